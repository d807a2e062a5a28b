// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/camera_trials.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "acquisition/base/try.h"
#include "sim_devices/prediction/trial_plate.h"
#include "sim_devices/sensor/effect_quantisation.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/registration/patch_windows.h"
#include "tod/registration/super_resolution.h"

namespace todbench {
namespace {

constexpr int factor = 2;
constexpr double largest_shift_px = 1.5;  ///< search range for frames displaced by at most half a pitch

cv::Mat1f kelvin_of(const cv::Mat1w& counts, const SensorSpec& sensor, double background_k) {
  cv::Mat1f kelvin;
  counts.convertTo(kelvin, CV_32F, sensor.kelvin_per_count, sensor.offset_k - background_k);
  return kelvin;
}

/// Frames of one presentation with their true displacements.
struct Presentation {
  std::vector<cv::Mat1f> frames;
  std::vector<cv::Point2d> displacements_px;  ///< against the first
  PlateScene scene;                           ///< of the first
};

cv::Point2d displacement_of(FrameDisplacements kind, int frame) {
  if (kind == FrameDisplacements::half_pitches) return {0.5 * (frame % 2), 0.5 * (frame / 2 % 2)};
  // Additive recurrence with the plastic number: displacements fill the pixel evenly for any number of frames.
  const double g = 1.3247179572447460;
  return {std::remainder(frame / g, 1.0), std::remainder(frame / (g * g), 1.0)};
}

Presentation expose(const SensorModel& model, const TargetPlate& plate, const CameraTrialOptions& options, int index) {
  const RandomStream phases = RandomStream(options.seed, "camera_trials.phase").sub(static_cast<std::uint64_t>(index));
  Presentation shown;
  shown.scene.plate = plate;
  shown.scene.delta_t_k = options.delta_t_k;
  shown.scene.distance_m = trial_distance_m;
  shown.scene.centre_px = {phases.uniform(0) - 0.5, phases.uniform(1) - 0.5};
  for (int k = 0; k < options.frames; ++k) {
    const cv::Point2d displacement = displacement_of(options.displacements, k);
    PlateScene scene = shown.scene;
    scene.centre_px += displacement;
    const auto frame =
        static_cast<std::uint64_t>(index) * static_cast<std::uint64_t>(options.frames) + static_cast<std::uint64_t>(k);
    shown.frames.push_back(kelvin_of(model.expose(scene, frame), model.spec(), scene.background_k));
    shown.displacements_px.push_back(displacement);
  }
  return shown;
}

/// Frames of a presentation that were registered. A camera leaves the others out, too.
struct Registered {
  std::vector<cv::Mat1f> frames;
  std::vector<cv::Point2d> shifts_px;
  double squared_errors = 0;  ///< estimated minus true displacement, mean of both axes
};

Registered register_frames(const Presentation& shown) {
  Registered registered;
  registered.frames.push_back(shown.frames.front());
  registered.shifts_px.emplace_back(0, 0);
  for (std::size_t k = 1; k < shown.frames.size(); ++k) {
    const auto shift = frame_shift(shown.frames.front(), shown.frames[k]);
    if (!shift || std::hypot(shift->x, shift->y) > largest_shift_px) continue;
    const cv::Point2d error = *shift - shown.displacements_px[k];
    registered.squared_errors += error.dot(error) / 2;
    registered.frames.push_back(shown.frames[k]);
    registered.shifts_px.push_back(*shift);
  }
  return registered;
}

/// A picture to be judged: the place of a camera pixel in it, and its sampling.
struct Picture {
  cv::Mat1f kelvin;
  cv::Point2d first_px;
  int samples_per_pitch = 1;
  double noise_k = 0;
};

/// One observer, prepared for every size on both sampling grids.
class Judge {
 public:
  static Result<Judge> prepare(TemplateObserver& observer, const CameraTrialOptions& options) {
    Judge judge;
    judge.draws_ = options.graded_draws;
    for (const int samples : {1, factor}) {
      for (const double size : options.sizes_pitch) {
        TODBENCH_TRY(auto prepared, observer.prepare(size * samples, samples));
        judge.prepared_[samples == 1 ? 0 : 1].push_back(prepared);
      }
    }
    return judge;
  }

  /// One level per size, one graded answer per triangle.
  void add_answers(PictureAnswers& out, const Picture& picture, const PlateScene& scene, cv::Point2d pixel_mrad,
                   cv::Size sensor, const RandomStream& noise, int presentation) const {
    const auto& sizes = prepared_[picture.samples_per_pitch == 1 ? 0 : 1];
    std::vector<Level> levels(sizes.size());
    for (std::size_t t = 0; t < 4 * sizes.size(); ++t) {  // the marks follow
      const PlateTriangle& triangle = scene.plate.triangles[t];
      const PreparedObserver& observer = *sizes[t / 4];
      const cv::Point2d place = scene_pixel(scene, triangle.position_mm, pixel_mrad, sensor);
      const PatchWindow window =
          patch_window((place - picture.first_px) * picture.samples_per_pitch, observer.window_samples());
      Patch patch;
      picture.kelvin(window.pixels).convertTo(patch.kelvin, CV_64F);
      patch.phase = window.phase;
      patch.noise_k = picture.noise_k;
      const GradedChoice judged = observer.judge(patch, scene.delta_t_k, noise.sub(t), draws_);
      const auto truth = static_cast<std::size_t>(triangle.apex);
      Level& level = levels[t / 4];
      level.size = triangle.size_mm;
      level.correct += judged.choice.alternative == static_cast<int>(truth) ? 1 : 0;
      level.total += 1;
      level.cluster = presentation;
      out.graded.push_back({.size = triangle.size_mm,
                            .probability_correct = std::min(1.0, judged.answers.probability[truth]),
                            .presentation = presentation,
                            .place = static_cast<int>(t)});
    }
    out.levels.insert(out.levels.end(), levels.begin(), levels.end());
  }

 private:
  std::array<std::vector<std::shared_ptr<const PreparedObserver>>, 2> prepared_;
  int draws_ = 0;
};

double noise_of(const SensorSpec& sensor, double frames) {
  return std::hypot(sensor.netd_k, sensor.kelvin_per_count / std::sqrt(12.0)) / std::sqrt(frames);
}

Result<void> check(const CameraTrialOptions& options) {
  if (options.sizes_pitch.empty() || options.presentations < 2 || options.frames < factor * factor)
    return fail(ErrorCode::invalid_input, "camera trials need at least one size, two presentations and four frames");
  for (const double size : options.sizes_pitch) {
    if (!(size > 0.1 && size < 40))
      return fail(ErrorCode::invalid_input, "camera trials need sizes of 0.1 to 40 pitches");
  }
  if (!(std::abs(options.delta_t_k) > 0)) return fail(ErrorCode::invalid_input, "a contrast of 0 K has no threshold");
  return {};
}

}  // namespace

Result<CameraTrialRecord> camera_trials(const SensorSpec& sensor, const std::vector<TemplateObserver*>& observers,
                                        const CameraTrialOptions& options) {
  TODBENCH_TRY_VOID(check(options));
  if (sensor.microscan != 1) return fail(ErrorCode::invalid_input, "super-resolution needs a camera without microscan");
  if (reaches_an_end(sensor, options.delta_t_k, PlateScene{}.background_k))
    return fail(ErrorCode::invalid_input,
                "a contrast of " + std::to_string(options.delta_t_k) +
                    " K reaches the lowest or highest count of the camera, so its frames are clipped");
  const TargetPlate plate = trial_plate(options.sizes_pitch, sensor.ifov_mrad());
  const SensorSpec camera = cropped_to(sensor, plate, 0);
  const SensorModel model(camera, full_plan(camera, {}, {}), options.accuracy, options.seed);
  std::vector<Judge> judges;
  for (TemplateObserver* observer : observers) {
    TODBENCH_TRY(auto judge, Judge::prepare(*observer, options));
    judges.push_back(std::move(judge));
  }
  CameraTrialRecord record;
  record.observers.resize(observers.size());
  const RandomStream internal(options.seed, "camera_trials.internal");
  double squares = 0, placement = 0, samples = 0;
  std::size_t used = 0;
  for (int p = 0; p < options.presentations; ++p) {
    if (options.stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
    const Presentation shown = expose(model, plate, options, p);
    const auto registered = register_frames(shown);
    const auto fine = super_resolve(registered.frames, registered.shifts_px, factor);
    if (!fine) return fail("super-resolution of the emulated camera", fine.error());
    squares += registered.squared_errors;
    used += registered.frames.size();
    placement += fine->placement_rms_px * fine->placement_rms_px;
    // The noise variance of a sample is that of a frame over the number of frames in it; the mean variance counts.
    double inverse = 0;
    for (const int count : fine->frames_per_cell) inverse += 1.0 / count;
    const double averaged = static_cast<double>(fine->frames_per_cell.total()) / inverse;
    samples += averaged;
    const Picture still{shown.frames.front(), {0, 0}, 1, noise_of(camera, 1)};
    const Picture resolved{fine->picture, fine->first_px, factor, noise_of(camera, averaged)};
    for (std::size_t o = 0; o < judges.size(); ++o) {
      const RandomStream trial = internal.sub(static_cast<std::uint64_t>(p) * 16 + o);
      const auto add = [&](PictureAnswers& answers, const Picture& picture, std::uint64_t stream) {
        judges[o].add_answers(answers, picture, shown.scene, sample_mrad(camera), model.size(), trial.sub(stream), p);
      };
      add(record.observers[o].still, still, 0);
      add(record.observers[o].super_resolved, resolved, 1);
    }
  }
  record.registration_rms_px = std::sqrt(squares / static_cast<double>(used));
  record.frames_registered = static_cast<double>(used) / options.presentations;
  record.placement_rms_px = std::sqrt(placement / options.presentations);
  record.frames_per_sample = samples / options.presentations;
  return record;
}

}  // namespace todbench
