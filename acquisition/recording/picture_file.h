// SPDX-License-Identifier: GPL-3.0-or-later
// One picture from a file: TIFF or .npy, in integer counts or in any linear unit.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string_view>
#include <utility>

#include "acquisition/base/result.h"

namespace todbench {

/// A picture from a file.
struct PictureFile {
  cv::Mat1d picture;
  /// Smallest and largest value of the file's integer type; empty for floating-point values.
  std::optional<std::pair<double, double>> counts{};
};

/// Reads a TIFF or .npy file, recognised by its first bytes. TIFF: one page; one sample per pixel of 8, 16 or 32 bits,
/// or of 32 or 64 bits floating point; rows or strips, any byte order and lossless compression. The picture is rotated
/// as its tag Orientation requires, and 0 is the darkest value. .npy: an array of two dimensions; integers of 8 to 64
/// bits or floating point of 32 or 64 bits; both byte orders; C and Fortran order. Values may be NaN. Errors:
/// `invalid_input` with the path (not TIFF or .npy, or unreadable); `integrity` if the two bytes of 16-bit samples are
/// exchanged.
[[nodiscard]] Result<PictureFile> read_picture(const std::filesystem::path& path);

/// Reads the bytes of a .npy file (NumPy format 1.0 to 3.0). Error: `invalid_input` without a path.
[[nodiscard]] Result<PictureFile> parse_npy(std::string_view bytes);

/// Reads a TIFF file. Error: `invalid_input` without the path.
[[nodiscard]] Result<PictureFile> read_tiff_picture(const std::filesystem::path& path);

}  // namespace todbench
