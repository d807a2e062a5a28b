// SPDX-License-Identifier: GPL-3.0-or-later
// How often the MTF of a plate's squares holds that of the sensor model: for the test and the study.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "bench/plan/descriptions.h"
#include "sim_devices/sensor/sensor_model.h"
#include "sim_devices/sensor/transfer_functions.h"
#include "tod/camera_measures/edge_measure.h"
#include "tod/measures/mtf50.h"

namespace todbench::testing {

/// One square in the middle and four in the corners of the picture of an sc2000 at 2 m.
inline TargetPlate five_squares() {
  TargetPlate plate{.name = "five", .description = "", .width_mm = 780, .height_mm = 580, .triangles = {}};
  plate.rectangles = {{"centre", {0, 0}, {60, 60}, 5}};
  for (const double x : {-330.0, 330.0}) {
    for (const double y : {-230.0, 230.0})
      plate.rectangles.push_back({fmt::format("corner {:g}, {:g}", x, y), {x, y}, {60, 60}, -6});
  }
  return plate;
}

struct EdgeCoverage {
  static constexpr std::array frequencies{0.1, 0.25, 0.5};
  std::array<double, frequencies.size()> within{};  ///< share of the edges whose interval holds the closed form
  std::array<double, frequencies.size()> mean_error{};
  double half_within = 0;  ///< the same of the frequency at which the MTF is 0.5
  int edges = 0, single_sided = 0;
  double largest_error = 0;
};

/// A share of the light with a normal blur, narrow enough for the plate to belong to the MTF.
struct EdgeHalo {
  double share = 0, sigma_px = 1;
};

/// Noise of 0.0015 of the step: 0.1 K in the mean of 64 frames over 8 K. The mapping is 3 and 2 pixels off, as that of
/// another plate in the same holder.
inline Result<EdgeCoverage> edge_coverage(double aberration_pitch, int seeds, double f_number, EdgeHalo halo = {}) {
  SensorSpec sensor = *load_sensor("sc2000");
  sensor.aberration_sigma_pitch = aberration_pitch, sensor.f_number = f_number;
  const SensorModel model(sensor, full_plan(sensor, {}, {}), Accuracy::draft(), 1);
  const TransferFunction truth = sensor_transfer(sensor, model.plan(), Accuracy::draft().wavelengths);
  PlateScene scene;
  scene.plate = five_squares();
  const cv::Mat1d sharp = *model.unit_signal(scene);
  cv::Mat1d unit;
  cv::GaussianBlur(sharp, unit, {}, halo.sigma_px, halo.sigma_px, cv::BORDER_REPLICATE);
  unit = halo.share * unit + (1 - halo.share) * sharp;
  Registration where;
  const double scale = 1 / (scene.distance_m * sensor.ifov_mrad());
  where.plate_to_pixel = {scale, 0, (sensor.width - 1) / 2.0 + 3, 0, scale, (sensor.height - 1) / 2.0 - 2, 0, 0, 1};
  EdgeCoverage out;
  for (int seed = 1; seed <= seeds; ++seed) {
    const RandomStream random(static_cast<std::uint64_t>(seed), "noise of an edge");
    cv::Mat1d picture(unit.size());
    std::uint64_t pixel = 0;
    for (int row = 0; row < picture.rows; ++row)
      for (int x = 0; x < picture.cols; ++x) picture(row, x) = unit(row, x) + 0.0015 * random.normal(pixel++);
    const auto found = plate_edges(picture, scene.plate, where);
    if (!found) return tl::unexpected(found.error());
    for (const EdgeMtf& edge : found->edges) {
      ++out.edges;
      out.single_sided += edge.sides == 2 ? 0 : 1;
      const double angle = edge.angle_deg * std::numbers::pi / 180;
      const auto expected_at = [&](double f) {
        const double u = f * std::cos(angle), w = f * std::sin(angle);
        const double spread = std::exp(-2 * std::pow(std::numbers::pi * halo.sigma_px * f, 2));
        return std::abs(edge.axis == EdgeAxis::x ? truth(u, w) : truth(w, u)) * (1 - halo.share + halo.share * spread);
      };
      double below = 0.1, above = 1;  // the MTF of these sensors is 0.5 once between them
      for (int i = 0; i < 40; ++i) (expected_at(0.5 * (below + above)) > 0.5 ? below : above) = 0.5 * (below + above);
      const Interval half = mtf50_interval(edge.frequency_per_pitch, edge.low, edge.high);
      out.half_within += half.low.value_or(0) <= below && above <= half.high.value_or(1) ? 1 : 0;
      for (std::size_t k = 0; k < EdgeCoverage::frequencies.size(); ++k) {
        const double f = EdgeCoverage::frequencies[k], expected = expected_at(f);
        out.within[k] += edge.low_at(f) <= expected && expected <= edge.high_at(f) ? 1 : 0;
        out.mean_error[k] += edge.at(f) - expected;
        out.largest_error = std::max(out.largest_error, std::abs(edge.at(f) - expected));
      }
    }
  }
  for (std::size_t k = 0; k < EdgeCoverage::frequencies.size(); ++k)
    out.within[k] /= out.edges, out.mean_error[k] /= out.edges;
  out.half_within /= out.edges;
  return out;
}

}  // namespace todbench::testing
