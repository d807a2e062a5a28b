// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/devices/observed_source.h"

#include <utility>

#include "acquisition/core/forwarding_source.h"

namespace todbench {
namespace {

class ObservedSource final : public ForwardingSource {
 public:
  ObservedSource(std::unique_ptr<FrameSource> camera, std::function<void(const Frame&)> on_frame)
      : ForwardingSource(std::move(camera)), on_frame_(std::move(on_frame)) {}

  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    auto frame = ForwardingSource::next(timeout);
    if (frame) on_frame_(*frame);
    return frame;
  }

 private:
  std::function<void(const Frame&)> on_frame_;
};

}  // namespace

std::unique_ptr<FrameSource> observed_source(std::unique_ptr<FrameSource> camera,
                                             std::function<void(const Frame&)> on_frame) {
  return std::make_unique<ObservedSource>(std::move(camera), std::move(on_frame));
}

}  // namespace todbench
