#include "acquisition/aravis/frame_id.h"

#include <gtest/gtest.h>

namespace todbench {
namespace {

TEST(FrameSequence, StartsAtZeroWhateverTheFirstId) {
  FrameSequence sequence(FrameIdKind::gvsp16);

  EXPECT_EQ(sequence.next(65400), 0U);
  EXPECT_EQ(sequence.next(65401), 1U);
}

TEST(FrameSequence, ContinuesFrom65535To1WithoutAGap) {
  FrameSequence sequence(FrameIdKind::gvsp16);
  static_cast<void>(sequence.next(65534));

  EXPECT_EQ(sequence.next(65535), 1U);
  EXPECT_EQ(sequence.next(1), 2U);
  EXPECT_EQ(sequence.next(2), 3U);
}

TEST(FrameSequence, CountsTheLostFramesOfAGapAcrossTheWrap) {
  FrameSequence sequence(FrameIdKind::gvsp16);
  static_cast<void>(sequence.next(65530));

  // 65531 ... 65535 and 1 ... 3 are lost: eight frames.
  EXPECT_EQ(sequence.next(4), 9U);
}

TEST(FrameSequence, NeverWrapsOverManyPeriodsOfTheId) {
  FrameSequence sequence(FrameIdKind::gvsp16);
  std::uint64_t expected = 0;
  bool agreed = true;

  for (std::uint64_t k = 0; k < 200'000; ++k, ++expected)
    agreed = agreed && sequence.next((65399 + k) % 65535 + 1) == expected;

  EXPECT_TRUE(agreed);
}

TEST(FrameSequence, PutsAFrameWithoutIdAfterTheLastOne) {
  FrameSequence sequence(FrameIdKind::gvsp16);
  static_cast<void>(sequence.next(100));

  EXPECT_EQ(sequence.next(std::nullopt), 1U);
  EXPECT_EQ(sequence.next(102), 2U);
}

TEST(FrameSequence, FindsTheTruePlaceAgainAfterAFrameWithoutIdInsideAGap) {
  FrameSequence sequence(FrameIdKind::gvsp16);
  static_cast<void>(sequence.next(100));
  static_cast<void>(sequence.next(std::nullopt));

  EXPECT_EQ(sequence.next(105), 5U);
}

TEST(FrameSequence, GivesAnOlderFrameItsOlderPlace) {
  FrameSequence sequence(FrameIdKind::gvsp16);
  static_cast<void>(sequence.next(10));
  static_cast<void>(sequence.next(13));

  EXPECT_EQ(sequence.next(12), 2U);
}

TEST(FrameSequence, TakesWideIdsAsTheyAreIncludingZero) {
  FrameSequence sequence(FrameIdKind::wide);

  EXPECT_EQ(sequence.next(0), 0U);
  EXPECT_EQ(sequence.next(1), 1U);
  EXPECT_EQ(sequence.next(70'000), 70'000U);
  EXPECT_EQ(sequence.next(0x1'0000'0000U), 0x1'0000'0000U);
}

}  // namespace
}  // namespace todbench
