// SPDX-License-Identifier: GPL-3.0-or-later
// Table of the quantities of measures.json: unit, title, definition, and limits.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/plan/plan.h"

namespace todbench {

/// Side of the limit on which a result conforms.
enum class LimitSide {
  at_least,
  at_most,
  none,  ///< the demand has no number
};

/// Uncertainty of the budget that the judgement of a quantity includes.
enum class StatedUncertainty {
  none,          ///< common errors cancel, for example in a ratio of contrasts in one picture
  camera_scale,  ///< uncertainty of a temperature difference on the camera's scale
  scale,         ///< uncertainty of the temperature scale, for temperatures and quantities divided by a temperature
  distance,      ///< uncertainty of an angle per pixel
};

/// Demand that corresponds to a limit on a quantity.
struct QuantityLimit {
  std::string_view demand;  ///< name in verdict.json; empty: the quantity cannot have this limit
  std::string_view words;   ///< text in front of the number of the limit
  [[nodiscard]] constexpr bool possible() const { return !demand.empty(); }
};

/// Quantity of measures.json.
struct Quantity {
  std::string_view name;        ///< as in measures.json, without a position
  std::string_view unit;        ///< "1" for ratios and numbers of objects
  std::string_view title;       ///< title in reports
  std::string_view definition;  ///< one sentence, with the source of a published method
  /// Keys of [measures] that the quantity requires; empty: none.
  std::string_view measure{}, second_measure{};
  QuantityLimit at_least{}, at_most{};
  StatedUncertainty stated = StatedUncertainty::none;
  bool absolute = false;  ///< a limit applies to the absolute value

  [[nodiscard]] constexpr bool can_be_limited() const { return at_least.possible() || at_most.possible(); }
};

/// Returns all quantities. Quantities with limits are in the order of their demands.
[[nodiscard]] std::span<const Quantity> quantities();
/// Returns the quantity with this name; a position in brackets, "mtf_x (corner)", is ignored. Null if unknown.
[[nodiscard]] const Quantity* find_quantity(std::string_view name);
/// Returns the quantity if it can have a limit; null otherwise.
[[nodiscard]] const Quantity* find_limited_quantity(std::string_view name);
/// Returns the names of the quantities that can have a limit.
[[nodiscard]] std::vector<std::string> limited_quantity_names();

/// Returns the relative standard uncertainty that the budget of the plan states for quantities of this kind.
[[nodiscard]] double relative_u(const Plan& plan, StatedUncertainty stated);

}  // namespace todbench
