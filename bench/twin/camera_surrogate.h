// SPDX-License-Identifier: GPL-3.0-or-later
// Simulated sensor that replaces the twin if the frames of the camera differ from it. The surrogate provides the
// psychometric function for the fit of the camera and the response for the contrast of the camera. The twin itself does
// not change.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "bench/plan/loaded_plan.h"
#include "bench/session/provenance.h"
#include "bench/twin/experiment_inputs.h"
#include "sim_devices/prediction/camera_halo.h"
#include "sim_devices/prediction/camera_optics.h"
#include "tod/measurement/measurement.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Estimate of the camera from its set-ups at the highest contrast. One thread at a time; `loaded` and `inputs` must
/// outlive this object.
class CameraSurrogate {
 public:
  /// `responses`: result of simulated_responses() for the twin.
  CameraSurrogate(const LoadedPlan& loaded, const ExperimentInputs& inputs, std::map<std::string, double> responses);

  /// Returns the response of the plate through the camera's own optics, if these differ from the twin's optics. Used as
  /// MeasurementOptions::learn_response. The test is chi-square with two degrees of freedom. Over all set-ups of the
  /// plan, a camera identical to its twin fails with a probability of 0.2 %, with errors of registration below 1 %.
  [[nodiscard]] std::map<std::string, double> learn(const SetUpPicture& found);

  /// Returns the responses by which contrasts are divided.
  [[nodiscard]] const std::map<std::string, double>& responses() const { return responses_; }
  /// Returns the inputs with the surrogate in place of the twin. Empty if the frames of the camera agree with the twin,
  /// or if the surrogate is not a valid sensor; the function of the twin then remains in use. Noise counts as different
  /// if the difference is significant at 1 % (normal distribution) and would change a threshold by more than 0.05 %:
  /// 5 % of the NETD, or 3 % of the variance of a pixel for rows, columns and fixed pattern.
  [[nodiscard]] std::optional<ExperimentInputs> lent() const;
  /// Returns whether the pictures of the camera contradict the optical model of the twin for all its parameters, or
  /// whether no valid sensor has the estimated optics.
  [[nodiscard]] bool refused() const;
  /// Returns whether the frames could not be compared with the twin's optics: contrasts in grey levels, a program in
  /// the twin, or no triangle large enough.
  [[nodiscard]] bool unseen() const { return !possible_ || !fit_.result(); }
  /// Returns the light that the camera spreads round the triangles in addition to its twin; empty if the frames contain
  /// no such light.
  [[nodiscard]] std::optional<CameraHalo> halo() const;
  /// Returns whether the frames do not confirm the function and the response: refused(), unseen() or a halo().
  [[nodiscard]] bool unconfirmed() const { return refused() || unseen() || halo(); }
  /// Returns the largest magnitude of ln (estimated response / response of the twin) over the plates. If halo() has a
  /// share, the result is at least this share.
  [[nodiscard]] double response_shift() const;
  /// Returns the record of the estimate; empty if no set-up could be evaluated.
  [[nodiscard]] std::optional<CameraOpticsRecord> record() const;
  /// Returns a sentence for report and log.
  [[nodiscard]] std::optional<std::string> sentence() const;
  /// Returns the finding for a surrogate that is unconfirmed().
  [[nodiscard]] AdequacyFinding finding() const;

 private:
  struct Noise {
    double pixel = 0, row = 0, column = 0;           ///< variances of a frame, K^2
    double pixel_se = 0, row_se = 0, column_se = 0;  ///< standard errors of the variances
    double correlation = 0;
  };
  struct Learnt {
    double sigma = 0, ratio = 1;
  };
  [[nodiscard]] std::optional<Noise> noise() const;
  [[nodiscard]] bool noise_differs() const;
  /// Returns whether a surrogate is needed.
  [[nodiscard]] bool differs() const;
  [[nodiscard]] SensorSpec sensor(bool with_noise) const;
  void add_noise(const SetUpPicture& found);
  void add_to_fit(const SetUpPicture& found);
  [[nodiscard]] std::map<std::string, double> learnt_response(const SetUpPicture& found);

  const LoadedPlan& loaded_;
  const ExperimentInputs& inputs_;
  std::map<std::string, double> twin_responses_, responses_;
  std::map<std::string, Learnt> learnt_;
  CameraOpticsFit fit_;
  CameraHaloFit halo_fit_;
  int samples_per_pitch_ = 1;
  bool possible_ = false, optics_differ_ = false;
  double largest_k_ = 0;
  int pictures_ = 0;
  double total_ = 0, rows_ = 0, columns_ = 0, correlation_ = 0, pairs_ = 0;
  cv::Size size_;
};

}  // namespace todbench
