// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/image_chain.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "sim_devices/sensor/transfer_functions.h"
#include "tests/sim_devices/reference.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

using test::reference;
using test::sc2000;

Polygon shape_of(const nlohmann::json& item) {
  return triangle(item.at("S"), static_cast<Apex>(item.at("orient").get<int>()), {item.at("cx"), item.at("cy")});
}

// The second radiation constant enters the spectral weights; its eleventh digit moves pixels by 2e-12.
TEST(ImageChain, PixelsOfPeriod32EqualTheReference) {
  const SensorSpec spec = sc2000();
  const FilterTable filter({.period = 32, .band = 203}, sensor_transfer(spec, full_plan(spec, {}, {}), 16));
  const auto document = reference();
  for (const auto& item : document.at("pixels")) {
    const PolygonImage image(shape_of(item), filter);

    const cv::Mat1d values = image.sample({-4, -4}, 1, {9, 9});

    for (int j = 0; j < 9; ++j) {
      for (int i = 0; i < 9; ++i) {
        EXPECT_NEAR(values(j, i),
                    item["values_period32"][static_cast<std::size_t>(j)][static_cast<std::size_t>(i)].get<double>(),
                    1e-11);
      }
    }
  }
}

TEST(ImageChain, PixelsOfAnInfinitePlaneEqualTheReferenceAndStayWithinTheStatedError) {
  const SensorSpec spec = sc2000();
  const ImageChain chain(spec, full_plan(spec, {}, {}), Accuracy::reference());
  const auto document = reference();
  for (const auto& item : document.at("pixels")) {
    const auto plane = chain.infinite_plane(shape_of(item), {-4, -4}, 1, {9, 9});

    for (int j = 0; j < 9; ++j) {
      for (int i = 0; i < 9; ++i) {
        // The reference states its own error: 2e-8.
        EXPECT_NEAR(
            plane.values(j, i),
            item["values_infinite_plane"][static_cast<std::size_t>(j)][static_cast<std::size_t>(i)].get<double>(),
            1e-7);
      }
    }
    EXPECT_LT(plane.max_error_estimate, 1e-6);
  }
}

TEST(ImageChain, EveryAccuracyLevelKeepsItsWrapTolerance) {
  const SensorSpec spec = sc2000();
  const SensorPlan plan = full_plan(spec, {}, {});
  for (const Accuracy& accuracy : {Accuracy::draft(), Accuracy::normal(), Accuracy::reference()}) {
    Accuracy exact = Accuracy::reference();
    exact.wavelengths = accuracy.wavelengths;  // only the wrapped signal is looked at
    const ImageChain chain(spec, plan, accuracy);
    const ImageChain best(spec, plan, exact);
    for (const double size : {0.3, 1.6, 2.6, 5.2}) {
      const Polygon shape = triangle(size, Apex::up);

      const cv::Mat1d values = chain.image(shape).sample({-4, -4}, 1, {9, 9});

      const auto truth = best.infinite_plane(shape, {-4, -4}, 1, {9, 9});
      EXPECT_LT(cv::norm(values, truth.values, cv::NORM_INF),
                accuracy.wrap_tolerance * std::max(1.0, std::pow(size / 2.6, 2)))
          << size;
    }
  }
}

TEST(ImageChain, HoldsAllPhasesOnTheFineImage) {
  const SensorSpec spec = sc2000();
  const ImageChain chain(spec, full_plan(spec, {}, {}), Accuracy::normal());
  const PolygonImage image = chain.image(triangle(1.6, Apex::left));

  const cv::Mat1d fine = image.fine_image(chain.points_per_pitch());
  const cv::Mat1d shifted = image.sample({-2 + 3 / 16.0, -2 - 5 / 16.0}, 1, {5, 5});

  const int k = chain.points_per_pitch();
  const int n = fine.rows;
  for (int j = 0; j < 5; ++j) {
    for (int i = 0; i < 5; ++i) {
      const int y = ((-2 + j) * k - 5 * k / 16 + n) % n;
      const int x = ((-2 + i) * k + 3 * k / 16 + n) % n;
      EXPECT_NEAR(fine(y, x), shifted(j, i), 1e-13);
    }
  }
}

/// Mean over a detector's side of a strip from -half to half behind a normal blur, one axis.
double strip_on_detector(double at, double half, double side, double sigma) {
  // The integral of the normal distribution function.
  const auto integral = [&](double x) {
    const double z = x / sigma;
    return x * 0.5 * std::erfc(-z / std::numbers::sqrt2) +
           sigma * std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
  };
  const auto edge = [&](double border) {
    return (integral(at + side / 2 - border) - integral(at - side / 2 - border)) / side;
  };
  return edge(-half) - edge(half);
}

TEST(ImageChain, AveragesOverADetectorThatIsNoSquare) {
  SensorSpec spec = test::sc2000();
  spec.detector_um = 0.9 * spec.pitch_um, spec.detector_y_um = 0.4 * spec.pitch_um;
  spec.aberration_sigma_pitch = 0.3;
  const ImageChain chain(spec, full_plan(spec, {Effect::diffraction}, {}), Accuracy::normal());
  const Polygon square{{-1.7, -1.7}, {1.7, -1.7}, {1.7, 1.7}, {-1.7, 1.7}};
  const cv::Mat1d seen = chain.infinite_plane(square, {-2.6, -2.4}, 0.4, {14, 14}).values;
  for (int j = 0; j < seen.rows; ++j) {
    for (int i = 0; i < seen.cols; ++i) {
      EXPECT_NEAR(seen(j, i),
                  strip_on_detector(0.4 * i - 2.6, 1.7, 0.9, 0.3) * strip_on_detector(0.4 * j - 2.4, 1.7, 0.4, 0.3),
                  2e-4)
          << i << " " << j;
    }
  }
}

}  // namespace
}  // namespace todbench
