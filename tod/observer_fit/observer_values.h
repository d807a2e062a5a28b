// SPDX-License-Identifier: GPL-3.0-or-later
// Parameters of a template observer that can be fitted, and the answers for the fit.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "hvs/observer/answer_lattice.h"

namespace todbench {

/// Fitted parameters. Lapse is the share of answers that do not depend on the patch and are spread evenly over the
/// alternatives; it is not a parameter of the template observer.
enum class ObserverKey { blur_sigma_samples, internal_noise, sensor_noise_factor, lapse };
inline constexpr std::array all_observer_keys{ObserverKey::blur_sigma_samples, ObserverKey::internal_noise,
                                              ObserverKey::sensor_noise_factor, ObserverKey::lapse};
[[nodiscard]] std::string_view to_string(ObserverKey key);
inline constexpr std::size_t observer_key_count = all_observer_keys.size();

/// By ObserverKey.
using ObserverValues = std::array<double, observer_key_count>;

/// Limits of the search, by ObserverKey.
inline constexpr ObserverValues least_values{AnswerLattice::least_sigma, AnswerLattice::least_noise, 1, 0};
inline constexpr ObserverValues most_values{AnswerLattice::most_sigma, 5, 10, 0.5};

/// Coordinates of the search: logarithms of the first three parameters, the lapse itself.
using ObserverPlace = std::array<double, observer_key_count>;
[[nodiscard]] ObserverPlace place_of(const ObserverValues& values);
[[nodiscard]] ObserverValues values_at(const ObserverPlace& place);

/// An answer to a patch of the lattice.
struct PersonAnswer {
  std::size_t patch = 0;  ///< index in the lattice
  int answer = 0, truth = 0;
  int cell = 0;  ///< contrast and size, numbered by the caller: residuals are grouped by it
};

}  // namespace todbench
