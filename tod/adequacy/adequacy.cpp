// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/adequacy/adequacy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "acquisition/base/normal.h"
#include "tod/adequacy/alternatives.h"
#include "tod/adequacy/contradiction.h"
#include "tod/adequacy/guessing.h"
#include "tod/adequacy/model_test.h"
#include "tod/adequacy/orientation.h"
#include "tod/adequacy/twin_scatter.h"
#include "tod/psychometric/psychometric_model.h"

namespace todbench {
namespace {

// "8.1 %"
std::string percent(double share) {
  return fmt::format("{:.{}g} %", 100 * share, share < 0.995 ? 2 : 3);
}

// Half the 95 % interval in ln threshold on the side of a shift; empty if that side is open.
std::optional<double> half_width(const PsychometricFit& fit, double ln_shift) {
  const std::optional<double>& side = ln_shift < 0 ? fit.ci95.low : fit.ci95.high;
  if (!side || !fit.threshold || !(*side > 0)) return std::nullopt;
  return std::abs(std::log(*side / *fit.threshold));
}

// Half the interval if both sides are closed.
std::optional<double> half_width(const PsychometricFit& fit) {
  const auto low = half_width(fit, -1), high = half_width(fit, 1);
  return low && high ? std::optional((*low + *high) / 2) : std::nullopt;
}

// Effect of an alternative description of the answers on the threshold.
struct Consequence {
  std::string words;
  bool unfit = false;
};

Consequence consequence(const PsychometricFit& fit, double ln_shift, const std::string& description) {
  const auto half = half_width(fit, ln_shift);
  // An open side allows any shift.
  const double allowed = half ? std::max(immaterial_shift, immaterial_share_of_half_width * *half) : INFINITY;
  const bool unfit = std::abs(ln_shift) > allowed;
  const std::string moved = fmt::format("with {} the threshold is {} {}", description,
                                        percent(std::abs(std::expm1(ln_shift))), ln_shift < 0 ? "lower" : "higher");
  if (!half) return {moved + ", and the interval is open on that side", false};
  if (unfit) return {moved + ", more than the allowed " + percent(allowed), true};
  if (std::abs(ln_shift) <= *half) return {moved + ", within the 95 % interval", false};
  return {moved + ", outside the 95 % interval but within the allowed " + percent(allowed), false};
}

class Examination {
 public:
  Examination(const TodPoint& point, const FitOptions& options) : point_(point), fit_(point.fit), options_(options) {
    options_.graded = is_quasi(fit_.interval);
  }

  Adequacy made() {
    if (fit_.verdict == FitVerdict::flat_or_decreasing) {
      add(FindingKind::slope, fit_.slope.value_or(min_slope), min_slope,
          "correct answers do not increase with size: there is no threshold", true);
    }
    if (!options_.graded) {
      if (const auto found = below_chance(point_.levels, false_alarms_of_contradiction))
        add_contradiction(*found, "guessing gives", "the orientations of triangles and answers do not belong together");
    }
    if (fit_.threshold) {
      examine_chance();
      const bool regular = fit_.verdict == FitVerdict::ok || fit_.verdict == FitVerdict::extrapolated;
      if (!fit_.twin_shape) examine_slope();
      examine_extrapolation();
      if (fit_.twin_shape) {
        examine_twin_shape();
      } else if (regular) {
        examine_model();
      } else if (!options_.graded) {
        examine_step();
      }
      examine_direct_estimate();
    }
    examine_frames();
    return {std::move(findings_)};
  }

 private:
  void add(FindingKind kind, double value, double limit, std::string sentence, bool unfit) {
    findings_.push_back({kind, value, limit, std::move(sentence), unfit});
  }

  void examine_slope() {
    if (asks_for_steeper(point_.levels, fit_, options_, false_alarms.departure)) {
      add(FindingKind::slope, *fit_.slope, max_slope,
          "the answers call for a steeper slope than the model allows: the threshold is that of a step function",
          false);
    }
  }

  // The interval refers a likelihood ratio to its limit for many answers. With few answers it may be finite although
  // guessing often gives these answers.
  void examine_chance() {
    if (options_.graded) return;
    const double p = p_guessed(point_.levels);
    if (!(p > false_alarms_of_guessing)) return;
    add(FindingKind::slope, p, false_alarms_of_guessing,
        fmt::format("with a probability of {:.2g}, guessed answers increase as much with size: there are too few "
                    "answers for a threshold",
                    p),
        true);
  }

  void examine_extrapolation() {
    double smallest = INFINITY, largest = 0;
    for (const Level& level : point_.levels) {
      if (level.total <= 0 || level.size <= 0) continue;
      smallest = std::min(smallest, level.size);
      largest = std::max(largest, level.size);
    }
    if (!(largest > 0) || (*fit_.threshold >= smallest && *fit_.threshold <= largest)) return;
    const bool below = *fit_.threshold < smallest;
    add(FindingKind::extrapolation, *fit_.threshold, below ? smallest : largest,
        fmt::format(
            "the threshold lies {} all sizes shown: it is extrapolated and depends on the form of the function alone",
            below ? "below" : "above"),
        true);
  }

  void add_contradiction(const Contradiction& at, const std::string& expected, const std::string& meaning) {
    add(FindingKind::deviance, at.p, false_alarms_of_contradiction,
        fmt::format("at size {:.4g}, {:g} of {:g} answers are correct, but {} {}: the probability of this by chance is "
                    "{:.1g}; {}",
                    at.size, at.correct, at.total, expected, percent(at.expected), at.p, meaning),
        true);
  }

  // At the end of the domain of the slope the score tests do not hold, but every size has an exact distribution.
  void examine_step() {
    const auto found = contradicts_step(point_.levels, fit_, options_.form, false_alarms_of_contradiction);
    // Below chance it is named already.
    if (found && found->correct >= chance_level * found->total)
      add_contradiction(*found, "the fitted step function gives", "no function of this form fits the answers");
    // The threshold adapts to the answers near the step, so that too little scatter means nothing.
    Dispersions scatter = test_model(point_.levels, fit_, std::nullopt, options_, false_alarms).scatter;
    scatter.less = {};
    add_scatter(scatter);
  }

  void examine_model() {
    std::optional<PsychometricFit> free_fit = point_.free_lapse_fit;
    if (!free_fit && options_.fixed_lapse) {
      if (auto made = fit_psychometric(point_.levels, {options_.form, std::nullopt, false, options_.graded}))
        free_fit = *made;
    }
    const ModelTest test = test_model(point_.levels, fit_, free_fit, options_, false_alarms);
    if (test.departure && test.departure->score > test.departure->limit) add_departure(*test.departure);
    if (test.lapse && test.lapse->statistic > test.lapse->limit) add_lapse(*test.lapse, *free_fit);
    add_scatter(test.scatter);
  }

  void examine_twin_shape() {
    examine_twin_departure();
    if (options_.fixed_lapse && point_.free_lapse_fit) {
      const auto test = twin_lapse_test(fit_, *point_.free_lapse_fit, false_alarms.lapse);
      if (test && test->statistic > test->limit) add_lapse(*test, *point_.free_lapse_fit);
    }
    if (const auto scatter = twin_dispersions(point_.levels, fit_, options_)) add_scatter(*scatter);
  }

  void examine_twin_departure() {
    const TwinShapeUse& use = *fit_.twin_shape;
    if (!(use.departure_limit > 0) || std::abs(use.departure) <= use.departure_limit) return;
    const char* asked = use.slope_fitted ? "a bend" : "another slope";
    const Consequence of = consequence(fit_, use.departure_shift, asked);
    add(FindingKind::deviance, use.departure, use.departure_limit,
        fmt::format("the function of the twin does not fit the answers: they call for {} ({:.2g} standard errors, "
                    "limit for chance {:.2g}); {}",
                    use.slope_fitted ? "another bend" : asked, std::abs(use.departure), use.departure_limit, of.words),
        of.unfit);
  }

  void add_departure(const Departure& departure) {
    const auto other = best_alternative(point_.levels, fit_, options_);
    const Consequence of = other ? consequence(fit_, other->ln_shift, other->name)
                                 : Consequence{"no other function fits them either", true};
    add(FindingKind::deviance, departure.score, departure.limit,
        fmt::format("the answers depart from the fitted function {} by {:.2g} standard deviations (limit for chance: "
                    "{:.2g}); {}",
                    departure.towards, departure.score, departure.limit, of.words),
        of.unfit);
  }

  void add_lapse(const LapseTest& test, const PsychometricFit& free_fit) {
    const std::string description = fmt::format("a free lapse rate of {:.2g}", test.lapse);
    const Consequence of = free_fit.threshold
                               ? consequence(fit_, std::log(*free_fit.threshold / *fit_.threshold), description)
                               : Consequence{"with " + description + " there is no threshold", true};
    add(FindingKind::lapse, test.statistic, test.limit,
        fmt::format("the answers contain more lapses than the fit allows for (fixed lapse rate {:.2g}): {}",
                    *options_.fixed_lapse, of.words),
        of.unfit);
  }

  void add_scatter(const Dispersions& scatter) {
    if (scatter.more.p_more() < false_alarms.scatter) {
      const double widening = half_width(fit_).value_or(0) * (std::sqrt(scatter.more.ratio) - 1);
      add(FindingKind::overdispersion, scatter.more.ratio, scatter.more.upper_limit(false_alarms.scatter),
          fmt::format("the scatter of the answers about the fitted function has {:.3g} times the variance expected "
                      "from {}: the interval is too narrow by a factor of {:.2g}",
                      scatter.more.ratio, fit_.clusters > 0 ? "clusters" : "chance", std::sqrt(scatter.more.ratio)),
          scatter.more.ratio > immaterial_dispersion && widening > immaterial_widening);
    } else if (scatter.less.p_less() < false_alarms.scatter) {
      add(FindingKind::underdispersion, scatter.less.ratio, scatter.less.lower_limit(false_alarms.scatter),
          fmt::format("the scatter of the answers about the fitted function has {:.2g} times the variance of "
                      "independent answers: the interval is wider than necessary",
                      scatter.less.ratio),
          false);
    }
  }

  void examine_direct_estimate() {
    if (!point_.direct_s75_mrad || !(*point_.direct_s75_mrad > 0) || !fit_.threshold) return;
    const double difference = std::log(*fit_.threshold / *point_.direct_s75_mrad);
    const auto half = half_width(fit_, -difference);
    if (!half) return;
    constexpr double claimed_errors = 3;
    const double standard_error =
        std::hypot(*half / normal_z95, point_.direct_s75_se_mrad.value_or(0) / *point_.direct_s75_mrad);
    const double allowed = direct_estimate_tolerance + claimed_errors * standard_error;
    if (std::abs(difference) <= allowed) return;
    add(FindingKind::direct_estimate, 100 * std::expm1(difference), 100 * allowed,
        fmt::format("the threshold from the trials and the direct estimate of the same sensor differ by {}, more than "
                    "the {} that their errors allow: one of them is wrong",
                    percent(std::abs(std::expm1(difference))), percent(allowed)),
        true);
  }

  void examine_frames() {
    if (point_.orientations) {
      if (auto finding = orientation_finding(*point_.orientations)) findings_.push_back(*std::move(finding));
    }
    if (point_.saturated_share > 0) {
      add(FindingKind::clipping, point_.saturated_share, 0,
          fmt::format("in {} of the trials, pixels in the window of the triangle are saturated: the observer did not "
                      "judge the contrast that was shown",
                      percent(point_.saturated_share)),
          true);
    }
    if (point_.noise_counts && *point_.noise_counts < least_noise_counts) {
      add(FindingKind::rounding, *point_.noise_counts, least_noise_counts,
          fmt::format("the noise of a pixel is {:.2g} counts: rounding to whole counts does not act as white noise and "
                      "affects the answers of this camera",
                      *point_.noise_counts),
          false);
    }
    if (point_.lag1_correlation && std::abs(*point_.lag1_correlation) > most_lag1_correlation) {
      // Intervals of clusters and of graded answers come from the scatter between presentations, which includes the
      // correlation. Those of independent answers do not.
      const bool interval_knows = !fit_.threshold || fit_.interval != IntervalKind::independent;
      add(FindingKind::temporal_correlation, *point_.lag1_correlation, most_lag1_correlation,
          fmt::format("the noise of successive frames is correlated ({:.2g}): their trials are not independent, and "
                      "the noise of single frames does not describe the camera{}",
                      *point_.lag1_correlation,
                      interval_knows ? "" : "; the interval treats all answers as independent"),
          !interval_knows);
    }
  }

  const TodPoint& point_;
  const PsychometricFit& fit_;
  FitOptions options_;
  std::vector<AdequacyFinding> findings_;
};

}  // namespace

Adequacy adequacy(const TodPoint& point, const FitOptions& options) {
  return Examination(point, options).made();
}

Adequacy adequacy(std::span<const Level> levels, const PsychometricFit& fit, const FitOptions& options) {
  TodPoint point;
  point.levels.assign(levels.begin(), levels.end());
  point.fit = fit;
  return adequacy(point, options);
}

void examine(TodCurve& curve, const FitOptions& options) {
  for (TodPoint& point : curve.points) point.adequacy = adequacy(point, options);
}

}  // namespace todbench
