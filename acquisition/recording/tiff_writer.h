// SPDX-License-Identifier: GPL-3.0-or-later
// Writes 16-bit pages to a TIFF file that is readable at any moment.
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>

#include "acquisition/recording/written_file.h"

namespace todbench {

/// Appends pages, uncompressed, little-endian, BigTIFF (no limit of 4 GiB). The preceding page refers to a page only
/// after pixels and directory of this page are completely in the file. If the program is killed or the disk is full,
/// the file is therefore readable up to its last complete page. Move-only, one thread at a time. Errors: `io` with the
/// path; an incomplete page is then truncated, and later pages are refused.
class TiffWriter {
 public:
  [[nodiscard]] static Result<TiffWriter> create(const std::filesystem::path& path);

  /// Appends one page; `invalid_input` for an empty picture.
  [[nodiscard]] Result<void> append(const cv::Mat1w& counts);
  /// Waits until everything is on the disk and reads the file again. Returns the number of pages found, 0 for a file
  /// without pages (not a valid TIFF). Fails if this differs from the number appended.
  [[nodiscard]] Result<std::uint64_t> verified_pages();

  [[nodiscard]] std::uint64_t pages() const { return pages_; }

 private:
  explicit TiffWriter(WrittenFile file) : file_(std::move(file)) {}
  [[nodiscard]] Result<void> append_page(const cv::Mat1w& counts);

  WrittenFile file_;
  std::uint64_t pages_ = 0;
  std::uint64_t link_offset_ = 0;  ///< position in the file that receives the offset of the next directory
  bool broken_ = false;            ///< writing a page failed
};

}  // namespace todbench
