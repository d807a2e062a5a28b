// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/cost_figure.h"

#include <algorithm>
#include <array>
#include <span>

#include "acquisition/base/try.h"
#include "bench/report/number_format.h"
#include "bench/report/report_pieces.h"
#include "bench/report/svg.h"

namespace todbench {
namespace {

constexpr double smallest_error_percent = 1e-3;

/// Style of the points of one knob.
struct KnobStyle {
  std::string_view knob, label;
  PlotTone tone;
  PlotMarker marker;
  PlotLine line;
};
constexpr std::array result_styles{
    KnobStyle{"draws", "noise draws", PlotTone::third, PlotMarker::bar, PlotLine::dashed},
    KnobStyle{"trials", "trials", PlotTone::muted, PlotMarker::square, PlotLine::dotted},
    KnobStyle{"tolerance", "tolerance, all effects", PlotTone::second, PlotMarker::square, PlotLine::solid},
    KnobStyle{"planner", "planner's effects", PlotTone::muted, PlotMarker::disc, PlotLine::none},
};
constexpr std::array knob_styles{
    KnobStyle{"wavelengths", "wavelengths", PlotTone::first, PlotMarker::square, PlotLine::dashed},
    KnobStyle{"phases", "phases", PlotTone::second, PlotMarker::disc, PlotLine::solid},
    KnobStyle{"wrap", "wrapped signal", PlotTone::third, PlotMarker::bar, PlotLine::dotted},
    KnobStyle{"band", "truncated band", PlotTone::muted, PlotMarker::square, PlotLine::solid},
};

/// Smallest range that contains all values, with a margin.
struct Span {
  double low = 0, high = 0;
  void add(double value) {
    low = low > 0 ? std::min(low, value) : value;
    high = std::max(high, value);
  }
  [[nodiscard]] PlotAxis axis(std::string label, double margin) const {
    return {.label = std::move(label),
            .scale = AxisScale::logarithmic,
            .low = (low > 0 ? low : 0.1) / margin,
            .high = (high > 0 ? high : 1) * margin,
            .ticks = {}};
  }
};

double drawn_error(const CostPoint& point) {
  return std::max(point.total_percent(), smallest_error_percent);
}

Plot plot_of(const CostFrontier& frontier, std::span<const KnobStyle> styles, std::string y_label) {
  Plot plot;
  plot.height = 360;
  Span x, y;
  PlotSeries chosen{.label = "chosen", .tone = PlotTone::first, .marker = PlotMarker::disc, .points = {}};
  for (const KnobStyle& style : styles) {
    PlotSeries series{.label = std::string(style.label),
                      .tone = style.tone,
                      .marker = style.marker,
                      .line = style.line,
                      .legend_line = PlotLine::none,
                      .points = {}};
    for (const CostPoint& point : frontier.points) {
      if (point.knob != style.knob || !point.measured()) continue;
      const double seconds = std::max(*point.wall_s, 1e-6);
      x.add(seconds);
      y.add(drawn_error(point));
      (point.chosen ? chosen : series)
          .points.push_back({.x = seconds, .y = drawn_error(point), .x_interval = {}, .y_interval = {}});
    }
    if (!series.points.empty()) plot.series.push_back(std::move(series));
  }
  if (!chosen.points.empty()) {
    const PlotPoint& at = chosen.points.front();
    plot.references.push_back(
        {.y = *at.y, .label = "chosen: " + significant(*at.y, 2) + " % in " + significant(*at.x, 2) + " s"});
    plot.series.push_back(std::move(chosen));
  }
  plot.x = x.axis("Computing time (s)", 1.4);
  plot.y = y.axis(std::move(y_label), 1.8);
  return plot;
}

Table point_table(const CostFrontier& frontier) {
  Table rows;
  rows.caption = "Measured settings of the computation";
  rows.header = {"Knob", "Setting", "Computing time (s)", "Error of acuity (%)", "Standard error (%)", "Remark"};
  for (const CostPoint& point : frontier.points) {
    const auto number = [&](const std::optional<double>& value) {
      return value ? plain(significant(*value, 2)) : missing(point.measured() ? "not stated" : "not measured");
    };
    std::string remark = point.not_measured;
    if (point.best) remark = "best";
    if (point.chosen) remark = remark.empty() ? "chosen" : "chosen; " + remark;
    rows.rows.push_back({plain(point.knob), plain(point.setting), number(point.wall_s), number(point.error_percent),
                         point.paired ? missing("same random numbers") : number(point.standard_error_percent),
                         plain(remark)});
  }
  return rows;
}

}  // namespace

Plot cost_result_plot(const CostFrontier& frontier) {
  Plot plot = plot_of(frontier, result_styles, "Error with standard error (%)");
  plot.id = "cost-result";
  plot.title = "Cost of accuracy in computing time";
  plot.description =
      "Error of the 75 % acuity against the reference, including the standard error, over computing time: tolerances, "
      "noise draws, trials and the choices of the planner.";
  return plot;
}

Plot cost_knob_plot(const CostFrontier& frontier) {
  Plot plot = plot_of(frontier, knob_styles, "Error of this knob alone (%)");
  plot.id = "cost-knob";
  plot.title = "Cost of each numerical knob in computing time";
  plot.description =
      "Error of the 75 % acuity by one knob alone, the others at the reference level, over computing time: "
      "wavelengths, phases, wrapped signal, truncated band.";
  return plot;
}

Result<std::string> cost_document(const CostFrontier& frontier) {
  std::vector<Drawing> drawings;
  for (const Plot& plot : {cost_result_plot(frontier), cost_knob_plot(frontier)}) {
    TODBENCH_TRY(auto drawing, drawn(plot));
    drawings.push_back(std::move(drawing));
  }
  return svg_document(drawings);
}

Section cost_section(const CostFrontier& frontier) {
  Section section{"Cost of accuracy", {}};
  section.blocks.emplace_back(Paragraph{plain(
      "Thresholds of the simulated sensor, computed with faster and slower settings, against the reference level (" +
      std::to_string(frontier.reference_draws) + " draws per size, " + significant(frontier.reference_s, 2) +
      " s, standard error " + significant(frontier.reference_standard_error_percent, 2) +
      " %). Measured on one core of the machine that wrote this session.")});
  section.blocks.emplace_back(
      Figure{drawn(cost_result_plot(frontier)),
             "Error of the 75 % acuity, the largest over the contrasts, with its standard error, over computing time: "
             "that of one thread on an idle machine, the smaller of wall time and processor time. A setting is marked "
             "as best in the table if no other measured setting is both faster and more accurate."});
  section.blocks.emplace_back(Figure{
      drawn(cost_knob_plot(frontier)),
      "Error by one numerical knob alone over the same time, with the other knobs at the reference level and the "
      "same random numbers as its reference. Errors below 0.001 % are drawn at 0.001 %."});
  section.blocks.emplace_back(point_table(frontier));
  if (!frontier.notes.empty()) section.blocks.emplace_back(list_of(frontier.notes));
  return section;
}

}  // namespace todbench
