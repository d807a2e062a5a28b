// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/sensor_model.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <mutex>
#include <numbers>
#include <numeric>
#include <tuple>
#include <vector>

#include "sim_devices/sensor/effect_distortion.h"
#include "sim_devices/sensor/effect_image_dance.h"
#include "sim_devices/sensor/effect_quantisation.h"
#include "sim_devices/sensor/effect_readout.h"
#include "sim_devices/sensor/effect_row.h"
#include "sim_devices/sensor/image_chain.h"
#include "sim_devices/sensor/pixel_faults.h"
#include "sim_devices/sensor/scene_image.h"

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

/// Adds the values that lie inside the picture.
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
  std::uint64_t seed;
  std::vector<const stage::Noise*> noises;  ///< new in every exposure
  cv::Mat1f fixed_noise;                    ///< sum of all fixed noise, kelvin; empty: none
  ImageDance dance;
  std::vector<PixelFault> faults;
  std::vector<PictureStage> picture_stages;
  mutable std::mutex mutex;
  mutable std::deque<std::pair<PlateScene, std::shared_ptr<const cv::Mat1f>>> scenes;
  mutable std::map<ShapeKey, std::unique_ptr<const PolygonImage>> shapes;
  mutable std::map<std::pair<double, double>, std::unique_ptr<const ImageChain>> chains;    ///< by motion
  mutable std::map<std::pair<double, double>, std::unique_ptr<const SceneImager>> imagers;  ///< by motion

  State(SensorSpec s, SensorPlan p, Accuracy a, std::uint64_t seed_of_all)
      : spec(as_planned(std::move(s), p)), plan(std::move(p)), accuracy(a), seed(seed_of_all), dance(spec) {
    faults = pixel_faults(spec);
    const NoiseStreams streams = [this](std::string_view name, std::uint64_t) { return stream(name); };
    for (const Effect effect : all_effects) {
      if (!plan.simulates(effect) || is_neutral(spec, effect)) continue;
      const EffectRow& row = row_of(effect);
      if (const auto* noise = std::get_if<stage::Noise>(&row.stage)) {
        if (noise->recurrence == stage::Recurrence::every_exposure) {
          noises.push_back(noise);
        } else {
          if (fixed_noise.empty()) fixed_noise = cv::Mat1f(size(), 0.0F);
          noise->add(fixed_noise, spec, streams, 1);
        }
      }
      if (const auto* own = std::get_if<stage::Picture>(&row.stage))
        picture_stages.push_back(own->prepare(spec, streams));
    }
  }

  [[nodiscard]] RandomStream stream(std::string_view name) const { return {seed, "sensor." + std::string(name)}; }

  [[nodiscard]] cv::Size size() const {
    const int n = spec.samples_per_pitch();
    return {spec.width * n, spec.height * n};
  }

  [[nodiscard]] const ImageChain& chain(SceneMotion motion) const {
    auto& slot = chains[{motion.x_mrad_s, motion.y_mrad_s}];
    if (slot == nullptr) slot = std::make_unique<const ImageChain>(spec, plan, accuracy, motion);
    return *slot;
  }

  /// The four apexes share one spectrum if possible, because reading spectra dominates the cost of a new scene.
  [[nodiscard]] PolygonImage shape(double size_pitch, Apex apex, double rotation_deg, SceneMotion motion) const {
    const ImageChain& own_chain = chain(motion);
    const auto image_of = [&](Apex shown) -> const PolygonImage& {
      auto& slot = shapes[{size_pitch, static_cast<int>(shown), rotation_deg, motion.x_mrad_s, motion.y_mrad_s}];
      if (slot == nullptr)
        slot = std::make_unique<const PolygonImage>(
            own_chain.image(on_detectors(turned(triangle(size_pitch, shown), rotation_deg), spec)));
      return *slot;
    };
    const PolygonImage& upright = image_of(Apex::up);
    return own_chain.turns_alike(upright) ? upright.turned(static_cast<int>(apex)) : image_of(apex);
  }

  /// Picture before noise of the exposures of picture `index`, each displaced by the image dance.
  [[nodiscard]] cv::Mat1f danced_signal(const PlateScene& scene, std::uint64_t index) const {
    const std::vector<cv::Point2d> displacements = displacements_px(index);
    cv::Mat1f sum(size(), 0.0F);
    for (const cv::Point2d& displacement : displacements) {
      PlateScene moved = scene;
      moved.centre_px += displacement;
      const std::scoped_lock lock(mutex);
      forget_shapes();
      sum += draw(moved, size());
    }
    if (displacements.size() > 1) sum /= static_cast<double>(displacements.size());
    return sum;
  }
  [[nodiscard]] std::vector<cv::Point2d> displacements_px(std::uint64_t index) const {
    const auto exposures = static_cast<std::uint64_t>(spec.exposures_per_sample());
    std::vector<cv::Point2d> out;
    for (std::uint64_t k = 0; k < exposures; ++k)
      out.push_back(spec.samples_per_pitch() * dance.displacement_pitch(stream("dance"), index * exposures + k));
    return out;
  }
  void forget_shapes() const {
    if (shapes.size() > cached_shapes) shapes.clear();
  }

  /// Picture `index` before quantisation.
  [[nodiscard]] cv::Mat1f analog(const cv::Mat1f& unit, double delta_t_k, std::uint64_t index) const;

  /// Samples at which a place of the plate appears.
  [[nodiscard]] cv::Point2d place_of(const PlateScene& scene, cv::Point2d plate_mm, cv::Size size) const {
    const cv::Point2d place = as_lens_shows(projected(scene, plate_mm, size), spec, size);
    return as_read_out(place, readout_slope(spec, scene.motion), 0.5 * (size.height - 1));
  }
  /// The same for a lens without distortion and simultaneous readout.
  [[nodiscard]] cv::Point2d projected(const PlateScene& scene, cv::Point2d plate_mm, cv::Size size) const {
    return scene_pixel(scene, plate_mm, sample_mrad(spec), size);
  }

  /// A triangle with the distortion of the lens, relative to the displayed place of its middle.
  [[nodiscard]] PolygonImage bent(const PlateScene& scene, const PlateTriangle& t, cv::Size size) const {
    const cv::Point2d middle = as_lens_shows(projected(scene, t.position_mm, size), spec, size);
    Polygon outline = triangle(t.size_mm, t.apex, t.position_mm);
    for (auto& corner : outline) corner = projected(scene, corner, size);
    outline = as_lens_shows(outline, spec, size);
    for (auto& corner : outline) corner = (corner - middle) / spec.samples_per_pitch();
    return chain(scene.motion).image(outline);
  }

  /// Rectangles may be large compared with the picture, so they are drawn together on the whole frame.
  void draw_rectangles(const PlateScene& scene, cv::Mat1f& picture) const {
    const std::vector<PlateRectangle> cut_outs = straight_cut_outs(scene.plate);
    if (cut_outs.empty()) return;
    std::vector<PaintedPolygon> painted;
    for (const PlateRectangle& rectangle : cut_outs) {
      Polygon outline = outline_mm(rectangle);
      for (auto& corner : outline) corner = projected(scene, corner, picture.size());
      if (distorts(spec)) outline = as_lens_shows(outline, spec, picture.size());
      for (auto& corner : outline)
        corner = as_read_out(corner, readout_slope(spec, scene.motion), 0.5 * (picture.rows - 1));
      painted.push_back({std::move(outline), 1});
    }
    auto& imager = imagers[{scene.motion.x_mrad_s, scene.motion.y_mrad_s}];
    if (imager == nullptr) imager = std::make_unique<const SceneImager>(spec, plan, accuracy, scene.motion);
    const cv::Mat1d image = imager->image(visible_edges(painted), picture.size());
    for (int row = 0; row < picture.rows; ++row)
      for (int x = 0; x < picture.cols; ++x) picture(row, x) += static_cast<float>(image(row, x));
  }

  [[nodiscard]] cv::Mat1f draw(const PlateScene& scene, cv::Size size) const {
    const int n = spec.samples_per_pitch();
    cv::Mat1f picture = in_fields(way_between_fields(spec, scene.motion), n, [&](cv::Point2d displacement_pitch) {
      PlateScene field = scene;
      field.centre_px += displacement_pitch * n;
      return triangles_of(field, size);
    });
    draw_rectangles(scene, picture);
    return picture;
  }

  /// All rows at one time.
  [[nodiscard]] cv::Mat1f triangles_of(const PlateScene& scene, cv::Size size) const {
    const double sample_pitch = 1.0 / spec.samples_per_pitch();
    const std::vector<PlateTriangle>& triangles = scene.plate.triangles;
    // Sampled size by size, so that their common spectrum stays in the cache; added in the order of the plate.
    std::vector<std::size_t> order(triangles.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return triangles[a].size_mm < triangles[b].size_mm; });
    std::vector<std::pair<cv::Mat1d, cv::Point>> samples(triangles.size());
    for (const std::size_t i : order) {
      const PlateTriangle& t = triangles[i];
      const cv::Point2d centre = place_of(scene, t.position_mm, size);
      const double size_pitch = t.size_mm / scene.distance_m / spec.ifov_mrad();
      const PolygonImage image =
          distorts(spec) ? bent(scene, t, size) : shape(size_pitch, t.apex, scene.rotation_deg, scene.motion);
      const int n = image.lattice().period * spec.samples_per_pitch();
      const cv::Point origin(static_cast<int>(std::lround(centre.x)) - n / 2,
                             static_cast<int>(std::lround(centre.y)) - n / 2);
      const cv::Point2d first((origin.x - centre.x) * sample_pitch, (origin.y - centre.y) * sample_pitch);
      samples[i] = {image.sample(first, sample_pitch, {n, n}), origin};
    }
    cv::Mat1f picture(size, 0.0F);
    for (const auto& [values, origin] : samples) add_clipped(picture, values, origin);
    return picture;
  }
};

SensorModel::SensorModel(SensorSpec spec, SensorPlan plan, Accuracy accuracy, std::uint64_t seed)
    : state_(std::make_unique<State>(std::move(spec), std::move(plan), accuracy, seed)) {}

SensorModel::~SensorModel() = default;

const SensorSpec& SensorModel::spec() const {
  return state_->spec;
}
const SensorPlan& SensorModel::plan() const {
  return state_->plan;
}

std::uint64_t SensorModel::seed() const {
  return state_->seed;
}

cv::Size SensorModel::size() const {
  return state_->size();
}

std::shared_ptr<const cv::Mat1f> SensorModel::unit_signal(const PlateScene& scene) const {
  const std::scoped_lock lock(state_->mutex);
  for (const auto& [cached, picture] : state_->scenes) {
    if (same_geometry(cached, scene)) return picture;
  }
  state_->forget_shapes();
  auto picture = std::make_shared<const cv::Mat1f>(state_->draw(scene, size()));
  state_->scenes.emplace_back(scene, picture);
  if (state_->scenes.size() > cached_scenes) state_->scenes.pop_front();
  return picture;
}

cv::Mat1f SensorModel::State::analog(const cv::Mat1f& unit, double delta_t_k, std::uint64_t index) const {
  CV_Assert(unit.size() == size() && unit.isContinuous());
  cv::Mat1f out(unit.size());
  const auto count = static_cast<std::size_t>(out.total());
  const float* signal = unit.ptr<float>();
  auto* pixels = out.ptr<float>();
  const auto contrast = static_cast<float>(delta_t_k);
  for (std::size_t i = 0; i < count; ++i) pixels[i] = contrast * signal[i];
  // A sample is the mean of this number of exposures of the sequence.
  const auto exposures = static_cast<std::uint64_t>(spec.exposures_per_sample());
  const double weight = 1.0 / static_cast<double>(exposures);
  for (std::uint64_t k = 0; k < exposures; ++k) {
    const std::uint64_t exposure = index * exposures + k;
    const NoiseStreams streams = [&](std::string_view name, std::uint64_t ago) {
      return stream(name).sub(exposure - ago);
    };
    for (const stage::Noise* noise : noises) noise->add(out, spec, streams, weight);
  }
  if (!fixed_noise.empty()) {
    const auto* fixed = fixed_noise.ptr<float>();
    for (std::size_t i = 0; i < count; ++i) pixels[i] += fixed[i];
  }
  if (!faults.empty()) show_faults(out, faults, spec, stream("faults").sub(index), index);
  for (const PictureStage& stage : picture_stages) stage(out);
  return out;
}

std::vector<cv::Point2d> SensorModel::displacements_px(std::uint64_t index) const {
  return state_->displacements_px(index);
}

cv::Mat1f SensorModel::picture(const PlateScene& scene, std::uint64_t index) const {
  if (!state_->dance.still())
    return picture(state_->danced_signal(scene, index), scene.delta_t_k, scene.background_k, index);
  return picture(*unit_signal(scene), scene.delta_t_k, scene.background_k, index);
}

cv::Mat1f SensorModel::picture(const cv::Mat1f& unit_signal, double delta_t_k, double background_k,
                               std::uint64_t index) const {
  cv::Mat1f out = state_->analog(unit_signal, delta_t_k, index);
  if (!state_->plan.simulates(Effect::quantisation)) return out;
  const Quantiser quantiser(state_->spec, background_k);
  for (float& pixel : out) pixel = quantiser.rounded(pixel);
  return out;
}

cv::Mat1w SensorModel::expose(const PlateScene& scene, std::uint64_t index) const {
  if (!state_->dance.still())
    return expose(state_->danced_signal(scene, index), scene.delta_t_k, scene.background_k, index);
  return expose(*unit_signal(scene), scene.delta_t_k, scene.background_k, index);
}

cv::Mat1w SensorModel::expose(const cv::Mat1f& unit_signal, double delta_t_k, double background_k,
                              std::uint64_t index) const {
  const cv::Mat1f kelvin = state_->analog(unit_signal, delta_t_k, index);
  const Quantiser quantiser(state_->spec, background_k);
  cv::Mat1w counts(kelvin.size());
  const auto* from = kelvin.ptr<float>();
  auto* to = counts.ptr<std::uint16_t>();
  for (std::size_t i = 0; i < kelvin.total(); ++i) to[i] = quantiser.count(from[i]);
  return counts;
}

cv::Point2d sample_mrad(const SensorSpec& spec) {
  return cv::Point2d(spec.ifov_mrad(PitchAxis::x), spec.ifov_mrad(PitchAxis::y)) / spec.samples_per_pitch();
}

}  // namespace todbench
