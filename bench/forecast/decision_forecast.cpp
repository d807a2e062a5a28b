// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/decision_forecast.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "acquisition/base/distributions.h"
#include "acquisition/base/normal.h"
#include "acquisition/base/try.h"
#include "bench/forecast/bench_time.h"
#include "bench/forecast/contrast_forecast.h"
#include "bench/forecast/limit_forecast.h"
#include "bench/forecast/ramp_advice.h"
#include "bench/plan/plan_options.h"
#include "bench/report/number_format.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr double upper_tail = 0.025;
/// Shrinkage of the deciding interval that counts as none.
constexpr double matters = 0.05;
constexpr int camera_step_percent = 1, largest_camera_percent = 10;

double percent_of_ln(double ln) {
  return 100 * std::expm1(ln);
}

/// Half-width that decides, from the standard error that a run states for its trials.
double deciding_half_ln(double stated_se, const ExpectedUncertainty& expected, const LimitsPlan& limits) {
  if (limits.rule == ConformityRule::simple) return 0;
  const double statistical = expected.interval_factor * stated_se;
  JoinedUncertainty all = expected.stated;
  all.add(statistical / distribution::quantile_above(upper_tail, expected.degrees_of_freedom),
          expected.degrees_of_freedom);
  const double half = std::max(statistical, all.half_width(upper_tail));
  if (!limits.guard_band_risk) return half;
  return *limits.guard_band_risk == 0.5 ? 0
                                        : half * all.half_width(*limits.guard_band_risk) / all.half_width(upper_tail);
}

/// Chances of the decisions for any camera, with the half-widths of equally likely runs.
class ChancesOf {
 public:
  ChancesOf(const ExpectedUncertainty& expected, const LimitsPlan& limits)
      : rule_(limits.rule), sd_(std::hypot(expected.se, expected.stated.u())) {
    const int runs = expected.degrees_of_freedom ? 200 : 1;
    for (int i = 0; i < runs; ++i) {
      double ratio = 1;
      if (expected.degrees_of_freedom) {
        const double freedom = *expected.degrees_of_freedom;
        ratio = std::sqrt(distribution::quantile(distribution::ChiSquared(freedom), (i + 0.5) / runs) / freedom);
      }
      halves_ln_.push_back(deciding_half_ln(ratio * expected.se, expected, limits));
    }
  }

  [[nodiscard]] DecisionChances at(double ln_over_limit) const {
    const distribution::Normal normal;
    DecisionChances sum;
    for (const double half : halves_ln_) {
      sum.pass += cdf(normal, (ln_over_limit - half) / sd_);
      sum.fail += cdf(normal, (-ln_over_limit - half) / sd_);
    }
    const auto runs = static_cast<double>(halves_ln_.size());
    sum.pass /= runs;
    sum.fail = rule_ == ConformityRule::guarded ? 1 - sum.pass : sum.fail / runs;
    sum.inconclusive = std::max(0.0, 1 - sum.pass - sum.fail);
    return sum;
  }

  [[nodiscard]] double mean_half_ln() const {
    double sum = 0;
    for (const double half : halves_ln_) sum += half;
    return sum / static_cast<double>(halves_ln_.size());
  }

 private:
  ConformityRule rule_;
  double sd_;
  std::vector<double> halves_ln_;
};

JoinedUncertainty stated_rows(const PointUncertainty& point) {
  JoinedUncertainty stated;
  for (const AppliedRow& row : point.rows) {
    if (row.row.name != finite_trials_row) stated.add(row.contribution, row.row.degrees_of_freedom);
  }
  return stated;
}

/// Mean and spread of ln acuity over that of the limit in the fleet of the plan; empty: not stated.
std::optional<Fleet> fleet_of(const LimitsPlan& limits, double delta_t_k, double ln_expected, double ln_limit) {
  if (limits.fleet_sd_percent)
    return Fleet{.mean = ln_expected - ln_limit, .sd = std::log1p(*limits.fleet_sd_percent / 100)};
  for (const FleetRow& row : limits.fleets) {
    if (row.measure == fleet_acuity && row.delta_t_k && same_contrast(*row.delta_t_k, delta_t_k))
      return Fleet{.mean = std::log(row.mean) - ln_limit, .sd = row.sd};
  }
  return std::nullopt;
}

void add_risks(DecisionDesign& design, const ChancesOf& chances, const Fleet& fleet) {
  constexpr int steps = 240;
  constexpr double reach = 6;
  double consumer = 0, producer = 0, all = 0;
  for (int i = 0; i <= steps; ++i) {
    const double z = reach * (2.0 * i / steps - 1), weight = std::exp(-z * z / 2);
    const double unit = fleet.mean + z * fleet.sd, accepted = chances.at(unit).pass;
    (unit < 0 ? consumer : producer) += weight * (unit < 0 ? accepted : 1 - accepted);
    all += weight;
  }
  design.consumer_risk = consumer / all;
  design.producer_risk = producer / all;
}

/// Plans that are compared: all settings of one knob.
std::vector<Plan> varied_plans(const Plan& plan, const ExperimentInputs& inputs) {
  std::vector<Plan> plans{plan};
  Plan other = plan;
  if (plan.schedule.kind == ScheduleKind::adaptive) {
    for (const double factor : {4.0, 2.0, 0.5, 0.25}) {
      other.schedule.half_width_percent = std::min(100.0, factor * plan.schedule.half_width_percent);
      plans.push_back(other);
    }
  } else if (plan.schedule.kind == ScheduleKind::ramp) {
    const double planned = plan.schedule.ramp_k_per_s.value_or(0);
    const double largest =
        largest_ramp_rate(plan.schedule.from_delta_t_k.value_or(0), plan.target.max_contrast_lag_s.value_or(0));
    for (const double factor : {4.0, 2.0, 0.5, 0.25}) {
      const double rate = std::min(factor * planned, largest);
      if (rate == planned || rate == plans.back().schedule.ramp_k_per_s) continue;
      other.schedule.ramp_k_per_s = rate;
      plans.push_back(other);
    }
  } else if (chosen_answers(plan, inputs.sensor).kind == AnswerKind::graded) {
    for (int frames = 1; frames <= 64; frames *= 2) {
      other.schedule.frames_per_presentation = {frames};
      if (plan.schedule.frames_per_presentation != other.schedule.frames_per_presentation) plans.push_back(other);
    }
  } else {
    for (const double factor : {0.25, 0.5, 2.0, 4.0}) {
      const int phases = static_cast<int>(std::lround(factor * plan.target.phases));
      other.target.phases = other.simulation.phases = std::max(1, phases);
      if (phases >= 1) plans.push_back(other);
    }
  }
  return plans;
}

DecisionForecast forecast_of(const AcuityLimit& limit, double expected_per_mrad, const CurveUncertainty* budget) {
  DecisionForecast forecast{.delta_t_k = limit.delta_t_k,
                            .least_acuity_per_mrad = limit.least_acuity_per_mrad,
                            .expected_over_limit_percent = 100 * (expected_per_mrad / limit.least_acuity_per_mrad - 1)};
  const PointUncertainty* point = budget != nullptr ? point_at(*budget, limit.delta_t_k) : nullptr;
  if (point == nullptr) return forecast;
  const JoinedUncertainty stated = stated_rows(*point);
  forecast.floor_percent = percent_of_ln(stated.half_width(upper_tail));
  forecast.smallest_half_width_percent = percent_of_ln(smallest_half_width_ln(stated));
  for (const AppliedRow& row : point->rows) {
    if (row.row.name == finite_trials_row || row.contribution == 0) continue;
    forecast.rows.push_back({row.row.name, percent_of_ln(normal_z95 * std::abs(row.contribution))});
  }
  std::ranges::stable_sort(forecast.rows, std::ranges::greater{}, &FloorRow::half_width_percent);
  return forecast;
}

/// A design of `plan` for the limit of `forecast`; empty without a threshold.
std::optional<DecisionDesign> design_of(const Plan& plan, const ContrastPrediction& contrast, double bench_s,
                                        const DecisionForecast& forecast, const CurveUncertainty* budget) {
  const auto expected = expected_uncertainty(contrast, budget);
  if (!expected) return std::nullopt;
  const ChancesOf chances(*expected, plan.limits);
  LimitsPlan two_sided = plan.limits;
  two_sided.rule = ConformityRule::guarded_acceptance_and_rejection;
  two_sided.guard_band_risk.reset();
  ExpectedUncertainty trials = *expected;
  trials.stated = {};
  DecisionDesign design{.frames = plan.schedule.frames_per_presentation,
                        .phases = plan.target.phases,
                        .contrast_frames = plan.measurement.contrast_frames,
                        .ramp_k_per_s = std::nullopt,
                        .asked_percent = std::nullopt,
                        .bench_s = bench_s,
                        .half_width_percent = percent_of_ln(ChancesOf(trials, two_sided).mean_half_ln()),
                        .deciding_percent = percent_of_ln(ChancesOf(*expected, two_sided).mean_half_ln())};
  if (plan.schedule.kind == ScheduleKind::ramp) design.ramp_k_per_s = plan.schedule.ramp_k_per_s;
  if (plan.schedule.kind == ScheduleKind::adaptive) design.asked_percent = plan.schedule.half_width_percent;
  for (int over = -largest_camera_percent; over <= largest_camera_percent; over += camera_step_percent)
    design.cameras.push_back({static_cast<double>(over), chances.at(std::log1p(over / 100.0))});
  const double ln_limit = std::log(forecast.least_acuity_per_mrad);
  const double ln_expected = ln_limit + std::log1p(forecast.expected_over_limit_percent / 100);
  if (const auto fleet = fleet_of(plan.limits, forecast.delta_t_k, ln_expected, ln_limit))
    add_risks(design, chances, *fleet);
  return design;
}

void finish(DecisionForecast& forecast) {
  std::ranges::stable_sort(forecast.designs, {}, &DecisionDesign::bench_s);
  if (!(forecast.smallest_half_width_percent > 0)) return;
  const auto enough = std::ranges::find_if(forecast.designs, [&](const DecisionDesign& design) {
    return design.half_width_percent <= forecast.smallest_half_width_percent;
  });
  if (enough != forecast.designs.end()) forecast.enough_bench_s = enough->bench_s;
}

}  // namespace

const ContrastPrediction* expected_at(const PlanPrediction& prediction, double delta_t_k) {
  const auto found = std::ranges::find_if(prediction.contrasts, [&](const ContrastPrediction& contrast) {
    return same_contrast(contrast.delta_t_k, delta_t_k) && contrast.s75_mrad;
  });
  return found == prediction.contrasts.end() ? nullptr : &*found;
}

std::optional<ExpectedUncertainty> expected_uncertainty(const ContrastPrediction& contrast,
                                                        const CurveUncertainty* budget) {
  if (!(contrast.se_ln_s75 > 0) || !(contrast.interval_factor > 0)) return std::nullopt;
  ExpectedUncertainty expected{.se = contrast.se_ln_s75,
                               .interval_factor = contrast.interval_factor,
                               .degrees_of_freedom = contrast.degrees_of_freedom};
  const PointUncertainty* point = budget != nullptr ? point_at(*budget, contrast.delta_t_k) : nullptr;
  if (point != nullptr) expected.stated = stated_rows(*point);
  return expected;
}

DecisionChances decision_chances(double ln_over_limit, const ExpectedUncertainty& expected, const LimitsPlan& limits) {
  return ChancesOf(expected, limits).at(ln_over_limit);
}

double smallest_half_width_ln(const JoinedUncertainty& stated) {
  return stated.half_width(upper_tail) * std::sqrt(std::pow(1 + matters, 2) - 1);
}

double laboratory_time(Plan plan, const ExperimentInputs& inputs, const std::vector<AdaptiveRun>& runs) {
  if (plan.target.kind == TargetKind::scene) plan.target.kind = TargetKind::scpi;
  return bench_time(plan, inputs.plates, inputs.sensor.frame_rate_hz, runs).total_s();
}

Result<std::vector<double>> floors_ln(const Plan& plan, const PlanPrediction& prediction) {
  TODBENCH_TRY(const auto budget, curve_uncertainty(plan, expected_curve(prediction), {}, std::nullopt));
  std::vector<double> floors;
  for (const ContrastPrediction& contrast : prediction.contrasts) {
    const PointUncertainty* point = budget ? point_at(*budget, contrast.delta_t_k) : nullptr;
    floors.push_back(point != nullptr ? stated_rows(*point).half_width(upper_tail) : 0);
  }
  return floors;
}

Result<std::vector<DecisionForecast>> decision_forecasts(const Plan& asked, const ExperimentInputs& inputs) {
  std::vector<DecisionForecast> forecasts;
  if (asked.limits.acuity.empty()) return forecasts;
  Plan plan = as_measured(with_frames(asked, inputs));
  if (plan.camera.id.empty()) plan.target.phases = plan.simulation.phases;
  TODBENCH_TRY(const auto planned, predict_plan(plan, inputs));
  TODBENCH_TRY(const auto budget, curve_uncertainty(plan, expected_curve(planned), {}, std::nullopt));
  const CurveUncertainty* rows = budget ? &*budget : nullptr;
  int most_contrast_frames = 0;
  for (const AcuityLimit& limit : plan.limits.acuity) {
    const ContrastPrediction* contrast = expected_at(planned, limit.delta_t_k);
    if (contrast == nullptr) continue;
    DecisionForecast& forecast = forecasts.emplace_back(forecast_of(limit, 1 / *contrast->s75_mrad, rows));
    forecast.contrast_percent = percent_of_ln(contrast->contrast_half_width);
    TODBENCH_TRY(forecast.contrast_frames,
                 deciding_contrast_frames(plan, inputs, *contrast, limit.least_acuity_per_mrad,
                                          std::log1p(forecast.floor_percent / 100)));
    most_contrast_frames = std::max(most_contrast_frames, forecast.contrast_frames.value_or(0));
  }
  std::vector<Plan> plans = varied_plans(plan, inputs);
  if (most_contrast_frames > plan.measurement.contrast_frames) {
    Plan other = plan;
    other.measurement.contrast_frames = most_contrast_frames;
    const std::vector<Plan> more = varied_plans(other, inputs);
    plans.insert(plans.end(), more.begin(), more.end());
  }
  for (std::size_t i = 0; i < plans.size(); ++i) {
    TODBENCH_TRY(const auto prediction, predict_plan(plans[i], inputs));
    const double bench_s = laboratory_time(plans[i], inputs, prediction.runs);
    for (DecisionForecast& forecast : forecasts) {
      const ContrastPrediction* contrast = expected_at(prediction, forecast.delta_t_k);
      if (contrast == nullptr) continue;
      auto design = design_of(plans[i], *contrast, bench_s, forecast, rows);
      if (!design) continue;
      design->planned = i == 0;
      forecast.designs.push_back(*std::move(design));
    }
  }
  std::ranges::for_each(forecasts, finish);
  return forecasts;
}

std::string open_by_budget(const Plan& plan, const std::vector<ContrastPrediction>& contrasts,
                           const CurveUncertainty* budget, double probability) {
  std::vector<std::string> open;
  for (const ContrastPrediction& contrast : contrasts) {
    auto rows_alone = expected_uncertainty(contrast, budget);
    if (!rows_alone || !contrast.s75_mrad || !(rows_alone->stated.u() > 0)) continue;
    rows_alone->se *= 1e-6;
    for (const AcuityLimit& limit : plan.limits.acuity) {
      if (!same_contrast(limit.delta_t_k, contrast.delta_t_k)) continue;
      const double over = -std::log(*contrast.s75_mrad * limit.least_acuity_per_mrad);
      if (1 - decision_chances(over, *rows_alone, plan.limits).inconclusive >= probability) continue;
      open.push_back(
          fmt::format("at {} K the acuity is {} % from its limit, and the stated rows of the budget make ± {} %",
                      number_text(contrast.delta_t_k), significant(percent_of_ln(std::abs(over)), 2),
                      significant(percent_of_ln(rows_alone->stated.half_width(upper_tail)), 2)));
    }
  }
  return open.empty() ? "" : fmt::format("{}, which no presentation reduces", fmt::join(open, "; "));
}

std::string in_words(const DecisionForecast& forecast) {
  std::string text = fmt::format("{} K, at least {} 1/mrad: ", number_text(forecast.delta_t_k),
                                 number_text(forecast.least_acuity_per_mrad));
  const std::string of_contrast =
      forecast.contrast_frames
          ? fmt::format(
                ". The measured contrast alone makes ± {} %, which no presentation reduces; with {} frames of "
                "the contrast ([measurement] contrast_frames) presentations decide",
                significant(forecast.contrast_percent, 2), *forecast.contrast_frames)
          : "";
  if (forecast.rows.empty())
    return text + "the plan states no rows of a budget" +
           (of_contrast.empty() ? ", so that every further presentation narrows the interval" : of_contrast);
  text += fmt::format(
      "the stated rows of the budget make ± {} % (95 %), of which {} alone makes ± {} %. The smallest "
      "half-width of the trials that matters is {} %: below it the deciding interval shrinks by less than 5 %",
      significant(forecast.floor_percent, 2), forecast.rows.front().name,
      significant(forecast.rows.front().half_width_percent, 2), significant(forecast.smallest_half_width_percent, 2));
  text += forecast.enough_bench_s
              ? fmt::format(". {:.0f} s of bench time are enough for it; more frames hardly shorten the interval",
                            *forecast.enough_bench_s)
              : std::string(". None of these designs is that precise: more frames still narrow the interval");
  return text + of_contrast;
}

}  // namespace todbench
