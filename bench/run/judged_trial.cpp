// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/judged_trial.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace todbench {

std::vector<std::size_t> balanced_choice(const std::vector<JudgedTrial>& trials, int per_size,
                                         const RandomStream& stream) {
  // Sizes of one row of the plate differ in the last bits of the description; micrometres identify them.
  std::map<std::pair<double, std::int64_t>, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < trials.size(); ++i)
    groups[{trials[i].trial.set_delta_t_k, std::llround(trials[i].trial.size_mm * 1000)}].push_back(i);
  std::vector<std::size_t> chosen;
  std::uint64_t number = 0;
  for (auto& [key, members] : groups) {
    shuffle(members, stream.sub(++number));
    const auto count = std::min(members.size(), static_cast<std::size_t>(std::max(per_size, 0)));
    chosen.insert(chosen.end(), members.begin(), members.begin() + static_cast<std::ptrdiff_t>(count));
  }
  return chosen;
}

}  // namespace todbench
