// SPDX-License-Identifier: GPL-3.0-or-later
// An open TIFF file and the messages of libtiff.
#pragma once

#include <tiffio.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// An open TIFF file. Not movable, because libtiff keeps the address of the message. One thread at a time.
class TiffFile {
 public:
  /// `mode`: a reading mode of TIFFOpen(). Pipes and devices are not opened.
  TiffFile(const std::filesystem::path& path, const char* mode);
  TiffFile(const TiffFile&) = delete;
  TiffFile& operator=(const TiffFile&) = delete;

  /// Null if the file could not be opened.
  [[nodiscard]] TIFF* get() const { return tiff_.get(); }
  /// Returns the first message of libtiff; `otherwise` if there is none.
  [[nodiscard]] std::string why(const char* otherwise) const { return message_.empty() ? otherwise : message_; }
  void close() { tiff_.reset(); }
  /// Returns the size of the file in bytes; 0: unknown.
  [[nodiscard]] std::uint64_t size_bytes() const { return size_bytes_; }

 private:
  struct Close {
    void operator()(TIFF* tiff) const { TIFFClose(tiff); }
  };
  std::string message_;  ///< outlives tiff_
  std::unique_ptr<TIFF, Close> tiff_;
  std::uint64_t size_bytes_ = 0;
};

/// Tags of a page (`samples`: number per pixel; `kind`: SampleFormat); an absent tag has libtiff's default, or 0.
struct TiffPage {
  std::uint32_t width = 0, height = 0;
  std::uint16_t bits = 1, samples = 1, kind = SAMPLEFORMAT_UINT;
  std::uint16_t orientation = ORIENTATION_TOPLEFT, photometric = PHOTOMETRIC_MINISBLACK, compression = COMPRESSION_NONE;

  /// Returns whether both sides are 1 ... 65535.
  [[nodiscard]] bool has_size() const { return width >= 1 && height >= 1 && width <= 65535 && height <= 65535; }
  [[nodiscard]] bool white_is_zero() const { return photometric == PHOTOMETRIC_MINISWHITE; }
};
/// Reads the tags of the current page.
[[nodiscard]] TiffPage page_of(const TiffFile& file);

/// Checks that the page contains grey levels and a valid tag Orientation; colour tables are refused. Error:
/// `invalid_input`.
[[nodiscard]] Result<void> check_layout(const TiffPage& page);

/// Checks that all strips or tiles of the current page lie inside the file. A file that was truncated after its
/// directory is found here, before its pixels are read. Error: `invalid_input`.
[[nodiscard]] Result<void> check_extent(const TiffFile& file);

/// Reads the rows of the current page in file order, from the top, each `row_bytes` long, from strips or tiles. Rows of
/// a compressed strip can only be read in order. A page that states more data than its file can hold is refused before
/// memory is allocated: libtiff's lossless compressions expand a byte to at most 4096 bytes. Errors: `io`.
class TiffRows {
 public:
  TiffRows(const TiffFile& file, const TiffPage& page, std::size_t row_bytes);
  [[nodiscard]] Result<void> may_hold();
  /// Returns the next row; valid until the next call.
  [[nodiscard]] Result<const std::vector<char>*> next();

 private:
  [[nodiscard]] Result<void> read_tiles();

  const TiffFile& file_;
  TiffPage page_;
  std::vector<char> row_;
  std::uint32_t next_ = 0;
  std::uint32_t tile_width_ = 0, tile_height_ = 0;  ///< 0: strips
  std::vector<char> tile_, band_;                   ///< one tile; the rows of all tiles side by side
};

/// Rotates the picture as its tag Orientation requires: row 0 at the top, column 0 at the left. Orientations 5 to 8
/// exchange rows and columns.
[[nodiscard]] cv::Mat oriented(const cv::Mat& stored, std::uint16_t orientation);
[[nodiscard]] constexpr bool exchanges_axes(std::uint16_t orientation) {
  return orientation >= ORIENTATION_LEFTTOP;
}

/// Consecutive pictures of ImageJ that share one directory ("images=N" in the description).
struct ImageJStack {
  std::uint64_t images = 0;
  std::uint64_t offset = 0;  ///< position of the first pixel in the file
};
/// Reads the stack of the first page. Empty if the file states no number of images, or 1, or as many images as it has
/// pages (`directories`). Error: `invalid_input` (an unreadable number, or not the stated number of images).
[[nodiscard]] Result<std::optional<ImageJStack>> image_j_stack(const TiffFile& file, std::uint64_t directories);

}  // namespace todbench
