#include "sim_devices/prediction/dynamic_trials.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "sim_devices/prediction/trial_plate.h"
#include "sim_devices/sensor/effect_quantisation.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/plate/test_pattern.h"
#include "tod/registration/patch_windows.h"

namespace todbench {
namespace {

/// The frames of a pass.
struct MovingPass {
  std::vector<cv::Mat1f> frames;
  PlateScene scene;    ///< of the first
  double step_px = 0;  ///< from frame to frame, along x
};

/// Observer and bank of one size. The bank reaches half a sample further than the observer searches, so that the whole
/// search is round the true place wherever that is between two samples.
struct PreparedSize {
  std::shared_ptr<const PreparedObserver> observer;
  std::shared_ptr<const TemplateBank> bank;
};

class SequenceJudge {
 public:
  static Result<SequenceJudge> prepare(TemplateObserver& observer, const DynamicTrialOptions& options) {
    SequenceJudge judge;
    judge.spec_ = observer.spec();
    judge.steps_ = static_cast<int>(std::lround(1 / judge.spec_.search_step_samples));
    judge.reach_ = static_cast<int>(std::lround(judge.spec_.search_range_samples * judge.steps_));
    TemplateObserverSpec wider = judge.spec_;
    const int half_a_sample = (judge.steps_ + 1) / 2;
    wider.search_range_samples += static_cast<double>(half_a_sample) / judge.steps_;
    judge.wide_reach_ = judge.reach_ + half_a_sample;
    if (auto valid = validate(wider); !valid) return tl::unexpected(valid.error());
    for (const double size : options.sizes_pitch) {
      auto prepared = observer.prepare(size, 1);
      if (!prepared) return tl::unexpected(prepared.error());
      auto bank = TemplateBank::build(wider, triangle_alternatives(), size, 1);
      if (!bank) return tl::unexpected(bank.error());
      judge.sizes_.push_back({*prepared, std::make_shared<const TemplateBank>(*std::move(bank))});
    }
    return judge;
  }

  [[nodiscard]] std::size_t sizes() const { return sizes_.size(); }

  /// Of triangle t in the pass. `noise_k` is the sensor's in one frame.
  [[nodiscard]] int choose(SequenceObserver kind, const MovingPass& pass, std::size_t t, cv::Point2d place,
                           double noise_k, const RandomStream& noise) const {
    const PreparedSize& size = sizes_[t / 4];
    const double contrast_k = pass.scene.delta_t_k;
    switch (kind) {
      case SequenceObserver::tracking_sum:
        return tracked(size, pass, place, noise_k, noise);
      case SequenceObserver::static_sum: {
        const double middle_px = pass.step_px * static_cast<double>(pass.frames.size() - 1) / 2;
        const PatchWindow window = patch_window(place + cv::Point2d(middle_px, 0), size.observer->window_samples());
        Patch patch{.kelvin = cv::Mat1d::zeros(window.pixels.size()), .phase = window.phase};
        for (const cv::Mat1f& frame : pass.frames) patch.kelvin += seen_in(frame, window);
        patch.kelvin /= static_cast<double>(pass.frames.size());
        patch.noise_k = noise_k / std::sqrt(static_cast<double>(pass.frames.size()));
        return size.observer->choose(patch, contrast_k, noise).alternative;
      }
      case SequenceObserver::single_frame:
        break;
    }
    const PatchWindow window = patch_window(place, size.observer->window_samples());
    const Patch patch{.kelvin = seen_in(pass.frames.front(), window), .phase = window.phase, .noise_k = noise_k};
    return size.observer->choose(patch, contrast_k, noise).alternative;
  }

 private:
  static cv::Mat1d seen_in(const cv::Mat1f& frame, const PatchWindow& window) {
    cv::Mat1d kelvin;
    frame(window.pixels).convertTo(kelvin, CV_64F);
    return kelvin;
  }

  /// Mean of the scores over the frames, each at the template that stands where the target is, and the observer's own
  /// noise once.
  [[nodiscard]] int tracked(const PreparedSize& size, const MovingPass& pass, cv::Point2d place, double noise_k,
                            const RandomStream& noise) const {
    const TemplateBank& bank = *size.bank;
    const auto samples = static_cast<std::size_t>(bank.window_samples() * bank.window_samples());
    const std::size_t side = static_cast<std::size_t>(2 * reach_ + 1), places = side * side;
    std::vector<float> seen(samples), room(samples), scores(bank.padded_templates());
    std::vector<double> sums(static_cast<std::size_t>(bank.alternatives()) * places);
    TemplateObserverSpec without_noise = spec_;
    without_noise.internal_noise = 0;
    without_noise.sensor_noise_factor = 1;
    const double weight = 1.0 / static_cast<double>(pass.frames.size());
    const auto add = [&](cv::Point2d phase, double share) {
      bank.project(seen, scores);
      const int right = static_cast<int>(std::lround(phase.x * steps_)) + wide_reach_ - reach_;
      const int down = static_cast<int>(std::lround(phase.y * steps_)) + wide_reach_ - reach_;
      const int wide = 2 * wide_reach_ + 1;
      for (int o = 0; o < bank.alternatives(); ++o) {
        for (int i = 0; i < static_cast<int>(places); ++i) {
          const int x = i % static_cast<int>(side) + right, y = i / static_cast<int>(side) + down;
          sums[static_cast<std::size_t>(o) * places + static_cast<std::size_t>(i)] +=
              share * static_cast<double>(scores[static_cast<std::size_t>(o * bank.places() + y * wide + x)]);
        }
      }
    };
    for (std::size_t k = 0; k < pass.frames.size(); ++k) {
      const cv::Point2d now = place + cv::Point2d(pass.step_px * static_cast<double>(k), 0);
      const PatchWindow window = patch_window(now, bank.window_samples());
      const Patch patch{.kelvin = seen_in(pass.frames[k], window), .phase = window.phase};
      seen_patch(without_noise, patch, pass.scene.delta_t_k, noise, seen, room);
      add(window.phase, weight);
    }
    const Patch nothing{.kelvin = cv::Mat1d::zeros(bank.window_samples(), bank.window_samples()),
                        .phase = {},
                        .noise_k = noise_k * std::sqrt(weight)};
    seen_patch(spec_, nothing, pass.scene.delta_t_k, noise, seen, room);
    add({0, 0}, 1);
    Choice choice;
    choice.alternatives = bank.alternatives();
    for (int o = 0; o < choice.alternatives; ++o) {
      const auto begin = sums.begin() + o * static_cast<std::ptrdiff_t>(places);
      choice.scores[static_cast<std::size_t>(o)] =
          *std::max_element(begin, begin + static_cast<std::ptrdiff_t>(places));
    }
    return winning_alternative(choice, noise);
  }

  TemplateObserverSpec spec_;
  int steps_ = 8, reach_ = 8, wide_reach_ = 12;
  std::vector<PreparedSize> sizes_;
};

/// Frames that the stages remember.
int lead_frames(const DynamicTrialOptions& options) {
  if (!options.stages) return 0;
  int sum = 0;
  const auto stages = options.stages();
  for (const auto& stage : stages) sum += stage->memory_frames();
  return sum;
}

Result<MovingPass> exposed_pass(const SensorModel& model, const TargetPlate& plate, const DynamicTrialOptions& options,
                                double speed_mrad_s, int index) {
  // The streams are those of camera_trials(): a target that rests gives the answers of a still picture, bit for bit.
  const RandomStream phases = RandomStream(options.seed, "camera_trials.phase").sub(static_cast<std::uint64_t>(index));
  const double along = index % 2 == 0 ? speed_mrad_s : -speed_mrad_s;
  const SensorSpec& spec = model.spec();
  MovingPass pass;
  pass.step_px = along / spec.ifov_mrad() / spec.frame_rate_hz;
  pass.scene.plate = plate;
  pass.scene.delta_t_k = options.delta_t_k;
  pass.scene.distance_m = trial_distance_m;
  pass.scene.centre_px = {phases.uniform(0) - 0.5, phases.uniform(1) - 0.5};
  pass.scene.motion = {.x_mrad_s = along, .y_mrad_s = 0};
  auto stages = options.stages ? options.stages() : std::vector<std::unique_ptr<ChainStage>>();
  const int lead = lead_frames(options);
  for (int k = -lead; k < options.frames; ++k) {
    PlateScene scene = pass.scene;
    scene.centre_px.x += pass.step_px * k;
    // What stages see before a pass has random numbers behind those of all passes.
    const int frame = k >= 0 ? index * options.frames + k : options.passes * options.frames + index * lead + (k + lead);
    cv::Mat1f picture;
    model.expose(scene, static_cast<std::uint64_t>(frame)).convertTo(picture, CV_32F);
    for (const auto& stage : stages) {
      auto answer = stage->process(picture);
      if (!answer) return tl::unexpected(answer.error());
      picture = *std::move(answer);
    }
    if (k < 0) continue;
    cv::Mat1f kelvin;
    picture.convertTo(kelvin, CV_32F, spec.kelvin_per_count, spec.offset_k - scene.background_k);
    pass.frames.push_back(std::move(kelvin));
  }
  return pass;
}

void add_answers(const SequenceJudge& judge, const MovingPass& pass, const SensorModel& model, double noise_k,
                 int index, const RandomStream& trial, DynamicTrials& trials) {
  for (const SequenceObserver kind : all_sequence_observers) {
    const auto k = static_cast<std::size_t>(kind);
    std::vector<Level> levels(judge.sizes());
    for (std::size_t t = 0; t < 4 * judge.sizes(); ++t) {  // the marks follow
      const PlateTriangle& triangle = pass.scene.plate.triangles[t];
      const cv::Point2d place = scene_pixel(pass.scene, triangle.position_mm, model.spec().ifov_mrad(), model.size());
      const int answer = judge.choose(kind, pass, t, place, noise_k, trial.sub(k).sub(t));
      Level& level = levels[t / 4];
      level.size = triangle.size_mm;
      level.correct += answer == static_cast<int>(triangle.apex) ? 1 : 0;
      level.total += 1;
      level.cluster = index;
    }
    trials.levels[k].insert(trials.levels[k].end(), levels.begin(), levels.end());
  }
}

Result<void> check_dynamic(const SensorSpec& sensor, const DynamicTrialOptions& options) {
  const auto refuse = [](const std::string& why) { return fail(ErrorCode::invalid_input, why); };
  if (options.sizes_pitch.empty() || options.speeds_mrad_s.empty() || options.passes < 2 || options.frames < 1)
    return refuse("dynamic trials need sizes, speeds, two passes and a frame");
  for (const double size : options.sizes_pitch) {
    if (!(size > 0.1 && size < 40)) return refuse("dynamic trials need sizes of 0.1 to 40 pitches");
  }
  if (!(std::abs(options.delta_t_k) > 0)) return refuse("a contrast of 0 K has no threshold");
  if (!sensor.modules.empty()) return refuse("dynamic trials do not run the [[module]] of a sensor");
  if (sensor.samples_per_pitch() != 1)
    return refuse("dynamic trials are for a camera without microscan and super-resolution");
  for (const double speed : options.speeds_mrad_s) {
    const double px = speed / sensor.ifov_mrad() / sensor.frame_rate_hz;
    // Beyond it rows that are read one after the other would matter, and a pass leaves the picture.
    if (!(px >= 0 && px <= 5)) return refuse("dynamic trials need speeds of 0 to 5 pixels per frame");
  }
  if (reaches_an_end(sensor, options.delta_t_k, PlateScene{}.background_k))
    return refuse("a contrast of " + std::to_string(options.delta_t_k) +
                  " K reaches an end of the camera's counts: frames of it are clipped");
  return {};
}

}  // namespace

std::string_view to_string(SequenceObserver observer) {
  constexpr std::array<std::string_view, all_sequence_observers.size()> names{"single-frame", "tracking-sum",
                                                                              "static-sum"};
  return names[static_cast<std::size_t>(observer)];
}

Result<std::vector<DynamicTrials>> dynamic_trials(const SensorSpec& sensor, TemplateObserver& observer,
                                                  const DynamicTrialOptions& options) {
  if (auto checked = check_dynamic(sensor, options); !checked) return tl::unexpected(checked.error());
  const double fastest = *std::max_element(options.speeds_mrad_s.begin(), options.speeds_mrad_s.end());
  const double reach_px =
      fastest / sensor.ifov_mrad() / sensor.frame_rate_hz * (options.frames - 1 + lead_frames(options));
  const TargetPlate plate = trial_plate(options.sizes_pitch, sensor.ifov_mrad());
  const SensorSpec camera = cropped_to(sensor, plate, static_cast<int>(std::ceil(reach_px)));
  auto judge = SequenceJudge::prepare(observer, options);
  if (!judge) return tl::unexpected(judge.error());
  const RandomStream internal(options.seed, "camera_trials.internal");
  const double noise_k = std::hypot(camera.netd_k, camera.kelvin_per_count / std::sqrt(12.0));
  std::vector<DynamicTrials> found;
  for (const double speed : options.speeds_mrad_s) {
    // A chain for each direction of each speed is kept by the model; another speed needs none of them.
    const SensorModel model(camera, full_plan(camera, {}, {}, {.x_mrad_s = speed, .y_mrad_s = 0}), options.accuracy,
                            options.seed);
    DynamicTrials trials;
    trials.speed_mrad_s = speed;
    trials.speed_px = speed / camera.ifov_mrad() / camera.frame_rate_hz;
    for (int p = 0; p < options.passes; ++p) {
      if (options.stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
      const auto pass = exposed_pass(model, plate, options, speed, p);
      if (!pass) return tl::unexpected(pass.error());
      add_answers(*judge, *pass, model, noise_k, p, internal.sub(static_cast<std::uint64_t>(p) * 16), trials);
    }
    found.push_back(std::move(trials));
  }
  return found;
}

}  // namespace todbench
