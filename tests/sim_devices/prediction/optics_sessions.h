// SPDX-License-Identifier: GPL-3.0-or-later
// Set-ups of two plates and four mountings before a camera whose optics and noise are known, for the fit of its optics.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "sim_devices/prediction/camera_halo.h"
#include "sim_devices/prediction/camera_optics.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tests/sim_devices/test_plates.h"

namespace todbench::test {

/// What the frames have beside white noise.
struct OpticsSession {
  SensorSpec camera{};
  double delta_t_k = 16.9;
  double size_ratio = 1;  ///< cut-outs over what the plate file says
  double dead_share = 0;  ///< pixels that show the mean of their neighbours
  bool rounds = false;    ///< every frame to whole counts; else only the average is made
  double halo_share = 0;  ///< of the light, in a halo of 4 pixels
};

/// Pictures without noise, made once.
class OpticsSessions {
 public:
  static constexpr int frames = 32;

  explicit OpticsSessions(OpticsSession session) : session_(std::move(session)) {
    const SensorSpec& camera = session_.camera;
    const SensorModel model(camera, full_plan(camera, {}, {}), Accuracy::normal(), 1);
    for (const TargetPlate& plate : two_plates()) {
      for (const Mounting mounting : all_mountings) {
        PlateScene scene;
        scene.plate = mounted(plate, mounting);
        for (PlateTriangle& t : scene.plate.triangles) t.size_mm *= session_.size_ratio;
        scene.distance_m = 2;
        const auto i = static_cast<double>(pictures_.size());
        scene.centre_px = {0.37 * std::fmod(i, 3), -0.21 * std::fmod(i, 5)};
        cv::Mat1d picture;
        model.unit_signal(scene)->convertTo(picture, CV_64F);
        if (session_.halo_share > 0) {
          cv::Mat1d halo;
          cv::GaussianBlur(picture, halo, {41, 41}, 4);
          picture = (1 - session_.halo_share) * picture + session_.halo_share * halo;
        }
        pictures_.push_back(picture * session_.delta_t_k);
        plates_.push_back(mounted(plate, mounting));
      }
    }
  }

  /// `differs`: whether one of the looks after every set-up says so, each at an eighth of 0.2 %.
  struct Outcome {
    CameraOptics optics;
    bool differs = false;
  };

  /// Gives `use(picture, delta_t_k)` every set-up with its noise. Returns false if a plate is not found.
  template <typename Use>
  [[nodiscard]] bool for_every_picture(const SensorSpec& twin, std::uint64_t seed, Use use) const {
    cv::RNG random(seed);
    const cv::Mat1d pattern = noise(random, session_.camera.fixed_pattern_k);
    const double rho = session_.camera.noise_correlation;
    for (std::size_t i = 0; i < pictures_.size(); ++i) {
      const cv::Mat1d picture = average(pictures_[i] + pattern, random);
      RegistrationOptions registration;
      registration.expected_scale_px_per_mm = session_.camera.samples_per_pitch() / (2 * twin.ifov_mrad());
      const auto found = register_plate(picture, plates_[i], registration);
      if (!found) return false;
      use(OpticsPicture{.picture = picture,
                        .mounted_plate = plates_[i],
                        .registration = *found,
                        .averaged_noise_k = session_.camera.netd_k * std::sqrt((1 + rho) / (1 - rho) / frames)},
          session_.delta_t_k);
    }
    return true;
  }

  /// Halo of the camera by its pictures.
  [[nodiscard]] std::optional<CameraHalo> halo(const SensorSpec& twin, std::uint64_t seed,
                                               double f_number_ratio = 1) const {
    CameraHaloFit fit(twin, session_.camera.samples_per_pitch());
    EXPECT_TRUE(for_every_picture(
        twin, seed, [&](const OpticsPicture& picture, double delta_t_k) { fit.add(picture, delta_t_k); }));
    return fit.result(f_number_ratio);
  }

  [[nodiscard]] std::optional<Outcome> fitted(const SensorSpec& twin, std::uint64_t seed) const {
    CameraOpticsFit fit(twin, session_.camera.samples_per_pitch());
    Outcome out;
    bool added = true;
    const bool found = for_every_picture(twin, seed, [&](const OpticsPicture& picture, double /*delta_t_k*/) {
      added = added && fit.add(picture);
      if (!added) return;
      out.optics = *fit.result();
      out.differs = out.differs || out.optics.differs(0.002 / 8);
    });
    if (!found || !added) return std::nullopt;
    return out;
  }

 private:
  [[nodiscard]] cv::Mat1d noise(cv::RNG& random, double sd) const {
    cv::Mat1d out(pictures_[0].size(), 0.0);
    if (sd > 0) random.fill(out, cv::RNG::NORMAL, 0, sd);
    return out;
  }

  [[nodiscard]] cv::Mat1d average(const cv::Mat1d& signal, cv::RNG& random) const {
    const SensorSpec& camera = session_.camera;
    const double rho = camera.noise_correlation;
    const double averaged = std::sqrt((1 + rho) / (1 - rho) / frames);
    cv::Mat1d out;
    if (session_.rounds) {
      out = cv::Mat1d::zeros(signal.size());
      for (int k = 0; k < frames; ++k) {
        cv::Mat1d counts = (signal + noise(random, camera.netd_k)) / camera.kelvin_per_count;
        for (double& value : counts) value = std::round(value);
        out += counts * (camera.kelvin_per_count / frames);
      }
    } else {
      out = signal + noise(random, camera.netd_k * averaged);
    }
    const double column_k = camera.column_noise_k / std::sqrt(frames), row_k = camera.row_noise_k / std::sqrt(frames);
    if (column_k > 0)
      for (int x = 0; x < out.cols; ++x) out.col(x) += random.gaussian(column_k);
    if (row_k > 0)
      for (int y = 0; y < out.rows; ++y) out.row(y) += random.gaussian(row_k);
    const int dead = static_cast<int>(session_.dead_share * static_cast<double>(out.total()));
    for (int k = 0; k < dead; ++k) {
      const int x = random.uniform(1, out.cols - 1), y = random.uniform(1, out.rows - 1);
      out(y, x) = (out(y, x - 1) + out(y, x + 1) + out(y - 1, x) + out(y + 1, x)) / 4;
    }
    return out;
  }

  OpticsSession session_;
  std::vector<cv::Mat1d> pictures_;
  std::vector<TargetPlate> plates_;
};

template <typename Change>
SensorSpec sensor_with(Change change) {
  SensorSpec sensor;
  change(sensor);
  return sensor;
}

}  // namespace todbench::test
