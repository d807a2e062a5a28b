// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/range/turbulent_ranges.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "acquisition/base/try.h"
#include "sim_devices/prediction/effect_planner.h"
#include "sim_devices/sensor/effect_turbulence.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

constexpr std::array path_shares{1 / 16.0, 1 / 8.0, 1 / 4.0, 1 / 2.0, 3 / 4.0, 1.0};
constexpr int curve_paths = 16;

std::optional<double> simulated_s75_pitch(const SensorSpec& sensor, TemplateObserver& observer, double delta_t_k) {
  if (!validate(sensor)) return std::nullopt;
  const SceneSurvey survey = survey_scene(sensor, observer, {.delta_t_k = {delta_t_k}, .motion = {}});
  if (survey.outlooks.empty()) return std::nullopt;
  return survey.outlooks.front().s75_pitch;
}

/// Thresholds rise with the inverse of the transfer function, up to the frequency at which it is zero.
Result<std::optional<LogLinearCurve>> blurred(const std::optional<LogLinearCurve>& curve, const TurbulentPath& path) {
  if (!curve) return std::optional<LogLinearCurve>();
  std::vector<CurvePoint> points;
  for (const CurvePoint& point : curve->points()) {
    const double value = point.value / long_exposure_mtf(path, point.frequency);
    if (!std::isfinite(value)) break;
    points.push_back({point.frequency, value});
  }
  TODBENCH_TRY(auto out, LogLinearCurve::of(points, "curve with turbulence"));
  return std::optional(std::move(out));
}

RangeModel model_named(const std::string& name) {
  return *std::find_if(all_range_models.begin(), all_range_models.end(),
                       [&](RangeModel model) { return to_string(model) == name; });
}

/// P at the ranges of a curve, linear in the path between the two nearest computed paths.
Result<std::vector<ModelRangePoint>> probabilities_behind(RangeModel which, const TurbulentSources& sources,
                                                          const RangeQuestion& question,
                                                          const std::vector<double>& ranges_m) {
  const RangeGridAxes axes{.sizes_m = {question.size_m}, .contrasts_k = {question.delta_t_k}, .ranges_m = ranges_m};
  const double step = ranges_m.back() / curve_paths;
  std::vector<std::vector<std::optional<double>>> behind;
  for (int k = 0; k <= curve_paths; ++k) {
    TODBENCH_TRY(const auto grid, range_grid(std::array{which}, sources.at(k * step), question, axes));
    behind.push_back(grid.front().probability);
  }
  std::vector<ModelRangePoint> points;
  for (std::size_t i = 0; i < ranges_m.size(); ++i) {
    const double place = ranges_m[i] / step;
    const auto at = std::min(static_cast<std::size_t>(place), static_cast<std::size_t>(curve_paths - 1));
    const double w = place - static_cast<double>(at);
    const auto &near = behind[at][i], &far = behind[at + 1][i];
    points.push_back({ranges_m[i], near && far ? std::optional(*near + w * (*far - *near)) : std::nullopt});
  }
  return points;
}

}  // namespace

Result<TurbulentSources> TurbulentSources::of(RangeSources still, const std::optional<TemplateObserverSpec>& observer,
                                              double cn2, double longest_m) {
  if (!still.sensor)
    return fail(ErrorCode::invalid_input,
                "turbulence needs a sensor, because its blur is computed in units of the sensor's pitch");
  if (!(cn2 > 0) || !(longest_m > 0)) return fail(ErrorCode::invalid_input, "Cn2 and the path must be above 0");
  TurbulentSources out;
  out.still_ = std::move(still);
  out.still_.sensor->turbulence_cn2_m_minus_2_3 = 0;
  out.cn2_ = cn2;
  out.longest_m_ = std::min(longest_m, 1e5);
  for (const double share : path_shares) out.paths_m_.push_back(share * out.longest_m_);
  out.leaves_tod_ = !observer;
  if (!observer) return out;
  TemplateObserver seeing(*observer, triangle_alternatives());
  for (const TodThreshold& threshold : out.still_.thresholds) {
    auto& factors = out.ln_factors_[threshold.delta_t_k];
    if (!factors.empty()) continue;
    const auto without = simulated_s75_pitch(out.sensor_at(0), seeing, threshold.delta_t_k);
    for (const double path_m : out.paths_m_) {
      const auto with =
          without ? simulated_s75_pitch(out.sensor_at(path_m), seeing, threshold.delta_t_k) : std::nullopt;
      factors.push_back(with ? std::optional(std::log(*with / *without)) : std::nullopt);
    }
  }
  return out;
}

SensorSpec TurbulentSources::sensor_at(double path_m) const {
  SensorSpec spec = *still_.sensor;
  spec.turbulence_cn2_m_minus_2_3 = path_m > 0 ? cn2_ : 0;
  spec.turbulence_path_m = path_m;
  return spec;
}

std::optional<double> TurbulentSources::ln_factor(double delta_t_k, double path_m) const {
  if (path_m == 0 || leaves_tod_) return 0;
  // Uses the nearest contrast of the table: those of a curve and its twin differ by the scale of the camera.
  const auto nearest = std::min_element(ln_factors_.begin(), ln_factors_.end(), [&](const auto& a, const auto& b) {
    return std::abs(std::log(a.first / delta_t_k)) < std::abs(std::log(b.first / delta_t_k));
  });
  if (nearest == ln_factors_.end()) return std::nullopt;
  double before_m = 0;
  std::optional<double> before = 0;
  for (std::size_t i = 0; i < paths_m_.size(); ++i) {
    const auto& here = nearest->second[i];
    if (!here) return std::nullopt;
    if (path_m <= paths_m_[i]) return *before + (path_m - before_m) / (paths_m_[i] - before_m) * (*here - *before);
    before_m = paths_m_[i];
    before = here;
  }
  // Tolerates rounding of the longest path; longer paths are unknown.
  return path_m <= longest_m_ * (1 + 1e-9) ? before : std::nullopt;
}

std::vector<TodThreshold> TurbulentSources::thresholds_at(std::span<const TodThreshold> still, double path_m) const {
  std::vector<TodThreshold> found;
  for (TodThreshold threshold : still) {
    const auto change = ln_factor(threshold.delta_t_k, path_m);
    if (!change) continue;
    const double factor = std::exp(*change);
    threshold.s75_mrad *= factor;
    if (factor != 1) threshold.s75_spread_mrad.reset();  // the factor is that of the observer itself
    for (auto* side : {&threshold.s75_ci95_mrad.low, &threshold.s75_ci95_mrad.high}) {
      if (*side) **side *= factor;
    }
    found.push_back(threshold);
  }
  return found;
}

RangeSources TurbulentSources::at(double path_m) const {
  if (!(path_m > 0)) return still_;
  RangeSources out{.thresholds = thresholds_at(still_.thresholds, path_m), .sensor = sensor_at(path_m)};
  const auto path = turbulent_path(*out.sensor);
  // A curve with fewer than two remaining points is absent: the model then has no sensor to fall back on.
  const auto put = [&](const std::optional<LogLinearCurve>& from, std::optional<LogLinearCurve>& into) {
    if (!from) return;
    if (auto curve = blurred(from, *path)) into = *std::move(curve);
  };
  put(still_.mrtd, out.mrtd);
  put(still_.mtdp, out.mtdp);
  put(still_.ctf, out.ctf);
  return out;
}

std::optional<double> self_consistent_range(double still_m,
                                            const std::function<std::optional<double>(double path_m)>& range_behind) {
  // f(R) - R falls from above 0 at 0 to below 0 at the range without turbulence: regula falsi, Illinois variant.
  double near = 0, far = still_m, above = still_m;
  const auto last = range_behind(far);
  if (!last) return std::nullopt;
  double below = *last - far;
  if (below >= 0) return still_m;
  int side = 0;
  double middle = far;
  for (int i = 0; i < 60; ++i) {
    middle = (near * below - far * above) / (below - above);
    const auto range = range_behind(middle);
    if (!range) return std::nullopt;
    const double value = *range - middle;
    if (std::abs(value) <= 1e-7 * middle) return *range;
    if (value > 0) {
      near = middle;
      above = value;
      if (side == 1) below /= 2;
      side = 1;
    } else {
      far = middle;
      below = value;
      if (side == -1) above /= 2;
      side = -1;
    }
  }
  return middle;
}

TurbulenceDecision decide_turbulence(const SensorSpec& sensor, double cn2, const RangeQuestion& question,
                                     std::optional<double> still_r75_m, double tolerance_percent) {
  if (!still_r75_m)
    return {true, 0, "simulated: without turbulence the TOD curve has no 75 % range at which to judge it"};
  SensorSpec behind = sensor;
  behind.turbulence_cn2_m_minus_2_3 = cn2;
  behind.turbulence_path_m = *still_r75_m;
  const double s75_pitch = 1000 * question.size_m / *still_r75_m / question.m75 / sensor.ifov_mrad();
  TurbulenceDecision out;
  out.bound_percent = 100 * std::expm1(std::min(turbulence_bound(behind, s75_pitch), 5.0));
  out.simulated = out.bound_percent > 0.8 * tolerance_percent;
  out.reason =
      out.simulated
          ? fmt::format("simulated: it may change the acuity by {:.3g} % at {:.4g} m", out.bound_percent, *still_r75_m)
          : fmt::format("not simulated in the TOD model: it changes the acuity by at most {:.2g} % at {:.4g} m",
                        out.bound_percent, *still_r75_m);
  return out;
}

namespace {

/// One model: each of its ranges with the curve behind its own path.
Result<ModelRange> turbulent_model(RangeModel which, const TurbulentSources& sources, const RangeQuestion& question) {
  const auto behind = [&](double path_m) -> Result<ModelRange> {
    TODBENCH_TRY(auto found, range_models(std::array{which}, sources.at(path_m), question));
    return std::move(found.front());
  };
  auto still = behind(0);
  if (!still) return still;
  using Reader = std::optional<double> (*)(const ModelRange&);
  const auto solved = [&](Reader read) -> std::optional<double> {
    const auto start = read(*still);
    if (!start || *start > sources.longest_m()) return std::nullopt;
    return self_consistent_range(*start, [&](double path_m) -> std::optional<double> {
      const auto found = behind(path_m);
      return found ? read(*found) : std::nullopt;
    });
  };
  const auto r75_m = solved([](const ModelRange& model) { return model.r75_m; });
  if (!r75_m) {
    ModelRange none = *std::move(still);
    if (none.r75_m)
      none.reason =
          fmt::format("with the turbulence of a path of {:.4g} m or less the model has no range", *none.r75_m);
    none.r50_m.reset();
    none.r75_m.reset();
    none.r75_ci95_m = {};
    none.sensitivity.reset();
    none.curve.clear();
    return none;
  }
  auto model = behind(*r75_m);
  if (!model) return model;
  model->r75_m = r75_m;
  model->r50_m = solved([](const ModelRange& one) { return one.r50_m; });
  model->r75_ci95_m = {solved([](const ModelRange& one) { return one.r75_ci95_m.low; }),
                       solved([](const ModelRange& one) { return one.r75_ci95_m.high; })};
  return model;
}

}  // namespace

Result<std::vector<ModelRange>> turbulent_range_models(std::span<const RangeModel> asked,
                                                       const TurbulentSources& sources, const RangeQuestion& question) {
  std::vector<ModelRange> answers;
  double farthest = 0;
  std::vector<double> ranges_m;
  for (const RangeModel which : asked) {
    TODBENCH_TRY(auto model, turbulent_model(which, sources, question));
    if (model.r75_m && *model.r75_m > farthest) {
      farthest = *model.r75_m;
      ranges_m.clear();
      for (const auto& point : model.curve) ranges_m.push_back(point.range_m);
    }
    answers.push_back(std::move(model));
  }
  for (auto& model : answers) {
    if (!model.r75_m || ranges_m.empty()) continue;
    TODBENCH_TRY(model.curve, probabilities_behind(model_named(model.name), sources, question, ranges_m));
  }
  return answers;
}

Result<RangePrediction> turbulent_prediction(const TurbulentSources& sources, std::span<const TodThreshold> still,
                                             const RangeTask& task) {
  auto plain = predict_range(still, task);
  if (!plain) return plain;
  using Reader = std::optional<double> (*)(const RangePrediction&);
  const auto solved = [&](Reader read) -> std::optional<double> {
    const auto start = read(*plain);
    if (!start) return std::nullopt;
    return self_consistent_range(*start, [&](double path_m) -> std::optional<double> {
      const auto found = predict_range(sources.thresholds_at(still, path_m), task);
      return found ? read(*found) : std::nullopt;
    });
  };
  const auto r75_m = solved([](const RangePrediction& one) { return one.r75_m; });
  if (!r75_m) {
    if (plain->r75_m) plain->reason = "with the turbulence of the path the TOD curve has no range";
    plain->r75_m.reset();
    plain->r75_ci95_m = {};
    plain->curve.clear();
    return plain;
  }
  auto prediction = predict_range(sources.thresholds_at(still, *r75_m), task);
  if (!prediction) return prediction;
  prediction->r75_m = r75_m;
  prediction->r75_ci95_m = {solved([](const RangePrediction& one) { return one.r75_ci95_m.low; }),
                            solved([](const RangePrediction& one) { return one.r75_ci95_m.high; })};
  for (RangePoint& point : prediction->curve) {
    const auto behind = sources.thresholds_at(still, point.range_m);
    const auto own = behind.empty() ? Result<RangePoint>(RangePoint{.range_m = point.range_m,
                                                                    .apparent_delta_t_k = point.apparent_delta_t_k,
                                                                    .probability = {},
                                                                    .probability_ci95 = {}})
                                    : range_point(behind, task, point.range_m);
    if (!own) return tl::unexpected(own.error());
    point = *own;
  }
  return prediction;
}

}  // namespace todbench
