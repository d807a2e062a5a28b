// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/read_png.h"

#include <png.h>

#include <algorithm>

namespace todbench::testing {
namespace {

struct Source {
  const std::string& bytes;
  std::size_t at = 0;
};

void read_bytes(png_structp png, png_bytep to, std::size_t count) {
  auto& source = *static_cast<Source*>(png_get_io_ptr(png));
  if (source.at + count > source.bytes.size()) png_error(png, "the file ends early");
  std::copy_n(source.bytes.data() + source.at, count, reinterpret_cast<char*>(to));
  source.at += count;
}

}  // namespace

cv::Mat read_png(const std::string& bytes) {
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  Source source{bytes};
  png_set_read_fn(png, &source, read_bytes);
  png_read_png(png, info, PNG_TRANSFORM_SWAP_ENDIAN | PNG_TRANSFORM_BGR, nullptr);
  const int depth = png_get_bit_depth(png, info) == 16 ? CV_16U : CV_8U;
  cv::Mat out;
  if (png_get_valid(png, info, PNG_INFO_gAMA) == 0) {
    out.create(static_cast<int>(png_get_image_height(png, info)), static_cast<int>(png_get_image_width(png, info)),
               CV_MAKETYPE(depth, png_get_channels(png, info)));
    const png_bytepp rows = png_get_rows(png, info);
    for (int y = 0; y < out.rows; ++y) std::copy_n(rows[y], png_get_rowbytes(png, info), out.ptr(y));
  }
  png_destroy_read_struct(&png, &info, nullptr);
  return out;
}

}  // namespace todbench::testing
