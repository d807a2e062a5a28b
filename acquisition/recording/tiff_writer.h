// Pages of 16 bits into a TIFF file that can be read at any moment.
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>

#include "acquisition/recording/written_file.h"

namespace todbench {

/// Writes pages one after another, uncompressed, little-endian, BigTIFF (there is no limit of 4 GiB). A page is whole
/// in the file, pixels and directory, before the page in front of it points to it: a file whose writer was killed, or
/// whose disk is full, is read up to its last whole page. Move-only, one thread at a time. Errors: `io` with the path;
/// what a full disk cut off is taken back, and nothing is appended any more.
class TiffWriter {
 public:
  [[nodiscard]] static Result<TiffWriter> create(const std::filesystem::path& path);

  /// One page; `invalid_input` for an empty picture.
  [[nodiscard]] Result<void> append(const cv::Mat1w& counts);
  /// Waits until everything is on the disk, and opens the file again: the pages that a reader finds in it, 0 for a file
  /// without any, which is no TIFF. Fails unless they are those that were appended.
  [[nodiscard]] Result<std::uint64_t> verified_pages();

  [[nodiscard]] std::uint64_t pages() const { return pages_; }

 private:
  explicit TiffWriter(WrittenFile file) : file_(std::move(file)) {}
  [[nodiscard]] Result<void> append_page(const cv::Mat1w& counts);

  WrittenFile file_;
  std::uint64_t pages_ = 0;
  std::uint64_t link_offset_ = 0;  ///< where the offset of the next directory belongs
  bool broken_ = false;            ///< a page was refused by the disk
};

}  // namespace todbench
