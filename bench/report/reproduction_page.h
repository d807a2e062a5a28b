// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison of a published experiment with results of this program, as a document.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/report/document.h"
#include "tod/range/range_prediction.h"

namespace todbench {

/// Threshold of one sensor and observer.
struct ReproducedThreshold {
  std::string sensor, observer;
  double delta_t_k = 0;
  std::optional<double> acuity_per_mrad;
  Interval ci95;
  std::string method;  ///< method of determination
  /// Acuity of the same threshold from graded answers of a camera; empty: none.
  std::optional<double> graded_acuity_per_mrad{};
  Interval graded_ci95{};
  std::string graded_method{};
};

/// Kind of a figure. The kind determines whether differences are relative or in percentage points.
enum class FigureKind {
  amount,  ///< a value in its unit; differences are relative
  share,   ///< share of a total in percent; differences are in percentage points
  change,  ///< signed change of one value relative to another in percent; differences are in percentage points
};

/// Published figure and the corresponding result of this program. Texts are plain.
struct ReproducedFigure {
  FigureKind kind = FigureKind::amount;
  std::string quantity, unit;
  std::string published;                  ///< as the paper states it; empty: not stated
  std::optional<double> published_value;  ///< published number in `unit`; empty if the statement is not a number
  std::optional<double> value;
  Interval ci95;
  std::string remark;  ///< reason for a difference, or dependence
  /// Value from graded answers of a camera; empty: no threshold has graded answers.
  std::optional<double> graded_value{};
  Interval graded_ci95{};
};

/// Identification curve.
struct ReproducedRange {
  std::string sensor, observer;
  RangePrediction prediction;
};

/// Content of the page.
struct Reproduction {
  std::string title, source;
  /// Observer whose identification curves the figure shows, named as in thresholds and ranges. The other observers
  /// represent people.
  std::string model_observer;
  std::vector<std::string> simulated_sensors, cameras;
  std::vector<ReproducedFigure> figures;
  std::vector<ReproducedThreshold> thresholds;
  std::vector<ReproducedRange> ranges;
  std::vector<std::string> assumptions;  ///< values not stated in the paper, and the values assumed instead
  std::vector<std::pair<std::string, std::string>> settings;
};

/// Returns the difference between the value of this program and the published value: in percentage points for
/// percentages, otherwise in percent of the published value.
[[nodiscard]] std::string difference_in_words(const ReproducedFigure& figure);

/// Returns the page for render_html(). A pure function.
[[nodiscard]] Document reproduction_document(const Reproduction& reproduction);

}  // namespace todbench
