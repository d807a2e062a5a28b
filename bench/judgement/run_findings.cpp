// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/judgement/run_findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bench/plan/joined_uncertainty.h"
#include "tod/psychometric/contrast_slope.h"

namespace todbench {
namespace {

/// Returns the relative standard uncertainty of a contrast row; empty for other rows.
std::optional<double> relative_u(const BudgetRow& row, double contrast_k) {
  if (kind_of(input_of(row)) != InputKind::contrast || row.sensitivity) return std::nullopt;
  const BudgetUnit unit = budget_unit(InputKind::contrast, row.unit).value_or(BudgetUnit{});
  return standard_of(row) * unit.factor / (unit.relative ? 1 : contrast_k);
}

void add(TodPoint& point, const AdequacyFinding& finding) {
  if (!point.adequacy) point.adequacy.emplace();
  point.adequacy->findings.push_back(finding);
}

/// Relative deviation from which a finding names a contrast that is allowed: beyond its noise and beyond what the
/// estimate itself can be off.
double noticed_contrast_deviation(const TodPoint& point) {
  constexpr double least = 0.02, standard_errors = 4;
  const double se_k = contrast_se_k(point).value_or(0);
  return std::max(least, standard_errors * se_k / std::abs(point.set_delta_t_k));
}

AdequacyFinding unfit(FindingKind kind, const ConstancyFigure& figure, std::string sentence) {
  return {.kind = kind, .value = figure.value, .limit = figure.limit, .sentence = std::move(sentence), .unfit = true};
}

double percent_of_ln(double ln_ratio) {
  return 100 * std::expm1(ln_ratio);
}

/// Relative deviation from the read-back while the contrast approaches the set one; of a ramp at its first contrast.
/// Empty for settled contrasts.
std::optional<double> deviation_on_the_way(const Plan& plan, const TodPoint& point,
                                           std::span<const Presentation> presentations) {
  double sum = 0;
  int count = 0;
  for (const Presentation& shown : presentations) {
    if (shown.set.wait != ContrastWait::within_band || !shown.delta_t_k) continue;
    if (plan.schedule.kind != ScheduleKind::ramp && !same_contrast(shown.set.delta_t_k, point.set_delta_t_k)) continue;
    sum += *shown.delta_t_k / (shown.air_transmittance.value_or(1) * shown.said.state.delta_t_k) - 1;
    ++count;
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

std::vector<AdequacyFinding> changes(const RunFacts& run) {
  std::vector<AdequacyFinding> out;
  if (const auto change = transfer_change(run.contrasts); change && change->beyond()) {
    const ConstancyFigure percent{100 * change->value, 100 * change->limit};
    out.push_back(unfit(FindingKind::transfer_change, percent,
                        fmt::format("the observed contrast changed by {:+.1f} % from earlier to later set-ups, {:.1f} "
                                    "% are allowed: the response of the camera or the target changed during the run",
                                    percent.value, percent.limit)));
  }
  if (const auto change = presented_change(run.constancy.presented); change && change->beyond()) {
    const ConstancyFigure percent{100 * change->value, 100 * change->limit};
    out.push_back(
        unfit(FindingKind::transfer_change, percent,
              fmt::format("in the presentations the contrast differed by {:+.1f} % from the contrast measured "
                          "before them, {:.1f} % are allowed: the target or the response of the camera "
                          "changed after the measurement of the contrast",
                          percent.value, percent.limit)));
  }
  if (const auto change = noise_change(run.constancy.noise); change && change->beyond()) {
    const ConstancyFigure percent{percent_of_ln(change->value), percent_of_ln(change->limit)};
    out.push_back(unfit(FindingKind::noise_change, percent,
                        fmt::format("the noise of a pixel changed by {:+.0f} % during the run, {:.0f} % are allowed: "
                                    "the answers belong to two states of the camera",
                                    percent.value, percent.limit)));
  }
  if (const auto change = correlation_change(run.constancy.noise); change && change->beyond()) {
    out.push_back(unfit(FindingKind::correlation_change, *change,
                        fmt::format("the correlation of successive frames changed by {:+.2f} during the run, {:.2f} is "
                                    "allowed: a temporal filter was switched on or off",
                                    change->value, change->limit)));
  }
  if (const auto& residue = run.constancy.residue; residue && residue->share > residue->limit) {
    const ConstancyFigure percent{100 * residue->share, 100 * residue->limit};
    out.push_back(
        unfit(FindingKind::picture_residue, percent,
              fmt::format("the first {} after a change of the target still contained {:.1f} % of the difference "
                          "from the previous picture, {:.1f} % are allowed: increase {}",
                          residue->behind_stages ? "judged picture" : "frame", percent.value, percent.limit,
                          residue->behind_stages ? "settle_frames of the stages or frames_after_change"
                                                 : "frames_after_change")));
  }
  return out;
}

}  // namespace

std::string unchecked_changes(std::span<const ContrastMeasurement> contrasts, const RunConstancy& constancy) {
  if (contrasts.empty() || transfer_change(contrasts)) return "";
  std::string others;
  if (!noise_change(constancy.noise)) others += ", of the noise";
  if (!correlation_change(constancy.noise)) others += ", of its correlation";
  return "not checked: fewer than two comparable set-ups. A change of the signal transfer" + others +
         " during the run would not be noticed; measure in two mountings or with several shifts";
}

double allowed_contrast_deviation(const Plan& plan, const TodPoint& point, std::size_t contrasts) {
  if (plan.target.max_contrast_deviation_percent) return *plan.target.max_contrast_deviation_percent / 100;
  const double contrast_k = std::abs(point.set_delta_t_k);
  JoinedUncertainty sum;
  bool stated = false;
  for (const BudgetRow& row : plan.uncertainty.rows) {
    const auto u = relative_u(row, contrast_k);
    if (!u) continue;
    stated = true;
    sum.add(*u, row.degrees_of_freedom);
  }
  if (!stated) sum.add(assumed_relative_u, std::nullopt);
  sum.add(reading_relative_u, std::nullopt);
  if (point.delta_t_se_k > 0 && std::isfinite(point.delta_t_se_k))
    sum.add(point.delta_t_se_k / contrast_k, freedom_of_contrast(point));
  return sum.half_width(contrast_false_alarm / 2 / static_cast<double>(std::max<std::size_t>(1, contrasts)));
}

std::map<double, double> gross_contrast_deviations(const Plan& plan) {
  std::map<double, double> allowed;
  if (plan.camera.contrast != ContrastUnit::kelvin) return allowed;
  for (const double contrast_k : plan.target.delta_t_k) {
    TodPoint point;
    point.set_delta_t_k = contrast_k;
    allowed[contrast_k] =
        std::max(gross_contrast_deviation, allowed_contrast_deviation(plan, point, plan.target.delta_t_k.size()));
  }
  return allowed;
}

std::optional<double> contrast_deviation(const Plan& plan, const TodPoint& point,
                                         std::span<const Presentation> presentations) {
  if (plan.camera.contrast != ContrastUnit::kelvin || !(std::abs(point.set_delta_t_k) > 0)) return std::nullopt;
  const double air = contrast_transmittance(plan, presentations).value_or(1);
  double deviation = point.delta_t_k / (air * point.set_delta_t_k) - 1;
  if (const auto own = deviation_on_the_way(plan, point, presentations)) deviation = *own;
  return std::isfinite(deviation) ? std::optional(deviation) : std::nullopt;
}

std::optional<double> contrast_transmittance(const Plan& plan, std::span<const Presentation> presentations) {
  if (plan.camera.contrast != ContrastUnit::kelvin || presentations.empty()) return std::nullopt;
  return presentations.front().air_transmittance.value_or(1);
}

std::vector<std::string> add_run_findings(TodCurve& curve, const Plan& plan, const RunFacts& run) {
  std::vector<AdequacyFinding> of_all = changes(run);
  of_all.insert(of_all.end(), run.others.begin(), run.others.end());
  std::vector<std::string> sentences;
  for (const AdequacyFinding& finding : of_all) sentences.push_back(finding.sentence);
  for (TodPoint& point : curve.points) {
    const auto deviation = contrast_deviation(plan, point, run.presentations);
    const double allowed = allowed_contrast_deviation(plan, point, curve.points.size());
    const bool beyond = deviation && std::abs(*deviation) > allowed;
    if (beyond || (deviation && std::abs(*deviation) > noticed_contrast_deviation(point))) {
      const ConstancyFigure percent{100 * *deviation, 100 * allowed};
      AdequacyFinding finding =
          unfit(FindingKind::contrast_deviation, percent,
                fmt::format("the camera observed {:.3f} K, but {:.3f} K were set ({:+.1f} %, {:.1f} % are allowed): {}",
                            point.delta_t_k, point.set_delta_t_k, percent.value, percent.limit,
                            beyond ? "the target or the temperature scale of the camera is wrong"
                                   : "compare the target and the temperature scale of the camera"));
      finding.unfit = beyond;
      sentences.push_back(finding.sentence);
      add(point, finding);
    }
    for (const AdequacyFinding& finding : of_all) add(point, finding);
  }
  return sentences;
}

}  // namespace todbench
