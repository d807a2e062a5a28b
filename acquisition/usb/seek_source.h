// SPDX-License-Identifier: GPL-3.0-or-later
// One open Seek camera as a FrameSource. Private to the USB back end.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>

#include "acquisition/core/frame_sequence.h"
#include "acquisition/core/frame_source.h"
#include "acquisition/usb/seek_stream.h"
#include "acquisition/usb/usb_connection.h"

namespace todbench {

/// An open Seek camera. One thread at a time, except stop().
class SeekSource final : public FrameSource {
 public:
  /// Creates a source that owns the opened camera. Errors: `not_found`.
  [[nodiscard]] static Result<std::unique_ptr<FrameSource>> create(UsbContext context, const SeekOnBus& camera,
                                                                   std::string id, UsbConnection connection);
  ~SeekSource() override;

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override;
  void stop() override;
  [[nodiscard]] Result<std::string> get(const std::string& feature) override;
  [[nodiscard]] Result<void> set(const std::string& feature, const std::string& value) override;
  [[nodiscard]] Result<void> correct_nonuniformity() override;

 private:
  SeekSource(UsbContext context, UsbConnection connection, SeekModel model);
  /// Initialises the camera and reads frames until the dead pixels and the shutter picture are known.
  [[nodiscard]] Result<void> calibrate();
  [[nodiscard]] Result<void> initialise();
  /// Reads the calibration frame and the following frames, up to and including the shutter frame.
  [[nodiscard]] Result<void> read_calibration_frames(std::chrono::steady_clock::time_point deadline);
  /// Reads a frame within two seconds and before `latest`, even if its bytes arrive slowly.
  [[nodiscard]] Result<SeekFrame> read_frame(std::chrono::steady_clock::time_point latest);
  [[nodiscard]] Frame frame_of(const SeekArrival& arrival);
  void sleep();
  void update_scale();
  /// Records a loss of the camera and returns the error.
  [[nodiscard]] tl::unexpected<Error> failed(const Error& error);
  [[nodiscard]] Error disconnected() const;

  UsbContext context_;        ///< outlives the connection
  UsbConnection connection_;  ///< outlives the stream
  SeekModel model_;
  SourceInfo info_;
  std::shared_ptr<const RadiometricScale> scale_;
  double kelvin_per_count_ = 0, offset_k_ = 0;  ///< scale stated by the user; 0: not stated
  SeekDeadPixels dead_;
  cv::Mat1w shutter_;
  std::int64_t shutter_time_ns_ = 0;
  bool pictures_begun_ = false;  ///< the first image has arrived; frames are counted from there
  FrameSequence sequence_{FrameNumberKind::wrap16, 0};
  bool corrected_last_ = false;  ///< the preceding frame was part of a correction

  std::atomic<bool> running_{false};
  std::atomic<bool> lost_{false};
  std::mutex mutex_;  ///< guards the stream against stop(), and serialises calls of stop()
  std::shared_ptr<SeekStream> stream_;
};

}  // namespace todbench
