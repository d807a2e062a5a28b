// SPDX-License-Identifier: GPL-3.0-or-later
// Result of one range model, as all reports and programs show it.
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
  std::string probability_form;    ///< by name
  std::string reads;               ///< input of the model and its source: a sentence
  std::string criterion_origin{};  ///< whose answers, to which targets, by which source: a phrase
  std::string display{};           ///< contrast on the display that the model assumes: a sentence
  std::optional<double> r50_m{}, r75_m{};
  Interval r75_ci95_m{};  ///< of the curve and the air; a side is open if unknown
  /// R75 over the open parameters of the observer of a TOD curve (RangePrediction); not a confidence interval.
  std::optional<std::pair<double, double>> r75_spread_m{};
  std::optional<RangeSensitivity> sensitivity{};
  std::string reason{};              ///< why there is no r75_m; else empty
  std::vector<std::string> notes{};  ///< assumptions of this model
  std::vector<ModelRangePoint> curve{};

  /// Dominant limit; empty without a range, because the contrast was lost or the air is not known.
  [[nodiscard]] std::optional<DominantLimit> dominant() const {
    return sensitivity ? std::optional(sensitivity->dominant()) : std::nullopt;
  }
};

}  // namespace todbench
