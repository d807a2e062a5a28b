// SPDX-License-Identifier: GPL-3.0-or-later
// An observer that tells shapes apart: against the template observer of triangles, and the closed form of two.
#include "sim_devices/prediction/identification.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>

#include "acquisition/base/rng.h"
#include "hvs/observer/eye_noise.h"
#include "hvs/observer/identification_bank.h"
#include "hvs/observer/template_bank.h"
#include "hvs/shape/step_image.h"
#include "sim_devices/prediction/identification_views.h"
#include "sim_devices/sensor/image_chain.h"
#include "sim_devices/sensor/scene_image.h"
#include "tests/sim_devices/reference.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

std::vector<StepEdge> edges_of(const Polygon& polygon, double level = 1) {
  const PaintedPolygon painted{polygon, level};
  return visible_edges(std::span(&painted, 1));
}

TEST(StepImage, IsTheSumOfTheImagesOfPolygons) {
  const FilterTable filter({.period = 24, .band = 40},
                           [](double u, double w) -> std::complex<double> { return std::exp(-2 * (u * u + w * w)); });
  const Polygon a = triangle(3, Apex::up, {0.3, -0.2}), b = triangle(2, Apex::left, {-5.5, 1.1});
  const std::vector<PaintedPolygon> painted{{a, 1.5}, {b, -0.5}};  // they do not touch

  const cv::Mat1d found = fine_step_image(visible_edges(painted), filter, 4);
  const cv::Mat1d expected = 1.5 * PolygonImage(a, filter).fine_image(4) - 0.5 * PolygonImage(b, filter).fine_image(4);

  EXPECT_LT(cv::norm(found, expected, cv::NORM_INF), 1e-12);
}

TEST(ElementEdges, HaveTheMeansOfTheElementsAndJoinEqualSteps) {
  cv::Mat1d levels(3, 4, 0.0);
  levels(cv::Rect(1, 0, 2, 2)) = 2.5;
  levels(1, 2) = -1;
  levels(2, 3) = 4;
  const cv::Mat1d means = SceneImager::means(element_edges(levels, 1, {1.5, 2.5}), {8, 7});
  cv::Mat1d expected(7, 8, 0.0);
  levels.copyTo(expected(cv::Rect(2, 3, 4, 3)));
  EXPECT_LT(cv::norm(means, expected, cv::NORM_INF), 1e-12);
  // A block of any number of elements has four edges.
  EXPECT_EQ(element_edges(cv::Mat1d(5, 9, 3.0), 0.1, {0, 0}).size(), 4u);
}

TEST(Identification, NumbersEveryPictureOfTheLargestSetDifferently) {
  std::set<std::uint64_t> numbers;
  for (std::size_t target = 0; target < 64; ++target) {
    for (std::size_t aspect = 0; aspect < most_aspects; ++aspect) {
      for (std::size_t phase = 0; phase < identification_phases; ++phase)
        EXPECT_TRUE(numbers.insert(presentation_of(phase, target, aspect)).second) << target << " " << aspect;
    }
  }
}

TEST(IdentificationBank, ScoresTrianglesAsTheTemplateObserverDoes) {
  const TemplateObserverSpec observer;
  const double size = 1.6;
  std::vector<AlternativeAspects> alternatives;
  for (const Apex apex : all_apexes) alternatives.push_back({edges_of(triangle(size, apex))});
  const auto bank = IdentificationBank::build(observer, alternatives, 1);
  const auto known = TemplateBank::build(observer, triangle_alternatives(), size, 1);
  ASSERT_TRUE(bank && known);
  ASSERT_EQ(bank->window_samples(), known->window_samples());
  const SensorSpec spec = test::sc2000();
  const int side = bank->window_samples();
  cv::Mat1f patch;
  ImageChain(spec, full_plan(spec, {}, {}), Accuracy::draft())
      .image(triangle(size, Apex::right, {0.21, -0.37}))
      .sample({0.5 - side / 2.0, 0.5 - side / 2.0}, 1, {side, side})
      .convertTo(patch, CV_32F);
  patch -= cv::mean(patch)[0];

  const auto found = bank->project(patch);
  std::vector<float> expected(known->padded_templates());
  known->project(std::span(patch.ptr<float>(), patch.total()), expected);

  ASSERT_EQ(found.size(), static_cast<std::size_t>(known->templates()));
  for (std::size_t t = 0; t < found.size(); ++t) ASSERT_NEAR(found[t], expected[t], 1e-4) << t;
}

/// hvs-2 at 3 arcmin a displayed sample, with a background of `luminance`.
TemplateObserverSpec identifying_eye(double luminance_cd_m2 = 50) {
  return {.name = "hvs-2",
          .internal_noise = 0,
          .sensor_noise_factor = 1.75,
          .eye = EyeParameters{},
          .window_margin_arcmin = 6,
          .display = ViewedDisplay{.pixel_pitch_mm = 1000 * 2 * std::tan(3 / 120.0 * std::numbers::pi / 180),
                                   .viewing_distance_m = 1,
                                   .luminance_white_cd_m2 = 2 * luminance_cd_m2}};
}

// The bank of arbitrary shapes against that of triangles: signal, and covariance of the noise of the eye as the product
// of the responses to single points of its lattice.
TEST(IdentificationBank, SeesTrianglesWithTheEyeOfTheTemplateObserver) {
  const TemplateObserverSpec observer = identifying_eye();
  const double size = 1.6, contrast_k = 0.3;
  std::vector<AlternativeAspects> alternatives;
  for (const Apex apex : all_apexes) alternatives.push_back({edges_of(triangle(size, apex))});
  const auto bank = IdentificationBank::build(observer, alternatives, 1);
  const auto known = TemplateBank::build(observer, triangle_alternatives(), size, 1);
  ASSERT_TRUE(bank && known);
  const int side = bank->window_samples();
  ASSERT_EQ(side, known->window_samples());
  const SensorSpec spec = test::sc2000();
  cv::Mat1f patch;
  ImageChain(spec, full_plan(spec, {}, {}), Accuracy::draft())
      .image(triangle(size, Apex::right, {0.21, -0.37}))
      .sample({0.5 - side / 2.0, 0.5 - side / 2.0}, 1, {side, side})
      .convertTo(patch, CV_32F);
  const EyeNoise& eye = *known->eye();

  const auto found = bank->project(patch);
  std::vector<float> expected(known->padded_templates());
  known->project(std::span(patch.ptr<float>(), patch.total()), expected);

  // One scale for all templates; it follows from the noise, because both have the same d'.
  const double scale = eye.sd(contrast_k) / (bank->eye_noise_k(observer, 0, 0, contrast_k, 1) / contrast_k);
  const double largest = *std::max_element(expected.begin(), expected.end());
  for (std::size_t t = 0; t < found.size(); ++t)
    ASSERT_NEAR(scale * static_cast<double>(found[t]), static_cast<double>(expected[t]), 0.004 * largest) << t;
  // The window of the noise leaves out 0.2 % of the energy, the lattice 0.01 %.
  EXPECT_NEAR(bank->eye_energy(0, 0, 1) / eye.energy(), 1, 0.005);
  const int points = bank->eye_points();
  std::array<std::size_t, 5> chosen{144, 0, 288, 289 + 144, 3 * 289 + 100};
  std::array<std::array<double, 5>, 5> covariance{};
  for (int row = 0; row < points; ++row) {
    std::vector<cv::Mat1f> pictures;
    for (int column = 0; column < points; ++column) {
      pictures.push_back(cv::Mat1f::zeros(points, points));
      pictures.back()(row, column) = 1;
    }
    for (const auto& scores : bank->project_eye(pictures)) {
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        for (std::size_t j = 0; j < chosen.size(); ++j)
          covariance[i][j] += static_cast<double>(scores[chosen[i]]) * static_cast<double>(scores[chosen[j]]);
      }
    }
  }
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    for (std::size_t j = 0; j < chosen.size(); ++j)
      EXPECT_NEAR(covariance[i][j], eye.covariance(chosen[i], chosen[j]) / eye.energy(), 0.006) << i << ' ' << j;
  }
}

FieldScene triangle_scene(Apex apex, double size_m, double temperature_k = 300.3) {
  FieldScene scene;
  scene.background_k = 300;
  scene.regions = {{"triangle", triangle(size_m, apex), temperature_k, 1, true}};
  return scene;
}

IdentificationTask two_mirror_images() {
  IdentificationTask task;
  task.sensor = test::sc2000();
  task.plan = full_plan(task.sensor, {}, {});
  task.observer.search_range_samples = 0;
  task.knowledge = TemplateKnowledge::ideal;
  task.accuracy = Accuracy::draft();
  task.targets = {{"up", {triangle_scene(Apex::up, 1)}}, {"down", {triangle_scene(Apex::down, 1)}}};
  task.ranges = {{350, 1}};  // 2.18 pitches
  task.decisions = 4000;
  return task;
}

// With two alternatives at a known place the score difference is normal: P = Phi(<a - b, g> / (sd |a - b|)), averaged
// over the 16 phases of the experiment and both triangles.
TEST(Identification, OfTwoMirrorImagesIsTheClosedFormOfTwoAlternatives) {
  const IdentificationTask task = two_mirror_images();
  const SensorSpec& spec = task.sensor;
  const double size_pitch = 1e3 / (350 * spec.ifov_mrad()), contrast_k = 0.3;
  const auto bank = TemplateBank::build(task.observer, {triangle(1, Apex::up), triangle(1, Apex::down)}, size_pitch, 1);
  ASSERT_TRUE(bank.has_value());
  const cv::Mat1f difference = bank->image(0, 0) - bank->image(1, 0);
  const double noise = std::sqrt(spec.netd_k * spec.netd_k + spec.kelvin_per_count * spec.kelvin_per_count / 12 +
                                 std::pow(task.observer.internal_noise * contrast_k, 2));
  const ImageChain chain(spec, task.plan, Accuracy::draft());
  double expected = 0;
  const int side = bank->window_samples();
  for (int phase = 0; phase < 16; ++phase) {
    const cv::Point2d at((phase % 4 + 0.5) / 4 - 0.5, (phase / 4 + 0.5) / 4 - 0.5);
    for (const bool up : {true, false}) {
      cv::Mat1f seen;
      chain.image(triangle(size_pitch, up ? Apex::up : Apex::down))
          .sample(cv::Point2d(0.5 - side / 2.0, 0.5 - side / 2.0) - at, 1, {side, side})
          .convertTo(seen, CV_32F, contrast_k);
      const double d = (up ? 1 : -1) * difference.dot(seen) / (noise * cv::norm(difference));
      expected += 0.5 * std::erfc(-d / std::sqrt(2.0)) / 32;
    }
  }

  const auto found = identify(task);

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_GT(expected, 0.6);
  EXPECT_LT(expected, 0.97);
  // Four standard errors, and 0.002 for radiance that is not straight and for periods.
  EXPECT_NEAR(found->front().proportion(), expected, 4 * found->front().standard_error() + 0.002);
  EXPECT_LT(found->front().standard_error(), 0.01);
  const auto& answers = found->front().answers;
  EXPECT_EQ(answers[0][0] + answers[0][1], 4000);
}

/// The two triangles behind the camera, without their mean; of norm 1 or as they are. One row.
cv::Mat1f seen_triangle(const IdentificationTask& task, double size_pitch, Apex apex, cv::Point2d at, int side) {
  cv::Mat1f seen;
  ImageChain(task.sensor, task.plan, task.accuracy)
      .image(triangle(size_pitch, apex))
      .sample(cv::Point2d(0.5 - side / 2.0, 0.5 - side / 2.0) - at, 1, {side, side})
      .convertTo(seen, CV_32F);
  seen -= cv::mean(seen)[0];
  return seen.reshape(1, 1);
}

struct PairReference {
  double proportion = 0, standard_error = 0;
};

/// Of two triangles that the observer knows behind the camera. At a known place in closed form; where it searches, by
/// every template at every place and by noise of its own.
PairReference pair_reference(const IdentificationTask& task, double size_pitch, double contrast_k, int draws) {
  const double reach = std::max(std::abs(triangle(size_pitch, Apex::up)[0].x), 0.7 * size_pitch);
  const int side = 2 * static_cast<int>(std::ceil(1.1 * reach + task.observer.window_margin_pitch));
  const int steps = static_cast<int>(std::lround(1 / task.observer.search_step_samples));
  const int search = static_cast<int>(std::lround(task.observer.search_range_samples * steps));
  const double noise_k = std::sqrt(std::pow(task.sensor.netd_k, 2) + std::pow(task.sensor.kelvin_per_count, 2) / 12 +
                                   std::pow(task.observer.internal_noise * contrast_k, 2));
  std::array<cv::Mat1f, 2> templates;
  const std::array apexes{Apex::up, Apex::down};
  for (std::size_t a = 0; a < 2; ++a) {
    for (int place = 0; place < (2 * search + 1) * (2 * search + 1); ++place) {
      const cv::Point2d at(place % (2 * search + 1) - search, place / (2 * search + 1) - search);
      cv::Mat1f row = seen_triangle(task, size_pitch, apexes[a], at / steps, side);
      row /= cv::norm(row);
      templates[a].push_back(row);
    }
  }
  cv::Mat1f noise(draws, side * side);
  const RandomStream numbers(7, "pair");
  numbers.fill_normal({noise.ptr<float>(), noise.total()});
  const std::array<cv::Mat1f, 2> noise_scores{noise_k * noise * templates[0].t(), noise_k * noise * templates[1].t()};
  PairReference out;
  std::vector<double> shares(static_cast<std::size_t>(draws));
  for (int phase = 0; phase < 16; ++phase) {
    const cv::Point2d at((phase % 4 + 0.5) / 4 - 0.5, (phase / 4 + 0.5) / 4 - 0.5);
    for (std::size_t a = 0; a < 2; ++a) {
      const cv::Mat1f signal = contrast_k * seen_triangle(task, size_pitch, apexes[a], at, side);
      const cv::Mat1f own = signal * templates[a].t(), other = signal * templates[1 - a].t();
      if (search == 0) {
        const double d = (own(0) - other(0)) / (noise_k * cv::norm(templates[0] - templates[1]));
        out.proportion += 0.5 * std::erfc(-d / std::sqrt(2.0)) / 32;
        continue;
      }
      for (int draw = phase; draw < draws; draw += 16) {
        double best = 0, best_other = 0;
        cv::minMaxLoc(own + noise_scores[a].row(draw), nullptr, &best);
        cv::minMaxLoc(other + noise_scores[1 - a].row(draw), nullptr, &best_other);
        shares[static_cast<std::size_t>(draw)] += best > best_other ? 0.5 : 0;
      }
    }
  }
  if (search == 0) return out;
  for (const double share : shares) out.proportion += share / draws;
  out.standard_error = std::sqrt(out.proportion * (1 - out.proportion) / draws);
  return out;
}

// From 0.6 of a pitch, where two triangles are all but one blob, at a known place and with the search of the observer:
// a search that knows the templates at some places only prefers the wrong triangle there.
TEST(Identification, OfTwoMirrorImagesBehindAKnownCameraIsWhatEveryPlaceOfTheSearchSays) {
  struct Case {
    double size_pitch, temperature_k, search;
  };
  for (const Case& c : {Case{0.6, 309, 0}, Case{1.1, 301, 0}, Case{2.2, 300.3, 0}, Case{0.6, 309, 1}, Case{0.8, 309, 1},
                        Case{1.2, 309, 1}}) {
    SCOPED_TRACE(c.size_pitch);
    SCOPED_TRACE(c.search);
    IdentificationTask task = two_mirror_images();
    task.knowledge = TemplateKnowledge::behind_camera;
    task.observer.search_range_samples = c.search;
    task.targets = {{"up", {triangle_scene(Apex::up, 1, c.temperature_k)}},
                    {"down", {triangle_scene(Apex::down, 1, c.temperature_k)}}};
    task.ranges = {{1e3 / (c.size_pitch * task.sensor.ifov_mrad()), 1}};
    task.decisions = 8000;
    const RadianceScale scale{{task.sensor.wavelength_min_um, task.sensor.wavelength_max_um},
                              task.sensor.scene_temperature_k};
    const auto signature = target_signature(task.targets[0].aspects[0], scale);
    ASSERT_TRUE(signature);
    const PairReference expected = pair_reference(task, c.size_pitch, signature->dt_rss_k(), 8000);

    const auto found = identify(task);

    ASSERT_TRUE(found) << found.error().message;
    // Four standard errors of both, and 0.002 for the band of the templates and for periods.
    EXPECT_NEAR(found->front().proportion(), expected.proportion,
                4 * std::hypot(found->front().standard_error(), expected.standard_error) + 0.002);
    EXPECT_GT(expected.proportion, 0.5);
  }
}

TEST(Identification, FallsWithRangeToChance) {
  IdentificationTask task = two_mirror_images();
  task.observer.search_range_samples = 0.5;
  task.ranges = {{150, 1}, {400, 1}, {400, 0.1}, {5000, 1}};
  task.decisions = 320;

  const auto found = identify(task);

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_GT((*found)[0].proportion(), 0.99);
  EXPECT_GT((*found)[1].proportion(), (*found)[2].proportion());
  EXPECT_NEAR((*found)[3].proportion(), 0.5, 0.12);
}

// A perfect eye leaves the noise of the sensor, and its gain then has no effect; light helps; the open parameters
// enclose their middle.
TEST(Identification, WithAnEyeFollowsItsNoiseItsLightAndItsOpenParameters) {
  IdentificationTask task = two_mirror_images();
  task.decisions = 640;
  task.ranges = {{500, 1}};
  const auto proportion = [&](const TemplateObserverSpec& observer) {
    task.observer = observer;
    auto found = identify(task);
    EXPECT_TRUE(found) << found.error().message;
    return found ? found->front() : IdentificationPoint{.answers = {}, .by_draw = {0}};
  };
  TemplateObserverSpec perfect = identifying_eye();
  perfect.eye->sensitivity *= 1e4;
  perfect.eye->contrast_noise = 0;
  perfect.sensor_noise_factor = 1;
  TemplateObserverSpec more = perfect;
  more.eye->sensitivity *= 10;

  const auto seen = proportion(identifying_eye()), dim = proportion(identifying_eye(0.5));
  const auto best = proportion(perfect), same = proportion(more);

  EXPECT_EQ(best.answers, same.answers);
  EXPECT_GT(best.proportion(), seen.proportion());
  EXPECT_GT(seen.proportion(), dim.proportion());
  EXPECT_GT(dim.proportion(), 0.5);
  ASSERT_TRUE(seen.spread);
  EXPECT_LT(seen.spread->first, seen.proportion());
  EXPECT_GT(seen.spread->second, seen.proportion());
  EXPECT_LE(seen.spread->second, best.proportion());
}

FieldScene rectangle_scene(cv::Size2d size_m) {
  FieldScene scene;
  scene.background_k = 300;
  const double x = size_m.width / 2, y = size_m.height / 2;
  scene.regions = {{"rectangle", {{-x, -y}, {x, -y}, {x, y}, {-x, y}}, 310, 1, true}};
  return scene;
}

// Without noise what is shown has the largest score. Ideal templates take blur for shape: of half a pitch and more,
// a narrow rectangle then looks like a wider one.
/// Turbulence of the path of each range: as a sensor that has it on that path, and worse than still air.
TEST(Identification, ThroughTurbulenceIsThatOfTheSensorBehindTheSamePath) {
  IdentificationTask task = two_mirror_images();
  task.decisions = 800;
  task.targets = {{"up", {triangle_scene(Apex::up, 10)}}, {"down", {triangle_scene(Apex::down, 10)}}};
  task.ranges = {{2500, 1}, {3500, 1}};
  const auto still = identify(task);
  task.cn2_m_minus_2_3 = 1e-11;
  SensorSpec behind = task.sensor;
  behind.turbulence_cn2_m_minus_2_3 = 1e-11;
  task.plan = full_plan(behind, {}, {});
  const auto found = identify(task);
  ASSERT_TRUE(still && found);
  IdentificationTask alone = task;
  alone.cn2_m_minus_2_3 = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    alone.sensor.turbulence_cn2_m_minus_2_3 = 1e-11;
    alone.sensor.turbulence_path_m = task.ranges[i].range_m;
    alone.ranges = {task.ranges[i]};
    const auto expected = identify(alone);
    ASSERT_TRUE(expected);
    EXPECT_EQ((*found)[i].answers, expected->front().answers) << i;
  }
  // The same draws: what turbulence takes has no noise of its own.
  EXPECT_LT((*found)[1].proportion(), (*still)[1].proportion());
}

/// Judged one by one as the model does, the frames for a person have the answers of the experiment.
TEST(Identification, ShowsAPersonTheFramesOfTheModel) {
  IdentificationTask task = two_mirror_images();
  task.decisions = 64;
  task.observer.internal_noise = 0;
  task.ranges = {{350, 0.9}};
  const auto expected = identify(task);
  const auto frames = IdentificationFrames::of(task);
  ASSERT_TRUE(expected && frames);
  const double samples_per_metre = 1e3 / (350 * task.sensor.ifov_mrad());
  std::vector<AlternativeAspects> alternatives;
  for (const Apex apex : {Apex::up, Apex::down}) alternatives.push_back({edges_of(triangle(samples_per_metre, apex))});
  const auto bank = IdentificationBank::build(task.observer, alternatives, 1);
  ASSERT_TRUE(bank);
  const std::vector<float> nothing(bank->scores(), 0.0F);
  std::vector answers(2, std::vector(2, 0));
  for (std::size_t target = 0; target < 2; ++target) {
    for (std::uint64_t draw = 0; draw < 64; ++draw) {
      cv::Mat1f frame = frames->frame_k(0, target, 0, draw).value();
      ASSERT_EQ(frame.rows, bank->window_samples());
      frame -= cv::mean(frame)[0];
      ++answers[target][bank->best(bank->project(frame), nothing, 0, nothing, 0)];
    }
  }
  EXPECT_EQ(answers, expected->front().answers);
  EXPECT_GT(answers[0][1] + answers[1][0], 0) << "some are wrong, or nothing is compared";
  EXPECT_NEAR(frames->contrast_k(0, 0, 0), 0.9 * 0.3, 0.003);
}

TEST(Identification, OfAKnownCameraErrsByNoiseOnly) {
  IdentificationTask task = two_mirror_images();
  task.sensor.netd_k = 1e-4;
  task.plan = full_plan(task.sensor, {Effect::quantisation}, {});
  task.observer.internal_noise = 1e-4;
  task.observer.search_range_samples = 0.375;  // every phase of the experiment is a place of the search
  task.targets = {{"narrow", {rectangle_scene({0.25, 2})}},
                  {"middle", {rectangle_scene({0.5, 2})}},
                  {"wide", {rectangle_scene({1, 2})}}};
  task.ranges = {{600, 1}};
  task.decisions = 64;

  task.knowledge = TemplateKnowledge::behind_camera;
  const auto known = identify(task);
  task.knowledge = TemplateKnowledge::ideal;
  const auto ideal = identify(task);

  ASSERT_TRUE(known && ideal);
  EXPECT_EQ(known->front().proportion(), 1);
  EXPECT_LT(ideal->front().proportion(), 0.9);
}

TEST(Identification, OfShapeAloneDoesNotTellSizesApart) {
  IdentificationTask task = two_mirror_images();
  task.targets = {{"small", {triangle_scene(Apex::up, 1)}}, {"large", {triangle_scene(Apex::up, 2)}}};
  ASSERT_TRUE(planned_effort(task));
  task.cues = TargetCues::shape;

  const auto found = identify(task);

  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::invalid_input);
}

TEST(Identification, PlansAnEffortThatGrowsWithDecisionsAndNearness) {
  IdentificationTask task = two_mirror_images();
  const auto once = planned_effort(task);
  task.decisions *= 2;
  const auto twice = planned_effort(task);
  task.ranges = {{50, 1}};
  const auto near = planned_effort(task);

  ASSERT_TRUE(once && twice && near);
  EXPECT_EQ(once->decisions, 2 * 4000);
  EXPECT_EQ(twice->decisions, 2 * once->decisions);
  EXPECT_GT(twice->processor_s, once->processor_s);
  EXPECT_GT(near->processor_s, twice->processor_s);
  EXPECT_GT(near->largest_bytes, once->largest_bytes);
}

TEST(Identification, RefusesARangeWhoseTemplatesNeedMoreMemoryThanAllowedBeforeAnyComputation) {
  IdentificationTask task = two_mirror_images();
  task.ranges = {{0.001, 1}, {350, 1}};

  const auto effort = planned_effort(task);
  const auto found = identify(task);

  ASSERT_FALSE(effort || found);
  for (const Error& error : {effort.error(), found.error()}) {
    EXPECT_EQ(error.code, ErrorCode::invalid_input);
    EXPECT_NE(error.message.find("at 0.001 m the targets are too large for this observer"), std::string::npos);
    EXPECT_NE(error.message.find("the shortest feasible range is about"), std::string::npos) << error.message;
  }
}

TEST(Identification, RefusesWhatCannotBeToldApart) {
  IdentificationTask alike = two_mirror_images();
  alike.targets[1] = {"again", {triangle_scene(Apex::up, 1)}};
  IdentificationTask cold = two_mirror_images();
  cold.targets[1].aspects[0].regions[0].temperature_k = 300;
  IdentificationTask alone = two_mirror_images();
  alone.targets.resize(1);

  for (const auto& task : {alike, cold, alone}) {
    const auto found = identify(task);

    ASSERT_FALSE(found);
    EXPECT_EQ(found.error().code, ErrorCode::invalid_input);
  }
}

}  // namespace
}  // namespace todbench
