// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/bench_time.h"

#include <algorithm>
#include <cmath>

#include "bench/plan/plan_options.h"

namespace todbench {
namespace {

/// Counts changes and frames of one presentation after another, in the order of measure().
class Walk {
 public:
  explicit Walk(const Plan& plan) : plan_(plan) {}

  void present(const TargetState* before, const TargetState& state) {
    const bool plate = before == nullptr || before->plate != state.plate;
    const bool mounting = before == nullptr || before->mounting != state.mounting;
    const bool contrast = before == nullptr || before->delta_t_k != state.delta_t_k;
    const bool shift = before == nullptr || before->shift_mm != state.shift_mm;
    ++time_.presentations;
    time_.plate_changes += plate ? 1 : 0;
    time_.mounting_changes += mounting ? 1 : 0;
    time_.contrast_changes += contrast ? 1 : 0;
    time_.shift_changes += shift ? 1 : 0;
    const TargetPlan& target = plan_.target;
    time_.changes_s += std::max({plate ? target.plate_change_s : 0, mounting ? target.mounting_change_s : 0,
                                 contrast ? target.contrast_change_s : 0, shift ? target.shift_change_s : 0});
    take_frames(plate || mounting, contrast, state.delta_t_k);
  }

  /// Counts the requests of [measures] after the trials, in the order of measure_camera().
  void measure(const TargetState& last, const std::string& first_plate) {
    const MeasuresPlan& measures = plan_.measures;
    if (!measures.any()) return;
    const TargetPlan& target = plan_.target;
    const auto change = [&](double seconds, int frames) {
      time_.changes_s += seconds;
      time_.frames += static_cast<std::uint64_t>(plan_.measurement.frames_after_change + frames);
    };
    change(std::max({last.plate != first_plate ? target.plate_change_s : 0,
                     last.mounting != Mounting::identity ? target.mounting_change_s : 0, target.contrast_change_s,
                     last.shift_mm != cv::Point2d(0, 0) ? target.shift_change_s : 0}),
           plan_.measurement.registration_frames);
    if (measures.transfer) {
      for (std::size_t i = 0; i < measures.transfer_steps_k.size(); ++i)
        change(target.contrast_change_s, plan_.measurement.contrast_frames);
    }
    if (measures.noise) change(target.contrast_change_s, measures.noise_frames);
    if (measures.drift) {
      change(target.contrast_change_s, 0);
      time_.changes_s += plan_.camera.nuc_wait_s + measures.drift_s;
    }
    if (measures.response) {
      constexpr int before_step = 8;
      for (int i = 0; i < 2; ++i) change(target.contrast_change_s, plan_.measurement.contrast_frames);
      for (int i = 0; i < measures.response_steps; ++i)
        change(target.contrast_change_s, before_step + measures.response_frames);
    }
    if (measures.triangles) {
      for (std::size_t i = 0; i < target.delta_t_k.size(); ++i)
        change(target.contrast_change_s, plan_.measurement.contrast_frames);
    }
    const double new_plate_s = std::max(target.plate_change_s, target.contrast_change_s);
    if (measures.mtf) change(new_plate_s, measures.mtf_frames);
    if (measures.ctf) change(new_plate_s, measures.ctf_frames);
    if (measures.source_size) {
      change(new_plate_s, measures.source_size_frames);
      for (int i = 0; i < 2; ++i) change(target.contrast_change_s, measures.source_size_frames);
    }
  }

  [[nodiscard]] BenchTime finished(double frame_rate_hz) {
    // A simulated camera and its scene are as fast as the processor.
    if (plan_.target.kind == TargetKind::scene) {
      time_.changes_s = 0;
      return time_;
    }
    time_.frames_s = frame_rate_hz > 0 ? static_cast<double>(time_.frames) / frame_rate_hz : 0;
    const double running = time_.changes_s + time_.frames_s;
    if (plan_.camera.nuc_interval_s > 0)
      time_.corrections_s = (running / plan_.camera.nuc_interval_s + 1) * plan_.camera.nuc_wait_s;
    return time_;
  }

 private:
  void take_frames(bool new_set_up, bool new_contrast, double delta_t_k) {
    const MeasurementPlan& measurement = plan_.measurement;
    // The camera is predicted without the modules of the sensor.
    const int frames = measurement.frames_after_change + chosen_answers(plan_, {}, delta_t_k).frames;
    int looking = new_set_up ? measurement.registration_frames : 0;
    if (new_set_up || new_contrast) looking += measurement.contrast_frames;
    // After the operator has moved the plate, it is located again.
    if (!new_set_up && plan_.target.kind == TargetKind::prompt) looking += measurement.contrast_frames;
    time_.looking_frames += static_cast<std::uint64_t>(looking);
    time_.presentation_frames[delta_t_k] += static_cast<std::uint64_t>(frames);
    time_.frames += static_cast<std::uint64_t>(frames + looking);
  }

  const Plan& plan_;
  BenchTime time_;
};

}  // namespace

std::vector<TargetState> listed_presentations(const Plan& plan, const std::vector<TargetPlate>& plates) {
  ConstantStimuliOptions stimuli = stimuli_options(plan, plates, plan.camera.ifov_mrad, Side::measured);
  // Shifts are only counted: a plan without a camera has them too.
  stimuli.pixel_mm = 1;
  stimuli.drawings.clear();
  if (plan.schedule.kind == ScheduleKind::adaptive) {
    const double visit_order[] = {3, 2, 1, 0};
    std::copy(std::begin(visit_order), std::end(visit_order), std::begin(stimuli.change_cost_s));
  }
  return constant_stimuli(stimuli, RandomStream(plan.seed, "schedule"));
}

BenchTime bench_time(const Plan& plan, const std::vector<TargetPlate>& plates, double frame_rate_hz,
                     std::optional<double> presentations) {
  return bench_time(plan, plates, listed_presentations(plan, plates), frame_rate_hz, presentations);
}

BenchTime bench_time(const Plan& plan, const std::vector<TargetPlate>& plates, const std::vector<TargetState>& states,
                     double frame_rate_hz, std::optional<double> presentations) {
  Walk walk(plan);
  if (states.empty()) return walk.finished(frame_rate_hz);
  std::uint64_t count = states.size();
  if (plan.schedule.kind == ScheduleKind::adaptive) {
    const auto cap = static_cast<double>(plan.schedule.max_presentations);
    count = static_cast<std::uint64_t>(std::llround(std::min(presentations.value_or(cap), cap)));
  }
  const TargetState* before = nullptr;
  for (std::uint64_t i = 0; i < count; ++i) {
    const TargetState& state = states[i % states.size()];
    walk.present(before, state);
    before = &state;
  }
  if (before != nullptr && !plates.empty()) walk.measure(*before, plates.front().name);
  return walk.finished(frame_rate_hz);
}

}  // namespace todbench
