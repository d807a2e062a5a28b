// SPDX-License-Identifier: GPL-3.0-or-later
// Result of one range model, in the form used by all reports and programs.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tod/psychometric/psychometric_fit.h"
#include "tod/range/criterion_range.h"

namespace todbench {

/// Probability at one range.
struct ModelRangePoint {
  double range_m = 0;
  std::optional<double> probability;
};

/// Result of a range model.
struct ModelRange {
  std::string name;       ///< "tod", "acquire", "ttp", "mtdp"
  std::string title;      ///< "TOD"
  std::string criterion;  ///< name of the criterion: "M75", "N50", "V50"
  double criterion_value = 0;
  std::string probability_form;    ///< name of the form
  std::string reads;               ///< one sentence that states the input of the model and the source of this input
  std::string criterion_origin{};  ///< a phrase that states observers, targets and source of the criterion
  std::string display{};           ///< one sentence about the contrast on the display that the model assumes
  std::optional<double> r50_m{}, r75_m{};
  Interval r75_ci95_m{};  ///< from the intervals of the curve and of the air; a side that is not known is open
  /// R75 over the range of the open parameters of the observer of a TOD curve (RangePrediction). This is not a
  /// confidence interval.
  std::optional<std::pair<double, double>> r75_spread_m{};
  std::optional<RangeSensitivity> sensitivity{};
  std::string reason{};              ///< reason why there is no r75_m; otherwise empty
  std::vector<std::string> notes{};  ///< assumptions of this model
  std::vector<ModelRangePoint> curve{};

  /// Returns the dominant limit. Empty if there is no range, because the contrast is too low or the air is not known.
  [[nodiscard]] std::optional<DominantLimit> dominant() const {
    return sensitivity ? std::optional(sensitivity->dominant()) : std::nullopt;
  }
};

}  // namespace todbench
