// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/v4l2/video_layout.h"

#include <algorithm>
#include <cstdint>

#include "acquisition/base/try.h"
#include "acquisition/core/control_text.h"
#include "acquisition/pixel_formats/pixel_formats.h"

namespace todbench {
namespace {

constexpr std::uint32_t big_endian_bit = 1U << 31U;
constexpr double tiny1_kelvin_per_count = 1.0 / 64;

bool offered(const std::vector<VideoMode>& modes, const VideoMode& mode) {
  return std::find(modes.begin(), modes.end(), mode) != modes.end();
}

/// Rows of one of the two pictures of a Tiny1's double frame: those of the single picture that the camera also offers,
/// otherwise three quarters of its width (256x192, 160x120). The remaining rows of a frame of 386 rows are not picture.
int rows_of_half(const VideoMode& mode, const std::vector<VideoMode>& modes) {
  const auto fits = [&](int rows) {
    const int left = mode.height - 2 * rows;
    return rows >= 1 && left >= 0 && left <= most_foreign_rows;
  };
  for (const VideoMode& single : modes) {
    if (single.fourcc == mode.fourcc && single.width == mode.width && fits(single.height)) return single.height;
  }
  constexpr int least_width = 32;
  if (const int rows = mode.width * 3 / 4; mode.width >= least_width && fits(rows)) return rows;
  return mode.height / 2;
}

/// Number of rows of the mode that exceed those of a picture.
int foreign_rows(const VideoMode& mode, const std::vector<VideoMode>& modes, VideoFamily family) {
  int foreign = 0;
  for (int rows = 1; rows <= most_foreign_rows && rows < mode.height; ++rows) {
    const bool boson = family == VideoFamily::boson && mode.height - rows == mode.width * 4 / 5;
    if (boson || offered(modes, {mode.fourcc, mode.width, mode.height - rows})) foreign = rows;
  }
  return foreign;
}

/// Layout of a mode; empty if it cannot be measured.
std::optional<VideoLayout> layout_of(const VideoMode& mode, const std::vector<VideoMode>& modes, VideoFamily family) {
  if (mode.width < 1 || mode.height < 1) return std::nullopt;
  VideoLayout layout;
  layout.mode = mode;
  layout.picture = {0, 0, mode.width, mode.height};
  layout.row_bytes = 2 * static_cast<std::size_t>(mode.width);
  const auto format = format_of_fourcc(mode.fourcc);
  if (!format) return std::nullopt;
  if (format->format == PixelFormat::yuyv) {
    // These cameras also offer their single picture, which is wider than high; the double one is higher than wide.
    const int rows = rows_of_half(mode, modes);
    layout.foreign_rows = mode.height - 2 * rows;
    if (family != VideoFamily::temperature_rows || mode.height <= mode.width || (layout.foreign_rows & 1) != 0)
      return std::nullopt;
    layout.picture = {0, rows, mode.width, rows};
    layout.kelvin_per_count = tiny1_kelvin_per_count;
    layout.pixel_format = "Mono16";
    return layout;
  }
  layout.significant_bits = significant_bits(format->format);
  if (format->format == PixelFormat::mono8) layout.row_bytes = static_cast<std::size_t>(mode.width);
  layout.pixel_format = to_string(format->format);
  const int rows = lepton_telemetry_rows(mode.width);
  if (family == VideoFamily::lepton) {
    if (mode.height > rows && offered(modes, {mode.fourcc, mode.width, mode.height - rows}))
      layout.telemetry_rows = rows;
  } else {
    layout.foreign_rows = foreign_rows(mode, modes, family);
  }
  layout.picture.height -= layout.telemetry_rows + layout.foreign_rows;
  return layout;
}

/// Whether layout `a` is better than `b`.
bool is_better(const VideoLayout& a, const VideoLayout& b) {
  if (a.significant_bits != b.significant_bits) return a.significant_bits > b.significant_bits;
  const auto pixels = [](cv::Rect area) { return static_cast<std::int64_t>(area.width) * area.height; };
  if (pixels(a.picture) != pixels(b.picture)) return pixels(a.picture) > pixels(b.picture);
  if (a.telemetry_rows != b.telemetry_rows) return a.telemetry_rows > b.telemetry_rows;
  return a.foreign_rows < b.foreign_rows;
}

/// Mean absolute difference of two rows.
double row_difference(const cv::Mat1w& rows, int a, int b) {
  return cv::norm(rows.row(a), rows.row(b), cv::NORM_L1) / rows.cols;
}

/// Removes `foreign` rows at one end: the end whose rows differ more from the picture.
cv::Mat1w without_foreign_rows(const cv::Mat1w& rows, int foreign) {
  if (foreign == 0) return rows;
  const int last = rows.rows - 1;
  const double above = row_difference(rows, foreign - 1, foreign),
               below = row_difference(rows, last - foreign + 1, last - foreign);
  const int first = above > below ? foreign : 0;
  return rows.rowRange(first, first + rows.rows - foreign).clone();
}

/// Whether a frame was begun in mid-picture. The display picture and the temperatures meet at two rows, half a frame
/// apart: at the middle and, across the edge, at the top. There the 16-bit words of neighbouring rows differ by
/// thousands (chroma against the high byte of a temperature, 0x80 against 0x4B at 300 K), elsewhere only by the scene.
/// In a frame begun in mid-picture the largest pair of steps is elsewhere, and twice as large.
bool begins_in_the_middle(const cv::Mat1w& words) {
  constexpr int least_side = 16;  // fewer words are not conclusive
  constexpr double clear = 2, least_step = 1024;
  const int half = words.rows / 2;
  if (words.cols < least_side || half < least_side || words.rows % 2 != 0) return false;
  const auto steps_at = [&](int row) {
    const int other = row + half;
    return row_difference(words, row, row == 0 ? words.rows - 1 : row - 1) + row_difference(words, other, other - 1);
  };
  double largest = 0;
  for (int row = 1; row < half; ++row) largest = std::max(largest, steps_at(row));
  return largest > std::max(least_step, clear * steps_at(0));
}

/// Rows as counts, in the format of the frame; rows below a display picture have 16 bits, low byte first.
Result<cv::Mat1w> read_rows(std::span<const std::uint8_t> bytes, const VideoLayout& layout, RowSection rows) {
  if (rows.count == 0) return cv::Mat1w();
  auto format = format_of_fourcc(layout.mode.fourcc);
  if (!format)
    return fail(ErrorCode::invalid_input, "the format " + fourcc_text(layout.mode.fourcc) + " contains no counts");
  if (format->format == PixelFormat::yuyv) format = FourccFormat{PixelFormat::mono16, ByteOrder::little_endian};
  TODBENCH_TRY(const auto section, section_bytes(bytes, layout.row_bytes, rows));
  return decode_pixels(section, {.format = format->format,
                                 .order = format->order,
                                 .width = layout.mode.width,
                                 .height = rows.count,
                                 .row_bytes = layout.row_bytes});
}

}  // namespace

VideoFamily video_family(std::uint16_t usb_vendor, std::uint16_t usb_product) {
  if (usb_vendor == 0x1e4e && usb_product == 0x0100) return VideoFamily::lepton;
  if (usb_vendor == 0x09cb && usb_product == 0x4007) return VideoFamily::boson;
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

Result<VideoLayout> choose_layout(const std::vector<VideoMode>& modes, VideoFamily family, const WantedLayout& wanted) {
  std::optional<VideoLayout> best;
  std::string seen;
  for (const auto& mode : modes) {
    seen += (seen.empty() ? "" : ", ") + fourcc_text(mode.fourcc) + " " + std::to_string(mode.width) + "x" +
            std::to_string(mode.height);
    const auto layout = layout_of(mode, modes, family);
    if (!layout || (!wanted.pixel_format.empty() && layout->pixel_format != wanted.pixel_format)) continue;
    if (wanted.frame && *wanted.frame != cv::Size(mode.width, mode.height)) continue;
    if (!best || is_better(*layout, *best)) best = layout;
  }
  if (best) return *best;
  std::string missing =
      wanted.pixel_format.empty() ? std::string("no usable pixel format") : "no format " + wanted.pixel_format;
  if (wanted.frame) missing += " of " + frame_size_text(*wanted.frame);
  return fail(ErrorCode::not_found, missing + "; the camera offers " + (seen.empty() ? "none" : seen));
}

Result<VideoPicture> read_video_frame(std::span<const std::uint8_t> bytes, const VideoLayout& layout) {
  const std::size_t rows = layout.row_bytes * static_cast<std::size_t>(std::max(layout.mode.height, 0));
  if (bytes.size() > rows && bytes.size() != rows + layout.filler_bytes) {
    return fail(ErrorCode::invalid_input,
                std::to_string(bytes.size()) + " bytes instead of the " + std::to_string(rows) + " bytes of the rows");
  }
  TODBENCH_TRY(auto counts, read_rows(bytes, layout, {layout.picture.y, layout.picture.height + layout.foreign_rows}));
  TODBENCH_TRY(const auto telemetry,
               read_rows(bytes, layout, {layout.picture.y + layout.picture.height, layout.telemetry_rows}));
  VideoPicture picture{.counts = without_foreign_rows(counts, layout.foreign_rows), .telemetry = std::nullopt};
  // A frame with rows between its halves has no middle to check.
  if (layout.picture.y > 0 && layout.foreign_rows == 0) {
    const auto words = read_rows(bytes, layout, {0, layout.mode.height});
    picture.begins_in_the_middle = words && begins_in_the_middle(*words);
  }
  if (!telemetry.empty()) picture.telemetry = parse_lepton_telemetry({telemetry.ptr<ushort>(), telemetry.total()});
  return picture;
}

}  // namespace todbench
