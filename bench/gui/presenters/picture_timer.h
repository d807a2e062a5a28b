// SPDX-License-Identifier: GPL-3.0-or-later
// Picture in front of a person: shown until it is answered or for a limited time, with the response time.
#pragma once

#include <QElapsedTimer>
#include <QImage>
#include <QObject>
#include <QTimer>
#include <optional>

namespace todbench {

/// State of the picture.
enum class HumanState { idle, showing, hidden, finished };

/// Display of one picture at a time. Used in the window's thread.
class PictureTimer final : public QObject {
  Q_OBJECT

 public:
  explicit PictureTimer(QObject* parent = nullptr);

  /// Shows a picture and starts its time. `shown_ms` empty: until it is answered.
  void show(const QImage& picture, std::optional<int> shown_ms);
  /// Returns the time since show() in seconds, and ends the time limit; empty: no picture awaits an answer.
  [[nodiscard]] std::optional<double> take_answer();
  /// Removes the picture; `state` is idle or finished.
  void end(HumanState state);

  [[nodiscard]] HumanState state() const { return state_; }
  /// Returns whether a picture has no answer yet.
  [[nodiscard]] bool awaits_answer() const { return state_ == HumanState::showing || state_ == HumanState::hidden; }
  [[nodiscard]] const QImage& picture() const { return picture_; }

 signals:
  /// A picture is shown, or its time is over.
  void updated();

 private:
  QImage picture_;
  HumanState state_ = HumanState::idle;
  QElapsedTimer since_shown_;
  QTimer hide_;
};

}  // namespace todbench
