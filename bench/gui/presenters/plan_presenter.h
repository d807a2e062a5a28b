// SPDX-License-Identifier: GPL-3.0-or-later
// The plan as a form and as TOML, with its predicted cost.
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

/// Decides whether an effect is simulated.
enum class EffectChoice { planner, simulate, skip };
inline constexpr std::array all_effect_choices{EffectChoice::planner, EffectChoice::simulate, EffectChoice::skip};

/// Validates every change like a file. Counts and bench time are updated in the call. The planner's decisions,
/// uncertainties and the time of the simulation come from predict_plan() in the background, one after the other while a
/// slider moves. Used in the window's thread.
class PlanPresenter final : public QObject {
  Q_OBJECT

 public:
  explicit PlanPresenter(Workbench& bench, QObject* parent = nullptr);

  [[nodiscard]] const Plan& plan() const { return bench_.plan(); }
  [[nodiscard]] QString toml() const;
  /// Accepts the plan, or returns an error sentence and keeps the old one.
  [[nodiscard]] QString apply(const Plan& plan);
  /// The same, but the error also names the key.
  [[nodiscard]] Result<void> use(const Plan& plan);
  [[nodiscard]] QString apply_toml(const QString& text);
  /// Loads a file or a shipped plan by name.
  [[nodiscard]] QString load(const QString& reference);
  [[nodiscard]] QString save(const QString& file) const;
  /// Sets the number of phases for camera and twin that gives this uncertainty of S75; the outlook follows at once.
  [[nodiscard]] QString set_tolerance_percent(double tolerance_percent);
  /// Adds an effect to [simulation] force or skip, or removes it from both.
  [[nodiscard]] QString choose(Effect effect, EffectChoice choice);
  [[nodiscard]] EffectChoice choice(Effect effect) const;

  /// Changes of the plan from all sources since the device was chosen; one movement of the slider is one change.
  [[nodiscard]] bool can_undo() const { return !undone_to_.empty(); }
  [[nodiscard]] bool can_redo() const { return !redone_to_.empty(); }
  void undo();
  void redo();

  [[nodiscard]] const PlanPreview& outlook() const { return outlook_; }
  /// False until the thresholds of the direct estimate are known.
  [[nodiscard]] bool expected_known() const { return !expected_.empty(); }
  [[nodiscard]] const std::vector<ExpectedThreshold>& expected() const { return expected_; }
  /// Of this plan, or of the last one until the new forecast is complete; empty before the first.
  [[nodiscard]] const std::optional<PlanForecast>& forecast() const { return forecast_; }
  [[nodiscard]] bool forecast_current() const { return forecast_ && forecast_->plan == bench_.plan(); }
  /// Cost by accuracy, from the finest; empty until known.
  [[nodiscard]] const std::vector<AccuracyPrice>& prices() const { return prices_; }
  /// Conflicts in a plan whose file is valid: sizes that cannot be measured at this distance, a tolerance that cannot
  /// be met.
  [[nodiscard]] QString misfit() const;
  /// Messages of the planner apart from its decisions.
  [[nodiscard]] QStringList warnings() const;

 signals:
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
  std::optional<LoadedPlan> loaded_;  ///< of the plan; empty while a part of it cannot be read
  PlanPreview outlook_;
  std::optional<PlanForecast> forecast_;
  std::vector<AccuracyPrice> prices_;
  QString misfit_, trouble_;
  std::optional<Plan> expected_of_, prices_of_;
  std::vector<Plan> undone_to_, redone_to_;  ///< the last element is the next one
  Plan last_;                                ///< before the present change
  Change change_ = Change::single, last_change_ = Change::single;
  EffectPlanner planner_;  // of both jobs
  JobRunner forecasts_, jobs_;
};

}  // namespace todbench
