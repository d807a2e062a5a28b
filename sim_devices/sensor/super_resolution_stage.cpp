// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/super_resolution_stage.h"

#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "tod/registration/super_resolution.h"

namespace todbench {
namespace {

class SuperResolutionStage final : public ChainStage {
 public:
  explicit SuperResolutionStage(const SuperResolutionStageOptions& options) : options_(options) {}

  [[nodiscard]] Result<cv::Mat1f> process(const cv::Mat1f& picture) override {
    frames_.push_back(picture.clone());
    if (std::ssize(frames_) > options_.frames) frames_.erase(frames_.begin());
    ++seen_;
    if (std::ssize(frames_) < options_.frames) return repeated(picture);
    auto shifts =
        options_.shifts == FrameShifts::scan ? Result<std::vector<cv::Point2d>>(scanned()) : frame_shifts(frames_);
    if (!shifts) return fail(ErrorCode::not_identifiable, "super-resolution: " + shifts.error().message);
    auto finer = super_resolve(frames_, *shifts, options_.factor);
    if (!finer) return fail(ErrorCode::not_identifiable, "super-resolution: " + finer.error().message);
    cv::Point2d mean(0, 0);
    for (const cv::Point2d& shift : *shifts) mean += shift / static_cast<double>(shifts->size());
    first_px_ = finer->first_px + mean;
    return std::move(finer->picture);
  }
  [[nodiscard]] int memory_frames() const override { return options_.frames - 1; }
  [[nodiscard]] int samples_per_pixel() const override { return options_.factor; }
  [[nodiscard]] cv::Point2d first_px() const override { return first_px_; }
  [[nodiscard]] std::optional<cv::Point2d> believed_px() const override {
    if (options_.shifts != FrameShifts::scan || seen_ == 0) return std::nullopt;
    return dither_px(options_.factor, seen_ - 1);
  }

 private:
  cv::Mat1f repeated(const cv::Mat1f& picture) {
    cv::Mat1f answer;
    cv::resize(picture, answer, picture.size() * options_.factor, 0, 0, cv::INTER_NEAREST);
    const double half = (options_.factor - 1) / (2.0 * options_.factor);
    first_px_ = {-half, -half};
    return answer;
  }
  /// Shifts of the frames against the first of them.
  [[nodiscard]] std::vector<cv::Point2d> scanned() const {
    const std::uint64_t first = seen_ - frames_.size();
    std::vector<cv::Point2d> shifts;
    for (std::uint64_t k = 0; k < frames_.size(); ++k)
      shifts.push_back(dither_px(options_.factor, first + k) - dither_px(options_.factor, first));
    return shifts;
  }

  SuperResolutionStageOptions options_;
  std::vector<cv::Mat1f> frames_;
  std::uint64_t seen_ = 0;
  cv::Point2d first_px_{0, 0};
};

}  // namespace

cv::Point2d dither_px(int n, std::uint64_t index) {
  const auto steps = static_cast<std::uint64_t>(n);
  return cv::Point2d(static_cast<double>(index % steps), static_cast<double>(index / steps % steps)) / n;
}

std::unique_ptr<ChainStage> super_resolution_stage(const SuperResolutionStageOptions& options) {
  return std::make_unique<SuperResolutionStage>(options);
}

}  // namespace todbench
