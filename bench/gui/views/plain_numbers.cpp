// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/plain_numbers.h"

#include <QLocale>
#include <clocale>

namespace todbench {

void use_plain_numbers() {
  std::setlocale(LC_NUMERIC, "C");
  QLocale plain = QLocale::c();
  plain.setNumberOptions(QLocale::OmitGroupSeparator | QLocale::RejectGroupSeparator);
  QLocale::setDefault(plain);
}

QValidator::State PlainSpinBox::validate(QString& text, int& place) const {
  return text.contains(',') ? QValidator::Invalid : QDoubleSpinBox::validate(text, place);
}

}  // namespace todbench
