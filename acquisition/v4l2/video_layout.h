// SPDX-License-Identifier: GPL-3.0-or-later
// Meaning of the rows of a video frame. There are three layouts: only a picture; a display picture above temperatures;
// telemetry above or below a picture. Pure functions over untrusted bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "acquisition/v4l2/lepton_telemetry.h"

namespace todbench {

/// Families of cameras whose rows have a meaning that the four-character code does not define.
enum class VideoFamily {
  plain,             ///< every row is picture
  temperature_rows,  ///< InfiRay Tiny1 class: YUYV whose lower half contains temperatures, 1/64 K per count
  lepton,            ///< PureThermal: Y16; telemetry rows below the picture if the frame size includes them
  boson,             ///< FLIR Boson: Y16 of 640x512 or 320x256; telemetry rows above or below the picture if enabled
};

/// Returns the family of a USB camera: PureThermal 1e4e:0100; Boson 09cb:4007; Tiny1 class 0bda:5830 and 0bda:5840
/// (InfiRay P2 Pro, Topdon TC001).
[[nodiscard]] VideoFamily video_family(std::uint16_t usb_vendor, std::uint16_t usb_product);

/// A format and size that a camera offers.
struct VideoMode {
  std::uint32_t fourcc = 0;
  int width = 0, height = 0;
  bool operator==(const VideoMode&) const = default;
};

/// Interpretation of the frames of a mode.
struct VideoLayout {
  VideoMode mode;
  std::size_t row_bytes = 0;     ///< distance between rows, as the driver reports
  std::size_t filler_bytes = 0;  ///< after the last row, from a driver that transfers whole pages
  std::string pixel_format;      ///< PFNC name of the counts
  int significant_bits = 16;
  cv::Rect picture;        ///< rows that contain counts
  int telemetry_rows = 0;  ///< telemetry rows of a Lepton below the picture
  /// Number of rows that do not belong to the picture, all above or all below it. If it is not 0, `picture` begins at
  /// the first row that may belong to the picture. The position of the other rows is determined in each frame, because
  /// these rows differ more from their neighbours than rows of the picture.
  int foreign_rows = 0;
  double kelvin_per_count = 0;  ///< 0: the family does not report it
};

/// Maximum number of additional rows that are interpreted as telemetry if a camera has two modes of the same width and
/// different heights. Telemetry of the Boson and the Tau has up to 4 rows.
inline constexpr int most_foreign_rows = 4;

/// The user's choice of a mode; empty members are chosen automatically.
struct WantedLayout {
  std::string pixel_format{};       ///< PFNC name: "Mono16", "Mono14", "Mono8"
  std::optional<cv::Size> frame{};  ///< size of the mode, telemetry rows included
};

/// Chooses the best mode: 16 bits before 14, 12, 10 and 8; then the largest picture. For a Lepton, modes with telemetry
/// rows are preferred; for other cameras, modes without. If two modes have the same format and width, and the heights
/// differ by up to four rows, the additional rows are telemetry. YUYV of a camera without temperature rows is a display
/// picture and cannot be measured. Error: `not_found` with the camera's modes.
[[nodiscard]] Result<VideoLayout> choose_layout(const std::vector<VideoMode>& modes, VideoFamily family,
                                                const WantedLayout& wanted);

/// A decoded frame.
struct VideoPicture {
  cv::Mat1w counts;
  bool begins_in_the_middle = false;  ///< the two halves of a frame with temperature rows are at wrong positions
  std::optional<LeptonTelemetry> telemetry;
};

/// Decodes counts and telemetry of one frame. Error: `invalid_input` if the number of bytes differs from the layout.
/// With more bytes than expected, rows may be longer than the driver reports or additional rows may exist, so the
/// position of every pixel is uncertain.
[[nodiscard]] Result<VideoPicture> read_video_frame(std::span<const std::uint8_t> bytes, const VideoLayout& layout);

/// Returns a text for messages: "Y16 ", "YUYV", "Y16 -BE".
[[nodiscard]] std::string fourcc_text(std::uint32_t fourcc);

}  // namespace todbench
