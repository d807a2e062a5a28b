// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/measures_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "acquisition/base/distributions.h"
#include "bench/session/ctf_record.h"
#include "bench/session/drift_record.h"
#include "bench/session/geometry_record.h"
#include "bench/session/response_record.h"
#include "bench/session/transfer_record.h"
#include "bench/text/base64.h"
#include "bench/text/json_reader.h"
#include "tod/measures/pixel_noise.h"

namespace todbench {
namespace {

double root(double variance) {
  return std::sqrt(std::max(0.0, variance));
}

/// Returns a standard deviation from a variance that may be negative.
MeasureLine deviation(std::string name, const ComponentEstimate& estimate, const std::string& conditions) {
  return {std::move(name), "K", root(estimate.variance), {root(estimate.low), root(estimate.high)}, conditions};
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

bool too_coarse(const NoiseMeasure& noise) {
  return noise.noise_counts && *noise.noise_counts < least_measurable_noise_counts;
}

void add_noise(MeasureLines& out, const CameraMeasures& measures) {
  const NoiseMeasure& noise = *measures.noise;
  const std::string conditions = conditions_of(noise);
  out.lines.push_back({"shading_range", "K", noise.shading_range_k, {}, conditions});
  if (noise.noise_counts) out.lines.push_back({"noise_counts", "counts", noise.noise_counts, {}, conditions});
  if (too_coarse(noise)) {
    out.reasons.push_back(fmt::format(
        "noise: not measured, because the scale is too coarse: the noise is {:.2f} counts", *noise.noise_counts));
    return;
  }
  out.lines.push_back(deviation("temporal_noise", *measures.temporal_variance_k2(), conditions));
  out.lines.push_back({"lag1_correlation", "1", noise.lag1_correlation, {}, conditions});
  if (noise.table.pixel_memory == 0 && noise.lag1_correlation.value_or(0) > 0.9)
    out.reasons.push_back(
        fmt::format("noise: {} frames cannot separate noise with such a long correlation ({:.2f}) from drift: the "
                    "temporal noise is underestimated and the fixed pattern overestimated",
                    noise.frames, *noise.lag1_correlation));
  if (const auto netd = measures.netd_k()) {
    const double half = *netd * measures.netd_relative_half_width().value_or(0);
    out.lines.push_back({"netd",
                         "K",
                         netd,
                         {*netd - half, *netd + half},
                         "temporal noise divided by the slope of the signal transfer"});
  }
  if (measures.netd_model_k)
    out.lines.push_back({"netd_model",
                         "K",
                         measures.netd_model_k,
                         {},
                         "closed form of the sensor model, for a correct temperature scale and any number of frames"});
  for (const NoiseComponent component : noise_components)
    out.lines.push_back(
        deviation("noise_" + std::string(to_string(component)), estimate_of(noise.table, component), conditions));
}

/// Adds "bad_pixels" for the whole frame and "bad_pixels (NAME)" for a zone. Unobserved parts may contain more.
void add_pixels(MeasureLines& out, const PixelMeasure& pixels) {
  for (const PixelMeasure::Zone& zone : pixels.zones) {
    const ZoneCount& count = zone.count;
    const std::string name = zone.area.name == "whole" ? "" : " (" + zone.area.name + ")";
    const std::string conditions =
        fmt::format("zone '{}': {} of its {} pixels were observed, in {} frames at a contrast of 0", zone.area.name,
                    count.measured, count.pixels, pixels.defects.frames);
    const auto line = [&](const char* measure, int found) {
      Interval most{.low = found, .high = found};
      if (count.measured < count.pixels) most.high.reset();
      out.lines.push_back({measure + name, "1", found, most, conditions});
    };
    line("bad_pixels", count.bad);
    line("substituted_pixels", count.substituted);
    line("defect_clusters", count.clusters);
    line("largest_cluster", count.largest_cluster);
    if (count.measured > 0)
      out.lines.push_back({"operability" + name, "%", 100.0 * (1 - 1.0 * count.bad / count.measured), {}, conditions});
  }
  for (const PixelDefect kind : pixel_defect_kinds) {
    if (kind == PixelDefect::substituted) continue;
    const auto found = static_cast<double>(cv::countNonZero(pixels.defects.of(kind)));
    const std::string seen =
        kind == PixelDefect::unresponsive
            ? fmt::format("of the {} pixels whose response was observed inside triangles",
                          pixels.defects.response_tested)
            : fmt::format("of the {} x {} observed pixels", pixels.field.width, pixels.field.height);
    out.lines.push_back({"pixels_" + std::string(to_string(kind)), "1", found, {found, found}, seen});
  }
  for (const std::string& sentence : pixels.defects.not_tested) out.reasons.push_back("pixels: " + sentence);
}

void add_transfer(MeasureLines& out, const TransferMeasure& transfer) {
  const SignalTransfer& line = transfer.line;
  const double half = transfer.slope_half_width();
  const std::string conditions =
      fmt::format("{} steps of {} frames, observed contrast over the contrast reported by the target",
                  transfer.steps.size(), transfer.frames_each);
  out.lines.push_back({"transfer_slope", "K/K", line.slope, {line.slope - half, line.slope + half}, conditions});
  out.lines.push_back({"transfer_offset", "K", line.offset, {}, conditions});
  out.lines.push_back({"transfer_nonlinearity", "%", line.nonlinearity_percent, {}, conditions});
  out.transfer = TransferCurve{transfer.steps, line.slope, line.offset};
}

/// Returns the interval; a lower end of 0 means unknown.
Interval mtf_interval(double low, double high) {
  return {low > 0 ? std::optional(low) : std::nullopt, high};
}

/// Adds "mtf_x" for the rectangle nearest to the centre, "mtf_x (NAME)" for the others.
void add_edge(MeasureLines& out, const MtfMeasure& mtf, const EdgeMtf& edge, const std::string& name) {
  const double f = mtf.frequency_per_pitch;
  const Interval interval = mtf_interval(edge.low_at(f), edge.high_at(f));
  const std::string axis(to_string(edge.axis));
  const std::string frames = fmt::format("{} frames of plate {} at {:g} K, {} {} of '{}', {:.2f} degrees from the axis",
                                         mtf.frames, mtf.plate, mtf.said_delta_t_k, edge.sides,
                                         edge.sides == 1 ? "side" : "opposite sides", edge.place, edge.angle_deg);
  out.lines.push_back({"mtf_" + axis + name, "1", edge.at(f), interval,
                       fmt::format("at {:g} cycles per pitch, {:.4g} per mrad: {}", f, f / mtf.pitch_mrad, frames)});
  if (edge.mtf50_per_pitch)
    out.lines.push_back({"mtf50_" + axis + name, "1/mrad", *edge.mtf50_per_pitch / mtf.pitch_mrad, {}, frames});
  if (edge.model.empty()) return;
  const auto k = static_cast<std::size_t>(std::lround(f * static_cast<double>(edge.model.size() - 1)));
  out.lines.push_back(
      {"mtf_" + axis + name + "_model",
       "1",
       edge.model[std::min(k, edge.model.size() - 1)],
       {},
       fmt::format("closed form of the sensor model at {:g} cycles per pitch", edge.frequency_per_pitch[k])});
}

void add_mtf(MeasureLines& out, const MtfMeasure& mtf) {
  for (const EdgeMtf& edge : mtf.edges)
    add_edge(out, mtf, edge, edge.place == mtf.edges.front().place ? "" : " (" + edge.place + ")");
  out.mtf = MtfCurves{mtf.pitch_mrad, mtf.edges};
}

PlatePanels panels_of(const PlatePicture& picture) {
  const cv::Mat1d& seen = picture.seen.kelvin;
  PlatePanels panels;
  panels.width = seen.cols, panels.height = seen.rows;
  cv::minMaxLoc(picture.expected_k, &panels.black_k, &panels.white_k);
  constexpr double shown = 4;  // standard deviations of the residual on either side
  panels.difference_k = std::max(shown * picture.residual_k, 1e-9);
  panels.seen = grey_png(seen, panels.black_k, panels.white_k);
  panels.expected = grey_png(picture.expected_k, panels.black_k, panels.white_k);
  panels.difference = grey_png(seen - picture.expected_k, -panels.difference_k, panels.difference_k);
  for (Polygon outline : picture.outlines) {
    for (cv::Point2d& p : outline) p -= cv::Point2d(picture.seen.field.tl());
    panels.outlines.push_back(std::move(outline));
  }
  return panels;
}

void add_picture(MeasureLines& out, const PlatePicture& picture) {
  const std::string conditions = fmt::format(
      "mean of {} frames of {} x {} pixels of the plate at {:g} K against the sensor model without noise; "
      "fitted: contrast ({:.4g} K), level, rotation, scale and position (shift {:.3f} pixels)",
      picture.seen.frames, picture.seen.kelvin.cols, picture.seen.kelvin.rows, picture.seen.set_delta_t_k,
      picture.contrast_k, picture.moved_px);
  const double relative = 1.96 / std::sqrt(2.0 * static_cast<double>(picture.seen.kelvin.total()));
  const auto line = [&](const char* name, const char* unit, double value) {
    out.lines.push_back({name, unit, value, {value * (1 - relative), value * (1 + relative)}, conditions});
  };
  line("picture_residual", "K", picture.residual_k);
  if (const auto ratio = picture.residual_over_noise()) line("picture_residual_over_noise", "1", *ratio);
  out.picture = panels_of(picture);
}

Json line_json(const MeasureLine& line) {
  Json json{{"measure", line.measure},
            {"unit", line.unit},
            {"value", json_number(line.value)},
            {"ci95", json_interval(line.ci95)},
            {"conditions", line.conditions}};
  if (line.expanded) json["expanded_ci95"] = json_interval(*line.expanded);
  return json;
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

Json list_json(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(json_number(value));
  return list;
}

Json mtf_json(const MtfMeasure& mtf) {
  Json edges = Json::array();
  for (const EdgeMtf& edge : mtf.edges) {
    Json intervals = Json::array();
    for (std::size_t i = 0; i < edge.mtf.size(); ++i)
      intervals.push_back(json_interval(mtf_interval(edge.low[i], edge.high[i])));
    std::vector<double> per_mrad = edge.frequency_per_pitch;
    for (double& f : per_mrad) f /= mtf.pitch_mrad;
    edges.push_back({{"place", edge.place},
                     {"axis", to_string(edge.axis)},
                     {"sides", edge.sides},
                     {"middle_px", {json_number(edge.middle_px.x), json_number(edge.middle_px.y)}},
                     {"angle_deg", json_number(edge.angle_deg)},
                     {"noise_over_step", json_number(edge.noise_over_step)},
                     {"frequency_per_pitch", list_json(edge.frequency_per_pitch)},
                     {"frequency_per_mrad", list_json(per_mrad)},
                     {"mtf", list_json(edge.mtf)},
                     {"mtf_ci95", intervals},
                     {"widest_halo_pitch", json_number(edge.widest_halo_pitch)},
                     {"halo_allowance", json_number(edge.halo_allowance)},
                     {"mtf50_per_pitch", json_number(edge.mtf50_per_pitch)},
                     {"model", edge.model.empty() ? Json() : list_json(edge.model)}});
  }
  return {{"plate", mtf.plate},
          {"frames", mtf.frames},
          {"set_delta_t_k", mtf.set_delta_t_k},
          {"said_delta_t_k", json_number(mtf.said_delta_t_k)},
          {"pitch_mrad", mtf.pitch_mrad},
          {"stated_at_per_pitch", mtf.frequency_per_pitch},
          {"edges", edges}};
}

Json panels_json(const PlatePanels& panels) {
  Json outlines = Json::array();
  for (const Polygon& outline : panels.outlines) {
    Json corners = Json::array();
    for (const cv::Point2d& p : outline) corners.push_back({json_number(p.x), json_number(p.y)});
    outlines.push_back(std::move(corners));
  }
  return {{"width", panels.width},
          {"height", panels.height},
          {"black_k", json_number(panels.black_k)},
          {"white_k", json_number(panels.white_k)},
          {"difference_k", json_number(panels.difference_k)},
          {"outlines_px", outlines},
          {"seen_png", panels.seen},
          {"expected_png", panels.expected},
          {"difference_png", panels.difference}};
}

PlatePanels panels_from(const JsonReader& picture) {
  PlatePanels panels;
  panels.width = static_cast<int>(picture.at("width").whole());
  panels.height = static_cast<int>(picture.at("height").whole());
  panels.black_k = picture.at("black_k").number();
  panels.white_k = picture.at("white_k").number();
  panels.difference_k = picture.at("difference_k").number();
  for (const JsonReader& corners : picture.at("outlines_px").elements()) {
    Polygon outline;
    for (const JsonReader& corner : corners.elements()) {
      const Interval place = corner.interval();
      outline.emplace_back(place.low.value_or(0), place.high.value_or(0));
    }
    panels.outlines.push_back(std::move(outline));
  }
  panels.seen = picture.at("seen_png").text();
  panels.expected = picture.at("expected_png").text();
  panels.difference = picture.at("difference_png").text();
  return panels;
}

std::vector<double> mtf_numbers(const JsonReader& list) {
  std::vector<double> values;
  for (const JsonReader& value : list.elements()) values.push_back(value.number());
  return values;
}

MtfCurves mtf_from(const JsonReader& mtf) {
  MtfCurves curves{mtf.at("pitch_mrad").number(), {}};
  for (const JsonReader& edge : mtf.at("edges").elements()) {
    EdgeMtf one;
    one.place = edge.at("place").text();
    one.axis = edge.at("axis").named(std::array{EdgeAxis::x, EdgeAxis::y});
    one.sides = static_cast<int>(edge.at("sides").whole());
    one.angle_deg = edge.at("angle_deg").number();
    one.noise_over_step = edge.at("noise_over_step").number();
    one.frequency_per_pitch = mtf_numbers(edge.at("frequency_per_pitch"));
    one.mtf = mtf_numbers(edge.at("mtf"));
    for (const JsonReader& sides : edge.at("mtf_ci95").elements()) {
      const Interval interval = sides.interval();
      one.low.push_back(interval.low.value_or(0)), one.high.push_back(interval.high.value_or(0));
    }
    one.mtf50_per_pitch = edge.at("mtf50_per_pitch").optional_number();
    const JsonReader model = edge.at("model");
    if (!model.is_null()) one.model = mtf_numbers(model);
    curves.edges.push_back(std::move(one));
  }
  return curves;
}

Json lines_json(const MeasureLines& found) {
  Json lines = Json::array();
  for (const MeasureLine& line : found.lines) lines.push_back(line_json(line));
  return lines;
}

Json side_json(const std::optional<CameraMeasures>& measures) {
  if (!measures) return nullptr;
  const MeasureLines found = measure_lines(*measures);
  return {{"quantities", lines_json(found)},
          {"noise", measures->noise ? noise_json(*measures->noise) : Json()},
          {"transfer", measures->transfer ? transfer_json(*measures->transfer) : Json()},
          {"geometry", measures->geometry ? geometry_json(*measures->geometry) : Json()},
          {"drift", measures->drift ? drift_json(*measures->drift) : Json()},
          {"response", measures->response ? response_json(*measures->response) : Json()},
          {"pixels", measures->pixels ? pixels_json(*measures->pixels) : Json()},
          {"mtf", measures->mtf ? mtf_json(*measures->mtf) : Json()},
          {"ctf", measures->ctf ? ctf_json(*measures->ctf) : Json()},
          {"maps", pixel_maps_json(found.maps)},
          {"picture", found.picture ? panels_json(*found.picture) : Json()},
          {"reasons", found.reasons}};
}

/// Returns whether each edge has a number at each frequency.
bool complete(const std::optional<MeasureLines>& side) {
  if (!side || !side->mtf) return true;
  const auto whole = [](const EdgeMtf& edge) {
    const std::size_t count = edge.frequency_per_pitch.size();
    return count > 1 && edge.mtf.size() == count && edge.low.size() == count && edge.high.size() == count &&
           (edge.model.empty() || edge.model.size() == count);
  };
  return side->mtf->pitch_mrad > 0 && std::all_of(side->mtf->edges.begin(), side->mtf->edges.end(), whole);
}

/// Returns whether all pictures that a page shows are valid.
bool drawable(const std::optional<MeasureLines>& side) {
  if (side && !drawable(side->maps)) return false;
  if (!side || !side->picture) return true;
  const PlatePanels& panels = *side->picture;
  return panels.width > 0 && panels.height > 0 && is_base64(panels.seen) && is_base64(panels.expected) &&
         is_base64(panels.difference);
}

std::optional<MeasureLines> side_from(const JsonReader& side) {
  if (side.is_null()) return std::nullopt;
  MeasureLines found;
  for (const JsonReader& line : side.at("quantities").elements()) {
    found.lines.push_back({line.at("measure").text(), line.at("unit").text(), line.at("value").optional_number(),
                           line.at("ci95").interval(), line.at("conditions").text()});
    const JsonReader expanded = line.at_if_there("expanded_ci95");
    if (!expanded.is_null()) found.lines.back().expanded = expanded.interval();
  }
  const JsonReader mtf = side.at_if_there("mtf");
  if (!mtf.is_null()) found.mtf = mtf_from(mtf);
  const JsonReader ctf = side.at_if_there("ctf");
  if (!ctf.is_null()) found.ctf = ctf_from(ctf);
  const JsonReader transfer = side.at_if_there("transfer");
  if (!transfer.is_null()) found.transfer = transfer_from(transfer);
  const JsonReader drift = side.at_if_there("drift");
  if (!drift.is_null()) found.drift = drift_from(drift);
  const JsonReader response = side.at_if_there("response");
  if (!response.is_null()) found.response = response_from(response);
  const JsonReader geometry = side.at_if_there("geometry");
  if (!geometry.is_null()) found.geometry = geometry_from(geometry);
  const JsonReader picture = side.at_if_there("picture");
  if (!picture.is_null()) found.picture = panels_from(picture);
  found.maps = pixel_maps_from(side.at_if_there("maps"));
  found.reasons = side.at("reasons").texts();
  return found;
}

}  // namespace

MeasureLines measure_lines(const CameraMeasures& measures) {
  MeasureLines found;
  if (measures.transfer) add_transfer(found, *measures.transfer);
  if (measures.geometry) add_geometry_lines(found, *measures.geometry);
  if (measures.noise) add_noise(found, measures);
  if (measures.drift) add_drift_lines(found, *measures.drift);
  if (measures.response) add_response_lines(found, *measures.response);
  if (const auto& model = measures.response_model_ms)
    found.lines.push_back({"response_time_model", "ms", *model, {}, "time constant of the sensor model"});
  if (measures.pixels) add_pixels(found, *measures.pixels);
  if (measures.mtf) add_mtf(found, *measures.mtf);
  if (measures.ctf) add_ctf_lines(found, *measures.ctf);
  if (measures.picture) add_picture(found, *measures.picture);
  found.maps = pixel_maps(measures);
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

Json measures_json(const MeasureLines& main) {
  return {{"main", {{"quantities", lines_json(main)}, {"maps", pixel_maps_json(main.maps)}, {"reasons", main.reasons}}},
          {"twin", nullptr}};
}

Result<SessionMeasures> measures_from(const Json& record) {
  const JsonReader reader(record);
  SessionMeasures measures{side_from(reader.at("main")), side_from(reader.at("twin"))};
  if (auto finished = reader.finish(); !finished) return tl::unexpected(finished.error());
  if (!drawable(measures.main) || !drawable(measures.twin))
    return fail(ErrorCode::invalid_input, "'picture': expected three PNG files of the same size as base64");
  if (!complete(measures.main) || !complete(measures.twin))
    return fail(ErrorCode::invalid_input, "'mtf.edges': expected lists of the same length and a pitch above 0");
  if (!ctf_drawable(measures.main) || !ctf_drawable(measures.twin))
    return fail(ErrorCode::invalid_input, "'ctf.groups': expected frequencies and a pitch above 0");
  if (!geometry_drawable(measures.main) || !geometry_drawable(measures.twin))
    return fail(ErrorCode::invalid_input, "'geometry.picture_px': expected numbers above 0");
  if (!drift_drawable(measures.main) || !drift_drawable(measures.twin))
    return fail(ErrorCode::invalid_input, "'drift': expected lists of the same length");
  return measures;
}

}  // namespace todbench
