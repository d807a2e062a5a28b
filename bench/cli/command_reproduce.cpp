// SPDX-License-Identifier: GPL-3.0-or-later
// todbench reproduce
#include <cmath>
#include <memory>

#include "bench/cli/commands.h"
#include "bench/cli/scene_files.h"
#include "bench/judgement/verdict.h"
#include "bench/picture_files/encoded_picture.h"
#include "bench/report/picture_page.h"
#include "bench/studies/eo_vista.h"
#include "bench/studies/eo_vista_craft.h"
#include "bench/text/files.h"
#include "bench/text/folders.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

struct ReproduceArguments {
  std::string experiment;
  std::string out = "reproduction-eo-vista";
  std::string accuracy = "normal";
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
    const auto png = png_of(grey_picture(picture.kelvin, picture.grey_low_k, picture.grey_high_k, 480));
    if (!png) return tl::unexpected(png.error());
    if (auto done = write_file_atomically(folder / (picture.name + ".png"), *png); !done)
      return tl::unexpected(done.error());
    entries.push_back({picture.title, picture.caption, *png});
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
  const std::filesystem::path folder = arguments.out;
  std::error_code error;
  if (std::filesystem::exists(folder, error) && !std::filesystem::is_directory(folder, error))
    return fail(ErrorCode::invalid_input, folder.string() + ": is not a folder");
  if (auto made = make_folder(folder); !made) return tl::unexpected(made.error());
  if (!arguments.overwrite && !std::filesystem::is_empty(folder, error))
    return fail(ErrorCode::invalid_input,
                folder.string() + ": is not empty (--force overwrites the reproduction in it)");
  return folder;
}

int run_reproduce(Console& console, const ReproduceArguments& arguments, const Program& program) {
  if (arguments.experiment != "eo-vista") {
    return report_error(console,
                        {ErrorCode::invalid_input,
                         "reproduce: unknown experiment '" + one_line(arguments.experiment) + "', expected eo-vista"});
  }
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

}  // namespace

void add_reproduce_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand(
      "reproduce", "repeats a published experiment and writes a page that compares published and reproduced values");
  auto a = std::make_shared<ReproduceArguments>();
  command->add_option("EXPERIMENT", a->experiment, "experiment: eo-vista")->required();
  command->add_option("--out", a->out, "folder for the page")->capture_default_str();
  command->add_option("--accuracy", a->accuracy, "numerical accuracy: draft, normal or reference")
      ->capture_default_str();
  command->add_flag("--force", a->overwrite, "overwrites the page in an existing folder");
  finish_command(*command, program, [a, &program](Console& console) { return run_reproduce(console, *a, program); });
}

}  // namespace todbench
