// SPDX-License-Identifier: GPL-3.0-or-later
// Counter-based random numbers: a value is a function of (seed, stream, index), on any number of threads and any
// compiler. Philox4x32-10, Salmon et al. 2011 "Parallel random numbers: as easy as 1, 2, 3".
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace todbench {

/// One independent sequence of random numbers. A value type without state: the position is an argument. Thread-safe.
/// Streams have names, so removing one consumer never changes the numbers of the others.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::uint64_t stream) : seed_(seed), stream_(stream) {}
  /// Selects the stream whose number is the FNV-1a hash of `name`, e.g. "sensor.temporal".
  RandomStream(std::uint64_t seed, std::string_view name);

  /// Returns the substream of item `index` (a frame of a sensor, a trial of an observer).
  [[nodiscard]] RandomStream sub(std::uint64_t index) const;

  /// Returns four raw 32-bit words at position `index`.
  [[nodiscard]] std::array<std::uint32_t, 4> words(std::uint64_t index) const;
  /// Returns a uniform number in (0, 1), 52 bits, at position `index`.
  [[nodiscard]] double uniform(std::uint64_t index) const;
  /// Returns a uniform integer in [0, count), 1 <= count <= 2^50, with a bias below count / 2^52.
  [[nodiscard]] std::uint64_t below(std::uint64_t count, std::uint64_t index) const;
  /// Returns a standard normal number at position `index`, the same value as in fill_normal().
  [[nodiscard]] float normal(std::uint64_t index) const;
  /// Writes standard normal numbers for positions first, first + 1, ... Single precision, |z| <= 5.9; bit-identical on
  /// every compiler.
  void fill_normal(std::span<float> out, std::uint64_t first = 0) const;

  [[nodiscard]] std::uint64_t seed() const { return seed_; }
  [[nodiscard]] std::uint64_t stream() const { return stream_; }

 private:
  std::uint64_t seed_;
  std::uint64_t stream_;
};

}  // namespace todbench
