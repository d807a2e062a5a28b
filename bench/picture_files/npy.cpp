// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/picture_files/npy.h"

#include <bit>
#include <cstring>

#include "acquisition/base/npy_header.h"

namespace todbench {

std::string to_npy(const NpyArray& array) {
  std::string shape;
  for (const std::size_t extent : array.shape) shape += std::to_string(extent) + ", ";
  if (array.shape.size() > 1) shape.resize(shape.size() - 2);
  std::string bytes = npy_header("<f8", shape);
  static_assert(std::endian::native == std::endian::little);
  const std::size_t begin = bytes.size();
  bytes.resize(begin + array.values.size() * sizeof(double));
  if (!array.values.empty())
    std::memcpy(bytes.data() + begin, array.values.data(), array.values.size() * sizeof(double));
  return bytes;
}

}  // namespace todbench
