// SPDX-License-Identifier: GPL-3.0-or-later
// Alignment of the plate in front of the camera, with repeated measurements of its position.
#pragma once

#include <QObject>
#include <QString>
#include <QStringList>
#include <optional>

#include "bench/gui/presenters/workbench.h"
#include "bench/run/alignment.h"

namespace todbench {

/// Presenter of the alignment. Used in the window's thread.
class AlignPresenter final : public QObject {
  Q_OBJECT

 public:
  explicit AlignPresenter(Workbench& bench, QObject* parent = nullptr);
  /// Starts measuring the position of the plate.
  void start();
  void stop() { bench_.stop(); }

  /// Returns the result of the last measurement of the position; empty before the first.
  [[nodiscard]] const std::optional<Alignment>& alignment() const { return alignment_; }
  /// Returns the number of measurements since start().
  [[nodiscard]] int looks() const { return looks_; }
  /// Returns name and value with unit of each quantity.
  [[nodiscard]] std::vector<std::pair<QString, QString>> figures() const;
  /// Returns the corrections that the user has to make, one sentence each; empty: ready to measure.
  [[nodiscard]] QStringList hints() const;

 signals:
  void updated();

 private:
  Workbench& bench_;
  std::optional<Alignment> alignment_;
  int looks_ = 0;
};

}  // namespace todbench
