// A published experiment beside our own figures: a document made from values.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/report/document.h"
#include "tod/range/range_prediction.h"

namespace todbench {

/// One threshold of one sensor and observer.
struct ReproducedThreshold {
  std::string sensor, observer;
  double delta_t_k = 0;
  std::optional<double> acuity_per_mrad;
  Interval ci95;
  std::string method;  ///< how it was found
  /// Of a camera the same from graded answers; nothing: there are none.
  std::optional<double> graded_acuity_per_mrad{};
  Interval graded_ci95{};
  std::string graded_method{};
};

/// What a figure is: it decides how differences are said.
enum class FigureKind {
  amount,  ///< in its unit; a difference is relative
  share,   ///< of all, in per cent; a difference is in points
  change,  ///< of one against another, in per cent, with its sign; a difference is in points
};

/// One published figure with ours. Texts are plain.
struct ReproducedFigure {
  FigureKind kind = FigureKind::amount;
  std::string quantity, unit;
  std::string published;                  ///< as the paper states it; empty: the paper leaves it open
  std::optional<double> published_value;  ///< in `unit`, where the statement is a number
  std::optional<double> value;
  Interval ci95;
  std::string remark;  ///< why it differs, or what it depends on
  /// The same from the graded answers of a camera; nothing: none of its thresholds has any.
  std::optional<double> graded_value{};
  Interval graded_ci95{};
};

/// One identification curve.
struct ReproducedRange {
  std::string sensor, observer;
  RangePrediction prediction;
};

struct Reproduction {
  std::string title, source;
  /// How curves are told apart: as named in thresholds and ranges. Other observers stand for people.
  std::string model_observer;
  std::vector<std::string> simulated_sensors, cameras;
  std::vector<ReproducedFigure> figures;
  std::vector<ReproducedThreshold> thresholds;
  std::vector<ReproducedRange> ranges;
  std::vector<std::string> assumptions;  ///< what the paper does not state, and what was taken instead
  std::vector<std::pair<std::string, std::string>> settings;
};

/// Ours against the published number: a difference in units of `unit` for percentages, else in per cent of it.
[[nodiscard]] std::string difference_in_words(const ReproducedFigure& figure);

/// The page as a value, for render_html(). A pure function.
[[nodiscard]] Document reproduction_document(const Reproduction& reproduction);

}  // namespace todbench
