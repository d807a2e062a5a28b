// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/response_measure.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>
#include <utility>
#include <vector>

#include "acquisition/base/median.h"
#include "acquisition/base/try.h"
#include "tod/presentation/target_failure.h"

namespace todbench {
namespace {

constexpr int frames_before = 8;
constexpr double changed_part = 0.7, still_part = 0.1;  // of the largest change
constexpr int least_pixels = 12;
constexpr double least_surround = 0.1;  // of the change of the target: a plate warms up by some percent
/// A reported correction arrives with the delays of the frames: a smaller difference is not a new correction.
constexpr double told_delay_s = 0.5;

/// Time by the camera's clock; for a camera without one, the number of frames at the stated rate.
double camera_s(const Frame& frame, double frame_rate_hz) {
  return frame.device_time_ns != 0 || frame_rate_hz <= 0 ? static_cast<double>(frame.device_time_ns) * 1e-9
                                                         : static_cast<double>(frame.sequence) / frame_rate_hz;
}

/// Weights whose sum over the field is the mean of the changing pixels minus the mean of the constant ones, or the mean
/// of the surround.
struct SignalWeights {
  cv::Mat1d weight;
  int bright = 0;
};

/// The surround is most of the picture, so its change is the median. The target changes most against it.
Result<SignalWeights> surround_weights(const cv::Mat1d& change) {
  const double surround = median(std::vector<double>(change.begin(), change.end()));
  double low = 0, high = 0;
  cv::minMaxLoc(change, &low, &high);
  const double target = std::max(high - surround, surround - low);
  if (!(std::abs(surround) > least_surround * target))
    return fail(ErrorCode::calibration,
                "the level round the target does not follow its contrast: the camera does not control its gain");
  SignalWeights out{cv::Mat1d::zeros(change.size()), 0};
  const auto is_surround = [&](double one) { return std::abs(one - surround) < least_surround * target; };
  out.bright = static_cast<int>(std::count_if(change.begin(), change.end(), is_surround));
  std::transform(change.begin(), change.end(), out.weight.begin(),
                 [&](double one) { return is_surround(one) ? 1.0 / out.bright : 0.0; });
  return out;
}

Result<SignalWeights> signal_weights(const cv::Mat1d& change) {
  double low = 0, high = 0;
  cv::minMaxLoc(change, &low, &high);
  const double largest = -low > high ? low : high;
  SignalWeights out{cv::Mat1d::zeros(change.size()), 0};
  int still = 0;
  const auto each = [&](const auto& with) {
    for (int j = 0; j < change.rows; ++j)
      for (int i = 0; i < change.cols; ++i) with(change(j, i) / largest, out.weight(j, i));
  };
  each([&](double part, double&) {
    out.bright += part > changed_part ? 1 : 0;
    still += std::abs(part) < still_part ? 1 : 0;
  });
  if (largest == 0 || out.bright < least_pixels)
    return fail(ErrorCode::calibration, "no part of the picture changes with the contrast of the target");
  each([&](double part, double& weight) {
    if (part > changed_part) weight = 1.0 / out.bright;
    if (std::abs(part) < still_part && still >= least_pixels) weight = -1.0 / still;
  });
  return out;
}

class ResponseRun {
 public:
  ResponseRun(FrameTaker& taker, Target& target, RunController& host, const cv::Rect& field,
              const ResponseOptions& options, double frame_rate_hz, std::stop_token stop)
      : taker_(taker),
        target_(target),
        host_(host),
        field_(field),
        options_(options),
        frame_rate_hz_(frame_rate_hz),
        stop_(std::move(stop)) {}

  Result<ResponseMeasure> operator()() {
    SteppingTarget* stepping = target_.stepping();
    if (stepping == nullptr && !options_.settling_s)
      return fail(ErrorCode::invalid_input,
                  "the settling time of the target is unknown: state [measures] response_settling_ms");
    ResponseMeasure measure{
        .delta_t_k = options_.delta_t_k, .settling_s = stepping != nullptr ? 0 : *options_.settling_s, .response = {}};
    TODBENCH_TRY_VOID(learn_pixels(measure));
    std::vector<StepSeries> series;
    for (int i = 0; i < options_.steps; ++i) {
      const bool rising = i % 2 == 0;
      TODBENCH_TRY(auto step, one_step(rising ? options_.delta_t_k : 0, stepping));
      step.rising = rising;
      if (corrected_)
        ++measure.dropped;
      else
        series.push_back(std::move(step));
    }
    measure.frame_s = frame_s(series);
    TODBENCH_TRY(measure.response,
                 step_response(series, {.frame_s = measure.frame_s, .settling_s = measure.settling_s}));
    return measure;
  }

 private:
  [[nodiscard]] TargetState at(double delta_t_k) const {
    return {.plate = options_.plate, .mounting = Mounting::identity, .delta_t_k = delta_t_k, .shift_mm = {0, 0}};
  }

  Result<cv::Mat1d> mean_at(double delta_t_k) {
    auto shown = present(at(delta_t_k), [](const Frame&) { return Result<void>(); });
    if (!shown) return tl::unexpected(shown.error());
    TODBENCH_TRY(const auto there_ns, host_.now_ns(Moment::scene_changed));
    taker_.scene_changed(there_ns);
    // A gain that is controlled settles as long as it is followed after a step.
    for (int k = 0; options_.signal == StepSignal::surround && k < options_.frames; ++k) {
      TODBENCH_TRY_VOID(taker_.next_of_moving_scene(stop_));
    }
    TODBENCH_TRY(auto picture, taker_.average(options_.contrast_frames, stop_));
    return picture.kelvin(field_).clone();
  }

  Result<void> learn_pixels(ResponseMeasure& measure) {
    TODBENCH_TRY(const auto bright, mean_at(options_.delta_t_k));
    TODBENCH_TRY(const auto dark, mean_at(0));
    const cv::Mat1d change = bright - dark;
    TODBENCH_TRY(auto weights,
                 options_.signal == StepSignal::surround ? surround_weights(change) : signal_weights(change));
    // With a negative polarity, a step up of the contrast is a step down in the picture.
    weights_ = weights.weight * (change.dot(weights.weight) < 0 ? -1.0 : 1.0);
    measure.bright_pixels = weights.bright;
    measure.change = change.dot(weights.weight);
    return {};
  }

  /// Calls `with` for each good frame that arrives while the target changes.
  template <typename Function>
  Result<void> present(const TargetState& state, const Function& with) {
    if (host_.frames_while_presenting() != FramesWhilePresenting::take) {
      if (auto presented = target_.present(state, stop_); !presented)
        return target_failure("presenting the target", presented.error());
      return {};
    }
    Result<PresentedTarget> presented;
    Result<void> frames;
    std::atomic<bool> there = false;
    std::int64_t calls = 0;
    {
      std::stop_source give_up;
      const std::stop_callback stopped(stop_, [&give_up] { give_up.request_stop(); });
      const std::jthread taking([&] {
        while (!there && frames) {
          auto frame = taker_.next_of_moving_scene(stop_);
          ++calls;
          frames = frame ? with(*frame) : Result<void>(tl::unexpected(frame.error()));
        }
        if (!frames) give_up.request_stop();
      });
      presented = target_.present(state, give_up.get_token());
      there = true;
    }
    if (!frames) return frames;
    if (!presented) return target_failure("presenting the target", presented.error());
    TODBENCH_TRY_VOID(host_.asked_while_presenting(calls));
    return {};
  }

  Result<void> add(StepSeries& step, const Frame& frame) {
    TODBENCH_TRY(const auto kelvin, window_kelvin(frame, field_));
    const double since_s = taker_.since_nuc_s(frame);
    if (!step.time_s.empty() && since_s >= 0 && (last_since_s_ < 0 || since_s < last_since_s_ - told_delay_s))
      corrected_ = true;
    last_since_s_ = since_s;
    step.time_s.push_back(camera_s(frame, frame_rate_hz_));
    step.signal.push_back(kelvin.dot(weights_));
    return {};
  }

  Result<void> take(StepSeries& step, int frames) {
    for (int k = 0; k < frames; ++k) {
      TODBENCH_TRY(const auto frame, taker_.next_of_moving_scene(stop_));
      TODBENCH_TRY_VOID(add(step, frame));
    }
    return {};
  }

  Result<StepSeries> one_step(double delta_t_k, SteppingTarget* stepping) {
    StepSeries step;
    corrected_ = false;
    TODBENCH_TRY_VOID(take(step, frames_before));
    step.before = frames_before;
    Result<void> done;
    if (stepping != nullptr)
      done = stepping->step_to(delta_t_k, stop_);
    else
      done = present(at(delta_t_k), [&](const Frame& frame) { return add(step, frame); });
    if (!done) return tl::unexpected(done.error());
    TODBENCH_TRY_VOID(take(step, options_.frames));
    return step;
  }

  /// Median frame interval.
  static double frame_s(const std::vector<StepSeries>& series) {
    std::vector<double> apart;
    for (const StepSeries& step : series)
      for (std::size_t k = 1; k < step.time_s.size(); ++k) apart.push_back(step.time_s[k] - step.time_s[k - 1]);
    return apart.empty() ? 0 : median(std::move(apart));
  }

  FrameTaker& taker_;
  Target& target_;
  RunController& host_;
  const cv::Rect field_;
  const ResponseOptions& options_;
  const double frame_rate_hz_;
  std::stop_token stop_;
  cv::Mat1d weights_;
  bool corrected_ = false;
  double last_since_s_ = -1;
};

}  // namespace

Result<ResponseMeasure> measure_response(FrameTaker& taker, Target& target, RunController& host, const cv::Rect& field,
                                         const ResponseOptions& options, double frame_rate_hz,
                                         const std::stop_token& stop) {
  return ResponseRun(taker, target, host, field, options, frame_rate_hz, stop)();
}

}  // namespace todbench
