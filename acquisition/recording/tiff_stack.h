// 16-bit TIFF: one file of many pages, or a folder of files of one page each, through libtiff.
#pragma once

#include <filesystem>
#include <memory>

#include "acquisition/recording/recorded_source.h"

namespace todbench {

/// What a TIFF cannot say about itself.
struct TiffFormat {
  int significant_bits = 16;
  double frame_rate_hz = 0;     ///< 0: unknown
  RadiometricScale scale = {};  ///< uncalibrated unless stated
};

/// A file of pages, or a folder whose files *.tif and *.tiff are taken in the order of their names. One sample of 16
/// unsigned bits per pixel in rows or strips, any byte order, any lossless compression that libtiff reads, also
/// BigTIFF. Pages are read when they are asked for. Errors: `io`, `invalid_input` (not a TIFF, another kind of picture,
/// pages of different size, no page).
[[nodiscard]] Result<Recording> open_tiff_stack(const std::filesystem::path& path, const TiffFormat& format);

/// Writes pages one after another, uncompressed, little-endian, BigTIFF (there is no limit of 4 GiB). Move-only, one
/// thread at a time. Errors: `io` with the path.
class TiffWriter {
 public:
  [[nodiscard]] static Result<TiffWriter> create(const std::filesystem::path& file);
  TiffWriter(TiffWriter&&) noexcept;
  TiffWriter& operator=(TiffWriter&&) noexcept;
  ~TiffWriter();

  /// One page; `invalid_input` for an empty picture.
  [[nodiscard]] Result<void> append(const cv::Mat1w& counts);
  /// Writes what is left and closes. Nothing may be appended after it.
  [[nodiscard]] Result<void> finish();

 private:
  struct State;
  explicit TiffWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace todbench
