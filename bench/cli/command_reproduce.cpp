// SPDX-License-Identifier: GPL-3.0-or-later
// todbench reproduce
#include <cmath>
#include <memory>

#include "acquisition/base/try.h"
#include "bench/cli/commands.h"
#include "bench/cli/result_folder.h"
#include "bench/judgement/verdict.h"
#include "bench/picture_files/encoded_picture.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/resources.h"
#include "bench/report/html.h"
#include "bench/report/picture_page.h"
#include "bench/studies/eo_vista.h"
#include "bench/studies/eo_vista_craft.h"
#include "bench/studies/vision.h"
#include "bench/text/files.h"
#include "bench/text/folders.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

struct ReproduceArguments {
  std::string experiment;
  std::string out{};  ///< empty: reproduction-EXPERIMENT
  std::string accuracy = "normal";
  std::string observer = "hvs-2";
  std::string figures{};  ///< empty: the quoted figures alone
  bool overwrite = false;
};

Json json_of(const Reproduction& r) {
  Json figures = Json::array(), thresholds = Json::array(), ranges = Json::array();
  for (const auto& f : r.figures) {
    figures.push_back({{"quantity", f.quantity},
                       {"unit", f.unit},
                       {"published", f.published.empty() ? Json() : Json(f.published)},
                       {"published_value", json_number(f.published_value)},
                       {"value", json_number(f.value)},
                       {"ci95", json_interval(f.ci95)},
                       {"graded_value", json_number(f.graded_value)},
                       {"graded_ci95", json_interval(f.graded_ci95)},
                       {"remark", f.remark}});
  }
  for (const auto& t : r.thresholds) {
    thresholds.push_back({{"sensor", t.sensor},
                          {"observer", t.observer},
                          {"delta_t_k", t.delta_t_k},
                          {"acuity_per_mrad", json_number(t.acuity_per_mrad)},
                          {"acuity_ci95_per_mrad", json_interval(t.ci95)},
                          {"method", t.method},
                          {"graded_acuity_per_mrad", json_number(t.graded_acuity_per_mrad)},
                          {"graded_acuity_ci95_per_mrad", json_interval(t.graded_ci95)},
                          {"graded_method", t.graded_method.empty() ? Json() : Json(t.graded_method)}});
  }
  for (const auto& range : r.ranges) {
    ranges.push_back({{"sensor", range.sensor},
                      {"observer", range.observer},
                      {"r75_m", json_number(range.prediction.r75_m)},
                      {"r75_ci95_m", json_interval(range.prediction.r75_ci95_m)},
                      {"reason", range.prediction.reason.empty() ? Json() : Json(range.prediction.reason)}});
  }
  Json settings = Json::object();
  for (const auto& [name, value] : r.settings) settings[name] = value;
  return {{"experiment", "eo-vista"}, {"source", r.source},           {"figures", figures},  {"thresholds", thresholds},
          {"ranges", ranges},         {"assumptions", r.assumptions}, {"settings", settings}};
}

/// Writes the pictures of Figure 12 to files; returns their page entries.
Result<std::vector<PagePicture>> write_craft(const std::filesystem::path& folder,
                                             const std::vector<CraftPicture>& craft) {
  std::vector<PagePicture> entries;
  for (const auto& picture : craft) {
    TODBENCH_TRY(const auto png, png_of(grey_picture(picture.kelvin, picture.grey_low_k, picture.grey_high_k, 480)));
    TODBENCH_TRY_VOID(write_file_atomically(folder / (picture.name + ".png"), png));
    entries.push_back({picture.title, picture.caption, png});
  }
  return entries;
}

Json craft_json(const std::vector<CraftPicture>& craft) {
  Json pictures = Json::array();
  for (const auto& picture : craft) {
    pictures.push_back({{"title", picture.title},
                        {"png", picture.name + ".png"},
                        {"range_m", picture.range_m > 0 ? Json(picture.range_m) : Json()},
                        {"black_k", json_number(picture.grey_low_k)},
                        {"white_k", json_number(picture.grey_high_k)}});
  }
  return pictures;
}

/// Returns a new folder, an empty one, or one that may be overwritten.
Result<std::filesystem::path> folder_for(const ReproduceArguments& arguments) {
  const std::filesystem::path folder = arguments.out.empty() ? "reproduction-" + arguments.experiment : arguments.out;
  std::error_code error;
  if (std::filesystem::exists(folder, error) && !std::filesystem::is_directory(folder, error))
    return fail(ErrorCode::invalid_input, folder.string() + ": is not a folder");
  TODBENCH_TRY_VOID(make_folder(folder));
  if (!arguments.overwrite && !std::filesystem::is_empty(folder, error))
    return fail(ErrorCode::invalid_input,
                folder.string() + ": is not empty (--force overwrites the reproduction in it)");
  return folder;
}

int run_eo_vista(Console& console, const ReproduceArguments& arguments, const Program& program) {
  EoVistaOptions options;
  const auto accuracy = Accuracy::named(arguments.accuracy);
  if (!accuracy) return report_error(console, accuracy.error());
  options.accuracy = *accuracy;
  options.seed = program.common.seed;
  options.stop = program.stop->token();
  const auto folder = folder_for(arguments);
  if (!folder) return report_error(console, folder.error());
  console.phase("simulating sensors, cameras and observers");
  const auto found = reproduce_eo_vista(options);
  console.end_progress();
  if (!found) return report_error(console, found.error());
  const auto craft = eo_vista_craft(options.accuracy, options.seed);
  if (!craft) return report_error(console, craft.error());
  const auto pictures = write_craft(*folder, *craft);
  if (!pictures) return report_error(console, pictures.error());
  Json json = json_of(*found);
  json["figure_12"] = craft_json(*craft);
  const auto page = *folder / "reproduction.html";
  const std::string html = page_with_pictures(reproduction_document(*found), "Pictures of a craft (Figure 12)",
                                              *pictures, PicturePlace::last);
  if (auto written = write_file_atomically(page, html); !written) return report_error(console, written.error());
  if (auto written = write_file_atomically(*folder / "reproduction.json", to_page(json)); !written)
    return report_error(console, written.error());
  if (console.json()) {
    console.object(json);
    return 0;
  }
  std::vector<TableRow> rows;
  for (const auto& f : found->figures) {
    const int decimals = f.kind != FigureKind::amount || f.unit == "m" ? 0 : 1;
    rows.push_back(
        {f.quantity, f.published.empty() ? "–" : f.published,
         fixed(f.value && decimals == 0 ? std::optional(std::round(*f.value) + 0.0) : f.value, decimals) + " " + f.unit,
         range(f.ci95, decimals)});
  }
  console.table({"quantity", "published", "reproduced", "95 %"}, rows);
  console.text("page: " + page.string());
  return 0;
}

Json vision_json(const VisionComparison& comparison) {
  Json kinds = Json::array(), failures = Json::array(), outside = Json::array(), settings = Json::object();
  for (const VisionKind& kind : comparison.kinds) {
    Json points = Json::array();
    for (const VisionPoint& point : kind.points) {
      points.push_back({{"condition", point.condition},
                        {"people", json_number(point.people)},
                        {"model", json_number(point.model)},
                        {"error", json_number(error_of(kind, point))}});
    }
    const VisionErrors errors = errors_of(kind);
    kinds.push_back({{"name", kind.name},
                     {"title", kind.title},
                     {"quantity", kind.quantity},
                     {"error_unit", to_string(kind.error)},
                     {"mean_error", json_number(errors.mean)},
                     {"rms_error", json_number(errors.rms)},
                     {"largest_error", json_number(errors.largest)},
                     {"role", to_string(kind.role)},
                     {"failure", kind.failure.empty() ? Json() : Json(kind.failure)},
                     {"source", kind.source},
                     {"remark", kind.remark},
                     {"points", points}});
    if (!kind.failure.empty()) failures.push_back(kind.name);
  }
  for (const VisionOutside& figure : comparison.not_comparable) {
    outside.push_back(
        {{"quantity", figure.quantity}, {"published", figure.published}, {"value", Json()}, {"reason", figure.reason}});
  }
  for (const auto& [name, value] : comparison.settings) settings[name] = value;
  return {{"experiment", "vision"},
          {"observer", comparison.observer},
          {"statement", comparison.statement},
          {"failures", failures},
          {"kinds", kinds},
          {"not_comparable", outside},
          {"settings", settings}};
}

void print_vision(const Console& console, const VisionComparison& comparison, const std::filesystem::path& page) {
  console.text(comparison.statement);
  std::vector<TableRow> rows;
  for (const VisionKind& kind : comparison.kinds) {
    const VisionErrors errors = errors_of(kind);
    const int decimals = kind.error == VisionError::log10 ? 3 : 1;
    rows.push_back({kind.title, std::to_string(kind.points.size()), std::string(to_string(kind.error)),
                    fixed(errors.mean, decimals), fixed(errors.rms, decimals), fixed(errors.largest, decimals),
                    kind.failure.empty() ? std::string(to_string(kind.role)) : "fails: " + kind.failure});
  }
  console.table({"figures of people", "number", "error in", "mean", "rms", "largest", ""}, rows);
  for (const VisionOutside& figure : comparison.not_comparable)
    console.text(figure.quantity + ", " + figure.published + ": " + figure.reason);
  console.text("page: " + page.string());
}

int run_vision(Console& console, const ReproduceArguments& arguments, const Program& program) {
  const auto accuracy = Accuracy::named(arguments.accuracy);
  if (!accuracy) return report_error(console, accuracy.error());
  const auto resource = find_resource(ResourceKind::observer, arguments.observer);
  if (!resource) return report_error(console, resource.error());
  const auto observer = parse_observer(*resource);
  if (!observer) return report_error(console, observer.error());
  if (const auto eye = require_eye(*observer, arguments.observer); !eye) return report_error(console, eye.error());
  const auto folder = folder_for(arguments);
  if (!folder) return report_error(console, folder.error());
  console.phase("comparing the observer with figures of people");
  const auto found = vision_comparison(*observer, {.accuracy = *accuracy,
                                                   .seed = program.common.seed,
                                                   .figures = arguments.figures,
                                                   .stop = program.stop->token()});
  console.end_progress();
  if (!found) return report_error(console, found.error());
  const Json json = vision_json(*found);
  const auto page = *folder / "vision.html";
  if (auto written = write_file_atomically(page, render_html(vision_document(*found))); !written)
    return report_error(console, written.error());
  if (auto written = write_file_atomically(*folder / "vision.json", to_page(json)); !written)
    return report_error(console, written.error());
  if (console.json()) {
    console.object(json);
  } else {
    print_vision(console, *found, page);
  }
  return 0;
}

int run_reproduce(Console& console, const ReproduceArguments& arguments, const Program& program) {
  if (arguments.experiment == "eo-vista" && (!arguments.figures.empty() || arguments.observer != "hvs-2")) {
    return report_error(console, {ErrorCode::invalid_input,
                                  "reproduce eo-vista: --figures and --observer belong to 'reproduce vision'"});
  }
  if (arguments.experiment == "eo-vista") return run_eo_vista(console, arguments, program);
  if (arguments.experiment == "vision") return run_vision(console, arguments, program);
  return report_error(
      console, {ErrorCode::invalid_input,
                "reproduce: unknown experiment '" + one_line(arguments.experiment) + "', expected eo-vista or vision"});
}

}  // namespace

void add_reproduce_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand(
      "reproduce",
      "repeats a published experiment, or compares an observer with published figures of people, and writes a page");
  auto a = std::make_shared<ReproduceArguments>();
  command->add_option("EXPERIMENT", a->experiment, "experiment: eo-vista or vision")->required();
  command->add_option("--out", a->out, "folder for the page (default: reproduction-EXPERIMENT)");
  command->add_option("--accuracy", a->accuracy, "numerical accuracy: draft, normal or reference")
      ->capture_default_str();
  command->add_option("--figures", a->figures,
                      "CSV file of people's figures that 'vision' compares, too: contrast sensitivity or acuity");
  command->add_option("--observer", a->observer, "observer with an eye that 'vision' compares: name or file")
      ->capture_default_str();
  command->add_flag("--force", a->overwrite, "overwrites the page in an existing folder");
  finish_command(*command, program, [a, &program](Console& console) { return run_reproduce(console, *a, program); });
}

}  // namespace todbench
