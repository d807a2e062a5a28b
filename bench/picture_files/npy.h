// SPDX-License-Identifier: GPL-3.0-or-later
// Arrays in NumPy's .npy format, version 1.0, for scripts.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// Array of 64-bit floating point numbers in row-major order.
struct NpyArray {
  std::vector<std::size_t> shape;
  std::vector<double> values;
};

/// Returns the bytes of the file: dtype <f8 (little-endian), C order. Precondition: the number of values matches the
/// shape.
[[nodiscard]] std::string to_npy(const NpyArray& array);

}  // namespace todbench
