// SPDX-License-Identifier: GPL-3.0-or-later
// Section of a person's answers to the camera's frames, compared with the model.
#include <algorithm>
#include <functional>
#include <set>

#include "bench/report/number_format.h"
#include "bench/report/report_pieces.h"
#include "bench/report/tod_figures.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

RichText threshold_cell(const PsychometricFit& fit) {
  return interval_or_missing(stated_threshold(fit), fit.ci95, "not identified");
}

/// Returns the curve of the model observer for the same frames: of the camera, or of a simulated one.
const std::optional<TodCurve>& model_curve(const ReportData& data) {
  return data.measured ? data.measured : data.simulated;
}

/// "P2, 34 years, acuity 1.2, 0.6 m from EIZO, white 120 cd/m²"
std::string facts_in_words(const PersonFacts& person, std::size_t number) {
  std::string text = person.code.empty() ? "person " + std::to_string(number) : person.code;
  if (person.age_years) text += ", " + shown(*person.age_years, 0) + " years";
  if (person.acuity_decimal) text += ", acuity " + stated(*person.acuity_decimal);
  if (person.distance_m) text += ", " + stated(*person.distance_m) + " m from the screen";
  if (!person.screen.empty()) text += ", " + person.screen;
  if (person.luminance_cd_m2) text += ", white " + stated(*person.luminance_cd_m2) + " cd/m²";
  if (person.training_answers > 0) text += ", " + std::to_string(person.training_answers) + " answers of training";
  return text;
}

/// All people with their thresholds, and their mean.
Table people_table(const ReportData& data) {
  Table rows;
  rows.caption = "All people. Mean: geometric, every person once; its interval contains the scatter between people";
  rows.header = {"Person", "Day (UTC)"};
  const std::vector<PeopleMean> means = mean_over_people(data.people);
  std::set<double, std::greater<>> contrasts_k;
  for (const PersonRecord& one : data.people) {
    for (const TodPoint& point : one.record.curve.points) contrasts_k.insert(point.set_delta_t_k);
  }
  for (const double contrast_k : contrasts_k) rows.header.push_back("S₇₅ at " + stated(contrast_k) + " K (mrad)");
  for (std::size_t i = 0; i < data.people.size(); ++i) {
    const PersonRecord& one = data.people[i];
    std::vector<RichText> row{plain(facts_in_words(one.person, i + 1)), plain(one.person.judged_utc.substr(0, 10))};
    for (const double contrast_k : contrasts_k) {
      const TodPoint* point = point_at(one.record.curve, contrast_k);
      row.push_back(point == nullptr ? missing("not asked") : threshold_cell(point->fit));
    }
    rows.rows.push_back(std::move(row));
  }
  std::vector<RichText> last{plain("mean"), plain("")};
  for (const double contrast_k : contrasts_k) {
    const auto mean = std::ranges::find(means, contrast_k, &PeopleMean::set_delta_t_k);
    if (mean == means.end()) {
      last.push_back(missing("no person has a threshold"));
      continue;
    }
    Interval interval;
    if (mean->ci95_mrad) interval = {mean->ci95_mrad->first, mean->ci95_mrad->second};
    last.push_back(interval_or_missing(mean->s75_mrad, interval, "one person"));
  }
  rows.rows.push_back(std::move(last));
  return rows;
}

}  // namespace

std::vector<Plot> human_plots(const ReportData& data) {
  std::vector<Plot> plots;
  if (!data.human) return plots;
  const auto& model = model_curve(data);
  for (const TodPoint& point : data.human->points) {
    plots.push_back(psychometric_figure("human-" + std::to_string(plots.size() + 1), {"human", &point},
                                        {"model", model ? point_at(*model, point.set_delta_t_k) : nullptr},
                                        data.fit.form));
  }
  return plots;
}

std::optional<Section> human_section(const ReportData& data) {
  if (!data.human) return {};
  const auto& model = model_curve(data);
  Table rows;
  rows.caption = "Person and model observer on the same frames; brackets: 95 % interval";
  rows.header = {"Set ΔT (K)", "Human S₇₅ (mrad)", "Human slope", "Human trials", "Human fit", "Model S₇₅ (mrad)"};
  for (const TodPoint& point : data.human->points) {
    const TodPoint* judged = model ? point_at(*model, point.set_delta_t_k) : nullptr;
    rows.rows.push_back({plain(stated(point.set_delta_t_k)), threshold_cell(point.fit),
                         point.fit.slope ? plain(significant(*point.fit.slope, 3)) : missing("not identified"),
                         plain(shown(point.fit.trials, 0)), plain(in_words(point.fit.verdict)),
                         judged == nullptr ? missing("not measured") : threshold_cell(judged->fit)});
  }
  FigurePairs figures;
  const std::vector<Plot> plots = human_plots(data);
  for (std::size_t i = 0; i < plots.size(); ++i)
    figures.figures.push_back(
        {drawn(plots[i]), "Set contrast ΔT = " + stated(data.human->points[i].set_delta_t_k) + " K"});
  Section section{"Human observer", {}};
  if (data.people.size() > 1) {
    section.blocks.emplace_back(people_table(data));
    rows.caption = "The first person and the model observer on the same frames; brackets: 95 % interval";
  } else if (!data.people.empty() && !data.people.front().person.code.empty()) {
    section.blocks.emplace_back(note(plain("Person: " + facts_in_words(data.people.front().person, 1) + ".")));
  }
  section.blocks.emplace_back(std::move(rows));
  section.blocks.emplace_back(std::move(figures));
  section.blocks.emplace_back(
      note(plain("Task: four alternatives, no feedback, patches in random order. The answers of "
                 "the model were not shown.")));
  return section;
}

}  // namespace todbench
