#include "bench/enhance/package_file.h"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <sstream>
#include <utility>

#include "bench/plan/strict_toml.h"
#include "bench/text/files.h"
#include "bench/text/json.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

const std::vector<std::string> stage_kinds{"recursive", "sharpen", "median", "clahe", "plateau", "module"};

/// Output of a command for a shell, its first line, within ten seconds.
std::string first_line_of(const std::string& command) {
  std::string quoted = "'";
  for (const char c : command) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  FILE* pipe = ::popen(("timeout -s KILL 10 sh -c " + quoted + "' 2>&1 </dev/null").c_str(), "r");
  if (pipe == nullptr) return "";
  std::array<char, 256> line{};
  const bool read = std::fgets(line.data(), line.size(), pipe) != nullptr;
  ::pclose(pipe);
  return read ? one_line(std::string(line.data(), std::string(line.data()).find_last_not_of('\n') + 1)) : "";
}

/// Command, version and the files that the command names.
std::string module_record(const std::string& command, const std::string& version) {
  std::string record = "module: " + one_line(command);
  if (!version.empty()) record += "; version: " + first_line_of(version);
  std::istringstream words(command);
  for (std::string word; words >> word;) {
    std::error_code problem;
    if (!std::filesystem::is_regular_file(word, problem)) continue;
    if (const auto hash = sha256_of_file(word)) record += "; " + one_line(word) + " SHA-256 " + *hash;
  }
  return record;
}

ModuleStageOptions read_module(TomlReader& stage, std::string& record) {
  ModuleStageOptions module;
  module.process.command = stage.text("command", std::nullopt);
  if (module.process.command.empty()) stage.reject("command", "is empty");
  module.process.limit = std::chrono::milliseconds(stage.whole("limit_ms", 1, 600000, 5000));
  module.process.memory_limit_mib = static_cast<std::size_t>(stage.whole("memory_mib", 0, 1 << 20, 0));
  module.process.network = stage.flag("network", false) ? ModuleNetwork::ours : ModuleNetwork::cut;
  module.restart_frames = static_cast<int>(stage.whole("restart_frames", 0, 1000000000, 0));
  module.settle_frames = static_cast<int>(stage.whole("settle_frames", 0, 10000, 0));
  Json parameters = Json::object();
  for (const auto& [key, value] : stage.free_table("parameters")) parameters[key] = value;
  module.process.header =
      Json{{"protocol", "todbench-module"}, {"version", 1}, {"place", "picture"}, {"parameters", parameters}}.dump();
  const std::string version = stage.text("version", "");
  record = module.process.command + '\n' + version;
  return module;
}

StagePlan read_stage(TomlReader& table, std::string& record) {
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
      stage.module = read_module(table, record);
      break;
  }
  return stage;
}

}  // namespace

Result<EnhancementPackage> read_package(const std::filesystem::path& file) {
  const auto text = read_text_file(file);
  if (!text) return tl::unexpected(text.error());
  auto reader = TomlReader::parse(*text, file.string());
  if (!reader) return tl::unexpected(reader.error());
  EnhancementPackage package;
  package.name = reader->text("name", file.stem().string());
  package.description = reader->text("description", "");
  package.sha256 = sha256_of(*text);
  std::vector<std::string> modules;
  for (TomlReader& table : reader->sections("stage")) {
    std::string record;
    package.stages.push_back(read_stage(table, record));
    if (!record.empty()) modules.push_back(std::move(record));
  }
  if (auto fine = reader->finish(); !fine) return tl::unexpected(fine.error());
  if (package.stages.empty()) return fail(ErrorCode::invalid_input, file.string() + ": has no [[stage]]");
  // Nothing is started before the whole file is known to be right.
  for (const auto& module : modules) {
    const auto end = module.rfind('\n');
    package.provenance.push_back(module_record(module.substr(0, end), module.substr(end + 1)));
  }
  return package;
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
    }
  }
  return stages;
}

}  // namespace todbench
