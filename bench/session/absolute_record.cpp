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

/// By the error of white noise from successive differences of frames: 1.5 times the variance of independent frames.
Interval dynamic_range_interval(double value_db, int frames, double pixels) {
  const double half = 20 * std::log10(1 + normal_z95 * std::sqrt(0.75 / (pixels * std::max(1, frames - 1))));
  return {.low = value_db - half, .high = value_db + half};
}

/// `pixels`: of the picture.
void add_lines(MeasureLines& out, const AbsoluteMeasure& measure, double pixels) {
  const auto add = [&](const char* name, const Estimate& found, const std::string& conditions) {
    out.lines.push_back(measure_line(name, found.value, found.interval(), conditions));
  };
  const std::string range =
      fmt::format("{} temperatures of the black body from {:g} to {:g} K, upwards and downwards, {} frames each",
                  measure.levels.size(), measure.levels.front().set_k, measure.levels.back().set_k, measure.frames);
  const AbsoluteLevel& worst = measure.worst();
  add("absolute_error", measure.deviation_k(worst), fmt::format("at {:.3f} K; {}", worst.said_k, range));
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
  const auto exact = [](double value) { return Interval{.low = value, .high = value}; };
  if (measure.lowest_k)
    out.lines.push_back(measure_line("range_low", measure.lowest_k, exact(*measure.lowest_k), "lowest count"));
  if (measure.highest_k)
    out.lines.push_back(measure_line("range_high", measure.highest_k, exact(*measure.highest_k), "highest count"));
  if (measure.dynamic_range_db)
    out.lines.push_back(measure_line("dynamic_range", measure.dynamic_range_db,
                                     dynamic_range_interval(*measure.dynamic_range_db, measure.frames, pixels),
                                     "from the lowest to the highest count, over the temporal noise of a pixel"));
}

Json absolute_json(const AbsoluteMeasure& measure) {
  Json levels = Json::array();
  for (const AbsoluteLevel& level : measure.levels) {
    levels.push_back({{"set_k", json_number(level.set_k)},
                      {"said_k", json_number(level.said_k)},
                      {"expected_k", json_number(level.expected_k)},
                      {"seen_k", json_number(level.seen_k)},
                      {"difference_k", json_number(level.difference_k)},
                      {"pattern_k", level.saturated ? Json() : estimate_json(level.pattern_k)},
                      {"saturated", level.saturated}});
  }
  return {{"plate", measure.plate},
          {"frames", measure.frames},
          {"levels", levels},
          {"repeatability_k", json_number(measure.repeatability_k)},
          {"u_k", json_number(measure.u_k)},
          {"degrees_of_freedom", measure.degrees_of_freedom},
          {"source_u_k", json_number(measure.source_u_k)},
          {"nonlinearity_percent", json_number(measure.nonlinearity_percent)},
          {"undetermined_slope_k", json_number(measure.undetermined_slope_k)}};
}

}  // namespace

MeasureRow absolute_row() {
  return {.key = "absolute",
          .add =
              [](MeasureLines& out, const CameraMeasures& measures) {
                const double pixels = measures.view ? std::max(1, measures.view->picture.area()) : 1;
                if (measures.absolute) add_lines(out, *measures.absolute, pixels);
              },
          .to_json =
              [](const CameraMeasures& measures) {
                return measures.absolute ? absolute_json(*measures.absolute) : Json();
              }};
}

}  // namespace todbench
