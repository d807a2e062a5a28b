#include "sim_devices/sensor/sensor_model.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <mutex>
#include <numbers>
#include <tuple>
#include <vector>

#include "sim_devices/sensor/image_chain.h"

namespace todbench {
namespace {

using ShapeKey = std::tuple<double, int, double>;  ///< size in pitches, apex, rotation

Polygon turned(const Polygon& polygon, double degrees) {
  if (degrees == 0) return polygon;
  const double angle = degrees * std::numbers::pi / 180;
  Polygon out;
  for (const auto& v : polygon)
    out.emplace_back(v.x * std::cos(angle) - v.y * std::sin(angle), v.x * std::sin(angle) + v.y * std::cos(angle));
  return out;
}

/// Adds values to the part of the picture that is inside it.
void add_clipped(cv::Mat1f& picture, const cv::Mat1d& values, cv::Point origin) {
  for (int j = std::max(0, -origin.y); j < values.rows && origin.y + j < picture.rows; ++j) {
    for (int i = std::max(0, -origin.x); i < values.cols && origin.x + i < picture.cols; ++i) {
      picture(origin.y + j, origin.x + i) += static_cast<float>(values(j, i));
    }
  }
}

constexpr std::size_t cached_scenes = 64;  // 20 MB of 320 x 240
constexpr std::size_t cached_shapes = 256;

}  // namespace

struct SensorModel::State {
  SensorSpec spec;
  SensorPlan plan;
  ImageChain chain;
  RandomStream temporal, fixed;
  cv::Mat1f fixed_pattern;  ///< per picture element, kelvin; empty where it is not simulated
  mutable std::mutex mutex;
  mutable std::deque<std::pair<PlateScene, std::shared_ptr<const cv::Mat1f>>> scenes;
  mutable std::map<ShapeKey, std::shared_ptr<const PolygonImage>> shapes;

  State(SensorSpec s, SensorPlan p, Accuracy accuracy, std::uint64_t seed)
      : spec(std::move(s)),
        plan(std::move(p)),
        chain(spec, plan, accuracy),
        temporal(seed, "sensor.temporal"),
        fixed(seed, "sensor.fixed") {}

  [[nodiscard]] std::shared_ptr<const PolygonImage> shape(const ShapeKey& key) const {
    auto& slot = shapes[key];
    if (slot == nullptr) {
      const auto& [size, apex, rotation] = key;
      slot =
          std::make_shared<const PolygonImage>(chain.image(turned(triangle(size, static_cast<Apex>(apex)), rotation)));
    }
    return slot;
  }

  [[nodiscard]] cv::Mat1f draw(const PlateScene& scene, cv::Size size) const {
    cv::Mat1f picture(size, 0.0F);
    const double sample_pitch = 1.0 / spec.microscan;
    for (const auto& t : scene.plate.triangles) {
      const cv::Point2d centre = scene_pixel(scene, t.position_mm, spec.ifov_mrad() * sample_pitch, size);
      const double size_pitch = t.size_mm / scene.distance_m / spec.ifov_mrad();
      const auto image = shape({size_pitch, static_cast<int>(t.apex), scene.rotation_deg});
      const int n = image->lattice().period * spec.microscan;
      const cv::Point origin(static_cast<int>(std::lround(centre.x)) - n / 2,
                             static_cast<int>(std::lround(centre.y)) - n / 2);
      const cv::Point2d first((origin.x - centre.x) * sample_pitch, (origin.y - centre.y) * sample_pitch);
      add_clipped(picture, image->sample(first, sample_pitch, {n, n}), origin);
    }
    return picture;
  }
};

SensorModel::SensorModel(SensorSpec spec, SensorPlan plan, Accuracy accuracy, std::uint64_t seed)
    : state_(std::make_unique<State>(std::move(spec), std::move(plan), accuracy, seed)) {
  const SensorSpec& s = state_->spec;
  if (state_->plan.simulates(Effect::fixed_pattern) && s.fixed_pattern_k > 0) {
    cv::Mat1f detectors(s.height, s.width);
    state_->fixed.fill_normal(std::span(detectors.ptr<float>(), detectors.total()));
    state_->fixed_pattern.create(size());
    // The samples of one microscan cycle come from the same detector and share its offset.
    for (int row = 0; row < state_->fixed_pattern.rows; ++row) {
      for (int column = 0; column < state_->fixed_pattern.cols; ++column) {
        state_->fixed_pattern(row, column) =
            static_cast<float>(s.fixed_pattern_k) * detectors(row / s.microscan, column / s.microscan);
      }
    }
  }
}

SensorModel::~SensorModel() = default;

const SensorSpec& SensorModel::spec() const {
  return state_->spec;
}
const SensorPlan& SensorModel::plan() const {
  return state_->plan;
}

cv::Size SensorModel::size() const {
  return {state_->spec.width * state_->spec.microscan, state_->spec.height * state_->spec.microscan};
}

std::shared_ptr<const cv::Mat1f> SensorModel::unit_signal(const PlateScene& scene) const {
  const std::scoped_lock lock(state_->mutex);
  for (const auto& [cached, picture] : state_->scenes) {
    if (same_geometry(cached, scene)) return picture;
  }
  if (state_->shapes.size() > cached_shapes) state_->shapes.clear();
  auto picture = std::make_shared<const cv::Mat1f>(state_->draw(scene, size()));
  state_->scenes.emplace_back(scene, picture);
  if (state_->scenes.size() > cached_scenes) state_->scenes.pop_front();
  return picture;
}

cv::Mat1f SensorModel::picture(const PlateScene& scene, std::uint64_t index) const {
  cv::Mat1f out = *unit_signal(scene) * scene.delta_t_k;
  const auto count = static_cast<std::size_t>(out.total());
  float* pixels = out.ptr<float>();
  if (state_->plan.simulates(Effect::temporal_noise) && state_->spec.netd_k > 0) {
    std::vector<float> noise(count);
    state_->temporal.sub(index).fill_normal(noise);
    const auto sd = static_cast<float>(state_->spec.netd_k);
    for (std::size_t i = 0; i < count; ++i) pixels[i] += sd * noise[i];
  }
  if (!state_->fixed_pattern.empty()) {
    const float* pattern = state_->fixed_pattern.ptr<float>();
    for (std::size_t i = 0; i < count; ++i) pixels[i] += pattern[i];
  }
  if (state_->plan.simulates(Effect::quantisation)) {
    // Steps are those of the counts, wherever the surround lies between two of them.
    const double step = state_->spec.kelvin_per_count;
    const double base = (scene.background_k - state_->spec.offset_k) / step;
    for (std::size_t i = 0; i < count; ++i) {
      pixels[i] = static_cast<float>((std::nearbyint(base + static_cast<double>(pixels[i]) / step) - base) * step);
    }
  }
  return out;
}

cv::Mat1w SensorModel::expose(const PlateScene& scene, std::uint64_t index) const {
  const auto unit = unit_signal(scene);
  const SensorSpec& spec = state_->spec;
  const auto count = static_cast<std::size_t>(unit->total());
  cv::Mat1w counts(unit->size());
  const float* signal = unit->ptr<float>();
  const auto contrast = static_cast<float>(scene.delta_t_k);
  const float* pattern = state_->fixed_pattern.empty() ? nullptr : state_->fixed_pattern.ptr<float>();
  const bool noisy = state_->plan.simulates(Effect::temporal_noise) && spec.netd_k > 0;
  const auto sd = static_cast<float>(noisy ? spec.netd_k : 0);
  const RandomStream stream = state_->temporal.sub(index);
  const double per_kelvin = 1 / spec.kelvin_per_count;
  const double base = (scene.background_k - spec.offset_k) * per_kelvin + 0.5;
  const double full_scale = static_cast<double>((1u << spec.bits) - 1u) + 0.5;
  auto* out = counts.ptr<std::uint16_t>();
  constexpr std::size_t strip = 4096;  // noise of a strip stays in the first-level cache
  float noise[strip] = {};
  for (std::size_t first = 0; first < count; first += strip) {
    const std::size_t n = std::min(strip, count - first);
    if (noisy) stream.fill_normal(std::span(noise, n), first);
    for (std::size_t i = 0; i < n; ++i) {
      float value = contrast * signal[first + i] + sd * noise[i];
      if (pattern != nullptr) value += pattern[first + i];
      const double level = base + static_cast<double>(value) * per_kelvin;
      out[first + i] = static_cast<std::uint16_t>(static_cast<int>(std::clamp(level, 0.0, full_scale)));
    }
  }
  return counts;
}

}  // namespace todbench
