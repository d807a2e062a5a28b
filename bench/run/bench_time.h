// How long a plan keeps the bench: the one formula, for the command line and the window.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "bench/plan/plan.h"

namespace todbench {

/// Changes of the target and frames of the camera, in the order in which measure() and then measure_camera() ask for
/// them.
struct BenchTime {
  std::uint64_t presentations = 0;
  /// Presentations for which it changes; the first one brings everything.
  std::uint64_t plate_changes = 0, mounting_changes = 0, contrast_changes = 0, shift_changes = 0;
  /// What one presentation changes, changes together: black body and stage settle at the same time, and a hand that
  /// brings another plate holds it as it has to be held. So each presentation takes as long as the slowest of them.
  double changes_s = 0;  ///< with those of the physical measures
  /// For registration, contrast, answers and physical measures, and those discarded after a change.
  std::uint64_t frames = 0;
  double frames_s = 0;
  double corrections_s = 0;  ///< waiting after commanded corrections of the camera
  [[nodiscard]] double total_s() const { return changes_s + frames_s + corrections_s; }
};

/// Of the camera of a plan, whose frames per presentation are chosen (with_frames()), with its frames `frame_rate_hz`
/// apart. `presentations`: how many are expected of an adaptive schedule, which goes through the same set-ups visit by
/// visit; nothing: as many as the plan lists, of an adaptive one its cap. A target of kind scene is as fast as the
/// processor: counts, and no time.
[[nodiscard]] BenchTime bench_time(const Plan& plan, const std::vector<TargetPlate>& plates, double frame_rate_hz,
                                   std::optional<double> presentations);
/// The same where the presentations are listed already.
[[nodiscard]] BenchTime bench_time(const Plan& plan, const std::vector<TargetPlate>& plates,
                                   const std::vector<TargetState>& listed, double frame_rate_hz,
                                   std::optional<double> presentations);

/// The presentations of a constant schedule, for bench_time(): of an adaptive one those of its visits, for it stays in
/// a set-up for a visit, whatever a change takes. They do not depend on the frames of a presentation. Choosing their
/// phases takes 20 ms for the demonstration.
[[nodiscard]] std::vector<TargetState> listed_presentations(const Plan& plan, const std::vector<TargetPlate>& plates);

}  // namespace todbench
