// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bench/report/drawing.h"
#include "bench/report/measure_figures.h"
#include "bench/report/plot.h"

namespace todbench {
namespace {

constexpr double percent = 100;

/// Loss of apertures, or gain of spots, in percent of the reference.
Estimate in_percent(const SourceSizePoint& point) {
  if (point.spot) return {percent * point.ratio.value, percent * point.ratio.low, percent * point.ratio.high};
  return {percent * (1 - point.ratio.value), percent * (1 - point.ratio.high), percent * (1 - point.ratio.low)};
}

void add_side(Plot& plot, const SourceSize& effect, const std::string& who, bool first) {
  const PlotTone tone = first ? PlotTone::first : PlotTone::second;
  PlotSeries curve{.label = who + ", fitted halo, aperture",
                   .tone = tone,
                   .marker = PlotMarker::none,
                   .line = first ? PlotLine::solid : PlotLine::dashed,
                   .points = {}};
  for (std::size_t i = 0; i < effect.size_px.size(); ++i) {
    const Estimate& ratio = effect.ratio[i];
    // Intervals of every third point: the curve is dense.
    const bool shown = first && i % 3 == 0;
    curve.points.push_back(
        {.x = effect.size_px[i],
         .y = percent * (1 - ratio.value),
         .x_interval = {},
         .y_interval = shown ? Interval{percent * (1 - ratio.high), percent * (1 - ratio.low)} : Interval{}});
  }
  plot.series.push_back(std::move(curve));
  for (const bool spot : {false, true}) {
    PlotSeries points{.label = who + (spot ? ", opaque spot (inverse)" : ", aperture (direct)"),
                      .tone = tone,
                      .marker = spot ? PlotMarker::square : PlotMarker::disc,
                      .line = PlotLine::none,
                      .points = {},
                      .dodge_px = first ? 0.0 : 3.0};
    for (const SourceSizePoint& point : effect.points) {
      if (point.spot != spot) continue;
      const Estimate share = in_percent(point);
      points.points.push_back(
          {.x = point.size_px, .y = share.value, .x_interval = {}, .y_interval = {share.low, share.high}});
      plot.y.low = std::min(plot.y.low, 1.1 * share.low);
      plot.y.high = std::max(plot.y.high, 1.1 * share.high);
    }
    if (!points.points.empty()) plot.series.push_back(std::move(points));
  }
  for (const Estimate& ratio : effect.ratio) plot.y.high = std::max(plot.y.high, percent * 1.1 * (1 - ratio.low));
}

}  // namespace

std::optional<FigurePairs> source_size_figures(const SessionMeasures& measures, bool camera) {
  const bool main = measures.main && measures.main->source, twin = measures.twin && measures.twin->source;
  if (!main && !twin) return std::nullopt;
  Plot plot;
  plot.id = "source-size";
  plot.title = "Size-of-source effect";
  plot.description =
      "Signal that a small source loses, and an opaque spot gains, against its size, in percent of a "
      "large source, with 95 % intervals";
  plot.width = 560, plot.height = 390;
  const double reference = (main ? measures.main : measures.twin)->source->effect.reference_px;
  plot.x = {.label = "Side of the square (px)", .low = 0, .high = 1.05 * reference, .ticks = {}};
  plot.y = {.label = "Loss or gain (%)", .low = 0, .high = 0.5, .ticks = {}};
  if (twin) add_side(plot, measures.twin->source->effect, "twin", !main);
  if (main) add_side(plot, measures.main->source->effect, camera ? "camera" : "sensor", true);
  FigurePairs figures;
  figures.figures.push_back(
      {drawn(plot),
       "Size-of-source effect: share of the signal that a square aperture loses, and an opaque spot gains, "
       "against the reference aperture, with 95 % intervals"});
  return figures;
}

}  // namespace todbench
