// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/vision_page.h"

#include <algorithm>
#include <cmath>

#include "bench/report/number_format.h"
#include "bench/report/plot.h"

namespace todbench {
namespace {

int error_decimals(VisionError error) {
  return error == VisionError::log10 ? 3 : 1;
}

std::string with_sign(double value, int decimals) {
  return (value > 0 ? "+" : "") + shown(value, decimals);
}

/// Model against people; on the diagonal they are equal.
Plot vision_plot(const VisionKind& kind) {
  double low = 1e300, high = 0;
  PlotSeries points{.label = kind.title, .tone = PlotTone::first, .marker = PlotMarker::disc, .points = {}};
  for (const VisionPoint& point : kind.points) {
    points.points.push_back({.x = point.people, .y = point.model, .x_interval = {}, .y_interval = {}});
    low = std::min({low, point.people, point.model});
    high = std::max({high, point.people, point.model});
  }
  low /= 1.25;
  high *= 1.25;
  PlotSeries equal{
      .label = "equal", .tone = PlotTone::muted, .marker = PlotMarker::none, .line = PlotLine::dashed, .points = {}};
  for (const double at : {low, high}) equal.points.push_back({.x = at, .y = at, .x_interval = {}, .y_interval = {}});
  Plot plot;
  plot.id = "vision-" + kind.name;
  std::replace(plot.id.begin(), plot.id.end(), '_', '-');
  plot.title = kind.title;
  plot.description = "The model against people: " + kind.quantity + ".";
  plot.width = 620;
  plot.x = {
      .label = "People: " + kind.quantity, .scale = AxisScale::logarithmic, .low = low, .high = high, .ticks = {}};
  plot.y = {.label = "Model", .scale = AxisScale::logarithmic, .low = low, .high = high, .ticks = {}};
  plot.series = {equal, points};
  return plot;
}

Section summary(const VisionComparison& comparison) {
  Table table;
  table.header = {"Figures of people", "Number", "Unit of error", "Mean", "RMS", "Largest", "Role", "What is wrong"};
  for (const VisionKind& kind : comparison.kinds) {
    const VisionErrors errors = errors_of(kind);
    const int decimals = error_decimals(kind.error);
    table.rows.push_back({plain(kind.title), plain(std::to_string(kind.points.size())), plain(to_string(kind.error)),
                          plain(with_sign(errors.mean, decimals)), plain(shown(errors.rms, decimals)),
                          plain(with_sign(errors.largest, decimals)), plain(to_string(kind.role)),
                          plain(kind.failure)});
  }
  return {"Errors, failures first",
          {note(plain("An error is positive where the model sees better than people.")), std::move(table)}};
}

Section kind_section(const VisionKind& kind) {
  Section section{kind.title, {}};
  if (!kind.failure.empty()) section.blocks.emplace_back(Paragraph{badge(kind.failure, Mood::bad)});
  section.blocks.emplace_back(Paragraph{plain("Source: " + kind.source)});
  if (!kind.remark.empty()) section.blocks.emplace_back(Paragraph{plain(kind.remark)});
  section.blocks.emplace_back(Figure{drawn(vision_plot(kind)), kind.title + ": the model against people."});
  Table table;
  table.header = {"Condition", "People: " + kind.quantity, "Model",
                  "Error [" + std::string(to_string(kind.error)) + "]"};
  for (const VisionPoint& point : kind.points) {
    table.rows.push_back({plain(point.condition), plain(significant(point.people, 3)),
                          plain(significant(point.model, 3)),
                          plain(with_sign(error_of(kind, point), error_decimals(kind.error)))});
  }
  section.blocks.emplace_back(std::move(table));
  return section;
}

Section outside_section(const VisionComparison& comparison) {
  Table table;
  table.header = {"Quantity", "Published", "Here"};
  for (const VisionOutside& figure : comparison.not_comparable)
    table.rows.push_back({plain(figure.quantity), plain(figure.published), plain(figure.reason)});
  return {"Not comparable", {std::move(table)}};
}

}  // namespace

std::string_view to_string(VisionRole role) {
  switch (role) {
    case VisionRole::fitted:
      return "fitted";
    case VisionRole::chosen:
      return "chosen";
    case VisionRole::predicted:
      return "predicted";
    case VisionRole::from_file:
      return "from file";
  }
  return "";
}

std::string_view to_string(VisionError error) {
  switch (error) {
    case VisionError::decibel:
      return "dB";
    case VisionError::log10:
      return "log10";
    case VisionError::points:
      return "points";
  }
  return "";
}

double error_of(const VisionKind& kind, const VisionPoint& point) {
  if (kind.error == VisionError::points) return point.model - point.people;
  return (kind.error == VisionError::decibel ? 20 : 1) * std::log10(point.model / point.people);
}

VisionErrors errors_of(const VisionKind& kind) {
  VisionErrors out;
  double squares = 0;
  for (const VisionPoint& point : kind.points) {
    const double error = error_of(kind, point);
    out.mean += error;
    squares += error * error;
    if (std::abs(error) > std::abs(out.largest)) out.largest = error;
  }
  const auto count = static_cast<double>(kind.points.size());
  out.mean /= count;
  out.rms = std::sqrt(squares / count);
  return out;
}

Document vision_document(const VisionComparison& comparison) {
  const std::string title = comparison.observer + " and figures of people";
  ValueTable settings;
  for (const auto& [name, value] : comparison.settings) settings.values.push_back({name, plain(value)});
  Document document{.title = title,
                    .heading = title,
                    .subtitle = "An observer with an eye against published figures",
                    .page_label = title,
                    .opening = {Paragraph{strong(comparison.statement)}},
                    .sections = {summary(comparison)}};
  for (const VisionKind& kind : comparison.kinds) document.sections.push_back(kind_section(kind));
  document.sections.push_back(outside_section(comparison));
  document.sections.push_back({"Settings", {std::move(settings)}});
  return document;
}

}  // namespace todbench
