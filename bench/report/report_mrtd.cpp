// SPDX-License-Identifier: GPL-3.0-or-later
// MRTD and MDTD of the model and of people, for a reader of STANAG 4349.
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bench/report/measure_figures.h"
#include "bench/report/number_format.h"
#include "bench/report/report_pieces.h"

namespace todbench {
namespace {

/// Point of the model at the place of people; null if it has none.
const MrtdPoint* model_point(const MrtdMeasure& model, const BarsThreshold& of) {
  const std::vector<MrtdPoint>& points = of.size_px > 0 ? model.spots : model.bars;
  const auto found = std::ranges::find(points, of.place, &MrtdPoint::place);
  return found == points.end() ? nullptr : &*found;
}

std::string mrtd_place_words(const BarsThreshold& of, double pitch_mrad) {
  return of.size_px > 0 ? "spot of " + significant(of.size_px * pitch_mrad, 3) + " mrad"
                        : significant(of.frequency_per_pitch / pitch_mrad, 3) + " cycles/mrad along " +
                              std::string(to_string(of.axis));
}

/// One row for each sitting, then their mean, then the model.
void add_mrtd_place(Table& rows, const BarsMean& mean, const std::vector<JudgedBars>& people,
                    const MrtdMeasure& model) {
  const std::string place = mrtd_place_words(mean.of, model.pitch_mrad);
  for (std::size_t i = 0; i < people.size(); ++i) {
    const auto own = std::ranges::find(people[i].thresholds, mean.of.place, &BarsThreshold::place);
    if (own == people[i].thresholds.end()) continue;
    const ForcedChoiceThreshold& found = own->found;
    const std::string& code = people[i].person;
    rows.rows.push_back({plain(place), plain(code.empty() ? "person " + std::to_string(i + 1) : code),
                         plain(std::to_string(found.answers)), contrast_cell(found.positive_k),
                         contrast_cell(found.negative_k),
                         interval_or_missing(found.half_k, found.half_k ? found.ci95 : Interval{}, found.reason)});
  }
  const bool exists = mean.over.people > 0;
  Interval interval;
  if (mean.over.ci95) interval = {mean.over.ci95->first, mean.over.ci95->second};
  const std::string none = std::to_string(mean.without) + " without a threshold";
  rows.rows.push_back({plain(place),
                       plain(exists ? "mean of " + std::to_string(mean.over.people) + " people" : "mean of people"),
                       plain(std::to_string(mean.answers)), plain("–"), plain("–"),
                       interval_or_missing(exists ? std::optional(mean.over.mean) : std::nullopt, interval, none)});
  if (const MrtdPoint* point = model_point(model, mean.of)) {
    rows.rows.push_back(
        {plain(place), plain("model " + model.observer), plain("–"), contrast_cell(point->positive_k),
         contrast_cell(point->negative_k),
         interval_or_missing(point->threshold_k, point->threshold_k ? point->ci95 : Interval{}, point->reason)});
  }
}

std::optional<Table> mrtd_people_table(const ReportData& data, const MrtdMeasure& model) {
  if (data.bars_people.empty()) return {};
  Table rows;
  rows.caption =
      "MRTD and MDTD of people, from the frames that the model judged. Mean: geometric, every person once; its "
      "interval contains the scatter between people and that of the set-ups, which are common to them";
  rows.header = {"Target", "Observer", "Answers", "ΔT positive (K)", "ΔT negative (K)", "Half difference (K), 95 %"};
  const std::vector<JudgedBars> people = judged_bars(data.bars_people);
  for (const BarsMean& mean : bars_means(people)) add_mrtd_place(rows, mean, people, model);
  return rows;
}

/// People who judged, every code once.
int number_of_people(const std::vector<BarsSitting>& sittings) {
  std::set<std::string> codes;
  int without_code = 0;
  for (const BarsSitting& sitting : sittings) {
    if (sitting.person.code.empty()) ++without_code;
    codes.insert(sitting.person.code);
  }
  codes.erase("");
  return static_cast<int>(codes.size()) + without_code;
}

std::string mrtd_display_words(const ReportData& data) {
  if (!data.display) return {};
  const ViewedDisplay& display = *data.display;
  return "model: white " + stated(display.luminance_white_cd_m2) + " cd/m², black " +
         stated(display.luminance_black_cd_m2) + " cd/m², " + stated(display.viewing_distance_m) +
         " m from the eye, zoom " + stated(display.zoom);
}

std::string people_screens(const std::vector<BarsSitting>& sittings) {
  std::string words;
  for (const BarsSitting& sitting : sittings) {
    const PersonFacts& person = sitting.person;
    if (person.screen.empty() && !person.distance_m) continue;
    words += (words.empty() ? "" : "; ") + person.code + ": " + (person.screen.empty() ? "screen" : person.screen);
    if (person.distance_m) words += ", " + stated(*person.distance_m) + " m from the eye";
    words += ", " + std::to_string(sitting.magnification) + " screen pixels per pixel";
  }
  return words;
}

ValueTable mrtd_conditions_table(const ReportData& data, const MrtdMeasure& mrtd) {
  const auto text = [](const std::string& words) { return words.empty() ? missing("not stated") : plain(words); };
  ValueTable table{"Conditions of MRTD and MDTD", {}};
  table.values.push_back({"Target", plain("plate " + mrtd.plate +
                                          ": four bars 7 : 1 beside five bars in a square of the "
                                          "same size; square spots beside an empty part of the plate")});
  table.values.push_back({data.collimated ? "Focal length of the collimator" : "Distance to the target",
                          text(data.distance_m > 0 ? stated(data.distance_m) + " m" : std::string())});
  table.values.push_back({"Background temperature", plain("that of the plate; the air has " +
                                                          stated(data.air_temperature_c) + " °C by the plan")});
  table.values.push_back({"IFOV of a pixel", plain(significant(mrtd.pitch_mrad, 4) + " mrad")});
  table.values.push_back(
      {"Set-ups", plain(std::to_string(mrtd.set_ups) + " sampling phases in " + std::to_string(mrtd.mountings) +
                        " mountings, " + std::to_string(mrtd.frames) + " frames at each contrast")});
  const int people = number_of_people(data.bars_people);
  table.values.push_back({"Observers", plain("model " + mrtd.observer +
                                             (people > 0 ? " and " + std::to_string(people) + " people" : ""))});
  table.values.push_back({"Display of the model", text(mrtd_display_words(data))});
  if (people > 0) table.values.push_back({"Screens of the people", text(people_screens(data.bars_people))});
  return table;
}

/// Number of groups below the cut, and the source of their frequencies.
std::string frequency_words(const MrtdMeasure& mrtd) {
  const auto below_cut = std::ranges::count_if(
      mrtd.bars, [](const MrtdPoint& point) { return point.frequency_per_pitch <= mrtd_cut_per_pitch; });
  return std::to_string(below_cut) +
         " groups of bars up to half a cycle per pixel; the frequencies are those of the plate "
         "at the measured scale";
}

Table stanag_table(const ReportData& data, const MrtdMeasure& mrtd) {
  Table table{"STANAG 4349 as known from secondary sources, and this report", {"Demand", "This report", "State"}, {}};
  const auto row = [&](const char* demand, const std::string& here, const char* state) {
    table.rows.push_back({plain(demand), plain(here), plain(state)});
  };
  const auto has = [&](EdgeAxis axis) {
    return std::ranges::any_of(mrtd.bars,
                               [&](const MrtdPoint& point) { return point.axis == axis && point.threshold_k; });
  };
  const bool both = has(EdgeAxis::x) && has(EdgeAxis::y);
  const int people = number_of_people(data.bars_people);
  row("Four bars, length to width 7 : 1", "plate " + mrtd.plate, "as demanded");
  row("Spatial frequencies within 5 %", frequency_words(mrtd),
      "not verified: the bars of the plate are not measured here");
  row("Both axes", both ? "x and y" : "one axis has no threshold", both ? "as demanded" : "not met");
  row("Both polarities, half difference", "thresholds of hot and cold bars and their half difference", "as demanded");
  row("Several trained observers, mean", people == 0 ? "the model alone" : std::to_string(people) + " people",
      people == 0  ? "not met"
      : people < 2 ? "not met: one person"
                   : "training not verified");
  row("The observer resolves all four bars",
      "the observer tells four bars from five, 75 % correct (Bijl and Valeton 1999): free of response bias",
      "another criterion");
  row("The observer sets gain and level, and moves freely",
      "recorded windows at a fixed grey scale; eye and head are free before the screen", "not met");
  row("Background temperature and distance stated", "in the conditions, from the plan", "not verified: not measured");
  return table;
}

}  // namespace

std::optional<Section> mrtd_section(const ReportData& data) {
  if (!data.measures) return {};
  const auto& main = data.measures->main;
  const auto& twin = data.measures->twin;
  const bool camera = data.camera.has_value();
  const MeasureLines* stated_side = main && main->mrtd ? &*main : twin && twin->mrtd ? &*twin : nullptr;
  if (stated_side == nullptr) return {};
  const MrtdMeasure& mrtd = *stated_side->mrtd;
  Section section{"MRTD and MDTD, for readers of STANAG 4349 and ASTM E1311", {}};
  section.blocks.emplace_back(note(
      plain("The texts of both standards were not available. This section has the form that their readers expect; it "
            "does not declare compliance.")));
  section.blocks.emplace_back(mrtd_conditions_table(data, mrtd));
  for (const auto& [side, who] :
       {std::pair(&main, camera ? "camera" : "simulated sensor"), std::pair(&twin, "simulated twin")}) {
    if (!*side || !(*side)->mrtd) continue;
    for (Table& table : mrtd_tables(*(*side)->mrtd, who)) section.blocks.emplace_back(std::move(table));
  }
  if (auto people = mrtd_people_table(data, mrtd)) section.blocks.emplace_back(*std::move(people));
  if (auto figures = mrtd_figures(*data.measures, camera)) section.blocks.emplace_back(*std::move(figures));
  section.blocks.emplace_back(stanag_table(data, mrtd));
  return section;
}

}  // namespace todbench
