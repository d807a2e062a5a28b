// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/recording_camera.h"

#include <utility>

#include "acquisition/core/forwarding_source.h"

namespace todbench {
namespace {

class RecordingCamera final : public ForwardingSource {
 public:
  RecordingCamera(std::unique_ptr<FrameSource> camera, std::shared_ptr<FrameStreamWriter> stream)
      : ForwardingSource(std::move(camera)), stream_(std::move(stream)) {}

  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    auto frame = ForwardingSource::next(timeout);
    auto written = frame ? stream_->append(*frame) : stream_->append_failure(frame.error(), FailedCall::next);
    if (!written && frame) return fail("recording", written.error());
    return frame;
  }
  [[nodiscard]] Result<void> correct_nonuniformity() override {
    auto done = ForwardingSource::correct_nonuniformity();
    if (!done) (void)stream_->append_failure(done.error(), FailedCall::correct_nonuniformity);
    return done;
  }

 private:
  std::shared_ptr<FrameStreamWriter> stream_;
};

}  // namespace

std::unique_ptr<FrameSource> recording_camera(std::unique_ptr<FrameSource> camera,
                                              std::shared_ptr<FrameStreamWriter> stream) {
  return std::make_unique<RecordingCamera>(std::move(camera), std::move(stream));
}

}  // namespace todbench
