// SPDX-License-Identifier: GPL-3.0-or-later
// Sections on results: verdict, curves, functions, comparison.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/judgement/demand_kinds.h"
#include "bench/report/fit_words.h"
#include "bench/report/number_format.h"
#include "bench/report/report_pieces.h"
#include "bench/report/tod_figures.h"
#include "tod/comparison/paired_ratio.h"
#include "tod/psychometric/acuity.h"
#include "tod/psychometric/contrast_slope.h"

namespace todbench {
namespace {

constexpr std::string_view one_sided_note =
    "A single bound in brackets (≥ or ≤) is a one-sided 95 % limit: the data do not bound the other side.";

constexpr std::string_view groups_note =
    "Groups: trials that share a frame or a place on the plate form one group. The intervals include the variation "
    "that these trials share.";

RichText optional_number(std::optional<double> value, int digits, std::string_view reason) {
  return value && std::isfinite(*value) ? plain(significant(*value, digits)) : missing(reason);
}

const TodCurve* pointer(const std::optional<TodCurve>& curve) {
  return curve ? &*curve : nullptr;
}

std::string measured_name(const ReportData& data) {
  return data.camera && !data.camera->model.empty() ? "measured, " + data.camera->model : "measured";
}

std::string simulated_name(const ReportData& data) {
  return data.simulated_sensor && !data.simulated_sensor->name.empty() ? "simulated, " + data.simulated_sensor->name
                                                                       : "simulated";
}

/// Returns the acuity limits at the effective contrast if it was measured, because the points are drawn there.
std::vector<DrawnLimit> acuity_limits(const ReportData& data) {
  std::vector<DrawnLimit> limits;
  if (!data.verdict) return limits;
  for (const Demand& demand : data.verdict->demands) {
    if (demand.kind != DemandKind::acuity || !demand.limit || !demand.delta_t_k) continue;
    const TodPoint* point = data.measured ? point_at(*data.measured, *demand.delta_t_k) : nullptr;
    const bool seen = point != nullptr && point->delta_t_k != 0;
    limits.push_back({seen ? point->delta_t_k : *demand.delta_t_k, *demand.limit});
  }
  return limits;
}

RichText contrast_cell(const TodPoint& point) {
  if (point.delta_t_k == 0 || !std::isfinite(point.delta_t_k)) return missing("not measured");
  if (point.delta_t_measurements == 1 && !contrast_se_k(point))
    return plain(significant(point.delta_t_k, 3)) + RichText{{{" (measured once)", Meaning::reason}}};
  if (!(point.delta_t_se_k > 0)) return plain(significant(point.delta_t_k, 3));
  const int decimals = decimals_for(point.delta_t_k, {-point.delta_t_se_k, point.delta_t_se_k});
  return unbroken(shown(point.delta_t_k, decimals) + " ± " + fixed(point.delta_t_se_k, decimals));
}

RichText lapse_cell(const TodPoint& point) {
  const std::string lapse = significant(point.fit.lapse, 2);
  if (!point.lapse_warning || !point.free_lapse_fit) return plain(lapse);
  return plain(lapse + " (free: " + significant(point.free_lapse_fit->lapse, 2) + ", fits better)");
}

RichText trials_cell(const PsychometricFit& fit) {
  const std::string trials = shown(fit.trials, 0);
  return unbroken(fit.clusters > 0 ? trials + " / " + shown(fit.clusters, 0) : trials);
}

/// Returns the fit with its adequacy, so that a number unfit for a decision is never shown without a remark.
RichText fit_cell(const TodPoint& point) {
  RichText cell = plain(in_words(point.fit.verdict));
  if (point.adequacy && !point.adequacy->adequate())
    cell += plain(" ") + badge("not fit for a decision", Mood::bad);
  else if (point.adequacy && !point.adequacy->findings.empty())
    cell += plain("; see findings");
  return cell;
}

/// Returns the findings against the numbers of a curve, one sentence each; empty if there are none.
std::vector<RichText> findings_of(const TodCurve& curve, std::string_view which) {
  std::vector<RichText> items;
  for (const TodPoint& point : curve.points) {
    if (!point.adequacy) continue;
    for (const AdequacyFinding& finding : point.adequacy->findings) {
      RichText item = plain(std::string(which) + " at " + stated(point.set_delta_t_k) + " K: " + finding.sentence);
      if (finding.unfit) item += plain(" ") + badge("not fit for a decision", Mood::bad);
      items.push_back(std::move(item));
    }
  }
  return items;
}

void add_findings(Section& section, const ReportData& data) {
  List findings;
  for (const auto& [curve, which] : {std::pair(&data.measured, "Measured"), std::pair(&data.simulated, "Simulated"),
                                     std::pair(&data.human, "Human")})
    if (*curve)
      for (RichText& item : findings_of(**curve, which)) findings.items.push_back(std::move(item));
  if (findings.items.empty()) return;
  section.blocks.emplace_back(Paragraph{strong("Findings about these results")});
  section.blocks.emplace_back(std::move(findings));
}

/// States S75 over the open parameters of an observer with an eye.
void add_spread(Section& section, const ReportData& data) {
  List spreads;
  for (const auto& [curve, which] : {std::pair(&data.measured, "Measured"), std::pair(&data.simulated, "Simulated")}) {
    if (!*curve) continue;
    for (const TodPoint& point : (*curve)->points) {
      if (!point.s75_spread_mrad) continue;
      spreads.items.push_back(plain(std::string(which) + " at " + stated(point.set_delta_t_k) +
                                    " K: " + fixed(point.s75_spread_mrad->first, 3) + " to " +
                                    fixed(point.s75_spread_mrad->second, 3) + " mrad"));
    }
  }
  if (spreads.items.empty()) return;
  section.blocks.emplace_back(Paragraph{strong("S₇₅ over the open parameters of the observer")});
  section.blocks.emplace_back(
      Paragraph{plain("Public data do not determine the observer's sensitivity (±4 dB), its channels of uncertainty "
                      "(100 to 3000), its noise in proportion to the contrast (0 to 0.07) and its factor on the noise "
                      "of the sensor (1.1 to 3.2). These are the thresholds at the ends of all four ranges together. "
                      "They are not confidence intervals: no probability belongs to them. Public data carry detection "
                      "and the shape of acuity over luminance and contrast; they do not carry a TOD of people behind "
                      "a sensor.")});
  section.blocks.emplace_back(std::move(spreads));
}

std::vector<RichText> curve_row(const TodPoint& point, bool with_direct) {
  const PsychometricFit& fit = point.fit;
  const std::string_view reason = fit.verdict == FitVerdict::no_data ? "no trials" : "not identified";
  std::vector<RichText> row{plain(stated(point.set_delta_t_k)),
                            contrast_cell(point),
                            interval_or_missing(fit.threshold, fit.ci95, reason),
                            interval_or_missing(acuity_per_mrad(fit), acuity_interval(fit.ci95), reason),
                            optional_number(fit.slope, 3, reason),
                            lapse_cell(point),
                            trials_cell(fit),
                            fit_cell(point)};
  if (with_direct) {
    const double error = point.direct_s75_se_mrad.value_or(0);
    const int decimals = decimals_for(point.direct_s75_mrad, {-error, error});
    row.push_back(point.direct_s75_mrad ? unbroken(shown(*point.direct_s75_mrad, decimals) +
                                                   (error > 0 ? " ± " + fixed(error, decimals) : ""))
                                        : missing("not computed"));
  }
  return row;
}

Table curve_table(const TodCurve& curve, const std::string& caption, bool with_direct) {
  Table rows;
  rows.caption = caption;
  rows.header = {"Set ΔT (K)", "Effective ΔT (K)", "S₇₅ (mrad)", "Acuity 1/S₇₅ (1/mrad)", "Slope",
                 "Lapse",      "Trials / groups",  "Fit"};
  if (with_direct) rows.header.emplace_back("Direct S₇₅ (mrad)");
  for (const TodPoint& point : curve.points) rows.rows.push_back(curve_row(point, with_direct));
  return rows;
}

/// Returns the set contrasts of both curves without duplicates, in the order of the curves.
std::vector<double> all_contrasts(const ReportData& data) {
  std::vector<double> contrasts;
  for (const std::optional<TodCurve>* curve : {&data.measured, &data.simulated}) {
    if (!*curve) continue;
    for (const TodPoint& point : (*curve)->points) {
      bool known = false;
      for (const double contrast : contrasts) known = known || same_contrast(contrast, point.set_delta_t_k);
      if (!known) contrasts.push_back(point.set_delta_t_k);
    }
  }
  return contrasts;
}

const TodPoint* point_of(const std::optional<TodCurve>& curve, double contrast) {
  return curve ? point_at(*curve, contrast) : nullptr;
}

RichText limit_cell(const Demand& demand) {
  const LimitSide side = row_of(demand.kind).side;
  if (side == LimitSide::none || !demand.limit || !std::isfinite(*demand.limit)) return missing("no limit value");
  const std::string_view unit = row_of(demand.kind).unit;
  return unbroken((side == LimitSide::at_least ? "≥ " : "≤ ") + stated(*demand.limit) +
                  (unit.empty() || unit == "1" ? "" : " " + std::string(unit)));
}

/// The column header states 95 %; another confidence is stated with the number.
RichText result_cell(const Demand& demand) {
  if (demand.interval_percent == 95 || (!demand.interval.low && !demand.interval.high))
    return interval_or_missing(demand.result, demand.interval, "no value");
  return unbroken(with_interval(demand.result, demand.interval) + " (" + std::to_string(demand.interval_percent) +
                  " %)");
}

/// Names conditional decisions, and states the risks of the decision.
RichText conformity_words(const Demand& demand) {
  std::vector<std::string> parts;
  if (demand.conformity == ConformityDecision::conditional_pass ||
      demand.conformity == ConformityDecision::conditional_fail)
    parts.emplace_back(to_string(*demand.conformity));
  std::string risks;
  if (demand.p_conformity) risks = "probability of conformity " + probability(*demand.p_conformity);
  if (const auto risk = demand.consumer_risk()) risks += ", consumer's risk " + probability(*risk);
  if (const auto risk = demand.producer_risk()) risks += ", producer's risk " + probability(*risk);
  if (!risks.empty()) parts.push_back(std::move(risks));
  if (const auto& fleet = demand.fleet) {
    parts.push_back("with the fleet of " + std::to_string(fleet->units) + " earlier units: probability of conformity " +
                    probability(fleet->p_conformity) + "; over the fleet, probability of a wrong acceptance " +
                    probability(fleet->consumer_risk) + " (at most " + probability(fleet->consumer_risk_most) +
                    "), of a wrong rejection " + probability(fleet->producer_risk) + " (at most " +
                    probability(fleet->producer_risk_most) + ")");
  }
  return parts.empty() ? RichText{} : plain(fmt::format("{}", fmt::join(parts, "; ")));
}

/// The reason of a decision and its risks. The reason of a pass is in the columns beside it: interval and limit.
RichText reason_cell(const Demand& demand) {
  const RichText risks = demand.conformity ? conformity_words(demand) : RichText{};
  if (demand.decision == VerdictKind::pass && demand.p_conformity && demand.kind != DemandKind::equivalence)
    return risks;
  RichText reason = text_or_missing(demand.reason, "none given");
  return risks.phrases.empty() ? reason : reason + plain("; ") + risks;
}

/// Returns the result with the interval of the finite number of trials.
RichText statistical_cell(const Demand& demand) {
  Demand alone = demand;
  if (demand.statistical) alone.interval = *demand.statistical;
  return result_cell(alone);
}

/// Returns whether the answers are graded: their sum is not a count.
bool has_graded_answers(const TodPoint& point) {
  return point.answers ? point.answers->kind == AnswerKind::graded : is_quasi(point.fit.interval);
}

std::string answers_header(const TodCurve& curve) {
  const auto graded = std::ranges::count_if(curve.points, has_graded_answers);
  if (graded == 0) return "Correct / trials";
  return graded == std::ssize(curve.points) ? "Mean probability of a correct answer; trials"
                                            : "Correct / trials, or mean probability; trials";
}

RichText answers_cell(const TodPoint& point, const AnswersAtSize& answers) {
  if (!has_graded_answers(point)) return unbroken(shown(answers.correct, 0) + " / " + shown(answers.total, 0));
  if (!(answers.total > 0)) return missing("no trials");
  return unbroken(fixed(answers.correct / answers.total, 3) + "; " + shown(answers.total, 0));
}

Table answers_table(const std::string& caption, const TodCurve& curve) {
  Table rows;
  rows.caption = caption;
  rows.header = {"Set ΔT (K)", "Size (mrad)", answers_header(curve), "Proportion [95 %]"};
  for (const TodPoint& point : curve.points) {
    for (const AnswersAtSize& answers : answers_by_size(point)) {
      rows.rows.push_back(
          {plain(stated(point.set_delta_t_k)),
           plain(answers.size_mrad > 0 ? significant(answers.size_mrad, 4) : "0 (catch trials)"),
           answers_cell(point, answers),
           interval_or_missing(answers.correct / answers.total, proportion_interval(answers), "no trials")});
    }
  }
  return rows;
}

/// Thresholds by the direction of the triangles; without rows if no point compares them.
Table directions_table(const std::string& caption, const TodCurve& curve) {
  Table rows;
  rows.caption = caption;
  rows.header = {"Set ΔT (K)"};
  for (const Apex apex : all_apexes) rows.header.push_back(std::string(to_string(apex)) + " (%)");
  rows.header.emplace_back("up and down over left and right (%)");
  for (const TodPoint& point : curve.points) {
    if (!point.orientations) continue;
    rows.rows.push_back({plain(stated(point.set_delta_t_k))});
    for (const DirectionAnswers& one : point.orientations->directions)
      rows.rows.back().push_back(plain(fmt::format("{:+.1f}", one.percent)));
    rows.rows.back().push_back(unbroken(
        fmt::format("{:+.1f} ± {:.1f}", point.orientations->axes_percent, point.orientations->axes_se_percent)));
  }
  return rows;
}

struct Headline {
  std::string word, sentence;
  Mood mood = Mood::open;
};

Headline headline(ReportVerdict verdict) {
  switch (verdict) {
    case ReportVerdict::pass:
      return {"✓ PASS", "Every limit is met.", Mood::good};
    case ReportVerdict::fail:
      return {"✗ FAIL", "At least one limit is not met.", Mood::bad};
    case ReportVerdict::inconclusive:
      return {"? INCONCLUSIVE", "No limit is violated, but these data do not decide at least one limit.", Mood::open};
    case ReportVerdict::interrupted:
      return {"? INTERRUPTED", "The run ended early. The results below are partial, so there is no verdict.",
              Mood::open};
    case ReportVerdict::changed:
      return {"✗ FILES CHANGED",
              "Files of this session were changed after the run. The report shows the files as they are now, so there "
              "is no verdict.",
              Mood::bad};
    case ReportVerdict::not_judged:
      break;
  }
  return {"NO VERDICT", "The plan has no limits. This report states results only.", Mood::open};
}

/// Returns the demand on which the decision rests: of those with this decision, the one with the smallest probability
/// of conformity; the first if none has one. Null: no demand decides.
const Demand* deciding_demand(const Verdict& verdict) {
  const Demand* least = nullptr;
  for (const Demand& demand : verdict.demands) {
    if (demand.decision != verdict.decision || demand.kind == DemandKind::identified) continue;
    if (least == nullptr || demand.p_conformity.value_or(1) < least->p_conformity.value_or(1)) least = &demand;
  }
  return least;
}

/// "75 % acuity at 0.23 K: 0.29 [0.28, 0.30] 1/mrad, limit ≥ 0.2"
RichText deciding_words(const Demand& demand) {
  RichText text = plain(title(demand) + ": ") + result_cell(demand);
  if (row_of(demand.kind).side != LimitSide::none && demand.limit) text += plain(", limit ") + limit_cell(demand);
  return text;
}

/// Returns the remark about one interruption of a run, shown with the verdict.
RichText resumption(const Interruption& loss, std::size_t segment) {
  return strong("Interrupted and resumed:") +
         plain(fmt::format(" segment {} begins with presentation {}. The camera was lost for {:.1f} s ({}). It "
                           "returned with the same serial number and settings. The plate had moved by {:.2f} pixels.",
                           segment, loss.presentation, loss.away_s, loss.reason, loss.moved_px));
}

/// "the model observer hvs-1, not a person". The gain of hvs-1 is that of the EO-VISTA experiment.
std::string judge_in_words(const std::string& observer) {
  return "the model observer " + observer +
         (observer.starts_with("hvs-1") ? ", tuned to the gain of the EO-VISTA experiment, not a person"
                                        : ", not a person");
}

}  // namespace

VerdictBox verdict_box(const ReportData& data) {
  const ReportVerdict verdict = report_verdict(data);
  const Headline found = headline(verdict);
  VerdictBox box{found.word, found.mood, {plain(found.sentence)}};
  const bool decided =
      verdict == ReportVerdict::pass || verdict == ReportVerdict::fail || verdict == ReportVerdict::inconclusive;
  if (const Demand* demand = decided && data.verdict ? deciding_demand(*data.verdict) : nullptr)
    box.paragraphs.push_back(strong(verdict == ReportVerdict::pass ? "Closest to its limit:" : "Decided by:") +
                             plain(" ") + deciding_words(*demand));
  if (data.revision)
    box.paragraphs.push_back(
        strong("Revision " + std::to_string(data.revision->number) + " of " + data.revision->utc + ":") +
        plain(" " + data.revision->reason + ". It amends the signed report."));
  for (const std::string& file : data.accepted_changes)
    box.paragraphs.push_back(strong("Changed, removed or added after the session ended:") + plain(" " + file));
  if (data.cut_off)
    box.paragraphs.push_back(strong("Cut off:") +
                             plain(" the run wrote no manifest, so its files cannot be verified."));
  const auto by_a_bar = [](const Demand& demand) { return demand.kind == DemandKind::scene_dependence; };
  if (data.verdict && std::any_of(data.verdict->demands.begin(), data.verdict->demands.end(), by_a_bar))
    box.paragraphs.push_back(strong("Only about a hot bar in the field:") + plain(" " + data.verdict->reason + "."));
  if (verdict != ReportVerdict::not_judged && verdict != ReportVerdict::changed)
    box.paragraphs.push_back(strong("Decision rule:") + plain(" ") +
                             text_or_missing(data.verdict ? data.verdict->rule_in_words : "", "not stated"));
  if (!data.observer.empty())
    box.paragraphs.push_back(strong("Judged by:") + plain(" " + judge_in_words(data.observer)));
  if (data.verdict && data.verdict->judged == JudgedWhen::afterwards)
    box.paragraphs.push_back(plain(remark_on(data.verdict->judged)));
  if (data.interrupted)
    box.paragraphs.push_back(strong("Interrupted:") + plain(" ") +
                             text_or_missing(*data.interrupted, "no reason recorded"));
  for (std::size_t i = 0; i < data.interruptions.size(); ++i)
    box.paragraphs.push_back(resumption(data.interruptions[i], i + 2));
  return box;
}

Section limits_section(const ReportData& data) {
  Section section{"Limits", {}};
  if (!data.verdict || !limits_asked(*data.verdict))
    section.blocks.emplace_back(Paragraph{missing("the plan has no limits")});
  if (!data.verdict || data.verdict->demands.empty()) return section;
  const auto& demands = data.verdict->demands;
  const bool expanded =
      std::any_of(demands.begin(), demands.end(), [](const Demand& demand) { return demand.statistical.has_value(); });
  Table rows;
  // Decisions in changed files are not verdicts.
  const bool believed = report_verdict(data) != ReportVerdict::changed;
  rows.header = {"Quantity", "Limit", expanded ? "Result [expanded 95 %]" : "Result [95 %]",
                 believed ? "Verdict" : "Decision in the files", "Reason"};
  if (expanded) rows.header.insert(rows.header.begin() + 3, "Statistical [95 %]");
  for (const Demand& demand : demands) {
    const std::string decision(to_string(demand.decision));
    rows.rows.push_back({plain(title(demand)), limit_cell(demand), result_cell(demand),
                         believed ? badge(decision, mood_of(demand.decision)) : plain(decision), reason_cell(demand)});
    if (expanded) rows.rows.back().insert(rows.rows.back().begin() + 3, statistical_cell(demand));
  }
  section.blocks.emplace_back(std::move(rows));
  if (data.verdict->not_stated && !data.verdict->not_stated->empty()) {
    section.blocks.emplace_back(Paragraph{
        plain(fmt::format("The budget of the plan does not state: {}.", fmt::join(*data.verdict->not_stated, ", ")))});
  }
  section.blocks.emplace_back(note(plain(one_sided_note)));
  return section;
}

Plot tod_plot(const ReportData& data) {
  const std::vector<DrawnLimit> limits = acuity_limits(data);
  Plot plot = tod_figure({measured_name(data), pointer(data.measured)}, {simulated_name(data), pointer(data.simulated)},
                         limits);
  if (!data.human) return plot;
  // Curve of the person in the style of the figure, in the third tone.
  const Plot human = tod_figure({"human", pointer(data.human)}, {}, {});
  for (PlotSeries series : human.series) {
    series.tone = PlotTone::third;
    series.marker = PlotMarker::square;
    series.dodge_px = 0;
    plot.series.push_back(std::move(series));
  }
  plot.x.high = std::max(plot.x.high, human.x.high);
  plot.y.low = std::min(plot.y.low, human.y.low);
  plot.y.high = std::max(plot.y.high, human.y.high);
  return plot;
}

std::vector<Plot> psychometric_plots(const ReportData& data) {
  std::vector<Plot> plots;
  for (const double contrast : all_contrasts(data)) {
    plots.push_back(psychometric_figure("psychometric-" + std::to_string(plots.size() + 1),
                                        {"measured", point_of(data.measured, contrast)},
                                        {"simulated", point_of(data.simulated, contrast)}, data.fit.form));
  }
  return plots;
}

Section curve_section(const ReportData& data) {
  if (!data.measured && !data.simulated) return {"TOD curve", {Paragraph{missing("no results")}}};
  Section section{"TOD curve", {}};
  section.blocks.emplace_back(
      Figure{drawn(tod_plot(data)),
             "TOD curve: acuity (linear) against effective contrast (logarithmic), the contrast that the camera "
             "observed. Horizontal bars are 95 % intervals. An arrow marks a side that the data do not bound. The two "
             "curves are drawn a few pixels apart so that their bars do not hide each other."});
  if (data.measured)
    section.blocks.emplace_back(
        curve_table(*data.measured, "Measured; brackets: 95 % interval, ±: standard error", false));
  if (data.simulated)
    section.blocks.emplace_back(
        curve_table(*data.simulated, "Simulated; brackets: 95 % interval, ±: standard error", true));
  add_findings(section, data);
  add_spread(section, data);
  section.blocks.emplace_back(note(plain(form_in_words(data) + answers_in_words(data) + " " +
                                         std::string(one_sided_note) + " " + std::string(groups_note))));
  if (data.simulated)
    section.blocks.emplace_back(
        note(plain("Direct S₇₅: the size at which the phase-averaged proportion correct of the observer crosses 75 %, "
                   "without a psychometric form. It checks the fit. The comparison uses S₇₅.")));
  return section;
}

std::optional<Section> psychometric_section(const ReportData& data) {
  FigurePairs figures;
  const std::vector<Plot> plots = psychometric_plots(data);
  const std::vector<double> contrasts = all_contrasts(data);
  for (std::size_t i = 0; i < plots.size(); ++i)
    figures.figures.push_back({drawn(plots[i]), "Set contrast ΔT = " + stated(contrasts[i]) + " K"});
  if (figures.figures.empty()) return {};
  return Section{
      "Psychometric functions",
      {std::move(figures),
       note(plain("Points: proportion correct with 95 % intervals. For right and wrong answers these are Wilson "
                  "intervals of independent trials. For graded answers they come from the scatter over presentations. "
                  "Lines: fitted functions. Shaded: 95 % interval of S₇₅, widened for groups of trials. "
                  "Dashed: threshold (75 %) and chance (25 %)."))}};
}

/// Returns the table of ratios by common phases; empty if there are none.
std::optional<Table> paired_table(const Comparison& comparison) {
  Table rows;
  rows.header = {"Set ΔT (K)",
                 "Acuity, measured : simulated, paired [95 %]",
                 "Ratio [90 %]",
                 "p different",
                 "p equivalent",
                 "Standard error (%)",
                 "Share of the twin's noise (variance, %)",
                 "Verdict"};
  for (const ComparisonPoint& point : comparison.points) {
    if (!point.paired) continue;
    const RatioOfPairs& paired = *point.paired;
    rows.rows.push_back({plain(stated(point.set_delta_t_k)), interval_or_missing(paired.ratio, paired.ci95, ""),
                         interval_or_missing(paired.ratio, paired.ci90, ""), plain(probability(paired.p_difference)),
                         plain(probability(paired.p_equivalence)), plain(significant(100 * paired.se_ln_ratio, 2)),
                         plain(significant(100 * paired.twin_share, 2)),
                         badge(in_words(paired.verdict), mood_of(paired.verdict))});
  }
  if (rows.rows.empty()) return std::nullopt;
  return rows;
}

Section comparison_section(const ReportData& data) {
  constexpr const char* title = "Measured against simulated";
  if (!data.comparison) {
    const std::string_view reason =
        data.measured && data.simulated ? "not requested" : "needs a measured and a simulated curve";
    return {title, {Paragraph{missing(reason)}}};
  }
  Table rows;
  rows.header = {"Set ΔT (K)",
                 "Effective ΔT, measured / simulated (K)",
                 "Acuity, measured : simulated [95 %]",
                 "Ratio [90 %]",
                 "p different",
                 "p equivalent",
                 "Margin (%)",
                 "Verdict"};
  for (const ComparisonPoint& point : data.comparison->points) {
    rows.rows.push_back({plain(stated(point.set_delta_t_k)),
                         unbroken(significant(point.delta_t_a_k, 3) + " / " + significant(point.delta_t_b_k, 3)),
                         interval_or_missing(point.ratio, point.ratio_ci95, "a threshold is not identified"),
                         interval_or_missing(point.ratio, point.ratio_ci90, "a threshold is not identified"),
                         point.p_difference ? plain(probability(*point.p_difference)) : missing("no test possible"),
                         point.p_equivalence ? plain(probability(*point.p_equivalence)) : missing("no test possible"),
                         plain(stated(point.margin_percent)), badge(in_words(point.verdict), mood_of(point.verdict))});
  }
  const RichText overall =
      plain("Over all contrasts: ") + badge(in_words(data.comparison->verdict), mood_of(data.comparison->verdict));
  List findings;
  if (data.comparison->adequacy)
    for (const AdequacyFinding& finding : data.comparison->adequacy->findings)
      findings.items.push_back(plain(finding.sentence));
  Section section{title, {std::move(rows)}};
  if (auto paired = paired_table(*data.comparison)) {
    section.blocks.emplace_back(
        note(plain("Paired by presentation: the twin took the same presentations as the camera, with the same "
                   "sub-pixel phases. The verdict uses these ratios. " +
                   not_cancelled_by_pairs(data.measured && has_contrast_measured_once(*data.measured)))));
    section.blocks.emplace_back(*std::move(paired));
  }
  section.blocks.emplace_back(Paragraph{overall});
  if (!findings.items.empty()) section.blocks.emplace_back(std::move(findings));
  section.blocks.emplace_back(
      note(plain("p different: likelihood-ratio test of a common threshold, corrected for groups of trials. p "
                 "equivalent: two one-sided tests that the ratio lies within the margin, which was chosen before the "
                 "measurement. If p equivalent is below 0.05, the 90 % interval lies within the margin. If neither "
                 "test is significant, the result is inconclusive and more trials are needed.")));
  return section;
}

std::optional<Section> answers_section(const ReportData& data) {
  TablePairs pairs;
  if (data.measured) pairs.tables.emplace_back(answers_table("Measured", *data.measured));
  if (data.simulated) pairs.tables.emplace_back(answers_table("Simulated", *data.simulated));
  if (pairs.tables.empty()) return {};
  Section section{"Appendix: answers by size", {std::move(pairs)}};
  TablePairs directions;
  for (const auto& [caption, curve] :
       {std::pair("Measured", &data.measured), std::pair("Simulated", &data.simulated)}) {
    Table table = *curve ? directions_table(std::string(caption) +
                                                ", 75 % size by the direction of the triangles in "
                                                "the picture, over that of all directions; ±: standard error",
                                            **curve)
                         : Table{};
    if (!table.rows.empty()) directions.tables.push_back(std::move(table));
  }
  if (!directions.tables.empty()) section.blocks.emplace_back(std::move(directions));
  return section;
}

}  // namespace todbench
