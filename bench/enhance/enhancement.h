// SPDX-License-Identifier: GPL-3.0-or-later
// Test of enhancement: the same frames of a simulated sensor through several packages, and without a package.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "bench/enhance/package_file.h"
#include "bench/enhance/package_spread.h"
#include "bench/plan/loaded_plan.h"
#include "bench/session/open_session.h"
#include "bench/twin/experiment_inputs.h"
#include "tod/measurement/judged_contrast.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Acuity with a package divided by the acuity without it, at one contrast.
struct PairedRatio {
  double set_delta_t_k = 0;
  std::optional<double> ratio;  ///< empty: a threshold is missing
  /// 95 % interval by a jackknife of ln ratio with Student's t. The jackknife leaves out groups of whole presentations
  /// (at most 20) from both runs together. Variation common to both runs cancels, in particular the noise of the
  /// frames. If fewer than ten answers differ, the interval is at least as wide as unseen_ln_ratio(). The interval has
  /// no width if the observer judged equal pictures.
  Interval ci95;
  /// Lowest and highest ratio from three observers, each used in both runs: the observer with its stated parameters,
  /// and the observers at both limits of its open parameters. Not a confidence interval. Empty: no open parameters, or
  /// a threshold is missing.
  std::optional<std::pair<double, double>> spread{};
  std::string withheld{};  ///< reason why the ratio has no value: a point may not be used
};
/// Result of one package, or without a package.
struct PackageResult {
  std::string name;
  std::vector<Trial> trials;
  EndTrials at_ends{};              ///< trials at both limits of the open parameters of an observer with an eye
  TodCurve curve;                   ///< empty if no fit was possible
  std::vector<PairedRatio> ratios;  ///< ratios to the result without a package; empty in the result without a package
  double frame_ms = 0;              ///< median processing time of the stages of the package, per frame
  std::size_t frames = 0, clipped_pixels = 0;
  int samples_per_pixel = 1;             ///< samples per pixel and axis of the judged pictures
  std::vector<JudgedContrast> judged;    ///< gain and noise by set-up and contrast; empty: no stages
  cv::Mat1w picture;                     ///< picture of one frame; the same frame for all results
  std::optional<Error> error;            ///< reason for an early end or a failed measurement; earlier trials are kept
  std::vector<std::string> error_lines;  ///< first hundred lines of the modules on standard error
};
/// Results of all packages.
struct Enhancement {
  std::vector<PackageResult> results;  ///< first without a package, then the packages in their order
  int settle_frames = 0;               ///< exposures discarded after every change, the same for all
  std::string camera;                  ///< source of the frames
  double frame_rate_hz = 0;            ///< 0: unknown
  int dither = 1;                      ///< as in the options; 1 for recorded frames
  std::vector<std::string> warnings;   ///< one sentence each
};

/// Options of the test.
struct EnhancementOptions {
  std::function<void(const std::string& name)> on_package{};
  std::function<void(std::size_t done, std::size_t planned)> on_progress{};
  int dither = 1;  ///< n: the simulated sensor observes n x n positions within a pixel in sequence (dither_px())
};
/// Simulates the plan's sensor with every effect, once without a package and once with each package. All simulations
/// use the same random numbers: the exposures are identical bit for bit. After a change of the target, exposures are
/// discarded; their number is the memory of the package with the longest memory. The position of the plate and the
/// contrast are measured in the pictures of the camera itself. If a package fails, its result contains the error, and
/// the other packages continue. For an observer with an eye, the observers at both limits of its open parameters judge
/// the same patches. This gives the spread of thresholds and ratios. If there is no spread, a warning states the
/// reason. Errors: `invalid_input` for a plan whose schedule depends on the answers; those of the simulation without a
/// package.
[[nodiscard]] Result<Enhancement> compare_packages(const LoadedPlan& loaded,
                                                   const std::vector<EnhancementPackage>& packages,
                                                   const EnhancementOptions& options, std::stop_token stop);

/// Returns the plan of a session for a new evaluation of its recorded frames. Errors: those of open_session().
[[nodiscard]] Result<LoadedPlan> recorded_plan(const std::filesystem::path& session, const Opening& opening);
/// Compares the packages with the recorded frames of a session whose plan is `loaded`. The answers without a package
/// equal the answers of the session. After a change, the comparison can discard only frames that the run discarded. A
/// warning names packages with a longer memory. Errors: those of compare_packages() and open_recorded_bench().
[[nodiscard]] Result<Enhancement> compare_packages_recorded(const std::filesystem::path& session,
                                                            const LoadedPlan& loaded,
                                                            const std::vector<EnhancementPackage>& packages,
                                                            const EnhancementOptions& options, std::stop_token stop);

/// Returns the inputs with every effect simulated, because an effect that is negligible for the sensor alone may be
/// important in combination with a package. Errors: `invalid_input`.
[[nodiscard]] Result<ExperimentInputs> full_inputs(const LoadedPlan& loaded);
/// Simulates one chain with every effect: sensor, modules of the sensor, and stages of the package (null: none). For an
/// observer with an eye, also runs the observers at both limits of its open parameters, for add_spreads(). Errors are
/// in the result.
[[nodiscard]] PackageResult simulate_package(const LoadedPlan& loaded, const EnhancementPackage* package,
                                             int settle_frames, const EnhancementOptions& options,
                                             std::stop_token stop);
/// Returns the number of exposures after which a change no longer affects the output of the sensor's modules and of the
/// package. The numbers of successive stages add up.
[[nodiscard]] int memory_frames(const SensorSpec& sensor, const EnhancementPackage& package);
/// Fails with `invalid_input` for a plan that would show different frames to each package. Also fails for a plan that
/// uses psychometric functions of the sensor, because these functions do not include a package.
[[nodiscard]] Result<void> check_paired_plan(const Plan& plan);

/// Returns the paired ratios of two runs of the same presentations.
[[nodiscard]] std::vector<PairedRatio> paired_ratios(std::span<const Trial> with, std::span<const Trial> without,
                                                     const FitOptions& options);

}  // namespace todbench
