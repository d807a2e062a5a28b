// The plan as a form and as TOML, and what it will cost.
#pragma once

#include <QObject>
#include <QString>
#include <QTimer>
#include <vector>

#include "bench/gui/plan_outlook.h"
#include "bench/gui/workbench.h"

namespace todbench {

/// Every change goes through TOML and its reader: what the form accepts is what a file may say. In the window's thread.
class PlanPresenter final : public QObject {
  Q_OBJECT

 public:
  explicit PlanPresenter(Workbench& bench, QObject* parent = nullptr);

  [[nodiscard]] const Plan& plan() const { return bench_.plan(); }
  [[nodiscard]] QString toml() const;
  /// Takes the plan, or says in one sentence what is wrong and keeps the old one.
  [[nodiscard]] QString apply(const Plan& plan);
  [[nodiscard]] QString apply_toml(const QString& text);
  /// A file or the name of a shipped plan.
  [[nodiscard]] QString load(const QString& reference);
  [[nodiscard]] QString save(const QString& file) const;
  /// As many phases, for camera and twin, as give this uncertainty of the 75 % size; the outlook follows at once.
  [[nodiscard]] QString set_tolerance_percent(double tolerance_percent);

  [[nodiscard]] const PlanOutlook& outlook() const { return outlook_; }
  /// False until the thresholds that the outlook is based on are known.
  [[nodiscard]] bool expected_known() const { return !expected_.empty(); }
  [[nodiscard]] const std::vector<ExpectedThreshold>& expected() const { return expected_; }
  /// Simulated or skipped, and why.
  [[nodiscard]] const SensorPlan& effects() const { return effects_; }
  /// What does not fit together although the file is right: sizes that cannot be measured at this distance.
  [[nodiscard]] QString misfit() const { return misfit_; }

 signals:
  void updated();

 private:
  void plan_changed();
  void look_ahead();
  void refresh();

  Workbench& bench_;
  QTimer delay_;
  std::vector<ExpectedThreshold> expected_;
  std::vector<TargetPlate> plates_;
  PlanOutlook outlook_;
  SensorPlan effects_;
  QString misfit_;
  double frame_rate_hz_ = 50;
  std::optional<Plan> expected_of_;
  JobRunner jobs_;
};

}  // namespace todbench
