// SPDX-License-Identifier: GPL-3.0-or-later
// Proposes zoom and viewing distance for the display and the simulated sensor of a plan.
#pragma once

#include <QObject>
#include <QString>

#include "bench/gui/presenters/job_runner.h"
#include "bench/plan/plan.h"

namespace todbench {

inline constexpr const char* no_display_sentence =
    "The plan has no section [display]: state the pixel pitch, distance and luminances.";

/// Used in the thread of the window. The estimates run on another thread.
class ViewingPresenter final : public QObject {
  Q_OBJECT

 public:
  explicit ViewingPresenter(QObject* parent = nullptr);

  /// Compares viewing distances for hvs-2 at the display and at the largest contrast of the plan. A later call replaces
  /// an earlier one.
  void propose(const Plan& plan);
  [[nodiscard]] bool busy() const { return busy_; }
  /// The proposal, or why there is none; empty before the first one.
  [[nodiscard]] const QString& words() const { return words_; }

 signals:
  void updated();

 private:
  void take(int number, const QString& words);

  QString words_;
  bool busy_ = false;
  int number_ = 0;
  JobRunner jobs_;
};

}  // namespace todbench
