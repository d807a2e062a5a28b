// Setting up the plate before the camera, look by look.
#pragma once

#include <QObject>
#include <QString>
#include <QStringList>
#include <optional>

#include "bench/gui/presenters/workbench.h"
#include "bench/run/alignment.h"

namespace todbench {

/// In the window's thread.
class AlignPresenter final : public QObject {
  Q_OBJECT

 public:
  explicit AlignPresenter(Workbench& bench, QObject* parent = nullptr);
  void start();
  void stop() { bench_.stop(); }

  [[nodiscard]] const std::optional<Alignment>& alignment() const { return alignment_; }
  /// How often the plate was looked at since start().
  [[nodiscard]] int looks() const { return looks_; }
  /// Name, value with unit.
  [[nodiscard]] std::vector<std::pair<QString, QString>> figures() const;
  /// What to mend, one sentence each; empty: ready to measure.
  [[nodiscard]] QStringList hints() const;

 signals:
  void updated();

 private:
  Workbench& bench_;
  std::optional<Alignment> alignment_;
  int looks_ = 0;
};

}  // namespace todbench
