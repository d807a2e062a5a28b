#include "acquisition/v4l2/video_layout.h"

#include <algorithm>

#include "acquisition/pixel_formats/pixel_formats.h"

namespace todbench {
namespace {

constexpr std::uint32_t big_endian_bit = 1U << 31U;
constexpr double tiny1_kelvin_per_count = 1.0 / 64;

bool offered(const std::vector<VideoMode>& modes, const VideoMode& mode) {
  return std::find(modes.begin(), modes.end(), mode) != modes.end();
}

/// How a mode is read, or nothing when it cannot be measured.
std::optional<VideoLayout> layout_of(const VideoMode& mode, const std::vector<VideoMode>& modes, VideoFamily family) {
  if (mode.width < 1 || mode.height < 1) return std::nullopt;
  VideoLayout layout;
  layout.mode = mode;
  layout.picture = {0, 0, mode.width, mode.height};
  layout.row_bytes = 2 * static_cast<std::size_t>(mode.width);
  const auto format = format_of_fourcc(mode.fourcc);
  if (!format) return std::nullopt;
  if (format->format == PixelFormat::yuyv) {
    // The same cameras offer their picture alone, which is wider than high; the double one is higher than wide.
    if (family != VideoFamily::temperature_rows || mode.height % 2 != 0 || mode.height <= mode.width)
      return std::nullopt;
    layout.picture = {0, mode.height / 2, mode.width, mode.height / 2};
    layout.kelvin_per_count = tiny1_kelvin_per_count;
    layout.pixel_format = "Mono16";
    return layout;
  }
  layout.significant_bits = significant_bits(format->format);
  if (format->format == PixelFormat::mono8) layout.row_bytes = static_cast<std::size_t>(mode.width);
  layout.pixel_format = to_string(format->format);
  const int rows = lepton_telemetry_rows(mode.width);
  if (family == VideoFamily::lepton && mode.height > rows &&
      offered(modes, {mode.fourcc, mode.width, mode.height - rows})) {
    layout.picture.height -= rows;
    layout.telemetry_rows = rows;
  }
  return layout;
}

/// Which of two layouts carries more.
bool is_better(const VideoLayout& a, const VideoLayout& b) {
  if (a.significant_bits != b.significant_bits) return a.significant_bits > b.significant_bits;
  if (a.picture.area() != b.picture.area()) return a.picture.area() > b.picture.area();
  return a.telemetry_rows > b.telemetry_rows;
}

/// Rows as counts, in the format of the frame; rows below a picture for people are 16 bits, low byte first.
Result<cv::Mat1w> read_rows(std::span<const std::uint8_t> bytes, const VideoLayout& layout, RowSection rows) {
  if (rows.count == 0) return cv::Mat1w();
  auto format = format_of_fourcc(layout.mode.fourcc);
  if (!format) return fail(ErrorCode::invalid_input, "no counts in " + fourcc_text(layout.mode.fourcc));
  if (format->format == PixelFormat::yuyv) format = FourccFormat{PixelFormat::mono16, ByteOrder::little_endian};
  const auto section = section_bytes(bytes, layout.row_bytes, rows);
  if (!section) return tl::unexpected(section.error());
  return decode_pixels(*section, {.format = format->format,
                                  .order = format->order,
                                  .width = layout.mode.width,
                                  .height = rows.count,
                                  .row_bytes = layout.row_bytes});
}

}  // namespace

VideoFamily video_family(std::uint16_t usb_vendor, std::uint16_t usb_product) {
  if (usb_vendor == 0x1e4e && usb_product == 0x0100) return VideoFamily::lepton;
  if (usb_vendor == 0x0bda && (usb_product == 0x5830 || usb_product == 0x5840)) return VideoFamily::temperature_rows;
  return VideoFamily::plain;
}

std::string fourcc_text(std::uint32_t code) {
  std::string text;
  for (unsigned shift = 0; shift < 32; shift += 8) {
    const auto c = static_cast<char>(code >> shift & 0x7FU);
    text += c >= ' ' && c <= '~' ? c : '?';
  }
  return (code & big_endian_bit) != 0 ? text + "-BE" : text;
}

Result<VideoLayout> choose_layout(const std::vector<VideoMode>& modes, VideoFamily family, const std::string& wanted) {
  std::optional<VideoLayout> best;
  std::string seen;
  for (const auto& mode : modes) {
    seen += (seen.empty() ? "" : ", ") + fourcc_text(mode.fourcc) + " " + std::to_string(mode.width) + "x" +
            std::to_string(mode.height);
    const auto layout = layout_of(mode, modes, family);
    if (!layout || (!wanted.empty() && layout->pixel_format != wanted)) continue;
    if (!best || is_better(*layout, *best)) best = layout;
  }
  if (best) return *best;
  return fail(ErrorCode::not_found, (wanted.empty() ? std::string("no usable pixel format") : "no format " + wanted) +
                                        "; the camera offers " + (seen.empty() ? "none" : seen));
}

Result<VideoPicture> read_video_frame(std::span<const std::uint8_t> bytes, const VideoLayout& layout) {
  const std::size_t rows = layout.row_bytes * static_cast<std::size_t>(std::max(layout.mode.height, 0));
  if (bytes.size() > rows && bytes.size() != rows + layout.filler_bytes) {
    return fail(ErrorCode::invalid_input,
                std::to_string(bytes.size()) + " bytes for rows of " + std::to_string(rows) + " bytes");
  }
  auto counts = read_rows(bytes, layout, {layout.picture.y, layout.picture.height});
  if (!counts) return tl::unexpected(counts.error());
  const auto telemetry = read_rows(bytes, layout, {layout.picture.y + layout.picture.height, layout.telemetry_rows});
  if (!telemetry) return tl::unexpected(telemetry.error());
  VideoPicture picture{.counts = *counts, .telemetry = std::nullopt};
  if (!telemetry->empty()) picture.telemetry = parse_lepton_telemetry({telemetry->ptr<ushort>(), telemetry->total()});
  return picture;
}

}  // namespace todbench
