// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/observer_fit/person_likelihood.h"

#include <algorithm>
#include <cmath>

namespace todbench {
namespace {

constexpr std::size_t blur = 0, internal = 1, factor = 2, lapse = 3;
constexpr std::size_t alternatives = 4;

/// Half a step of the central differences in ln sigma and ln s: half the distance of the lattice's nodes in ln sigma.
/// With a shorter one the scatter of the draws from node to node would look like information.
constexpr double half_step = 0.1;

std::array<double, alternatives> observer_shares(AnswerLattice& lattice, std::size_t patch, double sigma, double sd) {
  const AnswerLogProbabilities logs = lattice.log_probabilities(patch, sigma, sd);
  std::array<double, alternatives> out{};
  for (std::size_t o = 0; o < alternatives; ++o) out[o] = std::exp(logs.value[o]);
  return out;
}

/// Both noises of an observer with an eye for a patch, and their slopes.
struct EyeNoises {
  double eye = 0, white = 0;
  double by_gain = 0, by_contrast_noise = 0, by_factor = 0;  ///< d ln eye / d ln of the first two, d ln white / d ln f
};
EyeNoises eye_noises(const AnswerLattice& lattice, std::size_t patch, const ObserverValues& values) {
  EyeNoises out;
  const double whole = lattice.eye_noise(patch, values[blur], values[internal]);
  const double fixed = lattice.eye_noise(patch, values[blur], 0);
  const double seen = lattice.patch(patch).noise_k / lattice.patch(patch).contrast_k;
  const double added = std::sqrt(std::max(0.0, values[factor] * values[factor] - 1)) * std::abs(seen);
  out.eye = std::max(whole, AnswerLattice::least_noise);
  out.white = std::max(added, AnswerLattice::least_noise);
  // eye^2 = fixed^2 + (contrast_noise B)^2, and fixed is proportional to 1 / gain.
  out.by_gain = -std::pow(fixed / out.eye, 2);
  out.by_contrast_noise = (whole * whole - fixed * fixed) / (out.eye * out.eye);
  out.by_factor = std::pow(values[factor] * seen / out.white, 2);
  return out;
}

double inside(double value, double low, double high) {
  return std::clamp(value, low, high);
}

/// d p_o / d ln x = p_o d ln p_o / d ln x, by a difference of ln p_o inside the domain of the lattice. With a
/// difference of p_o, an answer that is almost excluded here and possible half a step further would look like
/// information.
template <typename Logs>
std::array<double, alternatives> difference(const Logs& logs, double x, double low, double high) {
  const double less = inside(x * std::exp(-half_step), low, high), more = inside(x * std::exp(half_step), low, high);
  std::array<double, alternatives> out{};
  if (!(more > less)) return out;
  const AnswerLogProbabilities here = logs(x), before = logs(less), after = logs(more);
  for (std::size_t o = 0; o < alternatives; ++o)
    out[o] = std::exp(here.value[o]) * (after.value[o] - before.value[o]) / std::log(more / less);
  return out;
}

}  // namespace

double own_noise(const AnsweredPatch& patch, const ObserverValues& values) {
  const double seen = patch.noise_k / patch.contrast_k;
  return std::sqrt(values[internal] * values[internal] + (values[factor] * values[factor] - 1) * seen * seen);
}

std::array<double, 4> answer_shares(AnswerLattice& lattice, std::size_t patch, const ObserverValues& values) {
  std::array<double, 4> shares{};
  if (lattice.has_eye()) {
    const EyeNoises noises = eye_noises(lattice, patch, values);
    shares = observer_shares(lattice, patch, noises.eye, noises.white);
  } else {
    shares = observer_shares(lattice, patch, values[blur],
                             std::max(own_noise(lattice.patch(patch), values), AnswerLattice::least_noise));
  }
  for (double& share : shares) share = values[lapse] / alternatives + (1 - values[lapse]) * share;
  return shares;
}

namespace {

AnswerExpansion eye_expansion(AnswerLattice& lattice, std::size_t patch, const ObserverValues& values) {
  const EyeNoises noises = eye_noises(lattice, patch, values);
  const auto own = observer_shares(lattice, patch, noises.eye, noises.white);
  const double low = AnswerLattice::least_noise, high = AnswerLattice::most_noise;
  const auto by_eye =
      difference([&](double x) { return lattice.log_probabilities(patch, x, noises.white); }, noises.eye, low, high);
  const auto by_white =
      difference([&](double x) { return lattice.log_probabilities(patch, noises.eye, x); }, noises.white, low, high);
  AnswerExpansion out;
  const double kept = 1 - values[lapse];
  for (std::size_t o = 0; o < alternatives; ++o) {
    out.probability[o] = values[lapse] / alternatives + kept * own[o];
    out.slope[blur][o] = kept * by_eye[o] * noises.by_gain;
    out.slope[internal][o] = kept * by_eye[o] * noises.by_contrast_noise;
    out.slope[factor][o] = kept * by_white[o] * noises.by_factor;
    out.slope[lapse][o] = 1.0 / alternatives - own[o];
  }
  return out;
}

}  // namespace

AnswerExpansion answer_expansion(AnswerLattice& lattice, std::size_t patch, const ObserverPlace& place) {
  const ObserverValues values = values_at(place);
  if (lattice.has_eye()) return eye_expansion(lattice, patch, values);
  const double noise = own_noise(lattice.patch(patch), values);
  const double sd = std::max(noise, AnswerLattice::least_noise);
  const auto own = observer_shares(lattice, patch, values[blur], sd);
  const auto by_blur = difference([&](double x) { return lattice.log_probabilities(patch, x, sd); }, values[blur],
                                  AnswerLattice::least_sigma, AnswerLattice::most_sigma);
  const auto by_sd = difference([&](double x) { return lattice.log_probabilities(patch, values[blur], x); }, sd,
                                AnswerLattice::least_noise, AnswerLattice::most_noise);
  // d ln s / d ln n and d ln s / d ln f.
  const double seen = lattice.patch(patch).noise_k / lattice.patch(patch).contrast_k;
  const double by_internal = values[internal] * values[internal] / (sd * sd);
  const double by_factor = std::pow(values[factor] * seen / sd, 2);
  AnswerExpansion out;
  for (std::size_t o = 0; o < alternatives; ++o) {
    const double kept = 1 - values[lapse];
    out.probability[o] = values[lapse] / alternatives + kept * own[o];
    out.slope[blur][o] = kept * by_blur[o];
    out.slope[internal][o] = kept * by_sd[o] * by_internal;
    out.slope[factor][o] = kept * by_sd[o] * by_factor;
    out.slope[lapse][o] = 1.0 / alternatives - own[o];
  }
  return out;
}

Expansion<observer_key_count> person_likelihood(AnswerLattice& lattice, std::span<const PersonAnswer> answers,
                                                const ObserverPlace& place) {
  // A rarer alternative does not affect the slopes: its share of the information is below rounding.
  constexpr double negligible = 1e-12;
  Expansion<observer_key_count> out;
  out.value = 0;
  for (const PersonAnswer& answer : answers) {
    const AnswerExpansion at = answer_expansion(lattice, answer.patch, place);
    const auto given = static_cast<std::size_t>(answer.answer);
    out.value += std::log(at.probability[given]);
    for (std::size_t k = 0; k < observer_key_count; ++k) {
      out.gradient[k] += at.slope[k][given] / at.probability[given];
      for (std::size_t l = 0; l <= k; ++l) {
        double information = 0;
        for (std::size_t o = 0; o < alternatives; ++o) {
          if (at.probability[o] > negligible) information += at.slope[k][o] * at.slope[l][o] / at.probability[o];
        }
        out.hessian[k][l] -= information;
      }
    }
  }
  for (std::size_t k = 0; k < observer_key_count; ++k) {
    for (std::size_t l = k + 1; l < observer_key_count; ++l) out.hessian[k][l] = out.hessian[l][k];
  }
  return out;
}

}  // namespace todbench
