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
  gate.reject(Rejection::nonuniformity_correction);

  EXPECT_EQ(gate.accepted(), 2u);
  EXPECT_EQ(gate.rejected(), 7u);
  EXPECT_EQ(gate.rejected_by_reason().size(), 7u);
}

TEST(IntegrityGate, CountsLostExposuresFromGapsInTheSequence) {
  IntegrityGate gate({});

  EXPECT_EQ(gate.judge(frame(10)), std::nullopt);
  EXPECT_EQ(gate.judge(frame(14)), std::nullopt);

  EXPECT_EQ(gate.lost(), 3u);
}

}  // namespace
}  // namespace todbench
