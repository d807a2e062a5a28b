// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/model_comparison/model_comparison_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "bench/enhance/decidable.h"
#include "bench/report/number_format.h"
#include "bench/report/report_pieces.h"
#include "bench/report/tod_figures.h"
#include "bench/session/build_info.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

const TodPoint* point_at(const PackageResult& result, double set_delta_t_k) {
  for (const TodPoint& point : result.curve.points) {
    if (same_contrast(point.set_delta_t_k, set_delta_t_k)) return &point;
  }
  return nullptr;
}

RichText acuity_cell(const TodPoint* point) {
  if (point == nullptr) return missing("not measured");
  return interval_or_missing(identified_acuity_per_mrad(*point), acuity_interval(point->fit.ci95), "no threshold");
}

Section acuity_comparison(const ModelComparison& comparison) {
  Table table{.caption = "Acuity of both models and ratio B / A, paired 95 % intervals",
              .header = {"Set contrast (K)", "A (1/mrad), 95 %", "B (1/mrad), 95 %", "B / A, 95 %", "Different"},
              .rows = {}};
  for (const PairedRatio& ratio : comparison.ratios) {
    const auto apart = parts(ratio);
    table.rows.push_back({plain(stated(ratio.set_delta_t_k)),
                          acuity_cell(point_at(comparison.result_a, ratio.set_delta_t_k)),
                          acuity_cell(point_at(comparison.result_b, ratio.set_delta_t_k)),
                          interval_or_missing(ratio.ratio, ratio.ci95, "a threshold is missing"),
                          !apart   ? missing("no interval")
                          : *apart ? strong("yes")
                                   : plain("not shown")});
  }
  Section section{"Acuity", {std::move(table)}};
  List spreads;
  for (const auto& [side, result] : {std::pair("A", &comparison.result_a), std::pair("B", &comparison.result_b)}) {
    for (const TodPoint& point : result->curve.points) {
      const auto acuity = acuity_spread_per_mrad(point.s75_spread_mrad);
      if (!acuity) continue;
      spreads.items.push_back(plain(std::string(side) + " at " + stated(point.set_delta_t_k) +
                                    " K: " + significant(*acuity->low, 3) + " to " + significant(*acuity->high, 3) +
                                    " per mrad"));
    }
  }
  for (const PairedRatio& ratio : comparison.ratios) {
    if (!ratio.spread) continue;
    spreads.items.push_back(plain("B / A at " + stated(ratio.set_delta_t_k) + " K: " +
                                  significant(ratio.spread->first, 3) + " to " + significant(ratio.spread->second, 3)));
  }
  if (!spreads.items.empty()) {
    section.blocks.emplace_back(Paragraph{strong("Acuity and ratio over the open parameters of the observer")});
    section.blocks.emplace_back(
        Paragraph{plain("These are the values at the ends of the ranges of all open parameters together. They are "
                        "not confidence intervals: no probability belongs to them.")});
    section.blocks.emplace_back(std::move(spreads));
  }
  if (!comparison.result_a.curve.points.empty() && !comparison.result_b.curve.points.empty()) {
    Plot plot = tod_figure({"A: " + comparison.a.name, &comparison.result_a.curve},
                           {"B: " + comparison.b.name, &comparison.result_b.curve}, {});
    plot.id = "models-tod";
    section.blocks.emplace_back(Figure{drawn(plot), "TOD curves"});
  }
  return section;
}

Section transfer_section(const ModelComparison& comparison) {
  Section section{"Transfer functions along x", {}};
  Plot plot;
  plot.id = "models-mtf";
  plot.title = "Transfer functions";
  plot.description = "Moduli of both models over spatial frequency.";
  plot.height = 320;
  plot.x.label = "Frequency (cycles/mrad)";
  plot.x.high = comparison.transfer.back().frequency_per_mrad;
  double highest = 1;
  PlotSeries a{.label = "A: " + comparison.a.name,
               .tone = PlotTone::first,
               .marker = PlotMarker::none,
               .line = PlotLine::solid,
               .points = {}};
  PlotSeries b{.label = "B: " + comparison.b.name,
               .tone = PlotTone::second,
               .marker = PlotMarker::none,
               .line = PlotLine::dashed,
               .points = {}};
  for (const TransferPoint& point : comparison.transfer) {
    a.points.push_back({.x = point.frequency_per_mrad, .y = point.a, .x_interval = {}, .y_interval = {}});
    b.points.push_back({.x = point.frequency_per_mrad, .y = point.b, .x_interval = {}, .y_interval = {}});
    highest = std::max({highest, point.a, point.b});
  }
  plot.y.label = "Modulus";
  plot.y.high = 1.05 * highest;
  plot.series = {std::move(a), std::move(b)};
  section.blocks.emplace_back(
      Figure{drawn(plot), comparison.parts_at_per_mrad
                              ? fmt::format("The moduli differ by more than 0.01 at frequencies above {} cycles/mrad.",
                                            significant(*comparison.parts_at_per_mrad, 3))
                              : std::string("The moduli differ by at most 0.01 at every frequency.")});
  return section;
}

Section differences_section(const ModelComparison& comparison) {
  Section section{"Pixels and parameters", {}};
  Table pixels{
      .caption = "B minus A over the picture of the first plate at the largest contrast, with the same random numbers",
      .header = {"Picture", "Mean (K)", "RMS (K)", "Largest (K)", "Row, column"},
      .rows = {}};
  for (const PixelDifference& found : comparison.pixels) {
    if (!found.rms_k) {
      pixels.rows.push_back({plain(found.what), missing(found.reason), missing(""), missing(""), missing("")});
      continue;
    }
    pixels.rows.push_back({plain(found.what), plain(significant(*found.mean_k, 3)), plain(significant(*found.rms_k, 3)),
                           plain(significant(*found.largest_k, 3)),
                           plain(fmt::format("{}, {}", found.largest_at.y, found.largest_at.x))});
  }
  if (!pixels.rows.empty()) section.blocks.emplace_back(std::move(pixels));
  Table keys{.caption = "Keys with different values", .header = {"Key", "A", "B"}, .rows = {}};
  for (const KeyDifference& key : comparison.keys) keys.rows.push_back({plain(key.key), plain(key.a), plain(key.b)});
  if (!keys.rows.empty()) section.blocks.emplace_back(std::move(keys));
  if (!comparison.notes.empty()) section.blocks.emplace_back(list_of(comparison.notes));
  return section;
}

Section models_record(const LoadedPlan& plan, const ModelComparison& comparison) {
  ValueTable values{.caption = "Origin of the numbers", .values = {}};
  values.values = {{"Program", plain("todbench " + std::string(build_info().version) + " (" +
                                     std::string(build_info().commit) + ")")},
                   {"Plan", plain(plan.plan().name)},
                   {"Seed", plain(std::to_string(plan.plan().seed))}};
  for (const auto& [side, model, result] :
       {std::tuple("A", &comparison.a, &comparison.result_a), std::tuple("B", &comparison.b, &comparison.result_b)}) {
    values.values.push_back({side, plain(fmt::format("{} {}{}", to_string(model->kind), model->name,
                                                     model->sha256.empty() ? "" : ", SHA-256 " + model->sha256))});
    for (const auto& record : model->provenance) values.values.push_back({side, plain(record)});
    values.values.push_back({side, plain(fmt::format("{} trials", result->trials.size()))});
    if (result->error) values.values.push_back({side, badge(result->error->message, Mood::bad)});
  }
  return {"Record", {std::move(values)}};
}

}  // namespace

Document model_comparison_page(const LoadedPlan& plan, const ModelComparison& comparison) {
  Document document{.title = "Models " + comparison.a.name + " and " + comparison.b.name,
                    .heading = "Comparison of two models",
                    .subtitle = fmt::format("A: {}, B: {}", comparison.a.name, comparison.b.name),
                    .page_label = plan.plan().name,
                    .opening = {},
                    .sections = {}};
  document.opening.emplace_back(Paragraph{plain(
      "Both models were tested with the same plates, contrasts, sub-pixel phases and random numbers. Every effect was "
      "simulated. The models are different at a contrast if the paired interval of the ratio excludes 1.")});
  document.sections = {acuity_comparison(comparison)};
  if (!comparison.transfer.empty()) document.sections.push_back(transfer_section(comparison));
  document.sections.push_back(differences_section(comparison));
  document.sections.push_back(models_record(plan, comparison));
  return document;
}

}  // namespace todbench
