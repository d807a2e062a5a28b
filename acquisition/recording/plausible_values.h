// SPDX-License-Identifier: GPL-3.0-or-later
// Tests whether the first frame agrees with the sign, bits and unit that the user stated for a file without them.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "acquisition/recording/recorded_source.h"
#include "acquisition/recording/tiff_values.h"

namespace todbench {

/// Known properties of the values of a file.
struct KnownValues {
  enum class Sign {
    assumed_unsigned,  ///< raw file, not stated
    stated_unsigned,   ///< raw file, signed=no
    stated_signed,     ///< raw file, signed=yes
    in_file,           ///< the file contains it
  };
  Sign sign = Sign::in_file;
  bool counts_are_signed = false;  ///< the counts of the frames are raised by 32768
  std::optional<ValueUnit> unit{};
};

/// Whether the picture is smooth only with its highest bit inverted: signed values that were read as unsigned, or the
/// reverse. The values must cross the wrap-around without a wide gap, so a bimodal or clipped scene does not count.
/// Pictures of fewer than 1000 pixels are not judged.
[[nodiscard]] bool looks_wrapped(const cv::Mat1w& counts);

/// Adds warnings to the recording: temperatures outside 150 to 2000 K, values whose sign looks wrong. Every frame read
/// later is tested for counts above the stated bits. Errors: `invalid_input` without the path (temperatures below 0 K,
/// counts above the stated bits, a raw file that looks signed without a statement). A first frame that cannot be read
/// is not an error here: reading it fails later.
[[nodiscard]] Result<void> check_values(Recording& recording, const KnownValues& known);

}  // namespace todbench
