// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/mounting_choices.h"

#include <algorithm>

namespace todbench {
namespace {

/// The mounting that is rotated by 180 degrees.
Mounting counterpart(Mounting mounting) {
  switch (mounting) {
    case Mounting::identity:
      return Mounting::rotated_180;
    case Mounting::rotated_180:
      return Mounting::identity;
    case Mounting::mirrored_horizontally:
      return Mounting::mirrored_vertically;
    case Mounting::mirrored_vertically:
      return Mounting::mirrored_horizontally;
  }
  return mounting;
}

}  // namespace

std::vector<Mounting> in_pairs(const std::vector<Mounting>& mountings) {
  std::vector<Mounting> out;
  const auto add = [&](Mounting mounting) {
    if (std::ranges::find(mountings, mounting) != mountings.end() && std::ranges::find(out, mounting) == out.end())
      out.push_back(mounting);
  };
  for (const Mounting mounting : mountings) {
    add(mounting);
    add(counterpart(mounting));
  }
  return out;
}

double unpaired_share(const TargetPlan& target) {
  int unpaired = 0;
  for (std::size_t p = 0; p < target.plates.size(); ++p) {
    const auto end = target.mountings.begin() + static_cast<std::ptrdiff_t>(mountings_of(target, p));
    for (auto mounting = target.mountings.begin(); mounting != end; ++mounting)
      unpaired += std::find(target.mountings.begin(), end, counterpart(*mounting)) == end ? 1 : 0;
  }
  return unpaired / static_cast<double>(set_ups_of(target));
}

std::vector<std::vector<int>> mounting_choices(std::size_t plates, int mountings, std::size_t set_ups) {
  constexpr std::size_t most_plates = 3;
  std::vector<std::vector<int>> choices;
  std::vector<int> counts(plates, 1);
  const auto add = [&] {
    std::size_t sum = 0;
    for (const int count : counts) sum += static_cast<std::size_t>(count);
    if (sum >= set_ups) choices.push_back(counts);
  };
  if (plates > most_plates) {  // the same number for all
    for (int count = 1; count <= mountings; ++count) {
      counts.assign(plates, count);
      add();
    }
    return choices;
  }
  for (std::size_t digit = 0; digit < plates;) {
    add();
    for (digit = 0; digit < plates && ++counts[digit] > mountings; ++digit) counts[digit] = 1;
  }
  return choices;
}

}  // namespace todbench
