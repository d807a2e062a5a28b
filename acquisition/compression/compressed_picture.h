// SPDX-License-Identifier: GPL-3.0-or-later
// Counts of 16 bits from compressed pictures inside the files of camera makers.
#pragma once

#include <opencv2/core.hpp>
#include <string_view>

#include "acquisition/base/result.h"

namespace todbench {

/// Largest picture that is decoded, in pixels: 128 MiB of counts. A few bytes can state a picture larger than memory.
inline constexpr std::size_t most_compressed_pixels = std::size_t{1} << 26;

/// Decodes JPEG-LS (ISO/IEC 14495-1) of one component with 9 to 16 bits. Errors: `invalid_input` (not JPEG-LS, not the
/// expected size, more than one component, truncated or too large).
[[nodiscard]] Result<cv::Mat1w> decode_jpeg_ls(std::string_view bytes, cv::Size expected);

/// Returns the largest difference between a count and its JPEG-LS coding; 0: lossless. FLIR cameras use up to 5. Error:
/// `invalid_input` (not JPEG-LS).
[[nodiscard]] Result<int> largest_jpeg_ls_error(std::string_view bytes);

/// Decodes a PNG of 16-bit grey; the first byte of a sample is the high byte, as the PNG standard requires. Errors as
/// decode_jpeg_ls().
[[nodiscard]] Result<cv::Mat1w> decode_png(std::string_view bytes, cv::Size expected);

}  // namespace todbench
