// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/grey_levels.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"

namespace todbench {

double GreySteps::noise_steps() const {
  const double measured = noise_levels / step_levels;
  return std::sqrt(std::max(0.0, measured * measured - 1.0 / 12));
}

double GreySteps::rounding_variance_steps() const {
  constexpr double tells_nothing = 0.52;
  return rounding_variance(noise_levels <= tells_nothing * step_levels ? 0 : noise_steps());
}

/// With less noise a flat picture shows a single level for any step.
constexpr double least_noise_of_a_level = 0.5;

GreySteps grey_steps(const cv::Mat1w& lowest, const cv::Mat1w& highest, double noise_levels) {
  std::vector<std::int64_t> occurrences(65536);
  for (const cv::Mat1w& counts : {lowest, highest}) {
    for (const std::uint16_t count : counts) ++occurrences[count];
  }
  const auto half = static_cast<std::int64_t>(lowest.total() + highest.total()) / 2;
  std::int64_t below = 0;
  int middle = 0;
  while (middle < 65535 && below + occurrences[static_cast<std::size_t>(middle)] < half)
    below += occurrences[static_cast<std::size_t>(middle++)];
  const int reach = static_cast<int>(std::ceil(3 * noise_levels)) + 1;
  int first = -1, last = -1, different = 0;
  for (int level = std::max(0, middle - reach); level <= std::min(65535, middle + reach); ++level) {
    if (occurrences[static_cast<std::size_t>(level)] == 0) continue;
    if (first < 0) first = level;
    last = level;
    ++different;
  }
  GreySteps steps{.noise_levels = noise_levels};
  if (different > 1) steps.step_levels = static_cast<double>(last - first) / (different - 1);
  if (different == 1 && noise_levels >= least_noise_of_a_level) {
    // Noise would reach another level if there were one nearer: the next one is a step away.
    const auto occurs = [&](int level) {
      return level >= 0 && level < 65536 && occurrences[static_cast<std::size_t>(level)] > 0;
    };
    int distance = reach;
    while (distance < 65536 && !occurs(middle - distance) && !occurs(middle + distance)) ++distance;
    steps.step_levels = distance;
  }
  return steps;
}

double rounding_variance(double noise_steps) {
  if (noise_steps < 0.02) return 1.0 / 12;  // the sum converges like that of 1 / k^2: 0.083 within 1 %
  constexpr double pi = std::numbers::pi;
  double sum = 0;
  for (int k = 1; k <= 60; ++k) {
    const double term = std::exp(-4 * pi * pi * k * k * noise_steps * noise_steps) / (2 * pi * pi * k * k);
    sum += term;
    if (term < 1e-12) break;
  }
  return sum;
}

double GreyContrast::half_width() const {
  return distribution::quantile(distribution::StudentsT(degrees_of_freedom), 0.975) * standard_uncertainty;
}

Result<GreyContrast> grey_contrast(const cv::Mat1d& levels, const TargetPlate& mounted_plate,
                                   const Registration& registration, double min_size_px, const GreySteps& steps) {
  TODBENCH_TRY(const auto seen,
               effective_contrast(levels, mounted_plate, registration, min_size_px, LevelEstimate::mean));
  if (seen.triangles < 2)
    return fail(
        ErrorCode::calibration,
        "plate \"" + mounted_plate.name +
            "\" has only one triangle that is large enough: the uncertainty of its grey levels needs at least two");
  const double scatter = seen.standard_error * seen.standard_error;
  // Inside and surround are rounded independently.
  const double rounding = 2 * steps.step_levels * steps.step_levels * steps.rounding_variance_steps();
  const double variance = scatter + rounding;
  GreyContrast out{.levels = seen.value,
                   .standard_uncertainty = std::sqrt(variance),
                   .degrees_of_freedom = 1e6,
                   .triangles = seen.triangles};
  if (scatter > 0)
    out.degrees_of_freedom = std::min(1e6, variance * variance / (scatter * scatter) * (seen.triangles - 1));
  return out;
}

}  // namespace todbench
