// SPDX-License-Identifier: GPL-3.0-or-later
// Access to the members of a plan as key values, for the table of keys.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "bench/plan/plan_keys.h"

namespace todbench {

/// Return all values of an enumeration, in the order of its names.
constexpr const auto& values_of(const TargetKind&) {
  return all_target_kinds;
}
constexpr const auto& values_of(const ScheduleKind&) {
  return all_schedule_kinds;
}
constexpr const auto& values_of(const AnswersChoice&) {
  return all_answers_choices;
}
constexpr const auto& values_of(const EstimatorChoice&) {
  return all_estimator_choices;
}
constexpr const auto& values_of(const PsychometricForm&) {
  return all_psychometric_forms;
}
constexpr const auto& values_of(const Mounting&) {
  return all_mountings;
}
constexpr const auto& values_of(const ConformityRule&) {
  return conformity_rules;
}
constexpr const auto& values_of(const PixelArea&) {
  return all_pixel_areas;
}
constexpr const auto& values_of(const PixelRule&) {
  return all_pixel_rules;
}
constexpr const auto& values_of(const BudgetDistribution&) {
  return budget_distributions;
}
constexpr const auto& values_of(const BudgetCommon&) {
  return budget_commons;
}
constexpr const auto& values_of(const BudgetInput&) {
  return budget_inputs;
}
constexpr const auto& values_of(const ModulePlace&) {
  return all_module_places;
}
constexpr const auto& values_of(const PlaceSource&) {
  return all_place_sources;
}
constexpr const auto& values_of(const InstrumentRole&) {
  return all_instrument_roles;
}
constexpr const auto& values_of(const ContrastUnit&) {
  return all_contrast_units;
}
constexpr const auto& values_of(const DisplayInterpolation&) {
  return all_display_interpolations;
}
constexpr const auto& values_of(const Effect&) {
  return all_effects;
}

/// Returns the names of an enumeration.
template <typename Values>
std::vector<std::string> names_of(const Values& values) {
  std::vector<std::string> names;
  for (const auto value : values) names.emplace_back(to_string(value));
  return names;
}

/// Returns the value with this name; the first value if the name is unknown (the reader has already recorded the
/// mistake).
template <typename E>
E value_named(const std::string& name) {
  for (const E value : values_of(E{})) {
    if (to_string(value) == name) return value;
  }
  return values_of(E{})[0];
}

/// Convert the member of a plan to a key value.
template <typename T>
KeyValue to_key_value(const T& member) {
  if constexpr (std::is_enum_v<T>) {
    return std::string(to_string(member));
  } else if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
    return static_cast<std::int64_t>(member);
  } else {
    return member;
  }
}
inline KeyValue to_key_value(const std::optional<double>& member) {
  return member ? KeyValue(*member) : KeyValue();
}
inline KeyValue to_key_value(const std::vector<int>& member) {
  return std::vector<double>(member.begin(), member.end());
}
inline KeyValue to_key_value(const SceneMotion& member) {
  return std::vector<double>{member.x_mrad_s, member.y_mrad_s};
}
template <typename E>
requires std::is_enum_v<E> KeyValue to_key_value(const std::vector<E>& member) {
  return names_of(member);
}

/// Set the member of a plan from a key value of the matching type.
template <typename T>
void from_key_value(T& member, const KeyValue& value) {
  if constexpr (std::is_enum_v<T>) {
    member = value_named<T>(std::get<std::string>(value));
  } else if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
    member = static_cast<T>(std::get<std::int64_t>(value));
  } else {
    member = std::get<T>(value);
  }
}
inline void from_key_value(std::optional<double>& member, const KeyValue& value) {
  const auto* number = std::get_if<double>(&value);
  member = number != nullptr ? std::optional(*number) : std::nullopt;
}
inline void from_key_value(std::vector<int>& member, const KeyValue& value) {
  member.clear();
  // The range check rejects invalid numbers of frames later; the cast must not overflow before.
  for (const double number : std::get<std::vector<double>>(value))
    member.push_back(number >= -1e9 && number <= 1e9 ? static_cast<int>(number) : -1);
}
/// Ignores a list without exactly two elements, because the reader has already rejected this list.
inline void from_key_value(SceneMotion& member, const KeyValue& value) {
  const auto& numbers = std::get<std::vector<double>>(value);
  if (numbers.size() == 2) member = {.x_mrad_s = numbers[0], .y_mrad_s = numbers[1]};
}
template <typename E>
requires std::is_enum_v<E>
void from_key_value(std::vector<E>& member, const KeyValue& value) {
  member.clear();
  for (const std::string& name : std::get<std::vector<std::string>>(value)) member.push_back(value_named<E>(name));
}

/// Returns access to a member of the struct `reach(plan, row)`, which is const if the plan is.
template <typename Reach, typename Struct, typename T>
KeyPlace place_of(Reach reach, T Struct::*member) {
  return {.get = [=](const Plan& plan, std::size_t row) { return to_key_value(reach(plan, row).*member); },
          .set = [=](Plan& plan, std::size_t row,
                     const KeyValue& value) { from_key_value(reach(plan, row).*member, value); }};
}

/// Returns access to a member of the plan itself.
template <typename T>
KeyPlace in_plan(T Plan::*member) {
  return place_of(
      [](auto& plan, std::size_t) -> auto& { return plan; }, member);
}

/// Returns access to a member of a section of the plan.
template <typename Struct, typename T>
KeyPlace in(Struct Plan::*section, T Struct::*member) {
  return place_of(
      [section](auto& plan, std::size_t) -> auto& { return plan.*section; }, member);
}

/// Returns access to the rows of the list `reach(plan)`.
template <typename Reach>
SectionRows rows_of(Reach reach) {
  return {.count = [=](const Plan& plan) { return reach(plan).size(); },
          .resize = [=](Plan& plan, std::size_t count) { reach(plan).resize(count); }};
}
/// Returns access to a member of one row of the list `reach(plan)`.
template <typename Reach, typename Struct, typename T>
KeyPlace in_row(Reach reach, T Struct::*member) {
  return place_of(
      [=](auto& plan, std::size_t row) -> auto& { return reach(plan)[row]; }, member);
}

}  // namespace todbench
