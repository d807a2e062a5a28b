// What the rows of a video frame mean: all of it a picture, a picture for people above temperatures, or a picture with
// telemetry below. Pure functions over untrusted bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "acquisition/v4l2/lepton_telemetry.h"

namespace todbench {

/// Families of cameras whose rows have a meaning that the four-character code does not tell.
enum class VideoFamily {
  plain,             ///< every row is picture
  temperature_rows,  ///< InfiRay Tiny1 class: YUYV whose lower half is temperature, 1/64 K per count
  lepton,            ///< PureThermal: Y16 with telemetry rows below the picture when that size is chosen
};

/// The family of a USB camera: PureThermal 1e4e:0100; Tiny1 class 0bda:5830 and 0bda:5840 (InfiRay P2 Pro, Topdon
/// TC001).
[[nodiscard]] VideoFamily video_family(std::uint16_t usb_vendor, std::uint16_t usb_product);

/// A format and size that a camera offers.
struct VideoMode {
  std::uint32_t fourcc = 0;
  int width = 0, height = 0;
  bool operator==(const VideoMode&) const = default;
};

/// How a frame of a mode is to be read.
struct VideoLayout {
  VideoMode mode;
  std::size_t row_bytes = 0;     ///< from row to row, as the driver says
  std::size_t filler_bytes = 0;  ///< behind the last row, of a driver that moves whole pages
  std::string pixel_format;      ///< PFNC name of the counts
  int significant_bits = 16;
  cv::Rect picture;             ///< rows that hold counts
  int telemetry_rows = 0;       ///< below the picture
  double kelvin_per_count = 0;  ///< 0: the family does not say
};

/// The mode that carries the most: 16 bits before 14, 12, 10 and 8; with telemetry rows before without; the largest
/// picture. `wanted`: a PFNC name ("Mono16", "Mono14", "Mono8") to choose among; empty: the best. Errors: `not_found`
/// with what the camera offers: YUYV of a camera without temperature rows is a picture for people, nothing to measure.
[[nodiscard]] Result<VideoLayout> choose_layout(const std::vector<VideoMode>& modes, VideoFamily family,
                                                const std::string& wanted);

/// A frame as it was read.
struct VideoPicture {
  cv::Mat1w counts;
  std::optional<LeptonTelemetry> telemetry;
};

/// Counts and telemetry of one frame. `invalid_input` when there are not as many bytes as the layout says: with more,
/// the rows are longer than the driver states, or there are others than it states, and every pixel would be in doubt.
[[nodiscard]] Result<VideoPicture> read_video_frame(std::span<const std::uint8_t> bytes, const VideoLayout& layout);

/// "Y16 ", "YUYV", "Y16 -BE": for messages.
[[nodiscard]] std::string fourcc_text(std::uint32_t fourcc);

}  // namespace todbench
