// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/observer_fit/person_fit.h"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <string>
#include <utility>

#include "acquisition/base/normal.h"
#include "tod/observer_fit/person_likelihood.h"

namespace todbench {
namespace {

using Top = Maximum<observer_key_count>;
using Matrix = std::array<std::array<double, observer_key_count>, observer_key_count>;

ParameterBox<observer_key_count> domain(const PersonFitOptions& options, FittedKind kind) {
  const ObserverPlace start = place_of(options.start, kind);
  ParameterBox<observer_key_count> box{start, start};
  const ObserverPlace least = place_of(observer_limits(kind).least, kind);
  const ObserverPlace most = place_of(observer_limits(kind).most, kind);
  for (std::size_t k = 0; k < observer_key_count; ++k) {
    if (!options.free[k]) continue;
    box.lower[k] = least[k];
    box.upper[k] = most[k];
  }
  return box;
}

/// Profile of the likelihood: one parameter is held, the others are fitted.
class Profile {
 public:
  Profile(AnswerLattice& lattice, std::span<const PersonAnswer> answers, const ParameterBox<observer_key_count>& box,
          const Top& top, std::size_t key)
      : lattice_(lattice), answers_(answers), box_(box), top_(top), key_(key) {}

  /// The signed root of twice the drop of ln likelihood minus the 95 % limit: below 0 inside the interval.
  double operator()(double value) {
    ParameterBox<observer_key_count> held = box_;
    held.lower[key_] = held.upper[key_] = value;
    ObserverPlace start = last_;
    start[key_] = value;
    const Top found =
        climb([&](const ObserverPlace& place) { return person_likelihood(lattice_, answers_, place); }, start, held);
    last_ = found.place;
    return std::sqrt(2 * std::max(0.0, top_.expansion.value - found.expansion.value)) - normal_z95;
  }

  /// The bound in a direction (-1, 1); empty if the domain ends before. `step`: step of the search.
  std::optional<double> bound(double direction, double step) {
    last_ = top_.place;
    const double end = direction < 0 ? box_.lower[key_] : box_.upper[key_];
    double inner = top_.place[key_], inner_drop = -normal_z95;
    while (inner != end) {
      const double outer = direction < 0 ? std::max(end, inner - step) : std::min(end, inner + step);
      const double outer_drop = (*this)(outer);
      if (outer_drop >= 0) return root(inner, outer, inner_drop, outer_drop);
      inner = outer;
      inner_drop = outer_drop;
    }
    return std::nullopt;
  }

 private:
  double root(double a, double b, double fa, double fb) {
    if (fb == 0) return b;
    if (a > b) {
      std::swap(a, b);
      std::swap(fa, fb);
    }
    std::uintmax_t most = 30;
    // 1e-3 of a parameter or of its logarithm: far below its standard error.
    const auto near = [](double low, double high) { return high - low < 1e-3; };
    const auto [low, high] =
        boost::math::tools::toms748_solve([this](double x) { return (*this)(x); }, a, b, fa, fb, near, most);
    return (low + high) / 2;
  }

  AnswerLattice& lattice_;
  std::span<const PersonAnswer> answers_;
  const ParameterBox<observer_key_count>& box_;
  const Top& top_;
  std::size_t key_;
  ObserverPlace last_{};
};

/// At most four steps of Fisher's scoring, each halved until it climbs. One step from a point within the scatter of the
/// estimate is as good as the maximum (Le Cam 1956); the further ones correct for a start further away.
Top few_steps(AnswerLattice& lattice, std::span<const PersonAnswer> answers, const ObserverPlace& start,
              const ParameterBox<observer_key_count>& box) {
  Top at{start, person_likelihood(lattice, answers, start), {}};
  for (int step_count = 0; step_count < 4; ++step_count) {
    at.free = free_variables(at.place, at.expansion.gradient, box);
    const auto step = solve_information(at.expansion.hessian, at.expansion.gradient, at.free, 1e-3);
    if (!step) return at;
    bool climbed = false;
    for (double share = 1; !climbed && share > 0.1; share /= 2) {
      ObserverPlace next = at.place;
      for (std::size_t k = 0; k < observer_key_count; ++k) {
        // Half a unit of a logarithm at a time.
        if (at.free[k])
          next[k] = std::clamp(next[k] + share * std::clamp((*step)[k], -0.5, 0.5), box.lower[k], box.upper[k]);
      }
      const auto there = person_likelihood(lattice, answers, next);
      climbed = there.value > at.expansion.value;
      if (!climbed) continue;
      const double gain = there.value - at.expansion.value;
      at.place = next;
      at.expansion = there;
      if (gain < 0.01) return at;
    }
    if (!climbed) return at;
  }
  return at;
}

std::optional<Matrix> inverse(const Top& top, const std::array<bool, observer_key_count>& free) {
  Matrix out{};
  for (std::size_t k = 0; k < observer_key_count; ++k) {
    if (!free[k]) continue;
    std::array<double, observer_key_count> unit{};
    unit[k] = 1;
    const auto column = solve_information(top.expansion.hessian, unit, free, 0);
    if (!column) return std::nullopt;
    for (std::size_t l = 0; l < observer_key_count; ++l) out[l][k] = free[l] ? (*column)[l] : 0;
  }
  return out;
}

/// A side of a 95 % interval: open, or a natural limit that is reached.
std::optional<double> side(const std::optional<double>& bound, std::size_t key, double direction) {
  const bool logarithmic = key != static_cast<std::size_t>(ObserverKey::lapse);
  if (bound) return logarithmic ? std::exp(*bound) : *bound;
  const bool hard = key == static_cast<std::size_t>(ObserverKey::sensor_noise_factor) ||
                    key == static_cast<std::size_t>(ObserverKey::lapse);
  // A natural limit of both kinds of observers.
  return hard && direction < 0 ? std::optional(observer_limits(FittedKind::blurred).least[key]) : std::nullopt;
}

/// Starts around the given one: more blur and less noise, and the opposite.
std::vector<ObserverPlace> starts_round(const ObserverPlace& start, const std::array<bool, observer_key_count>& free) {
  std::vector<ObserverPlace> out{start};
  for (const double sign : {-1.0, 1.0}) {
    ObserverPlace other = start;
    if (free[0]) other[0] += sign * std::log(1.5);
    if (free[1]) other[1] -= sign * std::log(2.0);
    if (free[2]) other[2] += std::log(1.5);
    if (free[3]) other[3] = 0.02;
    out.push_back(other);
  }
  return out;
}

}  // namespace

std::optional<double> standard_error(const PersonFit& fit, std::size_t key) {
  if (!fit.covariance || !fit.free[key]) return std::nullopt;
  return std::sqrt((*fit.covariance)[key][key]);
}

std::optional<double> correlation(const PersonFit& fit, std::size_t a, std::size_t b) {
  const auto of_a = standard_error(fit, a), of_b = standard_error(fit, b);
  if (!of_a || !of_b || *of_a == 0 || *of_b == 0) return std::nullopt;
  return (*fit.covariance)[a][b] / (*of_a * *of_b);
}

Result<PersonFit> fit_person(AnswerLattice& lattice, std::span<const PersonAnswer> answers,
                             const PersonFitOptions& options) {
  if (answers.empty()) return fail(ErrorCode::invalid_input, "there are no answers to fit");
  if (std::none_of(options.free.begin(), options.free.end(), [](bool free) { return free; }))
    return fail(ErrorCode::invalid_input, "no parameter is free");
  const FittedKind kind = lattice.has_eye() ? FittedKind::eye : FittedKind::blurred;
  const ObserverLimits limits = observer_limits(kind);
  for (std::size_t k = 0; k < observer_key_count; ++k) {
    // An observer without noise answers as with the least noise of the lattice.
    const bool least = k == static_cast<std::size_t>(ObserverKey::internal_noise);
    if (options.start[k] <= limits.most[k] && (least ? options.start[k] >= 0 : options.start[k] >= limits.least[k]))
      continue;
    return fail(ErrorCode::invalid_input, std::string(parameter_name(all_observer_keys[k], kind)) +
                                              " of the starting observer is outside the range of the fit");
  }
  const auto likelihood = [&](const ObserverPlace& place) { return person_likelihood(lattice, answers, place); };
  const ParameterBox<observer_key_count> box = domain(options, kind);
  std::optional<Top> top;
  const bool only_here = options.intervals == PersonFitOptions::Intervals::none;
  const auto starts = only_here ? std::vector{place_of(options.start, kind)}
                                : starts_round(place_of(options.start, kind), options.free);
  for (const ObserverPlace& start : starts) {
    const Top found = only_here ? few_steps(lattice, answers, start, box) : climb(likelihood, start, box);
    if (!top || found.expansion.value > top->expansion.value) top = found;
  }
  PersonFit out;
  out.values = values_at(top->place);
  out.free = options.free;
  out.covariance = inverse(*top, options.free);
  out.log_likelihood = top->expansion.value;
  out.answers = answers.size();
  for (std::size_t k = 0; k < observer_key_count; ++k) {
    if (!options.free[k]) {
      out.values[k] = options.start[k];
      continue;
    }
    out.at_limit[k] = top->place[k] <= box.lower[k] || top->place[k] >= box.upper[k];
    if (only_here) continue;
    Profile profile(lattice, answers, box, *top, k);
    const double se = standard_error(out, k).value_or(0.2);
    const double step = std::clamp(2 * se, 0.02, 0.7);
    out.ci95[k] = {side(profile.bound(-1, step), k, -1), side(profile.bound(1, step), k, 1)};
  }
  return out;
}

}  // namespace todbench
