#include <string>

#include "bench/plan/plan_keys.h"

namespace todbench {

namespace {

/// A bar would end the cell.
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
      "Every key of a plan file (TOML), from the table of the program (`bench/plan/plan_sections.h`); "
      "`plan_keys_page FILE` writes this page, and a\ntest fails when it is not what the table says. "
      "A key that is left out has its default. An unknown or misspelt key is refused with file and\nline. "
      "Files named in a plan are relative to it. Options of the command line stand in place of a key: "
      "`--record-frames` and `--letterhead` of `measure` and `demo`,\nthe others of `simulate` and `plan`; `--skip` "
      "and `--force` "
      "add to the plan's lists, `--seed` stands for `seed` everywhere.\n";
  for (const PlanSection& section : plan_sections()) {
    const std::string name(section.name);
    page += "\n## " +
            (name.empty()         ? "Before every section"
             : section.repeated() ? "[[" + name + "]]"
                                  : "[" + name + "]") +
            "\n\n" + std::string(section.sentence) + (section.repeated() ? " As many as there are." : "") +
            "\n\n| key | what it is | takes | unit | default | option |\n|---|---|---|---|---|---|\n";
    for (const PlanKey& key : section.keys) page += row_text({&section, &key, 0});
  }
  return page;
}

}  // namespace todbench
