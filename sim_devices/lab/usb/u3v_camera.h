// A USB3 Vision camera that exists only as a program: a USB device with GenCP control, bootstrap registers, a GenICam
// description and a stream. PluggedUsbDevice, or a USB/IP server, gives it to a host.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "acquisition/core/frame.h"
#include "acquisition/core/result.h"
#include "sim_devices/lab/usb/usb_device.h"

namespace todbench {

/// How the camera keeps its GenICam description; clients have to cope with both.
enum class U3vDescription { plain, zipped };

/// Where the camera says who it is.
enum class U3vIdentityNodes {
  present,  ///< in its bootstrap registers and in its description
  absent,   ///< in its bootstrap registers only
};

struct U3vCameraConfig {
  std::string vendor = "todbench", model = "Emulated U3V", serial = "TB0001", firmware = "1.0";
  int width = 320, height = 240;
  int significant_bits = 14;  ///< 14 offers Mono14 first, 15 and 16 Mono16
  double frame_rate_hz = 50;  ///< at power-up; 0.1 ... 1000
  double kelvin_per_count = 0.01, offset_k = 0;
  int nuc_freeze_frames = 0;  ///< how long the last picture is repeated after a correction
  U3vDescription description = U3vDescription::plain;
  std::string description_text = {};           ///< what it is; empty: that of the camera
  std::uint64_t stated_description_bytes = 0;  ///< 0: as many as it has
  U3vIdentityNodes identity_nodes = U3vIdentityNodes::present;
  std::optional<std::string> usb_serial{};  ///< of the USB descriptors, where it is not `serial`
  int row_padding_bytes = 0;                ///< sent behind every row, counted in the payload size
  bool states_padding = true;               ///< in the leader
  /// What the stream registers say at power-up instead of the truth: address of a register of 32 bits, value.
  std::map<std::uint64_t, std::uint32_t> false_registers{};
};

/// The camera. It exposes only when the host asks for data, never sooner than a frame period after the exposure before:
/// nothing is lost because a host is slow. Its clock advances by one frame period with every exposure from power-up:
/// exposure k at an undisturbed rate f has device_time_ns = (k + 1) 10^9 / f. Methods may be called from any thread.
class U3vCamera : public UsbDevice {
 public:
  /// Picture number `index`, counted from 0 at power-up over all streams; of the configured geometry. Called on the
  /// thread of the stream endpoint.
  using Exposure = std::function<cv::Mat1w(std::uint64_t index)>;

  /// Errors: `invalid_input` (configuration).
  [[nodiscard]] static Result<std::shared_ptr<U3vCamera>> create(U3vCameraConfig config, Exposure exposure);

  [[nodiscard]] virtual std::uint64_t exposures() const = 0;
  [[nodiscard]] virtual std::uint64_t nonuniformity_corrections() const = 0;
  /// The next `count` exposures happen but are never sent.
  virtual void lose_exposures(unsigned count) = 0;
  /// Of the next frame only the first `bytes` of the picture are sent.
  virtual void truncate_next_frame(std::size_t bytes) = 0;
  /// The next frame has this many bytes behind its payload that nothing speaks of.
  virtual void lengthen_next_frame(std::size_t bytes) = 0;
  /// The next frame has this block id; the clock goes on.
  virtual void restart_numbers(std::uint64_t block_id) = 0;
};

}  // namespace todbench
