// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/schedule/ramp_schedule.h"

#include <algorithm>
#include <cmath>

namespace todbench {
namespace {

constexpr double arrived = 0.1;         ///< relative distance from the last contrast of a ramp
constexpr std::size_t longest_end = 3;  ///< further presentations at the end of a ramp down, in ramps

double nearest_point(const std::vector<double>& points, double delta_t_k) {
  const auto distance = [&](double point) {
    return point * delta_t_k > 0 ? std::abs(std::log(point / delta_t_k)) : HUGE_VAL;
  };
  return *std::ranges::min_element(points, {}, distance);
}

}  // namespace

double ramp_relative_rate(const RampOptions& options) {
  return options.rate_k_per_s / std::abs(options.from_k);
}

std::size_t ramp_steps(const RampOptions& options) {
  const double duration_s = std::log(options.from_k / options.to_k) / ramp_relative_rate(options);
  return 1 + static_cast<std::size_t>(std::max(1.0, std::round(duration_s / ramp_step_s)));
}

std::vector<TargetState> ramp_presentations(const RampOptions& options, const RandomStream& stream) {
  ConstantStimuliOptions set_ups = options.stimuli;
  set_ups.delta_t_k = {options.from_k};
  set_ups.phases = 1;
  const std::size_t steps = ramp_steps(options);
  const auto phases = plastic_points(static_cast<int>(2 * steps));
  const auto phases_of_hold = plastic_points(static_cast<int>(ramp_hold));
  std::vector<TargetState> out;
  std::uint64_t set_up = 0;
  for (TargetState state : constant_stimuli(set_ups, stream)) {
    const RandomStream start = stream.sub(++set_up);
    const cv::Point2d first(start.uniform(0), start.uniform(1));
    state.delta_t_k = options.from_k;
    state.point_delta_t_k = nearest_point(options.stimuli.delta_t_k, options.from_k);
    state.wait = ContrastWait::held;
    for (std::size_t k = 0; set_up == 1 && k < ramp_hold; ++k) {
      state.shift_mm = shift_of(phases_of_hold[k] + first, options.stimuli);
      out.push_back(state);
    }
    for (std::size_t k = 0; k < 2 * steps; ++k) {
      const std::size_t below = k < steps ? k : 2 * steps - 1 - k;
      const double share = static_cast<double>(below) / static_cast<double>(steps - 1);
      state.delta_t_k = options.from_k * std::pow(options.to_k / options.from_k, share);
      state.point_delta_t_k = nearest_point(options.stimuli.delta_t_k, state.delta_t_k);
      state.shift_mm = shift_of(phases[k] + first, options.stimuli);
      state.wait = k == 0 ? ContrastWait::within_band : ContrastWait::none;
      out.push_back(state);
    }
  }
  return out;
}

RampSchedule::RampSchedule(const RampOptions& options, const RandomStream& stream)
    : options_(options), states_(ramp_presentations(options, stream)) {}

std::optional<TargetState> RampSchedule::next() {
  if (repeats_) {
    repeats_ = false;
    ++repeated_;
    ++repeated_here_;
    TargetState state = states_[position_ - 1];
    const cv::Point2d further = plastic_points(static_cast<int>(repeated_here_) + 1).back();
    const cv::Size2d pixel_mm = pixel_of(options_.stimuli);
    const cv::Point2d phase(state.shift_mm.x / pixel_mm.width, state.shift_mm.y / pixel_mm.height);
    state.shift_mm = shift_of(phase + further, options_.stimuli);
    return state;
  }
  if (position_ >= states_.size()) return std::nullopt;
  repeated_here_ = 0;
  return states_[position_++];
}

void RampSchedule::observe(std::span<const Trial> trials) {
  const std::size_t steps = ramp_steps(options_);
  const bool at_the_end = position_ > ramp_hold && (position_ - 1 - ramp_hold) % (2 * steps) == steps - 1;
  if (!at_the_end || trials.empty() || repeated_here_ >= longest_end * steps) return;
  repeats_ = std::abs(trials.front().delta_t_k) > (1 + arrived) * std::abs(options_.to_k);
}

}  // namespace todbench
