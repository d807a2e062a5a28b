// The plan as a form and as TOML, and what it will cost.
#pragma once

#include <QObject>
#include <QString>
#include <QStringList>
#include <QTimer>
#include <vector>

#include "bench/gui/presenters/plan_outlook.h"
#include "bench/gui/presenters/workbench.h"
#include "bench/plan/loaded_plan.h"

namespace todbench {

/// Who decides whether an effect is simulated.
enum class EffectChoice { planner, simulate, skip };
inline constexpr std::array all_effect_choices{EffectChoice::planner, EffectChoice::simulate, EffectChoice::skip};

/// Every change is validated as a file is: what the form accepts is what a file may say. Counts and bench time
/// follow in the call; the planner's decisions, uncertainties and the time of the simulation come from predict_plan()
/// in the background, one after the other while a slider moves. In the window's thread.
class PlanPresenter final : public QObject {
  Q_OBJECT

 public:
  explicit PlanPresenter(Workbench& bench, QObject* parent = nullptr);

  [[nodiscard]] const Plan& plan() const { return bench_.plan(); }
  [[nodiscard]] QString toml() const;
  /// Takes the plan, or says in one sentence what is wrong and keeps the old one.
  [[nodiscard]] QString apply(const Plan& plan);
  /// The same with the error, which names the key.
  [[nodiscard]] Result<void> use(const Plan& plan);
  [[nodiscard]] QString apply_toml(const QString& text);
  /// A file or the name of a shipped plan.
  [[nodiscard]] QString load(const QString& reference);
  [[nodiscard]] QString save(const QString& file) const;
  /// As many phases, for camera and twin, as give this uncertainty of the 75 % size; the outlook follows at once.
  [[nodiscard]] QString set_tolerance_percent(double tolerance_percent);
  /// Puts an effect into [simulation] force or skip, or into neither.
  [[nodiscard]] QString choose(Effect effect, EffectChoice choice);
  [[nodiscard]] EffectChoice choice(Effect effect) const;

  /// Changes of the plan since the device was chosen, whoever made them; one way of the slider is one change.
  [[nodiscard]] bool can_undo() const { return !undone_to_.empty(); }
  [[nodiscard]] bool can_redo() const { return !redone_to_.empty(); }
  void undo();
  void redo();

  [[nodiscard]] const PlanOutlook& outlook() const { return outlook_; }
  /// False until the thresholds of the direct estimate are known.
  [[nodiscard]] bool expected_known() const { return !expected_.empty(); }
  [[nodiscard]] const std::vector<ExpectedThreshold>& expected() const { return expected_; }
  /// Of this plan, or of the last one while a newer forecast is made; nothing before the first.
  [[nodiscard]] const std::optional<PlanForecast>& forecast() const { return forecast_; }
  [[nodiscard]] bool forecast_current() const { return forecast_ && forecast_->plan == bench_.plan(); }
  /// What accuracy costs, from the finest; empty until known.
  [[nodiscard]] const std::vector<AccuracyPrice>& prices() const { return prices_; }
  /// What does not fit together although the file is right: sizes that cannot be measured at this distance, a tolerance
  /// that cannot be met.
  [[nodiscard]] QString misfit() const;
  /// What the planner has to say beside its decisions.
  [[nodiscard]] QStringList warnings() const;

 signals:
  void updated();

 private:
  /// What a change of the plan is part of.
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
  std::optional<LoadedPlan> loaded_;  ///< of the plan; nothing while a part of it cannot be read
  PlanOutlook outlook_;
  std::optional<PlanForecast> forecast_;
  std::vector<AccuracyPrice> prices_;
  QString misfit_, trouble_;
  std::optional<Plan> expected_of_, prices_of_;
  std::vector<Plan> undone_to_, redone_to_;  ///< the last is the next
  Plan last_;                                ///< before the change that is being made
  Change change_ = Change::single, last_change_ = Change::single;
  EffectPlanner planner_;  // of both jobs
  JobRunner forecasts_, jobs_;
};

}  // namespace todbench
