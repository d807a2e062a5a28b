// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers in network byte order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace todbench {

using Bytes = std::vector<std::uint8_t>;

/// Appends the lowest `bytes` bytes of a number, highest byte first.
inline void append_big_endian(Bytes& out, std::uint64_t value, int bytes) {
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) out.push_back(static_cast<std::uint8_t>(value >> shift));
}

/// Returns the number in `bytes` bytes at `offset`; 0 if the data are too short.
[[nodiscard]] inline std::uint64_t big_endian_at(std::span<const std::uint8_t> data, std::size_t offset, int bytes) {
  if (offset > data.size() || data.size() - offset < static_cast<std::size_t>(bytes)) return 0;
  std::uint64_t value = 0;
  for (int i = 0; i < bytes; ++i) value = value << 8 | data[offset + static_cast<std::size_t>(i)];
  return value;
}

}  // namespace todbench
