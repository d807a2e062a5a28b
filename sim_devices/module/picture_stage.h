// Stages of the chain behind the sensor, picture to picture: the usual enhancements, and programs of the user's.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <string_view>

#include "acquisition/core/result.h"
#include "sim_devices/module/module_process.h"

namespace todbench {

/// Takes pictures in the order of their exposure; may remember. One thread at a time.
class ChainStage {
 public:
  virtual ~ChainStage() = default;
  ChainStage() = default;
  ChainStage(const ChainStage&) = delete;
  ChainStage& operator=(const ChainStage&) = delete;
  /// The answer has samples_per_pixel() times the size of the picture and finite numbers. Errors: those of
  /// ModuleProcess; none of the built-in stages.
  [[nodiscard]] virtual Result<cv::Mat1f> process(const cv::Mat1f& picture) = 0;
  /// Pictures after which less than 0.1 % is left of what was seen before.
  [[nodiscard]] virtual int memory_frames() const { return 0; }
  /// Samples of an answer along each axis for a sample of the picture.
  [[nodiscard]] virtual int samples_per_pixel() const { return 1; }
  /// Where sample (0, 0) of the last answer is, in samples of the picture.
  [[nodiscard]] virtual cv::Point2d first_px() const { return {0, 0}; }
};

/// y_n = share x_n + (1 - share) y_(n-1), the first picture as it is; white noise is left with the variance share / (2
/// - share). Precondition: 0 < share <= 1.
[[nodiscard]] std::unique_ptr<ChainStage> recursive_filter(double share);
/// x + amount (x - mean of the 3 x 3 neighbourhood), the edge repeated. 0: the picture as it is.
[[nodiscard]] std::unique_ptr<ChainStage> sharpening(double amount);
/// The sum over the 3 x 3 neighbourhood, each neighbour times its number of the kernel (rows first), the edge repeated.
[[nodiscard]] std::unique_ptr<ChainStage> kernel_filter(const std::array<double, 9>& kernel);
/// Gain control to 8 bits: equalisation by the whole histogram with a class for every count, none of which counts for
/// more than `plateau_counts` pixels (0: no limit). The answer is floor(255 c + 1/2), c the share of the clipped
/// histogram up to the count itself: grey levels 0 to 255 in place of counts.
[[nodiscard]] std::unique_ptr<ChainStage> gain_control(int plateau_counts);
/// Median over 3 x 3 or 5 x 5. Precondition: size is 3 or 5.
[[nodiscard]] std::unique_ptr<ChainStage> median_filter(int size);
/// Contrast limited adaptive equalisation (Zuiderveld 1994, as OpenCV has it) in tiles x tiles fields; the answer spans
/// the range of the picture.
[[nodiscard]] std::unique_ptr<ChainStage> clahe(double clip_limit, int tiles);
/// Equalisation by the whole histogram, 1024 classes over the range of the picture, none of which counts for more than
/// `plateau_percent` of the pixels (Vickers 1996); the answer spans the range of the picture.
[[nodiscard]] std::unique_ptr<ChainStage> plateau_equalisation(double plateau_percent);

struct ModuleStageOptions {
  ModuleOptions process{};
  int restart_frames = 0;  ///< a new process after so many pictures; 0: never
  int settle_frames = 0;   ///< its memory_frames()
  /// Every line that the program writes to standard error.
  std::function<void(std::string_view line)> on_error_line{};
};
/// A program of the user's, started with the first picture.
[[nodiscard]] std::unique_ptr<ChainStage> module_stage(ModuleStageOptions options);

}  // namespace todbench
