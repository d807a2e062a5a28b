// SPDX-License-Identifier: GPL-3.0-or-later
// Plan in the window: as a form and as TOML, with its predicted cost.
#pragma once

#include <QObject>
#include <QString>
#include <QStringList>
#include <QTimer>
#include <vector>

#include "bench/gui/presenters/plan_preview.h"
#include "bench/gui/presenters/workbench.h"
#include "bench/plan/loaded_plan.h"

namespace todbench {

/// Choice of the user for an effect: simulate it, skip it, or let the planner decide.
enum class EffectChoice { planner, simulate, skip };
inline constexpr std::array all_effect_choices{EffectChoice::planner, EffectChoice::simulate, EffectChoice::skip};

/// Presenter of the plan of the workbench. The presenter validates every change in the same way as a plan file. Counts
/// and bench time are updated during the call. The decisions of the planner, the uncertainties and the time of the
/// simulation come from predict_plan(), which runs in the background. While a slider moves, predictions run one after
/// the other. Used in the window's thread.
class PlanPresenter final : public QObject {
  Q_OBJECT

 public:
  explicit PlanPresenter(Workbench& bench, QObject* parent = nullptr);

  /// Returns the plan of the workbench.
  [[nodiscard]] const Plan& plan() const { return bench_.plan(); }
  /// Returns the plan as TOML.
  [[nodiscard]] QString toml() const;
  /// Uses the plan, or returns an error sentence and keeps the old plan.
  [[nodiscard]] QString apply(const Plan& plan);
  /// Uses the plan as apply() does. The error also names the key.
  [[nodiscard]] Result<void> use(const Plan& plan);
  /// Uses the plan of a TOML text, or returns an error sentence and keeps the old plan.
  [[nodiscard]] QString apply_toml(const QString& text);
  /// Loads a plan by file or shipped name. Returns an error sentence; empty: success.
  [[nodiscard]] QString load(const QString& reference);
  /// Writes the plan to a file. Returns an error sentence; empty: success.
  [[nodiscard]] QString save(const QString& file) const;
  /// Sets the number of phases of camera and twin with which S75 has this uncertainty; outlook() is updated during the
  /// call. Returns an error sentence; empty: success.
  [[nodiscard]] QString set_tolerance_percent(double tolerance_percent);
  /// Adds an effect to [simulation] force or skip, or removes it from both. Returns an error sentence; empty: success.
  [[nodiscard]] QString choose(Effect effect, EffectChoice choice);
  /// Returns the choice for an effect in the current plan.
  [[nodiscard]] EffectChoice choice(Effect effect) const;

  /// Returns whether there is a change to undo. Counts all changes since the device was selected, from any source. A
  /// movement of a slider is one change.
  [[nodiscard]] bool can_undo() const { return !undone_to_.empty(); }
  /// Returns whether there is an undone change to repeat.
  [[nodiscard]] bool can_redo() const { return !redone_to_.empty(); }
  /// Restores the plan before the last change.
  void undo();
  /// Repeats the change that was undone last.
  void redo();

  /// Returns counts, bench time and uncertainties of the current plan, updated with every change.
  [[nodiscard]] const PlanPreview& outlook() const { return outlook_; }
  /// Returns whether the thresholds of the direct estimate are known.
  [[nodiscard]] bool expected_known() const { return !expected_.empty(); }
  /// Returns the thresholds of the direct estimate; empty until they are known.
  [[nodiscard]] const std::vector<ExpectedThreshold>& expected() const { return expected_; }
  /// Returns the prediction for the current plan, or for the previous plan until the new prediction is complete. Empty
  /// before the first prediction, and after a change of a value other than tolerance and phases.
  [[nodiscard]] const std::optional<PlanForecast>& forecast() const { return forecast_; }
  /// Returns whether the prediction belongs to the current plan.
  [[nodiscard]] bool forecast_current() const { return forecast_ && forecast_->plan == bench_.plan(); }
  /// Returns the cost of each accuracy, starting with the finest; empty until computed.
  [[nodiscard]] const std::vector<AccuracyPrice>& prices() const { return prices_; }
  /// Returns a conflict in a plan whose file is valid: sizes that cannot be measured at this distance, or a tolerance
  /// that cannot be met. Empty: none.
  [[nodiscard]] QString misfit() const;
  /// Returns the messages of the planner other than its decisions.
  [[nodiscard]] QStringList warnings() const;

 signals:
  /// The plan or a value derived from it changed.
  void updated();

 private:
  /// Kind of a change of the plan, for undo.
  enum class Change { single, sliding, travel };

  Result<void> take(const Result<LoadedPlan>& loaded, Change change = Change::single);
  void keep_last();
  void travel(std::vector<Plan>& to, std::vector<Plan>& from);
  void plan_changed();
  void foresee();
  void look_ahead();
  void refresh();

  Workbench& bench_;
  QTimer delay_;
  std::vector<ExpectedThreshold> expected_;
  std::optional<LoadedPlan> loaded_;  ///< the plan with its parts; empty while a part cannot be read
  PlanPreview outlook_;
  std::optional<PlanForecast> forecast_;
  std::vector<AccuracyPrice> prices_;
  QString misfit_, trouble_;
  std::optional<Plan> expected_of_, prices_of_;
  std::vector<Plan> undone_to_, redone_to_;  ///< the last element is the next to be restored
  Plan last_;                                ///< plan before the current change
  Change change_ = Change::single, last_change_ = Change::single;
  EffectPlanner planner_;  // of both jobs
  JobRunner forecasts_, jobs_;
};

}  // namespace todbench
