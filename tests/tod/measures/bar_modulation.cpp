// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tod/measures/bar_modulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

namespace todbench {
namespace {

/// The first sample by `before` within `reach` of `centre`; empty if there is none.
template <typename Before>
std::optional<double> extreme(std::span<const double> samples, double first_sample_at, double centre, double reach,
                              Before before) {
  // A sample on the edge of the range belongs to it in spite of rounding.
  constexpr double rounding = 1e-9;
  std::optional<double> found;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double distance = std::abs(first_sample_at + static_cast<double>(i) - centre);
    if (distance <= reach + rounding && (!found || before(samples[i], *found))) found = samples[i];
  }
  return found;
}

}  // namespace

Result<RowModulation> bar_modulation(std::span<const double> samples, const FourBars& bars) {
  const double f = bars.frequency_per_pitch;
  if (!(f > 0) || !std::isfinite(f) || !std::isfinite(bars.first_sample_at))
    return fail(ErrorCode::invalid_input, "the frequency of the bars must be above 0");
  const double half_pattern = 7 / (4 * f);
  if (bars.first_sample_at > -half_pattern ||
      bars.first_sample_at + static_cast<double>(samples.size()) - 1 < half_pattern)
    return fail(ErrorCode::invalid_input, "the samples do not cover the four bars");
  const double reach = std::max(1 / (4 * f), 0.5);
  std::array<double, 4> bar{};
  std::array<double, 3> gap{};
  for (std::size_t i = 0; i < bar.size(); ++i) {
    const auto found =
        extreme(samples, bars.first_sample_at, (static_cast<double>(i) - 1.5) / f, reach, std::greater<>());
    if (!found) return fail(ErrorCode::invalid_input, "a bar has no sample");
    bar[i] = *found;
  }
  for (std::size_t i = 0; i < gap.size(); ++i) {
    const auto found = extreme(samples, bars.first_sample_at, (static_cast<double>(i) - 1) / f, reach, std::less<>());
    if (!found) return fail(ErrorCode::invalid_input, "a gap has no sample");
    gap[i] = *found;
  }
  RowModulation found;
  for (const double value : bar) found.modulation += value / static_cast<double>(bar.size());
  for (const double value : gap) found.modulation -= value / static_cast<double>(gap.size());
  for (std::size_t i = 0; i < gap.size(); ++i) found.bars_separated += gap[i] < bar[i] && gap[i] < bar[i + 1] ? 1 : 0;
  return found;
}

}  // namespace todbench
