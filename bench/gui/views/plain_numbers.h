// SPDX-License-Identifier: GPL-3.0-or-later
// Number format of the window, which is the format of plans, files and reports.
#pragma once

#include <QDoubleSpinBox>

namespace todbench {

/// Sets decimals with a point, without thousands separators, in every locale. With a decimal comma, a field would
/// read "1.000" as 1000; plans, reports and the command line read it as 1. Applies to the C library too, because
/// strtod() would otherwise expect a comma in numbers of cameras and files. Call it after the application object is
/// created, because its creation sets the locale of the C library. Affects widgets created later. Window's thread.
void use_plain_numbers();

/// Number field that rejects a comma. Qt would read "1,5" as fifteen, because it treats the comma as a thousands
/// separator even if the locale rejects separators.
class PlainSpinBox final : public QDoubleSpinBox {
 public:
  using QDoubleSpinBox::QDoubleSpinBox;
  QValidator::State validate(QString& text, int& place) const override;
};

}  // namespace todbench
