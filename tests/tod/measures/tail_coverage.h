// SPDX-License-Identifier: GPL-3.0-or-later
// How often the interval of an edge's MTF holds the truth of lenses with tails: for the test and the study.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <vector>

#include "tests/tod/measures/tailed_edge.h"
#include "tod/measures/slanted_edge.h"

namespace todbench::test {

struct TailCoverage {
  static constexpr std::array frequencies{0.05, 0.1, 0.25, 0.5};
  using Each = std::array<double, frequencies.size()>;
  int edges = 0, refused = 0;
  int sharpened = 0;                         ///< edges that are said to be sharpened
  Each inside{}, error{}, below{}, above{};  ///< sums over the edges; below and above: from the MTF to the ends
  Each inside_any{};                         ///< intervals that hold the MTF relative to a source of any size
  Each open{};                               ///< intervals without a low end
};

/// 32 lenses (two bands, two apertures each, aberration 0 and 0.35 pitch; no halo, one, two) by four sizes by four
/// noises.
constexpr std::uint64_t tailed_pictures = 512;

/// Pictures `first` to `last`. 32 successive ones show each lens once, with sizes and noises in turn.
inline TailCoverage tail_coverage(std::uint64_t first, std::uint64_t last) {
  const std::array bands{TailedLens{}, TailedLens{.f_number = 2},
                         TailedLens{.f_number = 4, .shortest_um = 3.5, .longest_um = 5, .pitch_um = 15},
                         TailedLens{.f_number = 2.5, .shortest_um = 3.5, .longest_um = 5, .pitch_um = 15}};
  const std::vector<std::vector<std::pair<double, double>>> halos{
      {}, {{0.01, 3}}, {{0.05, 10}}, {{0.03, 5}, {0.04, 30}}};
  constexpr std::array sizes{std::pair(24, 26), std::pair(60, 100), std::pair(120, 200),
                             std::pair(200, 200)};  // lines, pixels across
  constexpr std::array noises{0.0003, 0.0015, 0.006, 0.03};
  TailCoverage out;
  for (std::uint64_t lens_number = 0; lens_number < 32; ++lens_number) {
    TailedLens lens = bands[lens_number % 4];
    lens.halos = halos[lens_number / 4 % 4], lens.aberration_pitch = lens_number < 16 ? 0 : 0.35;
    const TailedProfile profile(lens, 5);
    const std::uint64_t before = first % 32 > lens_number ? first / 32 + 1 : first / 32;
    for (std::uint64_t n = before * 32 + lens_number; n <= last; n += 32) {
      const auto [rows, columns] = sizes[(n + n / 32) % 4];
      const TailedEdge made{.rows = rows,
                            .columns = columns,
                            .noise = noises[(n + n / 4 + n / 128) % 4],
                            .shading_dark = 0.003,
                            .shading_bright = -0.005};
      const auto edge = slanted_edge(made.picture(profile, n), {});
      out.refused += edge ? 0 : 1;
      if (!edge) continue;
      ++out.edges;
      out.sharpened += edge->sharpened ? 1 : 0;
      for (std::size_t k = 0; k < TailCoverage::frequencies.size(); ++k) {
        const auto i = static_cast<std::size_t>(std::lround(100 * TailCoverage::frequencies[k]));
        const double truth = lens.mtf(edge->frequency_per_pitch[i], made.angle_deg, edge->widest_halo_pitch);
        out.inside[k] += edge->mtf_low_in_picture[i] <= truth && truth <= edge->mtf_high[i] ? 1 : 0;
        const double of_any_source = lens.mtf(edge->frequency_per_pitch[i], made.angle_deg);
        out.inside_any[k] += edge->mtf_low[i] <= of_any_source && of_any_source <= edge->mtf_high[i] ? 1 : 0;
        out.open[k] += edge->low_known[i] ? 0 : 1;
        out.error[k] += edge->mtf[i] - truth;
        out.below[k] += edge->mtf[i] - edge->mtf_low_in_picture[i], out.above[k] += edge->mtf_high[i] - edge->mtf[i];
      }
    }
  }
  return out;
}

/// Edges of sharpened pictures: how many are found, and how many of their intervals hold the truth.
struct SharpenedCoverage {
  int edges = 0, found = 0, intervals = 0, inside = 0;
};

/// A filter "picture + amount * (picture - its blur by sigma)", which is a halo with a negative share, behind a lens
/// with or without a halo of 5 % and 15 pitches.
inline SharpenedCoverage sharpened_coverage(double amount, double sigma, int side, double noise, std::uint64_t seeds) {
  SharpenedCoverage out;
  for (const bool halo : {false, true}) {
    TailedLens lens{.halos = {{-amount, sigma}}};
    if (halo) lens.halos.emplace_back(0.05, 15);
    const TailedProfile profile(lens, 5);
    const TailedEdge made{.rows = side, .columns = side, .noise = noise};
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      const auto edge = slanted_edge(made.picture(profile, seed), {});
      if (!edge) continue;
      ++out.edges;
      out.found += edge->sharpened ? 1 : 0;
      for (const double frequency : TailCoverage::frequencies) {
        const auto i = static_cast<std::size_t>(std::lround(100 * frequency));
        const double truth = lens.mtf(frequency, made.angle_deg);
        ++out.intervals;
        out.inside += edge->mtf_low[i] <= truth && truth <= edge->mtf_high[i] ? 1 : 0;
      }
    }
  }
  return out;
}

}  // namespace todbench::test
