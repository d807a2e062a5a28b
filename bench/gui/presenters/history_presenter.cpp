// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/history_presenter.h"
#include "acquisition/base/normal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace todbench {
namespace {

/// Returns an axis that contains these numbers with a margin; never empty.
PlotAxis axis_around(std::string label, std::vector<double> numbers) {
  const auto [low, high] = std::minmax_element(numbers.begin(), numbers.end());
  const double room = *high > *low ? 0.08 * (*high - *low) : std::max(std::abs(*high) * 0.1, 1.0);
  return {.label = std::move(label), .low = *low - room, .high = *high + room, .ticks = {}};
}

PlotAxis time_axis(const HistorySeries& series) {
  const double first = series.values.front().days, last = series.values.back().days;
  // At least a day to either side, so that a date is on the axis.
  const double room = std::max(1.0, 0.04 * (last - first));
  return {.label = "Date (UTC)", .scale = AxisScale::dates, .low = first - room, .high = last + room, .ticks = {}};
}

Plot values_plot(const HistorySeries& series, const std::optional<ControlChart>& chart) {
  PlotSeries values{.label = "value, 95 % interval", .line = PlotLine::solid, .points = {}};
  std::vector<double> numbers;
  for (const ChartValue& value : series.values) {
    const double half = normal_z95 * value.u;
    const double low = shown_value(series, value.value - half), high = shown_value(series, value.value + half);
    values.points.push_back(
        {.x = value.days, .y = shown_value(series, value.value), .x_interval = {}, .y_interval = {low, high}});
    numbers.insert(numbers.end(), {low, high});
  }
  Plot plot;
  plot.id = "history-values";
  plot.title = title_of(series).toStdString();
  plot.description = "values of the unit over time, with 95 % intervals";
  plot.x = time_axis(series);
  if (chart) {
    const double reference = shown_value(series, chart->reference);
    plot.references.push_back({reference, "reference"});
    numbers.push_back(reference);
  }
  plot.y = axis_around(title_of(series).toStdString() + (series.unit_text.empty() ? "" : " (" + series.unit_text + ")"),
                       numbers);
  plot.series.push_back(std::move(values));
  return plot;
}

/// Draws lines of a chart in standard deviations over the same time.
Plot standard_plot(const HistorySeries& series, const ControlChart& chart, std::string id, std::string label,
                   const std::vector<std::pair<PlotSeries, double (*)(const ChartPoint&)>>& lines) {
  Plot plot;
  plot.id = std::move(id);
  plot.title = label;
  plot.description = label + " of the unit over time";
  plot.x = time_axis(series);
  std::vector<double> numbers{0};
  for (const auto& [style, value] : lines) {
    PlotSeries line = style;
    for (const ChartPoint& point : chart.points) {
      const double y = value(point);
      line.points.push_back({.x = point.days, .y = y, .x_interval = {}, .y_interval = {}});
      numbers.push_back(y);
    }
    plot.series.push_back(std::move(line));
  }
  plot.y = axis_around(std::move(label), numbers);
  return plot;
}

PlotSeries limit_line(std::string label) {
  return {.label = std::move(label),
          .tone = PlotTone::muted,
          .marker = PlotMarker::none,
          .line = PlotLine::dashed,
          .points = {}};
}

PlotSeries chart_line(std::string label, PlotTone tone) {
  return {.label = std::move(label), .tone = tone, .line = PlotLine::solid, .points = {}};
}

}  // namespace

QString title_of(const HistorySeries& series) {
  return QString::fromStdString(series.measure + (series.condition.empty() ? "" : " " + series.condition));
}

QString unit_of(const HistorySeries& series) {
  const HistoryUnit& unit = series.unit;
  std::string text = unit.model.empty() ? unit.vendor : unit.model;
  if (!unit.serial.empty()) text += ", serial number " + unit.serial;
  if (!unit.lens.empty()) text += ", " + unit.lens;
  return QString::fromStdString(text);
}

HistoryChart history_chart(const HistorySeries& series) {
  const auto chart = control_chart(series.values, {});
  HistoryChart shown{.values = values_plot(series, chart), .ewma = {}, .cusum = {}, .remark = {}};
  if (!chart) {
    shown.remark =
        QString("Values so far: %1. The charts need more than %2 values, because the first %2 are the reference.")
            .arg(series.values.size())
            .arg(ChartDesign{}.reference_values);
    return shown;
  }
  shown.ewma =
      standard_plot(series, *chart, "history-ewma", "EWMA (standard deviations)",
                    {{limit_line("limit"), [](const ChartPoint& point) { return point.ewma_limit; }},
                     {limit_line(""), [](const ChartPoint& point) { return -point.ewma_limit; }},
                     {chart_line("EWMA", PlotTone::first), [](const ChartPoint& point) { return point.ewma; }}});
  shown.cusum = standard_plot(
      series, *chart, "history-cusum", "CUSUM (standard deviations)",
      {{limit_line("limit"), [](const ChartPoint&) { return ChartDesign{}.cusum_h; }},
       {chart_line("upwards", PlotTone::first), [](const ChartPoint& point) { return point.cusum_up; }},
       {chart_line("downwards", PlotTone::second), [](const ChartPoint& point) { return point.cusum_down; }}});
  shown.remark = chart->signalled() ? "✗ The last check exceeds a limit of the charts: the unit has changed."
                                    : "✓ Within the limits of both charts.";
  return shown;
}

HistoryPresenter::HistoryPresenter(std::filesystem::path index, QObject* parent)
    : QObject(parent), index_(std::move(index)) {}

void HistoryPresenter::add_sessions(const std::filesystem::path& folder) {
  const auto folders = session_folders_below(folder);
  auto index = folders ? HistoryIndex::open(index_) : tl::unexpected(folders.error());
  if (!index) {
    trouble_ = QString::fromStdString(index.error().message);
    emit changed();
    return;
  }
  for (const auto& one : *folders) {
    const auto session = verified_session(*index, one);
    if (session) (void)index->add(*session);
  }
  refresh();
}

void HistoryPresenter::refresh() {
  series_.clear();
  trouble_.clear();
  std::error_code none;
  const auto nothing = QString("The history is empty. Add the sessions of this folder.");
  if (!std::filesystem::exists(index_, none)) {
    trouble_ = nothing;
    emit changed();
    return;
  }
  const auto index = HistoryIndex::open(index_);
  auto series = index ? history_series(*index, "", "") : tl::unexpected(index.error());
  if (series) {
    series_ = *std::move(series);
    if (series_.empty()) trouble_ = nothing;
  } else {
    trouble_ = QString::fromStdString(series.error().message);
  }
  emit changed();
}

}  // namespace todbench
