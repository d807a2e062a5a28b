// SPDX-License-Identifier: GPL-3.0-or-later
#include <png.h>

#include <csetjmp>
#include <vector>

#include "bench/picture_files/encoded_picture.h"

namespace todbench {
namespace {

void append_bytes(png_structp png, png_bytep data, std::size_t count) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), count);
}

void nothing_to_flush(png_structp) {}

[[noreturn]] void complain(png_structp png, const char* message) {
  *static_cast<std::string*>(png_get_error_ptr(png)) = message;
  png_longjmp(png, 1);
}

void ignore_warning(png_structp, const char*) {}

/// Writes the picture; returns false after an error. No local object has a destructor, because libpng leaves by
/// longjmp.
bool written(png_structp png, png_infop info, const cv::Mat& picture, png_bytepp rows) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  const bool coloured = picture.channels() == 3, wide = picture.depth() == CV_16U;
  png_set_IHDR(png, info, static_cast<png_uint_32>(picture.cols), static_cast<png_uint_32>(picture.rows), wide ? 16 : 8,
               coloured ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  // Noise hardly compresses: the default level takes up to ten times as long for a tenth of the bytes.
  png_set_compression_level(png, 2);
  png_write_info(png, info);
  if (coloured) png_set_bgr(png);
  if (wide) png_set_swap(png);  // the file has the high byte first
  png_write_image(png, rows);
  png_write_end(png, info);
  return true;
}

}  // namespace

Result<std::string> png_of(const cv::Mat& picture) {
  const int type = picture.type();
  if (picture.empty() || (type != CV_8UC1 && type != CV_16UC1 && type != CV_8UC3))
    return fail(ErrorCode::invalid_input, "a PNG needs a grey picture of 8 or 16 bits, or three colours of 8 bits");
  std::string bytes, message;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &message, complain, ignore_warning);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  bool whole = false;
  if (info != nullptr) {
    png_set_write_fn(png, &bytes, append_bytes, nothing_to_flush);
    std::vector<png_bytep> rows;
    for (int y = 0; y < picture.rows; ++y) rows.push_back(const_cast<png_bytep>(picture.ptr(y)));
    whole = written(png, info, picture, rows.data());
  }
  png_destroy_write_struct(&png, &info);
  if (!whole) return fail(ErrorCode::internal, "the picture cannot be encoded as PNG: " + message);
  return bytes;
}

}  // namespace todbench
