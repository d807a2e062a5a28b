// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/chain_presenter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/plan/atmospheres.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/scene_descriptions.h"
#include "bench/studies/scene_pictures.h"
#include "sim_devices/sensor/image_chain.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

constexpr int fine = 16;                 ///< points per pitch of continuous stages
constexpr int enlarged = 8;              ///< points per sample of display and observer
const cv::Point2d centre_px{0.3, -0.2};  ///< of the triangle, from the centre of the picture: not a special phase

/// The displayed square and its content.
struct Setting {
  SensorSpec sensor;
  TemplateObserverSpec observer;
  SensorPlan effects;
  PlateScene scene;
  Polygon shape_pitch;  ///< around the origin
  cv::Point2d centre;   ///< of the triangle, in pitches from the centre of the square
  int side_pitch = 0;
};

Result<Setting> setting_of(const ChainSettings& options) {
  Setting s;
  TODBENCH_TRY(auto sensor, load_sensor(options.sensor));
  TODBENCH_TRY(auto observer, load_observer(options.observer));
  TODBENCH_TRY_VOID(require_square_pixels(sensor, "this page"));
  if (!(options.size_pitch > 0)) return fail(ErrorCode::invalid_input, "the size of the triangle must be above 0");
  s.sensor = sensor;
  s.observer = observer;
  s.effects = full_plan(s.sensor, options.skip, {});
  s.side_pitch = 2 * static_cast<int>(std::ceil(options.size_pitch + 3));
  s.sensor.width = s.sensor.height = s.side_pitch;
  s.sensor.distortion_percent = s.sensor.distortion_r4_percent = 0;  // the centre of the picture is shown
  s.scene.distance_m = 1;
  s.scene.delta_t_k = options.delta_t_k;
  s.scene.background_k = s.sensor.scene_temperature_k;
  s.scene.centre_px = centre_px;
  const double size_mm = options.size_pitch * s.sensor.ifov_mrad() * s.scene.distance_m;
  s.scene.plate.name = "chain";
  s.scene.plate.width_mm = s.scene.plate.height_mm = 10 * size_mm;
  s.scene.plate.triangles = {{.name = "triangle", .position_mm = {0, 0}, .size_mm = size_mm, .apex = options.apex}};
  s.shape_pitch = triangle(options.size_pitch, options.apex);
  s.centre = centre_px / s.sensor.microscan;
  return s;
}

/// Position of the first fine point, in pitches from the triangle's centroid.
cv::Point2d first_point(const Setting& s) {
  const double corner = -s.side_pitch / 2.0 + 0.5 / fine;
  return cv::Point2d(corner, corner) - s.centre;
}

/// The sharp shape: the share of each point's square that it covers, sampled at 8 x 8 positions.
cv::Mat1d sharp(const Setting& s) {
  constexpr int places = 8;
  const int side = s.side_pitch * fine;
  std::vector<cv::Point2f> outline;
  for (const auto& v : s.shape_pitch) outline.emplace_back(static_cast<float>(v.x), static_cast<float>(v.y));
  const cv::Rect2f box = cv::boundingRect(outline);
  cv::Mat1d out = cv::Mat1d::zeros(side, side);
  const cv::Point2d first = first_point(s);
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const cv::Point2d middle(first.x + static_cast<double>(column) / fine, first.y + static_cast<double>(row) / fine);
      if (middle.x < box.x - 1 || middle.y < box.y - 1 || middle.x > box.br().x + 1 || middle.y > box.br().y + 1)
        continue;
      int inside = 0;
      for (int k = 0; k < places * places; ++k) {
        const int across = k % places, down = k / places;
        const cv::Point2f point(static_cast<float>(middle.x + ((across + 0.5) / places - 0.5) / fine),
                                static_cast<float>(middle.y + (down + 0.5) / places / fine - 0.5 / fine));
        inside += cv::pointPolygonTest(outline, point, false) >= 0 ? 1 : 0;
      }
      out(row, column) = static_cast<double>(inside) / (places * places);
    }
  }
  return out;
}

SensorPlan without(SensorPlan plan, const std::vector<Effect>& effects) {
  for (auto& decision : plan.decisions) {
    if (std::find(effects.begin(), effects.end(), decision.effect) != effects.end()) decision.decision = Decision::skip;
  }
  return plan;
}

cv::Mat1d continuous(const Setting& s, const SensorPlan& plan) {
  const ImageChain chain(s.sensor, plan, Accuracy::normal());
  const int side = s.side_pitch * fine;
  return chain.image(s.shape_pitch).sample(first_point(s), 1.0 / fine, {side, side});
}

cv::Mat1d modelled(const Setting& s, const SensorPlan& plan, const ChainSettings& options) {
  const SensorModel model(s.sensor, plan, Accuracy::normal(), options.seed);
  cv::Mat1d out;
  model.picture(s.scene, options.index).convertTo(out, CV_64F);
  return out;
}

/// The picture on a display that interpolates between samples.
cv::Mat1d displayed(const cv::Mat1d& samples) {
  cv::Mat1d out;
  cv::resize(samples, out, {}, enlarged, enlarged, cv::INTER_CUBIC);
  return out;
}

/// Convolves the samples with the observer's Gaussian: the observer correlates this with an ideal shape.
cv::Mat1d filtered(const cv::Mat1d& samples, double sigma) {
  if (!(sigma > 0)) return displayed(samples);
  const int side = samples.rows * enlarged;
  cv::Mat1d spread(side, samples.rows);
  for (int point = 0; point < side; ++point) {
    const double place = (point + 0.5) / enlarged - 0.5;
    double sum = 0;
    for (int k = 0; k < samples.rows; ++k) sum += spread(point, k) = std::exp(-std::pow((place - k) / sigma, 2) / 2);
    spread.row(point) /= sum;
  }
  return spread * samples * spread.t();
}

/// Stages of a scene in the order of the views; counts are those of the display, one pixel per sample.
Result<std::vector<StagePicture>> scene_chain(const ChainSettings& options) {
  ScenePicturesTask task;
  auto scene = load_scene(options.scene, [](const std::string& path) -> Result<StoredPicture> {
    return fail(ErrorCode::invalid_input, path + ": this page shows no scenes with pictures; use 'todbench picture'");
  });
  if (!scene) return tl::unexpected(scene.error());
  TODBENCH_TRY(auto sensor, load_sensor(options.sensor));
  TODBENCH_TRY(auto observer, load_observer(options.observer));
  auto air = load_atmosphere(options.atmosphere, {.band = {sensor.wavelength_min_um, sensor.wavelength_max_um},
                                                  .weight_temperature_k = sensor.scene_temperature_k});
  if (!air) return tl::unexpected(air.error());
  task.scene = *std::move(scene);
  task.sensor = std::move(sensor);
  task.observer = std::move(observer);
  task.air = *std::move(air);
  task.view.range_m = options.range_m;
  task.accuracy = Accuracy::draft();
  task.effects.skip = options.skip;
  task.seed = options.seed;
  TODBENCH_TRY(const auto seen, scene_pictures(task));
  constexpr std::array shown{Stage::scene, Stage::optics,  Stage::detector, Stage::samples,
                             Stage::noise, Stage::display, Stage::observer};
  std::vector<StagePicture> out;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const SceneStage& stage = seen.stages[i];
    StagePicture picture{.stage = shown[i],
                         .kelvin = {},
                         .pixels_per_pitch = stage.pixels_per_pitch,
                         .note = QString::fromStdString(stage.note),
                         .grey_k = std::pair(seen.grey_low_k, seen.grey_high_k)};
    stage.kelvin.convertTo(picture.kelvin, CV_64F);
    if (shown[i] == Stage::display) {
      StagePicture counts = picture;
      counts.stage = Stage::quantised;
      cv::resize(picture.kelvin, counts.kelvin, {}, 1.0 / enlarged, 1.0 / enlarged, cv::INTER_NEAREST);
      counts.pixels_per_pitch /= enlarged;
      counts.note = QString("%1 mK per count").arg(1000 * task.sensor.kelvin_per_count);
      out.push_back(std::move(counts));
    }
    out.push_back(std::move(picture));
  }
  return out;
}

QString onoff(const SensorPlan& plan, Effect effect, const QString& on) {
  return plan.simulates(effect) ? on : QString("skipped");
}

}  // namespace

QString name_of(Stage stage) {
  switch (stage) {
    case Stage::scene:
      return "Scene";
    case Stage::optics:
      return "Optics";
    case Stage::detector:
      return "Detector";
    case Stage::samples:
      return "Samples";
    case Stage::noise:
      return "Noise";
    case Stage::quantised:
      return "Quantised";
    case Stage::display:
      return "Display";
    case Stage::observer:
      return "Observer's filter";
  }
  return {};
}

Result<std::vector<StagePicture>> chain_pictures(const ChainSettings& options) {
  if (!options.scene.empty()) return scene_chain(options);
  TODBENCH_TRY(auto setting, setting_of(options));
  const Setting& s = setting;
  const double per_pitch = s.sensor.microscan;
  const SensorPlan& plan = s.effects;
  cv::Mat1d samples;
  SensorModel(s.sensor, plan, Accuracy::normal(), options.seed)
      .unit_signal(s.scene)
      ->convertTo(samples, CV_64F, options.delta_t_k);
  const cv::Mat1d noisy = modelled(s, without(plan, {Effect::quantisation}), options);
  const cv::Mat1d quantised = modelled(s, plan, options);
  const double k = options.delta_t_k;
  std::vector<StagePicture> out;
  out.push_back({Stage::scene, k * sharp(s), fine, QString("ΔT %1 K").arg(k)});
  out.push_back({Stage::optics, k * continuous(s, without(plan, {Effect::detector})), fine,
                 onoff(plan, Effect::diffraction, QString("f/%1").arg(s.sensor.f_number)) + ", aberration " +
                     onoff(plan, Effect::aberration, QString("σ %1 pitch").arg(s.sensor.aberration_sigma_pitch))});
  out.push_back(
      {Stage::detector, k * continuous(s, plan), fine,
       onoff(plan, Effect::detector,
             QString("width %1 µm%2, pitch %3 µm")
                 .arg(s.sensor.detector_um)
                 .arg(s.sensor.square_detector() ? QString()
                                                 : QString(", height %1 µm").arg(s.sensor.detector_along(PitchAxis::y)))
                 .arg(s.sensor.pitch_um))});
  out.push_back({Stage::samples, samples, per_pitch, QString("%1 per pitch").arg(per_pitch)});
  out.push_back({Stage::noise, noisy, per_pitch,
                 onoff(plan, Effect::temporal_noise, QString("NETD %1 mK").arg(1000 * s.sensor.netd_k)) +
                     ", fixed pattern " +
                     onoff(plan, Effect::fixed_pattern, QString("%1 mK").arg(1000 * s.sensor.fixed_pattern_k))});
  out.push_back({Stage::quantised, quantised, per_pitch,
                 onoff(plan, Effect::quantisation, QString("%1 mK per count").arg(1000 * s.sensor.kelvin_per_count))});
  out.push_back({Stage::display, displayed(quantised), enlarged * per_pitch, "bicubic interpolation"});
  out.push_back({Stage::observer, filtered(quantised, s.observer.blur_sigma_samples), enlarged * per_pitch,
                 QString("σ %1 samples").arg(s.observer.blur_sigma_samples)});
  return out;
}

ChainPresenter::ChainPresenter(Workbench& bench, QObject* parent) : QObject(parent), bench_(bench) {}

void ChainPresenter::set_options(const ChainSettings& options) {
  options_ = options;
  busy_ = true;
  const std::uint64_t request = ++request_;
  jobs_.start([this, request, options](const std::stop_token&) {
    auto pictures = chain_pictures(options);
    bench_.post([this, request, pictures = std::move(pictures)] {
      if (request != request_) return;
      busy_ = false;
      problem_ = pictures ? QString() : QString::fromStdString(pictures.error().message);
      // The pictures of an earlier scene would be taken for those of this one.
      pictures_ = pictures ? *pictures : std::vector<StagePicture>();
      emit updated();
    });
  });
  emit updated();
}

}  // namespace todbench
