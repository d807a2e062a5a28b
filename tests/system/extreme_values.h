// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers that a plan or a command line may state by mistake: for every key of the table of keys that takes one, and
// for every option whose help says that it takes one.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <regex>
#include <string>
#include <variant>
#include <vector>

#include "bench/plan/plan_keys.h"
#include "bench/text/text.h"
#include "tests/system/system_test_support.h"

namespace todbench::testing {

/// A key of a plan with one of its extreme values, and the plan that states it.
struct ExtremePlan {
  KeyAt at;
  std::string value, toml;
};

/// 0, negative, beyond every physical value, none at all, and the value of the plan in a unit a thousand times larger
/// or smaller. Whole keys also have the ends of their range and what lies beyond.
inline std::vector<std::string> extreme_values(const KeyType& type, const KeyValue& planned) {
  std::vector<std::string> values;
  const auto whole = [&](std::int64_t low, std::int64_t high) {
    for (const std::int64_t value : {std::int64_t{0}, std::int64_t{-1}, low, low - 1, high + 1, INT64_MAX})
      values.push_back(std::to_string(value));
    for (const char* none : {"1e308", "nan"}) values.emplace_back(none);
  };
  if (const auto* key = std::get_if<WholeKey>(&type)) whole(key->low, key->high);
  if (const auto* key = std::get_if<WholesKey>(&type)) whole(key->each.low, key->each.high);
  const auto* list = std::get_if<NumbersKey>(&type);
  if (list == nullptr && !std::holds_alternative<NumberKey>(type) && !std::holds_alternative<OptionalNumberKey>(type) &&
      !std::holds_alternative<NumberOrWordKey>(type))
    return values;
  std::vector<double> numbers{0, -1, 1e-320, 1e-30, 1e308, -1e308, std::nan(""), HUGE_VAL};
  double usual = 1;
  if (const auto* number = std::get_if<double>(&planned)) usual = *number;
  if (const auto* several = std::get_if<std::vector<double>>(&planned); several && !several->empty())
    usual = several->front();
  for (const double factor : {1e-3, 1e3}) numbers.push_back(factor * (usual == 0 ? 1 : usual));
  for (const double number : numbers) {
    std::string text = std::isnan(number) ? "nan" : std::isinf(number) ? "inf" : number_text(number);
    if (text.find_first_of(".en") == std::string::npos) text += ".0";
    if (list != nullptr) {
      std::string all = text;
      for (std::size_t i = 1; i < list->count.value_or(1); ++i) all += ", " + text;
      text = "[" + all + "]";
    }
    values.push_back(text);
  }
  return values;
}

/// The plan as a file, with this value in the first row of the section.
inline std::string with_key(const Plan& plan, const KeyAt& at, const std::string& value) {
  const std::string name(at.section->name), key(at.key->name);
  const std::string header = at.section->repeated() ? "[[" + name + "]]" : "[" + name + "]";
  std::string text = to_toml(plan);
  std::size_t begin = 0;
  if (!name.empty()) {
    begin = text.find("\n" + header + "\n");
    if (begin == std::string::npos) return text + "\n" + header + "\n" + key + " = " + value + "\n";
    begin += header.size() + 2;
  }
  const std::size_t end = std::min(text.find("\n[", begin), text.size());
  std::string section = text.substr(begin, end - begin);
  const std::size_t there = ("\n" + section).find("\n" + key + " = ");
  if (there != std::string::npos) section.erase(there, section.find('\n', there) + 1 - there);
  return text.substr(0, begin) + key + " = " + value + "\n" + section + text.substr(end);
}

/// Every extreme value of every key that takes numbers. Repeated sections have a row in the plan, or none are tried.
inline std::vector<ExtremePlan> extreme_plans(const Plan& plan) {
  std::vector<ExtremePlan> all;
  for (const PlanSection& section : plan_sections()) {
    if (section.count(plan) == 0) continue;
    for (const PlanKey& key : section.keys) {
      for (const std::string& value : extreme_values(key.type, key.place.get(plan, 0)))
        all.push_back({{&section, &key, 0}, value, with_key(plan, {&section, &key, 0}, value)});
    }
  }
  return all;
}

/// Every section with numbers has a row or its measure. Without modules, which need a program.
inline Plan plan_of_every_section() {
  const std::string text = small_measurement(
      1,
      "[measures]\nnoise = true\nnoise_frames = 48\ntransfer = true\ntransfer_steps_k = [-2, 1, 2]\npixels = true\n"
      "[[limits.acuity]]\ndelta_t_k = 16.9\nleast_acuity_per_mrad = 0.3\n"
      "[[limits.measure]]\nmeasure = \"netd\"\nat_most = 0.1\n"
      "[[limits.zone]]\nname = \"whole\"\nbad_pixels = 10\n"
      "[[limits.fleet]]\nmeasure = \"acuity\"\ndelta_t_k = 16.9\nmean = 0.4\nsd = 0.02\nu = 0.01\nunits = 12\n"
      "[[uncertainty.component]]\nname = \"distance\"\nvalue = 0.004\nunit = \"m\"\n");
  const auto plan = parse_plan({"small.toml", text}, ".");
  EXPECT_TRUE(plan) << plan.error().message;
  return plan ? *plan : Plan{};
}

/// The program ended by itself with one sentence, or with finite numbers.
inline void expect_refused_or_finite(const Ended& ended, const std::string& about) {
  if (ended.code == 2) {
    expect_refused(ended, 2, "");
    return;
  }
  EXPECT_THAT(ended.code, ::testing::AnyOf(0, 1, 3, 4, 5, 6)) << about << ": " << ended.err;
  const std::regex no_number("[^a-z](nan|inf)[^a-z]");
  EXPECT_FALSE(std::regex_search(ended.out, no_number)) << about << ": " << ended.out;
  if (!ended.out.empty()) (void)one_object(ended);
}

/// A command line whose options may be exchanged.
struct OptionCommand {
  std::vector<std::string> command;    ///< "history check"
  std::vector<std::string> arguments;  ///< that it needs, an option in front of its value
};

/// An option that takes numbers.
struct ExtremeOption {
  std::string name;
  int values = 1;
  bool whole = false;
};

/// The options whose help says that they take numbers. The seed may be any.
inline std::vector<ExtremeOption> numeric_options(const std::vector<std::string>& command) {
  std::vector<std::string> asked = command;
  asked.emplace_back("--help");
  const std::string help = todbench(asked).out;
  const std::regex line(R"((--[a-z0-9-]+) (FLOAT|INT|UINT)(?: x (\d))?)");
  std::vector<ExtremeOption> options;
  for (auto it = std::sregex_iterator(help.begin(), help.end(), line); it != std::sregex_iterator(); ++it) {
    const std::smatch& found = *it;
    if (found[1] == "--seed") continue;
    options.push_back({found[1], found[3].matched ? std::stoi(found[3]) : 1, found[2] != "FLOAT"});
  }
  return options;
}

/// The command line with this value of the option, in place of the one that it has.
inline std::vector<std::string> with_option(const OptionCommand& command, const ExtremeOption& option,
                                            const std::string& value) {
  std::vector<std::string> words = command.command, arguments = command.arguments;
  const auto there = std::ranges::find(arguments, option.name);
  if (there != arguments.end()) arguments.erase(there, there + 1 + option.values);
  words.insert(words.end(), arguments.begin(), arguments.end());
  words.push_back(option.name);
  for (int i = 0; i < option.values; ++i) words.push_back(value);
  words.emplace_back("--json");
  return words;
}

}  // namespace todbench::testing
