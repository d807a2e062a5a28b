// SPDX-License-Identifier: GPL-3.0-or-later
// Bytes of the frames of emulated video cameras, for the emulated kernel device and the emulated USB device.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "acquisition/pixel_formats/pixel_formats.h"

namespace todbench {

/// Kind of the emulated camera.
enum class VideoCameraKind {
  y16,     ///< 16-bit counts, little-endian, temperature not stated
  y14,     ///< 14-bit counts in two bytes
  grey,    ///< 8-bit counts
  lepton,  ///< PureThermal: Y16 with telemetry rows below the picture; 0.01 K per count
  boson,   ///< Y16, without or with two telemetry rows below the picture; the format with telemetry is listed first
  temperature_rows,  ///< Tiny1 class: YUYV, an 8-bit picture above 16-bit temperatures, 1/64 K per count
};

/// Configuration of the camera.
struct VideoCameraConfig {
  VideoCameraKind kind = VideoCameraKind::lepton;
  std::string vendor = "todbench", model = "Emulated UVC", serial = "TB0001";
  int width = 320, height = 240;  ///< size of the picture
  double frame_rate_hz = 50;      ///< frame rate at power-up; 0.1 ... 1000
  int nuc_freeze_frames = 0;      ///< frames for which the last picture is repeated after a correction
  int empty_first_frames = 0;     ///< first frames of the camera since power-up that are all zeros, including telemetry
  int short_frame_interval = 0;   ///< every n-th exposure is sent with half its bytes and without a mark; 0: none
};

/// Returns whether this exposure since power-up is sent with half its bytes.
[[nodiscard]] bool arrives_short(const VideoCameraConfig& config, std::uint64_t exposure);

/// Checks a configuration. Errors: `invalid_input` (geometry outside 8 ... 4096 or odd, rate, a serial number that is
/// not printable ASCII).
[[nodiscard]] Result<void> validate(const VideoCameraConfig& config);

/// Returns the scale in K per count; 0 if the camera does not state it.
[[nodiscard]] double kelvin_per_count(VideoCameraKind kind);
/// Returns the number of significant bits of a count.
[[nodiscard]] int significant_bits(VideoCameraKind kind);

/// USB vendor and product of the emulated camera. Plain kinds have the pair that is reserved for prototypes.
struct UsbIdentity {
  std::uint16_t vendor = 0, product = 0;
};
/// Returns vendor and product of a kind of camera.
[[nodiscard]] UsbIdentity usb_identity(VideoCameraKind kind);

/// Pixel format on the wire and the offered frame sizes; the last size is the size for measurements.
struct VideoWireFormat {
  PixelFormat pixels = PixelFormat::mono16;
  std::vector<cv::Size> sizes;
  [[nodiscard]] std::uint32_t fourcc() const { return fourcc_code(pixels); }
  [[nodiscard]] int bytes_per_pixel() const { return facts_of(pixels).bits_per_pixel / 8; }
};
/// Returns the format of a camera.
[[nodiscard]] VideoWireFormat wire_format(const VideoCameraConfig& config);

/// State of the camera that it reports with a picture.
struct VideoCameraState {
  std::uint64_t exposure = 0;         ///< number of the exposure since power-up
  bool correcting = false;            ///< whether a non-uniformity correction is in progress
  std::uint64_t last_correction = 0;  ///< exposure of the last correction; 0: none
};

/// Returns the bytes of a frame in one of the sizes of wire_format(). Precondition: the picture has the configured
/// geometry.
[[nodiscard]] std::vector<std::uint8_t> wire_frame(const VideoCameraConfig& config, const cv::Mat1w& counts,
                                                   cv::Size size, const VideoCameraState& state);

}  // namespace todbench
