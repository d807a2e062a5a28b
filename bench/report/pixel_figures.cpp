// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <utility>

#include "bench/report/measure_figures.h"
#include "bench/report/number_format.h"

namespace todbench {
namespace {

/// Returns the title of a map and the meaning of its greys or colours.
std::pair<std::string, std::string> words_of(const PixelMap& map) {
  // Temperatures, unlike differences, need hundredths of a kelvin.
  const int digits = map.black_k > 100 ? 5 : 3;
  const auto kelvin = [digits](double value) { return significant(value, digits) + " K"; };
  const std::string greys = ": " + kelvin(map.black_k) + " black to " + kelvin(map.white_k) + " white";
  if (map.name == "temporal_noise") return {"Temporal noise of each pixel", greys};
  if (map.name == "fixed_pattern") return {"Fixed pattern, without shading", greys};
  if (map.name == "triangles") return {"Smallest triangles " + map.note, greys};
  if (map.name == "bar_out") return {"Hot bar outside the field", ""};
  if (map.name == "bar_in") return {"Hot bar in the field", ", in the grey scale of the picture without the bar"};
  if (map.name != "defects") return {map.name, greys};
  std::string colours = ", drawn enlarged; ";
  for (const DefectColour& colour : defect_colours()) colours += std::string(colour.words) + ", ";
  return {"Bad and substituted pixels", colours + "not examined: grey"};
}

Figure map_figure(const PixelMap& map, const std::string& who, std::size_t number, const std::string& id) {
  constexpr double width = 430;
  const auto [title, meaning] = words_of(map);
  Drawing drawing;
  drawing.id = "pixels-" + id;
  for (char c : map.name) drawing.id += c == '_' ? '-' : c;
  if (map.name == "triangles") drawing.id += "-" + std::to_string(number);
  drawing.title = title + ", " + who;
  drawing.description = title + meaning;
  // Tall maps are narrower, so that two pairs fit on a page.
  constexpr double most_height = 360;
  const double scale = std::min(width / map.width, most_height / map.height);
  drawing.width = width, drawing.height = scale * map.height;
  drawing.frame = {(width - scale * map.width) / 2, 0, scale * map.width, drawing.height};
  drawing.inside.push_back({.shape = Raster{drawing.frame, map.png}});
  return {std::move(drawing), title + ", " + who + meaning};
}

}  // namespace

std::optional<FigurePairs> pixel_figures(const SessionMeasures& measures, bool camera) {
  FigurePairs figures;
  const std::vector<PixelMap> none;
  const std::vector<PixelMap>& main = measures.main ? measures.main->maps : none;
  const std::vector<PixelMap>& twin = measures.twin ? measures.twin->maps : none;
  for (std::size_t i = 0; i < main.size(); ++i) {
    const PixelMap& map = main[i];
    figures.figures.push_back(map_figure(map, camera ? "camera" : "simulated sensor", i, "main-"));
    const auto same = std::find_if(twin.begin(), twin.end(),
                                   [&](const PixelMap& one) { return one.name == map.name && one.note == map.note; });
    if (same != twin.end()) figures.figures.push_back(map_figure(*same, "simulated twin", i, "twin-"));
  }
  if (figures.figures.empty()) return std::nullopt;
  return figures;
}

}  // namespace todbench
