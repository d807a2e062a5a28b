// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/base/rng.h"

#include <gmock/gmock.h>

#include <cmath>
#include <thread>
#include <vector>

namespace todbench {
namespace {

TEST(RandomStream, IsPhiloxWithSeedAsKeyAndIndexAndStreamAsCounter) {
  // Known-answer vectors of the Random123 distribution (kat_vectors): philox4x32-10 with all-zero and all-one inputs.
  const std::array<std::uint32_t, 4> zeros{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8};
  const std::array<std::uint32_t, 4> ones{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd};

  EXPECT_EQ(RandomStream(0, std::uint64_t{0}).words(0), zeros);
  EXPECT_EQ(RandomStream(~0ull, ~std::uint64_t{0}).words(~0ull), ones);
}

TEST(RandomStream, FillsTheSameNormalsFromAnyStartAndInAnyPieces) {
  const RandomStream stream(3, "sensor.temporal");
  std::vector<float> whole(1000);
  std::vector<float> piece(337);

  stream.fill_normal(whole);
  stream.fill_normal(piece, 101);

  for (std::size_t i = 0; i < piece.size(); ++i) EXPECT_EQ(piece[i], whole[101 + i]);
  for (std::size_t i = 0; i < whole.size(); i += 17) EXPECT_EQ(stream.normal(i), whole[i]);
}

TEST(RandomStream, NormalsHaveTheMomentsAndTailsOfTheNormalDistribution) {
  const std::size_t n = 4'000'000;
  std::vector<float> z(n);

  RandomStream(1, "moments").fill_normal(z);

  double m1 = 0, m2 = 0, m3 = 0, m4 = 0, beyond3 = 0;
  for (const float value : z) {
    const double v = value;
    m1 += v;
    m2 += v * v;
    m3 += v * v * v;
    m4 += v * v * v * v;
    beyond3 += std::abs(v) > 3 ? 1 : 0;
  }
  const double root = std::sqrt(static_cast<double>(n));
  const auto count = static_cast<double>(n);
  // Four standard errors: variances of z, z^2, z^3, z^4 are 1, 2, 15, 96.
  EXPECT_NEAR(m1 / count, 0, 4 / root);
  EXPECT_NEAR(m2 / count, 1, 4 * std::sqrt(2.0) / root);
  EXPECT_NEAR(m3 / count, 0, 4 * std::sqrt(15.0) / root);
  EXPECT_NEAR(m4 / count, 3, 4 * std::sqrt(96.0) / root);
  const double p3 = std::erfc(3 / std::sqrt(2.0));
  EXPECT_NEAR(beyond3 / count, p3, 4 * std::sqrt(p3) / root);
}

TEST(RandomStream, NormalsPassAChiSquareTestAgainstTheNormalDistribution) {
  const std::size_t n = 1'000'000;
  const int cells = 64;
  std::vector<float> z(n);

  RandomStream(7, "chi-square").fill_normal(z);

  std::vector<double> observed(cells, 0);
  for (const float value : z) {
    const double p = 0.5 * std::erfc(-static_cast<double>(value) / std::sqrt(2.0));
    observed[static_cast<std::size_t>(std::min(p * cells, cells - 1.0))] += 1;
  }
  double chi_square = 0;
  const double expected = static_cast<double>(n) / cells;
  for (const double o : observed) chi_square += (o - expected) * (o - expected) / expected;
  // 63 degrees of freedom: mean 63, sd sqrt(126); four standard deviations.
  EXPECT_NEAR(chi_square, 63, 4 * std::sqrt(126.0));
}

TEST(RandomStream, StreamsOfDifferentNamesAndIndicesAreUncorrelated) {
  const std::size_t n = 200'000;
  std::vector<float> a(n), b(n), c(n);
  const RandomStream stream(1, "a");

  stream.fill_normal(a);
  RandomStream(1, "b").fill_normal(b);
  stream.sub(1).fill_normal(c);

  double ab = 0, ac = 0;
  for (std::size_t i = 0; i < n; ++i) {
    ab += static_cast<double>(a[i]) * static_cast<double>(b[i]);
    ac += static_cast<double>(a[i]) * static_cast<double>(c[i]);
  }
  const double four_sigma = 4 / std::sqrt(static_cast<double>(n));
  EXPECT_NEAR(ab / static_cast<double>(n), 0, four_sigma);
  EXPECT_NEAR(ac / static_cast<double>(n), 0, four_sigma);
}

TEST(RandomStream, GivesTheSameNumbersOnSeveralThreads) {
  const RandomStream stream(5, "threads");
  std::vector<float> one(100'000), two(100'000);

  stream.fill_normal(one);
  {
    std::span<float> halves(two);
    std::jthread first([&] { stream.fill_normal(halves.first(50'000), 0); });
    std::jthread second([&] { stream.fill_normal(halves.last(50'000), 50'000); });
  }

  EXPECT_EQ(one, two);
}

TEST(RandomStream, UniformIntegersCoverTheirRangeEvenly) {
  const RandomStream stream(2, "below");
  std::vector<double> seen(5, 0);
  const int n = 100'000;

  for (int i = 0; i < n; ++i) seen.at(stream.below(5, static_cast<std::uint64_t>(i))) += 1;

  for (const double count : seen) EXPECT_NEAR(count, n / 5.0, 4 * std::sqrt(n * 0.2 * 0.8));
}

}  // namespace
}  // namespace todbench
