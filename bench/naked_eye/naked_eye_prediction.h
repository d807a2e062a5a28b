// SPDX-License-Identifier: GPL-3.0-or-later
// Prediction for a naked-eye session by an observer that has an eye, made before the person answers.
#pragma once

#include <optional>
#include <stop_token>
#include <utility>
#include <vector>

#include "bench/naked_eye/naked_eye.h"

namespace todbench {

class JsonFields;

/// Predicted share of correct answers at one size.
struct NakedEyeShare {
  double size_samples = 0, size_mrad = 0;
  double share = 0;                      ///< share by the model
  double share_low = 0, share_high = 0;  ///< lowest and highest share over the open parameters of the model
};

/// Prediction at one contrast.
struct NakedEyeContrast {
  double contrast = 0;
  double s75_mrad = 0;
  double s75_se_mrad = 0;  ///< standard error of the calculation, from its finite number of pictures
  /// Lowest and highest S75 over the open parameters (hvs/observer/open_parameters.h); not a confidence interval. A
  /// limit is empty if the model has no threshold at that limit of the parameters.
  std::optional<double> spread_low_mrad, spread_high_mrad;
  std::vector<NakedEyeShare> sizes;  ///< sizes in increasing order
};

/// Prediction at all contrasts.
struct NakedEyePrediction {
  double arcmin_per_sample = 0, adaptation_luminance_cd_m2 = 0;
  std::vector<NakedEyeContrast> contrasts;  ///< contrasts in the order of the task
  /// Returns the sizes of every contrast, in displayed samples.
  [[nodiscard]] std::vector<std::vector<double>> sizes_samples() const;
};

/// Describes the fields of the record.
void prediction_fields(JsonFields& json, NakedEyePrediction& prediction);

/// Predicts thresholds and shares from graded answers to `pictures` pictures of each size, and chooses the sizes around
/// the threshold. Deterministic for the seed of the task. Errors: validate(); `not_identifiable` (a contrast without a
/// threshold between 0.7 and 60 samples: a different zoom or distance is needed); `interrupted`.
[[nodiscard]] Result<NakedEyePrediction> predict_naked_eye(const NakedEyeTask& task, int pictures,
                                                           const std::stop_token& stop);

}  // namespace todbench
