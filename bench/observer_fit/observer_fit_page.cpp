// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/observer_fit/observer_fit_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "bench/report/number_format.h"
#include "bench/report/plot.h"
#include "bench/report/report_pieces.h"
#include "bench/report/tod_figures.h"

namespace todbench {
namespace {

RichText estimate(const std::optional<double>& value, const Interval& interval) {
  return value ? interval_or_missing(value, interval, "not identified") : missing("not identified");
}

VerdictBox verdict(const PeopleFit& fit) {
  VerdictBox box;
  box.mood = fit.usable() ? Mood::good : fit.accepted ? Mood::open : Mood::bad;
  box.word = fit.usable() ? "✓ MODEL FITS" : fit.accepted ? "? NOT IDENTIFIED" : "✗ MODEL REJECTED";
  box.paragraphs.push_back(
      plain(fmt::format("The test asks how often the fitted model itself gives answers at least as unusual as those of "
                        "the person. The smallest probability over the people is {}. The model is rejected if it is at "
                        "most {} divided by the number of people.",
                        probability(fit.least_p), probability(fit.options.least_p))));
  for (const std::string& sentence : fit.not_identified) box.paragraphs.push_back(plain(sentence));
  return box;
}

Section parameters(const PeopleFit& fit) {
  Table table;
  table.header = {"Parameter", "Before", fit.people.size() == 1 ? "Fitted, 95 %" : "Mean over people, 95 %"};
  const bool several = fit.people.size() > 1;
  if (several) table.header.insert(table.header.end(), {"Between people, 95 %", "Heterogeneity: p"});
  const ObserverValues before = start_values(fit.options.from);
  const bool eye = fit.options.kind() == FittedKind::eye;
  if (eye) table.header.emplace_back("Distance from the default, in spreads");
  for (std::size_t k = 0; k < observer_key_count; ++k) {
    std::vector<RichText> row{plain(fit.options.parameter(k)), plain(stated(before[k])),
                              fit.options.free[k] ? estimate(fit.values[k], fit.ci95[k]) : missing("not free")};
    if (several) {
      const PeopleSpread& spread = fit.spread[k];
      row.push_back(estimate(spread.between_sd, spread.between_sd_ci95));
      row.push_back(spread.heterogeneity_p ? plain(probability(*spread.heterogeneity_p)) : missing("not free"));
    }
    if (eye) {
      const auto spreads = spreads_from_default(fit, k);
      row.push_back(spreads ? plain(shown(*spreads, 2)) : missing("not an open parameter"));
    }
    table.rows.push_back(std::move(row));
  }
  Section out{"Parameters", {std::move(table)}};
  if (eye) {
    out.blocks.emplace_back(
        note(plain("A spread is half of the range over which public data leave a parameter of the eye open.")));
  }
  if (several)
    out.blocks.emplace_back(
        note(plain("Between people: standard deviation of the logarithm of the parameter; for the lapse rate, of the "
                   "rate itself.")));
  return out;
}

Section worth() {
  return {"Validity of the model",
          {Paragraph{plain("With these parameters the template observer answers most like the people named here, for "
                           "these patches and this presentation. A model that is not rejected is not proven: this "
                           "number of answers does not distinguish it from these people. Blur and internal noise "
                           "include every effect that acts like them, such as the display and its distance.")}}};
}

PlotSeries curve_series(const FittedPerson& person, double contrast, PlotTone tone, bool model) {
  PlotSeries series;
  series.label = (model ? "model, " : "person, ") + stated(contrast) + " K";
  series.tone = tone;
  series.marker = model ? PlotMarker::none : PlotMarker::disc;
  series.line = model ? PlotLine::solid : PlotLine::none;
  for (const AnswerCell& cell : person.goodness.cells) {
    const ShownSize& shown = person.cells[static_cast<std::size_t>(cell.cell)];
    if (shown.set_delta_t_k != contrast) continue;
    PlotPoint point;
    point.x = shown.size_mrad;
    point.y = (model ? cell.expected : cell.correct) / cell.answers;
    if (!model) point.y_interval = wilson_interval(cell.correct, cell.answers);
    series.points.push_back(point);
  }
  return series;
}

Plot psychometric_plot(const FittedPerson& person, const std::string& id) {
  Plot plot;
  plot.id = id;
  plot.title = "Proportion correct against size";
  plot.description =
      "Proportion correct of the person, with Wilson intervals, and of the fitted observer, by contrast.";
  double low = person.cells.front().size_mrad, high = low;
  std::set<double> contrasts;
  for (const ShownSize& shown : person.cells) {
    low = std::min(low, shown.size_mrad);
    high = std::max(high, shown.size_mrad);
    contrasts.insert(shown.set_delta_t_k);
  }
  plot.x = {
      .label = "Size S (mrad)", .scale = AxisScale::logarithmic, .low = low / 1.1, .high = high * 1.1, .ticks = {}};
  plot.y = {.label = "Proportion correct", .scale = AxisScale::linear, .low = 0, .high = 1.05, .ticks = {}};
  plot.references = {{0.25, "guessing"}, {0.75, "75 %"}};
  const PlotTone tones[] = {PlotTone::first, PlotTone::second, PlotTone::third, PlotTone::muted};
  std::size_t index = 0;
  for (auto contrast = contrasts.rbegin(); contrast != contrasts.rend(); ++contrast) {
    const PlotTone tone = tones[index++ % 4];
    plot.series.push_back(curve_series(person, *contrast, tone, true));
    plot.series.push_back(curve_series(person, *contrast, tone, false));
  }
  return plot;
}

Plot residual_plot(const FittedPerson& person, const std::string& id) {
  Plot plot = psychometric_plot(person, id);
  plot.title = "Residuals against size";
  plot.description =
      "Number of correct answers minus the number expected from the fitted observer, divided by its standard "
      "deviation.";
  double most = 3;
  for (PlotSeries& series : plot.series) series.points.clear();
  std::erase_if(plot.series, [](const PlotSeries& series) { return series.marker == PlotMarker::none; });
  std::size_t index = 0;
  std::map<double, std::size_t, std::greater<>> rank;
  for (const ShownSize& shown : person.cells) rank[shown.set_delta_t_k] = 0;
  for (auto& [contrast, at] : rank) at = index++;
  for (const AnswerCell& cell : person.goodness.cells) {
    if (!(cell.sd > 0)) continue;
    const ShownSize& shown = person.cells[static_cast<std::size_t>(cell.cell)];
    PlotPoint point;
    point.x = shown.size_mrad;
    point.y = (cell.correct - cell.expected) / std::max(cell.sd, 0.2);
    most = std::max(most, std::abs(*point.y) + 0.5);
    plot.series[rank[shown.set_delta_t_k]].points.push_back(point);
  }
  plot.y = {.label = "Residual (sd)", .scale = AxisScale::linear, .low = -most, .high = most, .ticks = {}};
  plot.references = {{0, ""}};
  return plot;
}

Table confusion(const Goodness& goodness) {
  Table table;
  table.caption = "Answers by direction of the triangle; in brackets: expected from the fitted observer";
  table.header = {"Triangle"};
  for (const Apex apex : all_apexes) table.header.push_back("Answer " + std::string(to_string(apex)));
  for (std::size_t t = 0; t < 4; ++t) {
    std::vector<RichText> row{plain(to_string(all_apexes[t]))};
    for (std::size_t o = 0; o < 4; ++o) {
      row.push_back(
          unbroken(shown(goodness.confusion[t][o], 0) + " (" + shown(goodness.expected_confusion[t][o], 1) + ")"));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table tests(const Goodness& goodness) {
  Table table;
  table.caption = fmt::format("Goodness-of-fit tests, from {} simulated replicates of the model", goodness.replicates);
  table.header = {"Test", "Statistic", "Expected", "p"};
  for (std::size_t k = 0; k < all_misfit_kinds.size(); ++k) {
    const MisfitTest& test = goodness.tests[k];
    table.rows.push_back({plain(words(to_string(all_misfit_kinds[k]))), plain(shown(test.statistic, 1)),
                          plain(shown(test.expected, 1)), plain(probability(test.p))});
  }
  table.rows.push_back({plain("joint test"), missing("the joint test uses the smallest p of the tests"),
                        missing("the joint test uses the smallest p of the tests"), plain(probability(goodness.p))});
  return table;
}

Section person_section(const PeopleFit& fit, std::size_t index) {
  const FittedPerson& person = fit.people[index];
  const std::string id = "person-" + std::to_string(index + 1);
  ValueTable values;
  for (const std::size_t s : person.sessions)
    values.values.push_back({"Session", plain(label_of(fit.sessions[s]) + ", " +
                                              std::to_string(fit.sessions[s].human.trials.size()) + " answers")});
  for (std::size_t k = 0; k < observer_key_count; ++k) {
    if (person.fit.free[k])
      values.values.push_back({fit.options.parameter(k), estimate(person.fit.values[k], person.fit.ci95[k])});
  }
  for (std::size_t a = 0; a < observer_key_count; ++a) {
    for (std::size_t b = a + 1; b < observer_key_count; ++b) {
      if (const auto r = correlation(person.fit, a, b))
        values.values.push_back(
            {"Correlation of " + fit.options.parameter(a) + " and " + fit.options.parameter(b), plain(shown(*r, 2))});
    }
  }
  return {"Person " + std::to_string(index + 1),
          {std::move(values),
           FigurePairs{{Figure{drawn(psychometric_plot(person, id + "-curve")), "Answers and fitted observer"},
                        Figure{drawn(residual_plot(person, id + "-residuals")), "Residuals by size and contrast"}}},
           tests(person.goodness), confusion(person.goodness)}};
}

}  // namespace

Document people_fit_document(const PeopleFit& fit) {
  Document out{.title = "Observer " + fit.options.name,
               .heading = "Observer " + fit.options.name,
               .subtitle = "Fitted to people, from " + fit.options.from.name,
               .page_label = "Observer " + fit.options.name,
               .opening = {verdict(fit)},
               .sections = {parameters(fit), worth()}};
  for (std::size_t p = 0; p < fit.people.size(); ++p) out.sections.push_back(person_section(fit, p));
  return out;
}

}  // namespace todbench
