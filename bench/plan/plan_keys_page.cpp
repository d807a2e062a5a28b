// SPDX-License-Identifier: GPL-3.0-or-later
#include <string>

#include "bench/plan/plan_keys.h"

namespace todbench {

namespace {

/// Escapes bars, which would end the cell.
std::string cell(std::string_view text) {
  std::string result;
  for (const char c : text) result += c == '|' ? std::string("\\|") : std::string(1, c);
  return result;
}

std::string default_text(const KeyAt& at) {
  if (at.key->required == Required::always) return "required";
  if (at.key->fallback.value) return std::string(at.key->fallback.words);
  if (std::holds_alternative<FreeTableKey>(at.key->type)) return "none";
  const std::optional<std::string> value = toml_value(at.key->type, default_of(at));
  return value ? "`" + *value + "`" : "none";
}

std::string row_text(const KeyAt& at) {
  const PlanKey& key = *at.key;
  std::string text = "| `" + std::string(key.name) + "` | " + cell(key.sentence) + " | " + cell(expected_of(key.type));
  text += " | " + std::string(key.unit) + " | " + cell(default_text(at)) + " | ";
  if (!key.option.name.empty()) text += "`" + std::string(key.option.name) + "`";
  return text + " |\n";
}

}  // namespace

std::string plan_keys_page() {
  std::string page =
      "# Keys of a plan\n\n"
      "This page lists every key of a plan file (TOML). `plan_keys_page FILE` writes it from the table of the program "
      "(`bench/plan/plan_sections.h`), and a test\ncompares them.\n\n"
      "- A key that is left out has its default.\n"
      "- An unknown or misspelt key is rejected with file and line.\n"
      "- File names in a plan are relative to the folder of the plan.\n"
      "- An option of the command line replaces its key. The options `--record-frames` and `--letterhead` belong to "
      "`measure` and `demo`, the others to\n  `simulate` and `plan`.\n"
      "- `--skip` and `--force` add to the lists of the plan. `--seed` replaces `seed` in every command.\n";
  for (const PlanSection& section : plan_sections()) {
    const std::string name(section.name);
    page += "\n## " +
            (name.empty()         ? "Top level"
             : section.repeated() ? "[[" + name + "]]"
                                  : "[" + name + "]") +
            "\n\n" + std::string(section.sentence) + (section.repeated() ? " The table may be repeated." : "") +
            "\n\n| key | meaning | values | unit | default | option |\n|---|---|---|---|---|---|\n";
    for (const PlanKey& key : section.keys) page += row_text({&section, &key, 0});
  }
  return page;
}

}  // namespace todbench
