// SPDX-License-Identifier: GPL-3.0-or-later
// Stages of the chain after the sensor, from picture to picture: common enhancements, and programs of the user.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string_view>

#include "acquisition/base/result.h"
#include "sim_devices/module/module_process.h"

namespace todbench {

/// Stage that processes pictures in the order of their exposure. Its output may depend on earlier pictures. One thread
/// at a time.
class ChainStage {
 public:
  virtual ~ChainStage() = default;
  ChainStage() = default;
  ChainStage(const ChainStage&) = delete;
  ChainStage& operator=(const ChainStage&) = delete;
  /// Returns the processed picture, with samples_per_pixel() times the size of `picture` and finite numbers. Errors:
  /// those of ModuleProcess; built-in stages have no errors.
  [[nodiscard]] virtual Result<cv::Mat1f> process(const cv::Mat1f& picture) = 0;
  /// Returns the number of pictures after which an earlier scene contributes less than 0.1 %.
  [[nodiscard]] virtual int memory_frames() const { return 0; }
  /// Returns the number of output samples per input sample along each axis.
  [[nodiscard]] virtual int samples_per_pixel() const { return 1; }
  /// Returns the position of sample (0, 0) of the last result, in samples of the picture.
  [[nodiscard]] virtual cv::Point2d first_px() const { return {0, 0}; }
  /// Returns the displacement that the stage assumes for the last picture, in samples of this picture; empty if the
  /// stage assumes no displacement.
  [[nodiscard]] virtual std::optional<cv::Point2d> believed_px() const { return {}; }
};

/// Returns the recursive filter y_n = share x_n + (1 - share) y_(n-1) over pictures x_n, with y_0 = x_0. The variance
/// of white noise is reduced by the factor share / (2 - share). Precondition: 0 < share <= 1.
[[nodiscard]] std::unique_ptr<ChainStage> recursive_filter(double share);
/// Returns the filter x + amount (x - mean of the 3 x 3 neighbourhood of x), x: value of a pixel, with edges repeated.
/// An amount of 0 does not change the picture.
[[nodiscard]] std::unique_ptr<ChainStage> sharpening(double amount);
/// Returns the sum over the 3 x 3 neighbourhood, weighted by the kernel (rows first), with edges repeated.
[[nodiscard]] std::unique_ptr<ChainStage> kernel_filter(const std::array<double, 9>& kernel);
/// Returns a gain control with 8-bit output: histogram equalisation over the whole picture, one class per count. At
/// most `plateau_counts` pixels of a class are counted (0: no limit). The result is the grey level floor(255 c + 1/2),
/// 0 to 255, where c is the share of the limited histogram in classes up to and including the count.
[[nodiscard]] std::unique_ptr<ChainStage> gain_control(int plateau_counts);
/// Returns the median over size x size pixels. Precondition: size is 3 or 5.
[[nodiscard]] std::unique_ptr<ChainStage> median_filter(int size);
/// Returns a contrast limited adaptive equalisation (Zuiderveld 1994, implementation of OpenCV) in tiles x tiles
/// fields. The result spans the range of values of the input picture.
[[nodiscard]] std::unique_ptr<ChainStage> clahe(double clip_limit, int tiles);
/// Returns an equalisation by the whole histogram, with 1024 classes over the range of the picture. At most
/// `plateau_percent` of the pixels are counted in a class (Vickers 1996). The result spans the range of the picture.
[[nodiscard]] std::unique_ptr<ChainStage> plateau_equalisation(double plateau_percent);

/// Options of a module as a stage.
struct ModuleStageOptions {
  ModuleOptions process{};
  int restart_frames = 0;  ///< pictures after which a new process is started; 0: never
  int settle_frames = 0;   ///< pictures after which an earlier scene contributes less than 0.1 %: memory_frames()
  /// Receives every line that the program writes to standard error.
  std::function<void(std::string_view line)> on_error_line{};
};
/// Returns a program of the user as a stage. The program starts with the first picture.
[[nodiscard]] std::unique_ptr<ChainStage> module_stage(ModuleStageOptions options);

}  // namespace todbench
