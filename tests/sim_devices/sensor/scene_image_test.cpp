// SPDX-License-Identifier: GPL-3.0-or-later
// Frames of scenes against the images of single polygons, which the references hold.
#include "sim_devices/sensor/scene_image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim_devices/scene/target_model.h"
#include "sim_devices/sensor/image_chain.h"
#include "sim_devices/sensor/scene_signal.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tests/sim_devices/reference.h"
#include "tests/sim_devices/test_plates.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

SensorSpec sensor_of(int microscan) {
  SensorSpec spec = test::sc2000();
  spec.microscan = microscan;
  return spec;
}

Polygon rectangle(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

TEST(VisibleEdges, AreThoseOfWhatIsNotCovered) {
  const std::vector<PaintedPolygon> painted{{rectangle(0, 0, 4, 3), 2}, {rectangle(1, 1, 6, 2), 5}};

  EXPECT_NEAR(integral(visible_edges(painted)), 2 * (12 - 3) + 5 * 5, 1e-12);
}

TEST(VisibleEdges, OfNeighboursCountTheirCommonEdgeOnce) {
  const std::vector<PaintedPolygon> alike{{rectangle(0, 0, 1, 1), 3}, {rectangle(1, 0, 2, 1), 3}};
  const std::vector<PaintedPolygon> unlike{{rectangle(0, 0, 1, 1), 3}, {rectangle(1, -1, 2, 1), 4}};

  EXPECT_EQ(visible_edges(alike).size(), 6u);
  EXPECT_NEAR(integral(visible_edges(alike)), 6, 1e-12);
  EXPECT_NEAR(integral(visible_edges(unlike)), 11, 1e-12);
}

TEST(VisibleEdges, OfWhatIsCoveredWhollyAreNone) {
  const std::vector<PaintedPolygon> painted{{rectangle(1, 1, 2, 2), 7}, {rectangle(0, 0, 3, 3), 1}};

  EXPECT_EQ(visible_edges(painted).size(), 4u);
}

TEST(Polygons, ThatCrossThemselvesAreNotSimple) {
  EXPECT_TRUE(is_simple(rectangle(0, 0, 1, 1)));
  EXPECT_FALSE(is_simple({{0, 0}, {1, 1}, {1, 0}, {0, 1}}));
  EXPECT_FALSE(is_simple({{0, 0}, {2, 0}, {1, 0}}));
  EXPECT_FALSE(is_simple({{0, 0}, {1, 0}}));
  EXPECT_FALSE(is_simple({{0, 0}, {4, 0}, {4, 2}, {2, 0}, {0, 2}}));  // touches itself
}

double largest_difference(const SensorSpec& spec, const Polygon& shape_pitch, cv::Size size, SceneMotion motion = {}) {
  const SensorPlan plan = full_plan(spec, {}, {}, motion);
  const int n = spec.samples_per_pitch();
  const ImageChain chain(spec, plan, Accuracy::normal(), motion);
  const cv::Mat1d exact = chain.infinite_plane(shape_pitch, {0, 0}, 1.0 / n, size).values;
  const SceneImager imager(spec, plan, Accuracy::normal(), motion);

  const PaintedPolygon painted{placed(shape_pitch, n, {0, 0}), 1};
  const cv::Mat1d found = imager.image(visible_edges(std::span(&painted, 1)), size);

  return cv::norm(exact, found, cv::NORM_INF);
}

// What is left out beyond the reach of a cell and beyond the degree; found: 4e-7 to 2.3e-5, growing with the size.
TEST(SceneImager, EqualsTheImageOfThePolygonAlone) {
  for (const int microscan : {1, 2}) {
    const cv::Size size(20 * microscan, 20 * microscan);
    EXPECT_LT(largest_difference(sensor_of(microscan), triangle(0.4, Apex::up, {9.31, 8.72}), size), 3e-6);
    EXPECT_LT(largest_difference(sensor_of(microscan), triangle(5.3, Apex::right, {9.31, 8.72}), size), 3e-5);
  }
}

TEST(SceneImager, SmearsWhatMoves) {
  SensorSpec spec = sensor_of(1);
  spec.time_constant_ms = 10;

  EXPECT_LT(largest_difference(spec, triangle(2.1, Apex::up, {9.31, 8.72}), {20, 20}, {60, 25}), 3e-5);
}

// A plate of triangles, turned and out of the middle, is the same scene whichever way it is imaged.
TEST(SceneImager, ShowsAPlateAsTheSensorDoes) {
  const SensorSpec spec = sensor_of(1);
  const SensorPlan plan = full_plan(spec, {}, {});
  PlateScene before;
  before.plate = test::two_plates().front();
  before.rotation_deg = 7;
  const SensorModel model(spec, plan, Accuracy::normal(), 1);
  const cv::Mat1f expected = *model.unit_signal(before);

  const RadianceScale scale{{spec.wavelength_min_um, spec.wavelength_max_um}, 300};
  const FieldScene scene = scene_of_plate(before.plate, 1e-3, 300);  // where Planck's law is straight
  const auto found =
      scene_signal_k(SceneImager(spec, plan, Accuracy::normal()), spec, scene, scale,
                     {.range_m = before.distance_m, .rotation_deg = 7, .centre_pitch = before.centre_px}, model.size());

  ASSERT_TRUE(found.has_value());
  // Radiance is curved by 1e-5 of the contrast over 1 mK; tails of the periods 2e-5.
  EXPECT_LT(cv::norm(cv::Mat1d(expected), cv::Mat1d(*found * 1e3), cv::NORM_INF), 1e-4);
}

TEST(SceneImager, ShowsAPictureAsTheSquaresItIsMadeOf) {
  const SensorSpec spec = sensor_of(1);
  const SceneImager imager(spec, full_plan(spec, {}, {}), Accuracy::normal());
  const cv::Size size(24, 20);
  cv::Mat1d picture = cv::Mat1d::zeros(40, 60);
  picture(cv::Rect(7, 9, 20, 13)) = 2;
  picture(cv::Rect(20, 15, 30, 2)) = -3;
  const double element = 0.23;
  const cv::Point2d first(4.1, 5.3);
  const auto place = [&](double column, double row) { return first + cv::Point2d(column - 0.5, row - 0.5) * element; };
  const auto painted = [&](int x, int y, int w, int h, double level) {
    const auto low = place(x, y), high = place(x + w, y + h);
    return PaintedPolygon{rectangle(low.x, low.y, high.x, high.y), level};
  };
  const std::vector<PaintedPolygon> squares{painted(7, 9, 20, 13, 2), painted(20, 15, 30, 2, -3)};

  EXPECT_LT(
      cv::norm(imager.image(picture, element, first, size), imager.image(visible_edges(squares), size), cv::NORM_INF),
      1e-5);
}

FieldScene two_halves() {
  FieldScene scene;
  scene.background_k = 300;
  scene.regions = {{"cold half", rectangle(0, 0, 1, 2), 301, 1, true},
                   {"warm half", rectangle(1, 0, 2, 2), 303, 1, true}};
  return scene;
}

TEST(TargetSignature, IsMeanAndSpreadOverTheVisibleTarget) {
  const RadianceScale scale{{7.5, 13}, 302};
  FieldScene scene = two_halves();
  const double low = scale.kelvin(band_radiance(scale.band, 301) - band_radiance(scale.band, 300));
  const double high = scale.kelvin(band_radiance(scale.band, 303) - band_radiance(scale.band, 300));

  const auto found = target_signature(scene, scale);

  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->size_m(), 2, 1e-12);
  EXPECT_NEAR(found->mean_dt_k, (low + high) / 2, 1e-12);
  EXPECT_NEAR(found->sd_k, (high - low) / 2, 1e-9);
  EXPECT_NEAR(found->dt_rss_k(), std::sqrt((low * low + high * high) / 2), 1e-9);
}

TEST(TargetSignature, OfAPictureIsThatOfItsMask) {
  const RadianceScale scale{{7.5, 13}, 302};
  FieldScene scene;
  scene.picture = ScenePicture{cv::Mat1d(10, 10, 300.0), cv::Mat1b::zeros(10, 10), 0.1};
  scene.picture->kelvin(cv::Rect(2, 3, 4, 2)) = 303;
  scene.picture->target(cv::Rect(2, 3, 4, 2)) = 255;

  const auto found = target_signature(scene, scale);

  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->area_m2, 8 * 0.01, 1e-12);
  EXPECT_NEAR(found->dt_rss_k(), scale.kelvin(band_radiance(scale.band, 303) - band_radiance(scale.band, 300)), 1e-9);
}

TEST(Scenes, ThatCannotBeAreRefused) {
  const auto refused = [](const std::function<void(FieldScene&)>& change) {
    FieldScene scene = two_halves();
    change(scene);
    return !validate(scene).has_value();
  };
  EXPECT_TRUE(validate(two_halves()).has_value());
  EXPECT_TRUE(refused([](FieldScene& s) { s.regions[0].outline_m = {{0, 0}, {1, 1}, {1, 0}, {0, 1}}; }));
  EXPECT_TRUE(refused([](FieldScene& s) { s.regions[0].temperature_k = -1; }));
  EXPECT_TRUE(refused([](FieldScene& s) { s.regions[1].emissivity = 1.2; }));
  EXPECT_TRUE(refused([](FieldScene& s) { s.background_k = 0; }));
  EXPECT_TRUE(refused([](FieldScene& s) { s.regions[0].outline_m[2].x = std::nan(""); }));
  EXPECT_TRUE(refused([](FieldScene& s) { s.regions.clear(); }));
  EXPECT_TRUE(refused([](FieldScene& s) {
    s.regions.clear();
    s.picture = ScenePicture{cv::Mat1d(4, 4, 300.0), {}, 0};
  }));
}

TEST(Scenes, SmallerThanAPixelAndPicturesTooCoarseAreRefused) {
  const SensorSpec spec = sensor_of(1);
  const SceneImager imager(spec, full_plan(spec, {}, {}), Accuracy::draft());
  const RadianceScale scale{};
  FieldScene picture;
  picture.picture = ScenePicture{cv::Mat1d(100, 100, 301.0), {}, 0.04};  // 0.04 m, a quarter at 122.27 m
  const auto at = [&](const FieldScene& scene, double range_m, double rotation_deg = 0) {
    return scene_signal_k(imager, spec, scene, scale, {.range_m = range_m, .rotation_deg = rotation_deg}, {16, 16})
        .has_value();
  };

  EXPECT_TRUE(at(two_halves(), 1500));
  EXPECT_FALSE(at(two_halves(), 1600));
  EXPECT_FALSE(at(two_halves(), 0));
  EXPECT_TRUE(at(picture, 123));
  EXPECT_FALSE(at(picture, 122));
  EXPECT_FALSE(at(picture, 200, 3));
}

TEST(TargetModel, ShowsItsProfileFromTheSideAndItsWidthFromAhead) {
  const TargetModel box{"box", "", {{"body", rectangle(-2, 0, 2, 1), 3, 0, 310, 1}}};
  const auto seen_area = [&](double azimuth_deg) {
    std::vector<PaintedPolygon> painted;
    for (const auto& region : view_of(box, azimuth_deg)) painted.push_back({region.outline_m, 1});
    return integral(visible_edges(painted));
  };
  const double diagonal = (4 + 3) / std::numbers::sqrt2;

  EXPECT_NEAR(seen_area(90), 4, 1e-9);
  EXPECT_NEAR(seen_area(0), 3, 1e-9);
  EXPECT_NEAR(seen_area(45), diagonal, 1e-9);
  EXPECT_NEAR(seen_area(225), diagonal, 1e-9);
}

}  // namespace
}  // namespace todbench
