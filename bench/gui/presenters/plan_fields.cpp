// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/plan_fields.h"

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "bench/gui/presenters/text_of.h"
#include "bench/plan/plan_keys.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {
namespace {

QString with_unit(const QString& words, std::string_view unit) {
  return words + (unit.empty() ? QString() : " (" + text_of(unit) + ")");
}

QStringList list_of(const std::vector<std::string>& words) {
  QStringList out;
  for (const std::string& word : words) out << QString::fromStdString(word);
  return out;
}

QString with_full_stop(const QString& text) {
  return text.endsWith('.') ? text : text + ".";
}

QString tool_tip_of(const KeyAt& at) {
  const QString takes = QString::fromStdString(expected_of(at.key->type));
  const QString standard = QString::fromStdString(plain_text(at.key->type, default_of(at)));
  return with_full_stop(text_of(at.key->sentence)) + " Value: " + takes +
         (standard.isEmpty() ? "" : "; default " + standard);
}

/// Sets a text in the plan; returns an error if it is not a value of the key.
QString enter(const KeyAt& at, Plan& plan, const QString& text) {
  const auto value = value_from_text(type_in(*at.key, plan), text.toStdString());
  if (!value) return text_of(at.key->name) + ": " + QString::fromStdString(value.error().message);
  at.key->place.set(plan, at.row, *value);
  return {};
}

QString shown_value(const KeyAt& at, const Plan& plan) {
  return QString::fromStdString(plain_text(at.key->type, at.key->place.get(plan, at.row)));
}

/// Sets the kind of input for the type of a key.
struct AskFor {
  PlanField& field;
  const PlanKey& key;

  void operator()(const TextKey&) const { field.kind = FieldKind::text; }
  void operator()(const FlagKey&) const { field.kind = FieldKind::yes_no; }
  void operator()(const NumberKey&) const { field.kind = FieldKind::number; }
  void operator()(const OptionalNumberKey&) const {
    field.kind = FieldKind::number;
    field.when_empty = "none";
  }
  void operator()(const NumberOrWordKey& type) const {
    field.kind = FieldKind::name;
    field.words = {text_of(type.word)};
  }
  void operator()(const WholeKey& type) const {
    field.kind = FieldKind::whole;
    field.low = static_cast<int>(type.low);
    field.high = static_cast<int>(std::min<std::int64_t>(type.high, std::numeric_limits<int>::max()));
  }
  void operator()(const WholesKey&) const { field.kind = FieldKind::text; }
  void operator()(const ChoiceKey& type) const {
    field.kind = FieldKind::choice;
    field.words = list_of(type.words);
  }
  void operator()(const NumbersKey& type) const {
    // A fixed number of values is written in one line; otherwise the field has rows to add and remove.
    if (type.count) return;
    field.kind = FieldKind::rows;
    const QString noun = text_of(type.noun);
    field.columns = {{with_unit(noun.left(1).toUpper() + noun.mid(1), key.unit), {}}};
  }
  void operator()(const ChoicesKey& type) const {
    field.kind = FieldKind::boxes;
    field.words = list_of(type.words);
  }
  void operator()(const ResourceKey& type) const {
    field.words = list_of(resource_names(type.kind));
    field.kind = field.words.isEmpty() ? FieldKind::file : FieldKind::name;
    if (field.words.isEmpty()) field.when_empty = "none";
  }
  void operator()(const ResourcesKey& type) const {
    field.kind = FieldKind::rows;
    field.columns = {{"Name or file", list_of(resource_names(type.kind))}};
  }
  void operator()(const FreeTableKey&) const {
    field.kind = FieldKind::rows;
    field.columns = {{"Feature", {}}, {"Value", {}}};
  }
};

QString free_table_shown(const KeyAt& at, const Plan& plan) {
  const KeyValue value = at.key->place.get(plan, at.row);
  std::vector<QStringList> rows;
  for (const auto& [name, text] : std::get<std::map<std::string, std::string>>(value))
    rows.push_back({QString::fromStdString(name), QString::fromStdString(text)});
  return text_of_rows(rows);
}

QString enter_free_table(const KeyAt& at, Plan& plan, const QString& text) {
  std::map<std::string, std::string> table;
  for (const QStringList& row : rows_of_text(text)) {
    if (row.size() > 2) return "'" + row.join(": ") + "' has more values than a name and its value";
    if (row.front().isEmpty()) return "a value has no name";
    table[row.front().toStdString()] = row.value(1).toStdString();
  }
  at.key->place.set(plan, at.row, KeyValue(table));
  return {};
}

/// "target" -> "Target", "limits.zone" -> "Limits".
QString heading_of(const PlanSection& section) {
  if (section.name.empty()) return "Names";
  QString name = text_of(section.name).section('.', 0, 0);
  if (name == "instrument") return "Instruments";
  if (name == "uncertainty") return "Uncertainty budget";
  return name.left(1).toUpper() + name.mid(1);
}

PlanField field_of(const KeyAt& at) {
  PlanField field{.label = with_unit(text_of(at.key->form.label), at.key->unit),
                  .tool_tip = tool_tip_of(at),
                  .object_name = text_of(at.key->form.object_name)};
  std::visit(AskFor{field, *at.key}, at.key->type);
  field.paths = {path_of(*at.section, *at.key)};
  field.shown = [at](const Plan& plan) { return shown_value(at, plan); };
  field.entered = [at](Plan& plan, const QString& text) { return enter(at, plan, text); };
  field.section = heading_of(*at.section);
  if (std::holds_alternative<FreeTableKey>(at.key->type)) {
    field.shown = [at](const Plan& plan) { return free_table_shown(at, plan); };
    field.entered = [at](Plan& plan, const QString& text) { return enter_free_table(at, plan, text); };
  }
  return field;
}

/// Returns the section with one row per element of a key, if there is one.
const PlanSection* section_beside(std::string_view path) {
  for (const PlanSection& section : plan_sections()) {
    if (section.form.beside == path) return &section;
  }
  return nullptr;
}

double first_of(const PlanSection& section, const Plan& plan, std::size_t row) {
  return std::get<double>(section.keys.front().place.get(plan, row));
}

std::optional<std::size_t> row_at(const PlanSection& section, const Plan& plan, double element) {
  for (std::size_t row = 0; row < section.count(plan); ++row) {
    if (same_contrast(first_of(section, plan, row), element)) return row;
  }
  return std::nullopt;
}

QString rows_shown(const KeyAt& list, const PlanSection& section, const Plan& plan) {
  QStringList rows;
  const KeyValue value = list.key->place.get(plan, 0);
  const QStringList elements = shown_value(list, plan).split(", ", Qt::SkipEmptyParts);
  const auto& numbers = std::get<std::vector<double>>(value);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    QStringList values{elements.value(static_cast<qsizetype>(i))};
    const auto row = row_at(section, plan, numbers[i]);
    for (std::size_t k = 1; k < section.keys.size(); ++k)
      values << (row ? shown_value({&section, &section.keys[k], *row}, plan) : QString());
    rows << values.join(": ");
  }
  return rows.join(", ");
}

/// Sets the rows of elements with values; rows of removed elements are removed too.
QString enter_rows(const KeyAt& list, const PlanSection& section, Plan& plan, const QString& text) {
  Plan changed = plan;
  QStringList elements;
  std::vector<QStringList> rows;
  for (const QString& row : text.split(',', Qt::SkipEmptyParts)) {
    QStringList values;
    for (const QString& value : row.split(':')) values << value.trimmed();
    if (values.size() > static_cast<qsizetype>(section.keys.size()))
      return "'" + row.trimmed() + "' has more values than the table has columns";
    elements << values.front();
    rows.push_back(std::move(values));
  }
  if (const QString wrong = enter(list, changed, elements.join(", ")); !wrong.isEmpty()) return wrong;
  const KeyValue value = list.key->place.get(changed, 0);
  const auto& numbers = std::get<std::vector<double>>(value);
  section.rows.resize(changed, 0);
  for (std::size_t i = 0; i < rows.size() && i < numbers.size(); ++i) {
    if (std::all_of(rows[i].begin() + 1, rows[i].end(), [](const QString& v) { return v.isEmpty(); })) continue;
    const std::size_t row = section.count(changed);
    section.rows.resize(changed, row + 1);
    // An existing row keeps the number as it was written.
    const auto before = row_at(section, plan, numbers[i]);
    section.keys.front().place.set(changed, row, KeyValue(before ? first_of(section, plan, *before) : numbers[i]));
    for (std::size_t k = 1; k < section.keys.size(); ++k) {
      const KeyAt at{&section, &section.keys[k], row};
      const QString wrong = enter(at, changed, rows[i].value(static_cast<qsizetype>(k)));
      if (!wrong.isEmpty()) return elements[static_cast<qsizetype>(i)] + ": " + wrong;
    }
  }
  plan = changed;
  return {};
}

/// A list and its section as one table.
PlanField field_of(const KeyAt& list, const PlanSection& section) {
  PlanField field = field_of(list);
  field.tool_tip = with_full_stop(field.tool_tip) + " Next column: " + with_full_stop(text_of(section.sentence)) +
                   " An empty cell sets no limit.";
  for (std::size_t k = 1; k < section.keys.size(); ++k)
    field.columns.push_back({with_unit(text_of(section.form.label), section.keys[k].unit), {}});
  for (const PlanKey& key : section.keys) field.paths.push_back(path_of(section, key));
  field.shown = [list, &section](const Plan& plan) { return rows_shown(list, section, plan); };
  field.entered = [list, &section](Plan& plan, const QString& text) { return enter_rows(list, section, plan, text); };
  return field;
}

/// A name of a key as a column heading with its unit: "At least", "Delta t (K)".
QString column_head(const PlanKey& key) {
  QString words = text_of(key.name);
  if (const QString unit = "_" + text_of(key.unit).toLower(); words.endsWith(unit)) words.chop(unit.size());
  words.replace('_', ' ');
  return with_unit(words.left(1).toUpper() + words.mid(1), key.unit);
}

QString longest_of(const KeyType& type) {
  if (const auto* numbers = std::get_if<NumbersKey>(&type))
    return QStringList(static_cast<qsizetype>(numbers->count.value_or(1)), "0.25").join(", ");
  if (std::holds_alternative<TextKey>(type)) return "temporal_noise";
  return "0.0000";
}

QString table_shown(const PlanSection& section, const Plan& plan) {
  std::vector<QStringList> rows;
  for (std::size_t row = 0; row < section.count(plan); ++row) {
    QStringList values;
    for (const PlanKey& key : section.keys) values << shown_value({&section, &key, row}, plan);
    rows.push_back(std::move(values));
  }
  return text_of_rows(rows);
}

QString enter_table(const PlanSection& section, Plan& plan, const QString& text) {
  Plan changed = plan;
  const std::vector<QStringList> rows = rows_of_text(text);
  section.rows.resize(changed, 0);
  section.rows.resize(changed, rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].size() > static_cast<qsizetype>(section.keys.size()))
      return "'" + rows[i].join(": ") + "' has more values than the table has columns";
    for (std::size_t k = 0; k < section.keys.size(); ++k) {
      const QString value = rows[i].value(static_cast<qsizetype>(k));
      // A new row has the defaults.
      if (value.isEmpty() && section.keys[k].required != Required::always) continue;
      const QString wrong = enter({&section, &section.keys[k], i}, changed, value);
      if (!wrong.isEmpty()) return wrong;
    }
  }
  plan = changed;
  return {};
}

/// The rows of a repeated section as a separate table.
PlanField field_of(const PlanSection& section) {
  PlanField field{.label = text_of(section.form.label),
                  .tool_tip = text_of(section.sentence),
                  .object_name = text_of(section.form.object_name)};
  field.kind = FieldKind::rows;
  for (const PlanKey& key : section.keys) {
    const auto* choice = std::get_if<ChoiceKey>(&key.type);
    field.columns.push_back({column_head(key), choice ? list_of(choice->words) : QStringList{},
                             section.keys.size() > most_columns_beside ? longest_of(key.type) : QString()});
    field.paths.push_back(path_of(section, key));
  }
  field.shown = [&section](const Plan& plan) { return table_shown(section, plan); };
  field.entered = [&section](Plan& plan, const QString& text) { return enter_table(section, plan, text); };
  field.section = heading_of(section);
  return field;
}

}  // namespace

QString text_of_rows(const std::vector<QStringList>& rows) {
  QStringList lines;
  for (const QStringList& row : rows) {
    QStringList values;
    for (const QString& value : row) {
      const bool plain = !value.contains(',') && !value.contains(':') && !value.contains('"');
      values << (plain ? value : '"' + QString(value).replace("\"", "\"\"") + '"');
    }
    lines << values.join(": ");
  }
  return lines.join(", ");
}

std::vector<QStringList> rows_of_text(const QString& text) {
  std::vector<QStringList> rows;
  QString value;
  bool quoted = false, empty = true;  // `empty`: the row has no content yet
  QStringList row;
  const auto end_value = [&] {
    row << value.trimmed();
    value.clear();
  };
  const auto end_row = [&] {
    end_value();
    if (!empty) rows.push_back(row);
    row.clear(), empty = true;
  };
  for (qsizetype i = 0; i < text.size(); ++i) {
    const QChar c = text[i];
    if (!quoted && c == ',') {
      end_row();
      continue;
    }
    empty = empty && c.isSpace();
    if (c == '"' && quoted && text.mid(i + 1, 1) == "\"") {
      value += text[++i];
    } else if (c == '"' && (quoted || value.trimmed().isEmpty())) {
      quoted = !quoted;
    } else if (!quoted && c == ':') {
      end_value();
    } else {
      value += c;
    }
  }
  end_row();
  return rows;
}

namespace {

/// Whether a key of [measures] belongs only to measures that are off.
bool of_measure_that_is_off(std::string_view path, const MeasuresPlan& measures) {
  constexpr std::string_view section = "measures.";
  if (!path.starts_with(section)) return false;
  const std::string_view key = path.substr(section.size());
  if (key == "noise_frames") return !measures.noise && !measures.pixels;
  if (key.starts_with("response_")) return !measures.response && !measures.gain_control;
  return std::ranges::any_of(measure_keys, [&](const MeasureKey& measure) {
    return key.size() > measure.name.size() && key.starts_with(measure.name) && key[measure.name.size()] == '_' &&
           !(measures.*measure.requested);
  });
}

}  // namespace

QString idle_reason(const PlanField& field, const Plan& plan) {
  const std::string path = field.paths.empty() ? std::string() : field.paths.front();
  const auto is_one_of = [&path](std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), path) != names.end();
  };
  const TargetKind kind = plan.target.kind;
  if (kind != TargetKind::scpi && is_one_of({"target.black_body", "target.stage", "target.black_body_table",
                                             "target.stage_table", "target.settle_timeout_s"}))
    return "No effect: only a target of kind 'scpi' has instruments.";
  if (kind != TargetKind::display && path.starts_with("target.display"))
    return "No effect: only a target of kind 'display' has a monitor.";
  if (plan.schedule.kind != ScheduleKind::adaptive &&
      is_one_of({"schedule.half_width_percent", "schedule.max_presentations"}))
    return "No effect: only a schedule of kind 'adaptive' ends at a half-width.";
  if (plan.target.air_humidity_percent <= 0 && path == "target.air_temperature_c")
    return "No effect until the humidity of the air is stated.";
  if (plan.camera.nuc_interval_s <= 0 && path == "camera.nuc_command")
    return "No effect: no correction is commanded (nuc_interval_s is 0).";
  if (of_measure_that_is_off(path, plan.measures)) return "No effect: the measure is off.";
  return {};
}

std::vector<PlanField> plan_fields() {
  std::vector<PlanField> fields;
  for (const PlanSection& section : plan_sections()) {
    for (const PlanKey& key : section.keys) {
      if (key.form.label.empty()) continue;
      const KeyAt at{&section, &key, 0};
      const PlanSection* beside = section_beside(path_of(section, key));
      fields.push_back(beside != nullptr ? field_of(at, *beside) : field_of(at));
    }
    if (section.repeated() && !section.form.label.empty() && section.form.beside.empty())
      fields.push_back(field_of(section));
  }
  return fields;
}

}  // namespace todbench
