// SPDX-License-Identifier: GPL-3.0-or-later
// MTF in measures.json.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "bench/session/measure_row.h"
#include "tod/measures/mtf50.h"

namespace todbench {
namespace {

/// Returns the interval; a lower end of 0 means unknown.
Interval mtf_interval(double low, double high) {
  return {low > 0 ? std::optional(low) : std::nullopt, high};
}

Interval over(const Interval& interval, double divisor) {
  const auto divided = [&](const std::optional<double>& end) {
    return end ? std::optional(*end / divisor) : std::nullopt;
  };
  return {divided(interval.low), divided(interval.high)};
}

/// Statement about halos wider than the plate can tell from shading; empty if it excludes them.
std::string unseen_halos(const EdgeMtf& edge) {
  if (edge.wide_halo_most <= least_wide_share) return {};
  return fmt::format(
      "; relative to a source of the size of the plate: halos with a sigma above {:.3g} pixels can hold up to {:.2g} % "
      "of the light",
      edge.widest_halo_pitch, 100 * edge.wide_halo_most);
}

/// Adds "mtf_x" for the rectangle nearest to the centre, "mtf_x (NAME)" for the others.
void add_edge(MeasureLines& out, const MtfMeasure& mtf, const EdgeMtf& edge, const std::string& name) {
  const double f = mtf.frequency_per_pitch;
  const Interval interval = mtf_interval(edge.low_at(f), edge.high_at(f));
  const std::string axis(to_string(edge.axis));
  const std::string frames = fmt::format("{} frames of plate {} at {:g} K, {} {} of '{}', {:.2f} degrees from the axis",
                                         mtf.frames, mtf.plate, mtf.said_delta_t_k, edge.sides,
                                         edge.sides == 1 ? "side" : "opposite sides", edge.place, edge.angle_deg) +
                             unseen_halos(edge);
  out.lines.push_back(
      measure_line("mtf_" + axis + name, edge.at(f), interval,
                   fmt::format("at {:g} cycles per pitch, {:.4g} per mrad: {}", f, f / mtf.pitch_mrad, frames)));
  if (edge.mtf50_per_pitch)
    out.lines.push_back(
        measure_line("mtf50_" + axis + name, *edge.mtf50_per_pitch / mtf.pitch_mrad,
                     over(mtf50_interval(edge.frequency_per_pitch, edge.low, edge.high), mtf.pitch_mrad), frames));
  if (edge.model.empty()) return;
  const auto k = static_cast<std::size_t>(std::lround(f * static_cast<double>(edge.model.size() - 1)));
  out.lines.push_back(measure_line(
      "mtf_" + axis + name + "_model", edge.model[std::min(k, edge.model.size() - 1)], {},
      fmt::format("closed form of the sensor model at {:g} cycles per pitch", edge.frequency_per_pitch[k])));
}

void add_mtf(MeasureLines& out, const MtfMeasure& mtf) {
  for (const EdgeMtf& edge : mtf.edges)
    add_edge(out, mtf, edge, edge.place == mtf.edges.front().place ? "" : " (" + edge.place + ")");
  out.mtf = mtf;
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
                     {"frequency_per_pitch", json_numbers(edge.frequency_per_pitch)},
                     {"frequency_per_mrad", json_numbers(per_mrad)},
                     {"mtf", json_numbers(edge.mtf)},
                     {"mtf_ci95", intervals},
                     {"widest_halo_pitch", json_number(edge.widest_halo_pitch)},
                     {"halo_allowance", json_number(edge.halo_allowance)},
                     {"wide_halo_ci95", {json_number(edge.wide_halo_least), json_number(edge.wide_halo_most)}},
                     {"mtf50_per_pitch", json_number(edge.mtf50_per_pitch)},
                     {"model", edge.model.empty() ? Json() : json_numbers(edge.model)}});
  }
  return {{"plate", mtf.plate},
          {"frames", mtf.frames},
          {"set_delta_t_k", mtf.set_delta_t_k},
          {"said_delta_t_k", json_number(mtf.said_delta_t_k)},
          {"pitch_mrad", mtf.pitch_mrad},
          {"stated_at_per_pitch", mtf.frequency_per_pitch},
          {"edges", edges}};
}

MtfMeasure mtf_from(const JsonReader& mtf) {
  MtfMeasure found;
  found.pitch_mrad = mtf.at("pitch_mrad").number();
  for (const JsonReader& edge : mtf.at("edges").elements()) {
    EdgeMtf one;
    one.place = edge.at("place").text();
    one.axis = edge.at("axis").named(std::array{EdgeAxis::x, EdgeAxis::y});
    one.sides = static_cast<int>(edge.at("sides").whole());
    one.angle_deg = edge.at("angle_deg").number();
    one.noise_over_step = edge.at("noise_over_step").number();
    one.frequency_per_pitch = edge.at("frequency_per_pitch").numbers();
    one.mtf = edge.at("mtf").numbers();
    for (const JsonReader& sides : edge.at("mtf_ci95").elements()) {
      const Interval interval = sides.interval();
      one.low.push_back(interval.low.value_or(0)), one.high.push_back(interval.high.value_or(0));
    }
    one.mtf50_per_pitch = edge.at("mtf50_per_pitch").optional_number();
    const JsonReader model = edge.at("model");
    if (!model.is_null()) one.model = model.numbers();
    found.edges.push_back(std::move(one));
  }
  return found;
}

/// Returns whether each edge has a number at each frequency.
bool complete(const MtfMeasure& mtf) {
  const auto whole = [](const EdgeMtf& edge) {
    const std::size_t count = edge.frequency_per_pitch.size();
    return count > 1 && edge.mtf.size() == count && edge.low.size() == count && edge.high.size() == count &&
           (edge.model.empty() || edge.model.size() == count);
  };
  return mtf.pitch_mrad > 0 && std::all_of(mtf.edges.begin(), mtf.edges.end(), whole);
}

}  // namespace

MeasureRow mtf_row() {
  return {.key = "mtf",
          .add =
              [](MeasureLines& out, const CameraMeasures& measures) {
                if (measures.mtf) add_mtf(out, *measures.mtf);
              },
          .to_json = [](const CameraMeasures& measures) { return measures.mtf ? mtf_json(*measures.mtf) : Json(); },
          .read = [](MeasureLines& out, const JsonReader& part) { out.mtf = mtf_from(part); },
          .valid = [](const MeasureLines& lines) { return !lines.mtf || complete(*lines.mtf); },
          .mistake = "'mtf.edges': expected lists of the same length and a pitch above 0"};
}

}  // namespace todbench
