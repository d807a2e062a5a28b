// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/twin/module_chain.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <limits>
#include <sstream>
#include <utility>

#include "bench/devices/processed_source.h"
#include "bench/text/files.h"
#include "bench/text/json.h"
#include "bench/text/text.h"
#include "sim_devices/module/module_observer.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

/// A stage whose errors are those of the run.
class PlannedModule final : public ChainStage {
 public:
  PlannedModule(ModulePlan plan, const ModuleLine& on_error_line) : plan_(std::move(plan)) {
    ModuleStageOptions options = stage_options(plan_);
    options.on_error_line = on_error_line;
    stage_ = module_stage(std::move(options));
  }
  [[nodiscard]] Result<cv::Mat1f> process(const cv::Mat1f& picture) override {
    auto answer = stage_->process(picture);
    if (!answer) return tl::unexpected(module_error(plan_, answer.error()));
    return answer;
  }
  [[nodiscard]] int memory_frames() const override { return stage_->memory_frames(); }

 private:
  ModulePlan plan_;
  std::unique_ptr<ChainStage> stage_;
};

/// Returns the output of the version command of a module, within its limits and ten seconds.
std::string version_of(const ModulePlan& module) {
  ModuleOptions options = stage_options(module).process;
  options.command = module.version;
  options.limit = std::chrono::seconds(10);
  return one_line(first_line_of_module(options));
}

}  // namespace

const ModulePlan* observer_module(const Plan& plan) {
  const auto found = std::ranges::find(plan.modules, ModulePlace::observer, &ModulePlan::place);
  return found == plan.modules.end() ? nullptr : &*found;
}

bool has_modules(const Plan& plan, const SensorSpec& sensor) {
  return !plan.modules.empty() || !sensor.modules.empty();
}

Result<void> refuse_modules(const Plan& plan, const SensorSpec& sensor) {
  if (!has_modules(plan, sensor)) return {};
  return fail(
      ErrorCode::invalid_input,
      "the plan or its sensor has a [[module]], which an estimate without trials cannot include: use 'simulate'");
}

std::vector<ModulePlan> picture_modules(const Plan& plan, const SensorSpec& sensor, Side side) {
  std::vector<ModulePlan> modules;
  if (side == Side::simulated) modules = sensor.modules;
  for (const ModulePlan& module : plan.modules) {
    if (module.place == ModulePlace::picture) modules.push_back(module);
  }
  return modules;
}

std::vector<std::unique_ptr<ChainStage>> module_stages(const std::vector<ModulePlan>& modules,
                                                       const ModuleLine& on_error_line) {
  std::vector<std::unique_ptr<ChainStage>> stages;
  for (const ModulePlan& module : modules) {
    if (module.place == ModulePlace::picture) stages.push_back(std::make_unique<PlannedModule>(module, on_error_line));
  }
  return stages;
}

int settle_frames(const std::vector<ModulePlan>& modules) {
  int sum = 0;
  for (const ModulePlan& module : modules) sum += module.settle_frames;
  return sum;
}

void put_stages_behind(OpenedBench& bench, std::vector<std::unique_ptr<ChainStage>> stages) {
  if (stages.empty()) return;
  constexpr std::size_t no_picture = std::numeric_limits<std::size_t>::max();
  bench.camera = processed_source(std::move(bench.camera), std::move(stages), ProcessedAs::judged, no_picture,
                                  std::make_shared<ProcessingRecord>());
}

void keep_noise(const MeasurementResult& result, TodCurve& curve) {
  for (TodPoint& point : curve.points) {
    point.noise_counts = result.temporal_noise_counts;
    point.lag1_correlation = result.lag1_correlation;
    for (const JudgedContrast& judged : result.judged_contrasts) {
      if (!same_contrast(judged.set_delta_t_k, point.set_delta_t_k)) continue;
      const double steps = judged.scale.steps.noise_steps();
      if (judged.scale.steps.noise_levels > 0) point.noise_counts = std::min(point.noise_counts.value_or(steps), steps);
    }
  }
}

std::unique_ptr<Observer> observer_of(const Plan& plan, const ExperimentInputs& inputs,
                                      const ModuleLine& on_error_line) {
  if (const ModulePlan* module = observer_module(plan))
    return module_observer(inputs.observer, triangle_alternatives(), *module, on_error_line);
  return std::make_unique<TemplateObserver>(inputs.observer, triangle_alternatives());
}

std::string observer_name(const Plan& plan, const ExperimentInputs& inputs) {
  const ModulePlan* module = observer_module(plan);
  return module == nullptr
             ? inputs.observer.name
             : "module '" + one_line(module->command) + "' with window and noise of " + inputs.observer.name;
}

ModuleRecord module_record(const ModulePlan& module) {
  ModuleRecord record;
  record.place = to_string(module.place);
  record.command = module.command;
  if (!module.version.empty()) record.version = version_of(module);
  std::istringstream words(module.command);
  for (std::string word; words >> word;) {
    std::error_code problem;
    if (!std::filesystem::is_regular_file(word, problem)) continue;
    if (const auto hash = sha256_of_file(word)) record.files[word] = *hash;
  }
  return record;
}

std::string text_of(const ModuleRecord& record) {
  std::string text = "module: " + one_line(record.command);
  if (!record.version.empty()) text += "; version: " + record.version;
  for (const auto& [file, hash] : record.files) text += "; " + one_line(file) + " SHA-256 " + hash;
  return text;
}

std::vector<ModuleRecord> module_records(const Plan& plan, const SensorSpec& sensor, Side side) {
  std::vector<ModuleRecord> records;
  for (const ModulePlan& module : picture_modules(plan, sensor, side)) records.push_back(module_record(module));
  if (const ModulePlan* module = observer_module(plan)) records.push_back(module_record(*module));
  return records;
}

}  // namespace todbench
