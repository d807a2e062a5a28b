// SPDX-License-Identifier: GPL-3.0-or-later
// Tests whether the first frame agrees with the sign, bits and unit that the user stated for a file without this
// information.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "acquisition/recording/recorded_source.h"
#include "acquisition/recording/tiff_values.h"

namespace todbench {

/// Known properties of the values of a file.
struct KnownValues {
  enum class Sign {
    assumed_unsigned,  ///< raw file; the user did not state the sign
    stated_unsigned,   ///< raw file, signed=no
    stated_signed,     ///< raw file, signed=yes
    in_file,           ///< the file states the sign
    of_camera,         ///< a file of the camera's own format, with its scale
  };
  Sign sign = Sign::in_file;
  bool counts_are_signed = false;  ///< the counts of the frames are the signed values plus 32768
  std::optional<ValueUnit> unit{};
};

/// Returns whether the picture is smooth only if its highest bit is inverted. In this case, signed values were read as
/// unsigned, or the reverse. The values must cross the wrap-around without a wide gap, so the result is false for
/// bimodal and clipped scenes. Returns false for pictures of fewer than 1000 pixels.
[[nodiscard]] bool looks_wrapped(const cv::Mat1w& counts);

/// Adds warnings to the recording if temperatures are outside 150 to 2000 K or if the sign of the values looks wrong.
/// Tests each frame that is read later for counts above the stated bits. Errors: `invalid_input` without the path
/// (temperatures below 0 K, counts above the stated bits, a raw file that looks signed although the user did not state
/// the sign). A first frame that cannot be read is not an error here, because reading it fails later.
[[nodiscard]] Result<void> check_values(Recording& recording, const KnownValues& known);

}  // namespace todbench
