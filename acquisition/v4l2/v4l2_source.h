// One open camera as a FrameSource. Private to the V4L2 back end.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/core/frame_source.h"
#include "acquisition/v4l2/v4l2_backend.h"
#include "acquisition/v4l2/video_controls.h"
#include "acquisition/v4l2/video_device.h"
#include "acquisition/v4l2/video_listing.h"

namespace todbench {

class V4l2Source final : public FrameSource {
 public:
  /// Sets the format and reads back what the camera became. Errors: `not_found`.
  [[nodiscard]] static Result<std::unique_ptr<FrameSource>> create(const VideoNode& node, const V4l2Options& options);
  ~V4l2Source() override;

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override;
  void stop() override;
  [[nodiscard]] Result<std::string> get(const std::string& feature) override;
  [[nodiscard]] Result<void> set(const std::string& feature, const std::string& value) override;
  [[nodiscard]] Result<void> correct_nonuniformity() override;

 private:
  using Clock = std::chrono::steady_clock;

  V4l2Source(VideoNode node, V4l2Options options, VideoDevice device, VideoWatch watch, FileDescriptor wake);

  [[nodiscard]] Result<void> take_layout(const std::string& wanted);
  void refresh();
  void set_scale(const RadiometricScale& scale);
  /// The next frame that is already there; nothing when there is none, or when it repeats the one before.
  [[nodiscard]] Result<std::optional<Frame>> take_frame();
  /// Nothing when it repeats the frame before.
  [[nodiscard]] std::optional<Frame> frame_of(const VideoBuffer& buffer);
  [[nodiscard]] RadiometricScale scale_of(const LeptonTelemetry& telemetry) const;
  /// Reads one frame of a camera that tells its scale only there.
  [[nodiscard]] Result<void> learn_scale();
  /// Waits for the camera, stop(), the end of the device or the deadline.
  void wait_until(Clock::time_point deadline);
  [[nodiscard]] Error disconnected() const;

  VideoNode node_;
  V4l2Options options_;
  VideoWatch watch_;     ///< of the reading thread
  FileDescriptor wake_;  ///< eventfd that stop() writes
  SourceInfo info_;
  std::shared_ptr<const RadiometricScale> scale_;
  VideoLayout layout_;
  std::optional<double> stated_kelvin_per_count_;  ///< by the user, for cameras that do not say
  double stated_offset_k_ = 0;

  std::atomic<bool> running_{false};
  std::atomic<bool> lost_{false};

  std::mutex device_mutex_;  ///< guards what follows: stop() may meet a reader
  VideoDevice device_;
  std::vector<VideoControl> controls_;
  bool streaming_ = false;
  std::optional<std::uint32_t> first_sequence_;
  std::uint32_t repeated_ = 0;  ///< frames that the camera sent twice, taken out of the sequence
  std::optional<std::uint32_t> last_counter_;
};

}  // namespace todbench
