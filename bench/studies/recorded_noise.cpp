// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <opencv2/imgproc.hpp>

#include "acquisition/base/rng.h"
#include "acquisition/base/try.h"
#include "bench/studies/real_noise_study.h"

namespace todbench {
namespace {

/// Adds each pixel minus its mean over the block, scaled to the variance of single frames.
void add_residuals(std::span<const cv::Mat1f> block, int index, RecordedNoise& noise) {
  cv::Mat1d mean(block[0].size(), 0.0);
  for (const auto& frame : block) cv::accumulate(frame, mean);
  mean /= static_cast<double>(block.size());
  const double scale = std::sqrt(static_cast<double>(block.size()) / static_cast<double>(block.size() - 1));
  // With two frames the second residual is the negative of the first and adds no information.
  const std::size_t count = block.size() == 2 ? 1 : block.size();
  for (std::size_t k = 0; k < count; ++k) {
    cv::Mat1d residual;
    block[k].convertTo(residual, CV_64F);
    cv::Mat1f scaled;
    cv::Mat1d((residual - mean) * scale).convertTo(scaled, CV_32F);
    noise.frames.push_back(scaled);
    noise.block_of_frame.push_back(index);
  }
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// A pixel counts as moving scene if its noise is above twice the median pixel's. A single residual frame has no noise
/// per pixel: then all pixels are used.
void find_usable(RecordedNoise& noise, const cv::Mat1b& usable) {
  cv::Mat1d squares(noise.frames[0].size(), 0.0);
  for (const auto& frame : noise.frames) cv::accumulateSquare(frame, squares);
  squares /= static_cast<double>(noise.frames.size());
  noise.usable = usable.empty() ? cv::Mat1b(squares.size(), 255) : usable;
  if (usable.empty() && noise.frames.size() > 4)
    noise.usable = squares <= 4 * median_of(std::vector<double>(squares.begin(), squares.end()));
  noise.usable_share = cv::countNonZero(noise.usable) / static_cast<double>(noise.usable.total());
  noise.temporal_noise = std::sqrt(cv::mean(squares, noise.usable)[0]);
}

void find_correlations(RecordedNoise& noise) {
  double xx = 0, yy = 0, own_x = 0, own_y = 0;
  for (const auto& frame : noise.frames) {
    const double mean = cv::mean(frame, noise.usable)[0];
    for (int y = 0; y < frame.rows; ++y) {
      for (int x = 0; x < frame.cols; ++x) {
        if (noise.usable(y, x) == 0) continue;
        const double value = static_cast<double>(frame(y, x)) - mean;
        if (x + 1 < frame.cols && noise.usable(y, x + 1) != 0)
          xx += value * (static_cast<double>(frame(y, x + 1)) - mean), own_x += value * value;
        if (y + 1 < frame.rows && noise.usable(y + 1, x) != 0)
          yy += value * (static_cast<double>(frame(y + 1, x)) - mean), own_y += value * value;
      }
    }
  }
  noise.correlation_x = own_x > 0 ? xx / own_x : 0;
  noise.correlation_y = own_y > 0 ? yy / own_y : 0;
}

/// Root of the mean of the blocks' variances, component by component.
Result<ThreeDNoise> mean_components(std::span<const cv::Mat1f> frames, int block_frames, int blocks) {
  ThreeDNoise sum;
  constexpr double ThreeDNoise::*parts[] = {&ThreeDNoise::tvh, &ThreeDNoise::tv, &ThreeDNoise::th, &ThreeDNoise::t,
                                            &ThreeDNoise::vh,  &ThreeDNoise::v,  &ThreeDNoise::h};
  for (int b = 0; b < blocks; ++b) {
    const auto one = three_d_noise(frames.subspan(static_cast<std::size_t>(b) * static_cast<std::size_t>(block_frames),
                                                  static_cast<std::size_t>(block_frames)));
    if (!one) return one;
    for (const auto part : parts) sum.*part += (*one).*part * ((*one).*part) / blocks;
  }
  for (const auto part : parts) sum.*part = std::sqrt(sum.*part);
  return sum;
}

/// Returns the frames with unusable pixels set to the mean of the others in the block.
std::vector<cv::Mat1f> usable_alone(std::span<const cv::Mat1f> frames, const RecordedNoise& noise, int block_frames) {
  std::vector<cv::Mat1f> held;
  const auto size = static_cast<std::size_t>(block_frames);
  const cv::Mat1b other = noise.usable == 0;
  for (std::size_t b = 0; b < static_cast<std::size_t>(noise.blocks); ++b) {
    double mean = 0;
    for (std::size_t k = 0; k < size; ++k) mean += cv::mean(frames[b * size + k], noise.usable)[0] / block_frames;
    for (std::size_t k = 0; k < size; ++k) {
      held.push_back(frames[b * size + k].clone());
      held.back().setTo(mean, other);
    }
  }
  return held;
}

/// Converts the components of the frames with unusable pixels held to those of the usable pixels alone, if these are
/// spread over the picture. With a share p, effects of rows, columns and frames shrink to p of themselves; p (1 - p) of
/// their variance appears as variance between pixels.
ThreeDNoise of_usable(ThreeDNoise held, double p) {
  const auto pixels = [&](double sum, std::initializer_list<double> effects) {
    double squares = sum * sum;
    for (const double effect : effects) squares -= p * (1 - p) * effect * effect;
    return std::sqrt(std::max(0.0, squares) / p);
  };
  for (double* effect : {&held.tv, &held.th, &held.t, &held.v, &held.h}) *effect /= p;
  held.tvh = pixels(held.tvh, {held.tv, held.th, held.t});
  held.vh = pixels(held.vh, {held.v, held.h});
  return held;
}

}  // namespace

Result<RecordedNoise> recorded_noise(std::span<const cv::Mat1f> frames, int block_frames, const cv::Mat1b& usable) {
  if (block_frames < 2 || frames.size() < static_cast<std::size_t>(block_frames)) {
    return fail(ErrorCode::invalid_input, "the recording has " + std::to_string(frames.size()) +
                                              " frames; a block needs " + std::to_string(std::max(2, block_frames)));
  }
  RecordedNoise noise;
  noise.blocks = static_cast<int>(frames.size()) / block_frames;
  for (int b = 0; b < noise.blocks; ++b) {
    const auto size = static_cast<std::size_t>(block_frames);
    add_residuals(frames.subspan(static_cast<std::size_t>(b) * size, size), b, noise);
  }
  find_usable(noise, usable);
  // Below a millionth of the level it is rounding of the mean.
  if (!(noise.temporal_noise > 1e-6 * cv::norm(frames[0], cv::NORM_INF)))
    return fail(ErrorCode::invalid_input, "the recording contains no noise: all frames are the same");
  find_correlations(noise);
  TODBENCH_TRY(auto components, mean_components(usable_alone(frames, noise, block_frames), block_frames, noise.blocks));
  noise.components = of_usable(components, noise.usable_share);
  return noise;
}

RecordedNoise white_like(const RecordedNoise& noise, std::uint64_t seed) {
  RecordedNoise white = noise;
  const RandomStream stream(seed, "real_noise.white");
  std::uint64_t index = 0;
  for (auto& frame : white.frames) {
    cv::Mat1f drawn(frame.size());
    stream.sub(index++).fill_normal(std::span(drawn.ptr<float>(), drawn.total()));
    // Needs a new matrix: assigning the expression would write into the pixels shared with `noise`.
    const cv::Mat1f scaled = drawn * noise.temporal_noise;
    frame = scaled;
  }
  white.components = {};
  white.components.tvh = noise.temporal_noise;
  white.correlation_x = white.correlation_y = 0;
  return white;
}

}  // namespace todbench
