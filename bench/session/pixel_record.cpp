// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/pixel_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "bench/picture_files/encoded_picture.h"
#include "bench/session/measure_row.h"
#include "bench/text/base64.h"
#include "tod/measures/medians.h"

namespace todbench {
namespace {

constexpr std::size_t most_listed = 5000;

std::string png_text(const cv::Mat& picture) {
  return base64(png_of(picture).value_or(std::string()));
}

/// Returns the median plus and minus four standard deviations, estimated as for normally distributed values.
std::pair<double, double> grey_range(const cv::Mat1d& values) {
  constexpr double shown = 4;
  const double middle = median_of(values), reach = std::max(shown * 1.4826 * median_deviation_of(values), 1e-6);
  return {middle - reach, middle + reach};
}

PixelMap grey_map(std::string name, const cv::Mat1d& values, std::pair<double, double> range) {
  return {std::move(name), values.cols,  values.rows,
          range.first,     range.second, grey_png(values, range.first, range.second)};
}

/// Draws the map of defects. The neighbours of a pixel are drawn too, so that it is visible on paper.
PixelMap defect_map(const PixelMeasure& pixels) {
  cv::Mat3b picture(pixels.frame, cv::Vec3b(160, 160, 160));
  picture(pixels.field).setTo(cv::Scalar(255, 255, 255));
  for (const DefectColour& colour : defect_colours()) {
    const cv::Mat1b& found = pixels.defects.of(colour.kind);
    for (int y = 0; y < found.rows; ++y) {
      for (int x = 0; x < found.cols; ++x) {
        if (found(y, x) == 0) continue;
        const cv::Rect mark(x + pixels.field.x - 1, y + pixels.field.y - 1, 3, 3);
        picture(mark & cv::Rect({0, 0}, pixels.frame)).setTo(cv::Scalar(colour.blue, colour.green, colour.red));
      }
    }
  }
  return {"defects", picture.cols, picture.rows, 0, 0, png_text(picture)};
}

PixelMap triangle_map(const TriangleStrip& strip) {
  double low = 0, high = 0;
  cv::minMaxLoc(strip.kelvin, &low, &high);
  PixelMap map = grey_map("triangles", strip.kelvin, {low, high});
  map.note = fmt::format("at {:g} K, mean of {} frames, sizes from {:.1f} to {:.1f} pixels", strip.set_delta_t_k,
                         strip.frames, strip.size_px.front(), strip.size_px.back());
  return map;
}

Json rectangle_json(const cv::Rect& rectangle) {
  return {rectangle.x, rectangle.y, rectangle.width, rectangle.height};
}

}  // namespace

const std::array<DefectColour, pixel_defect_kinds.size()>& defect_colours() {
  // Palette of Okabe and Ito (2008).
  static constexpr std::array<DefectColour, pixel_defect_kinds.size()> colours{
      DefectColour{PixelDefect::offset, "dead or hot by level: vermilion", 213, 94, 0},
      DefectColour{PixelDefect::unresponsive, "dead by response: yellow", 240, 200, 0},
      DefectColour{PixelDefect::noisy, "noisy: blue", 0, 114, 178},
      DefectColour{PixelDefect::blinking, "blinking: purple", 204, 121, 167},
      DefectColour{PixelDefect::stuck, "stuck: black", 0, 0, 0},
      DefectColour{PixelDefect::substituted, "substituted: green", 0, 158, 115}};
  return colours;
}

std::string grey_png(const cv::Mat1d& values, double black, double white) {
  cv::Mat1b grey;
  const double span = std::max(white - black, 1e-9);
  values.convertTo(grey, CV_8U, 255 / span, -255 * black / span);
  return png_text(grey);
}

std::vector<PixelMap> pixel_maps(const CameraMeasures& measures) {
  std::vector<PixelMap> maps;
  if (measures.noise && !measures.noise->pixel_sd_k.empty()) {
    const cv::Mat1d& sd = measures.noise->pixel_sd_k;
    maps.push_back(grey_map("temporal_noise", sd, {0, 2 * median_of(sd)}));
    maps.push_back(grey_map("fixed_pattern", measures.noise->pattern_k, grey_range(measures.noise->pattern_k)));
  }
  for (const TriangleStrip& strip : measures.triangles) maps.push_back(triangle_map(strip));
  if (measures.pixels) maps.push_back(defect_map(*measures.pixels));
  return maps;
}

void pixel_map_fields(JsonFields& json, PixelMap& map) {
  json.value("name", map.name);
  json.value("width", map.width);
  json.value("height", map.height);
  json.value("black_k", map.black_k);
  json.value("white_k", map.white_k);
  json.value("note", map.note);
  json.value("png", map.png);
}

bool drawable(const std::vector<PixelMap>& maps) {
  return std::all_of(maps.begin(), maps.end(), [](const PixelMap& map) {
    return map.width > 0 && map.height > 0 && !map.png.empty() && is_base64(map.png);
  });
}

namespace {

/// Adds "bad_pixels" for the whole frame and "bad_pixels (NAME)" for a zone. Unobserved parts may contain more.
void add_pixels(MeasureLines& out, const PixelMeasure& pixels) {
  for (const PixelMeasure::Zone& zone : pixels.zones) {
    const ZoneCount& count = zone.count;
    const std::string name = zone.area.name == "whole" ? "" : " (" + zone.area.name + ")";
    const std::string conditions =
        fmt::format("zone '{}': {} of its {} pixels were observed, in {} frames at a contrast of 0", zone.area.name,
                    count.measured, count.pixels, pixels.defects.frames);
    const auto line = [&](const char* measure, int found) {
      Interval most{.low = found, .high = found};
      if (count.measured < count.pixels) most.high.reset();
      out.lines.push_back(measure_line(measure + name, found, most, conditions));
    };
    line("bad_pixels", count.bad);
    line("substituted_pixels", count.substituted);
    line("defect_clusters", count.clusters);
    line("largest_cluster", count.largest_cluster);
    if (count.measured > 0)
      out.lines.push_back(
          measure_line("operability" + name, 100.0 * (1 - 1.0 * count.bad / count.measured), {}, conditions));
  }
  for (const PixelDefect kind : pixel_defect_kinds) {
    if (kind == PixelDefect::substituted) continue;
    const auto found = static_cast<double>(cv::countNonZero(pixels.defects.of(kind)));
    const std::string seen =
        kind == PixelDefect::unresponsive
            ? fmt::format("of the {} pixels whose response was observed inside triangles",
                          pixels.defects.response_tested)
            : fmt::format("of the {} x {} observed pixels", pixels.field.width, pixels.field.height);
    out.lines.push_back(measure_line("pixels_" + std::string(to_string(kind)), found, {found, found}, seen));
  }
  for (const std::string& sentence : pixels.defects.not_tested) out.reasons.push_back("pixels: " + sentence);
}

/// Returns {"frames", "frame_px", "field_px", "response_tested", "counts", "zones": [...], "defects": [{"x_px", "y_px",
/// "kinds", "cluster"}], "defects_listed", "not_tested"}.
Json pixels_json(const PixelMeasure& pixels) {
  Json counts, zones = Json::array(), defects = Json::array();
  for (const PixelDefect kind : pixel_defect_kinds)
    counts[std::string(to_string(kind))] = cv::countNonZero(pixels.defects.of(kind));
  for (const PixelMeasure::Zone& zone : pixels.zones) {
    zones.push_back({{"name", zone.area.name},
                     {"area", {zone.area.left, zone.area.top, zone.area.right, zone.area.bottom}},
                     {"pixels", zone.count.pixels},
                     {"measured", zone.count.measured},
                     {"bad_pixels", zone.count.bad},
                     {"substituted_pixels", zone.count.substituted},
                     {"clusters", zone.count.clusters},
                     {"largest_cluster", zone.count.largest_cluster}});
  }
  const cv::Mat1i& cluster = pixels.defects.cluster;
  std::size_t all = 0;
  for (int y = 0; y < cluster.rows; ++y) {
    for (int x = 0; x < cluster.cols; ++x) {
      if (cluster(y, x) == 0 || all++ >= most_listed) continue;
      Json kinds = Json::array();
      for (const PixelDefect kind : pixel_defect_kinds)
        if (pixels.defects.of(kind)(y, x) != 0) kinds.push_back(to_string(kind));
      defects.push_back({{"x_px", x + pixels.field.x},
                         {"y_px", y + pixels.field.y},
                         {"kinds", std::move(kinds)},
                         {"cluster", cluster(y, x)}});
    }
  }
  return {{"frames", pixels.defects.frames},
          {"frame_px", {pixels.frame.width, pixels.frame.height}},
          {"field_px", rectangle_json(pixels.field)},
          {"response_tested", pixels.defects.response_tested},
          {"counts", counts},
          {"zones", zones},
          {"defects", defects},
          {"defects_found", all},
          {"not_tested", pixels.defects.not_tested}};
}

}  // namespace

MeasureRow pixels_row() {
  return {.key = "pixels",
          .add =
              [](MeasureLines& out, const CameraMeasures& measures) {
                if (measures.pixels) add_pixels(out, *measures.pixels);
              },
          .to_json =
              [](const CameraMeasures& measures) { return measures.pixels ? pixels_json(*measures.pixels) : Json(); }};
}

}  // namespace todbench
