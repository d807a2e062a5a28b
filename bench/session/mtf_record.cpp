// SPDX-License-Identifier: GPL-3.0-or-later
// MTF in measures.json.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

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

void mtf_edge_fields(JsonFields& json, EdgeMtf& edge, double pitch_mrad) {
  std::vector<Interval> intervals;
  for (std::size_t i = 0; i < edge.mtf.size(); ++i) intervals.push_back(mtf_interval(edge.low[i], edge.high[i]));
  std::vector<double> per_mrad = edge.frequency_per_pitch;
  for (double& f : per_mrad) f /= pitch_mrad;
  std::optional<std::vector<double>> model;
  if (!edge.model.empty()) model = edge.model;
  json.value("place", edge.place);
  json.value("axis", edge.axis, std::array{EdgeAxis::x, EdgeAxis::y});
  json.value("sides", edge.sides);
  json.derived("middle_px", Interval{edge.middle_px.x, edge.middle_px.y});
  json.value("angle_deg", edge.angle_deg);
  json.value("noise_over_step", edge.noise_over_step);
  json.value("frequency_per_pitch", edge.frequency_per_pitch);
  json.derived("frequency_per_mrad", per_mrad);
  json.value("mtf", edge.mtf);
  json.value("mtf_ci95", intervals);
  json.derived("widest_halo_pitch", edge.widest_halo_pitch);
  json.derived("halo_allowance", edge.halo_allowance);
  json.derived("wide_halo_ci95", Interval{edge.wide_halo_least, edge.wide_halo_most});
  json.value("mtf50_per_pitch", edge.mtf50_per_pitch);
  json.value("model", model);
  if (!json.reading()) return;
  for (const Interval& interval : intervals)
    edge.low.push_back(interval.low.value_or(0)), edge.high.push_back(interval.high.value_or(0));
  edge.model = model.value_or(std::vector<double>());
}

void mtf_fields(JsonFields& json, MtfMeasure& mtf) {
  json.derived("plate", mtf.plate);
  json.derived("frames", mtf.frames);
  json.derived("set_delta_t_k", mtf.set_delta_t_k);
  json.derived("said_delta_t_k", mtf.said_delta_t_k);
  json.value("pitch_mrad", mtf.pitch_mrad);
  json.derived("stated_at_per_pitch", mtf.frequency_per_pitch);
  json.value("edges", mtf.edges, [&](JsonFields& item, EdgeMtf& edge) { mtf_edge_fields(item, edge, mtf.pitch_mrad); });
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
          .fields = measure_part<&MeasureLines::mtf, mtf_fields>,
          .valid = [](const MeasureLines& lines) { return !lines.mtf || complete(*lines.mtf); },
          .mistake = "'mtf.edges': expected lists of the same length and a pitch above 0"};
}

}  // namespace todbench
