// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/module/picture_stage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "acquisition/base/try.h"

namespace todbench {
namespace {

class RecursiveFilter final : public ChainStage {
 public:
  explicit RecursiveFilter(double share) : share_(share) {}
  [[nodiscard]] Result<cv::Mat1f> process(const cv::Mat1f& picture) override {
    if (memory_.size() != picture.size()) picture.convertTo(memory_, CV_64F);
    cv::Mat1d now;
    picture.convertTo(now, CV_64F);
    memory_ = share_ * now + (1 - share_) * memory_;
    cv::Mat1f answer;
    memory_.convertTo(answer, CV_32F);
    return answer;
  }
  [[nodiscard]] int memory_frames() const override {
    return share_ >= 1 ? 0 : static_cast<int>(std::ceil(std::log(1e-3) / std::log(1 - share_)));
  }

 private:
  double share_;
  cv::Mat1d memory_;
};

/// A stage without memory.
class PictureFunction final : public ChainStage {
 public:
  explicit PictureFunction(std::function<cv::Mat1f(const cv::Mat1f&)> function) : function_(std::move(function)) {}
  [[nodiscard]] Result<cv::Mat1f> process(const cv::Mat1f& picture) override { return function_(picture); }

 private:
  std::function<cv::Mat1f(const cv::Mat1f&)> function_;
};

std::unique_ptr<ChainStage> stage_of(std::function<cv::Mat1f(const cv::Mat1f&)> function) {
  return std::make_unique<PictureFunction>(std::move(function));
}

/// Lowest value and width of a picture's range.
struct PictureRange {
  double low = 0, width = 0;
};
PictureRange range_of(const cv::Mat1f& picture) {
  double low = 0, high = 0;
  cv::minMaxLoc(picture, &low, &high);
  return {low, high - low};
}

cv::Mat1f equalised_in_fields(const cv::Mat1f& picture, double clip_limit, int tiles) {
  const auto [low, width] = range_of(picture);
  if (!(width > 0)) return picture.clone();
  constexpr double full = 65535;
  cv::Mat1w levels, equalised;
  picture.convertTo(levels, CV_16U, full / width, -low * full / width);
  cv::createCLAHE(clip_limit, {tiles, tiles})->apply(levels, equalised);
  cv::Mat1f answer;
  equalised.convertTo(answer, CV_32F, width / full, low);
  return answer;
}

cv::Mat1f equalised_to_plateau(const cv::Mat1f& picture, double plateau_percent) {
  const auto [low, width] = range_of(picture);
  if (!(width > 0)) return picture.clone();
  constexpr int classes = 1024;
  const auto class_of = [&, low = low, width = width](float value) {
    return std::clamp(static_cast<int>((static_cast<double>(value) - low) / width * classes), 0, classes - 1);
  };
  std::array<double, classes> counts{}, below{};
  for (const float value : picture) counts[static_cast<std::size_t>(class_of(value))] += 1;
  const double plateau = std::max(1.0, plateau_percent / 100 * static_cast<double>(picture.total()));
  double sum = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    // Middle of a class: equal values stay equal, and half of the class counts as below.
    const double counted = std::min(counts[i], plateau);
    below[i] = sum + counted / 2;
    sum += counted;
  }
  cv::Mat1f answer(picture.size());
  std::transform(picture.begin(), picture.end(), answer.begin(), [&, low = low, width = width](float value) {
    return static_cast<float>(low + width * below[static_cast<std::size_t>(class_of(value))] / sum);
  });
  return answer;
}

cv::Mat1f in_grey_levels(const cv::Mat1f& picture, int plateau_counts) {
  const auto count_of = [](float value) { return std::lround(value); };
  std::map<long, double> histogram;
  for (const float value : picture) histogram[count_of(value)] += 1;
  double total = 0;
  for (auto& [count, pixels] : histogram) {
    if (plateau_counts > 0) pixels = std::min(pixels, static_cast<double>(plateau_counts));
    total += pixels;
    pixels = total;  // from here on: up to and including the count
  }
  cv::Mat1f answer(picture.size());
  std::transform(picture.begin(), picture.end(), answer.begin(), [&](float value) {
    return static_cast<float>(std::floor(255 * histogram[count_of(value)] / total + 0.5));
  });
  return answer;
}

class ModuleStage final : public ChainStage {
 public:
  explicit ModuleStage(ModuleStageOptions options) : options_(std::move(options)) {
    options_.process.on_error_line = options_.on_error_line;
  }
  [[nodiscard]] Result<cv::Mat1f> process(const cv::Mat1f& picture) override {
    if (options_.restart_frames > 0 && answered_ >= options_.restart_frames) process_.reset();
    if (!process_) {
      TODBENCH_TRY(auto started, ModuleProcess::start(options_.process));
      process_.emplace(std::move(started));
      answered_ = 0;
    }
    auto answer = process_->exchange(picture);
    ++answered_;
    return answer;
  }
  [[nodiscard]] int memory_frames() const override { return options_.settle_frames; }

 private:
  ModuleStageOptions options_;
  std::optional<ModuleProcess> process_;
  int answered_ = 0;
};

}  // namespace

std::unique_ptr<ChainStage> recursive_filter(double share) {
  return std::make_unique<RecursiveFilter>(share);
}

std::unique_ptr<ChainStage> sharpening(double amount) {
  return stage_of([amount](const cv::Mat1f& picture) {
    cv::Mat1f mean;
    cv::blur(picture, mean, {3, 3}, {-1, -1}, cv::BORDER_REPLICATE);
    return amount == 0 ? picture.clone() : cv::Mat1f(picture + amount * (picture - mean));
  });
}

std::unique_ptr<ChainStage> kernel_filter(const std::array<double, 9>& kernel) {
  return stage_of([kernel](const cv::Mat1f& picture) {
    cv::Mat1f answer;
    cv::Mat1d weights(3, 3);
    std::copy(kernel.begin(), kernel.end(), weights.begin());
    cv::filter2D(picture, answer, CV_32F, weights, {-1, -1}, 0, cv::BORDER_REPLICATE);
    return answer;
  });
}

std::unique_ptr<ChainStage> gain_control(int plateau_counts) {
  return stage_of([plateau_counts](const cv::Mat1f& picture) { return in_grey_levels(picture, plateau_counts); });
}

std::unique_ptr<ChainStage> median_filter(int size) {
  return stage_of([size](const cv::Mat1f& picture) {
    cv::Mat1f answer;
    cv::medianBlur(picture, answer, size);
    return answer;
  });
}

std::unique_ptr<ChainStage> clahe(double clip_limit, int tiles) {
  return stage_of([=](const cv::Mat1f& picture) { return equalised_in_fields(picture, clip_limit, tiles); });
}

std::unique_ptr<ChainStage> plateau_equalisation(double plateau_percent) {
  return stage_of([=](const cv::Mat1f& picture) { return equalised_to_plateau(picture, plateau_percent); });
}

std::unique_ptr<ChainStage> module_stage(ModuleStageOptions options) {
  return std::make_unique<ModuleStage>(std::move(options));
}

}  // namespace todbench
