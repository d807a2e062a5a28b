#include "bench/run/processed_source.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "acquisition/core/correction_watch.h"
#include "acquisition/core/forwarding_source.h"

namespace todbench {
namespace {

class ProcessedSource final : public ForwardingSource {
 public:
  ProcessedSource(std::unique_ptr<FrameSource> camera, std::vector<std::unique_ptr<ChainStage>> stages,
                  std::size_t picture_frame, ProcessingRecord& record)
      : ForwardingSource(std::move(camera)),
        stages_(std::move(stages)),
        picture_frame_(picture_frame),
        record_(record) {}

  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    auto frame = ForwardingSource::next(timeout);
    if (!frame || frame->status != FrameStatus::complete) return frame;
    auto counts = processed(*frame);
    if (!counts) return tl::unexpected(counts.error());
    if (record_.frame_ms.size() == picture_frame_ + 1) record_.picture = counts->clone();
    if (!record_.handed_out) {
      watch_.scene_changed();
      return frame;
    }
    // Corrections are seen in the camera's own pictures: where answers begin the pictures differ in everything.
    if (frame->correction == CorrectionState::unknown)
      frame->correction = watch_.see(*frame) ? CorrectionState::running : CorrectionState::idle;
    frame->counts = *counts;
    return frame;
  }

 private:
  Result<cv::Mat1w> processed(const Frame& frame) {
    const auto begin = std::chrono::steady_clock::now();
    cv::Mat1w counts = frame.counts;
    if (!stages_.empty()) {
      cv::Mat1f picture;
      frame.counts.convertTo(picture, CV_32F);
      for (const auto& stage : stages_) {
        auto answer = stage->process(picture);
        if (!answer) return tl::unexpected(answer.error());
        picture = *answer;
      }
      counts = counts_of(picture, frame.significant_bits);
    }
    record_.frame_ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    return counts;
  }
  cv::Mat1w counts_of(const cv::Mat1f& picture, int significant_bits) {
    const float full = static_cast<float>((1 << significant_bits) - 1);
    cv::Mat1w counts(picture.size());
    std::transform(picture.begin(), picture.end(), counts.begin(), [&](float value) {
      const float rounded = std::nearbyint(value);
      if (rounded < 0 || rounded > full) ++record_.clipped;
      return static_cast<std::uint16_t>(std::clamp(rounded, 0.0F, full));
    });
    return counts;
  }

  std::vector<std::unique_ptr<ChainStage>> stages_;
  std::size_t picture_frame_;
  ProcessingRecord& record_;
  CorrectionWatch watch_{CorrectionWatchOptions{}};
};

}  // namespace

std::unique_ptr<FrameSource> processed_source(std::unique_ptr<FrameSource> camera,
                                              std::vector<std::unique_ptr<ChainStage>> stages,
                                              std::size_t picture_frame, ProcessingRecord& record) {
  return std::make_unique<ProcessedSource>(std::move(camera), std::move(stages), picture_frame, record);
}

}  // namespace todbench
