// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/reproduction_page.h"

#include <algorithm>
#include <cmath>

#include "bench/report/number_format.h"
#include "bench/report/plot.h"
#include "bench/report/report_pieces.h"

namespace todbench {
namespace {

bool percentage(const ReproducedFigure& figure) {
  return figure.kind != FigureKind::amount;
}

bool among(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

RichText in_its_unit(const ReproducedFigure& figure, double value, const Interval& ci95) {
  const int decimals = percentage(figure) ? 0 : std::min(1, decimals_for(value, ci95));
  std::string text = shown(value, decimals);
  if (figure.kind == FigureKind::change && value > 0) text.insert(0, 1, '+');
  if (ci95.low && ci95.high) text += " [" + shown(*ci95.low, decimals) + ", " + shown(*ci95.high, decimals) + "]";
  return unbroken(text + " " + figure.unit);
}

RichText ours(const ReproducedFigure& figure) {
  return figure.value ? in_its_unit(figure, *figure.value, figure.ci95) : missing("not found");
}

RichText graded(const ReproducedFigure& figure) {
  return figure.graded_value ? in_its_unit(figure, *figure.graded_value, figure.graded_ci95) : plain("");
}

Section figures_section(const Reproduction& reproduction) {
  Table rows;
  rows.header = {"Quantity",   "Published",  "Computed here, 95 %", "By graded answers, 95 %",
                 "Difference", "Explanation"};
  for (const auto& figure : reproduction.figures) {
    rows.rows.push_back({plain(figure.quantity), text_or_missing(figure.published, "not stated in the paper"),
                         ours(figure), graded(figure), plain(difference_in_words(figure)), plain(figure.remark)});
  }
  return {"Published and computed values", {std::move(rows)}};
}

Plot curve_plot(const Reproduction& reproduction, const std::string& id, const std::string& title,
                const std::vector<std::string>& sensors) {
  Plot plot;
  plot.id = id;
  plot.title = title;
  plot.description = "Acuity against contrast, both logarithmic, for each sensor and observer.";
  plot.x = {.label = "Acuity 1/S75 (1/mrad)", .scale = AxisScale::logarithmic, .low = 0.15, .high = 1.1, .ticks = {}};
  plot.y = {.label = "Contrast (K)", .scale = AxisScale::logarithmic, .low = 0.1, .high = 30, .ticks = {}};
  const PlotTone tones[] = {PlotTone::first, PlotTone::second, PlotTone::third};
  for (const auto& t : reproduction.thresholds) {
    const auto sensor = std::find(sensors.begin(), sensors.end(), t.sensor);
    if (sensor == sensors.end()) continue;
    const std::string label = t.sensor + ", " + t.observer;
    auto series = std::find_if(plot.series.begin(), plot.series.end(), [&](const auto& s) { return s.label == label; });
    if (series == plot.series.end()) {
      const bool model = t.observer == reproduction.model_observer;
      PlotSeries added;
      added.label = label;
      added.tone = tones[(sensor - sensors.begin()) % 3];
      added.marker = model ? PlotMarker::disc : PlotMarker::square;
      added.line = model ? PlotLine::solid : PlotLine::dashed;
      series = plot.series.insert(plot.series.end(), added);
    }
    PlotPoint point;
    point.x = t.acuity_per_mrad;
    point.x_interval = t.ci95;
    point.y = t.delta_t_k;
    series->points.push_back(point);
  }
  return plot;
}

Plot range_plot(const Reproduction& reproduction) {
  Plot plot;
  plot.id = "ranges";
  plot.title = "Probability of identification against range";
  plot.description = "Identification falls with range; the microscan sensor reaches farther.";
  plot.x = {.label = "Range (m)", .low = 0, .high = 1400, .ticks = {}};
  plot.y = {.label = "Fraction correct", .low = 0, .high = 1, .ticks = {}};
  plot.references.push_back({0.75, "75 %"});
  const PlotTone tones[] = {PlotTone::first, PlotTone::second, PlotTone::third, PlotTone::muted};
  std::size_t index = 0;
  for (const auto& range : reproduction.ranges) {
    if (range.observer != reproduction.model_observer) continue;  // as in the paper; four curves stay distinct
    PlotSeries series;
    series.label = range.sensor + ", " + range.observer;
    series.tone = tones[index++ % 4];
    series.marker = PlotMarker::none;
    series.line = among(reproduction.cameras, range.sensor) ? PlotLine::dashed : PlotLine::solid;
    for (const auto& point : range.prediction.curve) {
      if (point.range_m > 1400) break;
      PlotPoint shown_point;
      shown_point.x = point.range_m;
      shown_point.y = point.probability;
      series.points.push_back(shown_point);
    }
    plot.series.push_back(series);
  }
  // 75 % at 450 and 700 m, about 80 % at 400 and 640 m.
  PlotSeries published;
  published.label = "published";
  published.tone = PlotTone::muted;
  published.marker = PlotMarker::square;
  published.line = PlotLine::none;
  for (const auto& [range_m, fraction] :
       {std::pair(400.0, 0.8), std::pair(450.0, 0.75), std::pair(640.0, 0.8), std::pair(700.0, 0.75)}) {
    PlotPoint point;
    point.x = range_m;
    point.y = fraction;
    published.points.push_back(point);
  }
  plot.series.push_back(published);
  return plot;
}

Section thresholds_section(const Reproduction& reproduction) {
  Table rows;
  rows.header = {"Sensor", "Observer", "Contrast [K]", "Acuity [1/mrad], 95 %", "Method"};
  for (const auto& t : reproduction.thresholds) {
    rows.rows.push_back({plain(t.sensor), plain(t.observer), plain(stated(t.delta_t_k)),
                         unbroken(with_interval(t.acuity_per_mrad, t.ci95)), plain(t.method)});
    if (!t.graded_acuity_per_mrad) continue;
    rows.rows.push_back({plain(t.sensor), plain(t.observer), plain(stated(t.delta_t_k)),
                         unbroken(with_interval(t.graded_acuity_per_mrad, t.graded_ci95)), plain(t.graded_method)});
  }
  return {"All thresholds", {std::move(rows)}};
}

Section ranges_section(const Reproduction& reproduction) {
  Table rows;
  rows.header = {"Sensor", "Observer", "75 % range [m], 95 %", "Remark"};
  for (const auto& r : reproduction.ranges) {
    rows.rows.push_back({plain(r.sensor), plain(r.observer),
                         unbroken(with_interval(r.prediction.r75_m, r.prediction.r75_ci95_m)),
                         plain(r.prediction.reason)});
  }
  return {"Ranges",
          {Figure{drawn(range_plot(reproduction)),
                  "Fraction of correct identifications of a small craft against range, computed from the TOD curves, "
                  "and the four points stated in the paper."},
           std::move(rows)}};
}

Section curves_section(const Reproduction& reproduction) {
  const auto observers =
      curve_plot(reproduction, "observers", "Observers on the simulated sensors", reproduction.simulated_sensors);
  std::vector<std::string> beside = reproduction.simulated_sensors;
  if (!beside.empty()) beside.resize(1);
  beside.insert(beside.end(), reproduction.cameras.begin(), reproduction.cameras.end());
  const auto sensors = curve_plot(reproduction, "cameras", "Emulated camera and simulation", beside);
  return {"TOD curves",
          {Figure{drawn(observers),
                  "Both observers on the simulated sensor, without and with 2 x 2 microscan (Figure 10 of the paper)."},
           Figure{drawn(sensors),
                  "Emulated camera, with single and with super-resolved pictures, and simulated sensor (Figure 9 of "
                  "the paper)."}}};
}

Section settings_section(const Reproduction& reproduction) {
  ValueTable table;
  for (const auto& [name, value] : reproduction.settings) table.values.push_back({name, plain(value)});
  return {"Settings", {std::move(table)}};
}

}  // namespace

std::string difference_in_words(const ReproducedFigure& figure) {
  if (!figure.published_value || !figure.value) return "";
  const double difference = *figure.value - *figure.published_value;
  if (percentage(figure)) return shown(difference, 0) + " points";
  return shown(100 * difference / *figure.published_value, 0) + " %";
}

Document reproduction_document(const Reproduction& reproduction) {
  return {.title = reproduction.title,
          .heading = reproduction.title,
          .subtitle = reproduction.source,
          .page_label = reproduction.title,
          .opening = {},
          .sections = {figures_section(reproduction),
                       curves_section(reproduction),
                       ranges_section(reproduction),
                       thresholds_section(reproduction),
                       {"Assumptions not stated in the paper", {list_of(reproduction.assumptions)}},
                       settings_section(reproduction)}};
}

}  // namespace todbench
