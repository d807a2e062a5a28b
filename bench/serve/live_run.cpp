// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/serve/live_run.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>
#include <vector>

#include "bench/picture_files/encoded_picture.h"
#include "bench/report/svg.h"
#include "bench/report/tod_figures.h"
#include "bench/text/json.h"

namespace todbench {
namespace {

constexpr auto draw_period = std::chrono::milliseconds(500);
constexpr double cut_share = 0.0005;

std::string svg_of(const FittedCurves& curves, const Plan& plan) {
  std::vector<DrawnLimit> limits;
  for (const AcuityLimit& limit : plan.limits.acuity) limits.push_back({limit.delta_t_k, limit.least_acuity_per_mrad});
  const auto drawing = drawn(tod_figure({"measured", curves.measured ? &*curves.measured : nullptr},
                                        {"simulated", curves.twin ? &*curves.twin : nullptr}, limits));
  return drawing ? svg_document(std::array{*drawing}) : std::string();
}

}  // namespace

std::string_view to_string(LiveStatus status) {
  switch (status) {
    case LiveStatus::running:
      return "running";
    case LiveStatus::settling:
      return "settling";
    case LiveStatus::plate_change:
      return "plate-change";
    case LiveStatus::operator_needed:
      return "operator";
    case LiveStatus::camera_lost:
      return "camera-lost";
    case LiveStatus::finished:
      return "finished";
    case LiveStatus::stopped:
      return "stopped";
  }
  return "running";
}

std::string to_json(const LiveState& state) {
  return to_line(Json{{"state", to_string(state.status)},
                      {"reason", state.reason ? Json(*state.reason) : Json()},
                      {"name", state.name},
                      {"phase", state.phase},
                      {"waiting", state.waiting},
                      {"step", state.step},
                      {"done", state.done},
                      {"planned", state.planned},
                      {"verdict", state.verdict ? Json(*state.verdict) : Json()},
                      {"curve", state.curve},
                      {"picture", state.picture},
                      {"over", state.over}});
}

std::string picture_of(const Frame& frame) {
  if (frame.counts.empty()) return {};
  std::vector<std::uint16_t> counts(frame.counts.begin(), frame.counts.end());
  const auto quantile = [&](double share) {
    const auto place = counts.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(counts.size() - 1));
    std::nth_element(counts.begin(), place, counts.end());
    return static_cast<double>(*place);
  };
  const double low = quantile(cut_share), high = std::max(quantile(1 - cut_share), low + 1);
  cv::Mat1b grey;
  frame.counts.convertTo(grey, CV_8U, 255 / (high - low), -255 * low / (high - low));
  return png_of(grey).value_or(std::string());
}

LiveRun::LiveRun(LiveServer& server, const LiveCurve& curve, const Plan& plan)
    : LiveRun([&server](std::shared_ptr<const LivePages> pages) { server.show(std::move(pages)); }, curve, plan) {}

LiveRun::LiveRun(Show show, const LiveCurve& curve, const Plan& plan)
    : show_(std::move(show)), curve_(curve), plan_(plan) {
  state_.name = plan.name;
  render();
  worker_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

ExperimentListener LiveRun::listening(const ExperimentListener& listener) {
  ExperimentListener out = listener;
  out.on_phase = [this, next = listener.on_phase](std::string_view phase) {
    {
      const std::lock_guard lock(mutex_);
      state_.phase = phase;
      state_.done = state_.planned = 0;
    }
    if (next) next(phase);
  };
  out.on_progress = [this, next = listener.on_progress](std::size_t done, std::size_t planned) {
    {
      const std::lock_guard lock(mutex_);
      state_.done = done;
      state_.planned = planned;
    }
    if (next) next(done, planned);
  };
  out.on_wait = [this, next = listener.on_wait](const std::optional<TargetWait>& wait) {
    {
      const std::lock_guard lock(mutex_);
      state_.waiting = wait ? sentence(*wait) : std::string();
      target_ = !wait ? LiveStatus::running : wait->plate_there ? LiveStatus::settling : LiveStatus::plate_change;
      set_status();
    }
    if (next) next(wait);
  };
  out.on_lost = [this, next = listener.on_lost](const SourceInfo& camera, std::chrono::milliseconds patience) {
    if (patience.count() > 0) {
      const std::lock_guard lock(mutex_);
      lost_ = true;
      set_status();
    }
    if (next) next(camera, patience);
  };
  out.on_frame = [this, next = listener.on_frame](const Frame& frame) {
    if (frame.status == FrameStatus::complete) {
      const std::lock_guard lock(mutex_);
      frame_ = frame;
      lost_ = false;
      set_status();
    }
    if (next) next(frame);
  };
  return out;
}

void LiveRun::ask(const std::string& step) {
  const std::lock_guard lock(mutex_);
  state_.step = step;
  set_status();
}

void LiveRun::set_status() {
  if (state_.over) return;
  state_.status = !state_.step.empty() ? LiveStatus::operator_needed : lost_ ? LiveStatus::camera_lost : target_;
}

void LiveRun::end(const std::string& phase, const std::optional<std::string>& verdict,
                  const std::optional<std::string>& reason) {
  {
    const std::lock_guard lock(mutex_);
    state_.phase = phase;
    state_.waiting.clear();
    state_.step.clear();
    state_.verdict = verdict;
    state_.reason = reason;
    state_.status = reason ? LiveStatus::stopped : LiveStatus::finished;
    state_.over = true;
  }
  render();
}

void LiveRun::render() {
  const std::lock_guard one(rendering_);
  std::optional<Frame> frame;
  {
    const std::lock_guard lock(mutex_);
    frame = std::exchange(frame_, std::nullopt);
  }
  if (frame) {
    picture_png_ = picture_of(*frame);
    ++pictures_;
  }
  if (const auto curves = curve_.latest(); curves && curves->version != drawn_version_) {
    drawn_version_ = curves->version;
    curve_svg_ = svg_of(*curves, plan_);
  }
  std::string state;
  {
    const std::lock_guard lock(mutex_);
    state_.curve = curve_svg_.empty() ? 0 : drawn_version_;
    state_.picture = picture_png_.empty() ? 0 : pictures_;
    state = to_json(state_);
  }
  show_(std::make_shared<const LivePages>(LivePages{std::move(state), curve_svg_, picture_png_}));
}

void LiveRun::work(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    render();
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, stop, draw_period, [] { return false; });
  }
}

}  // namespace todbench
