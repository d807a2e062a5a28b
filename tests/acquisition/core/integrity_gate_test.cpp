// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/integrity_gate.h"

#include <gmock/gmock.h>

namespace todbench {
namespace {

Frame frame(std::uint64_t sequence, std::uint16_t value = 0) {
  Frame f;
  f.counts = cv::Mat1w(4, 5, static_cast<std::uint16_t>(value == 0 ? 1000 + sequence : value));
  f.sequence = sequence;
  f.significant_bits = 14;
  f.scale = std::make_shared<RadiometricScale>();
  return f;
}

/// A gradient of 14 bits whose bytes went the other way round.
Frame swapped_picture(std::uint64_t sequence) {
  Frame f = frame(sequence);
  for (int i = 0; i < 20; ++i) {
    const int value = 7000 + 13 * i;
    f.counts(i / 5, i % 5) = static_cast<std::uint16_t>((value << 8) | (value >> 8));
  }
  return f;
}

TEST(IntegrityGate, AcceptsAnUndisturbedStream) {
  IntegrityGate gate({.width = 5, .height = 4});

  for (std::uint64_t k = 0; k < 10; ++k) EXPECT_EQ(gate.judge(frame(k)), std::nullopt);

  EXPECT_EQ(gate.accepted(), 10u);
  EXPECT_EQ(gate.lost(), 0u);
  EXPECT_EQ(gate.rejected(), 0u);
}

TEST(IntegrityGate, CountsEveryReason) {
  IntegrityGate gate({.width = 5, .height = 4});
  Frame incomplete = frame(1);
  incomplete.status = FrameStatus::incomplete;
  Frame small = frame(2);
  small.counts = cv::Mat1w(3, 5, std::uint16_t{7});

  EXPECT_EQ(gate.judge(frame(0)), std::nullopt);
  EXPECT_EQ(gate.judge(incomplete), Rejection::incomplete);
  EXPECT_EQ(gate.judge(small), Rejection::wrong_size);
  EXPECT_EQ(gate.judge(frame(3)), std::nullopt);
  EXPECT_EQ(gate.judge(frame(3)), Rejection::repeated);
  EXPECT_EQ(gate.judge(frame(2)), Rejection::out_of_order);
  EXPECT_EQ(gate.judge(frame(4, 1003)), Rejection::frozen);
  EXPECT_EQ(gate.judge(frame(5, 16383)), Rejection::saturated);
  EXPECT_EQ(gate.judge(frame(8)), Rejection::gapped);
  EXPECT_EQ(gate.judge(swapped_picture(9)), Rejection::byte_swapped);
  EXPECT_EQ(gate.judge(frame(10)), std::nullopt);
  gate.reject_accepted(Rejection::nonuniformity_correction);

  EXPECT_EQ(gate.accepted(), 2u);
  EXPECT_EQ(gate.rejected(), 9u);
  EXPECT_EQ(gate.rejected_by_reason().size(), std::size(all_rejections));
}

TEST(IntegrityGate, CountsLostExposuresFromGapsInTheSequence) {
  IntegrityGate gate({});

  EXPECT_EQ(gate.judge(frame(10)), std::nullopt);
  EXPECT_EQ(gate.judge(frame(14)), Rejection::gapped);
  EXPECT_EQ(gate.judge(frame(15)), std::nullopt);

  EXPECT_EQ(gate.lost(), 3u);
}

TEST(IntegrityGate, CountsExposuresThatNobodyReadAmongTheLostOnes) {
  IntegrityGate gate({});
  Frame unread = frame(14);
  unread.numbering = Numbering::unread;

  EXPECT_EQ(gate.judge(frame(10)), std::nullopt);
  EXPECT_EQ(gate.judge(unread), Rejection::gapped);
  EXPECT_EQ(gate.judge(frame(16)), Rejection::gapped);

  EXPECT_EQ(gate.lost(), 4u);
  EXPECT_EQ(gate.numbering().unread, 3u);
  EXPECT_EQ(describe(gate.numbering()),
            "3 of the lost frames arrived while the program was busy and found its buffers full.");
}

TEST(IntegrityGate, CountsAnOldPictureUnderANewNumberAsRepeated) {
  IntegrityGate gate({});
  for (std::uint64_t k = 0; k < 6; ++k) EXPECT_EQ(gate.judge(frame(k)), std::nullopt);

  EXPECT_EQ(gate.judge(frame(6, 1002)), Rejection::repeated);
  EXPECT_EQ(gate.judge(frame(7)), std::nullopt);
}

TEST(IntegrityGate, CountsADamagedFrameBehindAGapAsDamaged) {
  IntegrityGate gate({});
  Frame damaged = frame(5);
  damaged.status = FrameStatus::incomplete;

  EXPECT_EQ(gate.judge(frame(0)), std::nullopt);
  EXPECT_EQ(gate.judge(damaged), Rejection::incomplete);

  EXPECT_EQ(gate.lost(), 4u);
  EXPECT_EQ(gate.rejected(), 1u);
}

TEST(IntegrityGate, LetsASensorWithoutNoiseRepeatItsPicture) {
  IntegrityGate gate({.reject_frozen = false});

  for (std::uint64_t k = 0; k < 5; ++k) EXPECT_EQ(gate.judge(frame(k, 500)), std::nullopt);
}

}  // namespace
}  // namespace todbench
