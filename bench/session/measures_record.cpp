#include "bench/session/measures_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "bench/text/json_reader.h"
#include "tod/measures/pixel_noise.h"

namespace todbench {
namespace {

double root(double variance) {
  return std::sqrt(std::max(0.0, variance));
}

/// A standard deviation from a variance that may be negative.
MeasureLine deviation(std::string name, const ComponentEstimate& estimate, const std::string& conditions) {
  return {std::move(name), "K", root(estimate.variance), {root(estimate.low), root(estimate.high)}, conditions};
}

std::string conditions_of(const NoiseMeasure& noise) {
  std::string text = fmt::format("{} frames of {} x {} pixels, contrast 0, {:.2f} K", noise.frames, noise.columns,
                                 noise.rows, noise.mean_k);
  if (noise.since_correction_s) text += fmt::format(", up to {:.1f} s after a correction", *noise.since_correction_s);
  return text + ", kelvin of the camera's scale, surface of second order taken out";
}

bool too_coarse(const NoiseMeasure& noise) {
  return noise.noise_counts && *noise.noise_counts < least_measurable_noise_counts;
}

void add_noise(MeasureLines& out, const CameraMeasures& measures) {
  const NoiseMeasure& noise = *measures.noise;
  const std::string conditions = conditions_of(noise);
  out.lines.push_back({"shading_range", "K", noise.shading_range_k, {}, conditions});
  if (noise.noise_counts) out.lines.push_back({"noise_counts", "counts", noise.noise_counts, {}, conditions});
  if (too_coarse(noise)) {
    out.reasons.push_back(
        fmt::format("noise: {:.2f} counts are too few for a number, the scale is too coarse", *noise.noise_counts));
    return;
  }
  out.lines.push_back(deviation("temporal_noise", *measures.temporal_variance_k2(), conditions));
  out.lines.push_back({"lag1_correlation", "1", noise.lag1_correlation, {}, conditions});
  if (const auto netd = measures.netd_k()) {
    const double half = 1.96 * *netd * measures.netd_relative_u().value_or(0);
    out.lines.push_back({"netd", "K", netd, {*netd - half, *netd + half}, "temporal noise over the signal transfer"});
  }
  for (const NoiseComponent component : noise_components)
    out.lines.push_back(
        deviation("noise_" + std::string(to_string(component)), estimate_of(noise.table, component), conditions));
}

void add_transfer(MeasureLines& out, const TransferMeasure& transfer) {
  const SignalTransfer& line = transfer.line;
  const double t = quantile(boost::math::students_t(line.degrees_of_freedom), 0.975);
  const std::string conditions =
      fmt::format("{} steps of {} frames, seen over said by the target", transfer.steps.size(), transfer.frames_each);
  out.lines.push_back({"transfer_slope",
                       "K/K",
                       line.slope,
                       {line.slope - t * line.slope_u, line.slope + t * line.slope_u},
                       conditions});
  out.lines.push_back({"transfer_offset", "K", line.offset, {}, conditions});
  out.lines.push_back({"transfer_nonlinearity", "%", line.nonlinearity_percent, {}, conditions});
}

Json line_json(const MeasureLine& line) {
  return {{"measure", line.measure},
          {"unit", line.unit},
          {"value", json_number(line.value)},
          {"ci95", json_interval(line.ci95)},
          {"conditions", line.conditions}};
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

Json transfer_json(const TransferMeasure& transfer) {
  Json steps = Json::array();
  for (const TransferStep& step : transfer.steps) {
    steps.push_back({{"set_delta_t_k", step.set_delta_t_k},
                     {"said_delta_t_k", json_number(step.said_delta_t_k)},
                     {"seen_delta_t_k", json_number(step.seen_delta_t_k)},
                     {"seen_u_k", json_number(step.seen_u_k)}});
  }
  return {{"frames_each", transfer.frames_each},
          {"steps", steps},
          {"slope", json_number(transfer.line.slope)},
          {"slope_u", json_number(transfer.line.slope_u)},
          {"offset_k", json_number(transfer.line.offset)},
          {"chi2", json_number(transfer.line.chi2)},
          {"degrees_of_freedom", transfer.line.degrees_of_freedom},
          {"p", json_number(transfer.line.p)},
          {"nonlinearity_percent", json_number(transfer.line.nonlinearity_percent)}};
}

Json side_json(const std::optional<CameraMeasures>& measures) {
  if (!measures) return nullptr;
  const MeasureLines found = measure_lines(*measures);
  Json lines = Json::array();
  for (const MeasureLine& line : found.lines) lines.push_back(line_json(line));
  return {{"quantities", lines},
          {"noise", measures->noise ? noise_json(*measures->noise) : Json()},
          {"transfer", measures->transfer ? transfer_json(*measures->transfer) : Json()},
          {"reasons", found.reasons}};
}

std::optional<MeasureLines> side_from(const JsonReader& side) {
  if (side.is_null()) return std::nullopt;
  MeasureLines found;
  for (const JsonReader& line : side.at("quantities").elements()) {
    found.lines.push_back({line.at("measure").text(), line.at("unit").text(), line.at("value").optional_number(),
                           line.at("ci95").interval(), line.at("conditions").text()});
  }
  found.reasons = side.at("reasons").texts();
  return found;
}

}  // namespace

MeasureLines measure_lines(const CameraMeasures& measures) {
  MeasureLines found;
  if (measures.transfer) add_transfer(found, *measures.transfer);
  if (measures.noise) add_noise(found, measures);
  found.reasons.insert(found.reasons.end(), measures.reasons.begin(), measures.reasons.end());
  return found;
}

std::vector<MeasuredQuantity> quantities_of(const MeasureLines& lines) {
  std::vector<MeasuredQuantity> quantities;
  for (const MeasureLine& line : lines.lines) quantities.push_back({line.measure, line.value, line.ci95});
  return quantities;
}

Json measures_json(const std::optional<CameraMeasures>& main, const std::optional<CameraMeasures>& twin) {
  return {{"main", side_json(main)}, {"twin", side_json(twin)}};
}

Result<SessionMeasures> measures_from(const Json& record) {
  const JsonReader reader(record);
  SessionMeasures measures{side_from(reader.at("main")), side_from(reader.at("twin"))};
  if (auto finished = reader.finish(); !finished) return tl::unexpected(finished.error());
  return measures;
}

}  // namespace todbench
