// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bench/report/drawing.h"
#include "bench/report/measure_figures.h"

namespace todbench {
namespace {

/// Largest length of a drawn residual, as a share of the picture's width.
constexpr double longest_share = 0.07;

/// Returns the longest residual as a share of the picture's width, at least 1e-6.
double longest_of(const std::optional<MeasureLines>& side) {
  double longest = 1e-6;
  if (!side || !side->geometry) return longest;
  for (const GeometryPlace& place : side->geometry->geometry.places)
    longest = std::max(longest, cv::norm(place.residual_px) / side->geometry->picture.width);
  return longest;
}

/// Returns 1, 2 or 5 times a power of ten, so that the longest residual fits; at least 1.
double magnification(const SessionMeasures& measures) {
  const double most = longest_share / std::max(longest_of(measures.main), longest_of(measures.twin));
  const double decade = std::pow(10, std::floor(std::log10(most)));
  const double step = most >= 5 * decade ? 5 : most >= 2 * decade ? 2 : 1;
  return std::clamp(step * decade, 1.0, 1e4);
}

Figure residual_map(const GeometryMeasure& measure, const std::string& who, const std::string& id, double times) {
  constexpr double width = 430;
  const double scale = width / measure.picture.width;
  Drawing drawing;
  drawing.id = "geometry-" + id;
  drawing.title = "Residuals of the triangles, " + who;
  drawing.width = width, drawing.height = scale * measure.picture.height;
  drawing.frame = {0.5, 0.5, drawing.width - 1, drawing.height - 1};
  const auto place_of = [&](cv::Point2d px) { return Place{(px.x + 0.5) * scale, (px.y + 0.5) * scale}; };
  Polyline lines;
  for (const GeometryPlace& place : measure.geometry.places) {
    lines.runs.push_back({place_of(place.found_px), place_of(place.found_px + times * place.residual_px)});
    drawing.marks.push_back(
        {.shape = Disc{place_of(place.found_px), 2.5}, .pen = Pen::marker, .tone = PlotTone::first});
  }
  drawing.inside.push_back({.shape = std::move(lines), .pen = Pen::curve, .tone = PlotTone::second});
  const std::string caption = fmt::format(
      "Positions of the triangles in the picture of the {} and their residuals after the lens fit, drawn {:g} times as "
      "long",
      who, times);
  drawing.description = caption;
  return {std::move(drawing), caption};
}

}  // namespace

std::optional<FigurePairs> geometry_figures(const SessionMeasures& measures, bool camera) {
  FigurePairs figures;
  const double times = magnification(measures);
  if (measures.main && measures.main->geometry)
    figures.figures.push_back(
        residual_map(*measures.main->geometry, camera ? "camera" : "simulated sensor", "main", times));
  if (measures.twin && measures.twin->geometry)
    figures.figures.push_back(residual_map(*measures.twin->geometry, "simulated twin", "twin", times));
  if (figures.figures.empty()) return std::nullopt;
  return figures;
}

}  // namespace todbench
