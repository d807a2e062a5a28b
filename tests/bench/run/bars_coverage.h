// SPDX-License-Identifier: GPL-3.0-or-later
// How often the CTF of the shipped bars holds that of the sensor model: for the test and the study.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "bench/plan/descriptions.h"
#include "sim_devices/sensor/sensor_model.h"
#include "sim_devices/sensor/transfer_functions.h"
#include "tod/camera_measures/bars_measure.h"
#include "tod/range/bars_sampled.h"

namespace todbench::testing {

/// Of one group: shares of the seeds whose interval holds the closed form, and mean errors, of best, mean and worst.
struct GroupCoverage {
  std::string group;
  double frequency_per_pitch = 0;
  BarModulation truth;
  std::array<double, 3> within{}, mean_error{}, half_width{};
};

struct BarsCoverage {
  std::vector<GroupCoverage> groups;
  double far_spread = 0;
  double largest_error = 0;
};

/// Noise of `noise` of the contrast in the mean picture (0.07 K over 8 in 64 frames at 10 K: 0.0009). The mapping is 3
/// and 2 pixels off, as that of another plate in the same holder; each seed has another place of the plate between
/// pixels.
inline Result<BarsCoverage> bars_coverage(const SensorSpec& sensor, double noise, int seeds, int places = 4) {
  const SensorModel model(sensor, full_plan(sensor, {}, {}), Accuracy::draft(), 1);
  const TransferFunction transfer = sensor_transfer(sensor, model.plan(), Accuracy::draft().wavelengths);
  const int samples = sensor.samples_per_pitch();
  BarsCoverage out;
  for (int seed = 1; seed <= seeds; ++seed) {
    PlateScene scene;
    scene.plate = *load_plate("bars");
    scene.centre_px = {0.25 * (seed % places), 0.41 * (seed % places)};
    const auto unit = model.unit_signal(scene);
    Registration where;
    const double scale = samples / (scene.distance_m * sensor.ifov_mrad());
    where.plate_to_pixel = {scale, 0, (unit->cols - 1) / 2.0 + 3, 0, scale, (unit->rows - 1) / 2.0 - 2, 0, 0, 1};
    const RandomStream random(static_cast<std::uint64_t>(seed), "noise of bars");
    cv::Mat1d picture(unit->size());
    std::uint64_t pixel = 0;
    for (int row = 0; row < picture.rows; ++row)
      for (int x = 0; x < picture.cols; ++x) picture(row, x) = (*unit)(row, x) + noise * random.normal(pixel++);
    const auto found = plate_bars_ctf(picture, scene.plate, where);
    if (!found) return tl::unexpected(found.error());
    if (!found->reasons.empty()) return fail(ErrorCode::calibration, found->reasons.front());
    out.far_spread += found->far_spread / seeds;
    out.groups.resize(found->groups.size());
    for (std::size_t i = 0; i < found->groups.size(); ++i) {
      const BarsCtf& group = found->groups[i];
      GroupCoverage& sum = out.groups[i];
      if (seed == 1) {
        const double angle = group.angle_deg * std::numbers::pi / 180;
        const double along = std::cos(angle), across = std::sin(angle);
        const auto of = [&](double f) {
          const double u = f * samples * along, w = f * samples * across;
          return std::real(group.axis == EdgeAxis::x ? transfer(u, w) : transfer(w, u));
        };
        sum.group = group.group, sum.frequency_per_pitch = group.frequency_per_pitch;
        sum.truth = bar_modulation(BlurredBars(group.frequency_per_pitch, of, 8));
      }
      const std::array<std::pair<Estimate, double>, 3> pairs{
          {{group.best, sum.truth.best}, {group.mean, sum.truth.mean}, {group.worst, sum.truth.worst}}};
      for (std::size_t k = 0; k < pairs.size(); ++k) {
        const auto& [modulation, truth] = pairs[k];
        sum.within[k] += (modulation.low <= truth && truth <= modulation.high ? 1.0 : 0.0) / seeds;
        sum.mean_error[k] += (modulation.value - truth) / seeds;
        sum.half_width[k] += 0.5 * (modulation.high - modulation.low) / seeds;
        out.largest_error = std::max(out.largest_error, std::abs(modulation.value - truth));
      }
    }
  }
  return out;
}

}  // namespace todbench::testing
