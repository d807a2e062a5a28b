#include "bench/run/observed_source.h"

#include <utility>

namespace todbench {
namespace {

class ObservedSource final : public FrameSource {
 public:
  ObservedSource(std::unique_ptr<FrameSource> camera, std::function<void(const Frame&)> on_frame)
      : camera_(std::move(camera)), on_frame_(std::move(on_frame)) {}

  [[nodiscard]] const SourceInfo& info() const override { return camera_->info(); }
  [[nodiscard]] Result<void> start() override { return camera_->start(); }
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    auto frame = camera_->next(timeout);
    if (frame) on_frame_(*frame);
    return frame;
  }
  void stop() override { camera_->stop(); }
  [[nodiscard]] Result<std::string> get(const std::string& feature) override { return camera_->get(feature); }
  [[nodiscard]] Result<void> set(const std::string& feature, const std::string& value) override {
    return camera_->set(feature, value);
  }
  [[nodiscard]] Result<void> correct_nonuniformity() override { return camera_->correct_nonuniformity(); }

 private:
  std::unique_ptr<FrameSource> camera_;
  std::function<void(const Frame&)> on_frame_;
};

}  // namespace

std::unique_ptr<FrameSource> observed_source(std::unique_ptr<FrameSource> camera,
                                             std::function<void(const Frame&)> on_frame) {
  return std::make_unique<ObservedSource>(std::move(camera), std::move(on_frame));
}

}  // namespace todbench
