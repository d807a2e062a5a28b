// SPDX-License-Identifier: GPL-3.0-or-later
// Absolute temperatures in measures.json.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "acquisition/base/distributions.h"
#include "acquisition/base/normal.h"
#include "bench/session/measure_row.h"

namespace todbench {
namespace {

/// Chi-square interval of a standard deviation.
Interval repeatability_interval(const AbsoluteMeasure& measure) {
  const double freedom = measure.degrees_of_freedom;
  const auto end = [&](double probability) {
    return measure.repeatability_k * std::sqrt(freedom / quantile(distribution::ChiSquared(freedom), probability));
  };
  return {.low = end(0.975), .high = end(0.025)};
}

/// Error at the temperature with the largest one. The interval holds for every temperature together (Bonferroni): the
/// largest of several errors is also the one with the largest random part.
Estimate largest_error(const AbsoluteMeasure& measure) {
  const double freedom = measure.degrees_of_freedom;
  const AbsoluteLevel& worst = measure.worst();
  const double value = worst.seen_k - worst.expected_k;
  if (!(freedom > 0)) return measure.deviation_k(worst);
  const double t = quantile(distribution::StudentsT(freedom), 1 - 0.025 / static_cast<double>(measure.levels.size()));
  const double half = std::hypot(t * measure.u_k, normal_z95 * measure.source_u_k);
  return {value, value - half, value + half};
}

/// Mean over the temperatures, with the lowest and the highest in the conditions.
void add_camera_temperature(MeasureLines& out, const AbsoluteMeasure& measure, const std::string& range) {
  double sum = 0, low = 0, high = 0;
  int count = 0;
  for (const AbsoluteLevel& level : measure.levels) {
    if (!level.camera_c) continue;
    low = count == 0 ? *level.camera_c : std::min(low, *level.camera_c);
    high = count == 0 ? *level.camera_c : std::max(high, *level.camera_c);
    sum += *level.camera_c, ++count;
  }
  if (count > 0)
    out.lines.push_back(measure_line("camera_temperature", sum / count, {},
                                     fmt::format("its own sensor, {:.2f} to {:.2f} C during {}", low, high, range)));
}

void add_lines(MeasureLines& out, const AbsoluteMeasure& measure) {
  const auto add = [&](const char* name, const Estimate& found, const std::string& conditions) {
    out.lines.push_back(measure_line(name, found.value, found.interval(), conditions));
  };
  const std::string range =
      fmt::format("{} temperatures of the black body from {:g} to {:g} K, upwards and downwards, {} frames each",
                  measure.levels.size(), measure.levels.front().set_k, measure.levels.back().set_k, measure.frames);
  const AbsoluteLevel& worst = measure.worst();
  add("absolute_error", largest_error(measure), fmt::format("at {:.3f} K; {}", worst.said_k, range));
  add("absolute_slope", measure.slope, range);
  add("absolute_offset", measure.offset_k, "in the middle of " + range);
  out.lines.push_back(measure_line("repeatability", measure.repeatability_k, repeatability_interval(measure), range));
  add("ietd", measure.ietd_k(), "second-order surface removed; " + range);
  add("prnu", measure.prnu_percent, "second-order surface removed; " + range);
  if (measure.camera_pattern_k) {
    const std::string apart = fmt::format(
        "black body at {:g} K shifted by the stage; a slope of {:.3g} K over the picture can be of either and is in "
        "neither",
        measure.levels[measure.levels.size() / 2].set_k, measure.undetermined_slope_k.value_or(0));
    add("camera_pattern", *measure.camera_pattern_k, apart);
    add("source_pattern", *measure.source_pattern_k, apart);
  }
  add_camera_temperature(out, measure, range);
  const auto exact = [](double value) { return Interval{.low = value, .high = value}; };
  if (measure.lowest_k)
    out.lines.push_back(measure_line("range_low", measure.lowest_k, exact(*measure.lowest_k), "lowest count"));
  if (measure.highest_k)
    out.lines.push_back(measure_line("range_high", measure.highest_k, exact(*measure.highest_k), "highest count"));
  if (measure.dynamic_range_db)
    out.lines.push_back(measure_line("dynamic_range", measure.dynamic_range_db,
                                     {.low = *measure.dynamic_range_db - measure.dynamic_range_half_db,
                                      .high = *measure.dynamic_range_db + measure.dynamic_range_half_db},
                                     "from the lowest to the highest count, over the temporal noise of a pixel"));
  out.absolute = measure;
}

void absolute_level_fields(JsonFields& json, AbsoluteLevel& level) {
  json.value("set_k", level.set_k);
  json.value("said_k", level.said_k);
  json.value("expected_k", level.expected_k);
  json.value("seen_k", level.seen_k);
  json.derived("difference_k", level.difference_k);
  json.derived("camera_c", level.camera_c);
  json.derived("pattern_k", level.saturated ? std::nullopt : std::optional(level.pattern_k), estimate_fields);
  json.value("saturated", level.saturated);
}

void absolute_fields(JsonFields& json, AbsoluteMeasure& measure) {
  json.value("plate", measure.plate);
  json.derived("frames", measure.frames);
  json.value("levels", measure.levels, absolute_level_fields);
  json.derived("repeatability_k", measure.repeatability_k);
  json.value("u_k", measure.u_k);
  json.value("degrees_of_freedom", measure.degrees_of_freedom);
  json.value("source_u_k", measure.source_u_k);
  json.derived("nonlinearity_percent", measure.nonlinearity_percent);
  json.derived("undetermined_slope_k", measure.undetermined_slope_k);
}

}  // namespace

MeasureRow absolute_row() {
  return {.key = "absolute",
          .add =
              [](MeasureLines& out, const CameraMeasures& measures) {
                if (measures.absolute) add_lines(out, *measures.absolute);
              },
          .fields = measure_part<&MeasureLines::absolute, absolute_fields>,
          .valid = [](const MeasureLines& lines) { return !lines.absolute || lines.absolute->degrees_of_freedom > 0; },
          .mistake = "'absolute.degrees_of_freedom': expected a number above 0"};
}

}  // namespace todbench
