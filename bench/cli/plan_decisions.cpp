// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/plan_decisions.h"

#include <fmt/format.h>
#include "tod/presentation/largest_contrast.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace todbench {
namespace {

/// Cameras of the printed tables, in percent above the limit.
constexpr std::array shown_cameras{-10, -5, -2, 0, 2, 5, 10};

std::string percent_text(double probability) {
  return fmt::format("{:.0f} %", 100 * probability);
}

const DecisionChances* chances_at(const DecisionDesign& design, int over_percent) {
  for (const CameraChance& camera : design.cameras) {
    if (std::lround(camera.over_limit_percent) == over_percent) return &camera.chances;
  }
  return nullptr;
}

/// Meaning of bench times, if the target of the plan takes no time.
std::string laboratory_text(TargetKind target) {
  return target == TargetKind::scene
             ? "bench times are those of a laboratory with the change times of the plan; the simulated target takes no "
               "time"
             : "";
}

bool varies_contrast_frames(const DecisionForecast& forecast) {
  return std::ranges::any_of(forecast.designs, [&](const DecisionDesign& design) {
    return design.contrast_frames != forecast.designs.front().contrast_frames;
  });
}

void print_designs(const Console& console, const DecisionForecast& forecast) {
  const bool ramp = std::ranges::any_of(forecast.designs, [](const auto& one) { return one.ramp_k_per_s.has_value(); });
  const bool adaptive =
      std::ranges::any_of(forecast.designs, [](const auto& one) { return one.asked_percent.has_value(); });
  TableRow header{"frames",
                  ramp       ? "ramp [K/s]"
                  : adaptive ? "half-width asked [%]"
                             : "phases",
                  "bench time [s]", "expected trials [%]", "with budget [%]"};
  const bool contrast_frames = varies_contrast_frames(forecast);
  if (contrast_frames) header.insert(header.begin() + 2, "frames of the contrast");
  for (const int over : shown_cameras) header.push_back(fmt::format("{:+d} %", over));
  const bool fleet =
      std::ranges::any_of(forecast.designs, [](const auto& design) { return design.consumer_risk.has_value(); });
  if (fleet) header.insert(header.end(), {"bad accepted", "good not accepted"});
  header.emplace_back("");
  std::vector<TableRow> rows;
  for (const DecisionDesign& design : forecast.designs) {
    TableRow row{fmt::format("{}", fmt::join(design.frames, ", ")),
                 design.ramp_k_per_s    ? fmt::format("{:.3g}", *design.ramp_k_per_s)
                 : design.asked_percent ? fmt::format("{:g}", *design.asked_percent)
                                        : std::to_string(design.phases),
                 fixed(design.bench_s, 0), fixed(design.half_width_percent, 2), fixed(design.deciding_percent, 2)};
    if (contrast_frames) row.insert(row.begin() + 2, std::to_string(design.contrast_frames));
    for (const int over : shown_cameras) {
      const DecisionChances* chances = chances_at(design, over);
      row.push_back(chances != nullptr ? percent_text(1 - chances->inconclusive) : "");
    }
    if (fleet) {
      row.push_back(design.consumer_risk ? fmt::format("{:.2g} %", 100 * *design.consumer_risk) : "");
      row.push_back(design.producer_risk ? fmt::format("{:.2g} %", 100 * *design.producer_risk) : "");
    }
    row.emplace_back(design.planned ? "planned" : "");
    rows.push_back(std::move(row));
  }
  console.text(
      "expected 95 % half-widths, and probability of a decision by distance of the camera from the limit (the table "
      "above has larger half-widths, which 19 of 20 runs do not exceed):");
  console.table(header, rows);
}

void print_planned(const Console& console, const DecisionDesign& design) {
  std::vector<TableRow> rows;
  for (const int over : shown_cameras) {
    const DecisionChances* chances = chances_at(design, over);
    if (chances == nullptr) continue;
    rows.push_back({fmt::format("{:+d} %", over), percent_text(chances->pass), percent_text(chances->fail),
                    percent_text(chances->inconclusive)});
  }
  console.text("decisions of the planned design:");
  console.table({"camera", "pass", "fail", "inconclusive"}, rows);
}

Json cameras_json(const std::vector<CameraChance>& cameras) {
  Json json = Json::array();
  for (const CameraChance& camera : cameras) {
    json.push_back({{"over_limit_percent", camera.over_limit_percent},
                    {"p_pass", json_number(camera.chances.pass)},
                    {"p_fail", json_number(camera.chances.fail)},
                    {"p_inconclusive", json_number(camera.chances.inconclusive)}});
  }
  return json;
}

Json design_json(const DecisionDesign& design) {
  Json json{{"frames_per_presentation", design.frames.size() == 1 ? Json(design.frames[0]) : Json(design.frames)},
            {"phases", design.phases},
            {"bench_s", json_number(design.bench_s)},
            {"half_width_percent", json_number(design.half_width_percent)},
            {"deciding_half_width_percent", json_number(design.deciding_percent)},
            {"planned", design.planned},
            {"cameras", cameras_json(design.cameras)}};
  if (design.asked_percent) json["asked_half_width_percent"] = json_number(design.asked_percent);
  if (design.ramp_k_per_s) json["ramp_k_per_s"] = json_number(*design.ramp_k_per_s);
  if (design.consumer_risk) json["consumer_risk"] = json_number(design.consumer_risk);
  if (design.producer_risk) json["producer_risk"] = json_number(design.producer_risk);
  return json;
}

std::string mountings_text(const TargetPlan& target) {
  std::string text;
  for (std::size_t i = 0; i < target.plates.size(); ++i)
    text += (i == 0 ? "" : " + ") + std::to_string(mountings_of(target, i));
  return text;
}

TableRow design_row(std::string name, const PricedDesign& design, const std::vector<double>& contrasts_k) {
  TableRow row{std::move(name),
               fixed(design.bench_s, 0),
               fixed(design.changes_s, 0),
               mountings_text(design.plan.target),
               std::to_string(design.plan.target.phases),
               fmt::format("{}", fmt::join(design.plan.schedule.frames_per_presentation, ", ")),
               fixed(design.half_width_percent, 2)};
  for (const double delta_t_k : contrasts_k) {
    const auto contrast = std::ranges::find(design.contrasts, delta_t_k, &ContrastPrediction::delta_t_k);
    row.push_back(contrast == design.contrasts.end() ? "left out" : fixed(contrast->uncertainty_percent, 2));
  }
  return row;
}

Json priced_json(const PricedDesign& design) {
  const Plan& plan = design.plan;
  std::vector<std::size_t> mountings;
  for (std::size_t i = 0; i < plan.target.plates.size(); ++i) mountings.push_back(mountings_of(plan.target, i));
  Json contrasts = Json::array();
  for (const ContrastPrediction& contrast : design.contrasts) {
    contrasts.push_back({{"delta_t_k", json_number(contrast.delta_t_k)},
                         {"half_width_percent", json_number(contrast.uncertainty_percent)}});
  }
  return {{"bench_s", json_number(design.bench_s)},
          {"changes_s", json_number(design.changes_s)},
          {"half_width_percent", json_number(design.half_width_percent)},
          {"mountings_per_plate", mountings},
          {"phases", plan.target.phases},
          {"registration_frames", plan.measurement.registration_frames},
          {"frames_per_presentation", plan.schedule.frames_per_presentation},
          {"contrasts", std::move(contrasts)}};
}

}  // namespace

void print_decisions(const Console& console, const std::vector<DecisionForecast>& forecasts, TargetKind target) {
  if (forecasts.empty()) console.text("the plan has no limit on an acuity with an expected threshold");
  for (const DecisionForecast& forecast : forecasts) {
    console.text("");
    console.text("decision at " + in_words(forecast));
    console.text(fmt::format("a camera like the simulated one is {:.1f} % {} the limit",
                             std::abs(forecast.expected_over_limit_percent),
                             forecast.expected_over_limit_percent < 0 ? "below" : "above"));
    if (const std::string text = laboratory_text(target); !text.empty()) console.text(text);
    print_designs(console, forecast);
    const auto planned = std::ranges::find_if(forecast.designs, &DecisionDesign::planned);
    if (planned != forecast.designs.end()) print_planned(console, *planned);
  }
}

Json decisions_json(const std::vector<DecisionForecast>& forecasts) {
  Json json = Json::array();
  for (const DecisionForecast& forecast : forecasts) {
    Json rows = Json::array(), designs = Json::array();
    for (const FloorRow& row : forecast.rows)
      rows.push_back({{"name", row.name}, {"half_width_percent", json_number(row.half_width_percent)}});
    for (const DecisionDesign& design : forecast.designs) {
      designs.push_back(design_json(design));
      if (varies_contrast_frames(forecast)) designs.back()["contrast_frames"] = design.contrast_frames;
    }
    json.push_back({{"delta_t_k", json_number(forecast.delta_t_k)},
                    {"least_acuity_per_mrad", json_number(forecast.least_acuity_per_mrad)},
                    {"expected_over_limit_percent", json_number(forecast.expected_over_limit_percent)},
                    {"budget_half_width_percent", json_number(forecast.floor_percent)},
                    {"smallest_half_width_percent",
                     forecast.rows.empty() ? Json(nullptr) : json_number(forecast.smallest_half_width_percent)},
                    {"enough_bench_s", json_number(forecast.enough_bench_s)},
                    {"rows", std::move(rows)},
                    {"designs", std::move(designs)}});
  }
  return json;
}

void print_design(const Console& console, const BestDesign& found) {
  TableRow header{"design", "bench time [s]", "changes [s]", "mountings", "phases", "frames", "95 % half-width [%]"};
  std::vector<double> contrasts_k;
  for (const ContrastPrediction& contrast : found.as_planned.contrasts) {
    contrasts_k.push_back(contrast.delta_t_k);
    header.push_back("at " + fixed(contrast.delta_t_k, 2) + " K");
  }
  console.table(header, {design_row("as planned", found.as_planned, contrasts_k),
                         design_row("least time", found.best, contrasts_k)});
  if (const std::string text = laboratory_text(found.best.plan.target.kind); !text.empty()) console.text(text);
  for (const std::string& sentence : in_words(found)) console.text(sentence);
}

Json best_design_json(const BestDesign& found) {
  Json json{{"bench_s", json_number(found.best.bench_s)},
            {"least_bench_s", json_number(found.least_s)},
            {"set_ups", found.set_ups},
            {"unpaired_share", json_number(found.unpaired_share)},
            {"dropped_contrasts_k", found.dropped_contrasts_k},
            {"optimised", priced_json(found.best)},
            {"as_planned", priced_json(found.as_planned)}};
  if (found.ramp) {
    Json& ramp = json["ramp"] = priced_json(found.ramp->design);
    ramp["ramp_k_per_s"] = json_number(found.ramp->design.plan.schedule.ramp_k_per_s);
    ramp["max_contrast_lag_s"] = json_number(found.ramp->lag_s);
    ramp["lag_is_stated"] = found.ramp->lag_is_stated;
    ramp["meets_request"] = found.ramp->meets;
  }
  return json;
}

std::string design_toml(const BestDesign& found) {
  return "# Design of `todbench plan --optimise`: " + times_in_words(found) + ".\n" + to_toml(found.best.plan);
}

Result<std::optional<ViewingProposal>> viewing_of(const std::vector<double>& delta_t_k, const ExperimentInputs& inputs,
                                                  std::stop_token stop) {
  if (!inputs.observer.eye || !inputs.observer.display || delta_t_k.empty()) return std::nullopt;
  const double largest = std::abs(largest_contrast_k(delta_t_k));
  auto found = propose_viewing(inputs.sensor, inputs.effects, inputs.observer, largest, std::move(stop));
  if (found) return *found;
  if (found.error().code == ErrorCode::interrupted) return tl::unexpected(found.error());
  return std::nullopt;
}

Json viewing_json(const ViewingProposal& viewing) {
  return {{"stated_arcmin", json_number(viewing.stated_arcmin)},
          {"stated_cost_percent", json_number(viewing.stated_cost_percent)},
          {"least_arcmin", json_number(viewing.least_arcmin)},
          {"zoom", json_number(viewing.zoom)},
          {"viewing_distance_m", json_number(viewing.viewing_distance_m)}};
}

}  // namespace todbench
