// SPDX-License-Identifier: GPL-3.0-or-later
// One open camera as a FrameSource. Private to the V4L2 back end.
#pragma once

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "acquisition/core/frame_sequence.h"
#include "acquisition/core/frame_source.h"
#include "acquisition/v4l2/boson_serial.h"
#include "acquisition/v4l2/v4l2_backend.h"
#include "acquisition/v4l2/video_controls.h"
#include "acquisition/v4l2/video_device.h"
#include "acquisition/v4l2/video_listing.h"

namespace todbench {

/// An open V4L2 camera. One thread at a time, except stop().
class V4l2Source final : public FrameSource {
 public:
  /// Sets the format and reads the result back. Errors: `not_found`.
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

  /// A frame from the receiving thread.
  struct Arrival {
    Frame frame;  ///< the frame without sequence and scale
    std::uint32_t sequence = 0;
    std::optional<LeptonTelemetry> telemetry;
    bool after_unread = false;  ///< frames directly before this one were dropped because the inbox was full
  };

  /// State shared by the receiving thread and the reader.
  struct Inbox {
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<Arrival> arrivals;
    bool overflowed = false;  ///< since the last arrival
    bool running = false;
    bool lost = false;
  };

  V4l2Source(VideoNode node, V4l2Options options, VideoDevice device, VideoWatch watch, Descriptor wake);

  [[nodiscard]] Result<void> take_layout(const WantedLayout& wanted);
  [[nodiscard]] Result<void> set_layout(const std::string& feature, const std::string& value);
  void refresh();
  /// Opens the serial port of a Boson, if it has one.
  void open_serial_port();
  /// Reads the settings of a Boson through its serial port, and updates settings and warnings.
  void refresh_serial_port();
  /// Writes GainMode or FFCMode. Error: `not_found` with the accepted values.
  [[nodiscard]] Result<void> set_boson_mode(const std::string& feature, const std::string& value);
  [[nodiscard]] Result<void> correct_boson();
  void set_scale(const RadiometricScale& scale);
  [[nodiscard]] RadiometricScale scale_of(const LeptonTelemetry& telemetry) const;
  /// Reads frames until one contains the scale, for a camera that reports its scale only in telemetry. The first frames
  /// may have no scale.
  [[nodiscard]] Result<void> learn_scale();

  /// Runs the receiving thread. The thread fetches every frame immediately, so that the host time of the frame is its
  /// time of arrival and the driver always has a free buffer.
  void receive(const std::stop_token& stop);
  void keep(const VideoBuffer& buffer);
  [[nodiscard]] bool device_has_gone();
  /// Fills in sequence and scale; empty if the camera sent the same frame twice.
  [[nodiscard]] std::optional<Frame> finished(Arrival arrival);

  [[nodiscard]] bool is_lost() const;
  void mark_lost();
  [[nodiscard]] Error disconnected() const;
  /// Records a loss of the camera and returns the error.
  [[nodiscard]] Error noted(const Error& error);

  VideoNode node_;
  V4l2Options options_;
  VideoWatch watch_;  ///< used by the receiving thread
  Descriptor wake_;   ///< eventfd that ends poll() of the receiving thread
  SourceInfo info_;
  std::shared_ptr<const RadiometricScale> scale_;
  VideoLayout layout_;
  WantedLayout wanted_;
  std::string nuc_command_;                        ///< control that corrects the non-uniformity; empty: search by name
  std::optional<double> stated_kelvin_per_count_;  ///< scale stated by the user because the camera does not report it
  double stated_offset_k_ = 0;

  // Members used by the reader during one run.
  FrameSequence sequence_{FrameNumberKind::wrap32, 0};
  bool corrected_last_ = false;          ///< the preceding frame was exposed during a correction
  std::int64_t may_pause_until_ns_ = 0;  ///< host time until which a commanded correction may interrupt the stream
  std::uint32_t repeated_ = 0;           ///< frames that the camera sent twice, excluded from the sequence
  std::optional<std::uint32_t> last_counter_;
  bool telemetry_came_ = false;  ///< telemetry arrived since the layout was set

  std::mutex control_;  ///< serialises start, stop, get and set; locked before inbox_.mutex
  VideoDevice device_;  ///< used by the receiving thread while it runs, except for controls
  std::vector<VideoControl> controls_;
  std::optional<BosonPort> serial_port_;  ///< serial port of a Boson
  std::string serial_port_problem_;       ///< reason why the serial port is not used; empty: no problem
  mutable Inbox inbox_;
  std::jthread receiver_;
};

}  // namespace todbench
