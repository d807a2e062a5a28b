// SPDX-License-Identifier: GPL-3.0-or-later
// Time that a plan occupies the bench. Command line and window use only this formula.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/forecast/visit_order.h"
#include "bench/plan/plan.h"

namespace todbench {

/// Part of a physical measure in the bench time.
struct MeasureTime {
  std::string_view measure;  ///< key of [measures]
  double changes_s = 0;
  std::uint64_t frames = 0;
};

/// Changes of the target and frames of the camera, in the order in which measure() and measure_camera() request them.
struct BenchTime {
  std::uint64_t presentations = 0;
  /// Number of presentations that change each property; the first presentation changes all properties.
  std::uint64_t plate_changes = 0, mounting_changes = 0, contrast_changes = 0, shift_changes = 0;
  std::uint64_t set_ups = 0;  ///< set-ups of the presentations; an adaptive schedule may end before it has visited all
  /// Changes of one presentation run in parallel: black body and stage settle at the same time, and an operator hangs
  /// another plate in the right mounting. So each presentation takes as long as its slowest change.
  double changes_s = 0;  ///< including the changes of the physical measures
  /// Frames for registration, contrast, answers and physical measures, including frames discarded after a change.
  std::uint64_t frames = 0;
  /// Parts of `frames`: the frames that locate the plate and measure contrasts, and the frames of the presentations by
  /// set contrast.
  std::uint64_t looking_frames = 0;
  std::map<double, std::uint64_t> presentation_frames{};
  double frames_s = 0;
  std::vector<MeasureTime> measures{};  ///< parts of changes_s and frames, in the order of the run
  MeasureTime all_measures{};           ///< sum over the measures, with the change of the target before the first
  double warm_up_s = 0;                 ///< part of changes_s: shortest warm-up before the run
  double corrections_s = 0;             ///< waiting time after commanded corrections of the camera
  /// Total times that one in ten simulated runs of an adaptive schedule stays below and one in ten exceeds; equal to
  /// total_s() for other schedules.
  double short_s = 0, long_s = 0;
  [[nodiscard]] double total_s() const { return changes_s + frames_s + corrections_s; }
};

/// Computes the bench time of a plan whose frames per presentation are chosen (with_frames()). `runs`: for an adaptive
/// schedule, the simulated runs over which the result is the mean, with rounded counts; empty: one run to its cap. The
/// highest contrast is shown at least once in each new set-up. A schedule that lists its presentations ignores `runs`.
/// For a target of kind scene only counts are computed, no times, because only the processor limits this target.
[[nodiscard]] BenchTime bench_time(const Plan& plan, const std::vector<TargetPlate>& plates, double frame_rate_hz,
                                   const std::vector<AdaptiveRun>& runs);
/// Computes the bench time for presentations that are already listed.
[[nodiscard]] BenchTime bench_time(const Plan& plan, const std::vector<TargetPlate>& plates,
                                   const std::vector<TargetState>& listed, double frame_rate_hz,
                                   const std::vector<AdaptiveRun>& runs);

/// Returns a sentence if a run of this bench time records no frames, so that `measure --resume` could not continue it
/// after an interruption; empty for runs of less than ten minutes and for a simulated scene.
[[nodiscard]] std::string resume_remark(const Plan& plan, double bench_s);

/// Returns the contrasts in K that the presentations of one set-up have during a ramp. They are computed for a black
/// body with a first-order response. A slow black body adds presentations at the end of the ramp down.
[[nodiscard]] std::vector<double> ramp_contrasts_k(const Plan& plan);

/// Returns the presentations of a constant schedule for bench_time(). For an adaptive schedule, returns the
/// presentations of its visits, because the schedule stays in a set-up for a whole visit. The result does not depend on
/// the frames per presentation. The shifts are distinct, but not spread evenly (ConstantStimuliOptions::spread_evenly).
[[nodiscard]] std::vector<TargetState> listed_presentations(const Plan& plan, const std::vector<TargetPlate>& plates);

}  // namespace todbench
