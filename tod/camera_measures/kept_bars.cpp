// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/kept_bars.h"

#include <optional>
#include <utility>

namespace todbench {

void BarsKeeper::add(KeptPicture picture) {
  int& kept = count_[{picture.place, picture.set_up, picture.contrast_k}];
  if (kept >= frames_) return;
  ++kept;
  pictures_.push_back(std::move(picture));
}

KeptBars BarsKeeper::of(const std::vector<KeptPlace>& places) const {
  KeptBars out;
  std::vector<std::optional<std::size_t>> number;
  for (const KeptPlace& place : places) {
    number.emplace_back(place.name.empty() ? std::nullopt : std::optional(out.places.size()));
    if (number.back()) out.places.push_back(place);
  }
  for (const KeptPicture& picture : pictures_) {
    if (!number[picture.place]) continue;
    out.pictures.push_back(picture);
    out.pictures.back().place = *number[picture.place];
  }
  return out;
}

}  // namespace todbench
