// What emulated video cameras send: the bytes of their frames. Shared by the emulated kernel device and the emulated
// USB device.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "acquisition/pixel_formats/pixel_formats.h"

namespace todbench {

/// Which camera is emulated.
enum class VideoCameraKind {
  y16,               ///< 16-bit counts, little-endian, nothing said about temperature
  y14,               ///< 14-bit counts in two bytes
  grey,              ///< 8-bit counts
  lepton,            ///< PureThermal: Y16 with telemetry rows below the picture; 0.01 K per count
  temperature_rows,  ///< Tiny1 class: YUYV, an 8-bit picture above 16-bit temperatures, 1/64 K per count
};

struct VideoCameraConfig {
  VideoCameraKind kind = VideoCameraKind::lepton;
  std::string vendor = "todbench", model = "Emulated UVC", serial = "TB0001";
  int width = 320, height = 240;  ///< of the picture
  double frame_rate_hz = 50;      ///< at power-up; 0.1 ... 1000
  int nuc_freeze_frames = 0;      ///< how long the last picture is repeated after a correction
  int short_frame_interval = 0;   ///< every so manieth exposure is sent with half its bytes, not marked; 0: none
};

/// Whether this exposure since power-up is one that is sent with half its bytes.
[[nodiscard]] bool arrives_short(const VideoCameraConfig& config, std::uint64_t exposure);

/// Errors: `invalid_input` for geometry (8 ... 4096, even), rate, or a serial number that is no printable ASCII.
[[nodiscard]] Result<void> validate(const VideoCameraConfig& config);

/// 0 where the camera does not tell its scale.
[[nodiscard]] double kelvin_per_count(VideoCameraKind kind);
[[nodiscard]] int significant_bits(VideoCameraKind kind);

/// USB vendor and product of the camera that is emulated; of a plain one the pair that is reserved for prototypes.
struct UsbIdentity {
  std::uint16_t vendor = 0, product = 0;
};
[[nodiscard]] UsbIdentity usb_identity(VideoCameraKind kind);

/// A format on the wire, and the sizes that it is offered in, the one to measure last.
struct VideoWireFormat {
  PixelFormat pixels = PixelFormat::mono16;
  std::vector<cv::Size> sizes;
  [[nodiscard]] std::uint32_t fourcc() const { return fourcc_code(pixels); }
  [[nodiscard]] int bytes_per_pixel() const { return facts_of(pixels).bytes_per_pixel; }
};
[[nodiscard]] VideoWireFormat wire_format(const VideoCameraConfig& config);

/// What the camera says of itself beside the picture.
struct VideoCameraState {
  std::uint64_t exposure = 0;  ///< since power-up
  bool correcting = false;
  std::uint64_t last_correction = 0;  ///< exposure of the last correction; 0: none
};

/// The bytes of a frame in one of the sizes of wire_format(). Precondition: the picture has the configured geometry.
[[nodiscard]] std::vector<std::uint8_t> wire_frame(const VideoCameraConfig& config, const cv::Mat1w& counts,
                                                   cv::Size size, const VideoCameraState& state);

}  // namespace todbench
