// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/sweep/sweep_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/text/text.h"

#include <toml++/toml.h>

namespace todbench {
namespace {

constexpr std::size_t most_values = 1'000'000;

/// Stores the first error with its line.
class Reading {
 public:
  explicit Reading(std::string file) : file_(std::move(file)) {}
  void wrong(const toml::node& node, const std::string& sentence) {
    if (!mistake_) mistake_ = fmt::format("{}:{}: {}", file_, node.source().begin.line, sentence);
  }
  [[nodiscard]] const std::optional<std::string>& mistake() const { return mistake_; }

 private:
  std::string file_;
  std::optional<std::string> mistake_;
};

/// Returns keys and values of a table in the order of the file.
std::vector<std::pair<std::string, const toml::node*>> in_order(const toml::table& table) {
  std::vector<std::pair<std::string, const toml::node*>> entries;
  for (const auto& [key, node] : table) entries.emplace_back(std::string(key.str()), &node);
  std::stable_sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) {
    const auto place = [](const toml::node* node) {
      return std::pair(node->source().begin.line, node->source().begin.column);
    };
    return place(a.second) < place(b.second);
  });
  return entries;
}

/// Returns the text of a number, a word, a boolean, or a list of these.
std::string text_of(const toml::node& node, Reading& reading) {
  if (const auto* value = node.as_floating_point(); value != nullptr && std::isfinite(value->get()))
    return number_text(value->get());
  if (const auto* value = node.as_integer()) return std::to_string(value->get());
  if (const auto* value = node.as_boolean()) return value->get() ? "yes" : "no";
  if (const auto* value = node.as_string()) return value->get();
  if (const auto* list = node.as_array(); list != nullptr && !list->empty()) {
    std::string text;
    for (const auto& element : *list) text += (text.empty() ? "" : ", ") + text_of(element, reading);
    return text;
  }
  reading.wrong(node, "expected a number, a text, true, false or a list of these");
  return "";
}

std::optional<double> number_of(const toml::node* node) {
  if (node == nullptr) return std::nullopt;
  const auto value = node->value<double>();
  return value && std::isfinite(*value) ? value : std::nullopt;
}

/// Expands "{ from, to, steps }" to its values.
std::vector<std::string> steps_of(const toml::table& table, Reading& reading) {
  const auto from = number_of(table.get("from")), to = number_of(table.get("to"));
  const auto steps = table["steps"].value<std::int64_t>();
  if (!from || !to || !steps || *steps < 2 || static_cast<std::size_t>(*steps) > most_values || table.size() != 3) {
    reading.wrong(table, "expected { from = number, to = number, steps = whole number of 2 or more }");
    return {};
  }
  std::vector<std::string> values;
  for (std::int64_t i = 0; i < *steps; ++i)
    values.push_back(number_text(*from + (*to - *from) * static_cast<double>(i) / static_cast<double>(*steps - 1)));
  return values;
}

std::vector<std::string> values_of(const toml::node& node, Reading& reading) {
  if (const auto* table = node.as_table()) return steps_of(*table, reading);
  const auto* list = node.as_array();
  if (list == nullptr || list->empty() || list->size() > most_values) {
    reading.wrong(node, "expected a list of values, or { from, to, steps }");
    return {};
  }
  std::vector<std::string> values;
  for (const auto& element : *list) values.push_back(text_of(element, reading));
  if (std::set<std::string>(values.begin(), values.end()).size() != values.size())
    reading.wrong(node, "a value occurs twice");
  return values;
}

/// Visits a table whose keys may have dots, "simulation.accuracy", which TOML reads as nested tables.
template <typename Use>
void each_key(const toml::table& table, const std::string& before, const Use& use, int depth = 0) {
  for (const auto& [key, node] : in_order(table)) {
    const auto* inner = node->as_table();
    if (inner != nullptr && !inner->contains("from") && depth < 4) {
      each_key(*inner, before + key + ".", use, depth + 1);
    } else {
      use(before + key, *node);
    }
  }
}

std::vector<SweepAxis> axes_of(const toml::table& table, Reading& reading) {
  std::vector<SweepAxis> axes;
  each_key(table, "", [&](const std::string& key, const toml::node& node) {
    axes.push_back({key, values_of(node, reading)});
  });
  return axes;
}

void read_sample(const toml::table& table, Reading& reading, SweepFile& sweep) {
  const auto kind = table["kind"].value_or(std::string("latin-hypercube"));
  if (kind != "latin-hypercube" && kind != "sobol") reading.wrong(table, "kind: expected 'latin-hypercube' or 'sobol'");
  sweep.sample_kind = kind == "sobol" ? SampleKind::sobol : SampleKind::latin_hypercube;
  const auto count = table["n"].value<std::int64_t>();
  if (!count || *count < 1 || static_cast<std::size_t>(*count) > most_values)
    reading.wrong(table, "n: expected a whole number of 1 or more");
  sweep.sample_count = static_cast<std::size_t>(count.value_or(1));
  const auto seed = table["seed"].value_or<std::int64_t>(1);
  if (seed < 0) reading.wrong(table, "seed: expected 0 or more");
  sweep.sample_seed = static_cast<std::uint64_t>(std::max<std::int64_t>(seed, 0));
  if (const auto* total = table.get("total")) {
    if (!total->is_boolean() || (total->value_or(false) && kind != "sobol"))
      reading.wrong(*total, "total: expected true or false; true needs kind = \"sobol\"");
    sweep.sample_total = total->value_or(false);
  }
  const auto* ranges = table["ranges"].as_table();
  if (ranges == nullptr || ranges->empty()) reading.wrong(table, "expected ranges = { key = [low, high], ... }");
  if (ranges == nullptr) return;
  each_key(*ranges, "", [&](const std::string& key, const toml::node& node) {
    const auto* list = node.as_array();
    const auto low = list != nullptr && list->size() == 2 ? number_of(list->get(0)) : std::nullopt;
    const auto high = list != nullptr && list->size() == 2 ? number_of(list->get(1)) : std::nullopt;
    if (!low || !high || !(*high > *low)) reading.wrong(node, "expected [low, high] with low below high");
    sweep.sample.push_back({key, low.value_or(0), high.value_or(1)});
  });
  for (const auto& [key, node] : in_order(table)) {
    if (key != "kind" && key != "n" && key != "seed" && key != "ranges" && key != "total")
      reading.wrong(*node, "unknown key '" + one_line(key) + "' in [sample]");
  }
}

void read_where(const toml::node& node, Reading& reading, SweepFile& sweep) {
  std::vector<std::string> texts;
  if (const auto* one = node.as_string()) texts.push_back(one->get());
  if (const auto* list = node.as_array()) {
    for (const auto& element : *list) texts.push_back(element.value_or(std::string()));
  }
  if (texts.empty()) reading.wrong(node, "expected a condition or a list of conditions");
  for (const auto& text : texts) {
    auto constraint = Constraint::parse(text);
    if (!constraint) {
      reading.wrong(node, constraint.error().message);
      return;
    }
    sweep.where.push_back(*std::move(constraint));
  }
}

std::uint64_t whole_of(const toml::node& node, std::int64_t low, std::int64_t high, Reading& reading) {
  const auto value = node.is_integer() ? node.value<std::int64_t>() : std::nullopt;
  if (!value || *value < low || *value > high)
    reading.wrong(node, fmt::format("expected a whole number from {} to {}", low, high));
  return static_cast<std::uint64_t>(std::clamp(value.value_or(low), low, high));
}

void read_repeat(const toml::table& table, Reading& reading, SweepFile& sweep) {
  for (const auto& [key, node] : in_order(table)) {
    if (key != "seeds") {
      reading.wrong(*node, "unknown key '" + one_line(key) + "' in [repeat]");
    } else {
      sweep.repeats = whole_of(*node, 1, 1'000'000, reading);
    }
  }
}

void read_section(const std::string& key, const toml::node& node, Reading& reading, SweepFile& sweep) {
  const toml::table* table = node.as_table();
  if (table == nullptr) {
    reading.wrong(node, "expected a table [" + key + "]");
  } else if (key == "base") {
    each_key(*table, "", [&](const std::string& name, const toml::node& value) {
      sweep.base.push_back({name, text_of(value, reading)});
    });
  } else if (key == "grid") {
    sweep.grid = axes_of(*table, reading);
  } else if (key == "zip") {
    sweep.zip = axes_of(*table, reading);
    for (const auto& axis : sweep.zip) {
      if (axis.values.size() != sweep.zip.front().values.size())
        reading.wrong(node, "the lists of [zip] must have the same length: '" + axis.key + "' has another length");
    }
  } else if (key == "sample") {
    read_sample(*table, reading, sweep);
  } else {
    read_repeat(*table, reading, sweep);
  }
}

void read_entry(const std::string& key, const toml::node& node, Reading& reading, SweepFile& sweep) {
  const auto word = [&]() -> std::string {
    if (!node.is_string()) reading.wrong(node, "expected a text");
    return node.value_or(std::string());
  };
  if (key == "name") {
    sweep.name = word();
  } else if (key == "results") {
    sweep.results = sweep.folder / word();
  } else if (key == "seed") {
    sweep.seed = whole_of(node, 0, std::numeric_limits<std::int64_t>::max(), reading);
  } else if (key == "paired") {
    if (!node.is_boolean()) reading.wrong(node, "expected true or false");
    sweep.paired = node.value_or(false);
  } else if (key == "kind") {
    const std::string kind = word();
    if (kind != "simulate" && kind != "estimate" && kind != "identify")
      reading.wrong(node, "expected 'simulate', 'estimate' or 'identify'");
    sweep.kind = kind == "estimate" ? TaskKind::estimate : kind == "identify" ? TaskKind::identify : TaskKind::simulate;
  } else if (key == "where") {
    read_where(node, reading, sweep);
  } else if (key == "base" || key == "grid" || key == "zip" || key == "sample" || key == "repeat") {
    read_section(key, node, reading, sweep);
  } else {
    static const std::vector<std::string> known{"name", "seed", "paired", "kind",   "results", "where",
                                                "base", "grid", "zip",    "sample", "repeat"};
    reading.wrong(node, "unknown key '" + one_line(key) + "'" + nearest_name_hint(key, known));
  }
}

/// Returns a parameter that occurs twice.
std::optional<std::string> named_twice(const SweepFile& sweep) {
  std::set<std::string> seen;
  std::vector<std::string> all;
  for (const auto& axis : sweep.grid) all.push_back(axis.key);
  for (const auto& axis : sweep.zip) all.push_back(axis.key);
  for (const auto& range : sweep.sample) all.push_back(range.key);
  for (const auto& parameter : sweep.base) all.push_back(parameter.key);
  for (const auto& key : all) {
    if (!seen.insert(key).second) return key;
  }
  return std::nullopt;
}

}  // namespace

Result<SweepFile> parse_sweep(std::string_view text, const std::filesystem::path& file) {
  const std::string name = file.string();
  toml::table root;
  try {
    root = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    return fail(ErrorCode::invalid_input,
                fmt::format("{}:{}: {}", name, error.source().begin.line, one_line(std::string(error.description()))));
  }
  SweepFile sweep;
  std::error_code problem;
  const auto absolute = std::filesystem::absolute(file, problem);
  sweep.folder = absolute.parent_path();
  sweep.name = file.stem().string();
  sweep.results = sweep.folder / (sweep.name + ".results");
  Reading reading(name);
  for (const auto& [key, node] : in_order(root)) read_entry(key, *node, reading, sweep);
  if (reading.mistake()) return fail(ErrorCode::invalid_input, *reading.mistake());
  if (sweep.sample_total && !(sweep.grid.empty() && sweep.zip.empty() && sweep.where.empty()))
    return fail(ErrorCode::invalid_input,
                name + ": [sample] total = true cannot be combined with conditions, [grid] or [zip]");
  if (const auto key = named_twice(sweep))
    return fail(ErrorCode::invalid_input, name + ": the parameter '" + one_line(*key) + "' is stated twice");
  return sweep;
}

Result<SweepFile> read_sweep(const std::filesystem::path& file) {
  TODBENCH_TRY(const auto text, read_text_file(file));
  return parse_sweep(text, file);
}

}  // namespace todbench
