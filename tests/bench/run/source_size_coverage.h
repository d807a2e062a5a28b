// SPDX-License-Identifier: GPL-3.0-or-later
// How often the curve of the size-of-source effect holds the closed form: for the test and the study.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "bench/plan/descriptions.h"
#include "sim_devices/sensor/image_chain.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/camera_measures/source_size.h"

namespace todbench::testing {

/// A share of the light with a normal blur.
struct SourceHalo {
  double share = 0, sigma_px = 1;
};

inline SensorSpec sharp_sensor(double f_number) {
  SensorSpec sensor = *load_sensor("sc2000");
  sensor.f_number = f_number;
  return sensor;
}

/// Signal in the middle of a square: image formation without the halo, and the normal blur in closed form.
inline double middle_of_square(double side_px, const SensorSpec& sharp, SourceHalo halo) {
  const ImageChain chain(sharp, full_plan(sharp, {}, {}), Accuracy::reference());
  const double h = 0.5 * side_px;
  const double core = chain.infinite_plane({{-h, -h}, {h, -h}, {h, h}, {-h, h}}, {0, 0}, 1, {1, 1}).values(0, 0);
  const double spread = std::pow(std::erf(side_px / (2 * std::sqrt(2.0) * halo.sigma_px)), 2);
  return (1 - halo.share) * core + halo.share * spread;
}

struct SourceSizeCoverage {
  static constexpr std::array sides_px{6.0, 10.0, 20.0};
  std::array<double, sides_px.size()> within{}, mean_error{}, half_width{}, truth{};
  std::array<double, 3> point_within{};  ///< of the apertures of 6, 10 and 20 px
  double slope_error = 0, consistent = 0;
  int runs = 0;
};

/// Pictures of the shipped plate before an sc2000 at 2 m with that noise over the contrast. The halo is OpenCV's blur
/// of a frame that reaches far beyond the camera's. The responsivity of the pixels varies by 0.3 %, their offset by 5
/// %.
inline Result<SourceSizeCoverage> source_size_coverage(SourceHalo halo, double f_number, double noise, int seeds) {
  constexpr int margin = 160;
  SensorSpec wide = sharp_sensor(f_number);
  const cv::Size camera(wide.width, wide.height);
  wide.width += 2 * margin, wide.height += 2 * margin;
  const SensorModel model(wide, full_plan(wide, {}, {}), Accuracy::draft(), 1);
  PlateScene scene;
  scene.plate = *load_plate("apertures");
  const cv::Mat1d sharp = *model.unit_signal(scene);
  cv::Mat1d blurred;
  cv::GaussianBlur(sharp, blurred, {}, halo.sigma_px, halo.sigma_px, cv::BORDER_REPLICATE);
  const cv::Mat1d unit = cv::Mat1d(halo.share * blurred + (1 - halo.share) * sharp)(cv::Rect({margin, margin}, camera));
  Registration where;
  const double scale = 1 / (scene.distance_m * wide.ifov_mrad());
  where.plate_to_pixel = {scale, 0, (camera.width - 1) / 2.0 + 3, 0, scale, (camera.height - 1) / 2.0 - 2, 0, 0, 1};
  SourceSizeCoverage out;
  const SensorSpec sensor = sharp_sensor(f_number);
  // The mean of the picture over a window round the middle of a rectangle; the other cut-outs light it, too.
  const auto seen_at = [&](std::size_t rectangle, int window_px) {
    const cv::Point2d at = where.pixel(scene.plate.rectangles[rectangle].position_mm) + cv::Point2d(-3, 2);
    return cv::mean(unit(cv::Rect(static_cast<int>(std::lround(at.x)) - window_px / 2,
                                  static_cast<int>(std::lround(at.y)) - window_px / 2, window_px, window_px)))[0];
  };
  const double reference_px = 160 * scale, reference = middle_of_square(reference_px, sensor, halo);
  for (std::size_t k = 0; k < out.sides_px.size(); ++k)
    out.truth[k] = 1 - middle_of_square(out.sides_px[k], sensor, halo) / reference;
  for (int seed = 1; seed <= seeds; ++seed) {
    const RandomStream random(static_cast<std::uint64_t>(seed), "noise of a source");
    SourcePictures pictures{cv::Mat1d(camera), cv::Mat1d(camera), cv::Mat1d(camera)};
    std::uint64_t next = 0;
    for (int row = 0; row < camera.height; ++row) {
      for (int x = 0; x < camera.width; ++x) {
        const double gain = 1 + 0.003 * random.normal(next++), offset = 0.05 * random.normal(next++);
        pictures.before(row, x) = offset + noise * random.normal(next++);
        pictures.lit(row, x) = gain * unit(row, x) + offset + noise * random.normal(next++);
        pictures.after(row, x) = offset + noise * random.normal(next++);
      }
    }
    const auto found = source_size(pictures, scene.plate, where);
    if (!found) return tl::unexpected(found.error());
    ++out.runs;
    out.consistent += found->consistent ? 1 : 0;
    out.slope_error += found->reference_k / seen_at(0, 5) - 1;
    for (std::size_t k = 0; k < out.sides_px.size(); ++k) {
      const Estimate loss = found->loss(out.sides_px[k]);
      out.within[k] += loss.low <= out.truth[k] && out.truth[k] <= loss.high ? 1 : 0;
      out.mean_error[k] += loss.value - out.truth[k];
      out.half_width[k] += 0.5 * (loss.high - loss.low);
    }
    // Apertures from small to large.
    constexpr std::array<std::size_t, 3> rectangles{3, 2, 1};
    constexpr std::array windows_px{1, 5, 5};
    for (std::size_t k = 0; k < rectangles.size(); ++k) {
      const Estimate& ratio = found->points[k].ratio;
      const double truth = seen_at(rectangles[k], windows_px[k]) / seen_at(0, 5);
      out.point_within[k] += ratio.low <= truth && truth <= ratio.high ? 1 : 0;
    }
  }
  for (std::size_t k = 0; k < out.sides_px.size(); ++k)
    out.within[k] /= out.runs, out.mean_error[k] /= out.runs, out.half_width[k] /= out.runs;
  for (double& share : out.point_within) share /= out.runs;
  out.slope_error /= out.runs, out.consistent /= out.runs;
  return out;
}

}  // namespace todbench::testing
