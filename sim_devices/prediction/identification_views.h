// SPDX-License-Identifier: GPL-3.0-or-later
// Views of the targets of an identification experiment: edges, contrasts and sampling phases.
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core/types.hpp>
#include <vector>

#include "acquisition/base/result.h"
#include "hvs/observer/identification_bank.h"
#include "sim_devices/prediction/identification.h"

namespace todbench {

inline constexpr int identification_phases_on_axis = 4;  ///< sampling phases along each axis
inline constexpr int identification_phases = identification_phases_on_axis * identification_phases_on_axis;

/// One view, independent of range: edges in metres, and contrast.
struct SeenAspect {
  std::vector<StepEdge> edges_m;
  double dt_rss_k = 0, size_m = 0;  ///< contrast dT_RSS in kelvin, effective size in metres
};
using SeenTargets = std::vector<std::vector<SeenAspect>>;

/// Returns the views of a task by target and aspect. Errors: those of identify() about the targets.
[[nodiscard]] Result<SeenTargets> seen_targets(const IdentificationTask& task);

/// Returns the first draw that shows a view in sampling phase `phase`; the following draws are identification_phases
/// apart. Views begin with different phases.
[[nodiscard]] std::size_t first_draw_of(std::size_t phase, std::size_t target, std::size_t aspect);
/// Returns the offset of a target's origin from the middle of the window in phase `phase`, in samples.
[[nodiscard]] cv::Point2d view_offset(std::size_t phase);
/// Returns a number that is unique for each picture without noise and that selects its image dance.
[[nodiscard]] std::uint64_t presentation_of(std::size_t phase, std::size_t target, std::size_t aspect);

/// Returns the number of displayed samples per metre.
[[nodiscard]] double samples_per_metre(const SensorSpec& spec, const IdentificationRange& range);
/// Returns the edges in displayed samples near the origin, sheared and stretched by sequential readout in this motion.
[[nodiscard]] std::vector<AlternativeAspects> in_samples(const SeenTargets& targets, double samples_per_metre,
                                                         const SensorSpec& spec, SceneMotion motion);

}  // namespace todbench
