// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "bench/report/drawing.h"
#include "bench/report/measure_figures.h"
#include "bench/report/number_format.h"
#include "bench/report/plot.h"
#include "bench/report/report_pieces.h"

namespace todbench {
namespace {

/// Style of the thresholds of one side.
struct MrtdPen {
  std::string label;
  PlotTone tone = PlotTone::first;
  PlotMarker marker = PlotMarker::disc;
  PlotLine line = PlotLine::solid;
  double dodge_px = 0;
};

/// Points of one axis in a plot of mrtd over frequency, and the range of contrasts that they need.
struct MrtdPlot {
  Plot plot;
  double low = 1e300, high = 0;

  void add(const MrtdMeasure& side, EdgeAxis axis, const MrtdPen& pen) {
    PlotSeries found{.label = pen.label,
                     .tone = pen.tone,
                     .marker = pen.marker,
                     .line = pen.line,
                     .points = {},
                     .dodge_px = pen.dodge_px};
    PlotSeries best{.label = pen.label + ", best phase",
                    .tone = pen.tone,
                    .marker = PlotMarker::none,
                    .line = PlotLine::dotted,
                    .points = {}};
    for (const MrtdPoint& point : side.bars) {
      if (point.axis != axis) continue;
      const double f = point.frequency_per_pitch / side.pitch_mrad;
      plot.x.high = std::max(plot.x.high, 1.1 * f);
      if (point.threshold_k)
        found.points.push_back({.x = f, .y = point.threshold_k, .x_interval = {}, .y_interval = point.ci95});
      if (point.best_phase_k)
        best.points.push_back({.x = f, .y = point.best_phase_k, .x_interval = {}, .y_interval = {}});
      for (const auto& end : {point.threshold_k, point.ci95.low, point.ci95.high, point.best_phase_k}) {
        if (end && *end > 0) low = std::min(low, *end), high = std::max(high, *end);
      }
    }
    plot.bands = {{"beyond Nyquist", PlotTone::muted, {0.5 / side.pitch_mrad, std::nullopt}}};
    if (!best.points.empty()) plot.series.push_back(std::move(best));
    if (!found.points.empty()) plot.series.push_back(std::move(found));
  }
};

std::optional<Figure> mrtd_figure(EdgeAxis axis, const SessionMeasures& measures, bool camera) {
  const std::string name(to_string(axis));
  MrtdPlot made;
  Plot& plot = made.plot;
  plot.id = "mrtd-" + name;
  plot.title = "MRTD along " + name;
  plot.description =
      "Contrast for 75 % correct decisions between four and five bars over spatial frequency, with 95 % "
      "intervals";
  plot.width = 430, plot.height = 390;
  plot.x = {.label = "Frequency (1/mrad)", .low = 0, .high = 0, .ticks = {}};
  plot.y = {.label = "MRTD along " + name + " (K)", .scale = AxisScale::logarithmic, .low = 0, .high = 0, .ticks = {}};
  const bool both = measures.main && measures.main->mrtd;
  if (measures.twin && measures.twin->mrtd)
    made.add(*measures.twin->mrtd, axis,
             {"twin", both ? PlotTone::second : PlotTone::first, PlotMarker::square, PlotLine::dashed, both ? 3.0 : 0});
  if (both)
    made.add(*measures.main->mrtd, axis,
             {camera ? "camera" : "sensor", PlotTone::first, PlotMarker::disc, PlotLine::solid, 0});
  if (plot.series.empty()) return std::nullopt;
  plot.y.low = made.low / 1.3, plot.y.high = 1.3 * made.high;
  if (!plot.bands.empty() && plot.bands.front().x.low >= plot.x.high) plot.bands.clear();
  return Figure{drawn(plot), "MRTD along " + name +
                                 ": half difference of both polarities, with 95 % intervals over set-ups; dotted: at "
                                 "the best sampling phase (MTDP-like)"};
}

RichText half_difference_cell(const MrtdPoint& point) {
  return interval_or_missing(point.threshold_k, point.threshold_k ? point.ci95 : Interval{}, point.reason);
}

/// Adds a column with the spread; without an observer with an eye there is none.
void add_spread(Table& table, const std::vector<MrtdPoint>& points) {
  if (std::ranges::none_of(points, [](const MrtdPoint& point) { return point.spread_k.has_value(); })) return;
  table.header.emplace_back("Spread over the open parameters (K)");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& spread = points[i].spread_k;
    table.rows[i].push_back(spread ? plain(significant(spread->first, 3) + " to " + significant(spread->second, 3))
                                   : missing("none"));
  }
}

RichText offset_cell(const MrtdPoint& point) {
  if (!point.positive_k || !point.negative_k) return plain("–");
  return plain(significant(0.5 * (*point.positive_k + *point.negative_k), 2));
}

}  // namespace

RichText contrast_cell(const std::optional<double>& value) {
  return value ? plain(significant(*value, 3)) : missing("none");
}

std::optional<FigurePairs> mrtd_figures(const SessionMeasures& measures, bool camera) {
  FigurePairs figures;
  for (const EdgeAxis axis : {EdgeAxis::x, EdgeAxis::y}) {
    if (auto figure = mrtd_figure(axis, measures, camera)) figures.figures.push_back(*std::move(figure));
  }
  if (figures.figures.empty()) return std::nullopt;
  return figures;
}

std::vector<Table> mrtd_tables(const MrtdMeasure& mrtd, const std::string& who) {
  Table bars{.caption = fmt::format("MRTD of the {}: observer {}, {} set-ups, {} frames at each contrast", who,
                                    mrtd.observer, mrtd.set_ups, mrtd.frames),
             .header = {"f (cycles/mrad)", "f / Nyquist", "Axis", "ΔT positive (K)", "ΔT negative (K)", "Offset (K)",
                        "MRTD, half difference (K), 95 %", "Mean of the axes (K)", "Best phase (K)"},
             .rows = {}};
  for (const MrtdPoint& point : mrtd.bars) {
    const auto other = std::ranges::find_if(mrtd.bars, [&](const MrtdPoint& one) {
      return one.axis != point.axis && std::abs(one.frequency_per_pitch / point.frequency_per_pitch - 1) < 0.02;
    });
    const bool mean = other != mrtd.bars.end() && other->threshold_k && point.threshold_k;
    bars.rows.push_back({plain(significant(point.frequency_per_pitch / mrtd.pitch_mrad, 3)),
                         plain(significant(2 * point.frequency_per_pitch, 3)),
                         plain(std::string(to_string(point.axis))), contrast_cell(point.positive_k),
                         contrast_cell(point.negative_k), offset_cell(point), half_difference_cell(point),
                         mean ? plain(significant(0.5 * (*point.threshold_k + *other->threshold_k), 3)) : plain("–"),
                         contrast_cell(point.best_phase_k)});
  }
  add_spread(bars, mrtd.bars);
  std::vector<Table> tables{std::move(bars)};
  if (mrtd.spots.empty()) return tables;
  Table spots{.caption = fmt::format("MDTD of the {}: square spots against an empty part of the plate", who),
              .header = {"Side (mrad)", "Side (px)", "ΔT positive (K)", "ΔT negative (K)", "Offset (K)",
                         "MDTD, half difference (K), 95 %"},
              .rows = {}};
  for (const MrtdPoint& point : mrtd.spots) {
    spots.rows.push_back({plain(significant(point.size_px * mrtd.pitch_mrad, 3)), plain(significant(point.size_px, 3)),
                          contrast_cell(point.positive_k), contrast_cell(point.negative_k), offset_cell(point),
                          half_difference_cell(point)});
  }
  add_spread(spots, mrtd.spots);
  tables.push_back(std::move(spots));
  return tables;
}

}  // namespace todbench
