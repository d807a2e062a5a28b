#include "acquisition/recording/recording_camera.h"

#include <utility>

namespace todbench {
namespace {

class RecordingCamera final : public FrameSource {
 public:
  RecordingCamera(std::unique_ptr<FrameSource> camera, std::shared_ptr<FrameStreamWriter> stream)
      : camera_(std::move(camera)), stream_(std::move(stream)) {}

  [[nodiscard]] const SourceInfo& info() const override { return camera_->info(); }
  [[nodiscard]] Result<void> start() override { return camera_->start(); }

  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    auto frame = camera_->next(timeout);
    auto written = frame ? stream_->append(*frame) : stream_->append_failure(frame.error(), FailedCall::next);
    if (!written && frame) return fail("recording", written.error());
    return frame;
  }

  void stop() override { camera_->stop(); }
  [[nodiscard]] Result<std::string> get(const std::string& feature) override { return camera_->get(feature); }
  [[nodiscard]] Result<void> set(const std::string& feature, const std::string& value) override {
    return camera_->set(feature, value);
  }
  [[nodiscard]] Result<void> correct_nonuniformity() override {
    auto done = camera_->correct_nonuniformity();
    if (!done) (void)stream_->append_failure(done.error(), FailedCall::correct_nonuniformity);
    return done;
  }

 private:
  std::unique_ptr<FrameSource> camera_;
  std::shared_ptr<FrameStreamWriter> stream_;
};

}  // namespace

std::unique_ptr<FrameSource> recording_camera(std::unique_ptr<FrameSource> camera,
                                              std::shared_ptr<FrameStreamWriter> stream) {
  return std::make_unique<RecordingCamera>(std::move(camera), std::move(stream));
}

}  // namespace todbench
