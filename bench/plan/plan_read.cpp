// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>
#include <set>
#include <string>

#include "acquisition/base/try.h"
#include "bench/plan/certificate_reader.h"
#include "bench/plan/loaded_plan.h"
#include "bench/plan/plan_keys.h"

namespace todbench {

namespace {

/// Tables of a file by section name; those of a repeated section by row.
class Tables {
 public:
  explicit Tables(TomlReader root) { tables_[""].push_back(std::move(root)); }

  std::vector<TomlReader>& open(const PlanSection& section) {
    if (const auto known = tables_.find(section.name); known != tables_.end()) return known->second;
    const std::string name(section.name);
    const std::size_t dot = name.rfind('.');
    TomlReader& parent = dot == std::string::npos ? tables_[""].front() : table(name.substr(0, dot));
    const std::string own = name.substr(dot == std::string::npos ? 0 : dot + 1);
    std::vector<TomlReader> opened =
        section.repeated() ? rows_in(parent, section) : std::vector<TomlReader>{parent.section(own)};
    return tables_.emplace(name, std::move(opened)).first->second;
  }

 private:
  TomlReader& table(const std::string& name) {
    const auto known = tables_.find(name);
    if (known != tables_.end()) return known->second.front();
    return tables_.emplace(name, std::vector<TomlReader>{tables_[""].front().section(name)}).first->second.front();
  }
  std::map<std::string, std::vector<TomlReader>, std::less<>> tables_;
};

void reject(TomlReader& table, const PlanKey& key, const ValueMistake& mistake) {
  if (mistake.element) {
    table.reject(name_in(table, key), *mistake.element, mistake.sentence);
  } else {
    table.reject(name_in(table, key), mistake.sentence);
  }
}

class PlanReader {
 public:
  PlanReader(TomlReader root, const std::filesystem::path& folder, const ResourceFinder& find)
      : tables_(std::move(root)), folder_(folder), find_(find) {}

  void read() {
    for (const PlanSection& section : plan_sections()) {
      std::vector<TomlReader>& tables = tables_.open(section);
      if (section.repeated()) section.rows.resize(plan_, tables.size());
      for (std::size_t row = 0; row < tables.size(); ++row) {
        for (const PlanKey& key : section.keys) read_key(tables[row], {&section, &key, row});
      }
    }
    read_certificates();
    for (const PlanMistake& found : mistakes_in(plan_)) {
      // Missing keys have been reported already.
      if (missing_.contains({found.at.key, found.at.row})) continue;
      std::vector<TomlReader>& tables = tables_.open(*found.at.section);
      // A row from a certificate is not in the file.
      if (found.at.row < tables.size()) reject(tables[found.at.row], *found.at.key, found.mistake);
    }
  }

  [[nodiscard]] Plan& plan() { return plan_; }
  [[nodiscard]] PlanParts& parts() { return parts_; }

 private:
  [[nodiscard]] bool required(const TomlReader& table, const PlanKey& key) const {
    if (key.replaced.in(plan_)) return false;
    if (key.narrowed && key.narrowed(plan_)) return true;
    return key.required == Required::always || (key.required == Required::with_section && table.present());
  }

  void read_key(TomlReader& table, const KeyAt& at) {
    const PlanKey& key = *at.key;
    const KeyType type = type_in(key, plan_);
    const std::string_view name = name_in(table, key);
    if (!table.has(name) && required(table, key)) {
      (void)read_value(type, table, name, std::nullopt);
      missing_.insert({at.key, at.row});
      return;
    }
    if (table.has(name) && key.replaced.in(plan_)) table.reject(name, std::string(key.replaced.sentence));
    const KeyValue fallback = key.fallback.value ? key.fallback.value(plan_, parts_) : key.place.get(plan_, at.row);
    key.place.set(plan_, at.row, read_value(type, table, name, fallback));
    if (std::holds_alternative<ResourceKey>(type) || std::holds_alternative<ResourcesKey>(type))
      read_named(table, at, type);
  }

  /// Puts the numbers of the certificates of instruments into the plan.
  void read_certificates() {
    const KeyAt at = plan_key("instrument.dcc");
    for (std::size_t row = 0; row < plan_.instruments.size(); ++row) {
      if (plan_.instruments[row].dcc.empty()) continue;
      if (auto applied = apply_certificate(plan_, row, folder_); !applied)
        reject(tables_.open(*at.section)[row], *at.key, {std::nullopt, applied.error().message});
    }
  }

  /// Makes the references of a key absolute in the plan and reads the parts.
  void read_named(TomlReader& table, const KeyAt& at, const KeyType& type) {
    // Absolute references stay unchanged.
    plan_ = with_absolute_references(std::move(plan_), folder_);
    for (const ValueMistake& mistake : read_parts(type, plan_, find_, parts_)) reject(table, *at.key, mistake);
  }

  Tables tables_;
  const std::filesystem::path& folder_;
  const ResourceFinder& find_;
  Plan plan_;
  PlanParts parts_;
  std::set<std::pair<const PlanKey*, std::size_t>> missing_;
};

}  // namespace

Result<LoadedPlan> read_plan(const Resource& resource, const std::filesystem::path& folder,
                             const ResourceFinder& find) {
  TODBENCH_TRY(TomlReader root, TomlReader::parse(resource.text, resource.origin));
  PlanReader reader(root, folder, find);
  reader.read();
  TODBENCH_TRY_VOID(root.finish());
  if (auto seen = check_eye(reader.plan(), reader.parts()); !seen) return fail(resource.origin, seen.error());
  return LoadedPlan(std::move(reader.plan()), std::move(reader.parts()));
}

}  // namespace todbench
