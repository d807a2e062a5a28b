// SPDX-License-Identifier: GPL-3.0-or-later
// Super-resolution of a target in motion: the finer picture against that of a camera with microscan, which the sensor
// model forms in another way.
#include <gtest/gtest.h>
#include <cmath>

#include "sim_devices/prediction/dynamic_trials.h"
#include "sim_devices/prediction/trial_plate.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tests/sim_devices/reference.h"
#include "tod/plate/test_pattern.h"
#include "tod/registration/patch_windows.h"

namespace todbench {
namespace {

const std::vector<double> sizes{1.1, 1.4, 1.8};
constexpr double contrast_k = 4, noise_k = 0.07;

/// Unit signal of the plate whose middle is displaced from that of the picture, times the contrast.
cv::Mat1f still_picture(const SensorModel& model, const TargetPlate& plate, cv::Point2d centre_px) {
  PlateScene scene;
  scene.plate = plate;
  scene.distance_m = trial_distance_m;
  scene.centre_px = centre_px;
  return *model.unit_signal(scene) * contrast_k;
}

cv::Point2d place_in(const SensorModel& model, cv::Point2d mm, cv::Point2d centre_px) {
  PlateScene scene;
  scene.distance_m = trial_distance_m;
  scene.centre_px = centre_px;
  return scene_pixel(scene, mm, model.spec().ifov_mrad() / model.spec().samples_per_pitch(), model.size());
}

SensorModel quiet_model(const TargetPlate& plate, int microscan) {
  SensorSpec spec = cropped_to(test::sc2000(), plate, 2);
  spec.microscan = microscan;
  return SensorModel(spec, full_plan(spec, {}, {}), Accuracy::normal(), 1);
}

TEST(MovingResolution, OfFourPlacesJudgesThePictureOfACameraWithMicroscan) {
  const TargetPlate plate = trial_plate(sizes, test::sc2000().ifov_mrad());
  const SensorModel camera = quiet_model(plate, 1), scanned = quiet_model(plate, 2);
  TemplateObserver observer({}, triangle_alternatives());
  const auto judge = SequenceJudge::prepare(observer, sizes).value();
  const cv::Point2d centre(0.21, -0.37);
  // 2.5 pixels to the right and 1.5 down between frames, so that whole pixels are undone as well as halves.
  const std::vector<cv::Point2d> places{{0, 0}, {2.5, 0}, {0, 1.5}, {2.5, 1.5}};
  std::vector<cv::Mat1f> frames;
  for (const cv::Point2d at : places) frames.push_back(still_picture(camera, plate, centre + at));
  const cv::Point2d fine_centre = 2 * centre - cv::Point2d(0.5, 0.5);
  const cv::Mat1f fine = still_picture(scanned, plate, fine_centre);

  int same = 0, decisions = 0;
  for (std::size_t t = 0; t < 4 * sizes.size(); ++t) {
    const cv::Point2d mm = plate.triangles[t].position_mm;
    SeenSequence seen{.frames = frames, .places = {}, .contrast_k = contrast_k, .noise_k = noise_k};
    for (const cv::Point2d at : places) seen.places.push_back(place_in(camera, mm, centre + at));
    const auto prepared = observer.prepare(2 * sizes[t / 4], 2).value();
    const PatchWindow window = patch_window(place_in(scanned, mm, fine_centre), prepared->window_samples());
    Patch patch{.kelvin = {}, .phase = window.phase, .noise_k = noise_k};
    fine(window.pixels).convertTo(patch.kelvin, CV_64F);
    for (std::uint64_t seed = 0; seed < 50; ++seed, ++decisions) {
      const RandomStream noise = RandomStream(seed, "moving_resolution").sub(t);
      same += judge.choose(SequenceObserver::super_resolution, t / 4, seen, noise) ==
                      prepared->choose(patch, contrast_k, noise).alternative
                  ? 1
                  : 0;
    }
  }

  // Both pictures agree to 1e-5 of the contrast; a decision differs where two scores are nearer than that.
  EXPECT_EQ(decisions, 600);
  EXPECT_GE(same, decisions - 2);
}

}  // namespace
}  // namespace todbench
