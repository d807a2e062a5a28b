// SPDX-License-Identifier: GPL-3.0-or-later
// State of an emulated GVSP camera, shared by control thread and streaming thread. Private to these two threads.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>

#include "acquisition/aravis/gev_registers.h"
#include "acquisition/base/rng.h"
#include "sim_devices/lab/genicam/picture_encoder.h"
#include "sim_devices/lab/gige/gvcp_device.h"
#include "sim_devices/lab/gige/gvsp_camera.h"
#include "sim_devices/lab/gige/gvsp_sockets.h"

namespace todbench {

/// Smallest size of a stream packet in bytes; no header fits into a smaller packet.
inline constexpr std::uint32_t gvsp_least_packet_bytes = 46;

/// Returns the frame period in ns, rounded to whole microseconds as exposure_index() assumes.
[[nodiscard]] std::uint64_t gvsp_period_ns(double rate_hz);

/// State that the control thread and the streaming thread of the camera share.
struct GvspCamera::State {
  State(GvspCameraConfig c, Exposure e, ControlSockets control_sockets, StreamSocket stream_socket,
        const LocalInterface& where);

  const GvspCameraConfig config;
  const Exposure exposure;
  const ModelDescription description;
  const LocalInterface interface;
  ControlSockets control;
  StreamSocket stream;
  std::mutex sending;  ///< one sender on `stream` at a time; no other lock is taken under it
  RegisterMap registers;
  GvcpDevice device;
  PictureEncoder encoder;  ///< used by the streaming thread
  Bytes last_picture;      ///< used by the streaming thread
  const RandomStream random;

  std::mutex mutex;  ///< guards the members below
  std::condition_variable_any changed;
  bool acquiring = false;
  std::uint64_t acquisitions = 0;  ///< number of acquisition starts
  std::uint64_t clock_ns = 0;
  std::uint64_t period_ns = 0;
  std::uint16_t next_block_id = 1;
  unsigned frozen_frames = 0;
  GvspFaults faults;
  GvspCameraCounts counts;
  std::deque<std::shared_ptr<const GvspFrame>> kept;
  std::chrono::steady_clock::time_point link_down_until, control_down_until;
  std::uint64_t resend_draws = 0;

  std::jthread control_thread, stream_thread;  ///< last members: they stop before anything that they use is destroyed

  [[nodiscard]] std::string description_served() const;
  void power_up();
  void serve_control(const std::stop_token& stop);
  void answer(const GvcpDatagram& request, const std::stop_token& stop);
  void serve_stream(const std::stop_token& stop);
  void on_write(std::uint32_t address, std::uint32_t value);
  void on_control_lost();
  void begin_correction(unsigned times);
  void stop_acquisition();
  void send_test_packet(std::uint32_t packet_bytes);
  void resend(const ResendRequest& request);
  [[nodiscard]] EncoderSettings encoder_settings() const;
  void update_payload_size();
  [[nodiscard]] GvcpEndpoint destination() const {
    return {registers.get(gev::stream_destination), static_cast<std::uint16_t>(registers.get(gev::stream_port))};
  }
  [[nodiscard]] bool link_is_down() {
    const std::lock_guard lock(mutex);
    return std::chrono::steady_clock::now() < link_down_until;
  }

  struct Exposed {
    std::uint64_t index = 0, timestamp_ns = 0;
    std::uint64_t acquisition = 0;
    std::uint16_t block_id = 1;
    bool shutter_closed = false;
    FrameFaults planned;
    GvspFaults faults;
  };
  [[nodiscard]] Exposed begin_exposure();
  [[nodiscard]] Bytes picture_of(const Exposed& exposed, const EncoderSettings& settings);
  [[nodiscard]] std::shared_ptr<const GvspFrame> frame_of(const Exposed& exposed);
  void send_frame(const GvspFrame& frame, const Exposed& exposed);
};

}  // namespace todbench
