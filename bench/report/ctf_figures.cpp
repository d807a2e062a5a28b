// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <string>
#include <utility>

#include "bench/report/drawing.h"
#include "bench/report/measure_figures.h"
#include "bench/report/plot.h"

namespace todbench {
namespace {

/// Style of a curve of one side.
struct CtfPen {
  std::string label;
  PlotTone tone = PlotTone::first;
  PlotMarker marker = PlotMarker::disc;
  PlotLine line = PlotLine::solid;
  double dodge_px = 0;
};

PlotSeries ctf_series(const CtfMeasure& side, EdgeAxis axis, Estimate BarsCtf::*phase, const CtfPen& pen) {
  PlotSeries series{.label = pen.label,
                    .tone = pen.tone,
                    .marker = pen.marker,
                    .line = pen.line,
                    .points = {},
                    .dodge_px = pen.dodge_px};
  for (const BarsCtf& group : side.bars.groups) {
    if (group.axis != axis) continue;
    const Estimate& found = group.*phase;
    series.points.push_back({.x = group.frequency_per_pitch / side.pitch_mrad,
                             .y = std::max(0.0, found.value),
                             .x_interval = {},
                             .y_interval = {std::max(0.0, found.low), std::max(0.0, found.high)}});
  }
  return series;
}

/// Adds the closed form as lines without markers behind the other curves, if there is one.
void add_model(Plot& plot, const CtfMeasure& side, EdgeAxis axis) {
  for (const auto& [phase, label] : {std::pair(&BarsModel::best, "closed form"), std::pair(&BarsModel::worst, "")}) {
    PlotSeries series{
        .label = label, .tone = PlotTone::muted, .marker = PlotMarker::none, .line = PlotLine::dotted, .points = {}};
    for (const BarsCtf& group : side.bars.groups) {
      if (group.axis != axis || !group.model) continue;
      series.points.push_back({.x = group.frequency_per_pitch / side.pitch_mrad,
                               .y = std::max(0.0, *group.model.*phase),
                               .x_interval = {},
                               .y_interval = {}});
    }
    if (!series.points.empty()) plot.series.push_back(std::move(series));
  }
}

void add_side(Plot& plot, const CtfMeasure& side, EdgeAxis axis, const std::string& who, bool first) {
  const PlotTone tone = first ? PlotTone::first : PlotTone::second;
  const double dodge = first ? 0 : 3;
  const PlotLine best = first ? PlotLine::solid : PlotLine::dashed;
  plot.series.push_back(
      ctf_series(side, axis, &BarsCtf::worst, {who + ", worst phase", tone, PlotMarker::square, best, dodge}));
  plot.series.push_back(
      ctf_series(side, axis, &BarsCtf::best, {who + ", best phase", tone, PlotMarker::disc, best, dodge}));
}

Figure ctf_figure(EdgeAxis axis, const SessionMeasures& measures, bool camera) {
  const std::string name(to_string(axis));
  Plot plot;
  plot.id = "ctf-" + name;
  plot.title = "CTF along " + name;
  plot.description =
      "Modulation of four bars over spatial frequency at the best and the worst sampling phase, with 95 % intervals";
  plot.width = 430, plot.height = 390;
  plot.x = {.label = "Frequency (1/mrad)", .low = 0, .high = 0, .ticks = {}};
  plot.y = {.label = "CTF along " + name, .low = 0, .high = 1.1, .ticks = {}};
  const auto reach = [&](const CtfMeasure& side) {
    plot.bands = {{"beyond half a cycle per pixel", PlotTone::muted, {0.5 / side.pitch_mrad, std::nullopt}}};
    for (const BarsCtf& group : side.bars.groups) {
      plot.x.high = std::max(plot.x.high, 1.15 * group.frequency_per_pitch / side.pitch_mrad);
      plot.y.high = std::max(plot.y.high, 1.05 * group.best.high);
    }
  };
  if (measures.twin && measures.twin->ctf) {
    reach(*measures.twin->ctf);
    add_model(plot, *measures.twin->ctf, axis);
    add_side(plot, *measures.twin->ctf, axis, "twin", !(measures.main && measures.main->ctf));
  }
  if (measures.main && measures.main->ctf) {
    reach(*measures.main->ctf);
    add_model(plot, *measures.main->ctf, axis);
    add_side(plot, *measures.main->ctf, axis, camera ? "camera" : "sensor", true);
  }
  // The frequencies of wide bars may all lie below the band.
  if (!plot.bands.empty() && plot.bands.front().x.low >= plot.x.high) plot.bands.clear();
  return {drawn(plot), "CTF of four bars along " + name +
                           ": modulation at the best and the worst sampling phase, with 95 % intervals"};
}

}  // namespace

std::optional<FigurePairs> ctf_figures(const SessionMeasures& measures, bool camera) {
  const auto& side = measures.main && measures.main->ctf ? measures.main : measures.twin;
  if (!side || !side->ctf) return std::nullopt;
  FigurePairs figures;
  for (const EdgeAxis axis : {EdgeAxis::x, EdgeAxis::y}) {
    const auto& groups = side->ctf->bars.groups;
    if (std::any_of(groups.begin(), groups.end(), [&](const BarsCtf& group) { return group.axis == axis; }))
      figures.figures.push_back(ctf_figure(axis, measures, camera));
  }
  return figures;
}

}  // namespace todbench
