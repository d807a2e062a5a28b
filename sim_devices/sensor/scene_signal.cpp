// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/scene_signal.h"

#include <fmt/format.h>

#include <algorithm>

#include "acquisition/base/try.h"
#include "sim_devices/sensor/effect_readout.h"

namespace todbench {
namespace {

Result<void> check_view(const SensorSpec& spec, const FieldScene& scene, const SceneView& view) {
  TODBENCH_TRY_VOID(require_square_pixels(spec, "a field scene"));
  if (!(view.range_m > 0)) return fail(ErrorCode::invalid_input, "the range must be above 0 m");
  const double pitch_m = view.range_m * spec.ifov_mrad() * 1e-3;
  const cv::Size2d extent = extent_m(scene);
  if (std::max(extent.width, extent.height) < pitch_m) {
    return fail(ErrorCode::invalid_input,
                fmt::format("the size of the scene, {:.3g} m, is smaller than a pixel, {:.3g} m at {:g} m",
                            std::max(extent.width, extent.height), pitch_m, view.range_m));
  }
  if (!scene.picture) return {};
  const double element_m = scene.picture->element_m;
  if (element_m > 0.25 * pitch_m * (1 + 1e-9)) {
    return fail(ErrorCode::invalid_input,
                fmt::format("elements of the picture, {:.3g} m, are larger than a quarter of a pixel, {:.3g} m at {:g} "
                            "m: the detail that decides aliasing is missing",
                            element_m, pitch_m, view.range_m));
  }
  if (view.rotation_deg != 0) return fail(ErrorCode::invalid_input, "a picture cannot be rotated, only polygons can");
  return {};
}

cv::Point2d middle_of(const SensorSpec& spec, const SceneView& view, cv::Size size) {
  return cv::Point2d((size.width - 1) / 2.0, (size.height - 1) / 2.0) + view.centre_pitch * spec.samples_per_pitch();
}

double samples_per_metre(const SensorSpec& spec, const SceneView& view) {
  return 1e3 / (view.range_m * spec.ifov_mrad()) * spec.samples_per_pitch();
}

}  // namespace

std::vector<StepEdge> edges_in_samples(const FieldScene& scene, const RadianceScale& scale, const SensorSpec& spec,
                                       const SceneView& view, cv::Size size) {
  auto edges = placed(visible_edges(levels_k(scene, scale)), samples_per_metre(spec, view), view.rotation_deg,
                      middle_of(spec, view, size));
  for (StepEdge& edge : edges) {
    edge.a = as_read_out(edge.a, view.readout_slope, (size.height - 1) / 2.0);
    edge.b = as_read_out(edge.b, view.readout_slope, (size.height - 1) / 2.0);
  }
  return edges;
}

Result<cv::Mat1d> scene_signal_k(const SceneImager& imager, const SensorSpec& spec, const FieldScene& scene,
                                 const RadianceScale& scale, const SceneView& view, cv::Size size) {
  TODBENCH_TRY_VOID(check_view(spec, scene, view));
  if (!scene.picture) return imager.image(edges_in_samples(scene, scale, spec, view, size), size);
  const cv::Mat1d levels = picture_levels_k(scene, scale);
  const double element = scene.picture->element_m * samples_per_metre(spec, view);
  const cv::Point2d first = middle_of(spec, view, size) - cv::Point2d(levels.cols - 1, levels.rows - 1) * (element / 2);
  return imager.image(levels, element, first, size);
}

}  // namespace todbench
