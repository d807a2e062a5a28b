// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison of an observer with an eye with published results of people, as a document.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "bench/report/document.h"

namespace todbench {

/// Relation between the figures of people and the parameters of the observer.
enum class VisionRole {
  fitted,     ///< some or all of these figures were used in the fit of the parameters
  chosen,     ///< a parameter was chosen with knowledge of these figures
  predicted,  ///< no parameter was adjusted to these figures
  from_file,  ///< figures of a user; the relation is not known
};
/// Returns the role in words.
[[nodiscard]] std::string_view to_string(VisionRole role);

/// Measure of the error of the observer.
enum class VisionError {
  decibel,  ///< 20 log10(model / people)
  log10,    ///< log10(model / people)
  points,   ///< model - people, both in percent
};
/// Returns the unit of the error.
[[nodiscard]] std::string_view to_string(VisionError error);

/// One condition: result of people, and of the observer.
struct VisionPoint {
  std::string condition;
  double people = 0, model = 0;
};

/// Figures of one kind.
struct VisionKind {
  std::string name;      ///< name for programs, "small_discs"
  std::string title;     ///< "Small discs"
  std::string quantity;  ///< quantity of the points with its unit: "sensitivity (1 / contrast)"
  VisionError error = VisionError::decibel;
  VisionRole role = VisionRole::predicted;
  std::string failure;  ///< error of the model for these figures; empty: the model describes them
  std::string source, remark;
  std::vector<VisionPoint> points;
};
/// Returns the error of the observer at a point, in the unit of the kind.
[[nodiscard]] double error_of(const VisionKind& kind, const VisionPoint& point);

/// Errors over all points of a kind.
struct VisionErrors {
  double mean = 0, rms = 0, largest = 0;  ///< largest: the error with the largest magnitude, with its sign
};
/// Returns the errors over all points. Precondition: the kind has points.
[[nodiscard]] VisionErrors errors_of(const VisionKind& kind);

/// Published figure without a corresponding result of this program.
struct VisionOutside {
  std::string quantity, published, reason;
};

/// Content of the page.
struct VisionComparison {
  std::string observer;
  std::string statement;          ///< statement about the limits of the observer
  std::vector<VisionKind> kinds;  ///< failures first
  std::vector<VisionOutside> not_comparable;
  std::vector<std::pair<std::string, std::string>> settings;
};

/// Returns the page for render_html(). A pure function.
[[nodiscard]] Document vision_document(const VisionComparison& comparison);

}  // namespace todbench
