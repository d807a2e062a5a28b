// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/observer/share_won.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "acquisition/base/rng.h"

namespace todbench {
namespace {

/// Sums formed and sorted one by one.
double by_sorting(const std::vector<float>& signal, const std::vector<float>& noise, float scale, int places,
                  int alternatives, int alternative) {
  std::vector<float> tops;
  for (int o = 0; o < alternatives; ++o) {
    std::vector<float> sums;
    for (int p = 0; p < places; ++p) {
      const auto at = static_cast<std::size_t>(o * places + p);
      const float product = scale * noise[at];
      sums.push_back(signal[at] + product);
    }
    std::ranges::sort(sums);
    tops.push_back(sums.back());
  }
  const float own = tops[static_cast<std::size_t>(alternative)];
  std::ranges::sort(tops);
  if (own != tops.back()) return 0;
  return 1.0 / static_cast<double>(std::ranges::count(tops, own));
}

TEST(ShareWon, IsThatOfSortedScoresForEveryNumberOfPlaces) {
  const RandomStream stream(3, "share_won");
  std::uint64_t drawn = 0;
  int won = 0;
  for (const int places : {1, 2, 17, 63, 64, 65, 127, 128, 129, 289, 1089}) {
    for (int trial = 0; trial < 20; ++trial) {
      std::vector<float> signal(static_cast<std::size_t>(4 * places)), noise(signal.size());
      stream.sub(drawn++).fill_normal(signal);
      stream.sub(drawn++).fill_normal(noise);
      for (int o = 0; o < 4; ++o) {
        const double share = share_won(signal, noise, -0.75F, places, 4, o);
        EXPECT_EQ(share, by_sorting(signal, noise, -0.75F, places, 4, o)) << places << " places, alternative " << o;
        won += share == 1 ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(won, 11 * 20);  // one alternative of every trial
}

TEST(ShareWon, FindsTheMaximumAtEveryPlace) {
  for (const int places : {5, 64, 100, 289}) {
    for (int at = 0; at < places; ++at) {
      std::vector<float> signal(static_cast<std::size_t>(2 * places), -3.0F);
      const std::vector<float> noise(signal.size(), 0.0F);
      signal[static_cast<std::size_t>(places + at)] = -2.0F;
      EXPECT_EQ(share_won(signal, noise, 1.0F, places, 2, 1), 1) << at << " of " << places;
      EXPECT_EQ(share_won(signal, noise, 1.0F, places, 2, 0), 0) << at << " of " << places;
    }
  }
}

TEST(ShareWon, EqualScoresShare) {
  std::vector<float> signal(4 * 70, 1.0F);
  const std::vector<float> noise(signal.size(), 0.5F);
  EXPECT_EQ(share_won(signal, noise, 1.0F, 70, 4, 2), 0.25);
  signal[75] = 2.0F;   // of alternative 1
  signal[275] = 2.0F;  // of alternative 3
  EXPECT_EQ(share_won(signal, noise, 1.0F, 70, 4, 2), 0);
  EXPECT_EQ(share_won(signal, noise, 1.0F, 70, 4, 1), 0.5);
}

}  // namespace
}  // namespace todbench
