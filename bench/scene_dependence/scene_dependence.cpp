// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/scene_dependence/scene_dependence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"
#include "acquisition/core/forwarding_source.h"
#include "bench/devices/devices.h"
#include "bench/devices/processed_source.h"
#include "bench/devices/terminal_operator.h"
#include "bench/plan/plan_options.h"
#include "bench/twin/module_chain.h"
#include "tod/measurement/judged_contrast.h"
#include "tod/measurement/set_up_step.h"
#include "tod/measurement/target_change.h"
#include "tod/plate/test_pattern.h"
#include "tod/registration/patch_windows.h"

namespace todbench {
namespace {

/// Largest movement of the plate from its place while the bar moves.
constexpr double most_moved_px = 0.3;
constexpr double found_within_px = 3;

/// Windows of the triangles of one size, in the frame in which the plate was located.
struct SizeWindows {
  double size_px = 0;
  std::vector<cv::Rect> windows;
  std::vector<cv::Mat1d> reference;  ///< minus its mean
  double energy = 0;
};

/// Smallest size that is evaluated: a smaller triangle is a single pixel.
constexpr double least_size_px = 0.8;

std::map<double, SizeWindows, std::greater<>> windows_of(const cv::Mat1d& picture, const TargetPlate& plate,
                                                         const Registration& registration) {
  std::map<double, SizeWindows, std::greater<>> sizes;
  for (const PlateTriangle& triangle : plate.triangles) {
    const double size_px = triangle.size_mm * registration.scale_at(triangle.position_mm);
    if (size_px < least_size_px) continue;
    const int side = 2 * static_cast<int>(std::ceil(1.05 * size_px + 2));
    const cv::Rect window = patch_window(registration.pixel(triangle.position_mm), side).pixels;
    if ((window & cv::Rect({0, 0}, picture.size())) != window) continue;
    SizeWindows& size = sizes[triangle.size_mm];
    cv::Mat1d reference = picture(window).clone();
    reference -= cv::mean(reference)[0];
    size.size_px = size_px;
    size.energy += reference.dot(reference);
    size.windows.push_back(window);
    size.reference.push_back(std::move(reference));
  }
  return sizes;
}

double response_of(const SizeWindows& size, const cv::Mat1d& picture) {
  double sum = 0;
  for (std::size_t i = 0; i < size.windows.size(); ++i) sum += size.reference[i].dot(picture(size.windows[i]).clone());
  return sum / size.energy;
}

/// The bar as a target: frames are handled during its movement as during a change of any target.
class BarTarget final : public Target {
 public:
  explicit BarTarget(const MoveBar& move) : move_(move) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return capabilities_; }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    TODBENCH_TRY_VOID(move_(in, std::move(stop)));
    PresentedTarget presented;
    presented.state = state;
    return presented;
  }
  bool in = false;

 private:
  const MoveBar& move_;
  TargetCapabilities capabilities_;
};

class BarRun {
 public:
  BarRun(FrameSource& camera, Target& target, const MoveBar& move_bar, const TargetState& state,
         const MeasurementOptions& measuring, const SceneDependenceOptions& options, RunController& host,
         std::stop_token stop)
      : measuring_(measuring),
        options_(options),
        target_(target),
        bar_(move_bar),
        state_(state),
        host_(host),
        stop_(std::move(stop)),
        taker_(camera, taker(camera)),
        step_(measuring_, camera, taker_, [this](const std::string& note) { notes_.push_back(note); }) {
    measuring_.registration.expected_scale_px_per_mm = 1 / (measuring_.distance_m * measuring_.ifov_mrad);
  }

  Result<SceneDependence> operator()() {
    for (const TargetPlate& plate : measuring_.plates) {
      if (plate.name == state_.plate) plate_ = mounted(plate, state_.mounting);
    }
    TODBENCH_TRY_VOID(change(target_));
    TODBENCH_TRY_VOID(move(false));
    TODBENCH_TRY(const auto picture, step_.look(stop_));
    TODBENCH_TRY(registration_, step_.find(picture, plate_, state_));
    TODBENCH_TRY_VOID(step_.contrast(plate_, registration_, state_, presented_, stop_));
    if (measuring_.contrast_unit == ContrastUnit::kelvin) noise_k_ = picture.temporal_noise_k;
    sizes_ = windows_of(picture.kelvin, plate_, registration_);
    std::map<double, std::vector<double>> ln_ratios;
    for (int cycle = 0; cycle < options_.cycles; ++cycle) {
      TODBENCH_TRY_VOID(one_cycle(ln_ratios));
    }
    return concluded(ln_ratios);
  }

 private:
  [[nodiscard]] FrameTakerOptions taker(const FrameSource& camera) const {
    FrameTakerOptions out = taker_options(measuring_, camera.info());
    out.frames_after_change += options_.settle_frames;
    return out;
  }

  Result<void> change(Target& what) {
    if (stop_.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
    TODBENCH_TRY(auto changed, change_target(what, taker_, host_, state_, stop_));
    if (!changed.presented && !changed.given_up) return fail("changing the scene", changed.presented.error());
    if (!changed.frames) return changed.frames;
    presented_ = *std::move(changed.presented);
    TODBENCH_TRY(const auto there_ns, host_.now_ns(Moment::scene_changed));
    taker_.scene_changed(there_ns);
    return {};
  }

  Result<void> move(bool in) {
    bar_.in = in;
    return change(bar_);
  }

  Result<cv::Mat1d> average() {
    auto picture = taker_.average(options_.frames, stop_, [this](const Frame& frame, const cv::Mat1d& /*kelvin*/) {
      clipped_ += clipped_samples(frame);
    });
    if (!picture) return tl::unexpected(picture.error());
    const auto moved = measure_shift(picture->kelvin, plate_, registration_, measuring_.registration, found_within_px);
    if (!moved) return fail("locating the plate beside the bar", moved.error());
    if (cv::norm(*moved) > most_moved_px)
      return fail(ErrorCode::calibration,
                  fmt::format("the plate has moved by {:.2f} pixels since it was located: only the bar may move",
                              cv::norm(*moved)));
    return std::move(picture->kelvin);
  }

  /// Counts clipped samples in the windows of the triangles. Grey levels 0 and full scale are ordinary levels and do
  /// not count.
  [[nodiscard]] int clipped_samples(const Frame& frame) const {
    int count = 0;
    for (const auto& [mm, size] : sizes_) {
      for (const cv::Rect& window : size.windows) {
        count += cut_off_samples(frame, window);
        if (measuring_.contrast_unit == ContrastUnit::kelvin) count += step_.saturated_pixels(frame, window);
      }
    }
    return count;
  }

  /// Out, in, in, out.
  Result<void> one_cycle(std::map<double, std::vector<double>>& ln_ratios) {
    std::map<double, double> out, in;
    for (const bool with_bar : {false, true}) {
      TODBENCH_TRY_VOID(move(with_bar));
      for (int twice = 0; twice < (with_bar ? 2 : 1); ++twice) {
        TODBENCH_TRY(auto picture, average());
        for (const auto& [mm, size] : sizes_) (with_bar ? in : out)[mm] += response_of(size, picture);
        if (with_bar) in_ = std::move(picture);
      }
    }
    TODBENCH_TRY_VOID(move(false));
    TODBENCH_TRY(auto picture, average());
    for (const auto& [mm, size] : sizes_) {
      out[mm] += response_of(size, picture);
      if (!(in[mm] > 0 && out[mm] > 0))
        return fail(ErrorCode::calibration,
                    fmt::format("triangles of {:g} mm are not visible in {} frames", mm, 2 * options_.frames));
      ln_ratios[mm].push_back(std::log(in[mm] / out[mm]));
    }
    out_ = std::move(picture);
    return {};
  }

  [[nodiscard]] SceneDependence concluded(const std::map<double, std::vector<double>>& ln_ratios) const {
    SceneDependence result;
    result.plate = state_.plate;
    result.set_delta_t_k = state_.delta_t_k;
    result.cycles = options_.cycles;
    result.tolerance_percent = options_.tolerance_percent;
    result.notes = notes_;
    result.set_up = {state_.plate, state_.mounting, registration_};
    result.out = out_, result.in = in_;
    result.temporal_noise_k = noise_k_;
    result.frames_used = taker_.used(), result.frames_lost = taker_.lost();
    result.frames_rejected = taker_.rejected();
    const double n = options_.cycles;
    const double t = distribution::quantile(distribution::StudentsT(n - 1),
                                            1 - 0.025 / static_cast<double>(std::max<std::size_t>(1, sizes_.size())));
    const double tolerance = std::log1p(options_.tolerance_percent / 100);
    bool all_within = true, one_beyond = false;
    for (const auto& [mm, size] : sizes_) {
      double mean = 0, squares = 0;
      for (const double value : ln_ratios.at(mm)) mean += value / n;
      for (const double value : ln_ratios.at(mm)) squares += std::pow(value - mean, 2);
      const double half = t * std::sqrt(squares / (n - 1) / n);
      SizeDependence found{.size_mm = mm,
                           .size_px = size.size_px,
                           .triangles = static_cast<int>(size.windows.size()),
                           .ratio = std::exp(mean),
                           .ci95 = {}};
      found.ci95.low = std::exp(mean - half);
      found.ci95.high = std::exp(mean + half);
      all_within = all_within && std::abs(mean) + half <= tolerance;
      one_beyond = one_beyond || std::abs(mean) - half > tolerance;
      result.sizes.push_back(found);
    }
    if (one_beyond)
      result.verdict = SceneDependenceVerdict::depends;
    else if (all_within)
      result.verdict = SceneDependenceVerdict::independent;
    if (clipped_ > 0) {
      result.verdict = SceneDependenceVerdict::inconclusive;
      result.notes.push_back(fmt::format(
          "{} samples of the triangles were clipped at an end of the counts, so the response to the scene is unknown",
          clipped_));
    }
    return result;
  }

  MeasurementOptions measuring_;
  SceneDependenceOptions options_;
  Target& target_;
  BarTarget bar_;
  TargetState state_;
  RunController& host_;
  std::stop_token stop_;
  FrameTaker taker_;
  SetUpStep step_;
  TargetPlate plate_;  ///< mounted
  Registration registration_;
  PresentedTarget presented_;
  std::map<double, SizeWindows, std::greater<>> sizes_;
  std::vector<std::string> notes_;
  cv::Mat1d out_, in_;
  double noise_k_ = 0;
  int clipped_ = 0;
};

class BarSource final : public ForwardingSource {
 public:
  BarSource(std::unique_ptr<FrameSource> camera, cv::Rect bar, double kelvin, std::shared_ptr<const bool> in)
      : ForwardingSource(std::move(camera)), bar_(bar), kelvin_(kelvin), in_(std::move(in)) {}

  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    auto frame = ForwardingSource::next(timeout);
    if (!frame || frame->status != FrameStatus::complete) return frame;
    // A simulated camera makes no corrections; an appearing bar looks like a shutter.
    if (frame->correction == CorrectionState::unknown) frame->correction = CorrectionState::idle;
    const LinearScale* line = frame->scale->straight_line();
    if (!*in_ || line == nullptr) return frame;
    frame->counts = frame->counts.clone();
    const int more = static_cast<int>(std::lround(kelvin_ / line->kelvin_per_count));
    const int full_scale = (1 << frame->significant_bits) - 1;
    for (int y = bar_.y; y < bar_.y + bar_.height; ++y) {
      for (int x = bar_.x; x < bar_.x + bar_.width; ++x) {
        std::uint16_t& count = frame->counts(y, x);
        count = static_cast<std::uint16_t>(std::clamp(int{count} + more, 0, full_scale));
      }
    }
    return frame;
  }

 private:
  cv::Rect bar_;
  double kelvin_;
  std::shared_ptr<const bool> in_;
};

/// Returns the first state of the plan at its largest contrast.
TargetState state_of(const Plan& plan, const std::vector<TargetPlate>& plates) {
  TargetState state{.plate = plates.front().name, .mounting = plan.target.mountings.front()};
  for (const double delta_t_k : plan.target.delta_t_k) {
    if (std::abs(delta_t_k) > std::abs(state.delta_t_k)) state.delta_t_k = delta_t_k;
  }
  return state;
}

MoveBar moved_by_operator(const ExperimentHost& host) {
  return [ask = host.ask_operator ? host.ask_operator : ask_at_terminal(), last = std::optional<bool>()](
             bool in, std::stop_token stop) mutable -> Result<void> {
    if (last == in) return {};
    const auto answer = ask(OperatorRequest{{MoveHotBar{in}}}, stop);
    if (!answer) return fail("asking the operator", answer.error());
    if (*answer == OperatorAnswer::stop) return fail(ErrorCode::interrupted, "stopped by the operator");
    last = in;
    return {};
  };
}

/// The simulated sensor of the plan with a bar, and a package behind it.
struct SimulatedBar {
  OpenedBench bench;
  MoveBar move;
  int memory = 0;
};

Result<SimulatedBar> simulated_bar(const LoadedPlan& loaded, const EnhancementPackage* package, double bar_k) {
  const Plan& plan = loaded.plan();
  const SensorSpec& sensor = loaded.sensor();
  TODBENCH_TRY(const auto accuracy, accuracy_of(plan));
  TODBENCH_TRY_VOID(check_sensor_module(sensor));
  const auto model = std::make_shared<const SensorModel>(
      sensor, full_plan(sensor, plan.simulation.skip, plan.simulation.force), accuracy, plan.seed);
  SimulatedBar out;
  out.bench = simulated_bench(model, loaded.plates(), plan.target.distance_m, {});
  const SourceInfo info = out.bench.camera->info();
  if (info.scale.straight_line() == nullptr)
    return fail(ErrorCode::invalid_input, "a hot bar needs a simulated sensor whose counts are linear in temperature");
  const double scale = sensor.samples_per_pitch() / (plan.target.distance_m * sensor.ifov_mrad());
  const auto place = place_of_bar({info.width, info.height}, loaded.plates().front(), scale);
  if (!place) return fail(ErrorCode::invalid_input, "the picture has not enough room for a hot bar beside the plate");
  const auto in = std::make_shared<bool>(false);
  out.bench.camera = with_hot_bar(std::move(out.bench.camera), *place, bar_k, in);
  out.move = [in](bool wanted, const std::stop_token&) -> Result<void> {
    *in = wanted;
    return {};
  };
  auto stages = module_stages(sensor.modules, {});
  if (package != nullptr) std::ranges::move(made_stages(*package, {}), std::back_inserter(stages));
  for (const auto& stage : stages) out.memory += stage->memory_frames();
  if (const ModulePlan* module = sensor_module(sensor)) out.memory += module->settle_frames;
  constexpr std::size_t no_picture = std::numeric_limits<std::size_t>::max();
  out.bench.camera = processed_source(std::move(out.bench.camera), std::move(stages), ProcessedAs::counts, no_picture,
                                      std::make_shared<ProcessingRecord>());
  return out;
}

}  // namespace

std::string_view to_string(SceneDependenceVerdict verdict) {
  switch (verdict) {
    case SceneDependenceVerdict::independent:
      return "independent";
    case SceneDependenceVerdict::depends:
      return "depends";
    case SceneDependenceVerdict::inconclusive:
      break;
  }
  return "inconclusive";
}

Result<SceneDependence> measure_scene_dependence(FrameSource& camera, Target& target, const MoveBar& move_bar,
                                                 const TargetState& state, Observer& observer,
                                                 const MeasurementOptions& measuring,
                                                 const SceneDependenceOptions& options, RunController& host,
                                                 std::stop_token stop) {
  if (options.cycles < 3 || options.frames < 1 || options.settle_frames < 0 || !(options.tolerance_percent > 0))
    return fail(ErrorCode::invalid_input, "at least three cycles, one frame and a tolerance above 0 are needed");
  TODBENCH_TRY_VOID(check_before_measuring(measuring, observer, camera.info()));
  if (options.on_begin) {
    TODBENCH_TRY_VOID(options.on_begin(camera.info(), target));
  }
  const std::stop_callback wake(stop, [&camera] { camera.stop(); });
  TODBENCH_TRY_VOID(camera.start());
  auto found = BarRun(camera, target, move_bar, state, measuring, options, host, stop)();
  camera.stop();
  if (!found && stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
  if (found) found->camera = camera.info().id;
  return found;
}

std::unique_ptr<FrameSource> with_hot_bar(std::unique_ptr<FrameSource> camera, cv::Rect bar, double kelvin,
                                          std::shared_ptr<const bool> in) {
  return std::make_unique<BarSource>(std::move(camera), bar, kelvin, std::move(in));
}

std::optional<cv::Rect> place_of_bar(cv::Size picture, const TargetPlate& plate, double px_per_mm) {
  const double beside = (picture.width - std::max(plate.width_mm, plate.height_mm) * px_per_mm) / 2;
  const int width = std::max(4, picture.width / 20);
  if (beside < width + 8) return std::nullopt;
  return cv::Rect(2, picture.height / 5, width, 3 * picture.height / 5);
}

Result<SceneDependence> plan_scene_dependence(const LoadedPlan& loaded, const EnhancementPackage* package, double bar_k,
                                              const SceneDependenceOptions& options, const ExperimentHost& host,
                                              std::stop_token stop) {
  const Plan& plan = loaded.plan();
  if (package != nullptr) {
    TODBENCH_TRY_VOID(refuse_finer_pictures(*package, "the response to a bar"));
  }
  TemplateObserver observer(loaded.observer(), triangle_alternatives());
  const TargetState state = state_of(plan, loaded.plates());
  if (!plan.camera.id.empty()) {
    if (package != nullptr)
      return fail(ErrorCode::invalid_input, "a package can only be used with a simulated sensor, not with a camera");
    TODBENCH_TRY(auto bench, open_bench(loaded, stop, host));
    MeasurementOptions measuring = camera_options(plan, loaded.plates());
    measuring.integrity.reject_frozen = measuring.integrity.reject_frozen && !bench.simulated;
    return measure_scene_dependence(*bench.camera, *bench.target, moved_by_operator(host), state, observer, measuring,
                                    options, *bench.host, stop);
  }
  TODBENCH_TRY(auto simulated, simulated_bar(loaded, package, bar_k));
  const SensorSpec& sensor = loaded.sensor();
  MeasurementOptions measuring =
      measurement_options(plan, loaded.plates(), sensor.ifov_mrad() / sensor.samples_per_pitch());
  measuring.samples_per_pitch = sensor.samples_per_pitch();
  measuring.frames_after_change = 0;
  measuring.integrity.reject_frozen = false;
  measuring.integrity.max_saturated_share = 1;  // because of the bar
  // Counts are not temperatures behind a gain control.
  if (package != nullptr || !sensor.modules.empty()) measuring.contrast_unit = ContrastUnit::grey_levels;
  SceneDependenceOptions settled = options;
  settled.settle_frames += simulated.memory;
  auto found = measure_scene_dependence(*simulated.bench.camera, *simulated.bench.target, simulated.move, state,
                                        observer, measuring, settled, *simulated.bench.host, stop);
  if (!found) return found;
  found->camera = sensor.name;
  if (package != nullptr) found->package = package->name;
  return found;
}

}  // namespace todbench
