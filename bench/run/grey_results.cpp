// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/grey_results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/plan/plan_options.h"
#include "tod/measurement/set_up_step.h"

namespace todbench {

Result<void> check_contrast_of(const Plan& plan, const ExperimentInputs& inputs, const SourceInfo& info) {
  if (plan.camera.contrast == ContrastUnit::kelvin && !info.scale.calibrated()) {
    return fail(
        ErrorCode::calibration,
        "camera " + info.id +
            " has no temperature scale: contrasts in kelvin cannot be measured. Set contrast = \"grey-levels\" in "
            "[camera] to measure them at the large triangles of every frame");
  }
  return check_grey_references(camera_options(plan, inputs.plates));
}

GreySummary grey_summary(const std::vector<GreyFrame>& frames, double set_delta_t_k) {
  GreySummary out{.set_delta_t_k = set_delta_t_k};
  double squares = 0;
  for (const GreyFrame& frame : frames) {
    if (frame.set_delta_t_k != set_delta_t_k) continue;
    out.lowest_per_k = out.frames == 0 ? frame.levels_per_k : std::min(out.lowest_per_k, frame.levels_per_k);
    out.highest_per_k = out.frames == 0 ? frame.levels_per_k : std::max(out.highest_per_k, frame.levels_per_k);
    out.noise_steps = out.frames == 0 ? frame.noise_steps : std::min(out.noise_steps, frame.noise_steps);
    out.levels += frame.contrast.levels;
    out.levels_per_k += frame.levels_per_k;
    squares += std::pow(frame.relative_uncertainty(), 2);
    ++out.frames;
  }
  if (out.frames == 0) return out;
  out.levels /= out.frames;
  out.levels_per_k /= out.frames;
  out.relative_uncertainty = std::sqrt(squares / out.frames);
  return out;
}

std::string sentence(const GreySummary& summary) {
  return fmt::format(
      "{:+.3f} K are {:.4g} grey levels, {:.4g} per kelvin ({:.4g} to {:.4g} in {} frames), each with a standard "
      "uncertainty of {:.2g} %; the pixel noise is {:.2g} grey levels",
      summary.set_delta_t_k, summary.levels, summary.levels_per_k, summary.lowest_per_k, summary.highest_per_k,
      summary.frames, 100 * summary.relative_uncertainty, summary.noise_steps);
}

Result<void> keep_grey_levels(TodCurve& curve, MeasurementResult& result, const OpenSession& open) {
  if (result.grey_frames.empty()) return {};
  for (TodPoint& point : curve.points) {
    const GreySummary grey = grey_summary(result.grey_frames, point.set_delta_t_k);
    if (grey.frames == 0) continue;
    point.delta_t_se_k = std::hypot(point.delta_t_se_k, grey.relative_uncertainty * std::abs(point.delta_t_k));
    point.noise_counts = grey.noise_steps;
    result.notes.push_back(sentence(grey));
    note(open.folder, open.listener, result.notes.back());
  }
  return open.folder.write_grey_levels(result.grey_frames);
}

}  // namespace todbench
