// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/judged_contrast.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "acquisition/base/distributions.h"
#include "acquisition/base/mean.h"
#include "acquisition/base/try.h"
#include "acquisition/core/judged_picture.h"

namespace todbench {
namespace {

/// Least contrast of the judged triangles, and of one frame of them, in standard errors.
constexpr double least_gain_certainty = 3;
/// A picture of one level has a contrast of the size of rounding errors in double precision.
constexpr double least_contrast_counts = 1e-6;
/// Probability of taking a constant gain for a changing one. A run has up to a hundred set-ups and contrasts: 1 % of
/// runs. The only consequence is that the noise of each frame's own contrast enters the answers.
constexpr double false_alarm = 1e-4;
/// A gain that changes by less moves an acuity by less than 0.3 %.
constexpr double least_change = 0.01;

double mean_of_rows(const std::vector<std::vector<double>>& rows) {
  double sum = 0;
  for (const auto& row : rows) sum += arithmetic_mean(row);
  return sum / static_cast<double>(rows.size());
}

/// Two-way analysis of variance of the judged contrasts minus those by the gain: frames against triangles.
struct Residuals {
  double of_frames = 0, left = 0;  ///< mean squares
  double frame_freedom = 0, left_freedom = 0;
  double gain_error = 0;  ///< standard error of the judged contrast, from the scatter over triangles
};

Residuals residuals(const std::vector<std::vector<double>>& camera, const std::vector<std::vector<double>>& judged,
                    double gain) {
  const std::size_t frames = judged.size(), triangles = judged.front().size();
  std::vector<double> by_frame(frames), by_triangle(triangles);
  double all = 0;
  const auto at = [&](std::size_t k, std::size_t i) { return judged[k][i] - gain * camera[k][i]; };
  for (std::size_t k = 0; k < frames; ++k) {
    for (std::size_t i = 0; i < triangles; ++i) {
      by_frame[k] += at(k, i) / static_cast<double>(triangles);
      by_triangle[i] += at(k, i) / static_cast<double>(frames);
      all += at(k, i) / static_cast<double>(frames * triangles);
    }
  }
  Residuals out{.frame_freedom = static_cast<double>(frames) - 1};
  out.left_freedom = out.frame_freedom * (static_cast<double>(triangles) - 1);
  double scatter = 0;
  for (const double value : by_triangle) scatter += (value - all) * (value - all);
  if (triangles > 1)
    out.gain_error = std::sqrt(scatter / static_cast<double>(triangles - 1) / static_cast<double>(triangles));
  for (std::size_t k = 0; k < frames; ++k) {
    out.of_frames += static_cast<double>(triangles) * (by_frame[k] - all) * (by_frame[k] - all);
    for (std::size_t i = 0; i < triangles; ++i) out.left += std::pow(at(k, i) - by_frame[k] - by_triangle[i] + all, 2);
  }
  if (out.frame_freedom > 0) out.of_frames /= out.frame_freedom;
  if (out.left_freedom > 0) out.left /= out.left_freedom;
  return out;
}

bool gain_changes(const Residuals& found, std::size_t triangles, double level) {
  if (found.frame_freedom < 1 || found.left_freedom < 1) return false;
  const double sd = std::sqrt(std::max(0.0, found.of_frames - found.left) / static_cast<double>(triangles));
  if (sd < least_change * std::abs(level)) return false;
  const distribution::FisherF law(found.frame_freedom, found.left_freedom);
  return found.of_frames > found.left * distribution::quantile(distribution::complement(law, false_alarm));
}

bool has_picture(const Frame& frame) {
  return behind_stages(frame) && !frame.judged->none;
}

/// Every n-th sample of a judged picture with n samples a pixel.
Frame at_pixels(const Frame& frame) {
  const int finer = judged_samples_per_pixel(frame);
  Frame out = as_judged(frame);
  if (finer == 1) return out;
  cv::Mat1w counts(out.counts.rows / finer, out.counts.cols / finer);
  for (int row = 0; row < counts.rows; ++row) {
    for (int column = 0; column < counts.cols; ++column) counts(row, column) = out.counts(row * finer, column * finer);
  }
  out.counts = counts;
  return out;
}

Result<EffectiveContrast> levels_of(const Frame& frame, const TargetPlate& plate, const Registration& registration,
                                    double min_size_px) {
  TODBENCH_TRY(const auto kelvin, to_kelvin(frame));
  return effective_contrast(kelvin, plate, registration, min_size_px, LevelEstimate::mean);
}

}  // namespace

bool behind_stages(const Frame& frame) {
  return frame.judged != nullptr && frame.judged->counts.data != frame.counts.data;
}

Result<EffectiveContrast> judged_levels(const Frame& frame, const TargetPlate& mounted_plate,
                                        const Registration& registration, double min_size_px) {
  return levels_of(at_pixels(frame), mounted_plate, registration.moved(-frame.judged->first_px), min_size_px);
}

void JudgedMemory::add(const Frame& frame) {
  if (!has_picture(frame) || judged_samples_per_pixel(frame) > 1) return;
  const auto camera = to_kelvin(frame), judged = to_kelvin(as_judged(frame));
  if (!camera || !judged) return;  // reported when the contrast is measured
  camera_.add(frame.sequence, *camera);
  judged_.add(frame.sequence, *judged);
}

double JudgedMemory::ratio() const {
  return judged_.memory() / camera_.memory();
}

void JudgedFrames::add(const Frame& frame) {
  if (error_ || !has_picture(frame)) return;
  if (auto taken = take(frame); !taken) error_ = taken.error();
}

Result<void> JudgedFrames::take(const Frame& frame) {
  const auto of_camera = levels_of(frame, plate_, registration_, min_size_px_);
  const auto behind = judged_levels(frame, plate_, registration_, min_size_px_);
  if (!of_camera) return tl::unexpected(of_camera.error());
  if (!behind) return fail("behind the stages", behind.error());
  const auto values = [](const EffectiveContrast& contrast) {
    std::vector<double> out;
    for (const ReferenceTriangle& reference : contrast.references) out.push_back(reference.value);
    return out;
  };
  camera_.push_back(values(*of_camera));
  judged_.push_back(values(*behind));
  samples_per_pixel_ = judged_samples_per_pixel(frame);
  kelvin_per_count_ = std::abs(frame.scale->kelvin_per_count(frame.counts(0, 0)).value_or(1));
  if (samples_per_pixel_ > 1) return {};
  const auto kelvin = to_kelvin(frame), judged_kelvin = to_kelvin(as_judged(frame));
  if (!kelvin) return tl::unexpected(kelvin.error());
  if (!judged_kelvin) return tl::unexpected(judged_kelvin.error());
  camera_noise_.add(frame.sequence, *kelvin);
  judged_noise_.add(frame.sequence, *judged_kelvin);
  const cv::Mat1w& counts = frame.judged->counts;
  lowest_ = lowest_.empty() ? counts.clone() : cv::Mat1w(cv::min(lowest_, counts));
  highest_ = highest_.empty() ? counts.clone() : cv::Mat1w(cv::max(highest_, counts));
  kelvin_sum_ = kelvin_sum_.empty() ? judged_kelvin->clone() : cv::Mat1d(kelvin_sum_ + *judged_kelvin);
  first_px_ = frame.judged->first_px;
  significant_bits_ = frame.significant_bits;
  return {};
}

std::optional<JudgedFrames::Average> JudgedFrames::average() const {
  if (lowest_.empty()) return std::nullopt;
  AveragedPicture picture{.kelvin = kelvin_sum_ / static_cast<double>(judged_.size()),
                          .lowest = lowest_,
                          .highest = highest_,
                          .significant_bits = significant_bits_,
                          .temporal_noise_k = std::sqrt(judged_noise_.successive_variance()),
                          .lag1_correlation = {},
                          .row_variance_k2 = {},
                          .column_variance_k2 = {}};
  return Average{std::move(picture), registration_.moved(-first_px_)};
}

Result<std::optional<JudgedScale>> JudgedFrames::scale(double memory_ratio) const {
  if (error_) return tl::unexpected(*error_);
  if (judged_.empty()) return std::optional<JudgedScale>();
  JudgedScale out{.camera_level = mean_of_rows(camera_)};
  const double level = mean_of_rows(judged_);
  out.gain = level / out.camera_level;
  if (!std::isfinite(out.gain))
    return fail(ErrorCode::calibration, "the large triangles have no contrast in the camera's frames");
  const Residuals found = residuals(camera_, judged_, out.gain);
  out.gain_error = found.gain_error / std::abs(out.camera_level);
  if (std::abs(level) < least_contrast_counts * kelvin_per_count_ ||
      std::abs(level) < least_gain_certainty * found.gain_error)
    return fail(ErrorCode::not_identifiable,
                fmt::format("behind the stages the large triangles differ from their surround by {:+.3g} +- {:.2g}, in "
                            "the camera's frames by {:+.3g}: their contrast is too small to measure",
                            level, found.gain_error, out.camera_level));
  out.changes = gain_changes(found, judged_.front().size(), level);
  if (samples_per_pixel_ > 1) {
    out.noise_ratio = std::abs(out.gain);  // the noise passed to the observer stays that of a frame of the camera
    return std::optional(out);
  }
  const double of_camera = camera_noise_.successive_variance(), behind = judged_noise_.successive_variance();
  out.noise_ratio = of_camera > 0 ? std::sqrt(behind / of_camera * memory_ratio) : std::abs(out.gain);
  out.steps = grey_steps(lowest_, highest_, std::sqrt(behind) / kelvin_per_count_);
  return std::optional(out);
}

Result<double> judged_gain(const Frame& frame, const TargetPlate& mounted_plate, const Registration& registration,
                           double min_size_px, const JudgedScale& scale) {
  const auto found = judged_levels(frame, mounted_plate, registration, min_size_px);
  if (!found) return fail("behind the stages", found.error());
  if (!(std::abs(found->value) > least_gain_certainty * found->standard_error))
    return fail(ErrorCode::not_identifiable,
                fmt::format("behind the stages the large triangles of frame {} differ from their surround by {:+.3g} "
                            "+- {:.2g}: their contrast is too small to measure",
                            frame.sequence, found->value, found->standard_error));
  return found->value / scale.camera_level;
}

int cut_off_samples(const Frame& frame, const cv::Rect& window) {
  if (frame.judged == nullptr || frame.judged->cut_off.empty()) return 0;
  return cv::countNonZero(frame.judged->cut_off(window));
}

}  // namespace todbench
