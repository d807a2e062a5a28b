// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/observer_fit/goodness.h"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <map>

#include "acquisition/base/rng.h"
#include "acquisition/base/try.h"
#include "tod/observer_fit/person_likelihood.h"

namespace todbench {
namespace {

constexpr std::size_t alternatives = 4;
constexpr std::size_t kinds = all_misfit_kinds.size();
using Shares = std::array<double, alternatives>;
using Statistics = std::array<double, kinds>;

/// Least variance of a count: an answer that the model almost excludes counts 20, not thousands, so that it does not
/// hide the rest.
constexpr double least_variance = 0.05;

/// Upper ends of the classes of predicted probability of the right answer.
constexpr std::array class_ends{0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.97, 1.01};

struct Count {
  double answers = 0, observed = 0, expected = 0, variance = 0;
  void add(bool yes, double p) {
    answers += 1;
    observed += yes ? 1 : 0;
    expected += p;
    variance += p * (1 - p);
  }
  [[nodiscard]] double misfit() const { return std::pow(observed - expected, 2) / std::max(variance, least_variance); }
};

/// A sum of numbers against its expectation.
struct Sum {
  double observed = 0, expected = 0, variance = 0;
  /// `weights` sum to 1 over the alternatives that count.
  void add(const Shares& weights, const Shares& numbers, std::size_t given) {
    double mean = 0, square = 0;
    for (std::size_t o = 0; o < alternatives; ++o) {
      mean += weights[o] * numbers[o];
      square += weights[o] * numbers[o] * numbers[o];
    }
    observed += numbers[given];
    expected += mean;
    variance += std::max(0.0, square - mean * mean);
  }
  [[nodiscard]] double misfit() const { return std::pow(observed - expected, 2) / std::max(variance, least_variance); }
};

double surprise_of(double p) {
  // An impossible answer counts as one in 10^12.
  return -std::log(std::max(p, 1e-12));
}

std::size_t class_of(double p) {
  return static_cast<std::size_t>(
      std::find_if(class_ends.begin(), class_ends.end(), [&](double end) { return p < end; }) - class_ends.begin());
}

struct Held {
  std::map<int, Count> cells;
  std::array<std::array<Count, alternatives>, alternatives> confusion;
  std::array<Count, class_ends.size() + 1> classes;
  Sum surprise, wrong;
};

Held hold(std::span<const PersonAnswer> answers, std::span<const Shares> shares) {
  Held out;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const Shares& p = shares[i];
    const auto truth = static_cast<std::size_t>(answers[i].truth), given = static_cast<std::size_t>(answers[i].answer);
    out.cells[answers[i].cell].add(given == truth, p[truth]);
    out.classes[class_of(p[truth])].add(given == truth, p[truth]);
    Shares surprise{}, wrong{}, if_wrong{};
    const double all_wrong = std::max(1 - p[truth], 1e-12);
    for (std::size_t o = 0; o < alternatives; ++o) {
      out.confusion[truth][o].add(given == o, p[o]);
      surprise[o] = surprise_of(p[o]);
      if_wrong[o] = o == truth ? 0 : p[o] / all_wrong;
      wrong[o] = o == truth ? 0 : surprise_of(if_wrong[o]);
    }
    out.surprise.add(p, surprise, given);
    if (given != truth) out.wrong.add(if_wrong, wrong, given);
  }
  return out;
}

Statistics statistics_of(const Held& held) {
  Statistics out{};
  for (const auto& [cell, count] : held.cells) out[0] += count.misfit();
  for (const auto& row : held.confusion) {
    for (const Count& count : row) out[1] += count.misfit();
  }
  for (const Count& count : held.classes) out[2] += count.answers > 0 ? count.misfit() : 0;
  out[3] = held.surprise.misfit();
  out[4] = held.wrong.misfit();
  return out;
}

std::vector<Shares> shares_of(AnswerLattice& lattice, std::span<const PersonAnswer> answers,
                              const ObserverValues& values) {
  std::vector<Shares> out;
  out.reserve(answers.size());
  for (const PersonAnswer& answer : answers) out.push_back(answer_shares(lattice, answer.patch, values));
  return out;
}

std::vector<PersonAnswer> answers_of_model(std::span<const PersonAnswer> asked, std::span<const Shares> shares,
                                           const RandomStream& stream) {
  std::vector<PersonAnswer> out(asked.begin(), asked.end());
  for (std::size_t i = 0; i < out.size(); ++i) {
    double left = stream.uniform(i);
    int given = 0;
    while (given < 3 && left >= shares[i][static_cast<std::size_t>(given)])
      left -= shares[i][static_cast<std::size_t>(given++)];
    out[i].answer = given;
  }
  return out;
}

/// Mean and variance of a statistic over replicates, and the test of a value.
struct Spread {
  double mean = 0, variance = 0;
  [[nodiscard]] double p(double value) const {
    if (!(variance > 0) || !(mean > 0)) return value > mean ? 0 : 1;
    const double scale = variance / (2 * mean), degrees = 2 * mean * mean / variance;
    return boost::math::gamma_q(degrees / 2, std::max(value, 0.0) / (2 * scale));
  }
};

Spread spread_of(const std::vector<Statistics>& replicates, std::size_t kind) {
  Spread out;
  for (const Statistics& r : replicates) out.mean += r[kind] / static_cast<double>(replicates.size());
  for (const Statistics& r : replicates)
    out.variance += std::pow(r[kind] - out.mean, 2) / static_cast<double>(replicates.size() - 1);
  return out;
}

double smallest_p(const Statistics& values, const std::array<Spread, kinds>& spreads) {
  double least = 1;
  for (std::size_t k = 0; k < kinds; ++k) least = std::min(least, spreads[k].p(values[k]));
  return least;
}

}  // namespace

std::string_view to_string(MisfitKind kind) {
  switch (kind) {
    case MisfitKind::contrast_and_size:
      return "contrast_and_size";
    case MisfitKind::confusion:
      return "confusion";
    case MisfitKind::calibration:
      return "calibration";
    case MisfitKind::surprise:
      return "surprise";
    case MisfitKind::wrong_answers:
      return "wrong_answers";
  }
  return "";
}

Result<Goodness> goodness_of(AnswerLattice& lattice, std::span<const PersonAnswer> answers, const PersonFit& fit,
                             const GoodnessOptions& options, std::stop_token stop) {
  CV_Assert(options.replicates >= 19);
  const auto shares = shares_of(lattice, answers, fit.values);
  const Held held = hold(answers, shares);
  const Statistics found = statistics_of(held);
  const RandomStream stream(options.seed, "observer.goodness");
  const PersonFitOptions again{.start = fit.values, .free = fit.free, .intervals = PersonFitOptions::Intervals::none};
  std::vector<Statistics> replicates;
  for (int b = 0; b < options.replicates; ++b) {
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
    const auto drawn = answers_of_model(answers, shares, stream.sub(static_cast<std::uint64_t>(b)));
    TODBENCH_TRY(const auto refit, fit_person(lattice, drawn, again));
    replicates.push_back(statistics_of(hold(drawn, shares_of(lattice, drawn, refit.values))));
  }
  Goodness out;
  out.replicates = options.replicates;
  std::array<Spread, kinds> spreads;
  for (std::size_t k = 0; k < kinds; ++k) {
    spreads[k] = spread_of(replicates, k);
    out.tests[k] = {found[k], spreads[k].mean, spreads[k].p(found[k])};
  }
  const double least = smallest_p(found, spreads);
  const auto as_small = std::count_if(replicates.begin(), replicates.end(),
                                      [&](const Statistics& r) { return smallest_p(r, spreads) <= least; });
  out.p = (1 + static_cast<double>(as_small)) / (1 + static_cast<double>(options.replicates));
  for (const auto& [cell, count] : held.cells)
    out.cells.push_back({cell, count.answers, count.observed, count.expected, std::sqrt(count.variance)});
  for (std::size_t t = 0; t < alternatives; ++t) {
    for (std::size_t o = 0; o < alternatives; ++o) {
      out.confusion[t][o] = held.confusion[t][o].observed;
      out.expected_confusion[t][o] = held.confusion[t][o].expected;
    }
  }
  return out;
}

}  // namespace todbench
