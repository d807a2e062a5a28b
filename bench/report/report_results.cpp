// SPDX-License-Identifier: GPL-3.0-or-later
// Sections on results: curves, functions, comparison.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/judgement/demand_kinds.h"
#include "bench/judgement/verdict.h"
#include "bench/report/fit_words.h"
#include "bench/report/number_format.h"
#include "bench/report/report_pieces.h"
#include "bench/report/tod_figures.h"
#include "tod/comparison/paired_ratio.h"
#include "tod/psychometric/acuity.h"
#include "tod/psychometric/contrast_slope.h"

namespace todbench {
namespace {

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
                            interval_or_missing(stated_threshold(fit), fit.ci95, reason),
                            interval_or_missing(stated_acuity_per_mrad(fit), acuity_interval(fit.ci95), reason),
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

/// The threshold of the only person who has one, with its own interval, or the mean over people.
PsychometricFit fit_of_people(const ReportData& data, const PeopleMean& mean) {
  PsychometricFit fit;
  fit.threshold = mean.s75_mrad;
  if (mean.ci95_mrad) fit.ci95 = {mean.ci95_mrad->first, mean.ci95_mrad->second};
  if (mean.people > 1) return fit;
  for (const PersonRecord& one : data.people) {
    const TodPoint* point = point_at(one.record.curve, mean.set_delta_t_k);
    if (point != nullptr && threshold_identified(point->fit)) return point->fit;
  }
  return fit;
}

/// One person, or the thresholds of all people: a line of a person without a threshold says nothing beside them.
std::pair<std::string, TodCurve> of_people(const ReportData& data) {
  const std::vector<PeopleMean> means = mean_over_people(data.people);
  if (data.people.size() < 2 || means.empty()) return {"human", *data.human};
  TodCurve curve;
  int people = 0;
  for (const PeopleMean& mean : means) {
    people = std::max(people, mean.people);
    TodPoint point;
    point.set_delta_t_k = point.delta_t_k = mean.set_delta_t_k;
    if (const TodPoint* judged = point_at(*data.human, mean.set_delta_t_k)) point.delta_t_k = judged->delta_t_k;
    point.fit = fit_of_people(data, mean);
    curve.points.push_back(std::move(point));
  }
  return {people > 1 ? "mean of " + std::to_string(people) + " people" : "human", std::move(curve)};
}

}  // namespace

Plot tod_plot(const ReportData& data) {
  const std::vector<DrawnLimit> limits = acuity_limits(data);
  Plot plot = tod_figure({measured_name(data), pointer(data.measured)}, {simulated_name(data), pointer(data.simulated)},
                         limits);
  if (!data.human) return plot;
  // Curve of the person or of the mean over people in the style of the figure, in the third tone.
  const auto [name, curve] = of_people(data);
  const Plot human = tod_figure({name, &curve}, {}, {});
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

std::string curve_caption(const ReportData& data) {
  std::string caption =
      "TOD curve: acuity (linear) against effective contrast (logarithmic), the contrast that the camera observed. "
      "Horizontal bars are 95 % intervals. An arrow marks a side that the data do not bound. The two curves are drawn "
      "a few pixels apart so that their bars do not hide each other.";
  if (data.measured && !data.measured->continuous.empty())
    caption += " The line of a ramp is the fit over all contrasts, the dotted lines are its 95 % limits.";
  return caption;
}

Section curve_section(const ReportData& data) {
  if (!data.measured && !data.simulated) return {"TOD curve", {Paragraph{missing("no results")}}};
  Section section{"TOD curve", {}};
  section.blocks.emplace_back(Figure{drawn(tod_plot(data)), curve_caption(data)});
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
                         badge(to_string(paired.verdict), mood_of(paired.verdict))});
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
                         plain(stated(point.margin_percent)), badge(to_string(point.verdict), mood_of(point.verdict))});
  }
  const RichText overall =
      plain("Over all contrasts: ") + badge(to_string(data.comparison->verdict), mood_of(data.comparison->verdict));
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
