// Every key of a plan, once: its name, unit, range, sentence and member. Reader, writer, form, command line, validation
// and docs/plan-keys.md come from this table.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/plan/key_types.h"
#include "bench/plan/loaded_plan.h"
#include "bench/plan/plan.h"

namespace todbench {

/// A line of the window's form; without a label there is none.
struct FormLine {
  std::string_view label{};        ///< without the unit
  std::string_view object_name{};  ///< of the part of the window
  /// Of a repeated section: path of the list of numbers whose elements its first key repeats. Its other keys are
  /// columns beside that list. Without it the rows are a table of their own, of names and numbers.
  std::string_view beside{};
};

/// The commands that take an option in place of a key.
enum class OptionOf {
  simulations,   ///< simulate and plan
  measurements,  ///< measure and demo
};
struct KeyOption {
  std::string_view name{};  ///< "--delta-t-k"; empty: none
  OptionOf of = OptionOf::simulations;
};

/// The member that holds the value, in row `row` of a section that may be repeated; otherwise `row` is 0.
struct KeyPlace {
  std::function<KeyValue(const Plan&, std::size_t row)> get;
  std::function<void(Plan&, std::size_t row, const KeyValue&)> set;
};

/// What a key that a file leaves out takes from elsewhere in the plan, in place of the default.
struct KeyFallback {
  std::string_view words{};  ///< for documents: "that of [target]"
  std::function<KeyValue(const Plan&, const PlanParts&)> value{};
};

/// When a file has to have a key.
enum class Required {
  never,
  with_section,  ///< where the file has the section
  always,
};

struct PlanKey {
  std::string_view name;
  KeyType type;
  std::string_view unit{};      ///< "s", "K"; empty: none
  std::string_view sentence{};  ///< what it is, for documents, tooltips and options
  KeyPlace place{};
  Required required = Required::never;
  KeyFallback fallback{};
  FormLine form{};
  KeyOption option{};
  /// In place of the range of the type, where the rest of the plan narrows it: then the key has to be there.
  std::function<std::optional<NumberRange>(const Plan&)> narrowed{};
  /// What the rest of the plan says against the value.
  std::function<std::vector<ValueMistake>(const Plan&, std::size_t row)> check{};
  /// A plan in which it has its default is written without it.
  bool written_at_default = true;
  std::vector<std::string_view> other_names{};  ///< that a file may have in place of `name`
};

/// Of a section that may be repeated, [[name]].
struct SectionRows {
  std::function<std::size_t(const Plan&)> count{};
  std::function<void(Plan&, std::size_t)> resize{};  ///< new rows have the defaults of their struct
};

struct PlanSection {
  std::string_view name;  ///< as in the file, "limits.acuity"; empty: the keys before every section
  std::string_view sentence;
  std::vector<PlanKey> keys;
  SectionRows rows{};                           ///< without functions: the section is there once
  FormLine form{};                              ///< of a repeated section: its rows
  std::vector<std::string_view> other_names{};  ///< of a repeated section, in place of the last part of `name`

  [[nodiscard]] bool repeated() const { return rows.count != nullptr; }
  /// 1 for a section that is there once.
  [[nodiscard]] std::size_t count(const Plan& plan) const { return repeated() ? rows.count(plan) : 1; }
};

/// The table, in the order in which a plan is read and written: what a fallback or a check looks at comes first.
[[nodiscard]] const std::vector<PlanSection>& plan_sections();

/// "target.delta_t_k": the name by which Error::key calls it.
[[nodiscard]] std::string path_of(const PlanSection& section, const PlanKey& key);

/// A key with its section, and where there are rows the row.
struct KeyAt {
  const PlanSection* section = nullptr;
  const PlanKey* key = nullptr;
  std::size_t row = 0;
};
/// Precondition: the table has the path.
[[nodiscard]] KeyAt plan_key(std::string_view path);
/// The value in a plan of defaults, in a new row of a repeated section.
[[nodiscard]] KeyValue default_of(const KeyAt& key);
/// The type with its range as the rest of the plan narrows it.
[[nodiscard]] KeyType type_in(const PlanKey& key, const Plan& plan);

/// The first name of the key that the table has; its own where it has none.
[[nodiscard]] std::string_view name_in(const TomlReader& table, const PlanKey& key);
/// The tables of a repeated section, by the last part of its name or another one of its names.
[[nodiscard]] std::vector<TomlReader> rows_in(TomlReader& parent, const PlanSection& section);

/// Something wrong with a plan.
struct PlanMistake {
  KeyAt at;
  ValueMistake mistake;
};
/// Everything that no file need be read for, in the order of the table.
[[nodiscard]] std::vector<PlanMistake> mistakes_in(const Plan& plan);
/// As an error about the key: "key 'delta_t_k' in [target]: SENTENCE", `invalid_input`.
[[nodiscard]] Error error_of(const PlanMistake& mistake);

/// docs/plan-keys.md.
[[nodiscard]] std::string plan_keys_page();

}  // namespace todbench
