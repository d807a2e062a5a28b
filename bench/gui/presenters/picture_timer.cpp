// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/picture_timer.h"

namespace todbench {

PictureTimer::PictureTimer(QObject* parent) : QObject(parent) {
  hide_.setSingleShot(true);
  connect(&hide_, &QTimer::timeout, this, [this] {
    if (state_ != HumanState::showing) return;
    state_ = HumanState::hidden;
    emit updated();
  });
}

void PictureTimer::show(const QImage& picture, std::optional<int> shown_ms) {
  picture_ = picture;
  state_ = HumanState::showing;
  since_shown_.start();
  hide_.stop();
  if (shown_ms) hide_.start(*shown_ms);
  emit updated();
}

std::optional<double> PictureTimer::take_answer() {
  if (!awaits_answer()) return std::nullopt;
  hide_.stop();
  return static_cast<double>(since_shown_.nsecsElapsed()) * 1e-9;
}

void PictureTimer::end(HumanState state) {
  hide_.stop();
  picture_ = {};
  state_ = state;
}

}  // namespace todbench
