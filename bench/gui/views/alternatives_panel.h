// SPDX-License-Identifier: GPL-3.0-or-later
// Alternatives of a question as icons; each is a button with its key.
#pragma once

#include <QWidget>
#include <string>
#include <vector>

#include "bench/studies/person_experiment.h"

class QGridLayout;
class QToolButton;

namespace todbench {

/// Panel of the alternatives.
class AlternativesPanel final : public QWidget {
  Q_OBJECT

 public:
  explicit AlternativesPanel(QWidget* parent = nullptr);
  /// Shows the alternatives of an experiment.
  void set_alternatives(const PersonExperiment& experiment);
  /// Removes all alternatives.
  void clear();
  /// Returns the alternative of a key: 1 to 9, then letters; arrow keys for two alternatives. -1: none.
  [[nodiscard]] int of_key(int key) const;

 signals:
  void chosen(int alternative);

 private:
  QGridLayout* grid_;
  std::vector<QToolButton*> buttons_;
};

}  // namespace todbench
