// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/bench_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include <string_view>

#include "bench/forecast/visit_order.h"
#include "bench/plan/plan_options.h"

namespace todbench {
namespace {

constexpr double settled_k = 0.002;  ///< tolerance of the shipped tables of black bodies

/// Time constant of a black body of first order that settles in the stated time from the strongest contrast.
double time_constant_s(const Plan& plan) {
  double strongest = std::abs(plan.schedule.from_delta_t_k.value_or(0));
  for (const double delta_t_k : plan.target.delta_t_k) strongest = std::max(strongest, std::abs(delta_t_k));
  return strongest > settled_k * std::numbers::e ? plan.target.contrast_change_s / std::log(strongest / settled_k) : 0;
}

/// Wait for a contrast, which ends when a first-order approach is near: within the tolerance of a black body, or within
/// a band and slow enough; a lag of 0.1 s is assumed if the plan states none.
double contrast_wait_s(const Plan& plan, const TargetState* before, const TargetState& state) {
  if (state.wait == ContrastWait::none) return 0;
  const bool settles = state.wait == ContrastWait::settled || state.wait == ContrastWait::held;
  const double tau_s = time_constant_s(plan), longest_s = plan.target.contrast_change_s;
  // A person takes as long for a small step.
  const bool by_hand = plan.target.kind == TargetKind::prompt;
  if (before == nullptr || (settles && (tau_s == 0 || by_hand))) return settles ? longest_s : 0;
  constexpr double default_band_percent = 10, default_rate_per_s = 0.06;
  const double percent = plan.target.contrast_settling_band_percent;
  const double band = std::min((percent > 0 ? percent : default_band_percent) / 100, default_rate_per_s * tau_s);
  const double step = std::abs(state.delta_t_k - before->delta_t_k);
  const double near = settles ? settled_k : band * std::abs(state.delta_t_k);
  return near > 0 && step > near ? std::min(longest_s, tau_s * std::log(step / near)) : 0;
}

/// Adds the presentations that a slow black body needs at the end of each ramp down.
std::vector<TargetState> with_ramp_ends(const Plan& plan, const RampOptions& ramp, std::vector<TargetState> states) {
  const std::size_t steps = ramp_steps(ramp), more = ramp_contrasts_k(plan).size() - 2 * steps;
  std::vector<TargetState> out;
  for (std::size_t k = 0; k < states.size(); ++k) {
    out.push_back(states[k]);
    if (k < ramp_hold || (k - ramp_hold) % (2 * steps) != steps - 1) continue;
    for (std::size_t i = 0; i < more; ++i) {
      TargetState again = states[k];
      again.shift_mm.x += static_cast<double>(i % 2 + 1);  // another shift
      out.push_back(again);
    }
  }
  return out;
}

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
    set_ups_.emplace(state.plate, state.mounting);
    time_.set_ups = set_ups_.size();
    time_.plate_changes += plate ? 1 : 0;
    time_.mounting_changes += mounting ? 1 : 0;
    time_.contrast_changes += contrast ? 1 : 0;
    time_.shift_changes += shift ? 1 : 0;
    const TargetPlan& target = plan_.target;
    const double contrast_s = contrast ? contrast_wait_s(plan_, before, state) : 0;
    time_.changes_s += std::max({plate ? target.plate_change_s : 0, mounting ? target.mounting_change_s : 0, contrast_s,
                                 shift ? target.shift_change_s : 0});
    take_frames(plate || mounting, contrast && state.wait != ContrastWait::none,
                state.point_delta_t_k.value_or(state.delta_t_k));
  }

  /// Counts the requests of [measures] after the trials, in the order of measure_camera().
  void measure(const TargetState& last, const std::string& first_plate, double plate_width_mm) {
    const MeasuresPlan& measures = plan_.measures;
    if (!measures.any()) return;
    const double trials_changes_s = time_.changes_s;
    const std::uint64_t trials_frames = time_.frames;
    const TargetPlan& target = plan_.target;
    const auto change = [&](double seconds, int frames) {
      time_.changes_s += seconds;
      time_.frames += static_cast<std::uint64_t>(plan_.measurement.frames_after_change + frames);
    };
    change(std::max({last.plate != first_plate ? target.plate_change_s : 0,
                     last.mounting != Mounting::identity ? target.mounting_change_s : 0, target.contrast_change_s,
                     last.shift_mm != cv::Point2d(0, 0) ? target.shift_change_s : 0}),
           plan_.measurement.registration_frames);
    const auto add = [&](std::string_view measure, bool wanted, auto&& count) {
      if (!wanted) return;
      const double changes_s = time_.changes_s;
      const std::uint64_t frames = time_.frames;
      count();
      time_.measures.push_back({measure, time_.changes_s - changes_s, time_.frames - frames});
    };
    const auto steps = [&](std::size_t count, int frames) {
      for (std::size_t i = 0; i < count; ++i) change(target.contrast_change_s, frames);
    };
    constexpr int before_step = 8;
    const int contrast_frames = plan_.measurement.contrast_frames;
    const auto response_steps = static_cast<std::size_t>(std::max(0, measures.response_steps));
    add("transfer", measures.transfer, [&] { steps(measures.transfer_steps_k.size(), contrast_frames); });
    add("noise", measures.noise, [&] { steps(1, measures.noise_frames); });
    add("drift", measures.drift, [&] {
      steps(1, 0);
      time_.changes_s += plan_.camera.nuc_wait_s + measures.drift_s;
    });
    add("response", measures.response, [&] {
      steps(2, contrast_frames);
      steps(response_steps, before_step + measures.response_frames);
    });
    add("gain_control", measures.gain_control, [&] {
      steps(measures.transfer_steps_k.size() + 2, measures.response_frames + contrast_frames);
      steps(response_steps, before_step + measures.response_frames);
    });
    add("triangles", measures.triangles, [&] { steps(target.delta_t_k.size(), contrast_frames); });
    const double new_plate_s = std::max(target.plate_change_s, target.contrast_change_s);
    add("mtf", measures.mtf, [&] { change(new_plate_s, measures.mtf_frames); });
    add("ctf", measures.ctf, [&] { change(new_plate_s, measures.ctf_frames); });
    add("source_size", measures.source_size, [&] {
      change(new_plate_s, measures.source_size_frames);
      steps(2, measures.source_size_frames);
    });
    add("timing", measures.timing, [&] { steps(1, measures.timing_frames); });
    add("latency", measures.latency, [&] {
      for (int i = 0; i < measures.latency_runs; ++i) {
        change(target.shift_change_s, 0);
        time_.changes_s += 0.1 * plate_width_mm / (measures.latency_mrad_s * target.distance_m);
      }
    });
    add("absolute", measures.absolute, [&] { add_absolute(new_plate_s); });
    add("mrtd", measures.mrtd, [&] { count_mrtd(measures, target); });
    time_.all_measures = {"", time_.changes_s - trials_changes_s, time_.frames - trials_frames};
  }

  /// Both passes over the temperatures, then both halves of the shifted pictures, in the order of measure_absolute().
  void add_absolute(double new_plate_s) {
    const MeasuresPlan& measures = plan_.measures;
    constexpr int passes = 2, places = 5;
    const auto change = [&](double seconds) {
      time_.changes_s += seconds;
      time_.frames += static_cast<std::uint64_t>(plan_.measurement.frames_after_change + measures.absolute_frames);
    };
    for (std::size_t i = 0; i < passes * measures.absolute_temperatures_k.size(); ++i)
      change(i == 0 ? new_plate_s : plan_.target.contrast_change_s);
    if (measures.absolute_shift_px == 0) return;
    for (int i = 0; i < passes * places; ++i)
      change(i == 0 ? plan_.target.contrast_change_s : plan_.target.shift_change_s);
  }

  [[nodiscard]] BenchTime finished(double frame_rate_hz) {
    // A simulated camera and its scene are as fast as the processor.
    if (plan_.target.kind == TargetKind::scene) {
      time_.changes_s = 0;
      return time_;
    }
    // The warm-up of the camera precedes the run; a drift adds at least its window.
    const WarmUpPlan& warm_up = plan_.camera.warm_up;
    time_.warm_up_s = std::max(warm_up.time_s, warm_up.drift_k_per_min > 0 ? warm_up.window_s : 0);
    time_.changes_s += time_.warm_up_s;
    time_.frames_s = frame_rate_hz > 0 ? static_cast<double>(time_.frames) / frame_rate_hz : 0;
    const double running = time_.changes_s + time_.frames_s;
    if (plan_.camera.nuc_interval_s > 0)
      time_.corrections_s = (running / plan_.camera.nuc_interval_s + 1) * plan_.camera.nuc_wait_s;
    time_.short_s = time_.long_s = time_.total_s();
    return time_;
  }

 private:
  void count_mrtd(const MeasuresPlan& measures, const TargetPlan& target) {
    MrtdOptions options{.contrasts_k = measures.mrtd_delta_t_k,
                        .frames = measures.mrtd_frames,
                        .set_ups = measures.mrtd_set_ups,
                        .mountings = target.mountings};
    const TargetState* before = nullptr;
    const std::vector<MrtdPresentation> presentations = mrtd_presentations(options, 1);
    for (const MrtdPresentation& one : presentations) {
      const TargetState& state = one.state;
      const bool contrast = before == nullptr || before->delta_t_k != state.delta_t_k;
      const bool mounting = before != nullptr && before->mounting != state.mounting;
      time_.changes_s +=
          std::max({before == nullptr ? target.plate_change_s : 0, mounting ? target.mounting_change_s : 0,
                    contrast ? target.contrast_change_s : 0, target.shift_change_s});
      time_.frames +=
          static_cast<std::uint64_t>(plan_.measurement.frames_after_change +
                                     (one.set_up < 0 ? plan_.measurement.registration_frames : measures.mrtd_frames));
      before = &state;
    }
  }

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
  std::set<std::pair<std::string, Mounting>> set_ups_;
};

/// Mean of a property over runs.
template <typename Property>
double mean_over(const std::vector<BenchTime>& times, const Property& property) {
  double sum = 0;
  for (const BenchTime& time : times) sum += static_cast<double>(property(time));
  return sum / static_cast<double>(times.size());
}

template <typename Property>
std::uint64_t mean_count(const std::vector<BenchTime>& times, const Property& property) {
  return static_cast<std::uint64_t>(std::llround(mean_over(times, property)));
}

/// Sets the means of a physical measure that `of` finds in the bench time of a run.
template <typename Of>
void set_means(MeasureTime& measure, const std::vector<BenchTime>& times, const Of& of) {
  measure.changes_s = mean_over(times, [&](const BenchTime& time) { return of(time).changes_s; });
  measure.frames = mean_count(times, [&](const BenchTime& time) { return of(time).frames; });
}

/// Mean over runs with the same physical measures.
BenchTime mean_of(const std::vector<BenchTime>& times) {
  BenchTime out = times.front();
  for (auto count : {&BenchTime::presentations, &BenchTime::plate_changes, &BenchTime::mounting_changes,
                     &BenchTime::contrast_changes, &BenchTime::shift_changes, &BenchTime::set_ups, &BenchTime::frames,
                     &BenchTime::looking_frames})
    out.*count = mean_count(times, [&](const BenchTime& time) { return time.*count; });
  for (auto seconds : {&BenchTime::changes_s, &BenchTime::frames_s, &BenchTime::corrections_s})
    out.*seconds = mean_over(times, [&](const BenchTime& time) { return time.*seconds; });
  for (auto& [delta_t_k, frames] : out.presentation_frames) {
    frames = mean_count(times, [contrast_k = delta_t_k](const BenchTime& time) {
      const auto found = time.presentation_frames.find(contrast_k);
      return found == time.presentation_frames.end() ? 0 : found->second;
    });
  }
  for (std::size_t i = 0; i < out.measures.size(); ++i)
    set_means(out.measures[i], times, [i](const BenchTime& time) { return time.measures[i]; });
  set_means(out.all_measures, times, [](const BenchTime& time) { return time.all_measures; });
  std::vector<double> totals_s;
  for (const BenchTime& time : times) totals_s.push_back(time.total_s());
  std::ranges::sort(totals_s);
  out.short_s = totals_s[totals_s.size() / 10];
  out.long_s = totals_s[totals_s.size() - 1 - totals_s.size() / 10];
  return out;
}

}  // namespace

std::vector<double> ramp_contrasts_k(const Plan& plan) {
  const RampOptions ramp = ramp_options(plan, {}, 1);
  const std::size_t steps = ramp_steps(ramp);
  const double tau_s = plan.target.kind == TargetKind::scene ? 0 : time_constant_s(plan);
  const double kept = tau_s > 0 ? std::exp(-ramp_step_s / tau_s) : 0;
  std::vector<double> out;
  double contrast = ramp.from_k;
  const auto show = [&](std::size_t below) {
    const double share = static_cast<double>(below) / static_cast<double>(steps - 1);
    const double set = ramp.from_k * std::pow(ramp.to_k / ramp.from_k, share);
    contrast = set + (contrast - set) * kept;
    out.push_back(contrast);
  };
  constexpr double arrived = 1.1;
  for (std::size_t k = 0; k < steps; ++k) show(k);
  for (std::size_t more = 0; more < 3 * steps && contrast / ramp.to_k > arrived; ++more) show(steps - 1);
  for (std::size_t k = steps; k-- > 0;) show(k);
  return out;
}

std::vector<TargetState> listed_presentations(const Plan& plan, const std::vector<TargetPlate>& plates) {
  ConstantStimuliOptions stimuli = stimuli_options(plan, plates, plan.camera.ifov_mrad, Side::measured);
  // Shifts are only counted: a plan without a camera has them too.
  stimuli.pixel_mm = 1;
  stimuli.drawings.clear();
  stimuli.spread_evenly = false;
  if (plan.schedule.kind == ScheduleKind::ramp) {
    RampOptions ramp = ramp_options(plan, plates, 1);
    ramp.stimuli = stimuli;
    return with_ramp_ends(plan, ramp, ramp_presentations(ramp, RandomStream(plan.seed, "schedule")));
  }
  if (plan.schedule.kind == ScheduleKind::adaptive) {
    const double visit_order[] = {3, 2, 1, 0};
    std::copy(std::begin(visit_order), std::end(visit_order), std::begin(stimuli.change_cost_s));
  }
  std::vector<TargetState> states = constant_stimuli(stimuli, RandomStream(plan.seed, "schedule"));
  if (has_own_contrasts(plan) && plan.schedule.kind == ScheduleKind::constant)
    for (TargetState& state : states) state.wait = ContrastWait::within_band;
  return states;
}

BenchTime bench_time(const Plan& plan, const std::vector<TargetPlate>& plates, double frame_rate_hz,
                     const std::vector<AdaptiveRun>& runs) {
  return bench_time(plan, plates, listed_presentations(plan, plates), frame_rate_hz, runs);
}

BenchTime bench_time(const Plan& plan, const std::vector<TargetPlate>& plates, const std::vector<TargetState>& listed,
                     double frame_rate_hz, const std::vector<AdaptiveRun>& runs) {
  const auto walk_through = [&](const std::vector<TargetState>& states) {
    Walk walk(plan);
    const TargetState* before = nullptr;
    for (const TargetState& state : states) {
      walk.present(before, state);
      before = &state;
    }
    if (before != nullptr && !plates.empty()) walk.measure(*before, plates.front().name, plates.front().width_mm);
    return walk.finished(frame_rate_hz);
  };
  if (plan.schedule.kind != ScheduleKind::adaptive || listed.empty()) return walk_through(listed);
  std::vector<BenchTime> times;
  for (const std::vector<TargetState>& states : visited_presentations(plan, listed, runs))
    times.push_back(walk_through(states));
  return mean_of(times);
}

std::string resume_remark(const Plan& plan, double bench_s) {
  constexpr double long_run_s = 600;
  if (plan.measurement.record_frames || plan.target.kind == TargetKind::scene || bench_s < long_run_s) return {};
  return fmt::format(
      "the run takes about {:.0f} minutes and keeps no frames: after an interruption it begins again. With "
      "record_frames of [measurement], or --record-frames, `todbench measure --resume` goes on with it",
      bench_s / 60);
}

}  // namespace todbench
