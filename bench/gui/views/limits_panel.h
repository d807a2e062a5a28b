// SPDX-License-Identifier: GPL-3.0-or-later
// Factors that limit the acuity at the display of the plan, on the page Human observer before the first answer.
#pragma once

#include <QWidget>
#include <optional>

#include "bench/plan/plan.h"

class QLabel;
class QPushButton;

namespace todbench {

class PlanAdvice;
class Workbench;

/// Panel that computes limits_advice() while it is visible, and again after a change of the plan. Hiding the panel
/// stops the calculation, so it does not delay the pictures that a person judges.
class LimitsPanel final : public QWidget {
  Q_OBJECT

 public:
  explicit LimitsPanel(Workbench& bench, QWidget* parent = nullptr);
  /// Sets the plan whose limits are shown. Empty: the plan of the workbench.
  void set_replayed_plan(std::optional<Plan> plan);

 protected:
  void showEvent(QShowEvent* event) override;
  void hideEvent(QHideEvent* event) override;

 private:
  void follow_plan();
  void ask();
  void show_advice();

  [[nodiscard]] const Plan& plan() const;

  Workbench& bench_;
  std::optional<Plan> replayed_;
  PlanAdvice* advice_;
  QLabel* text_;
  QPushButton* button_;        ///< stops the calculation, or starts it again after it was stopped
  std::optional<Plan> asked_;  ///< the plan of the text or of the running calculation
  bool stopped_ = false;       ///< the user stopped the calculation
};

}  // namespace todbench
