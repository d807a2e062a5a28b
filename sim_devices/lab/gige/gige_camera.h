// A thermal camera that exists only as a program, on the real GigE Vision protocol: any GigE Vision client can drive
// it.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "acquisition/core/frame.h"
#include "acquisition/core/radiometric_scale.h"
#include "acquisition/core/result.h"

namespace todbench {

struct EmulatedGigeCameraConfig {
  std::string interface_address = "127.0.0.1";  ///< IPv4 address of an interface that is up; one camera per address
  std::string vendor = "todbench", model = "Emulated LWIR", serial = "TB0001";  ///< at most 31, 31 and 15 characters
  std::string firmware = "1.0";
  int width = 320, height = 240;
  int significant_bits = 14;       ///< largest count 2^bits - 1; 14 offers Mono14 first, 15 and 16 Mono16
  double frame_rate_hz = 50;       ///< at power-up; 0.1 ... 1000
  double kelvin_per_count = 0.01;  ///< of the counts that the exposures deliver
  double offset_k = 0;             ///< temperature of count 0
  PlanckScale radiometric{366545, 1428, 1, 342};  ///< meaning of a count in IRFormat=Radiometric (like a FLIR A35)
  int nuc_freeze_frames = 0;  ///< how long the last picture is repeated after a correction; real cameras: 0.5 s
  double device_temperature_c = 30;
  std::uint16_t first_frame_id =
      65400;  ///< the 16-bit id wraps after 136 frames: every longer run tests the client's unwrapping
};

/// Serves frames while it lives. Its GVCP port 3956 is fixed by the standard: one camera per IPv4 address of a network
/// namespace.
///
/// The client may choose PixelFormat Mono14 or Mono16, IRFormat (the exposure's counts are sent as they are in
/// TemperatureLinear10mK, divided by ten in TemperatureLinear100mK, converted by `radiometric` in Radiometric),
/// NoiseReduction (on at power-up as in cameras as shipped; averages successive frames), NUCMode, NUCAction,
/// AcquisitionFrameRate, byte order.
///
/// The camera's clock advances by one frame period with every exposure, from power-up: exposure k at an undisturbed
/// rate f has device_time_ns = (k + 1) 10^9 / f, so a client in another process can tell which exposure a frame is. See
/// exposure_index().
///
/// Methods may be called from any thread.
class EmulatedGigeCamera {
 public:
  /// Picture number `exposure_index`, counted from 0 at power-up over all streams. Called once per exposure, on the
  /// camera's thread, which also answers the client: taking longer than a frame period lowers the frame rate, longer
  /// than 0.5 s hurts control. Must return the configured geometry; a wrong size or an exception is sent as zeros and
  /// counted in failed_exposures().
  using Exposure = std::function<cv::Mat1w(std::uint64_t exposure_index)>;
  /// Called on a camera thread when a non-uniformity correction begins, before the next exposure; no lock is held.
  using NucObserver = std::function<void()>;

  /// Powers the camera up; returns when it answers. Errors: `not_found` (no such interface, or port 3956 is "busy":
  /// another camera has the address), `invalid_input` (configuration).
  [[nodiscard]] static Result<std::unique_ptr<EmulatedGigeCamera>> start(EmulatedGigeCameraConfig config,
                                                                         Exposure exposure, NucObserver on_nuc = {});
  /// Cuts the power: no goodbye to the client. Takes up to 0.1 s and the end of the present exposure.
  ~EmulatedGigeCamera();
  EmulatedGigeCamera(const EmulatedGigeCamera&) = delete;
  EmulatedGigeCamera& operator=(const EmulatedGigeCamera&) = delete;

  [[nodiscard]] const EmulatedGigeCameraConfig& config() const;
  /// Exposures since power-up, lost ones included.
  [[nodiscard]] std::uint64_t exposures() const;
  [[nodiscard]] std::uint64_t failed_exposures() const;
  /// Non-uniformity corrections since power-up, commanded and automatic.
  [[nodiscard]] std::uint64_t nonuniformity_corrections() const;
  void set_device_temperature_c(double temperature_c);

  /// Loses every packet, leaders and trailers too, with this probability (0 ... 1) from now on. `seed` sets GLib's
  /// process-wide generator: the pattern repeats when nothing else in the process draws from it.
  void set_packet_loss(double probability, std::uint32_t seed);
  /// The next `count` exposures happen but are never sent: a gap of exactly `count` frames.
  void lose_exposures(unsigned count);

 private:
  struct State;
  explicit EmulatedGigeCamera(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Which exposure since power-up a frame of an emulated camera is, from its device time; the rate must not have been
/// changed.
[[nodiscard]] std::uint64_t exposure_index(const Frame& frame, double frame_rate_hz);

}  // namespace todbench
