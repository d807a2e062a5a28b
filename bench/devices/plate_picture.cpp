// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/devices/plate_picture.h"

#include <fmt/format.h>

#include <cmath>

#include "acquisition/base/try.h"
#include "tod/plate/plate_outlines.h"

namespace todbench {
namespace {

constexpr double step_px = 0.05;  // for the derivatives with respect to place
constexpr int rounds = 2;
constexpr int unknowns = 6;  // level, contrast, x, y, rotation, scale

/// The part of the model's picture at the camera's field, at a contrast of 1 K.
cv::Mat1d rendered(const SensorModel& model, const PlateScene& scene, const cv::Rect& field) {
  const auto unit = model.unit_signal(scene);
  cv::Mat1d out;
  (*unit)(field).convertTo(out, CV_64F);
  return out;
}

PlateScene scene_at(const PlateView& seen, const TargetPlate& plate, const SensorModel& model, SceneMotion motion) {
  const double sample_mrad = model.spec().ifov_mrad() / model.spec().samples_per_pitch();
  const cv::Point2d middle((seen.picture.width - 1) / 2.0, (seen.picture.height - 1) / 2.0);
  PlateScene scene;
  scene.plate = plate;
  scene.delta_t_k = 1;
  scene.distance_m = 1 / (seen.where.scale_px_per_mm * sample_mrad);
  scene.centre_px = seen.where.pixel({0, 0}) - middle;
  scene.rotation_deg = seen.where.rotation_deg;
  scene.motion = motion;
  return scene;
}

struct Fit {
  cv::Mat1d picture;
  double contrast_k = 0;
  cv::Point2d moved_px;
};

/// One step of least squares from a scene.
Result<Fit> fitted(const PlateView& seen, const SensorModel& model, const PlateScene& scene, cv::Point2d centre) {
  const cv::Mat1d here = rendered(model, scene, seen.field);
  PlateScene right = scene, down = scene;
  right.centre_px.x += step_px, down.centre_px.y += step_px;
  const cv::Mat1d along_x = (rendered(model, right, seen.field) - here) / step_px;
  const cv::Mat1d along_y = (rendered(model, down, seen.field) - here) / step_px;
  const auto count = static_cast<int>(here.total());
  cv::Mat1d columns(count, unknowns), values(count, 1);
  int i = 0;
  for (int row = 0; row < here.rows; ++row) {
    for (int x = 0; x < here.cols; ++x, ++i) {
      const double dx = along_x(row, x), dy = along_y(row, x);
      const double u = x + seen.field.x - centre.x, w = row + seen.field.y - centre.y;
      columns(i, 0) = 1, columns(i, 1) = here(row, x), columns(i, 2) = dx, columns(i, 3) = dy;
      columns(i, 4) = u * dy - w * dx, columns(i, 5) = u * dx + w * dy;
      values(i, 0) = seen.kelvin(row, x);
    }
  }
  cv::Mat1d solution;
  if (!cv::solve(columns, values, solution, cv::DECOMP_SVD) || !(std::abs(solution(1, 0)) > 0))
    return fail(ErrorCode::invalid_input, "the picture of the sensor model cannot be fitted to that of the camera");
  const cv::Mat1d picture = columns * solution;
  return Fit{picture.reshape(1, here.rows).clone(), solution(1, 0),
             cv::Point2d(solution(2, 0), solution(3, 0)) / solution(1, 0)};
}

}  // namespace

Result<PlatePicture> plate_picture(const PlateView& seen, const TargetPlate& plate, const SensorModel& model,
                                   SceneMotion motion) {
  const cv::Size size = model.size();
  if (size != seen.picture) {
    return fail(ErrorCode::invalid_input,
                fmt::format("the camera has {} x {} pixels and the sensor model {} x {}", seen.picture.width,
                            seen.picture.height, size.width, size.height));
  }
  PlateScene scene = scene_at(seen, plate, model, motion);
  const cv::Point2d centre = seen.where.pixel({0, 0});
  PlatePicture out;
  out.seen = seen;
  cv::Point2d moved(0, 0);
  for (int round = 0; round < rounds; ++round) {
    TODBENCH_TRY(auto fit, fitted(seen, model, scene, centre));
    // Beyond half a pixel the picture is not a linear function of the position.
    if (!(cv::norm(fit.moved_px) < 0.5))
      return fail(ErrorCode::invalid_input, "the picture of the sensor model cannot be fitted to that of the camera");
    moved += fit.moved_px;
    scene.centre_px += fit.moved_px;
    out.expected_k = fit.picture;
    out.contrast_k = fit.contrast_k;
  }
  out.moved_px = cv::norm(moved);
  const auto pixels = static_cast<double>(seen.kelvin.total());
  const double sum = cv::norm(seen.kelvin, out.expected_k, cv::NORM_L2SQR);
  out.residual_k = std::sqrt(sum / std::max(1.0, pixels - unknowns));
  for (const PlateTriangle& triangle : plate.triangles)
    out.outlines.push_back(outline_in_picture(seen.where.plate_to_pixel, triangle, triangle.apex));
  return out;
}

}  // namespace todbench
