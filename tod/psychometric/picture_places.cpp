// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/psychometric/picture_places.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

namespace todbench {
namespace {

/// A triangle of a set-up.
using Shown = std::tuple<std::string, Mounting, std::string>;

struct SeenTriangle {
  double x_px = 0, y_px = 0;  ///< sums over the trials
  double size_px = 0, count = 0;
  std::size_t index = 0;  ///< in order of appearance
};

struct Spot {
  double x_px = 0, y_px = 0, size_px = 0;
};

bool is_at(const Spot& seen, const Spot& place) {
  const double apart_px = std::hypot(seen.x_px - place.x_px, seen.y_px - place.y_px);
  return apart_px < std::max(seen.size_px, place.size_px) / 2 + reach_px;
}

}  // namespace

std::vector<int> picture_places(std::span<const Trial> trials) {
  const bool said = std::ranges::all_of(trials, [](const Trial& trial) { return trial.centroid.has_value(); });
  std::map<Shown, SeenTriangle> shown;
  std::vector<std::map<Shown, SeenTriangle>::iterator> in_order;
  for (const Trial& trial : trials) {
    const auto [at, is_new] = shown.try_emplace({trial.plate, trial.mounting, trial.triangle});
    if (is_new) {
      at->second.index = in_order.size();
      in_order.push_back(at);
    }
    const PlaceInPicture centroid = trial.centroid.value_or(PlaceInPicture{});
    at->second.x_px += centroid.x_px;
    at->second.y_px += centroid.y_px;
    at->second.size_px = trial.size_px;
    at->second.count += 1;
  }
  std::vector<int> number_of;
  std::vector<Spot> places;
  for (const auto& at : in_order) {
    const SeenTriangle& seen = at->second;
    const Spot here{seen.x_px / seen.count, seen.y_px / seen.count, seen.size_px};
    const auto near =
        said ? std::ranges::find_if(places, [&](const Spot& place) { return is_at(here, place); }) : places.end();
    number_of.push_back(static_cast<int>(near - places.begin()));
    if (near == places.end()) places.push_back(here);
  }
  std::vector<int> out;
  for (const Trial& trial : trials)
    out.push_back(number_of[shown.at({trial.plate, trial.mounting, trial.triangle}).index]);
  return out;
}

}  // namespace todbench
