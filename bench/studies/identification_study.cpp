// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/studies/identification_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "acquisition/base/normal.h"
#include "acquisition/base/try.h"
#include "bench/range/turbulent_ranges.h"
#include "hvs/observer/open_parameters.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

constexpr double wanted = 0.75;
constexpr int resamples = 1000;

/// Returns a non-increasing version: neighbours out of order become their mean (pool adjacent violators).
std::vector<double> not_increasing(const std::vector<double>& values) {
  struct Pool {
    double sum = 0;
    std::size_t count = 0;
    [[nodiscard]] double mean() const { return sum / static_cast<double>(count); }
  };
  std::vector<Pool> pools;
  for (const double value : values) {
    pools.push_back({value, 1});
    while (pools.size() > 1 && pools[pools.size() - 2].mean() < pools.back().mean()) {
      pools[pools.size() - 2].sum += pools.back().sum;
      pools[pools.size() - 2].count += pools.back().count;
      pools.pop_back();
    }
  }
  std::vector<double> out;
  for (const auto& pool : pools) out.insert(out.end(), pool.count, pool.mean());
  return out;
}

SetCriterion range_of_75_percent(const IdentificationStudyTask& task, const std::vector<IdentificationPoint>& points,
                                 std::vector<std::string>& notes) {
  const auto proportions = [&](const std::vector<std::size_t>& draws) {
    std::vector<double> out;
    for (const auto& point : points) {
      double sum = 0;
      for (const std::size_t d : draws) sum += point.by_draw[d];
      out.push_back(sum / static_cast<double>(draws.size()));
    }
    return out;
  };
  std::vector<std::size_t> draws(points.front().by_draw.size());
  for (std::size_t d = 0; d < draws.size(); ++d) draws[d] = d;
  // Draws are the independent units: targets, aspects and ranges share them.
  std::vector<Crossing75> resampled;
  const RandomStream numbers(task.seed, "identification.resample");
  for (std::uint64_t r = 0; r < resamples; ++r) {
    std::vector<std::size_t> drawn;
    for (std::uint64_t d = 0; d < draws.size(); ++d) drawn.push_back(numbers.sub(r).below(draws.size(), d));
    resampled.push_back(crossing_of_75_percent(task.ranges_m, proportions(drawn)));
  }
  const Crossing75 found = crossing_of_75_percent(task.ranges_m, proportions(draws));
  SetCriterion out = with_interval(found, resampled);
  if (out.ci95.low && found.interpolation_ln > 0.5 * std::log(*out.value / *out.ci95.low)) {
    notes.push_back(fmt::format(
        "the ranges beside the range of 75 % are far apart: the interpolation between them may be wrong by {:.1f} %, "
        "which is in the intervals; test more ranges near {:.4g} m",
        100 * std::expm1(found.interpolation_ln), *out.value));
  }
  return out;
}

/// Returns the curve between the contrasts of the set at its nearest and farthest range.
Result<std::vector<TodThreshold>> tod_curve_for(const IdentificationStudyTask& task, double dt_k, double least_tau,
                                                std::vector<std::string>& notes) {
  TemplateObserver observer(task.observer, triangle_alternatives());
  SensorSpec sensor = task.sensor;
  if (task.cn2_m_minus_2_3 > 0) sensor.turbulence_cn2_m_minus_2_3 = 0;  // the turbulence of the paths is added later
  const SensorPlan plan = full_plan(sensor, {}, {}, task.motion);
  const double least = dt_k * least_tau / 1.1;
  std::vector<TodThreshold> curve;
  for (const double contrast_k : {least, std::sqrt(least * 1.1 * dt_k), 1.1 * dt_k}) {
    const auto points =
        direct_estimate(sensor, plan, observer, {contrast_k},
                        {.motion = task.motion, .accuracy = task.accuracy, .seed = task.seed, .stop = task.stop});
    if (!points) {
      if (points.error().code == ErrorCode::interrupted) return tl::unexpected(points.error());
      notes.push_back(fmt::format("TOD at {:.3g} K: {}", contrast_k, points.error().message));
      continue;
    }
    const double s75 = points->front().s75_pitch * task.sensor.ifov_mrad();
    const double reach = normal_z95 * points->front().standard_error_pitch / points->front().s75_pitch;
    curve.push_back({contrast_k, s75, {s75 * std::exp(-reach), s75 * std::exp(reach)}});
  }
  return curve;
}

/// M of the set at a range, by the curve behind the turbulence of that path if there is any.
std::optional<double> m_at(const IdentificationStudyTask& task, const IdentificationStudy& study,
                           const std::optional<TurbulentSources>& turbulent, std::optional<double> range_m) {
  if (!range_m || study.tod.empty()) return std::nullopt;
  const auto tau = task.air.air.at(*range_m);
  if (!tau) return std::nullopt;
  const auto curve = turbulent ? turbulent->thresholds_at(study.tod, *range_m) : study.tod;
  if (curve.empty()) return std::nullopt;
  const auto acuity = interpolated_acuity_per_mrad(curve, study.dt_rss_k * *tau);
  if (!acuity) return std::nullopt;
  return 1e3 * study.size_m / *range_m * *acuity;
}

/// Returns the sensor with the turbulence of a range.
SensorSpec turbulent_sensor(const IdentificationStudyTask& task, double range_m) {
  SensorSpec spec = task.sensor;
  if (task.cn2_m_minus_2_3 > 0) {
    spec.turbulence_cn2_m_minus_2_3 = task.cn2_m_minus_2_3;
    spec.turbulence_path_m = range_m;
  }
  return spec;
}

/// Returns the curve of the study at the paths of the experiment and of its predicted range without turbulence.
Result<TurbulentSources> behind_turbulence(const IdentificationStudyTask& task, const IdentificationStudy& study,
                                           const RangeTask& question) {
  TODBENCH_TRY(const auto still, predict_range(study.tod, question));
  const double longest_m = std::max(task.ranges_m.back(), 2.2 * still.r75_ci95_m.high.value_or(0));
  return TurbulentSources::of({.thresholds = study.tod, .sensor = task.sensor}, task.observer, task.cn2_m_minus_2_3,
                              longest_m);
}

Result<void> check_ranges(const IdentificationStudyTask& task) {
  if (task.ranges_m.size() < 2) return fail(ErrorCode::invalid_input, "identification needs at least two ranges");
  for (std::size_t i = 0; i < task.ranges_m.size(); ++i) {
    const double range_m = task.ranges_m[i];
    if (!(range_m > 0) || (i > 0 && range_m <= task.ranges_m[i - 1]))
      return fail(ErrorCode::invalid_input, "ranges must be above 0 m and increase from one to the next");
    if (!task.air.air.at(range_m)) {
      return fail(ErrorCode::invalid_input, fmt::format("the air's table ends at {:g} m and does not cover {:g} m",
                                                        task.air.air.end_m(), range_m));
    }
  }
  return {};
}

/// Reason why the direct estimate has no TOD curve for the pictures of a task; empty if it has one.
std::string no_curve_because(const IdentificationStudyTask& task) {
  if (task.stages)
    return "the TOD curve would be that of the camera without the package; 'enhance' determines the curve behind it";
  if (task.sequence != SequenceObserver::single_frame)
    return "the TOD curve would be that of a single frame, and the observer sums several";
  if (task.motion.moving() && task.cn2_m_minus_2_3 > 0)
    return "the TOD curve behind turbulent paths is that of targets at rest";
  return "";
}

/// Adds the curve of the observer, and what follows from it and from the range with 75 % right: criteria of the set and
/// the predicted range.
Result<void> rate_by_curve(const IdentificationStudyTask& task, double least_tau, IdentificationStudy& study) {
  if (const std::string reason = no_curve_because(task); !reason.empty()) {
    study.notes.push_back("no M75, no V50 and no predicted range: " + reason);
    study.no_m75_because = reason;
    return {};
  }
  TODBENCH_TRY(study.tod, tod_curve_for(task, study.dt_rss_k, least_tau, study.notes));
  if (study.tod.empty()) {
    study.no_m75_because = "no triangle has a threshold at the contrasts of the set, so there is no TOD curve";
    return {};
  }
  const RangeTask question{.size_m = study.size_m, .delta_t_k = study.dt_rss_k, .m75 = task.m75, .air = task.air.air};
  std::optional<TurbulentSources> turbulent;
  if (task.cn2_m_minus_2_3 > 0) {
    TODBENCH_TRY(turbulent, behind_turbulence(task, study, question));
  }
  study.m75 = {
      m_at(task, study, turbulent, study.r75_m.value),
      {m_at(task, study, turbulent, study.r75_m.ci95.high), m_at(task, study, turbulent, study.r75_m.ci95.low)}};
  if (!study.m75.value)
    study.no_m75_because = study.r75_m.value ? "the TOD curve does not reach the contrast of the set at the range found"
                                             : std::string(no_r75);
  const auto v50 = [](std::optional<double> m) { return m ? std::optional(*m / m75_from_v50(1)) : std::nullopt; };
  study.v50 = {v50(study.m75.value), {v50(study.m75.ci95.low), v50(study.m75.ci95.high)}};
  auto predicted =
      turbulent ? turbulent_prediction(*turbulent, study.tod, question) : predict_range(study.tod, question);
  if (!predicted) return tl::unexpected(predicted.error());
  study.predicted = *std::move(predicted);
  return {};
}

/// The study of the observer at an end of its open parameters; its proportions are those of `end` of the spreads.
Result<IdentificationStudy> study_at_end(const IdentificationStudyTask& task, double least_tau,
                                         const IdentificationStudy& study, const TemplateObserverSpec& observer,
                                         double std::pair<double, double>::*end) {
  IdentificationStudyTask seen = task;
  seen.observer = observer;
  IdentificationStudy out;
  out.size_m = study.size_m, out.dt_rss_k = study.dt_rss_k;
  std::vector<double> proportions;
  for (const IdentificationPoint& point : study.points) proportions.push_back((*point.spread).*end);
  out.r75_m.value = crossing_of_75_percent(task.ranges_m, proportions).at;
  TODBENCH_TRY_VOID(rate_by_curve(seen, least_tau, out));
  return out;
}

/// Adds the spreads over the open parameters; none without an eye. M75 is not monotone in them, because better eyes see
/// the triangles better as well.
Result<void> add_spreads(const IdentificationStudyTask& task, double least_tau, IdentificationStudy& study) {
  auto proportions = &std::pair<double, double>::second;  // the best observer comes first
  TODBENCH_TRY(const auto ends, at_open_ends(task.observer, [&](const TemplateObserverSpec& observer) {
                 return study_at_end(task, least_tau, study, observer,
                                     std::exchange(proportions, &std::pair<double, double>::first));
               }));
  if (!ends) return {};
  const auto& [best, worst] = *ends;
  for (SetCriterion IdentificationStudy::*criterion :
       {&IdentificationStudy::r75_m, &IdentificationStudy::m75, &IdentificationStudy::v50}) {
    (study.*criterion).spread =
        spread_of({(study.*criterion).value, (best.*criterion).value, (worst.*criterion).value});
  }
  const auto predicted = [](const IdentificationStudy& one) {
    return one.predicted ? one.predicted->r75_m : std::nullopt;
  };
  study.predicted_spread_m = spread_of({predicted(study), predicted(best), predicted(worst)});
  for (const TodThreshold& point : study.tod) {
    const auto at = [&](const IdentificationStudy& one) -> std::optional<double> {
      const auto same = std::ranges::find(one.tod, point.delta_t_k, &TodThreshold::delta_t_k);
      return same == one.tod.end() ? std::nullopt : std::optional(same->s75_mrad);
    };
    study.tod_spread_mrad.push_back(spread_of({point.s75_mrad, at(best), at(worst)}));
  }
  return {};
}

/// States that stages change the targets differently, as stages that are not linear do.
void add_notes_of_stages(IdentificationStudy& study) {
  constexpr double alike = 0.05;
  for (const IdentificationPoint& point : study.points) {
    if (!point.judged) continue;
    const JudgedPictures& judged = *point.judged;
    if (judged.largest_gain - judged.least_gain <= alike * std::abs(judged.gain)) continue;
    study.notes.push_back(
        fmt::format("at {:g} m the package multiplies the contrast of the views by {:.3g} to {:.3g}: the difference "
                    "between them is "
                    "part of the result",
                    point.range_m, judged.least_gain, judged.largest_gain));
  }
}

}  // namespace

Crossing75 crossing_of_75_percent(const std::vector<double>& at, const std::vector<double>& proportions) {
  const auto p = not_increasing(proportions);
  if (p.front() < wanted) return {};
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    if (p[i + 1] >= wanted) continue;
    const double share = (p[i] - wanted) / (p[i] - p[i + 1]), ln_step = std::log(at[i + 1] / at[i]);
    // No proportion of a finite number of answers proves more.
    static constexpr double surest = 0.9995;
    // Between ranges a factor of 2 apart, a normal function (0.5 in ln range) and a Weibull function of slope 2 cross
    // up to 1.63 times as far away as the logistic function.
    constexpr double of_other_functions = 1.7;
    const auto log_odds = [](double proportion) {
      const double inside = std::clamp(proportion, 1 - surest, surest);
      return std::log(inside / (1 - inside));
    };
    const double logistic_share = (log_odds(p[i]) - log_odds(wanted)) / (log_odds(p[i]) - log_odds(p[i + 1]));
    return {at[i] * std::exp(share * ln_step), false, of_other_functions * std::abs(logistic_share - share) * ln_step};
  }
  return {std::nullopt, true};
}

SetCriterion with_interval(const Crossing75& found, const std::vector<Crossing75>& resampled) {
  constexpr double before_first = 0, beyond_last = std::numeric_limits<double>::infinity();
  std::vector<double> sorted;
  for (const Crossing75& crossing : resampled)
    sorted.push_back(crossing.at.value_or(crossing.beyond_last ? beyond_last : before_first));
  std::sort(sorted.begin(), sorted.end());
  const auto side = [&](std::size_t at) -> std::optional<double> {
    if (sorted[at] == before_first || sorted[at] == beyond_last) return std::nullopt;
    if (!found.at) return sorted[at];
    const double half = std::log(sorted[at] / *found.at);
    return *found.at * std::exp(std::copysign(std::hypot(half, found.interpolation_ln), half));
  };
  const std::size_t outside = sorted.size() / 40;
  return {.value = found.at, .ci95 = {side(outside), side(sorted.size() - 1 - outside)}};
}

Result<IdentificationTask> experiment_of(const IdentificationStudyTask& task) {
  TODBENCH_TRY_VOID(check_ranges(task));
  IdentificationTask experiment;
  experiment.sensor = task.sensor;
  experiment.plan = full_plan(turbulent_sensor(task, task.ranges_m.front()), {}, {}, task.motion);
  experiment.motion = task.motion;
  experiment.sequence = task.sequence;
  experiment.frames = task.frames;
  experiment.stages = task.stages;
  experiment.stage_reach_px = task.stage_reach_px;
  experiment.cn2_m_minus_2_3 = task.cn2_m_minus_2_3;
  experiment.observer = task.observer;
  experiment.accuracy = task.accuracy;
  experiment.knowledge = task.knowledge;
  experiment.cues = task.cues;
  experiment.decisions = task.decisions;
  experiment.seed = task.seed;
  experiment.stop = task.stop;
  experiment.targets = task.set.targets;
  for (const double range_m : task.ranges_m) experiment.ranges.push_back({range_m, *task.air.air.at(range_m)});
  return experiment;
}

namespace {

/// States the detail of a set of pictures; empty for models.
std::string note_of_detail(const IdentificationStudyTask& task) {
  const auto elements_m = element_range_m(task.set);
  if (!elements_m) return "";
  const double pixel_mrad = task.sensor.ifov_mrad() / task.sensor.samples_per_pitch();
  const double pixel_m = 1e-3 * pixel_mrad * task.ranges_m.front();
  std::string note = fmt::format(
      "the pictures of the set have pixels of {:.3g} to {:.3g} m and show no finer detail; at {:g} m a sample of the "
      "sensor is {:.3g} m",
      elements_m->first, elements_m->second, task.ranges_m.front(), pixel_m);
  if (elements_m->second > pixel_m)
    note += fmt::format(
        ". The coarsest pixel is larger than a sample up to {:.4g} m: there the sensor would show detail of the real "
        "targets that the pictures lack, so the proportions are those of the pictures only",
        1e3 * elements_m->second / pixel_mrad);
  return note;
}

/// A study with the means over the views of the set.
IdentificationStudy described(const IdentificationStudyTask& task, const IdentificationTask& experiment) {
  const RadianceScale scale{{task.sensor.wavelength_min_um, task.sensor.wavelength_max_um},
                            task.sensor.scene_temperature_k};
  IdentificationStudy study;
  study.notes = task.set.notes;
  if (std::string note = note_of_detail(task); !note.empty()) study.notes.push_back(std::move(note));
  double views = 0;
  for (const auto& target : experiment.targets) {
    for (const auto& aspect : target.aspects) {
      if (const auto signature = target_signature(aspect, scale)) {
        study.size_m += signature->size_m();
        study.dt_rss_k += signature->dt_rss_k();
      }
      views += 1;
    }
  }
  study.size_m /= views;
  study.dt_rss_k /= views;
  study.chance = 1 / static_cast<double>(task.set.targets.size());
  return study;
}

}  // namespace

Result<IdentificationStudy> rate_found_range(const IdentificationStudyTask& task, const SetCriterion& r75_m) {
  TODBENCH_TRY(const auto experiment, experiment_of(task));
  IdentificationStudy study = described(task, experiment);
  study.r75_m = r75_m;
  TODBENCH_TRY_VOID(rate_by_curve(task, experiment.ranges.back().transmittance, study));
  return study;
}

Result<IdentificationStudy> study_identification(const IdentificationStudyTask& task) {
  TODBENCH_TRY(const auto experiment, experiment_of(task));
  IdentificationStudy study = described(task, experiment);
  TODBENCH_TRY(study.points, identify(experiment));
  add_notes_of_stages(study);
  study.r75_m = range_of_75_percent(task, study.points, study.notes);
  TODBENCH_TRY_VOID(rate_by_curve(task, experiment.ranges.back().transmittance, study));
  TODBENCH_TRY_VOID(add_spreads(task, experiment.ranges.back().transmittance, study));
  return study;
}

}  // namespace todbench
