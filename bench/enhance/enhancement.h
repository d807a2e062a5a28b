// Enhancement under test: the same frames of a simulated sensor through several packages and through none.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "bench/enhance/package_file.h"
#include "bench/plan/loaded_plan.h"
#include "bench/session/open_session.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Acuity with a package over acuity without, at one contrast.
struct PairedRatio {
  double set_delta_t_k = 0;
  std::optional<double> ratio;  ///< nothing: a threshold is missing
  /// From the same presentations left out of both, group by group (jackknife of ln ratio over at most 20 groups of
  /// whole presentations, Student's t): what the two have in common, the noise of the frames above all, cancels.
  Interval ci95;
};
/// What came of one package, or of none.
struct PackageResult {
  std::string name;
  std::vector<Trial> trials;
  TodCurve curve;                   ///< empty where nothing could be fitted
  std::vector<PairedRatio> ratios;  ///< to none; of none itself empty
  double frame_ms = 0;              ///< median time of its stages for a frame
  std::size_t frames = 0, clipped_pixels = 0;
  int samples_per_pixel = 1;             ///< of what is judged, along each axis
  cv::Mat1w picture;                     ///< one and the same frame for all
  std::optional<Error> error;            ///< why it ended early or could not be measured; the trials so far are kept
  std::vector<std::string> error_lines;  ///< what its modules wrote to standard error, the first hundred lines
};
struct Enhancement {
  std::vector<PackageResult> results;  ///< none first, then the packages in their order
  int settle_frames = 0;               ///< exposures left out after every change, the same for all
  std::string camera;                  ///< whose frames they are
  double frame_rate_hz = 0;            ///< 0: unknown
  int dither = 1;                      ///< as in the options; of recorded frames 1
  std::vector<std::string> warnings;   ///< a sentence each
};

struct EnhancementOptions {
  std::function<void(const std::string& name)> on_package{};
  std::function<void(std::size_t done, std::size_t planned)> on_progress{};
  int dither = 1;  ///< n: the simulated sensor looks at n x n places of a pixel in turn (dither_px())
};
/// Simulates the plan's sensor with every effect, once without and once with each package, with the same random
/// numbers: what the sensor exposes is the same bit for bit. Every exposure within the longest memory of all packages
/// is left out after a change of the target. The place of the plate and the contrast are those in the pictures of the
/// camera itself. A package that fails has its error; the others go on. Errors: `invalid_input` for a plan whose
/// schedule depends on the answers; those of the simulation without a package.
[[nodiscard]] Result<Enhancement> compare_packages(const LoadedPlan& loaded,
                                                   const std::vector<EnhancementPackage>& packages,
                                                   const EnhancementOptions& options, std::stop_token stop);

/// The plan of a session, to be measured again from its recording. Errors: as open_session().
[[nodiscard]] Result<LoadedPlan> recorded_plan(const std::filesystem::path& session, const Opening& opening);
/// The same with the recorded frames of a session, whose plan is `loaded`: none gives the answers of the session. No
/// more frames can be left out after a change than the run left out; where a package remembers longer, a warning says
/// so. Errors: as compare_packages(), and those of open_recorded_bench().
[[nodiscard]] Result<Enhancement> compare_packages_recorded(const std::filesystem::path& session,
                                                            const LoadedPlan& loaded,
                                                            const std::vector<EnhancementPackage>& packages,
                                                            const EnhancementOptions& options, std::stop_token stop);

/// One way through the chain with every effect: sensor, its own modules, the stages of the package (null: none). What
/// goes wrong is in the result.
[[nodiscard]] PackageResult simulate_package(const LoadedPlan& loaded, const EnhancementPackage* package,
                                             int settle_frames, const EnhancementOptions& options,
                                             std::stop_token stop);
/// Exposures after which the sensor's modules and the package have forgotten a change: what one stage remembers the
/// next remembers again.
[[nodiscard]] int memory_frames(const SensorSpec& sensor, const EnhancementPackage& package);
/// `invalid_input` for a plan that shows each package other frames, or whose functions are those of the sensor alone.
[[nodiscard]] Result<void> check_paired_plan(const Plan& plan);

/// The paired ratios of two runs of the same presentations.
[[nodiscard]] std::vector<PairedRatio> paired_ratios(std::span<const Trial> with, std::span<const Trial> without,
                                                     const FitOptions& options);

}  // namespace todbench
