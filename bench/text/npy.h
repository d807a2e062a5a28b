// Arrays in NumPy's .npy format, version 1.0: what scripts of any laboratory read.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

/// A little-endian array of 64-bit numbers, rows first.
struct NpyArray {
  std::vector<std::size_t> shape;
  std::vector<double> values;
};

/// The file's bytes: dtype <f8, C order. Precondition: as many values as the shape says.
[[nodiscard]] std::string to_npy(const NpyArray& array);

}  // namespace todbench
