// SPDX-License-Identifier: GPL-3.0-or-later
// Table of the physical measures in measures.json: one row for each measure. Each row is defined in the source file of
// its measure.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "bench/session/measures_record.h"
#include "bench/text/json.h"
#include "bench/text/json_fields.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

/// A measure in measures.json.
struct MeasureRow {
  std::string_view key;  ///< key of the measure in the record
  /// Adds the quantities of the measure, and the measure itself if a figure or a table shows the measure. No effect if
  /// the measure was not taken.
  void (*add)(MeasureLines& out, const CameraMeasures& measures);
  /// Describes the part of a measure that figures and tables show. The part is null if the measure was not taken. The
  /// reader reads the part if it is present and not null.
  void (*fields)(JsonFields& json, const std::string& key, MeasureLines& lines) = nullptr;
  /// Returns the part of a measure that has no `fields`. This part is written but not read; null if the measure was not
  /// taken.
  Json (*to_json)(const CameraMeasures& measures) = nullptr;
  bool (*valid)(const MeasureLines& lines) = nullptr;  ///< checks the numbers read; null: always valid
  std::string_view mistake{};                          ///< message if the numbers are not valid
};

/// Return the row of a measure; each function is defined in the file of its measure.
[[nodiscard]] MeasureRow transfer_row();
[[nodiscard]] MeasureRow geometry_row();
[[nodiscard]] MeasureRow noise_row();
[[nodiscard]] MeasureRow drift_row();
[[nodiscard]] MeasureRow response_row();
[[nodiscard]] MeasureRow pixels_row();
[[nodiscard]] MeasureRow mtf_row();
[[nodiscard]] MeasureRow ctf_row();
[[nodiscard]] MeasureRow source_size_row();
[[nodiscard]] MeasureRow absolute_row();
[[nodiscard]] MeasureRow timing_row();
[[nodiscard]] MeasureRow latency_row();
[[nodiscard]] MeasureRow mrtd_row();
[[nodiscard]] MeasureRow gain_control_row();

/// Returns all rows in the order of their quantities.
[[nodiscard]] inline const auto& measure_table() {
  static const std::array rows{transfer_row(), geometry_row(), noise_row(), drift_row(),       response_row(),
                               pixels_row(),   mtf_row(),      ctf_row(),   source_size_row(), absolute_row(),
                               timing_row(),   latency_row(),  mrtd_row(),  gain_control_row()};
  return rows;
}

/// Implements MeasureRow::fields for a measure that is stored in one member of MeasureLines.
template <auto Member, auto Describe>
void measure_part(JsonFields& json, const std::string& key, MeasureLines& lines) {
  json.later(key, lines.*Member, Describe);
}

/// Describes {"value", "ci95"}. A missing limit of the interval is replaced by the value.
void estimate_fields(JsonFields& json, Estimate& found);
/// Describes a frame after a step of the contrast: {"time_s", "left", "rising"}.
void step_point_fields(JsonFields& json, StepPoint& point);

}  // namespace todbench
