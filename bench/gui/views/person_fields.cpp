// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/person_fields.h"

#include <QFormLayout>
#include <QLineEdit>
#include <QLocale>
#include <QSpinBox>
#include <utility>

namespace todbench {

PersonFields::PersonFields(QFormLayout& form, QObject* parent) : QObject(parent), form_(form) {
  const auto line = [&form](const QString& label, const char* name, const QString& tool_tip) {
    auto* edit = new QLineEdit;
    edit->setObjectName(name);
    edit->setToolTip(tool_tip);
    edit->setAccessibleName(label);
    form.addRow(label, edit);
    return edit;
  };
  code_ = line("Person", "personCode", "A code will do: the person decides whether a name is stored");
  age_ = line("Age (years)", "personAge", "May be empty");
  acuity_ =
      line("Acuity (decimal)", "personAcuity", "Visual acuity with the correction worn now, 1.0 is 6/6; may be empty");
  distance_ = line("Distance (m)", "personDistance", "From the eye to the screen; may be empty");
  screen_ = line("Screen", "personScreen", "Maker and model; may be empty");
  luminance_ = line("White (cd/m²)", "personLuminance", "Luminance of the white of the screen; may be empty");
  training_ = new QSpinBox;
  training_->setObjectName("humanTraining");
  training_->setRange(0, 200);
  training_->setToolTip("Patches with feedback before the answers count. They are not stored.");
  form.addRow("Training", training_);
}

void PersonFields::set_training_visible(bool visible) {
  form_.setRowVisible(training_, visible);
}

Result<PersonFacts> PersonFields::facts() const {
  PersonFacts facts;
  facts.code = code_->text().trimmed().toStdString();
  facts.screen = screen_->text().trimmed().toStdString();
  for (const auto& [edit, value] :
       {std::pair(age_, &facts.age_years), std::pair(acuity_, &facts.acuity_decimal),
        std::pair(distance_, &facts.distance_m), std::pair(luminance_, &facts.luminance_cd_m2)}) {
    const QString text = edit->text().trimmed();
    if (text.isEmpty()) continue;
    bool good = false;
    const double number = QLocale::c().toDouble(text, &good);
    if (!good || !(number > 0))
      return fail(ErrorCode::invalid_input,
                  (edit->accessibleName() + ": expected a number above 0 with a decimal point, found '" + text + "'")
                      .toStdString());
    *value = number;
  }
  return facts;
}

int PersonFields::training() const {
  return training_->value();
}

}  // namespace todbench
