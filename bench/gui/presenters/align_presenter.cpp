// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/align_presenter.h"

#include <cmath>

#include "bench/gui/presenters/text_of.h"

namespace todbench {

AlignPresenter::AlignPresenter(Workbench& bench, QObject* parent) : QObject(parent), bench_(bench) {}

void AlignPresenter::start() {
  alignment_.reset();
  looks_ = 0;
  emit updated();
  bench_.run(Activity::aligning, [this](const Plan& plan, const std::stop_token& stop) {
    AlignmentListener listener;
    listener.on_phase = [this](std::string_view phase) { bench_.note(std::string(phase)); };
    listener.on_open = [this](const SourceInfo& info) { bench_.feed().open(info); };
    listener.on_frame = [this](const Frame& frame) { bench_.feed().put(frame); };
    listener.on_alignment = [this, stop](const Alignment& alignment) {
      bench_.post([this, alignment, stop] {
        if (stop.stop_requested()) return;
        alignment_ = alignment;
        ++looks_;
        emit updated();
      });
    };
    return align_plan(plan, listener, stop);
  });
}

std::vector<std::pair<QString, QString>> AlignPresenter::figures() const {
  if (!alignment_ || !alignment_->registration) return {};
  const Registration& r = *alignment_->registration;
  const auto number = [](double value, int decimals, const char* unit) {
    const double smallest = std::pow(10.0, -decimals);
    // Avoids a displayed minus zero.
    const double shown = std::abs(value) < smallest / 2 ? 0 : value;
    return QString("%1 %2").arg(shown, 0, 'f', decimals).arg(QString::fromUtf8(unit));
  };
  return {{"Residual", number(r.residual_px, 3, "px rms")},
          {"Scale", number(r.scale_px_per_mm, 4, "px/mm")},
          {"Scale deviation", number(100 * r.scale_deviation, 2, "%")},
          {"Rotation", number(r.rotation_deg, 2, "°")},
          {"Mapping", text_of(to_string(r.mapping))},
          {"Edge blur", number(r.blur_px, 2, "px")},
          {"Expected edge blur", number(alignment_->expected_blur_px, 2, "px")},
          {"Drift since start", number(alignment_->drift_px, 3, "px")},
          {"Temporal noise", number(1000 * alignment_->temporal_noise_k, 1, "mK")},
          {"Triangles used", QString::number(r.triangles_used)}};
}

QStringList AlignPresenter::hints() const {
  QStringList out;
  if (!alignment_) return out;
  for (const auto& remark : alignment_->remarks) out << QString::fromStdString(remark.sentence);
  return out;
}

}  // namespace todbench
