// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/studies/mrtd_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "acquisition/base/normal.h"
#include "acquisition/base/try.h"
#include "bench/report/number_format.h"
#include "bench/report/report_pieces.h"

namespace todbench {
namespace {

std::string_view axis_title(BarAxis axis) {
  return axis == BarAxis::horizontal ? "horizontal" : "vertical";
}

std::string no_mrtd_reason(const VirtualMrtdPoint& point, BarCriterion criterion) {
  if (criterion == BarCriterion::detection) return "detection of a pattern is not an MRTD";
  if (!point.threshold_k) {
    return fmt::format("no contrast up to {:.3g} K reaches 75 % correct ({:.0f} % at that contrast)", point.highest_k,
                       100 * point.proportion_at_most);
  }
  if (point.frequency_over_nyquist > 1 + 1e-9)
    return "beyond Nyquist: the MRTD is cut there, because the observer discriminates alias patterns";
  if (point.share_of_four == 0) return "no phase shows four bars: the observer discriminates alias patterns";
  return {};
}

MrtdStudyPoint study_point(const VirtualMrtdPoint& found, BarCriterion criterion, const LogLinearCurve& formula) {
  MrtdStudyPoint point;
  point.found = found;
  if (found.threshold_k) {
    const double reach = normal_z95 * found.relative_error;
    point.threshold_ci95_k = {*found.threshold_k * std::exp(-reach), *found.threshold_k * std::exp(reach)};
  }
  point.reason = no_mrtd_reason(found, criterion);
  if (point.reason.empty()) point.mrtd_k = found.threshold_k;
  point.formula_k = formula.at(found.frequency_per_mrad);
  return point;
}

PlotSeries series(const std::string& label, PlotTone tone, PlotMarker marker, PlotLine line) {
  return {.label = label, .tone = tone, .marker = marker, .line = line, .legend_line = line, .points = {}};
}

std::string criterion_text(BarCriterion criterion) {
  switch (criterion) {
    case BarCriterion::four_or_five:
      return "two intervals, four bars in one and five in the other, 75 % correct; free of response bias";
    case BarCriterion::bars_resolved:
      return "yes if every gap is lower than the bars beside it, otherwise no; 75 % yes, with 5 % yes for empty "
             "pictures";
    case BarCriterion::detection:
      break;
  }
  return "two intervals, four bars in one and no bars in the other, 75 % correct; a detection threshold, not an MRTD";
}

Table axis_table(const MrtdAxisCurve& curve) {
  Table table;
  table.caption = fmt::format("Bars resolved along the {} axis", axis_title(curve.axis));
  table.header = {"f (cycles/mrad)",        "f / Nyquist",          "MRTD (K), 95 %", "Threshold (K)",
                  "Best phase (K)",         "Worst phase (K)",      "Formula (K)",    "Ideal (K)",
                  "Modulation best, worst", "Phases with four bars"};
  const auto number = [](const std::optional<double>& value, std::string_view why) {
    return value ? plain(significant(*value, 3)) : missing(why);
  };
  for (const auto& p : curve.points) {
    const auto& f = p.found;
    table.rows.push_back({plain(significant(f.frequency_per_mrad, 3)), plain(significant(f.frequency_over_nyquist, 3)),
                          interval_or_missing(p.mrtd_k, p.mrtd_k ? p.threshold_ci95_k : Interval{}, p.reason),
                          number(f.threshold_k, "none"), number(f.best_phase_k, "none"),
                          number(f.worst_phase_k, "not reached at every phase"), number(p.formula_k, "beyond Nyquist"),
                          plain(significant(f.ideal_k, 3)),
                          plain(significant(f.modulation_best, 2) + ", " + significant(f.modulation_worst, 2)),
                          plain(fmt::format("{:.0f} %", 100 * f.share_of_four))});
  }
  if (std::ranges::none_of(curve.points, [](const auto& p) { return p.found.spread_k.has_value(); })) return table;
  table.header.emplace_back("Threshold over the open parameters of the observer (K)");
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const auto& spread = curve.points[i].found.spread_k;
    table.rows[i].push_back(spread ? plain(significant(spread->first, 3) + " to " + significant(spread->second, 3))
                                   : missing("none"));
  }
  return table;
}

/// Converts the contrasts at the camera to those of the bars before the air.
VirtualMrtdPoint before_the_air(VirtualMrtdPoint point, double transmittance) {
  for (auto* contrast_k : {&point.threshold_k, &point.best_phase_k, &point.worst_phase_k}) {
    if (*contrast_k) **contrast_k /= transmittance;
  }
  if (point.spread_k)
    point.spread_k = std::pair(point.spread_k->first / transmittance, point.spread_k->second / transmittance);
  point.highest_k /= transmittance;
  point.ideal_k /= transmittance;
  return point;
}

}  // namespace

Result<MrtdStudy> study_mrtd(const MrtdStudyTask& task) {
  const auto tau = task.air.air.at(task.range_m);
  if (!tau) {
    return fail(ErrorCode::invalid_input, fmt::format("the air's table ends at {:g} m and does not cover {:g} m",
                                                      task.air.air.end_m(), task.range_m));
  }
  if (!(*tau > 0))
    return fail(ErrorCode::invalid_input, fmt::format("the air transmits no contrast over {:g} m", task.range_m));
  TODBENCH_TRY(const auto formula, mrtd_curves(task.trial.sensor, task.formula));
  MrtdStudy study;
  study.transmittance = *tau;
  study.nyquist_per_mrad = 0.5 * task.trial.sensor.samples_per_pitch() / task.trial.sensor.ifov_mrad();
  for (const BarAxis axis : task.axes) {
    VirtualMrtdTask trial = task.trial;
    trial.axis = axis;
    TODBENCH_TRY(const auto found, virtual_mrtd(trial));
    auto& curve = study.curves.emplace_back(MrtdAxisCurve{axis, {}});
    for (const auto& point : found) {
      curve.points.push_back(study_point(before_the_air(point, *tau), trial.criterion,
                                         axis == BarAxis::horizontal ? formula.horizontal : formula.vertical));
      auto& formula_k = curve.points.back().formula_k;
      if (formula_k) *formula_k /= *tau;
    }
  }
  return study;
}

Plot mrtd_plot(const MrtdStudyTask& task, const MrtdStudy& study) {
  Plot plot;
  plot.id = "mrtd";
  plot.title = "MRTD against frequency";
  plot.description =
      "Contrast for 75 % correct answers over the frequency of the bars, with the best phase, the formula and an ideal "
      "observer.";
  double low = 1e300, high = 0, farthest = study.nyquist_per_mrad;
  const auto add = [&](PlotSeries& to, double f, const std::optional<double>& y, const Interval& interval = {}) {
    to.points.push_back({.x = f, .y = y, .x_interval = {}, .y_interval = interval});
    if (!y) return;
    low = std::min(low, *y);
    high = std::max(high, *y);
  };
  for (const auto& curve : study.curves) {
    const bool first = &curve == &study.curves.front();
    const std::string axis(axis_title(curve.axis));
    auto found =
        series(std::string(to_string(task.trial.criterion)) + ", " + axis, first ? PlotTone::first : PlotTone::second,
               first ? PlotMarker::disc : PlotMarker::square, PlotLine::solid);
    auto beyond = series(first ? "no MRTD" : "", PlotTone::muted, PlotMarker::bar, PlotLine::none);
    auto best = series(first ? "best phase" : "", first ? PlotTone::first : PlotTone::second, PlotMarker::none,
                       PlotLine::dotted);
    auto formula =
        series("formula, " + axis, PlotTone::third, PlotMarker::none, first ? PlotLine::solid : PlotLine::dashed);
    auto ideal = series(first ? "ideal observer" : "", PlotTone::muted, PlotMarker::none, PlotLine::dashed);
    for (const auto& p : curve.points) {
      const double f = p.found.frequency_per_mrad;
      farthest = std::max(farthest, f);
      add(found, f, p.mrtd_k, p.mrtd_k ? p.threshold_ci95_k : Interval{});
      if (!p.mrtd_k) add(beyond, f, p.found.threshold_k);
      add(best, f, p.found.best_phase_k);
      add(formula, f, p.formula_k);
      add(ideal, f, p.found.ideal_k);
    }
    for (auto* s : {&ideal, &formula, &best, &beyond, &found}) plot.series.push_back(std::move(*s));
  }
  plot.bands.push_back({.label = "beyond Nyquist", .tone = PlotTone::muted, .x = {study.nyquist_per_mrad, {}}});
  plot.x = {
      .label = "Frequency (cycles/mrad)", .scale = AxisScale::linear, .low = 0, .high = 1.05 * farthest, .ticks = {}};
  plot.y = {.label = "Contrast for 75 % (K)",
            .scale = AxisScale::logarithmic,
            .low = low / 1.5,
            .high = 1.5 * high,
            .ticks = {}};
  return plot;
}

Document mrtd_page(const MrtdStudyTask& task, const MrtdStudy& study) {
  const auto& trial = task.trial;
  Document document;
  document.title = "Virtual MRTD";
  document.heading = "Virtual MRTD";
  document.subtitle = trial.sensor.name + ", observer " + trial.observer.name;
  document.page_label = "Virtual MRTD, " + trial.sensor.name;
  Section section{"Four-bar targets judged by the observer of the triangles", {}};
  section.blocks.emplace_back(Paragraph{plain("Criterion: " + criterion_text(trial.criterion) + ".")});
  if (task.range_m > 0) {
    section.blocks.emplace_back(Paragraph{plain(
        fmt::format("Bars at {:g} m; contrasts are those at the bars; transmittance {}, {}.", task.range_m,
                    significant(study.transmittance, 4), task.air.source.empty() ? task.air.name : task.air.source))});
  }
  section.blocks.emplace_back(Figure{
      drawn(mrtd_plot(task, study)),
      "Contrast for 75 % correct at random phase, with 95 % interval. Grey marks: thresholds that are not an MRTD."});
  for (const auto& curve : study.curves) section.blocks.emplace_back(axis_table(curve));
  section.blocks.emplace_back(list_of(std::vector<std::string>{
      fmt::format("{} noise draws, seed {}; eight phases across the bars, two along them.", trial.draws, trial.seed),
      fmt::format("Nyquist frequency of the samples: {} cycles/mrad. The MRTD is cut there.",
                  significant(study.nyquist_per_mrad, 3)),
      fmt::format(
          "Formula: structure after FLIR92, scaled by an SNR threshold of {} and {} s; not computed by that program.",
          stated(task.formula.snr_threshold), stated(task.formula.eye_integration_s)),
      "Ideal: an observer that knows the phase and is limited only by the camera's white noise, in the same two "
      "intervals (for detection and bars-resolved: four bars against a uniform square). It is a bound.",
      "The observer is a model of human answers to triangles. No people took part."}));
  document.sections.push_back(std::move(section));
  return document;
}

}  // namespace todbench
