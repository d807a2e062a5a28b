// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/enhance/package_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/plan_options.h"
#include "bench/plan/strict_toml.h"
#include "bench/text/files.h"
#include "bench/text/text.h"
#include "bench/twin/module_chain.h"

namespace todbench {
namespace {

const std::vector<std::string> stage_kinds{"recursive", "sharpen", "median", "clahe",           "plateau",
                                           "module",    "kernel",  "agc",    "super-resolution"};

StagePlan read_stage(TomlReader& table, std::vector<ModulePlan>& modules) {
  StagePlan stage;
  const std::string kind = table.choice("kind", stage_kinds, std::nullopt);
  for (std::size_t i = 0; i < stage_kinds.size(); ++i) {
    if (stage_kinds[i] == kind) stage.kind = static_cast<StagePlan::Kind>(i);
  }
  switch (stage.kind) {
    case StagePlan::Kind::recursive:
      stage.share = table.number("share", NumberRange::between(0.01, 1), 0.5);
      break;
    case StagePlan::Kind::sharpen:
      stage.amount = table.number("amount", NumberRange::between(0, 10), 1);
      break;
    case StagePlan::Kind::median:
      stage.size = static_cast<int>(table.whole("size", 3, 5, 3));
      if (stage.size == 4) table.reject("size", "expected 3 or 5");
      break;
    case StagePlan::Kind::clahe:
      stage.clip_limit = table.number("clip_limit", NumberRange::between(0.1, 100), 2);
      stage.tiles = static_cast<int>(table.whole("tiles", 1, 16, 8));
      break;
    case StagePlan::Kind::plateau:
      stage.plateau_percent = table.number("plateau_percent", NumberRange::above_to(0, 100), 1);
      break;
    case StagePlan::Kind::module:
      modules.push_back(read_module(table));
      stage.module = stage_options(modules.back());
      break;
    case StagePlan::Kind::kernel: {
      const auto values = table.numbers("values", NumberRange::between(-1000, 1000), std::nullopt);
      if (values.size() == stage.kernel.size())
        std::copy(values.begin(), values.end(), stage.kernel.begin());
      else
        table.reject("values", "expected nine numbers, row by row");
      break;
    }
    case StagePlan::Kind::super_resolution: {
      SuperResolutionStageOptions& finer = stage.super_resolution;
      finer.factor = static_cast<int>(table.whole("factor", 2, 4, finer.factor));
      finer.frames = static_cast<int>(table.whole("frames", 4, 64, finer.factor * finer.factor));
      if (finer.frames < finer.factor * finer.factor)
        table.reject("frames", "must be at least the square of factor, the number of cells of a pixel");
      const std::vector<std::string> shifts{"measured", "scan"};
      if (table.choice("shifts", shifts, shifts.front()) == "scan") finer.shifts = FrameShifts::scan;
      break;
    }
    case StagePlan::Kind::agc:
      stage.plateau_counts = static_cast<int>(table.whole("plateau_counts", 0, 100'000'000, 0));
      break;
  }
  return stage;
}

}  // namespace

Result<EnhancementPackage> read_package(const std::filesystem::path& file) {
  TODBENCH_TRY(const auto text, read_text_file(file));
  TODBENCH_TRY(auto reader, TomlReader::parse(text, file.string()));
  EnhancementPackage package;
  package.name = reader.text("name", file.stem().string());
  package.description = reader.text("description", "");
  package.text = text;
  package.sha256 = sha256_of(text);
  std::vector<ModulePlan> modules;
  auto tables = reader.sections("stage");
  for (TomlReader& table : tables) package.stages.push_back(read_stage(table, modules));
  TODBENCH_TRY_VOID(reader.finish());
  if (package.stages.empty()) return fail(ErrorCode::invalid_input, file.string() + ": the package has no [[stage]]");
  // Programs start only after the whole file is checked.
  for (const auto& module : modules) package.provenance.push_back(text_of(module_record(module)));
  return package;
}

Result<void> refuse_finer_pictures(const EnhancementPackage& package, std::string_view what) {
  for (const StagePlan& stage : package.stages) {
    if (stage.kind == StagePlan::Kind::super_resolution)
      return fail(
          ErrorCode::invalid_input,
          fmt::format("package {}: super-resolution can only be used with 'enhance': {} needs the camera's own pixels",
                      one_line(package.name), what));
  }
  return {};
}

std::optional<int> reach_px(const EnhancementPackage& package) {
  int reach = 0;
  for (const StagePlan& stage : package.stages) {
    switch (stage.kind) {
      case StagePlan::Kind::recursive:
        break;
      case StagePlan::Kind::sharpen:
      case StagePlan::Kind::kernel:
        reach += 1;
        break;
      case StagePlan::Kind::median:
        reach += stage.size / 2;
        break;
      case StagePlan::Kind::clahe:
      case StagePlan::Kind::plateau:
      case StagePlan::Kind::agc:
      case StagePlan::Kind::module:
      case StagePlan::Kind::super_resolution:
        return std::nullopt;
    }
  }
  return reach;
}

std::vector<std::unique_ptr<ChainStage>> made_stages(const EnhancementPackage& package,
                                                     const std::function<void(std::string_view line)>& on_error_line) {
  std::vector<std::unique_ptr<ChainStage>> stages;
  for (const StagePlan& plan : package.stages) {
    switch (plan.kind) {
      case StagePlan::Kind::recursive:
        stages.push_back(recursive_filter(plan.share));
        break;
      case StagePlan::Kind::sharpen:
        stages.push_back(sharpening(plan.amount));
        break;
      case StagePlan::Kind::median:
        stages.push_back(median_filter(plan.size));
        break;
      case StagePlan::Kind::clahe:
        stages.push_back(clahe(plan.clip_limit, plan.tiles));
        break;
      case StagePlan::Kind::plateau:
        stages.push_back(plateau_equalisation(plan.plateau_percent));
        break;
      case StagePlan::Kind::module: {
        ModuleStageOptions options = plan.module;
        options.on_error_line = on_error_line;
        stages.push_back(module_stage(std::move(options)));
        break;
      }
      case StagePlan::Kind::kernel:
        stages.push_back(kernel_filter(plan.kernel));
        break;
      case StagePlan::Kind::super_resolution:
        stages.push_back(super_resolution_stage(plan.super_resolution));
        break;
      case StagePlan::Kind::agc:
        stages.push_back(gain_control(plan.plateau_counts));
        break;
    }
  }
  return stages;
}

Result<PackageStages> read_package_stages(const std::filesystem::path& file, std::string_view what) {
  TODBENCH_TRY(auto package, read_package(file));
  TODBENCH_TRY_VOID(refuse_finer_pictures(package, what));
  const auto reach = reach_px(package);
  return PackageStages{[package = std::move(package)] { return made_stages(package, {}); }, reach};
}

}  // namespace todbench
