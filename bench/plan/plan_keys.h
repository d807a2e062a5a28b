// SPDX-License-Identifier: GPL-3.0-or-later
// Table of all plan keys: name, unit, range, sentence and member. It is the source of reader, writer, form, command
// line, validation and docs/reference/plan-keys.md.
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

/// Line of the form in the window; without a label the key is not shown.
struct FormLine {
  std::string_view label{};        ///< label without unit
  std::string_view object_name{};  ///< name of the widget
  /// Repeated section only: path of the list of numbers whose elements are the values of the first key. The other keys
  /// become columns next to that list. If empty, the rows form a separate table with names and numbers.
  std::string_view beside{};
};

/// Commands that offer an option for a key.
enum class OptionOf {
  simulations,   ///< simulate and plan
  measurements,  ///< measure and demo
};
/// Command-line option for a key.
struct KeyOption {
  std::string_view name{};  ///< "--delta-t-k"; empty: none
  OptionOf of = OptionOf::simulations;
};

/// Access to the member that contains the value. `row` is the row of a repeated section, otherwise 0.
struct KeyPlace {
  std::function<KeyValue(const Plan&, std::size_t row)> get;
  std::function<void(Plan&, std::size_t row, const KeyValue&)> set;
};

/// Source of the value of an absent key: another part of the plan instead of the default.
struct KeyFallback {
  std::string_view words{};  ///< text for documents: "value of the sensor"
  std::function<KeyValue(const Plan&, const PlanParts&)> value{};
};

/// Condition under which a file must contain a key.
enum class Required {
  never,
  with_section,  ///< required if the file has the section
  always,
};

/// Condition under which another key of the plan replaces a key.
struct KeyReplaced {
  std::function<bool(const Plan&)> by{};  ///< true: a file must not have the key, and a plan is written without it
  std::string_view sentence{};            ///< message about a file that has the key nevertheless
  [[nodiscard]] bool in(const Plan& plan) const { return by && by(plan); }
};

/// One key of a plan.
struct PlanKey {
  std::string_view name;
  KeyType type;
  std::string_view unit{};      ///< unit, "s" or "K"; empty: no unit
  std::string_view sentence{};  ///< description for documents, tooltips and options
  KeyPlace place{};
  Required required = Required::never;
  KeyFallback fallback{};
  KeyReplaced replaced{};
  FormLine form{};
  KeyOption option{};
  /// Replaces the range of the type if the rest of the plan narrows it. The key is then required.
  std::function<std::optional<NumberRange>(const Plan&)> narrowed{};
  /// Returns the mistakes in the value, given the rest of the plan.
  std::function<std::vector<ValueMistake>(const Plan&, std::size_t row)> check{};
  /// False: a plan with the default value is written without the key.
  bool written_at_default = true;
  std::vector<std::string_view> other_names{};  ///< alternatives to `name` in a file
};

/// Access to the rows of a repeated section, [[name]].
struct SectionRows {
  std::function<std::size_t(const Plan&)> count{};
  std::function<void(Plan&, std::size_t)> resize{};  ///< new rows have the defaults of their struct
};

/// One section of a plan with its keys.
struct PlanSection {
  std::string_view name;  ///< name as in the file, "limits.acuity"; empty: keys before the first section
  std::string_view sentence;
  std::vector<PlanKey> keys;
  SectionRows rows{};                           ///< empty functions: not repeated
  FormLine form{};                              ///< rows of a repeated section
  std::vector<std::string_view> other_names{};  ///< repeated section only: alternatives to the last part of `name`

  [[nodiscard]] bool repeated() const { return rows.count != nullptr; }
  /// Returns the number of rows; 1 if not repeated.
  [[nodiscard]] std::size_t count(const Plan& plan) const { return repeated() ? rows.count(plan) : 1; }
};

/// Returns the table in the order of reading and writing: a key comes after the keys that its fallback or check uses.
[[nodiscard]] const std::vector<PlanSection>& plan_sections();

/// Returns the path in Error::key: "target.delta_t_k".
[[nodiscard]] std::string path_of(const PlanSection& section, const PlanKey& key);

/// Key with its section and row.
struct KeyAt {
  const PlanSection* section = nullptr;
  const PlanKey* key = nullptr;
  std::size_t row = 0;
};
/// Finds a key by path. Precondition: the table has the path.
[[nodiscard]] KeyAt plan_key(std::string_view path);
/// Returns the value that a default plan has for this key; in a new row if the section is repeated.
[[nodiscard]] KeyValue default_of(const KeyAt& key);
/// Returns the type with the range narrowed by the rest of the plan.
[[nodiscard]] KeyType type_in(const PlanKey& key, const Plan& plan);

/// Returns the name under which the table contains the key (`name` or one of `other_names`); `key.name` if the key is
/// absent.
[[nodiscard]] std::string_view name_in(const TomlReader& table, const PlanKey& key);
/// Returns the tables of a repeated section, found by the last part of its name or by an alternative name.
[[nodiscard]] std::vector<TomlReader> rows_in(TomlReader& parent, const PlanSection& section);

/// Mistake in a plan.
struct PlanMistake {
  KeyAt at;
  ValueMistake mistake;
};
/// Returns all mistakes that can be found without reading files, in the order of the table.
[[nodiscard]] std::vector<PlanMistake> mistakes_in(const Plan& plan);
/// Returns the error "key 'delta_t_k' in [target]: SENTENCE", `invalid_input`.
[[nodiscard]] Error error_of(const PlanMistake& mistake);

/// Returns the text of docs/reference/plan-keys.md.
[[nodiscard]] std::string plan_keys_page();

}  // namespace todbench
