// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of a form with the facts about a person.
#pragma once

#include <QObject>

#include "acquisition/base/result.h"
#include "bench/session/human_record.h"

class QFormLayout;
class QLineEdit;
class QSpinBox;

namespace todbench {

/// Rows of the facts about a person.
class PersonFields final : public QObject {
  Q_OBJECT

 public:
  /// Adds the rows to the form, which must outlive this object.
  PersonFields(QFormLayout& form, QObject* parent);

  /// Shows or hides the row of the training, which only questions about frames use.
  void set_training_visible(bool visible);
  /// Returns the facts as entered. Errors: `invalid_input` for a value that is not a number above 0.
  [[nodiscard]] Result<PersonFacts> facts() const;
  /// Returns the number of patches with feedback before the answers count.
  [[nodiscard]] int training() const;

 private:
  QFormLayout& form_;
  QLineEdit *code_, *age_, *acuity_, *distance_, *screen_, *luminance_;
  QSpinBox* training_;
};

}  // namespace todbench
