// SPDX-License-Identifier: GPL-3.0-or-later
// Likelihood of a person's answers to given patches, according to the template observer.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "tod/observer_fit/observer_values.h"
#include "tod/psychometric/bounded_newton.h"

namespace todbench {

/// Probability of each alternative and its derivatives, for one patch and one ObserverPlace.
struct AnswerExpansion {
  std::array<double, 4> probability{};
  std::array<std::array<double, 4>, observer_key_count> slope{};
};

/// Returns the standard deviation of the noise that the observer adds to a patch, relative to the contrast. It is
/// sqrt(n^2 + (f^2 - 1) (q / dT)^2) with n: internal noise, f: sensor-noise factor, q: noise of the sensor, dT:
/// contrast.
[[nodiscard]] double own_noise(const AnsweredPatch& patch, const ObserverValues& values);
/// Returns the probabilities of the four answers to one patch: p = lapse / 4 + (1 - lapse) p_observer. The sum is 1.
[[nodiscard]] std::array<double, 4> answer_shares(AnswerLattice& lattice, std::size_t patch,
                                                  const ObserverValues& values);
/// Computes probabilities and derivatives for one patch.
[[nodiscard]] AnswerExpansion answer_expansion(AnswerLattice& lattice, std::size_t patch, const ObserverPlace& place);

/// Returns the ln likelihood of the answers and its gradient. The second derivatives are minus the expected information
/// (for Fisher's scoring). Precondition: a lattice of four alternatives.
[[nodiscard]] Expansion<observer_key_count> person_likelihood(AnswerLattice& lattice,
                                                              std::span<const PersonAnswer> answers,
                                                              const ObserverPlace& place);

}  // namespace todbench
