// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/range/range_models.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>

#include "acquisition/base/normal.h"
#include "acquisition/base/try.h"

namespace todbench {
namespace {

/// A model prepared for all inputs except the range.
struct Prepared {
  ModelRange head;
  CriterionTarget target;
  Criterion criterion;
  ResolvedPerMrad resolved;  ///< empty: see `head.reason`
  /// `resolved` with all thresholds of the curve divided by this factor; empty: use a target contrast multiplied by it.
  std::function<ResolvedPerMrad(double factor)> with_thresholds_over{};
};

std::string formula_words(const RangeQuestion& question) {
  return fmt::format("SNR threshold {:g}, eye {:g} s", question.formula.snr_threshold,
                     question.formula.eye_integration_s);
}

/// The contrast at which a model reads its curve.
double contrast_for(RangeModel which, const RangeSources& sources, const RangeQuestion& question) {
  if (which == RangeModel::tod || (which == RangeModel::mtdp && sources.transfer))
    return contrast_on_curve(sources.thresholds, question.delta_t_k);
  if (which != RangeModel::ttp) return std::abs(question.delta_t_k);
  const double on_display = std::abs(question.delta_t_k) / (2 * question.formula.scene_contrast_k);
  return question.target_contrast.value_or(on_display);
}

Prepared prepared_tod(const RangeSources& sources, const RangeQuestion& question) {
  Prepared model;
  model.head = {.name = "tod",
                .title = "TOD",
                .criterion = "M75",
                .criterion_value = question.m75,
                .probability_form = std::string(to_string(ProbabilityForm::ttp_2004)),
                .reads = "1 / S75 of the session's TOD curve",
                .criterion_origin = criterion_origin(question, RangeModel::tod),
                .display =
                    "none: the range has the display, if any, of the observer who judged the curve; no contrast is "
                    "lost on it"};
  std::vector<TodThreshold> sorted = sources.thresholds;
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.delta_t_k < b.delta_t_k; });
  if (sorted.empty()) {
    model.head.reason = "the TOD curve has no threshold";
    return model;
  }
  model.target = {question.size_m, contrast_on_curve(sorted, question.delta_t_k)};
  model.criterion = {question.m75 / ratio_for_probability(ProbabilityForm::ttp_2004, 0.75), ProbabilityForm::ttp_2004};
  model.resolved = [sorted](double contrast) { return interpolated_acuity_per_mrad(sorted, contrast); };
  return model;
}

/// Returns one curve per axis, or one for both.
Result<AxisCurves> cycle_curves(RangeModel which, const RangeSources& sources, const RangeQuestion& question) {
  const auto& given = which == RangeModel::acquire ? sources.mrtd : sources.mtdp;
  if (given) return AxisCurves{*given, *given};
  if (!sources.sensor) return fail(ErrorCode::invalid_input, "there is no curve, and no sensor to compute one from");
  return which == RangeModel::acquire ? mrtd_curves(*sources.sensor, question.formula)
                                      : mtdp_like_curves(*sources.sensor, question.formula);
}

/// Why the transfer does not hold for this curve; empty if it does.
std::string outside_of_transfer(const TodTransfer& transfer, const RangeSources& sources,
                                const RangeQuestion& question) {
  const std::string head = fmt::format("transfer {}: ", transfer.name);
  if (sources.thresholds.empty()) return head + "there is no TOD curve";
  if (!sources.sensor) return head + "there is no sensor, whose noise it needs";
  if (question.curve_observer != transfer.observer)
    return head + fmt::format("it holds for curves judged by {}, this one is judged by {}", transfer.observer,
                              question.curve_observer.empty() ? "an unknown observer" : question.curve_observer);
  if (sources.sensor->samples_per_pitch() > 1)
    return head + "it does not hold for cameras with more than one sample per detector and axis";
  if (sources.sensor->edge_boost > TodTransfer::highest_edge_boost)
    return head + fmt::format("it does not hold for an edge filter above {:g}", TodTransfer::highest_edge_boost);
  return {};
}

/// The TOD curve as frequencies of bars; an error if the transfer does not hold.
Result<TransferredCurve> transferred_curve(const RangeSources& sources, const RangeQuestion& question) {
  const std::string outside = outside_of_transfer(*sources.transfer, sources, question);
  if (!outside.empty()) return fail(ErrorCode::invalid_input, outside);
  auto curve = transferred(sources.thresholds, *sources.transfer,
                           sources.sensor->netd_k / std::sqrt(sources.sensor->exposures_per_sample()));
  if (!curve) return curve;
  std::sort(curve->points.begin(), curve->points.end(),
            [](const auto& a, const auto& b) { return a.delta_t_k < b.delta_t_k; });
  return curve;
}

Prepared prepared_transfer(const RangeSources& sources, const RangeQuestion& question) {
  const TodTransfer& transfer = *sources.transfer;
  Prepared model;
  model.head = {.name = std::string(to_string(RangeModel::mtdp)),
                .title = "MTDP-like",
                .criterion = "N50",
                .criterion_value = question.mtdp_n50,
                .probability_form = std::string(to_string(ProbabilityForm::johnson)),
                .reads = fmt::format("the session's TOD curve by transfer {}: {}", transfer.name, transfer.source),
                .criterion_origin = "people, vehicles: Johnson's cycles; no interval is published",
                .display = "none: the gain is free, and every contrast can be made visible"};
  const auto curve = transferred_curve(sources, question);
  if (!curve) {
    model.head.reason = curve.error().message;
    return model;
  }
  model.head.notes = curve->notes;
  model.head.notes.push_back(
      fmt::format("the bars are those that {} resolves in one picture, not an MTDP of people; 95 % interval of the "
                  "transfer of the frequency: factor {:.3g}",
                  transfer.observer, std::exp(transfer.half_width_ln)));
  model.target = {question.size_m, contrast_for(RangeModel::mtdp, sources, question)};
  model.criterion = {question.mtdp_n50, ProbabilityForm::johnson};
  model.resolved = [points = curve->points](double contrast) { return interpolated_acuity_per_mrad(points, contrast); };
  return model;
}

Prepared prepared_cycles(RangeModel which, const RangeSources& sources, const RangeQuestion& question) {
  const bool acquire = which == RangeModel::acquire;
  const bool given = acquire ? sources.mrtd.has_value() : sources.mtdp.has_value();
  Prepared model;
  model.head = {.name = std::string(to_string(which)),
                .title = acquire ? "ACQUIRE" : "MTDP-like",
                .criterion = "N50",
                .criterion_value = acquire ? question.n50 : question.mtdp_n50,
                .probability_form = std::string(to_string(ProbabilityForm::johnson)),
                .reads = "",
                .criterion_origin = "people, vehicles: Johnson's cycles; no interval is published",
                .display = "none: the gain is free, and every contrast can be made visible"};
  if (given) {
    model.head.reads = acquire ? "the given MRTD" : "the given MTDP";
  } else {
    model.head.reads = acquire ? "sqrt(f_h f_v) of the MRTD formula after FLIR92, cut at Nyquist; "
                               : "(pi / 2) SNR noise / modulation at best phase, a working definition; ";
    model.head.reads += formula_words(question) + ", without display and eye MTF";
  }
  if (!acquire) {
    model.head.notes.emplace_back(
        "no probability function is published for cycles of an MTDP: away from 50 % that of Johnson's cycles is "
        "assumed");
  }
  const auto curves = cycle_curves(which, sources, question);
  if (!curves) {
    model.head.reason = curves.error().message;
    return model;
  }
  model.target = {question.size_m, std::abs(question.delta_t_k)};
  model.criterion = {model.head.criterion_value, ProbabilityForm::johnson};
  model.resolved = resolved_cycles(curves->horizontal, curves->vertical);
  return model;
}

Prepared prepared_ttp(const RangeSources& sources, const RangeQuestion& question) {
  const FormulaConditions& viewing = question.formula;
  Prepared model;
  model.head = {
      .name = "ttp",
      .title = "TTP",
      .criterion = "V50",
      .criterion_value = question.v50,
      .probability_form = std::string(to_string(ProbabilityForm::ttp_2004)),
      .reads = sources.ctf
                   ? "the given CTF"
                   : fmt::format("CTF of eye, display and sensor, cut at Nyquist; {:g} cd/m2, {:g} mrad "
                                 "per sample at the eye, {:g} K for the mean luminance",
                                 viewing.eye.luminance_cd_m2, viewing.sample_at_eye_mrad, viewing.scene_contrast_k)};
  const double contrast = contrast_for(RangeModel::ttp, sources, question);
  model.head.criterion_origin = criterion_origin(question, RangeModel::ttp);
  model.head.display =
      question.target_contrast
          ? fmt::format("a stated contrast of {:.3g} before the air", contrast)
          : fmt::format(
                "a contrast of {:.3g} before the air: |dT| = {:.3g} K over twice the {:g} K of its mean luminance",
                contrast, std::abs(question.delta_t_k), viewing.scene_contrast_k);
  if (contrast > 1) {
    model.head.notes.push_back(fmt::format(
        "the contrast of {:.3g} at the target exceeds the display: after the air it is limited to 1", contrast));
  }
  Result<LogLinearCurve> ctf = fail(ErrorCode::invalid_input, "there is no CTF, and no sensor to compute one from");
  if (sources.ctf) {
    ctf = *sources.ctf;
  } else if (sources.sensor) {
    ctf = system_ctf(*sources.sensor, viewing);
  }
  if (!ctf) {
    model.head.reason = ctf.error().message;
    return model;
  }
  if (sources.ctf && ctf->points().back().value < std::min(1.0, contrast)) {
    model.head.notes.push_back(
        fmt::format("the CTF ends at {:g} cycles/mrad, below the target's contrast: higher "
                    "frequencies are not counted",
                    ctf->points().back().frequency));
  }
  model.target = {question.size_m, contrast};
  model.criterion = {question.v50, ProbabilityForm::ttp_2004};
  // The air reduces the contrast first, then the display clips it.
  model.with_thresholds_over = [values = resolved_values(*std::move(ctf))](double factor) -> ResolvedPerMrad {
    return [values, factor](double apparent) { return values(factor * std::min(1.0, apparent)); };
  };
  model.resolved = model.with_thresholds_over(1);
  return model;
}

Prepared prepared(RangeModel which, const RangeSources& sources, const RangeQuestion& question) {
  if (which == RangeModel::tod) return prepared_tod(sources, question);
  if (which == RangeModel::ttp) return prepared_ttp(sources, question);
  if (which == RangeModel::mtdp && sources.transfer) return prepared_transfer(sources, question);
  return prepared_cycles(which, sources, question);
}

std::optional<double> range_at(const Prepared& model, const Transmittance& air, double probability) {
  return range_for_probability(model.resolved, model.target, air, model.criterion, probability).range_m;
}

/// Both ends of an interval combined with those of the air, in logarithms.
Interval joined_with_air(const Prepared& model, const RangeQuestion& question, double r75, const Interval& of_curve) {
  if (question.extinction_u_percent <= 0) return of_curve;
  const double reach = normal_z95 * question.extinction_u_percent / 100;
  const auto side = [&](double factor, const std::optional<double>& bound) -> std::optional<double> {
    const auto changed = range_at(model, question.air.air.with_depth_times(std::max(0.0, factor)), 0.75);
    if (!changed || !bound) return std::nullopt;
    const double both = std::hypot(std::log(*changed / r75), std::log(*bound / r75));
    return r75 * std::exp(factor > 1 ? -both : both);
  };
  return {side(1 + reach, of_curve.low), side(1 - reach, of_curve.high)};
}

/// R75 for changed thresholds of the curve, which equals the inverse change of the contrast.
Interval interval_of_curve(const Prepared& model, const RangeQuestion& question) {
  const double factor = std::exp(normal_z95 * std::hypot(question.curve_u_percent, question.scale_u_percent) / 100);
  const auto changed = [&](double times) {
    Prepared other = model;
    if (other.with_thresholds_over)
      other.resolved = other.with_thresholds_over(times);
    else
      other.target.contrast *= times;
    return range_at(other, question.air.air, 0.75);
  };
  return {changed(1 / factor), changed(factor)};
}

/// All frequencies of the curve scale with the pixel's angle, so the range is inversely proportional to it.
Interval joined_with_ifov(const Interval& interval, double r75, double ifov_u_percent) {
  const auto side = [&](const std::optional<double>& bound, double direction) -> std::optional<double> {
    if (!bound || ifov_u_percent <= 0) return bound;
    return r75 * std::exp(direction * std::hypot(std::log(*bound / r75), normal_z95 * ifov_u_percent / 100));
  };
  return {side(interval.low, -1), side(interval.high, 1)};
}

/// TOD uses the same prediction as the rest of the program.
Result<void> predict_tod(Prepared& model, const RangeSources& sources, const RangeQuestion& question) {
  RangeTask task{
      .size_m = question.size_m, .delta_t_k = question.delta_t_k, .m75 = question.m75, .air = question.air.air};
  TODBENCH_TRY(const auto predicted, predict_range(sources.thresholds, task));
  model.head.r75_m = predicted.r75_m;
  model.head.reason = predicted.reason;
  model.head.r75_ci95_m = predicted.r75_ci95_m;
  model.head.r75_spread_m = predicted.r75_spread_m;
  model.head.notes = predicted.notes;
  if (predicted.r75_m) {
    model.head.r75_ci95_m =
        joined_with_m75(sources.thresholds, task, *predicted.r75_m, predicted.r75_ci95_m, question.m75_u_percent);
  }
  if (auto sentence = observers_differ(question); !sentence.empty()) model.head.notes.push_back(std::move(sentence));
  return {};
}

/// Range by the transferred TOD curve. The error of the transfer changes all frequencies alike, as M75 would.
Result<void> predict_transferred(Prepared& model, const RangeSources& sources, const RangeQuestion& question) {
  TODBENCH_TRY(const auto curve, transferred_curve(sources, question));
  const RangeTask task{.size_m = question.size_m,
                       .delta_t_k = question.delta_t_k,
                       .m75 = question.mtdp_n50 * ratio_for_probability(ProbabilityForm::johnson, 0.75),
                       .air = question.air.air};
  TODBENCH_TRY(const auto predicted, predict_range(curve.points, task));
  model.head.r75_m = predicted.r75_m;
  model.head.reason = predicted.reason;
  model.head.r75_ci95_m = predicted.r75_ci95_m;
  if (!predicted.r75_m) return {};
  const Interval both = joined_with_m75(curve.points, task, *predicted.r75_m, predicted.r75_ci95_m,
                                        100 * sources.transfer->half_width_ln / normal_z95);
  model.head.r75_ci95_m = joined_with_air(model, question, *predicted.r75_m, both);
  return {};
}

Result<void> answer(Prepared& model, const RangeSources& sources, const RangeQuestion& question) {
  if (!model.resolved) return {};
  const Transmittance& air = question.air.air;
  const auto found = range_for_probability(model.resolved, model.target, air, model.criterion, 0.75);
  model.head.sensitivity = found.sensitivity;
  model.head.r50_m = range_at(model, air, 0.5);
  if (model.head.name == "tod") {
    TODBENCH_TRY_VOID(predict_tod(model, sources, question));
    if (model.head.r75_m)
      model.head.r75_ci95_m = joined_with_air(model, question, *model.head.r75_m, model.head.r75_ci95_m);
    return {};
  }
  if (model.head.name == "mtdp" && sources.transfer) return predict_transferred(model, sources, question);
  model.head.r75_m = found.range_m;
  model.head.reason = found.reason;
  if (found.at_least_m) model.head.r75_ci95_m.low = found.at_least_m;
  // The formula of the curve has no error of its own; the stated errors of the curve and of the air are known.
  const bool curve_known = std::hypot(question.curve_u_percent, question.scale_u_percent) > 0;
  if (found.range_m && (question.extinction_u_percent > 0 || curve_known || question.ifov_u_percent > 0)) {
    model.head.r75_ci95_m =
        joined_with_ifov(joined_with_air(model, question, *found.range_m, interval_of_curve(model, question)),
                         *found.range_m, question.ifov_u_percent);
    if (question.scale_u_percent > 0 || question.ifov_u_percent > 0) {
      model.head.notes.push_back(fmt::format(
          "the interval includes the budget of the session: {:.2g} % of the temperature scale, {:.2g} % of the IFOV",
          question.scale_u_percent, question.ifov_u_percent));
    }
    if (!curve_known && question.ifov_u_percent <= 0)
      model.head.notes.emplace_back(
          "the interval includes only the uncertainty of the air: the curve has no stated uncertainty");
  }
  return {};
}

void add_curves(std::vector<Prepared>& models, const RangeQuestion& question) {
  double farthest = 0;
  for (const auto& model : models) {
    if (const auto reach = model.head.r75_m ? model.head.r75_m : model.head.r75_ci95_m.low)
      farthest = std::max(farthest, *reach);
  }
  if (!(farthest > nearest_range_m)) return;
  const double step = round_step(2 * farthest / 60);
  for (auto& model : models) {
    if (!model.resolved) continue;
    for (int i = 1; i * step <= 2 * farthest * (1 + 1e-12); ++i) {
      const auto x = criterion_ratio(model.resolved, model.target, question.air.air, model.criterion, i * step);
      model.head.curve.push_back(
          {i * step, x ? std::optional(target_probability(model.criterion.form, *x)) : std::nullopt});
    }
  }
}

Result<void> check(const RangeQuestion& question) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  if (!positive(question.size_m)) return fail(ErrorCode::invalid_input, "the target's size must be above 0 m");
  if (!positive(std::abs(question.delta_t_k))) return fail(ErrorCode::invalid_input, "the target has no contrast");
  for (const double criterion : {question.m75, question.n50, question.mtdp_n50, question.v50}) {
    if (!positive(criterion)) return fail(ErrorCode::invalid_input, "a criterion must be above 0");
  }
  if (question.target_contrast && !positive(*question.target_contrast))
    return fail(ErrorCode::invalid_input, "the contrast of luminances must be above 0");
  return {};
}

}  // namespace

Result<std::vector<ModelRange>> range_models(std::span<const RangeModel> asked, const RangeSources& sources,
                                             const RangeQuestion& question) {
  TODBENCH_TRY_VOID(check(question));
  std::vector<Prepared> models;
  for (const RangeModel which : asked) {
    models.push_back(prepared(which, sources, question));
    TODBENCH_TRY_VOID(answer(models.back(), sources, question));
  }
  add_curves(models, question);
  std::vector<ModelRange> answers;
  for (auto& model : models) answers.push_back(std::move(model.head));
  return answers;
}

Result<std::vector<RangeGrid>> range_grid(std::span<const RangeModel> asked, const RangeSources& sources,
                                          const RangeQuestion& question, const RangeGridAxes& axes) {
  constexpr std::size_t most = 200000;
  const std::size_t targets = axes.sizes_m.size() * axes.contrasts_k.size();
  if (targets == 0) return fail(ErrorCode::invalid_input, "a grid needs at least one size and one contrast");
  if (targets * std::max<std::size_t>(axes.ranges_m.size(), 1) > most)
    return fail(ErrorCode::invalid_input, fmt::format("a grid can have at most {} probabilities", most));
  for (const double range_m : axes.ranges_m) {
    if (!(std::isfinite(range_m) && range_m > 0)) return fail(ErrorCode::invalid_input, "ranges must be above 0 m");
  }
  std::vector<RangeGrid> grids;
  for (const RangeModel which : asked) {
    RangeGrid grid{which, {}, {}};
    RangeQuestion one = question;
    one.size_m = axes.sizes_m.front();
    one.delta_t_k = axes.contrasts_k.front();
    Prepared model = prepared(which, sources, one);
    for (const double size_m : axes.sizes_m) {
      for (const double contrast_k : axes.contrasts_k) {
        one.size_m = size_m;
        one.delta_t_k = contrast_k;
        TODBENCH_TRY_VOID(check(one));
        if (!model.resolved) {
          grid.r75_m.emplace_back();
          grid.probability.resize(grid.probability.size() + axes.ranges_m.size());
          continue;
        }
        model.target = {size_m, contrast_for(which, sources, one)};
        grid.r75_m.push_back(range_at(model, question.air.air, 0.75));
        for (const double range_m : axes.ranges_m) {
          const auto x = criterion_ratio(model.resolved, model.target, question.air.air, model.criterion, range_m);
          grid.probability.push_back(x ? std::optional(target_probability(model.criterion.form, *x)) : std::nullopt);
        }
      }
    }
    grids.push_back(std::move(grid));
  }
  return grids;
}

Interval joined_with_m75(std::span<const TodThreshold> thresholds, const RangeTask& task, double r75_m,
                         const Interval& of_curve, double m75_u_percent) {
  if (m75_u_percent <= 0) return of_curve;
  const auto side = [&](double direction, const std::optional<double>& bound) -> std::optional<double> {
    RangeTask changed = task;
    changed.m75 *= std::exp(-direction * normal_z95 * m75_u_percent / 100);
    const auto other = predict_range(thresholds, changed);
    if (!bound || !other || !other->r75_m) return std::nullopt;
    return r75_m * std::exp(direction * std::hypot(std::log(*other->r75_m / r75_m), std::log(*bound / r75_m)));
  };
  return {side(-1, of_curve.low), side(1, of_curve.high)};
}

TtpRanges ttp_ranges(const RangeSources& sources, const RangeQuestion& question, ProbabilityForm form) {
  Prepared model = prepared_ttp(sources, question);
  if (!model.resolved) return {};
  model.criterion.form = form;
  return {range_at(model, question.air.air, 0.5), range_at(model, question.air.air, 0.75)};
}

std::optional<NominalRanges> nominal_ranges(const RangeSources& sources, const RangeQuestion& question) {
  const Prepared model = prepared(RangeModel::mtdp, sources, question);
  if (!model.resolved) return std::nullopt;
  NominalRanges nominal;
  const auto range = [&](double cycles) {
    return range_for_probability(model.resolved, {nominal.size_m, nominal.delta_t_k},
                                 Transmittance::beer_lambert(nominal.extinction_per_km),
                                 {cycles, ProbabilityForm::johnson}, 0.5)
        .range_m;
  };
  nominal.detection_m = range(1);
  nominal.recognition_m = range(3);
  nominal.identification_m = range(6);
  return nominal;
}

}  // namespace todbench
