// SPDX-License-Identifier: GPL-3.0-or-later
// Emulated thermal camera on plain sockets: GigE Vision control (GVCP) and streaming (GVSP) with packet resend, chunk
// data, heartbeat, and faults on demand.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "acquisition/base/result.h"
#include "acquisition/core/radiometric_scale.h"
#include "sim_devices/lab/gige/camera_models.h"
#include "sim_devices/lab/gige/gvsp_faults.h"

namespace todbench {

/// Reaction of a camera to a resend request.
enum class ResendPolicy {
  answer,       ///< sends the packets of the last 16 frames, which it stores
  unavailable,  ///< reports that the packets are not available
  ignore,
};

/// Behaviour of the camera's clock when the frame numbers restart.
enum class ClockRestart { goes_on, begins_anew };

/// Configuration of the camera.
struct GvspCameraConfig {
  std::string interface_address = "127.0.0.1";  ///< IPv4 address of an interface that is up; one camera per address
  CameraModel model = CameraModel::ax5;
  std::string vendor, model_name;  ///< empty: names of the model; at most 31 characters
  std::string serial = "TB0002";   ///< 1 ... 15 characters
  std::string firmware = "1.0";
  int width = 320, height = 256;
  int significant_bits = 14;                      ///< largest count 2^bits - 1
  double frame_rate_hz = 50;                      ///< 0.1 ... 1000
  double kelvin_per_count = 0.04;                 ///< scale of the counts of the exposures
  double offset_k = 0;                            ///< temperature of count 0
  PlanckScale radiometric{366545, 1428, 1, 342};  ///< scale of counts that are not linear in temperature
  int nuc_freeze_frames = 25;            ///< frames for which a correction repeats the last picture; 0.5 s by default
  unsigned automatic_nuc_frames = 3600;  ///< frames between automatic corrections
  std::optional<PixelFormat> only_format{};           ///< replaces the formats of the model
  std::chrono::milliseconds heartbeat_timeout{3000};  ///< heartbeat timeout at power-up
  std::uint16_t first_block_id = 65400;               ///< the 16-bit id wraps from 65535 to 1
  int row_padding_bytes = 0;                          ///< sent after every row, counted in the payload size
  int image_padding_bytes = 0;                        ///< sent after the last row, counted in the payload size
  bool states_padding = true;                         ///< whether the leader states row and image padding
  int rows_not_sent = 0;                              ///< rows that the height register counts but the leaders do not
  bool chunks_at_power_up = false;                    ///< ChunkModeActive at power-up
  std::uint16_t chunk_payload_type = 0x4001;          ///< with chunks; 4: GigE Vision 1.x, whose leader states no size
  ResendPolicy resend = ResendPolicy::answer;
  std::string description = {};               ///< served description, text or ZIP archive; empty: the model's
  std::string description_url = {};           ///< stated location of the description; empty: the true location
  std::chrono::milliseconds memory_delay{0};  ///< delay before every response to READMEM
  std::string deaf_feature = {};              ///< feature that accepts writes but keeps its power-up value
  std::uint64_t seed = 1;                     ///< seed of the faults
};

/// Counters since power-up.
struct GvspCameraCounts {
  std::uint64_t exposures = 0;         ///< exposed frames, sent or not sent
  std::uint64_t failed_exposures = 0;  ///< exposures with wrong geometry or an exception; sent as zeros
  std::uint64_t corrections = 0;       ///< non-uniformity corrections, commanded and automatic
  std::uint64_t resend_requests = 0, packets_resent = 0;
  std::uint64_t controls_lost = 0;   ///< controllers that left or sent no more messages
  std::uint64_t late_exposures = 0;  ///< exposures that began more than a frame period late
  GvspFaultCounts faults;
};

/// Camera that serves frames during its lifetime on two threads. It responds to control messages while it sends frames.
/// The standard fixes the control port to 3956, so there can be only one camera per IPv4 address of a network
/// namespace. The camera responds to discovery only on its own interface.
///
/// On the camera's clock, exposure k has the time (k + 1) / frame rate. The clock stops while the camera does not
/// expose. exposure_index() of gige_camera.h therefore returns k for a frame.
///
/// Methods may be called from any thread.
class GvspCamera {
 public:
  /// Returns picture number `exposure_index`, counted from 0 at power-up over all streams. Not called for a picture
  /// that is replaced by the previous picture. Runs on the streaming thread; a call longer than a frame period lowers
  /// the frame rate.
  using Exposure = std::function<cv::Mat1w(std::uint64_t exposure_index)>;

  /// Powers the camera up and returns when it responds. Errors: `not_found` (no such interface, or port 3956 is busy),
  /// `invalid_input` (configuration).
  [[nodiscard]] static Result<std::unique_ptr<GvspCamera>> start(GvspCameraConfig config, Exposure exposure);
  /// Cuts the power without notice to the client.
  ~GvspCamera();
  GvspCamera(const GvspCamera&) = delete;
  GvspCamera& operator=(const GvspCamera&) = delete;

  [[nodiscard]] const GvspCameraConfig& config() const;
  [[nodiscard]] GvspCameraCounts counts() const;
  /// Returns whether a client controls the camera.
  [[nodiscard]] bool controlled() const;
  /// Returns the present value of a register; addresses are in camera_models.h and gev_registers.h.
  [[nodiscard]] std::uint32_t register_value(std::uint32_t address) const;

  /// Sets the faults from the next exposure on; {} ends them.
  void set_faults(const GvspFaults& faults);
  /// Sets the block id of the next frame. `clock`: whether the clock continues or restarts at 0.
  void restart_numbers(std::uint16_t block_id, ClockRestart clock);
  /// Pulls the cable for this time: no data are received or sent, but the camera continues.
  void pull_cable(std::chrono::milliseconds time);
  /// Loses control messages for this time, while frames still arrive.
  void lose_control_messages(std::chrono::milliseconds time);
  /// Restarts the camera: it is off for this time, then has the registers of power-up, no controller and no stream.
  void reset(std::chrono::milliseconds off);
  /// Denies control to all clients, as if another client had control.
  void deny_access();
  /// Permits control again.
  void permit_access();

 private:
  struct State;
  explicit GvspCamera(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace todbench
