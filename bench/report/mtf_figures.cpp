// SPDX-License-Identifier: GPL-3.0-or-later
// Figures of the MTF.
#include <algorithm>
#include <cctype>
#include <string>
#include <utility>

#include "bench/report/measure_figures.h"
#include "bench/report/plot.h"

namespace todbench {
namespace {

PlotSeries mtf_series(const EdgeMtf& edge, double pitch_mrad, std::string label, PlotTone tone, PlotLine line) {
  PlotSeries series{.label = std::move(label), .tone = tone, .marker = PlotMarker::none, .line = line, .points = {}};
  constexpr std::size_t every = 2;  // of 101 frequencies
  for (std::size_t i = 0; i < edge.mtf.size(); i += every) {
    series.points.push_back({.x = edge.frequency_per_pitch[i] / pitch_mrad,
                             .y = std::max(0.0, edge.mtf[i]),
                             .x_interval = {},
                             .y_interval = {}});
  }
  return series;
}

/// Returns the intervals at every tenth of a cycle.
PlotSeries mtf_bars(const EdgeMtf& edge, double pitch_mrad, PlotTone tone, PlotMarker marker) {
  PlotSeries series{.label = "", .tone = tone, .marker = marker, .points = {}};
  constexpr std::size_t every = 10;
  for (std::size_t i = every; i < edge.mtf.size(); i += every) {
    series.points.push_back({.x = edge.frequency_per_pitch[i] / pitch_mrad,
                             .y = std::max(0.0, edge.mtf[i]),
                             .x_interval = {},
                             .y_interval = {std::max(0.0, edge.low[i]), std::max(0.0, edge.high[i])}});
  }
  return series;
}

const EdgeMtf* edge_of(const std::optional<MeasureLines>& side, const EdgeMtf& like) {
  if (!side || !side->mtf) return nullptr;
  for (const EdgeMtf& edge : side->mtf->edges)
    if (edge.place == like.place && edge.axis == like.axis) return &edge;
  return nullptr;
}

/// Returns the figure of one place and axis: camera with intervals, twin, closed form.
Figure mtf_figure(const EdgeMtf& edge, const SessionMeasures& measures, bool camera) {
  Plot plot;
  const std::string axis(to_string(edge.axis));
  plot.id = "mtf-" + axis;
  for (const char c : edge.place) plot.id += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '-';
  plot.title = "MTF along " + axis + ", " + edge.place;
  plot.description = "Modulation transfer over spatial frequency with 95 % intervals";
  plot.width = 430, plot.height = 350;
  double highest = 1.1, beyond_pitch_mrad = 0;
  const std::optional<MeasureLines>* const sides[] = {&measures.twin, &measures.main};
  for (const auto* side : sides) {
    const EdgeMtf* found = edge_of(*side, edge);
    if (found == nullptr) continue;
    const bool first = side == &measures.main;
    const double pitch_mrad = (*side)->mtf->pitch_mrad;
    if (!found->model.empty()) {
      EdgeMtf model = *found;
      model.mtf = model.model;
      plot.series.push_back(mtf_series(model, pitch_mrad, "closed form", PlotTone::muted, PlotLine::dotted));
    }
    const PlotTone tone = first ? PlotTone::first : PlotTone::second;
    const std::string label = first ? (camera ? "camera" : "simulated sensor") : "simulated twin";
    plot.series.push_back(mtf_series(*found, pitch_mrad, label, tone, first ? PlotLine::solid : PlotLine::dashed));
    if (first) plot.series.push_back(mtf_bars(*found, pitch_mrad, tone, PlotMarker::disc));
    for (const double value : found->mtf) highest = std::max(highest, value);
    plot.x.high = 1 / pitch_mrad;
    beyond_pitch_mrad = pitch_mrad;
  }
  plot.x.label = "Frequency (1/mrad)";
  if (beyond_pitch_mrad > 0)
    plot.bands.push_back({"beyond half a cycle per pixel", PlotTone::muted, {0.5 / beyond_pitch_mrad, std::nullopt}});
  plot.y = {.label = "MTF along " + axis, .low = 0, .high = highest, .ticks = {}};
  return {drawn(plot), "MTF along " + axis + " at '" + edge.place + "', up to one cycle per pixel pitch"};
}

}  // namespace

std::optional<FigurePairs> mtf_figures(const SessionMeasures& measures, bool camera) {
  const auto& side = measures.main ? measures.main : measures.twin;
  if (!side || !side->mtf) return std::nullopt;
  FigurePairs figures;
  for (const EdgeMtf& edge : side->mtf->edges) figures.figures.push_back(mtf_figure(edge, measures, camera));
  return figures;
}

}  // namespace todbench
