// SPDX-License-Identifier: GPL-3.0-or-later
// Open parameters: parameters of an observer with an eye that published data do not determine, and their range.
#pragma once

#include <array>
#include <initializer_list>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "acquisition/base/result.h"
#include "hvs/observer/template_observer.h"

namespace todbench {

/// The two observers with the open parameters at their limits: sensitivity -4 to +4 dB, uncertainty of 100 to 3000
/// channels, contrast noise 0 to 0.07, sensor-noise factor 1.1 to 3.2. A parameter outside its range is not changed.
/// The acuity is monotone in each parameter, so these two observers have the highest and the lowest acuity of the
/// range.
struct OpenParameterRange {
  TemplateObserverSpec best, worst;
};

/// Returns the range; empty for an observer without an eye.
[[nodiscard]] std::optional<OpenParameterRange> open_parameter_range(const TemplateObserverSpec& spec);
/// Returns the best and then the worst observer of the range; empty without an eye.
[[nodiscard]] std::vector<TemplateObserverSpec> open_ends(const TemplateObserverSpec& spec);

/// Returns the results of `find`, which returns a Result, for the best and then the worst observer of the range. Empty
/// without an eye. Errors: those of `find`.
template <typename Find>
[[nodiscard]] auto at_open_ends(const TemplateObserverSpec& spec, const Find& find) -> Result<
    std::optional<std::array<typename std::invoke_result_t<const Find&, const TemplateObserverSpec&>::value_type, 2>>> {
  using Found = typename std::invoke_result_t<const Find&, const TemplateObserverSpec&>::value_type;
  std::vector<Found> found;
  for (const TemplateObserverSpec& end : open_ends(spec)) {
    auto at_end = find(end);
    if (!at_end) return tl::unexpected(at_end.error());
    found.push_back(*std::move(at_end));
  }
  if (found.empty()) return std::optional<std::array<Found, 2>>();
  return std::optional(std::array<Found, 2>{std::move(found[0]), std::move(found[1])});
}

/// Returns the spread of a quantity: the smallest and the largest of `values`. Pass the values of the best and the
/// worst observer of the range. If the quantity is not monotone in the parameters, also pass the value of the observer
/// with the nominal parameters. Empty if one of the values is missing. The spread is not a confidence interval.
[[nodiscard]] std::optional<std::pair<double, double>> spread_of(std::initializer_list<std::optional<double>> values);

}  // namespace todbench
