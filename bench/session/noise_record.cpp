// SPDX-License-Identifier: GPL-3.0-or-later
// Noise in measures.json.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "acquisition/base/normal.h"
#include "bench/session/measure_row.h"
#include "tod/measures/pixel_noise.h"

namespace todbench {
namespace {

double root(double variance) {
  return std::sqrt(std::max(0.0, variance));
}

/// Returns a standard deviation from a variance that may be negative.
MeasureLine deviation(std::string name, const ComponentEstimate& estimate, const std::string& conditions) {
  return measure_line(std::move(name), root(estimate.variance), {root(estimate.low), root(estimate.high)}, conditions);
}

std::string conditions_of(const NoiseMeasure& noise) {
  std::string text = fmt::format("{} frames of {} x {} pixels, contrast 0, {:.2f} K", noise.frames, noise.columns,
                                 noise.rows, noise.mean_k);
  if (noise.since_correction_s) text += fmt::format(", up to {:.1f} s after a correction", *noise.since_correction_s);
  text += ", kelvin on the camera's scale, second-order surface removed";
  if (noise.table.pixel_memory != 0)
    text += fmt::format(", corrected for a temporal correlation of {:.2f}", noise.table.pixel_memory);
  return text;
}

/// Errors of the fitted surface by the pattern of the pixels. The six terms have a leverage of 26 / N in a corner, so
/// that the difference of two corners has the variance 52 / N of a pixel's.
Interval shading_interval(const NoiseMeasure& noise) {
  if (noise.pattern_k.empty()) return {};
  cv::Scalar mean, sd;
  cv::meanStdDev(noise.pattern_k, mean, sd);
  const double half = normal_z95 * sd[0] * std::sqrt(52 / static_cast<double>(noise.pattern_k.total()));
  return {.low = std::max(0.0, noise.shading_range_k - half), .high = noise.shading_range_k + half};
}

bool too_coarse(const NoiseMeasure& noise) {
  return noise.noise_counts && *noise.noise_counts < least_measurable_noise_counts;
}

void add_noise(MeasureLines& out, const CameraMeasures& measures) {
  const NoiseMeasure& noise = *measures.noise;
  const std::string conditions = conditions_of(noise);
  out.lines.push_back(measure_line("shading_range", noise.shading_range_k, shading_interval(noise), conditions));
  if (noise.noise_counts) out.lines.push_back(measure_line("noise_counts", noise.noise_counts, {}, conditions));
  if (too_coarse(noise)) {
    out.reasons.push_back(fmt::format(
        "noise: not measured, because the scale is too coarse: the noise is {:.2f} counts", *noise.noise_counts));
    return;
  }
  out.lines.push_back(deviation("temporal_noise", *measures.temporal_variance_k2(), conditions));
  out.lines.push_back(measure_line("lag1_correlation", noise.lag1_correlation, {}, conditions));
  if (noise.table.pixel_memory == 0 && noise.lag1_correlation.value_or(0) > 0.9)
    out.reasons.push_back(
        fmt::format("noise: {} frames cannot separate noise with such a long correlation ({:.2f}) from drift: the "
                    "temporal noise is underestimated and the fixed pattern overestimated",
                    noise.frames, *noise.lag1_correlation));
  if (const auto netd = measures.netd_k()) {
    const double half = *netd * measures.netd_relative_half_width().value_or(0);
    out.lines.push_back(measure_line("netd", netd, {*netd - half, *netd + half},
                                     "temporal noise divided by the slope of the signal transfer"));
  }
  if (measures.netd_model_k)
    out.lines.push_back(
        measure_line("netd_model", measures.netd_model_k, {},
                     "closed form of the sensor model, for a correct temperature scale and any number of frames"));
  for (const NoiseComponent component : noise_components)
    out.lines.push_back(
        deviation("noise_" + std::string(to_string(component)), estimate_of(noise.table, component), conditions));
}

Json noise_json(const NoiseMeasure& noise) {
  Json variances, intervals;
  for (const NoiseComponent component : noise_components) {
    const ComponentEstimate found = estimate_of(noise.table, component);
    const std::string name(to_string(component));
    variances[name] = json_number(found.variance);
    intervals[name] = {json_number(found.low), json_number(found.high)};
  }
  return {{"frames", noise.frames},
          {"rows", noise.rows},
          {"columns", noise.columns},
          {"first_frame", noise.first_frame},
          {"last_frame", noise.last_frame},
          {"since_correction_s", json_number(noise.since_correction_s)},
          {"mean_k", json_number(noise.mean_k)},
          {"shading_range_k", json_number(noise.shading_range_k)},
          {"shading_sd_k", json_number(noise.shading_sd_k)},
          {"variances_k2", variances},
          {"intervals_k2", intervals}};
}

}  // namespace

MeasureRow noise_row() {
  return {
      .key = "noise",
      .add =
          [](MeasureLines& out, const CameraMeasures& measures) {
            if (measures.noise) add_noise(out, measures);
          },
      .to_json = [](const CameraMeasures& measures) { return measures.noise ? noise_json(*measures.noise) : Json(); }};
}

}  // namespace todbench
