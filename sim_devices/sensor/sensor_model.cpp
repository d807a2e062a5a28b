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
#include "sim_devices/sensor/picture_stages.h"

namespace todbench {
namespace {

using ShapeKey = std::tuple<double, int, double, double, double>;  ///< size in pitches, apex, rotation, motion

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
  Accuracy accuracy;
  RandomStream temporal, fixed, rows, columns;
  cv::Mat1f fixed_pattern;           ///< per picture element, kelvin; empty where it is not simulated
  cv::Mat1b dead;                    ///< per detector; empty where none is
  std::vector<double> display_taps;  ///< empty for sample and hold
  mutable std::mutex mutex;
  mutable std::deque<std::pair<PlateScene, std::shared_ptr<const cv::Mat1f>>> scenes;
  mutable std::map<ShapeKey, std::shared_ptr<const PolygonImage>> shapes;
  mutable std::map<std::pair<double, double>, std::unique_ptr<const ImageChain>> chains;  ///< by motion

  State(SensorSpec s, SensorPlan p, Accuracy a, std::uint64_t seed)
      : spec(as_planned(std::move(s), p)),
        plan(std::move(p)),
        accuracy(a),
        temporal(seed, "sensor.temporal"),
        fixed(seed, "sensor.fixed"),
        rows(seed, "sensor.rows"),
        columns(seed, "sensor.columns") {
    if (spec.dead_pixel_share > 0)
      dead = dead_detectors({spec.width, spec.height}, spec.dead_pixel_share, RandomStream(seed, "sensor.dead"));
    if (has_display(spec)) display_taps = taps_of([this](double f) { return display_response(spec, f); });
  }

  /// Whether the frame needs more than signal, temporal noise and fixed pattern.
  [[nodiscard]] bool many_stages() const {
    return spec.exposures_per_sample() > 1 || spec.row_noise_k > 0 || spec.column_noise_k > 0 || !dead.empty() ||
           !display_taps.empty();
  }

  [[nodiscard]] const ImageChain& chain(SceneMotion motion) const {
    auto& slot = chains[{motion.x_mrad_s, motion.y_mrad_s}];
    if (slot == nullptr) slot = std::make_unique<const ImageChain>(spec, plan, accuracy, motion);
    return *slot;
  }

  [[nodiscard]] std::shared_ptr<const PolygonImage> shape(const ShapeKey& key) const {
    auto& slot = shapes[key];
    if (slot == nullptr) {
      const auto& [size, apex, rotation, motion_x, motion_y] = key;
      slot = std::make_shared<const PolygonImage>(
          chain({motion_x, motion_y}).image(turned(triangle(size, static_cast<Apex>(apex)), rotation)));
    }
    return slot;
  }

  /// Picture `index` before quantisation.
  [[nodiscard]] cv::Mat1f analog(const cv::Mat1f& unit, double delta_t_k, std::uint64_t index) const;

  [[nodiscard]] cv::Mat1f draw(const PlateScene& scene, cv::Size size) const {
    cv::Mat1f picture(size, 0.0F);
    const double sample_pitch = 1.0 / spec.samples_per_pitch();
    for (const auto& t : scene.plate.triangles) {
      const cv::Point2d centre = scene_pixel(scene, t.position_mm, spec.ifov_mrad() * sample_pitch, size);
      const double size_pitch = t.size_mm / scene.distance_m / spec.ifov_mrad();
      const auto image = shape(
          {size_pitch, static_cast<int>(t.apex), scene.rotation_deg, scene.motion.x_mrad_s, scene.motion.y_mrad_s});
      const int n = image->lattice().period * spec.samples_per_pitch();
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
  if (s.fixed_pattern_k > 0) {
    cv::Mat1f detectors(s.height, s.width);
    state_->fixed.fill_normal(std::span(detectors.ptr<float>(), detectors.total()));
    state_->fixed_pattern.create(size());
    // The samples of one microscan cycle come from the same detector and share its offset.
    for (int row = 0; row < state_->fixed_pattern.rows; ++row) {
      for (int column = 0; column < state_->fixed_pattern.cols; ++column) {
        state_->fixed_pattern(row, column) = static_cast<float>(s.fixed_pattern_k) *
                                             detectors(row / s.samples_per_pitch(), column / s.samples_per_pitch());
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
  const int n = state_->spec.samples_per_pitch();
  return {state_->spec.width * n, state_->spec.height * n};
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

cv::Mat1f SensorModel::State::analog(const cv::Mat1f& unit, double delta_t_k, std::uint64_t index) const {
  cv::Mat1f out = unit * delta_t_k;
  const auto count = static_cast<std::size_t>(out.total());
  float* pixels = out.ptr<float>();
  // A sample is the mean of so many exposures of the sequence.
  const auto exposures = static_cast<std::uint64_t>(spec.exposures_per_sample());
  const double weight = 1.0 / static_cast<double>(exposures);
  for (std::uint64_t k = 0; k < exposures; ++k) {
    const std::uint64_t exposure = index * exposures + k;
    if (spec.netd_k > 0) {
      std::vector<float> noise(count);
      temporal.sub(exposure).fill_normal(noise);
      const auto sd = static_cast<float>(weight * spec.netd_k);
      for (std::size_t i = 0; i < count; ++i) pixels[i] += sd * noise[i];
    }
    add_line_noise(out, spec, rows.sub(exposure), columns.sub(exposure), weight);
  }
  if (!fixed_pattern.empty()) {
    const float* pattern = fixed_pattern.ptr<float>();
    for (std::size_t i = 0; i < count; ++i) pixels[i] += pattern[i];
  }
  if (!dead.empty()) replace_dead(out, dead, spec.samples_per_pitch());
  return display_taps.empty() ? out : filtered(out, display_taps);
}

cv::Mat1f SensorModel::picture(const PlateScene& scene, std::uint64_t index) const {
  cv::Mat1f out = state_->analog(*unit_signal(scene), scene.delta_t_k, index);
  if (state_->plan.simulates(Effect::quantisation)) {
    // Steps are those of the counts, wherever the surround lies between two of them.
    const double step = state_->spec.kelvin_per_count;
    const double base = (scene.background_k - state_->spec.offset_k) / step;
    const auto count = static_cast<std::size_t>(out.total());
    float* pixels = out.ptr<float>();
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
  const bool noisy = spec.netd_k > 0;
  const auto sd = static_cast<float>(spec.netd_k);
  const RandomStream stream = state_->temporal.sub(index);
  const double per_kelvin = 1 / spec.kelvin_per_count;
  const double base = (scene.background_k - spec.offset_k) * per_kelvin + 0.5;
  const double full_scale = static_cast<double>((1u << spec.bits) - 1u) + 0.5;
  auto* out = counts.ptr<std::uint16_t>();
  if (state_->many_stages()) {
    const cv::Mat1f analog = state_->analog(*unit, scene.delta_t_k, index);
    const float* pixels = analog.ptr<float>();
    for (std::size_t i = 0; i < count; ++i) {
      const double level = base + static_cast<double>(pixels[i]) * per_kelvin;
      out[i] = static_cast<std::uint16_t>(static_cast<int>(std::clamp(level, 0.0, full_scale)));
    }
    return counts;
  }
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
