// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/base/rng.h"

#include <Random123/philox.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "acquisition/base/multiversion.h"

namespace todbench {
namespace {

/// Finaliser of SplitMix64 (Steele, Lea and Flood 2014): spreads nearby numbers over all 64 bits.
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ull;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
  return x ^ (x >> 31);
}

std::uint64_t fnv1a(std::string_view text) {
  std::uint64_t hash = 0xCBF29CE484222325ull;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3ull;
  return hash;
}

constexpr std::size_t batch = 64;  // Philox blocks at a time: fits the first-level cache, long enough to vectorise

/// Philox4x32-10 at `batch` successive positions at once; the same words as RandomStream::words().
struct PhiloxBatch {
  std::uint32_t w0[batch], w1[batch], w2[batch], w3[batch];
};

/// Natural logarithm in single precision for 2^-25 <= x < 1, relative error below 3e-7 (polynomial of Moshier's Cephes,
/// logf). Plain arithmetic only, so that every compiler gives the same bits.
inline float log_single(float x) {
  const auto bits = std::bit_cast<std::int32_t>(x);
  // Mantissa in [sqrt(1/2), sqrt(2)).
  const std::int32_t shifted = bits - 0x3F3504F3;
  const std::int32_t exponent = shifted >> 23;
  const float m = std::bit_cast<float>((shifted & 0x007FFFFF) + 0x3F3504F3) - 1.0F;
  float p = 7.0376836292E-2F;
  p = p * m - 1.1514610310E-1F;
  p = p * m + 1.1676998740E-1F;
  p = p * m - 1.2420140846E-1F;
  p = p * m + 1.4249322787E-1F;
  p = p * m - 1.6668057665E-1F;
  p = p * m + 2.0000714765E-1F;
  p = p * m - 2.4999993993E-1F;
  p = p * m + 3.3333331174E-1F;
  const float square = m * m;
  return p * m * square - 0.5F * square + m + static_cast<float>(exponent) * 0.693147180559945F;
}

/// Box and Muller 1958: radius from `u`, angle from `v` (raw words). Writes two independent standard normals.
inline void box_muller(std::uint32_t u, std::uint32_t v, float& first, float& second) {
  // 24 bits, never 0 and never 1: |z| <= sqrt(2 ln 2^25) = 5.9.
  const float uniform = (static_cast<float>(static_cast<std::int32_t>(u >> 8)) + 0.5F) * 0x1p-24F;
  const float radius = std::sqrt(-2.0F * log_single(uniform));
  // Two bits choose the quadrant, the rest an angle in (-pi/4, pi/4), in which short polynomials suffice (Cephes sinf,
  // cosf).
  const auto quadrant = static_cast<std::int32_t>(v >> 30);
  const float fraction =
      static_cast<float>(static_cast<std::int32_t>((v >> 6) & 0xFFFFFF)) * 0x1p-24F - 0.5F + 0x1p-25F;
  const float x = fraction * 1.57079632679489662F;
  const float y = x * x;
  const float sine = ((-1.9515295891E-4F * y + 8.3321608736E-3F) * y - 1.6666654611E-1F) * y * x + x;
  const float cosine =
      ((2.443315711809948E-5F * y - 1.388731625493765E-3F) * y + 4.166664568298827E-2F) * y * y - 0.5F * y + 1.0F;
  const bool odd = (quadrant & 1) != 0;
  const float sign = (quadrant & 2) != 0 ? -radius : radius;
  first = sign * (odd ? -sine : cosine);
  second = sign * (odd ? cosine : sine);
}

/// Ten rounds on every block of the batch (Salmon et al. 2011, section 4.3, with their constants).
inline void philox_rounds(PhiloxBatch& x, std::uint32_t key0, std::uint32_t key1) {
  for (int round = 0; round < 10; ++round) {
    for (std::size_t i = 0; i < batch; ++i) {
      const std::uint64_t p0 = std::uint64_t{0xD2511F53} * x.w0[i];
      const std::uint64_t p1 = std::uint64_t{0xCD9E8D57} * x.w2[i];
      const std::uint32_t a = static_cast<std::uint32_t>(p1 >> 32) ^ x.w1[i] ^ key0;
      const std::uint32_t b = static_cast<std::uint32_t>(p0 >> 32) ^ x.w3[i] ^ key1;
      x.w0[i] = a;
      x.w1[i] = static_cast<std::uint32_t>(p1);
      x.w2[i] = b;
      x.w3[i] = static_cast<std::uint32_t>(p0);
    }
    key0 += 0x9E3779B9;
    key1 += 0xBB67AE85;
  }
}

/// Normals of the blocks `block`, block + 1, ...: 4 * batch numbers.
TODBENCH_MULTIVERSION
void fill_batch(std::uint64_t seed, std::uint64_t stream, std::uint64_t block, float* out) {
  PhiloxBatch x;
  for (std::size_t i = 0; i < batch; ++i) {
    const std::uint64_t position = block + i;
    x.w0[i] = static_cast<std::uint32_t>(position);
    x.w1[i] = static_cast<std::uint32_t>(position >> 32);
    x.w2[i] = static_cast<std::uint32_t>(stream);
    x.w3[i] = static_cast<std::uint32_t>(stream >> 32);
  }
  philox_rounds(x, static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32));
  float z0[batch], z1[batch], z2[batch], z3[batch];
  for (std::size_t i = 0; i < batch; ++i) box_muller(x.w0[i], x.w1[i], z0[i], z1[i]);
  for (std::size_t i = 0; i < batch; ++i) box_muller(x.w2[i], x.w3[i], z2[i], z3[i]);
  for (std::size_t i = 0; i < batch; ++i) {
    out[4 * i] = z0[i];
    out[4 * i + 1] = z1[i];
    out[4 * i + 2] = z2[i];
    out[4 * i + 3] = z3[i];
  }
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::string_view name) : seed_(seed), stream_(fnv1a(name)) {}

RandomStream RandomStream::sub(std::uint64_t index) const {
  return {seed_, mixed(stream_ ^ mixed(index))};
}

std::array<std::uint32_t, 4> RandomStream::words(std::uint64_t index) const {
  const r123::Philox4x32::ctr_type counter{{static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32),
                                            static_cast<std::uint32_t>(stream_),
                                            static_cast<std::uint32_t>(stream_ >> 32)}};
  const r123::Philox4x32::key_type key{{static_cast<std::uint32_t>(seed_), static_cast<std::uint32_t>(seed_ >> 32)}};
  const auto out = r123::Philox4x32{}(counter, key);
  return {out[0], out[1], out[2], out[3]};
}

double RandomStream::uniform(std::uint64_t index) const {
  const auto w = words(index);
  const std::uint64_t bits = (static_cast<std::uint64_t>(w[1]) << 32 | w[0]) >> 12;
  return (static_cast<double>(bits) + 0.5) * 0x1p-52;
}

std::uint64_t RandomStream::below(std::uint64_t count, std::uint64_t index) const {
  // uniform() <= 1 - 2^-53, so the product stays below count for every count up to 2^50.
  return static_cast<std::uint64_t>(uniform(index) * static_cast<double>(count));
}

float RandomStream::normal(std::uint64_t index) const {
  const auto w = words(index / 4);
  float z[4];
  box_muller(w[0], w[1], z[0], z[1]);
  box_muller(w[2], w[3], z[2], z[3]);
  return z[index % 4];
}

void RandomStream::fill_normal(std::span<float> out, std::uint64_t first) const {
  std::size_t done = 0;
  while (done < out.size() && (first + done) % 4 != 0) {
    out[done] = normal(first + done);
    ++done;
  }
  while (done < out.size()) {
    const std::size_t count = std::min(4 * batch, out.size() - done);
    if (count == 4 * batch) {
      fill_batch(seed_, stream_, (first + done) / 4, out.data() + done);
    } else {
      float last[4 * batch];
      fill_batch(seed_, stream_, (first + done) / 4, last);
      std::copy_n(last, count, out.data() + done);
    }
    done += count;
  }
}

}  // namespace todbench
