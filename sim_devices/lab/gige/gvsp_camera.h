// A thermal camera that exists only as a program, on plain sockets: GigE Vision control (GVCP) and streaming (GVSP)
// with packet resend, chunk data, heartbeat, and faults on demand.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "acquisition/core/radiometric_scale.h"
#include "acquisition/core/result.h"
#include "sim_devices/lab/gige/camera_models.h"
#include "sim_devices/lab/gige/gvsp_faults.h"

namespace todbench {

/// What a camera does when it is asked to send packets again.
enum class ResendPolicy {
  answer,       ///< sends them, while it keeps the frame: the last 16
  unavailable,  ///< says that it does not have them
  ignore,
};

/// Whether the clock of a camera goes on when its frame numbers begin anew.
enum class ClockRestart { goes_on, begins_anew };

struct GvspCameraConfig {
  std::string interface_address = "127.0.0.1";  ///< IPv4 address of an interface that is up; one camera per address
  CameraModel model = CameraModel::ax5;
  std::string vendor, model_name;  ///< empty: those of the model; at most 31 characters
  std::string serial = "TB0002";   ///< 1 ... 15 characters
  std::string firmware = "1.0";
  int width = 320, height = 256;
  int significant_bits = 14;                      ///< largest count 2^bits - 1
  double frame_rate_hz = 50;                      ///< 0.1 ... 1000
  double kelvin_per_count = 0.04;                 ///< of the counts that the exposures deliver
  double offset_k = 0;                            ///< temperature of count 0
  PlanckScale radiometric{366545, 1428, 1, 342};  ///< meaning of a count where it is not linear in temperature
  int nuc_freeze_frames = 25;                     ///< how long the last picture is repeated after a correction: 0.5 s
  unsigned automatic_nuc_frames = 3600;           ///< between corrections while the camera decides
  std::chrono::milliseconds heartbeat_timeout{3000};  ///< at power-up
  std::uint16_t first_block_id = 65400;               ///< the 16-bit id wraps from 65535 to 1
  int row_padding_bytes = 0;                          ///< sent behind every row, counted in the payload size
  int image_padding_bytes = 0;                        ///< the same behind the last row
  bool states_padding = true;                         ///< in the leader
  ResendPolicy resend = ResendPolicy::answer;
  std::string description = {};      ///< what is served for it, a text or a ZIP archive; empty: that of the model
  std::string description_url = {};  ///< where the camera says that it is; empty: where it is
  std::chrono::milliseconds memory_delay{0};  ///< before every answer to a READMEM
  std::uint64_t seed = 1;                     ///< of the faults
};

/// What has happened since power-up.
struct GvspCameraCounts {
  std::uint64_t exposures = 0;         ///< frames that were exposed, sent or not
  std::uint64_t failed_exposures = 0;  ///< wrong geometry or an exception: sent as zeros
  std::uint64_t corrections = 0;       ///< of the non-uniformity, commanded and automatic
  std::uint64_t resend_requests = 0, packets_resent = 0;
  std::uint64_t controls_lost = 0;   ///< controllers that went or fell silent
  std::uint64_t late_exposures = 0;  ///< begun more than a frame period after their time
  GvspFaultCounts faults;
};

/// Serves frames while it lives, on two threads of its own: control messages are answered while frames are sent. Its
/// control port 3956 is fixed by the standard: one camera per IPv4 address of a network namespace. Discovery is
/// answered only where it came in on the camera's own interface.
///
/// Exposure k has the time (k + 1) / frame rate on the camera's clock, which stands still while the camera does not
/// expose: exposure_index() of gige_camera.h tells k from a frame.
///
/// Methods may be called from any thread.
class GvspCamera {
 public:
  /// Picture number `exposure_index`, counted from 0 at power-up over all streams; not called for a picture that is
  /// replaced by the one before it. On the streaming thread; taking longer than a frame period lowers the frame rate.
  using Exposure = std::function<cv::Mat1w(std::uint64_t exposure_index)>;

  /// Powers the camera up; returns when it answers. Errors: `not_found` (no such interface, or its port 3956 is busy),
  /// `invalid_input` (configuration).
  [[nodiscard]] static Result<std::unique_ptr<GvspCamera>> start(GvspCameraConfig config, Exposure exposure);
  /// Cuts the power: no goodbye to the client.
  ~GvspCamera();
  GvspCamera(const GvspCamera&) = delete;
  GvspCamera& operator=(const GvspCamera&) = delete;

  [[nodiscard]] const GvspCameraConfig& config() const;
  [[nodiscard]] GvspCameraCounts counts() const;
  /// True while a client controls the camera.
  [[nodiscard]] bool controlled() const;
  /// A register as the camera has it now; addresses in camera_models.h and gev_registers.h.
  [[nodiscard]] std::uint32_t register_value(std::uint32_t address) const;

  /// Faults from the next exposure on; {} ends them.
  void set_faults(const GvspFaults& faults);
  /// The next frame has this block id; the clock begins at 0 again with it, or goes on.
  void restart_numbers(std::uint16_t block_id, ClockRestart clock);
  /// Repeats the last picture in the next `frames` frames, as a shutter does.
  void freeze(unsigned frames);
  /// The cable is out for this long: nothing arrives, nothing is sent; the camera goes on.
  void pull_cable(std::chrono::milliseconds time);
  /// Control messages are lost for this long while frames still arrive.
  void lose_control_messages(std::chrono::milliseconds time);
  /// The camera starts anew: off for this long, then registers as at power-up, nobody in control, not streaming.
  void reset(std::chrono::milliseconds off);
  /// Another client has the camera: nobody else gets control.
  void deny_access();
  void permit_access();

 private:
  struct State;
  explicit GvspCamera(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace todbench
