// One picture from a file: TIFF or .npy, in whole counts or in any linear unit.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string_view>
#include <utility>

#include "acquisition/core/result.h"

namespace todbench {

struct PictureFile {
  cv::Mat1d picture;
  /// What the file's type can hold at least and at most; nothing for floating point.
  std::optional<std::pair<double, double>> counts{};
};

/// A TIFF of one page (one sample of 8, 16 or 32 bits, or of 32 or 64 bits floating point, in rows or strips, any byte
/// order and lossless compression) or a .npy array of two dimensions (integers of 8 to 64 bits, floating point of 32 or
/// 64, both byte orders, C and Fortran order), told by the first bytes. Values may be NaN. `invalid_input` with the
/// path where it is neither or cannot be read.
[[nodiscard]] Result<PictureFile> read_picture(const std::filesystem::path& path);

/// The bytes of a .npy file (NumPy format 1.0 to 3.0). `invalid_input` without a path.
[[nodiscard]] Result<PictureFile> parse_npy(std::string_view bytes);

/// A TIFF file. `invalid_input` without the path.
[[nodiscard]] Result<PictureFile> read_tiff_picture(const std::filesystem::path& path);

}  // namespace todbench
