// SPDX-License-Identifier: GPL-3.0-or-later
// Parameters of a template observer that can be fitted, and the answers to which they are fitted.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "hvs/observer/answer_lattice.h"

namespace todbench {

/// Kind of the fitted observer. It determines the first two fitted parameters.
enum class FittedKind {
  blurred,  ///< blur_sigma_samples and internal_noise
  eye,      ///< factor of the sensitivity of the eye, and contrast_noise of the eye
};

/// Fitted parameters, named as for a blurred observer. The lapse is the share of answers that do not depend on the
/// patch and are distributed evenly over the alternatives. It is not a parameter of the template observer.
enum class ObserverKey { blur_sigma_samples, internal_noise, sensor_noise_factor, lapse };
inline constexpr std::array all_observer_keys{ObserverKey::blur_sigma_samples, ObserverKey::internal_noise,
                                              ObserverKey::sensor_noise_factor, ObserverKey::lapse};
[[nodiscard]] std::string_view to_string(ObserverKey key);
inline constexpr std::size_t observer_key_count = all_observer_keys.size();
/// Returns the name of a parameter for this kind of observer.
[[nodiscard]] std::string_view parameter_name(ObserverKey key, FittedKind kind);

/// Values of the parameters, in the order of ObserverKey.
using ObserverValues = std::array<double, observer_key_count>;

/// Limits of the search, by ObserverKey.
struct ObserverLimits {
  ObserverValues least{}, most{};
};
/// Returns the limits for a kind of observer.
[[nodiscard]] constexpr ObserverLimits observer_limits(FittedKind kind) {
  if (kind == FittedKind::eye) return {{0.05, 1e-3, 1, 0}, {20, 1, 10, 0.5}};
  return {{AnswerLattice::least_sigma, AnswerLattice::least_noise, 1, 0}, {AnswerLattice::most_sigma, 5, 10, 0.5}};
}

/// Coordinates of the search: logarithms of the first three parameters, and the lapse without a transformation.
using ObserverPlace = std::array<double, observer_key_count>;
/// Converts values to coordinates; values below the limits are replaced by the limits.
[[nodiscard]] ObserverPlace place_of(const ObserverValues& values, FittedKind kind = FittedKind::blurred);
/// Converts coordinates to values.
[[nodiscard]] ObserverValues values_at(const ObserverPlace& place);

/// An answer to a patch of the lattice.
struct PersonAnswer {
  std::size_t patch = 0;  ///< index in the lattice
  int answer = 0, truth = 0;
  /// Number that the caller assigns to the combination of contrast and size. Residuals are grouped by this number.
  int cell = 0;
};

}  // namespace todbench
