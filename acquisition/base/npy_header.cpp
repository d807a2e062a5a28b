// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/base/npy_header.h"

#include <fmt/format.h>

namespace todbench {

std::string npy_header(std::string_view type, std::string_view shape) {
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", type, shape);
  // Magic, version, length and header end together at a multiple of 64, with a line end.
  constexpr std::size_t before = 10, alignment = 64;
  while ((before + header.size() + 1) % alignment != 0) header += ' ';
  header += '\n';
  std::string bytes(npy_magic);
  bytes += std::string("\x01\x00", 2);
  bytes += static_cast<char>(header.size() & 0xff);
  bytes += static_cast<char>(header.size() >> 8);
  return bytes + header;
}

}  // namespace todbench
