#include "bench/gui/plan_outlook.h"

#include <algorithm>
#include <cmath>

#include "bench/session/descriptions.h"
#include "bench/session/plan_options.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "tod/planning.h"
#include "tod/test_pattern.h"

namespace todbench {
namespace {

constexpr double chance = 0.25;
constexpr double normal_95 = 1.959963984540054;
constexpr double variance_inflation = 1.2;  ///< typical of the shipped plates with 8 to 16 phases

/// Slope of ln(-ln((1 - p) / (1 - g))) against ln size where p says something about it.
double weibull_slope(const DirectPoint& point, double fallback) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < point.sizes_pitch.size(); ++i) {
    const double p = point.proportion_correct[i];
    if (p < 0.35 || p > 0.97) continue;
    const double x = std::log(point.sizes_pitch[i]);
    const double y = std::log(-std::log((1 - p) / (1 - chance)));
    ++n, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  const double spread = n * sxx - sx * sx;
  if (n < 2 || !(spread > 1e-9)) return fallback;
  const double slope = (n * sxy - sx * sy) / spread;
  return slope > 0.3 && slope < 30 ? slope : fallback;
}

/// Standard error of ln S75 with one presentation of every plate: that of many, scaled.
std::optional<double> se_ln_once(const Plan& plan, const std::vector<double>& sizes_mrad, double s75, double slope) {
  constexpr double many = 100;
  std::vector<Level> totals;
  for (const double size : sizes_mrad) totals.push_back({.size = size, .correct = 0, .total = many});
  const FitOptions options = fit_options(plan);
  const auto design = design_at(totals, options.form, s75, slope, options.fixed_lapse.value_or(0));
  const auto expected = expected_fit(design, options);
  if (!expected) return std::nullopt;
  return expected->se_ln_threshold * std::sqrt(many * variance_inflation);
}

std::vector<double> sizes_of(const Plan& plan, const std::vector<TargetPlate>& plates) {
  std::vector<double> sizes_mrad;
  for (const auto& plate : plates) {
    for (const auto& t : plate.triangles) sizes_mrad.push_back(t.size_mm / plan.target.distance_m);
  }
  return sizes_mrad;
}

double duration_s(const TargetPlan& target, double presentations, double frames_per_set_up, double frame_rate_hz) {
  const auto plates = static_cast<double>(target.plates.size());
  const auto mountings = static_cast<double>(target.mountings.size());
  const auto contrasts = static_cast<double>(target.delta_t_k.size());
  // Nested so that what takes longest changes least often.
  std::vector<std::pair<double, double>> levels{
      {target.plate_change_s, plates}, {target.mounting_change_s, mountings}, {target.contrast_change_s, contrasts}};
  std::stable_sort(levels.begin(), levels.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  double changes = 1, seconds = 0;
  for (const auto& [cost, count] : levels) {
    changes *= count;
    seconds += cost * changes;
  }
  // Per presentation: the shift, two exposures in flight, the one that is measured.
  seconds += presentations * (target.shift_change_s + 3 / frame_rate_hz);
  return seconds + changes * frames_per_set_up / frame_rate_hz;
}

}  // namespace

Result<std::vector<ExpectedThreshold>> expected_thresholds(const Plan& plan, std::stop_token stop) {
  auto sensor = sensor_of(plan);
  if (!sensor) return tl::unexpected(sensor.error());
  auto plates = plates_of(plan);
  if (!plates) return tl::unexpected(plates.error());
  auto spec = load_observer(plan.observer);
  if (!spec) return tl::unexpected(spec.error());
  TemplateObserver observer(*spec, triangle_alternatives());
  const SensorPlan effects = full_plan(*sensor, plan.simulation.skip, plan.simulation.force);
  std::vector<ExpectedThreshold> out;
  for (const double contrast : plan.target.delta_t_k) {
    ExpectedThreshold expected{.delta_t_k = contrast, .s75_mrad = {}, .se_ln_once = {}};
    const auto point =
        direct_estimate(*sensor, effects, observer, {std::abs(contrast)},
                        {.samples_per_pitch = sensor->microscan, .accuracy = Accuracy::draft(), .stop = stop});
    if (!point && point.error().code == ErrorCode::interrupted) return tl::unexpected(point.error());
    if (point) {
      expected.s75_mrad = point->front().s75_pitch * sensor->ifov_mrad();
      expected.slope = weibull_slope(point->front(), expected.slope);
      expected.se_ln_once = se_ln_once(plan, sizes_of(plan, *plates), *expected.s75_mrad, expected.slope);
    }
    out.push_back(expected);
  }
  return out;
}

TodCurve as_curve(const std::vector<ExpectedThreshold>& expected) {
  TodCurve curve;
  for (const auto& e : expected) {
    TodPoint point;
    point.set_delta_t_k = point.delta_t_k = e.delta_t_k;
    point.fit.threshold = e.s75_mrad;
    point.fit.slope = e.slope;
    curve.points.push_back(std::move(point));
  }
  return curve;
}

std::optional<double> PlanOutlook::uncertainty_percent() const {
  double largest = 0;
  for (const auto& contrast : contrasts) {
    if (!contrast.uncertainty_percent) return std::nullopt;
    largest = std::max(largest, *contrast.uncertainty_percent);
  }
  return contrasts.empty() ? std::nullopt : std::optional(largest);
}

PlanOutlook outlook(const Plan& plan, const std::vector<TargetPlate>& plates,
                    const std::vector<ExpectedThreshold>& expected, double frame_rate_hz) {
  PlanOutlook out;
  const std::vector<double> sizes_mrad = sizes_of(plan, plates);
  const auto repeats = static_cast<std::uint64_t>(plan.target.mountings.size()) *
                       static_cast<std::uint64_t>(std::max(plan.target.phases, 0));
  const auto contrasts = static_cast<std::uint64_t>(plan.target.delta_t_k.size());
  out.presentations = repeats * contrasts * plates.size();
  out.trials = repeats * contrasts * sizes_mrad.size();
  out.duration_s = duration_s(plan.target, static_cast<double>(out.presentations),
                              plan.measurement.registration_frames + plan.measurement.contrast_frames, frame_rate_hz);
  for (const double contrast : plan.target.delta_t_k) {
    PlannedContrast entry{.delta_t_k = contrast, .s75_mrad = {}, .uncertainty_percent = {}};
    for (const auto& e : expected) {
      if (e.delta_t_k != contrast || !e.s75_mrad) continue;
      entry.s75_mrad = e.s75_mrad;
      if (e.se_ln_once && repeats > 0)
        entry.uncertainty_percent =
            100 * std::expm1(normal_95 * *e.se_ln_once / std::sqrt(static_cast<double>(repeats)));
    }
    out.contrasts.push_back(entry);
  }
  return out;
}

int phases_for(Plan plan, const std::vector<TargetPlate>& plates, const std::vector<ExpectedThreshold>& expected,
               double tolerance_percent) {
  constexpr int least = 2, most = 256;
  const auto sure_enough = [&](int phases) {
    plan.target.phases = phases;
    const PlanOutlook seen = outlook(plan, plates, expected, 50);
    return std::all_of(seen.contrasts.begin(), seen.contrasts.end(), [&](const PlannedContrast& c) {
      return !c.uncertainty_percent || *c.uncertainty_percent <= tolerance_percent;
    });
  };
  int low = least, high = most;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (sure_enough(middle)) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

}  // namespace todbench
