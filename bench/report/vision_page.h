// SPDX-License-Identifier: GPL-3.0-or-later
// An observer with an eye against figures of people, as a document.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "bench/report/document.h"

namespace todbench {

/// How the figures of people relate to the observer.
enum class VisionRole {
  fitted,     ///< some or all of them were in the fit of its parameters
  chosen,     ///< a parameter was chosen with these figures in sight
  predicted,  ///< nothing was adjusted to them
  from_file,  ///< figures of a user, the relation is not known
};
[[nodiscard]] std::string_view to_string(VisionRole role);

/// Measure of the error of the observer.
enum class VisionError {
  decibel,  ///< 20 log10(model / people)
  log10,    ///< log10(model / people)
  points,   ///< model - people, both in percent
};
/// Unit of the error.
[[nodiscard]] std::string_view to_string(VisionError error);

struct VisionPoint {
  std::string condition;
  double people = 0, model = 0;
};

/// Figures of one kind.
struct VisionKind {
  std::string name;      ///< for programs, "small_discs"
  std::string title;     ///< "Small discs"
  std::string quantity;  ///< of the points with its unit, "sensitivity (1 / contrast)"
  VisionError error = VisionError::decibel;
  VisionRole role = VisionRole::predicted;
  std::string failure;  ///< what is wrong with the model here; empty: it describes these figures
  std::string source, remark;
  std::vector<VisionPoint> points;
};
[[nodiscard]] double error_of(const VisionKind& kind, const VisionPoint& point);

struct VisionErrors {
  double mean = 0, rms = 0, largest = 0;  ///< largest: by its size, with its sign
};
/// Precondition: the kind has points.
[[nodiscard]] VisionErrors errors_of(const VisionKind& kind);

/// A published figure without one of ours.
struct VisionOutside {
  std::string quantity, published, reason;
};

struct VisionComparison {
  std::string observer;
  std::string statement;          ///< what the observer is not
  std::vector<VisionKind> kinds;  ///< failures first
  std::vector<VisionOutside> not_comparable;
  std::vector<std::pair<std::string, std::string>> settings;
};

/// Returns the page for render_html(). A pure function.
[[nodiscard]] Document vision_document(const VisionComparison& comparison);

}  // namespace todbench
