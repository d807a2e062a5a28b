// SPDX-License-Identifier: GPL-3.0-or-later
// PNG of 16-bit grey through libpng.
#include <png.h>

#include <csetjmp>
#include <cstring>
#include <string>
#include <vector>

#include "acquisition/compression/compressed_picture.h"

namespace todbench {
namespace {

/// Bytes that libpng has not read yet.
struct Unread {
  std::string_view bytes;
};

void take_bytes(png_structp png, png_bytep data, std::size_t count) {
  auto& unread = *static_cast<Unread*>(png_get_io_ptr(png));
  if (count > unread.bytes.size()) png_error(png, "it is truncated");
  std::memcpy(data, unread.bytes.data(), count);
  unread.bytes.remove_prefix(count);
}

[[noreturn]] void complain(png_structp png, const char* message) {
  *static_cast<std::string*>(png_get_error_ptr(png)) = message;
  png_longjmp(png, 1);
}

void ignore_warning(png_structp, const char*) {}

/// What the header of the picture states.
struct PngHeader {
  png_uint_32 width = 0, height = 0;
  int bits = 0, colours = 0;
};

// No local object of these two functions has a destructor, because libpng leaves by longjmp.

bool read_header(png_structp png, png_infop info, PngHeader& header) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_read_info(png, info);
  png_get_IHDR(png, info, &header.width, &header.height, &header.bits, &header.colours, nullptr, nullptr, nullptr);
  return true;
}

bool read_rows(png_structp png, png_bytepp rows) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_swap(png);  // the file has the high byte first
  png_read_image(png, rows);
  return true;
}

Result<cv::Mat1w> decoded(png_structp png, png_infop info, cv::Size expected, const std::string& message) {
  PngHeader header;
  if (!read_header(png, info, header))
    return fail(ErrorCode::invalid_input, "the PNG picture cannot be decoded: " + message);
  if (header.width != static_cast<png_uint_32>(expected.width) ||
      header.height != static_cast<png_uint_32>(expected.height) || header.bits != 16 ||
      header.colours != PNG_COLOR_TYPE_GRAY) {
    return fail(ErrorCode::invalid_input, "the PNG picture is " + std::to_string(header.width) + " x " +
                                              std::to_string(header.height) + " of " + std::to_string(header.bits) +
                                              " bits and colour type " + std::to_string(header.colours) +
                                              ", expected " + std::to_string(expected.width) + " x " +
                                              std::to_string(expected.height) + " of 16-bit grey");
  }
  cv::Mat1w counts(expected);
  std::vector<png_bytep> rows;
  for (int y = 0; y < counts.rows; ++y) rows.push_back(counts.ptr(y));
  if (!read_rows(png, rows.data()))
    return fail(ErrorCode::invalid_input, "the PNG picture cannot be decoded: " + message);
  return counts;
}

}  // namespace

Result<cv::Mat1w> decode_png(std::string_view bytes, cv::Size expected) {
  if (expected.width < 1 || expected.height < 1 ||
      static_cast<std::size_t>(expected.width) * static_cast<std::size_t>(expected.height) > most_compressed_pixels)
    return fail(ErrorCode::invalid_input, "a compressed picture of this size is too large");
  std::string message;
  Unread unread{bytes};
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &message, complain, ignore_warning);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  Result<cv::Mat1w> counts = fail(ErrorCode::internal, "no memory for a PNG decoder");
  if (info != nullptr) {
    png_set_read_fn(png, &unread, take_bytes);
    png_set_crc_action(png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    counts = decoded(png, info, expected, message);
  }
  png_destroy_read_struct(&png, &info, nullptr);
  return counts;
}

}  // namespace todbench
