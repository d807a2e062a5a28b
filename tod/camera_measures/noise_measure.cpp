// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/noise_measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "acquisition/base/try.h"
#include "acquisition/core/count_step.h"
#include "tod/camera_measures/pixel_measure.h"
#include "tod/measures/shading.h"

namespace todbench {
namespace {

constexpr int attempts = 3;  // to take a series without a correction in it

/// Standard deviation in time of each pixel, without changes of whole frames.
class PixelSquares {
 public:
  void add(const cv::Mat1d& frame) {
    cv::Mat1d change = frame.clone();
    if (first_.empty()) first_ = frame.clone(), sum_ = cv::Mat1d::zeros(frame.size()), squares_ = sum_.clone();
    change -= first_;
    change -= cv::mean(change)[0];
    sum_ += change;
    squares_ += change.mul(change);
    ++frames_;
  }
  /// Precondition: at least two frames.
  [[nodiscard]] cv::Mat1d sd() const {
    cv::Mat1d variance = (squares_ - sum_.mul(sum_) / frames_) / (frames_ - 1.0), root;
    cv::sqrt(cv::max(variance, 0.0), root);
    return root;
  }

 private:
  int frames_ = 0;
  cv::Mat1d first_, sum_, squares_;
};

struct Series {
  NoiseCube cube;
  PixelSquares squares;
  CountStep step;
  NoiseSeries out;
};

Result<void> add_frame(Series& series, const Frame& frame, const NoiseOptions& options) {
  TODBENCH_TRY(const cv::Mat1d kelvin, window_kelvin(frame, options.field));
  TODBENCH_TRY_VOID(series.cube.add(kelvin));
  series.squares.add(kelvin);
  series.step.add(frame.counts);
  if (!options.pixel_window || series.out.pixel_frames.size() >= most_pixel_frames) return {};
  TODBENCH_TRY(const cv::Mat1d window, window_kelvin(frame, *options.pixel_window));
  cv::Mat1f single;
  window.convertTo(single, CV_32F);
  series.out.pixel_frames.push_back(std::move(single));
  return {};
}

/// Empty if a correction occurred.
Result<std::optional<Series>> take_series(FrameTaker& taker, const NoiseOptions& options, const std::stop_token& stop) {
  Series series;
  double last_s = -1;
  for (int k = 0; k < options.frames; ++k) {
    TODBENCH_TRY(const auto frame, taker.next(stop));
    const double since_s = taker.since_nuc_s(frame);
    if (k > 0 && since_s >= 0 && (last_s < 0 || since_s < last_s)) return std::nullopt;
    last_s = since_s;
    TODBENCH_TRY_VOID(add_frame(series, frame, options));
    NoiseMeasure& noise = series.out.noise;
    if (k == 0) noise.first_frame = frame.sequence;
    noise.last_frame = frame.sequence;
    if (since_s >= 0) noise.since_correction_s = since_s;
  }
  return series;
}

Result<void> sum_up(Series& series, const RadiometricScale& scale) {
  NoiseMeasure& noise = series.out.noise;
  const cv::Mat1d mean = series.cube.mean_frame();
  const Shading shading = shading_of(mean);
  TODBENCH_TRY(noise.table, series.cube.table_without(shading.surface));
  noise.table.pixel_memory = series.cube.pixel_memory();
  noise.frames = noise.table.frames, noise.rows = noise.table.rows, noise.columns = noise.table.columns;
  noise.mean_k = cv::mean(mean)[0];
  noise.shading_range_k = shading.range, noise.shading_sd_k = shading.sd;
  noise.lag1_correlation = series.cube.lag1_correlation();
  noise.pixel_sd_k = series.squares.sd();
  noise.pattern_k = mean - noise.mean_k - shading.surface;
  if (const auto per_count = kelvin_per_count_at(scale, noise.mean_k)) {
    series.out.kelvin_per_step = *per_count * series.step.counts_per_step();
    noise.noise_counts =
        std::sqrt(std::max(0.0, temporal_variance(noise.table).variance)) / *series.out.kelvin_per_step;
  }
  return {};
}

}  // namespace

std::optional<double> kelvin_per_count_at(const RadiometricScale& scale, double at_k) {
  const auto counts = scale.counts(at_k);
  const auto kelvin = counts ? scale.kelvin_per_count(*counts) : std::nullopt;
  return kelvin && *kelvin > 0 ? kelvin : std::nullopt;
}

Result<NoiseSeries> measure_series_noise(FrameTaker& taker, const RadiometricScale& scale, const NoiseOptions& options,
                                         const std::stop_token& stop) {
  std::optional<Series> series;
  for (int attempt = 0; attempt < attempts && !series; ++attempt) {
    TODBENCH_TRY(series, take_series(taker, options, stop));
  }
  if (!series)
    return fail(
        ErrorCode::integrity,
        "the camera corrects its non-uniformity so often that no uninterrupted series of frames could be recorded");
  if (const auto change = series->cube.abrupt_change())
    return fail(ErrorCode::integrity,
                fmt::format("the picture changed abruptly before frame {} of the series", *change + 1));
  if (series->cube.noise_changes())
    return fail(ErrorCode::integrity, "the noise of a pixel differs between the two halves of the series");
  if (const auto row = series->cube.row_outside_picture())
    return fail(
        ErrorCode::integrity,
        fmt::format("row {} of the measured field is no part of the picture, but telemetry or a defect", *row + 1));
  TODBENCH_TRY_VOID(sum_up(*series, scale));
  return std::move(series->out);
}

}  // namespace todbench
