// SPDX-License-Identifier: GPL-3.0-or-later
// Number format of the window: that of plans, files and reports.
#pragma once

#include <QDoubleSpinBox>

namespace todbench {

/// Sets decimals with a point, without thousands separators, in every locale: with a decimal comma, "1.000" in a field
/// would be a thousand, but one in plans, reports and the command line. Applies to the C library too, because strtod()
/// on numbers of cameras and files would expect a comma. Call it after the application object exists, which sets the
/// locale of the C library. Affects widgets created later. Window's thread.
void use_plain_numbers();

/// A number field that rejects a comma: Qt reads "1,5" as fifteen, because it takes the comma as a thousands separator
/// even if its locale rejects these.
class PlainSpinBox final : public QDoubleSpinBox {
 public:
  using QDoubleSpinBox::QDoubleSpinBox;
  QValidator::State validate(QString& text, int& place) const override;
};

}  // namespace todbench
