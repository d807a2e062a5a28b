// SPDX-License-Identifier: GPL-3.0-or-later
// todbench compare-models
#include "bench/cli/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include "bench/cli/effect_decisions.h"
#include "bench/cli/result_folder.h"
#include "bench/enhance/decidable.h"
#include "bench/judgement/verdict.h"
#include "bench/model_comparison/model_comparison_page.h"
#include "bench/report/html.h"
#include "bench/session/fit_record.h"
#include "bench/text/files.h"
#include "bench/text/spread_text.h"
#include "bench/text/text.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

struct CompareModelsArguments {
  std::string a, b, plan = "demo", out = "models";
  bool overwrite = false;
  EffectDecisionOptions decisions;
};

Json model_json(const ComparedModel& model, const PackageResult& result) {
  return {{"name", model.name},
          {"reference", model.reference},
          {"sha256", model.sha256.empty() ? Json() : Json(model.sha256)},
          {"trials", result.trials.size()},
          {"error", result.error ? Json(result.error->message) : Json()}};
}

/// Adds acuity and interval of the result at a contrast, under "acuity_SIDE_per_mrad".
void add_acuity(Json& point, const std::string& side, const PackageResult& result, double set_delta_t_k) {
  point["acuity_" + side + "_per_mrad"] = nullptr;
  point["acuity_" + side + "_ci95_per_mrad"] = json_interval({});
  for (const TodPoint& found : result.curve.points) {
    if (!same_contrast(found.set_delta_t_k, set_delta_t_k)) continue;
    point["acuity_" + side + "_per_mrad"] = json_number(identified_acuity_per_mrad(found));
    point["acuity_" + side + "_ci95_per_mrad"] = json_interval(acuity_interval(found.fit.ci95));
    if (const auto spread = acuity_spread_per_mrad(found.s75_spread_mrad))
      point["acuity_" + side + "_spread_per_mrad"] = json_interval(*spread);
    point["adequacy_" + side] = adequacy_json(found.adequacy);
    const auto judged = judged_point(result, set_delta_t_k);
    point["judged_gain_" + side] = judged ? json_number(judged->gain) : Json();
  }
}

Json comparison_of_models_json(const ModelComparison& comparison, const std::string& folder) {
  Json points = Json::array(), keys = Json::array(), pixels = Json::array(), transfer = Json::array();
  for (const PairedRatio& ratio : comparison.ratios) {
    Json point{{"set_delta_t_k", ratio.set_delta_t_k}};
    add_acuity(point, "a", comparison.result_a, ratio.set_delta_t_k);
    add_acuity(point, "b", comparison.result_b, ratio.set_delta_t_k);
    point["ratio"] = json_number(ratio.ratio);
    point["ratio_ci95"] = json_interval(ratio.ci95);
    add_spread(point, "ratio_spread", ratio.spread);
    point["withheld"] = ratio.withheld.empty() ? Json() : Json(ratio.withheld);
    const auto apart = parts(ratio);
    point["parts"] = apart ? Json(*apart) : Json();
    points.push_back(std::move(point));
  }
  for (const KeyDifference& key : comparison.keys) keys.push_back({{"key", key.key}, {"a", key.a}, {"b", key.b}});
  for (const PixelDifference& found : comparison.pixels) {
    pixels.push_back({{"picture", found.what},
                      {"mean_k", json_number(found.mean_k)},
                      {"rms_k", json_number(found.rms_k)},
                      {"largest_k", json_number(found.largest_k)},
                      {"row", found.rms_k ? Json(found.largest_at.y) : Json()},
                      {"column", found.rms_k ? Json(found.largest_at.x) : Json()},
                      {"reason", found.reason.empty() ? Json() : Json(found.reason)}});
  }
  for (const TransferPoint& point : comparison.transfer)
    transfer.push_back({{"frequency_per_mrad", point.frequency_per_mrad}, {"a", point.a}, {"b", point.b}});
  return {{"kind", to_string(comparison.a.kind)},
          {"a", model_json(comparison.a, comparison.result_a)},
          {"b", model_json(comparison.b, comparison.result_b)},
          {"points", points},
          {"transfer", transfer},
          {"parts_at_per_mrad", json_number(comparison.parts_at_per_mrad)},
          {"pixels", pixels},
          {"keys", keys},
          {"notes", comparison.notes},
          {"folder", folder}};
}

void say_models(Console& console, const ModelComparison& comparison) {
  std::vector<TableRow> rows;
  const auto acuity_at = [](const PackageResult& result, double set_delta_t_k) -> std::optional<double> {
    for (const TodPoint& point : result.curve.points) {
      if (same_contrast(point.set_delta_t_k, set_delta_t_k)) return identified_acuity_per_mrad(point);
    }
    return std::nullopt;
  };
  for (const PairedRatio& ratio : comparison.ratios) {
    const auto apart = parts(ratio);
    rows.push_back(
        {fmt::format("{:g}", ratio.set_delta_t_k), fixed(acuity_at(comparison.result_a, ratio.set_delta_t_k), 3),
         fixed(acuity_at(comparison.result_b, ratio.set_delta_t_k), 3), fixed(ratio.ratio, 3), range(ratio.ci95, 3),
         !apart   ? "-"
         : *apart ? "yes"
                  : "not shown"});
  }
  console.table({"set contrast (K)", "A (1/mrad)", "B (1/mrad)", "B / A", "95 %", "different"}, rows);
  for (const auto& [side, result] : {std::pair('A', &comparison.result_a), std::pair('B', &comparison.result_b)}) {
    for (const TodPoint& point : result->curve.points) {
      const auto spread = acuity_spread_per_mrad(point.s75_spread_mrad);
      if (!spread) continue;
      console.text(
          fmt::format("{}: {:g} K: {} 1/mrad over the open parameters of the observer (a range of the model, "
                      "not a confidence interval)",
                      side, point.set_delta_t_k, range(*spread, 3)));
    }
  }
  for (const PairedRatio& ratio : comparison.ratios) {
    if (!ratio.spread) continue;
    console.text(fmt::format("B / A: {:g} K: {} over the open parameters of the observer", ratio.set_delta_t_k,
                             range({ratio.spread->first, ratio.spread->second}, 3)));
  }
  if (comparison.parts_at_per_mrad)
    console.text(fmt::format("the MTFs of A and B differ by more than 0.01 from {:.3g} cycles/mrad upwards",
                             *comparison.parts_at_per_mrad));
  for (const auto& sentence : comparison.notes) console.note(sentence);
}

/// Effects of both models.
std::vector<DecidedEffects> effects_of(const LoadedPlan& loaded, const ComparedModel& a, const ComparedModel& b) {
  const auto of = [&](const ComparedModel& model) {
    const SensorSpec& sensor = model.kind == ModelKind::sensor ? model.sensor : loaded.sensor();
    const SimulationPlan& simulation = loaded.plan().simulation;
    return DecidedEffects{model.name, full_plan(sensor, simulation.skip, simulation.force, simulation.motion),
                          "every effect that is not neutral is simulated in both models, so that the difference "
                          "between the models comes from their descriptions alone"};
  };
  return {of(a), of(b)};
}

int run_compare_models(Console& console, const CompareModelsArguments& a, const Program& program) {
  auto first = read_compared_model(a.a);
  if (!first) return report_error(console, first.error());
  auto second = read_compared_model(a.b);
  if (!second) return report_error(console, second.error());
  auto plan = load_plan(a.plan);
  if (!plan) return report_error(console, plan.error());
  if (program.common.seed_given) plan->seed = program.common.seed;
  const auto loaded = LoadedPlan::load(*plan);
  if (!loaded) return report_error(console, loaded.error());
  const auto effects = effects_of(*loaded, *first, *second);
  if (a.decisions.dry_run) return dry_run(console, effects, a.decisions);
  const std::filesystem::path folder = a.out;
  const auto existing = a.overwrite ? ExistingResults::overwritten : ExistingResults::refused;
  if (auto made = make_result_folder(folder, existing); !made) return report_error(console, made.error());
  const EnhancementOptions options{
      .on_package = [&](const std::string& name) { console.phase("simulating with " + name); },
      .on_progress = [&](std::size_t done, std::size_t planned) { console.progress(done, planned); }};
  const auto found = compare_models(*loaded, *std::move(first), *std::move(second), options, program.stop->token());
  console.end_progress();
  if (!found) return report_error(console, found.error());
  const Json json = comparison_of_models_json(*found, folder.string());
  if (auto written = write_file_atomically(folder / "models.html", render_html(model_comparison_page(*loaded, *found)));
      !written)
    return report_error(console, written.error());
  if (auto written = write_file_atomically(folder / "models.json", to_page(json)); !written)
    return report_error(console, written.error());
  if (console.json()) console.object(json);
  say_models(console, *found);
  for (const DecidedEffects& one : effects) print_effects(console, one, a.decisions);
  console.text("page: " + (folder / "models.html").string());
  for (const PackageResult* result : {&found->result_a, &found->result_b}) {
    if (!result->error) continue;
    console.error(fmt::format("{}: {} (trials until then: {})", one_line(result->name), result->error->message,
                              result->trials.size()));
    return exit_code(result->error->code);
  }
  int code = 0;
  for (const PackageResult* result : {&found->result_a, &found->result_b}) {
    for (const TodPoint& point : result->curve.points) {
      const auto why = why_undecided(*result, point.set_delta_t_k);
      if (why.empty()) continue;
      console.text(fmt::format("not fit for a decision: {:g} K: {}", point.set_delta_t_k, why));
    }
    code = std::max(code, exit_code(*result));
  }
  return code;
}

}  // namespace

void add_compare_models_command(CLI::App& app, Program& program) {
  auto* command =
      app.add_subcommand("compare-models", "compares two sensors, observers or packages with the same scenes");
  auto a = std::make_shared<CompareModelsArguments>();
  command->add_option("A", a->a, "sensor, observer or package of stages: name or file; 'none' means no package")
      ->required();
  command->add_option("B", a->b, "sensor, observer or package of the same kind as A")->required();
  command->add_option("--plan", a->plan, "plan with scenes, contrasts and number of trials: name or file")
      ->capture_default_str();
  command->add_option("--out", a->out, "folder for the page and the numbers")->capture_default_str();
  command->add_flag("--force", a->overwrite, "overwrites the results in an existing folder");
  a->decisions.add_to(*command);
  finish_command(*command, program,
                 [a, &program](Console& console) { return run_compare_models(console, *a, program); });
}

}  // namespace todbench
