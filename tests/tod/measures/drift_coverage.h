// SPDX-License-Identifier: GPL-3.0-or-later
// Groups of frames of a camera whose drift is known, and how often the intervals of the law hold it.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "acquisition/base/rng.h"
#include "tod/measures/drift_law.h"

namespace todbench::testing {

/// 20 groups over 20 s, in 64 x 48 pixels.
struct DriftCase {
  double level_k = 0.3;                     ///< by which the mean has grown after 20 s
  double pattern_k = 0.03;                  ///< standard deviation over the pixels of what they have grown
  std::optional<double> time_constant_s{};  ///< nothing: linear
  double pixel_noise_k = 0.015;             ///< of a pixel in the mean of a group
  double frame_noise_k = 0.003;             ///< of all pixels of a group
  int groups = 20;
};

inline double drift_growth(const DriftCase& drift, double time_s) {
  constexpr double whole_s = 20;
  if (!drift.time_constant_s) return time_s / whole_s;
  return std::expm1(-time_s / *drift.time_constant_s) / std::expm1(-whole_s / *drift.time_constant_s);
}

inline std::vector<DriftGroup> drift_groups(const DriftCase& drift, std::uint64_t seed) {
  const cv::Size size(64, 48);
  const auto noise = [&](const std::string& name, std::size_t count) {
    std::vector<float> values(count);
    RandomStream(seed, "test.drift." + name).fill_normal(values);
    return values;
  };
  const auto pixels = static_cast<std::size_t>(size.area());
  const auto fixed = noise("fixed", pixels), growing = noise("growing", pixels);
  const auto whole = noise("whole", static_cast<std::size_t>(drift.groups));
  std::vector<DriftGroup> groups;
  for (int k = 0; k < drift.groups; ++k) {
    DriftGroup group{.time_s = 20.0 * (k + 0.5) / drift.groups, .frames = 16, .mean_k = cv::Mat1d(size)};
    const double grown = drift_growth(drift, group.time_s);
    const auto white = noise("white" + std::to_string(k), pixels);
    std::size_t i = 0;
    for (double& value : cv::Mat1d(group.mean_k)) {
      value = 300 + drift.level_k * grown + drift.frame_noise_k * whole[static_cast<std::size_t>(k)] + 0.05 * fixed[i] +
              drift.pattern_k * growing[i] * grown + drift.pixel_noise_k * white[i];
      ++i;
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

struct DriftCoverage {
  int seeds = 0;
  int level_approaches = 0, pattern_approaches = 0;
  double level_within = 0, pattern_within = 0, constant_within = 0;  ///< shares; the last of approaches
  double level_error_k = 0, pattern_error_k = 0;                     ///< mean
  double level_half_k = 0, pattern_half_k = 0;                       ///< mean half-width
};

inline bool holds(const Interval& interval, double truth) {
  return (!interval.low || *interval.low <= truth) && (!interval.high || *interval.high >= truth);
}

inline DriftCoverage drift_coverage(const DriftCase& drift, int seeds) {
  DriftCoverage out;
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto groups = drift_groups(drift, static_cast<std::uint64_t>(seed));
    const auto law = drift_law(groups);
    if (!law) continue;
    ++out.seeds;
    const double grown = drift_growth(drift, groups.back().time_s) - drift_growth(drift, groups.front().time_s);
    const double level = drift.level_k * grown, pattern = drift.pattern_k * grown;
    out.level_within += holds(law->level.change_ci95, level) ? 1 : 0;
    out.pattern_within += holds(law->pattern.change_ci95, pattern) ? 1 : 0;
    out.level_error_k += law->level.change_k - level, out.pattern_error_k += law->pattern.change_k - pattern;
    out.level_half_k += 0.5 * (law->level.change_ci95.high.value() - law->level.change_ci95.low.value());
    out.pattern_half_k += 0.5 * (law->pattern.change_ci95.high.value() - law->pattern.change_ci95.low.value());
    out.pattern_approaches += law->pattern.shape == DriftShape::approach ? 1 : 0;
    if (law->level.shape != DriftShape::approach) continue;
    ++out.level_approaches;
    out.constant_within +=
        drift.time_constant_s && holds(law->level.time_constant_ci95, *drift.time_constant_s) ? 1 : 0;
  }
  for (double* sum : {&out.level_within, &out.pattern_within, &out.level_error_k, &out.pattern_error_k,
                      &out.level_half_k, &out.pattern_half_k})
    *sum /= out.seeds;
  if (out.level_approaches > 0) out.constant_within /= out.level_approaches;
  return out;
}

}  // namespace todbench::testing
