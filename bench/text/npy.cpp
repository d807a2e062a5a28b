#include "bench/text/npy.h"

#include <bit>
#include <cstring>

namespace todbench {

std::string to_npy(const NpyArray& array) {
  std::string shape;
  for (const std::size_t extent : array.shape) shape += std::to_string(extent) + ", ";
  if (array.shape.size() > 1) shape.resize(shape.size() - 2);
  std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (" + shape + "), }";
  // Magic, version, length and header together end at a multiple of 64, the header with a line end.
  constexpr std::size_t before = 10, alignment = 64;
  while ((before + header.size() + 1) % alignment != 0) header += ' ';
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() & 0xff);
  bytes += static_cast<char>(header.size() >> 8);
  bytes += header;
  static_assert(std::endian::native == std::endian::little);
  const std::size_t begin = bytes.size();
  bytes.resize(begin + array.values.size() * sizeof(double));
  if (!array.values.empty())
    std::memcpy(bytes.data() + begin, array.values.data(), array.values.size() * sizeof(double));
  return bytes;
}

}  // namespace todbench
