// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/byte_order.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace todbench {
namespace {

std::uint16_t swapped(std::uint16_t value) {
  return static_cast<std::uint16_t>((value << 8) | (value >> 8));
}

std::uint32_t difference(std::uint16_t a, std::uint16_t b) {
  return a > b ? static_cast<std::uint32_t>(a - b) : static_cast<std::uint32_t>(b - a);
}

/// Sums over a picture: differences in both orders, and all bits that are set in any pixel.
struct Sums {
  std::uint64_t as_stated = 0, swapped = 0;
  std::uint16_t bits = 0;
};

constexpr int most_rows = 64;

bool uses_both_bytes(std::uint16_t bits) {
  return (bits & 0x00ff) != 0 && (bits & 0xff00) != 0;
}

Sums sums_of(const cv::Mat1w& counts) {
  Sums sums;
  const int step = std::max(1, counts.rows / most_rows);
  for (int row = 0; row < counts.rows; row += step) {
    const std::uint16_t* pixels = counts.ptr<std::uint16_t>(row);
    // 65535 columns of 65535 counts stay below 2^32, so a row is summed in 32 bits, which vectorises.
    std::uint32_t as_stated = 0, other = 0;
    std::uint16_t bits = counts.cols > 0 ? pixels[0] : std::uint16_t{0};
    for (int column = 1; column < counts.cols; ++column) {
      as_stated += difference(pixels[column], pixels[column - 1]);
      other += difference(swapped(pixels[column]), swapped(pixels[column - 1]));
      bits = static_cast<std::uint16_t>(bits | pixels[column]);
    }
    sums.as_stated += as_stated;
    sums.swapped += other;
    sums.bits = static_cast<std::uint16_t>(sums.bits | bits);
  }
  return sums;
}

}  // namespace

std::string_view to_string(ByteOrderVerdict verdict) {
  switch (verdict) {
    case ByteOrderVerdict::as_stated:
      return "as_stated";
    case ByteOrderVerdict::swapped:
      return "swapped";
    case ByteOrderVerdict::undecided:
      return "undecided";
  }
  return "unknown";
}

ByteOrderEvidence byte_order_evidence(const cv::Mat1w& counts, const ByteOrderOptions& options) {
  const Sums sums = sums_of(counts);
  ByteOrderEvidence evidence;
  evidence.bits = sums.bits;
  if (sums.as_stated == 0 || sums.swapped == 0) return evidence;
  evidence.log_ratio = std::log(static_cast<double>(sums.as_stated)) - std::log(static_cast<double>(sums.swapped));
  if (!uses_both_bytes(sums.bits) || std::abs(evidence.log_ratio) < options.least_log_ratio) return evidence;
  evidence.verdict = evidence.log_ratio < 0 ? ByteOrderVerdict::as_stated : ByteOrderVerdict::swapped;
  return evidence;
}

void ByteOrderWatch::see(const cv::Mat1w& counts, int significant_bits) {
  if (significant_bits <= 8) return;
  const ByteOrderEvidence evidence = byte_order_evidence(counts, ByteOrderOptions{});
  two_bytes_ = true;
  bits_ = static_cast<std::uint16_t>(bits_ | evidence.bits);
  as_stated_ = as_stated_ || evidence.verdict == ByteOrderVerdict::as_stated;
  swapped_ = swapped_ || evidence.verdict == ByteOrderVerdict::swapped;
}

ByteOrderVerdict ByteOrderWatch::verdict() const {
  if (as_stated_ || !two_bytes_) return ByteOrderVerdict::as_stated;
  return swapped_ ? ByteOrderVerdict::swapped : ByteOrderVerdict::undecided;
}

std::string ByteOrderWatch::note() const {
  if (verdict() != ByteOrderVerdict::undecided || bits_ == 0 || uses_both_bytes(bits_)) return "";
  const bool low = (bits_ & 0x00ff) != 0;
  return std::string("the byte order is not decided: the ") + (low ? "high" : "low") +
         " byte of every count is zero, so both orders look alike, and with the wrong one every number is " +
         (low ? "256 times too small" : "256 times too large") +
         ". Check it with a scene of known temperature, or state byte_order of a raw file";
}

}  // namespace todbench
