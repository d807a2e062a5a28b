// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/adequacy/model_test.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "acquisition/base/distributions.h"

namespace todbench {
namespace {

// Limit that a normal variable, or Student's t with clusters, exceeds on one side with `probability`.
double limit_of(double probability, double clusters) {
  return distribution::quantile_above(probability, clusters > 1 ? std::optional(clusters - 1) : std::nullopt);
}

// The member of another family nearest to the fitted function: fitted to the expected answers of the fit, so that it
// does not depend on the scatter of the answers.
PsychometricPlace nearest_of(const ModelResiduals& model, PsychometricForm form, double lapse) {
  PooledCounts expected = model.counts;
  for (std::size_t i = 0; i < expected.levels.size(); ++i) {
    expected.levels[i].right = model.levels[i].trials * model.levels[i].right;
    expected.levels[i].wrong = model.levels[i].trials * model.levels[i].wrong;
  }
  ParameterBox<3> box = search_box(lapse);
  const auto likelihood = [&](const PsychometricPlace& place) { return expand_likelihood(expected, form, place); };
  return climb<3>(likelihood, {model.place[place_t], model.place[place_q], lapse}, box).place;
}

std::vector<double> difference(const std::vector<double>& a, const ModelResiduals& model) {
  std::vector<double> d;
  for (std::size_t i = 0; i < a.size(); ++i) d.push_back(a[i] - model.levels[i].logit);
  return d;
}

// Log odds towards another chance level at the same threshold.
std::vector<double> towards_chance(const ModelResiduals& model, double chance) {
  std::vector<double> weights;
  for (const LevelResidual& level : model.levels) {
    const double share = level.wrong / (1 - chance_level);
    const double wrong = (1 - chance) * share;
    weights.push_back(level.wrong > 1e-12 ? std::log((1 - wrong) / wrong) - level.logit : 0);
  }
  return weights;
}

// Squared distance from the threshold in widths of the function, limited to the range in which the function has a
// slope.
std::vector<double> towards_bend(const ModelResiduals& model) {
  std::vector<double> weights;
  const double slope = std::exp(model.place[place_q]);
  for (const LevelResidual& level : model.levels) {
    const double y = std::clamp(slope * (level.ln_size - model.place[place_t]), -3.0, 1.5);
    weights.push_back(level.catch_trials ? 0 : y * y);
  }
  return weights;
}

// The best threshold (and lapse) at one slope, from starts over one width of the function about t.
Maximum<3> profile_maximum_over_t(const PooledCounts& counts, const FitOptions& options, double t, double q) {
  ParameterBox<3> box = search_box(options.fixed_lapse);
  box.lower[place_q] = box.upper[place_q] = q;
  const auto likelihood = [&](const PsychometricPlace& place) {
    return expand_likelihood(counts, options.form, place);
  };
  const double width = std::exp(-q), lapse = options.fixed_lapse.value_or(0.01);
  Maximum<3> best = climb<3>(likelihood, {t, q, lapse}, box);
  for (const double aside : {-2.0, -1.0, 1.0, 2.0}) {
    const Maximum<3> m = climb<3>(likelihood, {t + aside * width, q, lapse}, box);
    if (m.expansion.value > best.expansion.value) best = m;
  }
  return best;
}

enum class Sides { one, both };

struct Test {
  std::string towards, away;
  Sides sides = Sides::one;
  double share = 1;  // of the probability of a false alarm
  Direction direction;
};

class Tester {
 public:
  Tester(const ModelResiduals& model, std::span<const Level> levels, const PsychometricFit& fit)
      : model_(model), levels_(levels), clusters_(fit.clusters), graded_(is_quasi(fit.interval)), make_(model) {}

  void add(std::string towards, std::string away, Sides sides, double share, std::vector<double> weights) {
    if (auto direction = make_.direction(std::move(weights)))
      tests_.push_back({std::move(towards), std::move(away), sides, share, *std::move(direction)});
  }

  // Variance of a score over clusters, at least 1; graded answers scatter less than right and wrong ones.
  [[nodiscard]] double variance(const Direction& direction) const {
    if (clusters_ < 2) return 1;
    const double found = cluster_covariance(model_, levels_, {&direction, 1}, clusters_).front();
    return graded_ && found > 0 ? found : std::max(1.0, found);
  }

  [[nodiscard]] std::optional<Departure> strongest(double probability) const {
    std::optional<Departure> found;
    for (const Test& test : tests_) {
      const double limit = limit_for(test, probability);
      double score = test.direction.score / std::sqrt(variance(test.direction));
      const bool away = score < 0 && test.sides == Sides::both;
      if (away) score = -score;
      if (!found || score / limit > found->score / found->limit)
        found = Departure{away ? test.away : test.towards, score, limit};
    }
    return found;
  }

  // Directions in which the answers depart significantly.
  [[nodiscard]] std::vector<Direction> left(double probability) const {
    std::vector<Direction> directions;
    for (const Test& test : tests_) {
      const double score = std::abs(test.direction.score) / std::sqrt(variance(test.direction));
      if (score < limit_for(test, probability)) continue;
      if (auto rest = make_.direction(test.direction.weights, directions)) directions.push_back(*std::move(rest));
    }
    return directions;
  }

 private:
  [[nodiscard]] double limit_for(const Test& test, double probability) const {
    return limit_of(probability * test.share / (test.sides == Sides::both ? 2 : 1), clusters_);
  }

  const ModelResiduals& model_;
  std::span<const Level> levels_;
  double clusters_;
  bool graded_;
  Directions make_;
  std::vector<Test> tests_;
};

}  // namespace

bool asks_for_steeper(std::span<const Level> levels, const PsychometricFit& fit, const FitOptions& options,
                      double probability) {
  if (!fit.slope_at_cap || !fit.threshold || !fit.log_likelihood || fit.clusters == 1) return false;
  const PooledCounts counts = pool(levels);
  const double q = std::log(max_slope / 2);
  const Maximum<3> half = profile_maximum_over_t(counts, options, counts.relative(*fit.threshold), q);
  const double limit = limit_of(probability, fit.clusters);
  return 2 * (*fit.log_likelihood - half.expansion.value) > fit.variance_inflation * limit * limit;
}

ModelTest test_model(std::span<const Level> levels, const PsychometricFit& fit,
                     const std::optional<PsychometricFit>& free_fit, const FitOptions& options,
                     const FalseAlarms& probability) {
  ModelTest result;
  if (fit.clusters == 1 || !fit.threshold || !fit.slope) return result;
  const PooledCounts counts = pool(levels);
  // A free lapse at the end of its range counts as fixed.
  const bool lapse_fitted = !options.fixed_lapse && fit.lapse > 0 && fit.lapse < max_free_lapse;
  const PsychometricPlace place{counts.relative(*fit.threshold), std::log(*fit.slope), fit.lapse};
  const ModelResiduals model = model_residuals(counts, options.form, place, {true, true, lapse_fitted});
  Tester tester(model, levels, fit);
  const bool size = options.form == PsychometricForm::size;
  const PsychometricForm other = size ? PsychometricForm::acuity : PsychometricForm::size;
  tester.add(std::string("towards the ") + (size ? "acuity" : "size") + " form", "", Sides::one, 0.5,
             difference(logits_at(model, other, nearest_of(model, other, fit.lapse)), model));
  tester.add("towards more correct answers at small sizes than guessing gives",
             "towards fewer correct answers at small sizes than guessing gives", Sides::both, 0.25,
             towards_chance(model, 0.3));
  tester.add("towards an upward bend", "towards a downward bend", Sides::both, 0.25, towards_bend(model));
  result.departure = tester.strongest(probability.departure);

  if (options.fixed_lapse && free_fit && free_fit->log_likelihood && fit.log_likelihood) {
    const double alternative = std::min(*options.fixed_lapse + 0.03, max_free_lapse);
    const auto direction = Directions(model).direction(
        difference(logits_at(model, options.form, nearest_of(model, options.form, alternative)), model));
    const double gain = 2 * (*free_fit->log_likelihood - *fit.log_likelihood);
    const double limit = limit_of(probability.lapse, fit.clusters);
    if (direction && free_fit->lapse > *options.fixed_lapse)
      result.lapse = LapseTest{free_fit->lapse, std::max(0.0, gain) / tester.variance(*direction), limit * limit};
  }
  // The scatter of graded answers is estimated, so that it cannot be tested.
  if (is_quasi(fit.interval)) return result;
  result.scatter = dispersions(model, levels, tester.left(probability.departure), fit.clusters);
  return result;
}

}  // namespace todbench
