// SPDX-License-Identifier: GPL-3.0-or-later
// Emulated thermal camera with the real GigE Vision protocol, which any GigE Vision client can control.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "acquisition/base/result.h"
#include "acquisition/core/frame.h"
#include "acquisition/core/radiometric_scale.h"

namespace todbench {

/// Configuration of the camera.
struct EmulatedGigeCameraConfig {
  std::string interface_address = "127.0.0.1";  ///< IPv4 address of an interface that is up; one camera per address
  std::string vendor = "todbench", model = "Emulated LWIR", serial = "TB0001";  ///< at most 31, 31 and 15 characters
  std::string firmware = "1.0";
  int width = 320, height = 240;
  int significant_bits = 14;       ///< largest count 2^bits - 1; 14 offers Mono14 first, 15 and 16 Mono16
  double frame_rate_hz = 50;       ///< frame rate at power-up; 0.1 ... 1000
  double kelvin_per_count = 0.01;  ///< scale of the counts of the exposures
  double offset_k = 0;             ///< temperature of count 0
  PlanckScale radiometric{366545, 1428, 1, 342};  ///< scale of the counts in IRFormat=Radiometric (like a FLIR A35)
  /// Frames for which the last picture is repeated after a correction; 0.5 s in real cameras.
  int nuc_freeze_frames = 0;
  double device_temperature_c = 30;
  /// First 16-bit frame id. It wraps after 136 frames, so every longer run tests how the client unwraps ids.
  std::uint16_t first_frame_id = 65400;
};

/// Camera that serves frames during its lifetime. The standard fixes the GVCP port to 3956, so there can be only one
/// camera per IPv4 address of a network namespace.
///
/// The client may set PixelFormat Mono14 or Mono16, IRFormat, NoiseReduction, NUCMode, NUCAction, AcquisitionFrameRate
/// and byte order. IRFormat determines whether the camera sends the exposure's counts unchanged
/// (TemperatureLinear10mK), divided by ten (TemperatureLinear100mK) or converted by `radiometric` (Radiometric).
/// NoiseReduction averages successive frames; it is on at power-up, as in new cameras.
///
/// The camera's clock advances by one frame period with every exposure from power-up. Exposure k at an unchanged rate f
/// has device_time_ns = (k + 1) 10^9 / f. A client in another process can therefore identify the exposure of a frame
/// (exposure_index()).
///
/// Methods may be called from any thread.
class EmulatedGigeCamera {
 public:
  /// Returns picture number `exposure_index`, counted from 0 at power-up over all streams. Called once per exposure on
  /// the thread of the camera, which also responds to the client. A call longer than a frame period lowers the frame
  /// rate; a call longer than 0.5 s disturbs control. Must return the configured geometry. After a wrong size or an
  /// exception the camera sends zeros and counts the exposure in failed_exposures().
  using Exposure = std::function<cv::Mat1w(std::uint64_t exposure_index)>;
  /// Called on a camera thread when a non-uniformity correction begins, before the next exposure; no lock is held.
  using NucObserver = std::function<void()>;

  /// Powers the camera up and returns when it responds. Errors: `not_found` (no such interface, or port 3956 is "busy"
  /// because another camera has the address), `invalid_input` (configuration).
  [[nodiscard]] static Result<std::unique_ptr<EmulatedGigeCamera>> start(EmulatedGigeCameraConfig config,
                                                                         Exposure exposure, NucObserver on_nuc = {});
  /// Cuts the power without notice to the client. Takes up to 0.1 s and the rest of the present exposure.
  ~EmulatedGigeCamera();
  EmulatedGigeCamera(const EmulatedGigeCamera&) = delete;
  EmulatedGigeCamera& operator=(const EmulatedGigeCamera&) = delete;

  [[nodiscard]] const EmulatedGigeCameraConfig& config() const;
  /// Returns the number of exposures since power-up, including lost exposures.
  [[nodiscard]] std::uint64_t exposures() const;
  /// Returns the number of exposures that were sent as zeros.
  [[nodiscard]] std::uint64_t failed_exposures() const;
  /// Returns the number of non-uniformity corrections since power-up, commanded and automatic.
  [[nodiscard]] std::uint64_t nonuniformity_corrections() const;
  void set_device_temperature_c(double temperature_c);

  /// Loses every packet, including leaders and trailers, with this probability (0 ... 1) from now on. `seed` sets the
  /// process-wide generator of GLib; the pattern is reproducible if no other code in the process uses this generator.
  void set_packet_loss(double probability, std::uint32_t seed);
  /// Makes the next `count` exposures without sending them: a gap of exactly `count` frames.
  void lose_exposures(unsigned count);

 private:
  struct State;
  explicit EmulatedGigeCamera(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Returns the exposure number since power-up of a frame of an emulated camera, computed from the device time of the
/// frame. Precondition: unchanged rate.
[[nodiscard]] std::uint64_t exposure_index(const Frame& frame, double frame_rate_hz);

}  // namespace todbench
