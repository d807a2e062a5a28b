// SPDX-License-Identifier: GPL-3.0-or-later
// Wrapped signal and truncated band at every accuracy level against the tolerances that the level states.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim_devices/sensor/image_chain.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

double largest_difference(const cv::Mat1d& a, const cv::Mat1d& b) {
  double largest = 0;
  for (int j = 0; j < a.rows; ++j) {
    for (int i = 0; i < a.cols; ++i) largest = std::max(largest, std::abs(a(j, i) - b(j, i)));
  }
  return largest;
}

class AccuracyBounds : public ::testing::TestWithParam<const char*> {};

// Hard: the wrapped tail is a sum over all periods, conditionally convergent in practice; the reference is the infinite
// plane, by extrapolation from two periods with a bound of its own. Diffraction ends the band exactly, so that only
// wrapping is left.
TEST_P(AccuracyBounds, WrappedSignalStaysWithinTheStatedTolerance) {
  const Accuracy accuracy = Accuracy::named(GetParam()).value();
  const SensorSpec spec;
  const SensorPlan plan = full_plan(spec, {}, {});
  Accuracy same_optics = accuracy.wrap_tolerance < 1e-5 ? accuracy : Accuracy::normal();
  same_optics.wavelengths = accuracy.wavelengths;
  const ImageChain chain(spec, plan, accuracy), reference(spec, plan, same_optics);
  for (const double size : {0.01, 1.0, 2.6, 6.0}) {
    if (size > 2 && accuracy.wrap_tolerance < 1e-5) break;  // seconds each
    for (const cv::Point2d centre : {cv::Point2d(0.5, 0.5), cv::Point2d(0.31, -0.17)}) {
      const Polygon shape = triangle(size, Apex::right, centre);
      const int half = static_cast<int>(std::ceil(size)) + 3;
      const cv::Size window(2 * half + 1, 2 * half + 1);
      const cv::Point2d first(-half, -half);

      const cv::Mat1d values = chain.image(shape).sample(first, 1, window);
      const auto plane = reference.infinite_plane(shape, first, 1, window);

      EXPECT_LE(largest_difference(values, plane.values), accuracy.wrap_tolerance + plane.max_error_estimate)
          << "size " << size << " at " << centre;
    }
  }
}

// Hard: on small pixels the diffraction spot, and with it the wrapped tail, is four to eight times as wide in pitches
// as on the pixels for which the tail was measured.
TEST_P(AccuracyBounds, WrappedSignalStaysWithinTheStatedToleranceOnSmallPixels) {
  const Accuracy accuracy = Accuracy::named(GetParam()).value();
  struct Optics {
    double pitch_um, f_number, from_um, to_um;
  };
  for (const Optics& optics : {Optics{12, 1.4, 7.5, 14}, Optics{10, 4, 3.4, 5}}) {
    SensorSpec spec;
    spec.pitch_um = optics.pitch_um;
    spec.detector_um = 0.9 * optics.pitch_um;
    spec.f_number = optics.f_number;
    spec.wavelength_min_um = optics.from_um;
    spec.wavelength_max_um = optics.to_um;
    const ImageChain chain(spec, full_plan(spec, {}, {}), accuracy);
    for (const double size : {0.3, 2.0}) {
      const Polygon shape = triangle(size, Apex::right, {0.31, -0.17});

      const cv::Mat1d values = chain.image(shape).sample({-5, -5}, 1, {11, 11});
      const auto plane = chain.infinite_plane(shape, {-5, -5}, 1, {11, 11});

      EXPECT_LE(largest_difference(values, plane.values), accuracy.wrap_tolerance + plane.max_error_estimate)
          << "size " << size << " pitch " << optics.pitch_um;
    }
  }
}

// Hard: without diffraction the spectrum of a sharp shape never ends; aberration has to end it. Twice the band is the
// reference.
TEST_P(AccuracyBounds, TheBandThatIsLeftOutStaysWithinTheStatedTolerance) {
  Accuracy accuracy = Accuracy::named(GetParam()).value();
  SensorSpec spec;
  spec.aberration_sigma_pitch = 0.3;
  const SensorPlan plan = full_plan(spec, {Effect::diffraction}, {});
  Accuracy wider = accuracy;
  wider.band_tolerance = 1e-14;
  const ImageChain chain(spec, plan, accuracy), reference(spec, plan, wider);
  for (const double size : {0.01, 0.5, 1.6, 5.0}) {
    const Polygon shape = triangle(size, Apex::up, {0.2, 0.1});

    const cv::Mat1d values = chain.image(shape).sample({-6, -6}, 1, {13, 13});
    const cv::Mat1d exact = reference.image(shape).sample({-6, -6}, 1, {13, 13});

    EXPECT_LE(largest_difference(values, exact), accuracy.band_tolerance) << size;
  }
}

INSTANTIATE_TEST_SUITE_P(Levels, AccuracyBounds, ::testing::Values("draft", "normal", "reference"),
                         [](const auto& level) { return std::string(level.param); });

}  // namespace
}  // namespace todbench
