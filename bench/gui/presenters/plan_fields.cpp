#include "bench/gui/presenters/plan_fields.h"

#include <QStringList>

#include "bench/plan/plan_keys.h"

namespace todbench {
namespace {

QString text_of(std::string_view text) {
  return QString::fromUtf8(text.data(), static_cast<qsizetype>(text.size()));
}

QString label_of(const FormLine& form, std::string_view unit) {
  return text_of(form.label) + (unit.empty() ? QString() : " (" + text_of(unit) + ")");
}

QString tool_tip_of(const KeyAt& at) {
  const QString takes = QString::fromStdString(expected_of(at.key->type));
  const QString standard = QString::fromStdString(plain_text(at.key->type, default_of(at)));
  return text_of(at.key->sentence) + ". Takes " + takes + (standard.isEmpty() ? "" : "; default " + standard);
}

/// Why a text is no value of a key; otherwise it is in the plan.
QString enter(const KeyAt& at, Plan& plan, const QString& text) {
  const auto value = value_from_text(type_in(*at.key, plan), text.toStdString());
  if (!value) return text_of(at.key->name) + ": " + QString::fromStdString(value.error().message);
  at.key->place.set(plan, at.row, *value);
  return {};
}

PlanField field_of(const KeyAt& at) {
  return {.label = label_of(at.key->form, at.key->unit),
          .tool_tip = tool_tip_of(at),
          .object_name = text_of(at.key->form.object_name),
          .shown =
              [at](const Plan& plan) {
                return QString::fromStdString(plain_text(at.key->type, at.key->place.get(plan, at.row)));
              },
          .entered = [at](Plan& plan, const QString& text) { return enter(at, plan, text); }};
}

/// The values of a row, joined as the form shows them.
QString row_text(const PlanSection& section, const Plan& plan, std::size_t row) {
  QStringList values;
  for (const PlanKey& key : section.keys)
    values << QString::fromStdString(plain_text(key.type, key.place.get(plan, row)));
  return values.join(": ");
}

QString rows_text(const PlanSection& section, const Plan& plan) {
  QStringList rows;
  for (std::size_t row = 0; row < section.count(plan); ++row) rows << row_text(section, plan, row);
  return rows.join(", ");
}

QString enter_rows(const PlanSection& section, Plan& plan, const QString& text) {
  Plan changed = plan;
  const QStringList rows = text.split(',', Qt::SkipEmptyParts);
  section.rows.resize(changed, 0);
  section.rows.resize(changed, static_cast<std::size_t>(rows.size()));
  for (qsizetype row = 0; row < rows.size(); ++row) {
    const QStringList values = rows[row].split(':');
    if (values.size() != static_cast<qsizetype>(section.keys.size()))
      return "'" + rows[row].trimmed() + "' is not '" + text_of(section.form.label) + "'";
    for (qsizetype i = 0; i < values.size(); ++i) {
      const KeyAt at{&section, &section.keys[static_cast<std::size_t>(i)], static_cast<std::size_t>(row)};
      if (const QString wrong = enter(at, changed, values[i].trimmed()); !wrong.isEmpty()) return wrong;
    }
  }
  plan = changed;
  return {};
}

PlanField field_of(const PlanSection& section) {
  return {.label = text_of(section.form.label),
          .tool_tip = text_of(section.sentence),
          .object_name = text_of(section.form.object_name),
          .shown = [&section](const Plan& plan) { return rows_text(section, plan); },
          .entered = [&section](Plan& plan, const QString& text) { return enter_rows(section, plan, text); }};
}

}  // namespace

std::vector<PlanField> plan_fields() {
  std::vector<PlanField> fields;
  for (const PlanSection& section : plan_sections()) {
    if (!section.form.label.empty()) fields.push_back(field_of(section));
    for (const PlanKey& key : section.keys) {
      if (!key.form.label.empty()) fields.push_back(field_of({&section, &key, 0}));
    }
  }
  return fields;
}

}  // namespace todbench
