// SPDX-License-Identifier: GPL-3.0-or-later
// A known answer: a sensor that has nothing but noise, an ideal observer, and a threshold in closed form. The 95 %
// interval of the whole chain (frames, registration, contrast, trials, fit, clusters) must contain it as often as it
// says.
#pragma once

#include <gmock/gmock.h>

#include <cmath>
#include <thread>

#include "hvs/observer/known_position.h"
#include "tests/support/ideal_observer.h"
#include "tests/tod/measurement/measurement_bench.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench::test {

/// Overlap of two unit triangles about a common centroid, by clipping one with the other (Sutherland and Hodgman 1974):
/// exact.
inline double overlap(Apex first, Apex second) {
  Polygon shape = triangle(1, first);
  const Polygon clip = triangle(1, second);
  for (std::size_t e = 0; e < clip.size(); ++e) {
    const cv::Point2d a = clip[e];
    const cv::Point2d d = clip[(e + 1) % clip.size()] - a;
    const double inward = d.cross(-a) > 0 ? 1 : -1;
    Polygon kept;
    for (std::size_t i = 0; i < shape.size(); ++i) {
      const cv::Point2d p = shape[i];
      const cv::Point2d q = shape[(i + 1) % shape.size()];
      const double sp = inward * d.cross(p - a);
      const double sq = inward * d.cross(q - a);
      if (sp >= 0) kept.push_back(p);
      if ((sp >= 0) != (sq >= 0)) kept.push_back(p + (q - p) * (sp / (sp - sq)));
    }
    shape = kept;
  }
  return area(shape);
}

/// Square detectors that fill the pitch.
inline std::complex<double> full_pitch_detector(double u, double w) {
  const auto sinc = [](double x) { return x == 0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x); };
  return sinc(u) * sinc(w);
}

/// P(correct) of an observer that knows four signals with this Gram matrix exactly, in white noise of sd `noise`.
inline double proportion_correct(const std::array<std::array<double, 4>, 4>& gram, double noise) {
  KnownPositionTask task{.mean = {}, .gram = gram, .noise = noise};
  for (std::size_t i = 0; i < 4; ++i) task.mean[i] = gram[0][i] - gram[i][i] / 2;
  return probability_correct(task, 64);
}

/// Without pixels: inner products are overlaps of areas, and everything depends on size over noise alone.
inline double proportion_without_pixels(double size_px, double noise) {
  std::array<std::array<double, 4>, 4> gram;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j)
      gram[i][j] = size_px * size_px * overlap(static_cast<Apex>(i), static_cast<Apex>(j));
  }
  return proportion_correct(gram, noise);
}

/// With pixels, which average over edges and so lose a tenth of the difference: the mean over sampling phases.
inline double proportion_with_pixels(double size_px, double noise) {
  const int half = static_cast<int>(std::ceil(size_px + 2));
  const int period = 2 * half + 4;
  const FilterTable filter({.period = period, .band = 7 * period}, full_pitch_detector);
  std::vector<PolygonImage> images;
  for (const Apex apex : all_apexes) images.emplace_back(triangle(size_px, apex), filter);
  const int phases = 4;
  double sum = 0;
  for (int p = 0; p < phases * phases; ++p) {
    const cv::Point2d first(-half + (p % phases + 0.5) / phases, -half + (p / phases + 0.5) / phases);
    std::array<cv::Mat1d, 4> signals;
    for (std::size_t i = 0; i < 4; ++i) {
      signals[i] = images[i].sample(first, 1, {2 * half, 2 * half});
      signals[i] -= cv::mean(signals[i])[0];
    }
    std::array<std::array<double, 4>, 4> gram;
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 4; ++j) gram[i][j] = signals[i].dot(signals[j]);
    }
    sum += proportion_correct(gram, noise) / (phases * phases);
  }
  return sum;
}

/// Size in pixels with 75 % correct, by bisection.
inline double threshold_px(double (*proportion)(double size_px, double noise), double noise_to_contrast) {
  double low = 2 * noise_to_contrast, high = 5 * noise_to_contrast;
  while (high - low > 1e-3) {
    const double middle = (low + high) / 2;
    (proportion(middle, noise_to_contrast) < 0.75 ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// A camera whose noise begins at an exposure of its own, so that runs share one sensor model and its pictures.
class LaterExposures final : public FrameSource {
 public:
  LaterExposures(std::shared_ptr<const SensorModel> model, std::shared_ptr<SceneHolder> scene, std::uint64_t first)
      : plain_(simulated_source(model, scene, "1")),
        model_(std::move(model)),
        scene_(std::move(scene)),
        first_(first) {}
  [[nodiscard]] const SourceInfo& info() const override { return plain_->info(); }
  [[nodiscard]] Result<void> start() override { return plain_->start(); }
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds /*timeout*/) override {
    Frame frame;
    frame.counts = model_->expose(*scene_->scene(), first_ + index_);
    frame.sequence = index_++;
    frame.host_time_ns = std::chrono::steady_clock::now().time_since_epoch().count();
    frame.significant_bits = info().significant_bits;
    frame.scale = std::make_shared<const RadiometricScale>(info().scale);
    return frame;
  }
  void stop() override { plain_->stop(); }
  [[nodiscard]] Result<std::string> get(const std::string& feature) override { return plain_->get(feature); }
  [[nodiscard]] Result<void> set(const std::string& feature, const std::string& value) override {
    return plain_->set(feature, value);
  }
  [[nodiscard]] Result<void> correct_nonuniformity() override { return {}; }

 private:
  std::unique_ptr<FrameSource> plain_;
  std::shared_ptr<const SensorModel> model_;
  std::shared_ptr<SceneHolder> scene_;
  std::uint64_t first_;
  std::uint64_t index_ = 0;
};

/// Five rows of four, 6 to 16 pixels, close together: a small picture is enough.
inline TargetPlate close_plate() {
  TargetPlate plate = plate_of_rows("known", {4.2, 10.2, 6.5, 8.1, 5.2}, 0);
  const std::array<double, 5> rows_mm{-46, -24, 0, 21, 42};
  for (std::size_t i = 0; i < plate.triangles.size(); ++i) {
    plate.triangles[i].position_mm = {-38.0 + 25.4 * static_cast<double>(i % 4) + 0.21 * static_cast<double>(i / 4),
                                      rows_mm[i / 4] + 0.13 * static_cast<double>(i % 4)};
  }
  plate.width_mm = 110;
  plate.height_mm = 110;
  return plate;
}

/// Detectors that fill the pitch, no optics, hardly any quantisation: noise is all there is.
inline SimulatedBench noise_only_bench() {
  SimulatedBench bench;
  bench.spec.detector_um = bench.spec.pitch_um;
  bench.spec.netd_k = 1;
  bench.spec.kelvin_per_count = 0.02;
  bench.spec.offset_k = 200;
  bench.spec.width = 192;
  bench.spec.height = 192;
  bench.skip = {Effect::diffraction};
  bench.distance_m = 0.5;  // 0.654 mm per pixel
  bench.plates = {close_plate()};
  bench.mountings = {Mounting::identity};
  bench.contrasts = {8, 0.42, 0.33, 0.26};  // the plate is registered at the first
  bench.phases = 16;
  return bench;
}

/// One seed of the bench through the whole chain. Each run registers the plate anew and so has sizes of its own, of
/// 13 MB each: an observer that served all runs would keep gigabytes.
inline Result<TodCurve> measured(const SimulatedBench& bench, const std::shared_ptr<const SensorModel>& model,
                                 std::uint64_t seed) {
  IdealObserver observer("ideal", triangle_alternatives(), full_pitch_detector, 7);
  PlateScene scene;
  scene.plate = bench.plates.front();
  scene.distance_m = bench.distance_m;
  const auto holder = std::make_shared<SceneHolder>(scene);
  LaterExposures source(model, holder, seed * 1'000'000);
  const auto target = scene_target(holder, bench.plates);
  ListedSchedule schedule = schedule_of(bench);
  MeasurementOptions options = options_of(bench);
  options.seed = seed;
  UnattendedHost host;
  const auto result = measure(source, *target, observer, schedule, options, host, {}, {});
  if (!result) return tl::unexpected(result.error());
  return tod_curve(result->trials, {});
}

/// Runs of that many seeds, two at a time; at every contrast at least `least` of their 95 % intervals hold the truth.
inline void expect_intervals_hold_the_truth(int seeds, int least) {
  const SimulatedBench bench = noise_only_bench();
  const auto model =
      std::make_shared<const SensorModel>(bench.spec, full_plan(bench.spec, bench.skip, {}), Accuracy::draft(), 1);
  std::array<double, 4> truth{};
  for (std::size_t i = 1; i < 4; ++i) {
    truth[i] = threshold_px(proportion_with_pixels, bench.spec.netd_k / bench.contrasts[i]) * bench.spec.ifov_mrad();
  }
  std::vector<Result<TodCurve>> curves(static_cast<std::size_t>(seeds), fail(ErrorCode::internal, "not run"));
  const auto every_other = [&](int first) {
    for (int s = first; s < seeds; s += 2)
      curves[static_cast<std::size_t>(s)] = measured(bench, model, static_cast<std::uint64_t>(s + 1));
  };
  {
    const std::jthread one(every_other, 0);
    const std::jthread two(every_other, 1);
  }

  for (std::size_t i = 1; i < 4; ++i) {
    int contained = 0;
    double mean_log = 0;
    for (const auto& curve : curves) {
      ASSERT_TRUE(curve.has_value()) << curve.error().message;
      const auto& fit = curve->points[i].fit;
      ASSERT_TRUE(fit.threshold.has_value());
      mean_log += std::log(*fit.threshold / truth[i]) / seeds;
      const bool above = !fit.ci95.low || *fit.ci95.low <= truth[i];
      const bool below = !fit.ci95.high || truth[i] <= *fit.ci95.high;
      contained += above && below ? 1 : 0;
    }
    std::printf("dT %.2f: true S75 %.3f mrad (%.2f px), contained %d of %d, mean ratio %.4f\n", bench.contrasts[i],
                truth[i], truth[i] / bench.spec.ifov_mrad(), contained, seeds, std::exp(mean_log));
    EXPECT_GE(contained, least);
  }
}

}  // namespace todbench::test
