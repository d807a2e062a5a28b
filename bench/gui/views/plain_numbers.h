// Numbers of the window: those of plans, files and reports.
#pragma once

#include <QDoubleSpinBox>

namespace todbench {

/// Decimals with a point, no separators of thousands, whatever the user's locale: where a comma is the decimal sign,
/// "1.000" typed into a field would be a thousand, while plans, reports and the command line mean one. For the C
/// library too, because what reads the numbers of cameras and files with strtod() would expect a comma. To be called
/// once an application is there, which sets the locale of the C library. Of widgets that are made later. Thread: that
/// of the window.
void use_plain_numbers();

/// A field of a number that takes no comma: Qt reads one as a separator of thousands even where its locale rejects
/// them, and so "1,5" as fifteen.
class PlainSpinBox final : public QDoubleSpinBox {
 public:
  using QDoubleSpinBox::QDoubleSpinBox;
  QValidator::State validate(QString& text, int& place) const override;
};

}  // namespace todbench
