// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/run_display.h"

#include <memory>

#include "bench/report/curve_lines.h"

namespace todbench {
namespace {

constexpr auto line_period = std::chrono::seconds(10);

}  // namespace

ExperimentListener listener_of(Console& console) {
  ExperimentListener out;
  out.on_phase = [&console](std::string_view phase) { console.phase(phase); };
  out.on_progress = [&console](std::size_t done, std::size_t planned) { console.progress(done, planned); };
  out.on_lost = [&console](const SourceInfo&, std::chrono::milliseconds) { console.stands_still(); };
  out.on_note = [&console](std::string_view sentence) { console.note(sentence); };
  out.on_wait = [&console](const std::optional<TargetWait>& wait) {
    if (wait) {
      console.waiting(sentence(*wait));
    } else {
      console.end_progress();
    }
  };
  return out;
}

RunDisplay::RunDisplay(Console& console, const Plan& plan, Curve curve) : console_(console), plan_(plan) {
  if (curve == Curve::of_others_too || console.audience() != Console::Audience::nobody) curve_.emplace(plan);
}

ExperimentListener RunDisplay::listener() {
  ExperimentListener out = listener_of(console_);
  if (!curve_) return out;
  out.on_trial = [this](SessionCurve which, const Trial& trial, const Patch&) { curve_->add(which, trial); };
  out.on_progress = [this](std::size_t done, std::size_t planned) {
    show();
    console_.progress(done, planned);
  };
  return out;
}

void RunDisplay::show() {
  const std::shared_ptr<const FittedCurves> curves = curve_->latest();
  const bool terminal = console_.audience() == Console::Audience::terminal;
  if (console_.audience() == Console::Audience::nobody) return;
  if (!curves || curves->version == shown_version_) return;
  if (!terminal && Clock::now() - last_line_ < line_period) return;
  shown_version_ = curves->version;
  last_line_ = Clock::now();
  const CurveLines lines{.delta_t_k = plan_.target.delta_t_k,
                         .measured = curves->measured ? &*curves->measured : nullptr,
                         .twin = curves->twin ? &*curves->twin : nullptr,
                         .limits = plan_.limits.acuity};
  if (terminal) {
    console_.picture(curve_lines(lines, console_.columns() - 1));
  } else {
    console_.note(curve_in_one_line(lines));
  }
}

}  // namespace todbench
