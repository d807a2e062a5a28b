// SPDX-License-Identifier: GPL-3.0-or-later
// One open camera as a FrameSource. Private to the Aravis back end.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "acquisition/aravis/aravis_backend.h"
#include "acquisition/aravis/camera_setup.h"
#include "acquisition/aravis/glib_ptr.h"
#include "acquisition/aravis/watched_camera.h"
#include "acquisition/core/frame_sequence.h"
#include "acquisition/core/frame_source.h"

namespace todbench {

/// An open GigE Vision or USB3 Vision camera. One thread at a time, except stop().
class AravisSource : public FrameSource {
 public:
  /// Opens a source on a camera. `device_address`: IPv4 address of a GigE camera, empty for USB. `info` contains the
  /// identity; the rest is read from the camera. Precondition: no other reference to the camera's device exists.
  [[nodiscard]] static Result<std::unique_ptr<FrameSource>> create(GObjectPtr<ArvCamera> camera, AravisOptions options,
                                                                   SourceInfo info, std::string device_address);
  ~AravisSource() override;

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override;
  void stop() override;
  [[nodiscard]] Result<std::string> get(const std::string& feature) override;
  [[nodiscard]] Result<void> set(const std::string& feature, const std::string& value) override;
  [[nodiscard]] Result<void> correct_nonuniformity() override;

 private:
  using Clock = std::chrono::steady_clock;

  /// A buffer that came into the stream's output queue.
  struct Arrival {
    std::int64_t host_time_ns = 0;
    bool oversized = false;     ///< more bytes arrived than the buffer holds
    bool after_unread = false;  ///< frames were lost since the last arrival because no buffer was free
  };

  /// Events reported by Aravis's threads. Shared with the callbacks, which may run after the source is destroyed.
  struct Events {
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<Arrival> arrivals;  ///< one per buffer in the stream's output queue, in order
    Clock::time_point last_sign_of_life;
    bool running = false;
    bool lost = false;
    int failed_pings = 0;

    void mark_lost();
  };

  /// State of one stream's callback; destroyed with the stream.
  struct StreamTap {
    std::shared_ptr<Events> events;
    std::atomic<ArvStream*> stream = nullptr;
    std::uint64_t ignored_bytes = 0;  ///< the stream's counter of ignored bytes at the start of the present buffer
    std::uint64_t underruns = 0;      ///< the stream's underrun counter at the last arrival
  };

  AravisSource(GObjectPtr<ArvCamera> camera, AravisOptions options, SourceInfo info, std::string device_address);
  static void on_stream_event(void* tap, ArvStreamCallbackType type, ArvBuffer* buffer);

  [[nodiscard]] Result<void> refresh();
  [[nodiscard]] Result<void> check_byte_order();
  /// Sets a scale that the user measured. It takes precedence over the scale that the camera states.
  [[nodiscard]] Result<void> state_scale(const std::string& feature, const std::string& value);
  [[nodiscard]] Result<std::shared_ptr<ArvStream>> create_stream();
  void configure_transport();
  [[nodiscard]] Result<void> state_frame(const std::string& value);
  [[nodiscard]] Result<void> name_nuc_command(const std::string& value);
  /// Returns an error if no frame since the start has the size that the camera reports.
  [[nodiscard]] std::optional<Error> misstated_size(const Frame& frame, cv::Size sent);
  void check_socket_buffer(ArvStream* stream);
  void publish_socket_buffer();
  [[nodiscard]] Error silence(std::chrono::milliseconds timeout);
  [[nodiscard]] bool answers() const;
  [[nodiscard]] bool is_lost() const;
  void mark_lost();
  [[nodiscard]] Error disconnected() const;

  std::shared_ptr<Events> events_ = std::make_shared<Events>();
  WatchedCamera camera_;  ///< declared before the streams, which are destroyed first
  AravisOptions options_;
  SourceInfo info_;
  std::string device_address_;
  bool loopback_ = false;
  bool can_resend_ = false;
  std::vector<std::string> setup_warnings_;
  std::string socket_buffer_bytes_, socket_buffer_warning_;
  CameraFamily family_;
  bool bytes_swapped_ = false;  ///< the byte order is opposite to the order that the camera states
  bool corrections_taken_over_ = false;
  std::optional<double> stated_kelvin_per_count_, stated_offset_k_;
  std::optional<cv::Size> stated_frame_;  ///< size that the user stated because the camera states a wrong size
  std::string nuc_command_;               ///< command that the user stated; empty: command of the family, or found by
                                          ///< name
  StreamFormat format_;
  int frames_of_wrong_size_ = 0;  ///< successive frames of wrong size since the start; negative: a frame of the right
                                  ///< size has arrived
  std::shared_ptr<const RadiometricScale> scale_;
  FrameSequence sequence_{FrameNumberKind::gvsp16, 0};
  std::int64_t may_pause_until_ns_ = 0;  ///< host time until which a commanded correction may interrupt the stream

  std::mutex control_;                 ///< serialises communication with the camera; locked before events_->mutex
  std::shared_ptr<ArvStream> stream_;  ///< guarded by events_->mutex; next() keeps it alive while it copies
  std::shared_ptr<ArvStream> unreachable_stream_;  ///< stream of a camera that did not answer at stop(); guarded by
                                                   ///< control_
};

}  // namespace todbench
