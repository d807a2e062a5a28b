// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/tiff_file.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <opencv2/core/utility.hpp>
#include <string_view>
#include <system_error>

#include "acquisition/base/safe_file.h"
#include "acquisition/base/try.h"

namespace todbench {
namespace {

/// Fits a row of 65535 pixels and the tables of a page many times; a file that needs more is broken or hostile.
constexpr tmsize_t most_memory = tmsize_t{256} << 20;

/// Keeps the first message of libtiff about one file.
int keep_message(TIFF*, void* user, const char* /*module*/, const char* format, va_list arguments) {
  auto& message = *static_cast<std::string*>(user);
  if (message.empty()) {
    char text[200];  // libtiff passes formats of printf
    std::vsnprintf(text, sizeof text, format, arguments);
    message = text;
  }
  return 1;
}

int keep_quiet(TIFF*, void*, const char*, const char*, va_list) {
  return 1;
}

/// Largest expansion of a byte by libtiff's lossless compressions.
constexpr std::uint64_t most_expansion = 4096;

}  // namespace

TiffFile::TiffFile(const std::filesystem::path& path, const char* mode) {
  TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
  TIFFOpenOptionsSetMaxSingleMemAlloc(options, most_memory);
  TIFFOpenOptionsSetErrorHandlerExtR(options, keep_message, &message_);
  TIFFOpenOptionsSetWarningHandlerExtR(options, keep_quiet, nullptr);
  // libtiff closes the descriptor with the file, but leaves it open if it refuses the file.
  const int descriptor = open_to_read(path).value_or(-1);
  if (descriptor >= 0) tiff_.reset(TIFFFdOpenExt(descriptor, path.c_str(), mode, options));
  if (descriptor >= 0 && !tiff_) ::close(descriptor);
  TIFFOpenOptionsFree(options);
  std::error_code unknown;
  const auto bytes = std::filesystem::file_size(path, unknown);
  if (!unknown) size_bytes_ = bytes;
}

TiffPage page_of(const TiffFile& file) {
  TiffPage page;
  TIFFGetField(file.get(), TIFFTAG_IMAGEWIDTH, &page.width);
  TIFFGetField(file.get(), TIFFTAG_IMAGELENGTH, &page.height);
  TIFFGetFieldDefaulted(file.get(), TIFFTAG_BITSPERSAMPLE, &page.bits);
  TIFFGetFieldDefaulted(file.get(), TIFFTAG_SAMPLESPERPIXEL, &page.samples);
  TIFFGetFieldDefaulted(file.get(), TIFFTAG_SAMPLEFORMAT, &page.kind);
  TIFFGetFieldDefaulted(file.get(), TIFFTAG_ORIENTATION, &page.orientation);
  TIFFGetFieldDefaulted(file.get(), TIFFTAG_COMPRESSION, &page.compression);
  TIFFGetField(file.get(), TIFFTAG_PHOTOMETRIC, &page.photometric);
  return page;
}

Result<void> check_layout(const TiffPage& page) {
  if (page.photometric != PHOTOMETRIC_MINISBLACK && page.photometric != PHOTOMETRIC_MINISWHITE) {
    return fail(ErrorCode::invalid_input, "the tag PhotometricInterpretation is " + std::to_string(page.photometric) +
                                              ", expected 0 or 1 (grey levels)");
  }
  if (page.orientation < ORIENTATION_TOPLEFT || page.orientation > ORIENTATION_LEFTBOT)
    return fail(ErrorCode::invalid_input,
                "the tag Orientation is " + std::to_string(page.orientation) + ", expected 1 ... 8");
  return {};
}

Result<void> check_extent(const TiffFile& file) {
  TIFF* const tiff = file.get();
  const TiffPage page = page_of(file);
  const bool tiled = TIFFIsTiled(tiff) != 0;
  std::uint32_t strip_rows = 0;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_ROWSPERSTRIP, &strip_rows);
  const std::uint32_t count = tiled ? TIFFNumberOfTiles(tiff) : TIFFNumberOfStrips(tiff);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint64_t begin = TIFFGetStrileOffset(tiff, i);
    std::uint64_t bytes = TIFFGetStrileByteCount(tiff, i);
    if (page.compression == COMPRESSION_NONE) {
      // Some programs state one strip that reaches to the end of the file or has no length: only its pixels are read.
      const std::uint64_t first_row = std::uint64_t{i} * strip_rows;
      const std::uint64_t rows =
          std::min<std::uint64_t>(strip_rows, page.height - std::min<std::uint64_t>(first_row, page.height));
      const std::uint64_t pixels =
          tiled ? TIFFTileSize64(tiff) : TIFFVStripSize64(tiff, static_cast<std::uint32_t>(rows));
      bytes = bytes == 0 ? pixels : std::min(bytes, pixels);
    }
    if (begin > file.size_bytes() || bytes > file.size_bytes() - begin) {
      return fail(ErrorCode::invalid_input, "the file is truncated: its pixels reach to byte " +
                                                std::to_string(begin + bytes) + ", but it has " +
                                                std::to_string(file.size_bytes()) + " bytes");
    }
  }
  return {};
}

TiffRows::TiffRows(const TiffFile& file, const TiffPage& page, std::size_t row_bytes)
    : file_(file), page_(page), row_(row_bytes) {
  if (TIFFIsTiled(file.get()) == 0) return;
  TIFFGetField(file.get(), TIFFTAG_TILEWIDTH, &tile_width_);
  TIFFGetField(file.get(), TIFFTAG_TILELENGTH, &tile_height_);
}

Result<void> TiffRows::may_hold() {
  const bool tiled = TIFFIsTiled(file_.get()) != 0;
  const std::uint64_t expansion = page_.compression == COMPRESSION_NONE ? 1 : most_expansion;
  if (page_.compression == COMPRESSION_NONE && !tiled) {
    if (TIFFReadScanline(file_.get(), row_.data(), page_.height - 1, 0) >= 0) return {};
  } else if (row_.size() * static_cast<std::uint64_t>(page_.height) / expansion <= file_.size_bytes()) {
    if (!tiled) return {};
    const std::uint64_t pixel_bytes = row_.size() / page_.width;
    const std::uint64_t tile_bytes = std::uint64_t{tile_width_} * tile_height_ * pixel_bytes;
    const std::uint64_t band_bytes = row_.size() * std::uint64_t{tile_height_};
    const bool fits = tile_bytes > 0 && tile_bytes <= std::uint64_t{most_memory} &&
                      band_bytes <= std::uint64_t{most_memory} && tile_bytes / expansion <= file_.size_bytes();
    if (fits && TIFFTileSize(file_.get()) == static_cast<tmsize_t>(tile_bytes)) return {};
    return fail(ErrorCode::io, file_.why("its tiles have an unexpected size"));
  }
  return fail(ErrorCode::io, file_.why("the picture cannot be read"));
}

/// Fills the band with the tiles that hold the next row.
Result<void> TiffRows::read_tiles() {
  const std::size_t pixel_bytes = row_.size() / page_.width;
  tile_.resize(std::size_t{tile_width_} * tile_height_ * pixel_bytes);
  band_.resize(row_.size() * tile_height_);
  for (std::uint32_t x = 0; x < page_.width; x += tile_width_) {
    if (TIFFReadTile(file_.get(), tile_.data(), x, next_, 0, 0) < 0)
      return fail(ErrorCode::io, file_.why("a tile of the picture cannot be read"));
    const std::size_t used = std::min<std::size_t>(tile_width_, page_.width - x) * pixel_bytes;
    for (std::size_t y = 0; y < tile_height_; ++y) {
      std::memcpy(band_.data() + y * row_.size() + x * pixel_bytes, tile_.data() + y * tile_width_ * pixel_bytes, used);
    }
  }
  return {};
}

Result<const std::vector<char>*> TiffRows::next() {
  if (tile_height_ > 0) {
    const std::size_t row = next_ % tile_height_;
    if (row == 0) {
      TODBENCH_TRY_VOID(read_tiles());
    }
    std::memcpy(row_.data(), band_.data() + row * row_.size(), row_.size());
    ++next_;
    return &row_;
  }
  if (TIFFReadScanline(file_.get(), row_.data(), next_++, 0) < 0)
    return fail(ErrorCode::io, file_.why("the picture cannot be read"));
  return &row_;
}

cv::Mat oriented(const cv::Mat& stored, std::uint16_t orientation) {
  cv::Mat turned = stored;
  if (exchanges_axes(orientation)) turned = stored.t();
  constexpr int rows = 0, columns = 1, both = -1;
  const auto flipped = [&](int axis) {
    cv::Mat out;
    cv::flip(turned, out, axis);
    return out;
  };
  switch (orientation) {
    case ORIENTATION_TOPRIGHT:
    case ORIENTATION_RIGHTTOP:
      return flipped(columns);
    case ORIENTATION_BOTRIGHT:
    case ORIENTATION_RIGHTBOT:
      return flipped(both);
    case ORIENTATION_BOTLEFT:
    case ORIENTATION_LEFTBOT:
      return flipped(rows);
    default:
      return turned;
  }
}

Result<std::optional<ImageJStack>> image_j_stack(const TiffFile& file, std::uint64_t directories) {
  const char* description = nullptr;
  if (TIFFGetField(file.get(), TIFFTAG_IMAGEDESCRIPTION, &description) == 0 || description == nullptr)
    return std::nullopt;
  const std::string_view text = description;
  constexpr std::string_view key = "\nimages=";
  const std::size_t at = text.find(key);
  if (!text.starts_with("ImageJ=") || at == std::string_view::npos) return std::nullopt;
  ImageJStack stack;
  const char* first = text.data() + at + key.size();
  if (std::from_chars(first, text.data() + text.size(), stack.images).ec != std::errc())
    return fail(ErrorCode::invalid_input, "the ImageJ description in the file states no number of images");
  if (stack.images <= 1 || stack.images == directories) return std::nullopt;
  const auto wrong = [&](const std::string& why) {
    return fail(ErrorCode::invalid_input,
                "ImageJ states " + std::to_string(stack.images) + " images in this file, " + why);
  };
  if (directories != 1) return wrong("but it has " + std::to_string(directories) + " pages");
  const TiffPage page = page_of(file);
  if (page.compression != COMPRESSION_NONE) return wrong("but its only page is compressed");
  std::uint64_t* offsets = nullptr;
  if (TIFFGetField(file.get(), TIFFTAG_STRIPOFFSETS, &offsets) == 0 || offsets == nullptr)
    return wrong("but the offset of the first one is missing");
  stack.offset = offsets[0];
  const std::uint64_t image_bytes = std::uint64_t{page.width} * page.height * (page.bits / 8U) * page.samples;
  const std::uint64_t room = file.size_bytes() > stack.offset ? file.size_bytes() - stack.offset : 0;
  if (image_bytes == 0 || stack.images > room / image_bytes) return wrong("but the file is too short for them");
  return stack;
}

}  // namespace todbench
