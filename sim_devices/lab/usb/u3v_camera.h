// SPDX-License-Identifier: GPL-3.0-or-later
// Emulated USB3 Vision camera: a USB device with GenCP control, bootstrap registers, a GenICam description and a
// stream. PluggedUsbDevice or a USB/IP server connects the camera to a host.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "acquisition/base/result.h"
#include "acquisition/core/frame.h"
#include "sim_devices/lab/usb/usb_device.h"

namespace todbench {

/// Format of the GenICam description of the camera. Clients must support both formats.
enum class U3vDescription { plain, zipped };

/// Location of the identity of the camera.
enum class U3vIdentityNodes {
  present,  ///< the bootstrap registers and the description state the identity
  absent,   ///< only the bootstrap registers state the identity
};

/// Configuration of the camera.
struct U3vCameraConfig {
  std::string vendor = "todbench", model = "Emulated U3V", serial = "TB0001", firmware = "1.0";
  int width = 320, height = 240;
  int significant_bits = 14;                     ///< pixel formats: 14 offers Mono14 first, 15 and 16 Mono16
  double frame_rate_hz = 50;                     ///< frame rate at power-up; 0.1 ... 1000
  double kelvin_per_count = 0.01, offset_k = 0;  ///< scale of the counts; temperature of count 0
  int nuc_freeze_frames = 0;                     ///< frames for which the last picture is repeated after a correction
  U3vDescription description = U3vDescription::plain;
  std::string description_text = {};           ///< the served description; empty: the camera's own
  std::uint64_t stated_description_bytes = 0;  ///< size of the description that the camera states; 0: the true size
  U3vIdentityNodes identity_nodes = U3vIdentityNodes::present;
  std::optional<std::string> usb_serial{};  ///< serial number in the USB descriptors if it differs from `serial`
  int row_padding_bytes = 0;                ///< bytes after every row, counted in the payload size
  bool states_padding = true;               ///< whether the leader of a frame states the row padding
  /// Wrong contents of the stream registers at power-up: value by address of a 32-bit register.
  std::map<std::uint64_t, std::uint32_t> false_registers{};
};

/// Camera that exposes only when the host requests data, at the earliest one frame period after the previous exposure.
/// A slow host therefore loses no frames. The camera's clock advances by one frame period per exposure from power-up:
/// exposure k at an unchanged rate f has device_time_ns = (k + 1) 10^9 / f. Methods may be called from any thread.
class U3vCamera : public UsbDevice {
 public:
  /// Returns picture number `index`, counted from 0 at power-up over all streams, with the configured geometry. Called
  /// on the thread of the stream endpoint.
  using Exposure = std::function<cv::Mat1w(std::uint64_t index)>;

  /// Creates the camera. Errors: `invalid_input` (configuration).
  [[nodiscard]] static Result<std::shared_ptr<U3vCamera>> create(U3vCameraConfig config, Exposure exposure);

  /// Returns the number of exposures since power-up.
  [[nodiscard]] virtual std::uint64_t exposures() const = 0;
  /// Returns the number of non-uniformity corrections since power-up.
  [[nodiscard]] virtual std::uint64_t nonuniformity_corrections() const = 0;
  /// Makes the next `count` exposures without sending them.
  virtual void lose_exposures(unsigned count) = 0;
  /// Sends only the first `bytes` of the next picture.
  virtual void truncate_next_frame(std::size_t bytes) = 0;
  /// Appends this many undeclared bytes to the payload of the next frame.
  virtual void lengthen_next_frame(std::size_t bytes) = 0;
  /// Sets the block id of the next frame, from which later ids count on; the clock is unchanged.
  virtual void restart_numbers(std::uint64_t block_id) = 0;
};

}  // namespace todbench
