// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/devices/processed_source.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "acquisition/base/try.h"
#include "acquisition/core/forwarding_source.h"
#include "acquisition/core/judged_picture.h"

namespace todbench {
namespace {

class ProcessedSource final : public ForwardingSource {
 public:
  ProcessedSource(std::unique_ptr<FrameSource> camera, std::vector<std::unique_ptr<ChainStage>> stages, ProcessedAs as,
                  std::size_t picture_frame, std::shared_ptr<ProcessingRecord> record)
      : ForwardingSource(std::move(camera)),
        stages_(std::move(stages)),
        as_(as),
        picture_frame_(picture_frame),
        record_(std::move(record)) {}

  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    auto frame = ForwardingSource::next(timeout);
    if (!frame || frame->status != FrameStatus::complete) return frame;
    TODBENCH_TRY(auto answer, processed(*frame));
    if (record_->frame_ms.size() == picture_frame_ + 1) record_->picture = answer.counts.clone();
    if (as_ == ProcessedAs::judged)
      frame->judged = std::make_shared<const JudgedPicture>(std::move(answer));
    else {
      frame->counts = answer.counts;
      // Carries the record of clipped samples.
      frame->judged = std::make_shared<const JudgedPicture>(std::move(answer));
    }
    return frame;
  }

 private:
  Result<JudgedPicture> processed(const Frame& frame) {
    const auto begin = std::chrono::steady_clock::now();
    JudgedPicture out{.counts = frame.counts};
    if (!stages_.empty()) {
      cv::Mat1f picture;
      frame.counts.convertTo(picture, CV_32F);
      for (const auto& stage : stages_) {
        auto answer = stage->process(picture);
        if (const auto believed = stage->believed_px()) out.scan_px = *believed / out.samples_per_pixel;
        // Frames from before and after a change of the target may not combine to a picture; they are not judged.
        if (!answer && as_ == ProcessedAs::judged && answer.error().code == ErrorCode::not_identifiable) {
          out.none = Error{ErrorCode::integrity, answer.error().message};
          return out;
        }
        if (!answer) return tl::unexpected(answer.error());
        picture = *answer;
        out.first_px += stage->first_px() / out.samples_per_pixel;
        out.samples_per_pixel *= stage->samples_per_pixel();
      }
      put_counts(picture, frame.significant_bits, out);
    }
    record_->frame_ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    return out;
  }
  void put_counts(const cv::Mat1f& picture, int significant_bits, JudgedPicture& out) {
    const float full = static_cast<float>((1 << significant_bits) - 1);
    out.counts = cv::Mat1w(picture.size());
    std::transform(picture.begin(), picture.end(), out.counts.begin(), [&](float value) {
      return static_cast<std::uint16_t>(std::clamp(std::nearbyint(value), 0.0F, full));
    });
    // Up to half a count beyond an end, a value still rounds to the end.
    const cv::Mat1b beyond = (picture < -0.5F) | (picture > full + 0.5F);
    const int clipped = cv::countNonZero(beyond);
    record_->clipped += static_cast<std::size_t>(clipped);
    if (clipped > 0) out.cut_off = beyond;
  }

  std::vector<std::unique_ptr<ChainStage>> stages_;
  ProcessedAs as_;
  std::size_t picture_frame_;
  std::shared_ptr<ProcessingRecord> record_;
};

}  // namespace

int samples_per_pixel(const std::vector<std::unique_ptr<ChainStage>>& stages) {
  int samples = 1;
  for (const auto& stage : stages) samples *= stage->samples_per_pixel();
  return samples;
}

std::unique_ptr<FrameSource> processed_source(std::unique_ptr<FrameSource> camera,
                                              std::vector<std::unique_ptr<ChainStage>> stages, ProcessedAs as,
                                              std::size_t picture_frame, std::shared_ptr<ProcessingRecord> record) {
  return std::make_unique<ProcessedSource>(std::move(camera), std::move(stages), as, picture_frame, std::move(record));
}

}  // namespace todbench
