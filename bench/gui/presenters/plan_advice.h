// SPDX-License-Identifier: GPL-3.0-or-later
// Estimates about the display and the simulated sensor of a plan, as text: factors that limit the acuity, zoom and
// distance.
#pragma once

#include <QObject>
#include <QString>
#include <functional>
#include <stop_token>

#include "acquisition/base/result.h"
#include "bench/gui/presenters/job_runner.h"
#include "bench/plan/plan.h"

namespace todbench {

inline constexpr const char* no_display_sentence =
    "The plan has no section [display]: state the pixel pitch, distance and luminances.";

/// Compares zooms and viewing distances for hvs-2 at the display and at the largest contrast of the plan. Errors:
/// `invalid_input` without a display or with modules, those of the loaders and of propose_viewing().
[[nodiscard]] Result<QString> viewing_advice(const Plan& plan, const std::stop_token& stop);

/// Returns an HTML table with the cost of each limiting factor (acuity_limits()) at each contrast of the plan. Uses the
/// observer of the plan, or hvs-2 if the plan has a display and its observer has no eye. Errors: those of the loaders
/// and of acuity_limits().
[[nodiscard]] Result<QString> limits_advice(const Plan& plan, const std::stop_token& stop);

/// Estimate on its own thread. Used in the thread of the window.
class PlanAdvice final : public QObject {
  Q_OBJECT

 public:
  using Estimate = std::function<Result<QString>(const Plan&, const std::stop_token&)>;
  /// `running`: text of words() while the estimate runs.
  PlanAdvice(Estimate estimate, QString running, QObject* parent = nullptr);

  /// Starts the estimate for this plan; a later call replaces an earlier one.
  void ask(const Plan& plan);
  /// Ends a running estimate.
  void stop();
  /// Returns whether the estimate runs.
  [[nodiscard]] bool busy() const { return busy_; }
  /// Returns the result, an error sentence, or a sentence that the estimate runs or was stopped. Empty before the first
  /// estimate.
  [[nodiscard]] const QString& words() const { return words_; }

 signals:
  void updated();

 private:
  void take(int number, const QString& words);

  Estimate estimate_;
  QString running_, words_;
  bool busy_ = false;
  int number_ = 0;
  JobRunner jobs_;
};

}  // namespace todbench
