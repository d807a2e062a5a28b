// SPDX-License-Identifier: GPL-3.0-or-later
// Page of an evaluated comparison.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "bench/report/number_format.h"
#include "bench/report/plot.h"
#include "bench/report/report_pieces.h"
#include "bench/round_robin/round_robin_output.h"
#include "bench/session/build_info.h"

namespace todbench {
namespace {

/// Value and expanded uncertainty with the digits that leave two of the uncertainty.
std::string with_expanded(double value, double expanded) {
  const int decimals = decimals_for(value, {value - expanded, value + expanded});
  return shown(value, decimals) + " ± " + shown(expanded, decimals);
}

std::string p_text(double p) {
  const std::string text = probability(p);
  return (text.starts_with('<') ? "p " : "p = ") + text;
}

std::string label_of(const ComparedItem& item) {
  return item.quantity + (item.unit.empty() ? "" : " (" + item.unit + ")");
}

std::string method_words(const ItemComparison& item) {
  switch (item.reference.method) {
    case ReferenceMethod::weighted_mean:
      return "weighted mean of the consistent results (Cox 2002, procedure A)";
    case ReferenceMethod::median:
      return "median by Monte Carlo, because a few results are inconsistent (Cox 2002, procedure B)";
    case ReferenceMethod::paule_mandel:
      return "mean of Paule and Mandel, because the results scatter more than their uncertainties explain";
  }
  return "";
}

PlotSeries vertical_line(double x, double height, std::string label, PlotTone tone, PlotLine line) {
  PlotSeries out{.label = std::move(label), .tone = tone, .marker = PlotMarker::none, .line = line, .points = {}};
  for (const double y : {0.0, height}) out.points.push_back({.x = x, .y = y, .x_interval = {}, .y_interval = {}});
  return out;
}

Figure results_figure(const ItemComparison& item, const TruthCheck* truth, std::size_t number) {
  const double height = static_cast<double>(item.degrees.size()) + 1;
  Plot plot;
  plot.id = "round-robin-" + std::to_string(number);
  plot.title = "Results of the laboratories";
  plot.description =
      "Result of every laboratory with its expanded uncertainty, and the interval of the reference value.";
  plot.height = std::clamp(120 + 26 * height, 220.0, 900.0);
  PlotSeries kept{.label = "result, k = 2", .tone = PlotTone::first, .marker = PlotMarker::disc, .points = {}};
  PlotSeries aside{
      .label = "outlying result, k = 2", .tone = PlotTone::second, .marker = PlotMarker::square, .points = {}};
  const double reference = item.reference.value.value, wide = item.reference.expanded_u;
  double low = reference - wide, high = reference + wide;
  for (std::size_t i = 0; i < item.degrees.size(); ++i) {
    const auto& [laboratory, value, u] = item.degrees[i].result;
    (item.degrees[i].outlying ? aside : kept)
        .points.push_back({.x = value,
                           .y = static_cast<double>(i + 1),
                           .x_interval = {value - 2 * u, value + 2 * u},
                           .y_interval = {}});
    low = std::min(low, value - 2 * u), high = std::max(high, value + 2 * u);
    plot.y.ticks.push_back(static_cast<double>(i + 1));
  }
  plot.bands.push_back(
      {.label = "reference value, 95 %", .tone = PlotTone::muted, .x = {reference - wide, reference + wide}});
  plot.series.push_back(vertical_line(reference, height, "", PlotTone::muted, PlotLine::solid));
  if (truth != nullptr) {
    plot.series.push_back(
        vertical_line(truth->truth.value, height, "sealed true value", PlotTone::third, PlotLine::dashed));
    low = std::min(low, truth->truth.value), high = std::max(high, truth->truth.value);
  }
  if (!aside.points.empty()) plot.series.push_back(std::move(aside));
  plot.series.push_back(std::move(kept));
  const double room = 0.05 * (high - low);
  plot.x.label = label_of(item.item), plot.x.low = low - room, plot.x.high = high + room;
  plot.y.label = "Laboratory (number in the table)", plot.y.low = 0, plot.y.high = height;
  return {drawn(plot), "Results with their expanded uncertainties, and the interval of the reference value"};
}

Table degrees_table(const ItemComparison& item) {
  Table table{
      .caption = "Degrees of equivalence: difference from the reference value with its expanded uncertainty, k = 2",
      .header = {"No.", "Laboratory", "Result, k = 2", "Difference, k = 2", "E_n", "Zeta", "Finding"},
      .rows = {}};
  for (std::size_t i = 0; i < item.degrees.size(); ++i) {
    const DegreeOfEquivalence& degree = item.degrees[i];
    table.rows.push_back({plain(std::to_string(i + 1)), plain(degree.result.laboratory),
                          unbroken(with_expanded(degree.result.value, 2 * degree.result.u)),
                          unbroken(with_expanded(degree.difference, degree.expanded_u)), plain(shown(degree.e_n, 2)),
                          plain(shown(degree.zeta, 2)),
                          degree.outlying            ? badge("outlying", Mood::bad)
                          : std::abs(degree.e_n) > 1 ? badge("|E_n| > 1", Mood::open)
                                                     : badge("satisfactory", Mood::good)});
  }
  return table;
}

ValueTable reference_table(const ItemComparison& item, const TruthCheck* truth) {
  const auto check = [](const ConsistencyCheck& c) {
    return plain(fmt::format("chi2 = {} with {} degrees of freedom, {}, Birge ratio {}", shown(c.chi2, 2),
                             c.degrees_of_freedom, p_text(c.p), shown(c.birge_ratio, 2)));
  };
  const auto estimate = [](const Consensus& c, double expanded) { return unbroken(with_expanded(c.value, expanded)); };
  ValueTable table{.caption = "Reference value and consistency", .values = {}};
  table.values = {
      {"Reference value", unbroken(with_expanded(item.reference.value.value, item.reference.expanded_u)) +
                              plain(", 95 %, k = " + stated(item.reference.k))},
      {"Kind", plain(method_words(item))},
      {"Consistency of all results", check(item.all)},
      {"Consistency without outlying ones", check(item.kept)},
      {"Weighted mean, k = 2", estimate(item.weighted, 2 * item.weighted.u)},
      {"Median by Monte Carlo, k = 2", estimate(item.median, 2 * item.median.u)},
      {"Largest consistent subset, k = 2",
       estimate(item.consistent_subset, 2 * item.consistent_subset.u) +
           plain(fmt::format(" ({} of {} laboratories)", item.consistent_laboratories.size(), item.degrees.size()))},
      {"DerSimonian and Laird, k = 2",
       estimate(item.dersimonian_laird.mean, 2 * item.dersimonian_laird.hartung_knapp) +
           plain(", between laboratories " + significant(item.dersimonian_laird_sd, 2))},
      {"Paule and Mandel, k = 2", estimate(item.paule_mandel.mean, 2 * item.paule_mandel.hartung_knapp) +
                                      plain(", between laboratories " + significant(item.paule_mandel_sd, 2))}};
  if (truth != nullptr) {
    table.values.push_back({"Sealed true value, k = 2",
                            truth->truth.u > 0 ? unbroken(with_expanded(truth->truth.value, 2 * truth->truth.u))
                                               : plain(stated(truth->truth.value))});
    table.values.push_back(
        {"Reference value against it", plain("E_n = " + shown(truth->e_n, 2) + " ") +
                                           (truth->held ? badge("holds the true value", Mood::good)
                                                        : badge("does not hold the true value", Mood::bad))});
  }
  return table;
}

Section laboratories_section(const RoundRobin& found) {
  Table table{.caption =
                  "Deviation of each laboratory from the others over all items. Combined zeta: sum of its zeta "
                  "over the root of the number of items",
              .header = {"Laboratory", "Items", "Combined zeta", "p of this laboratory", "Finding"},
              .rows = {}};
  for (const LaboratorySummary& one : found.laboratories)
    table.rows.push_back({plain(one.laboratory), plain(std::to_string(one.items)), plain(shown(one.combined_zeta, 2)),
                          plain(probability(one.p)),
                          one.outlying ? badge("outlying", Mood::bad) : badge("not outlying", Mood::good)});
  return {"Laboratories", {std::move(table)}};
}

VerdictBox round_robin_verdict(const RoundRobin& found) {
  VerdictBox box;
  if (found.consistent()) {
    box.word = "✓ CONSISTENT", box.mood = Mood::good;
    box.paragraphs.push_back(plain("No laboratory and no result is outlying, and every item is consistent."));
  } else if (!found.outlying.empty()) {
    box.word = "✗ OUTLYING", box.mood = Mood::bad;
    for (const OutlyingResult& one : found.outlying) {
      box.paragraphs.push_back(
          strong(one.laboratory) +
          plain((one.item.empty() ? ", over all its items" : ", item " + one.item + ", " + one.quantity) + ": zeta = " +
                shown(one.zeta, 2) + ". Chance gives any laboratory so much with " + p_text(one.p) + "."));
    }
    if (found.reference_from_all)
      box.paragraphs.push_back(
          plain("Several laboratories deviate: all may understate their uncertainties. The reference values therefore "
                "come from all results."));
  } else {
    box.word = "? INCONSISTENT", box.mood = Mood::open;
    box.paragraphs.push_back(
        plain("The results scatter more than their uncertainties explain, and no single one can be named."));
  }
  return box;
}

}  // namespace

Document round_robin_page(const RoundRobin& found, const std::vector<TruthCheck>& truths) {
  Document document{.title = "Interlaboratory comparison",
                    .heading = "Interlaboratory comparison",
                    .subtitle = fmt::format("{} laboratories, {} items", found.laboratories.size(), found.items.size()),
                    .page_label = "Interlaboratory comparison",
                    .opening = {round_robin_verdict(found)},
                    .sections = {}};
  document.opening.emplace_back(Paragraph{plain(
      "E_n is the difference from the reference value over its expanded uncertainty, k = 2; results with |E_n| of at "
      "most 1 are satisfactory (ISO 13528, ISO/IEC 17043). By chance one correct result in 20 exceeds 1. Outlying is "
      "what "
      "chance gives any laboratory of this comparison with a probability below 2.5 %. The errors of a laboratory are "
      "taken "
      "as independent between items.")});
  document.sections.push_back(laboratories_section(found));
  for (std::size_t j = 0; j < found.items.size(); ++j) {
    const ItemComparison& item = found.items[j];
    const TruthCheck* truth = truths.empty() ? nullptr : &truths[j];
    document.sections.push_back(
        {item.item.item + ": " + label_of(item.item),
         {results_figure(item, truth, j + 1), degrees_table(item), reference_table(item, truth)}});
  }
  document.sections.push_back(
      {"Record",
       {ValueTable{.caption = "Origin of the numbers",
                   .values = {{"Program", plain("todbench " + std::string(build_info().version) + " (" +
                                                std::string(build_info().commit) + ")")}}}}});
  return document;
}

}  // namespace todbench
