// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/frame_sequence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <tuple>

namespace todbench {
namespace {

constexpr std::int64_t period_ns = 20'000'000;
constexpr double rate_hz = 50;
constexpr std::int64_t power_up_ns = 1'000'000'000'000;

/// What is known of the clocks of a camera.
enum class Clock { none, goes_on, begins_anew };

/// A camera that exposes 50 times a second; the host learns of a frame a little later, by an amount that varies.
class NumberedCamera {
 public:
  /// `running_ns`: what its clock shows at the beginning.
  NumberedCamera(FrameNumberKind kind, Clock clock, std::int64_t running_ns = 0)
      : sequence_(kind, rate_hz), clock_(clock), device_ns_(running_ns) {}

  /// `exposures` pass; the last of them arrives with this number.
  FramePlace send(std::optional<std::uint64_t> number, std::int64_t exposures = 1, bool after_unread = false) {
    now_ += exposures * period_ns;
    device_ns_ += exposures * period_ns;
    const std::int64_t late = (number.value_or(0) % 5) * 1'000'000;
    return sequence_.next({.number = number,
                           .device_time_ns = clock_ == Clock::none ? 0 : device_ns_,
                           .host_time_ns = now_ + late,
                           .may_pause = false,
                           .after_unread = after_unread});
  }
  void begin_anew() {
    if (clock_ == Clock::begins_anew) device_ns_ = 0;
  }
  FrameSequence& sequence() { return sequence_; }

 private:
  FrameSequence sequence_;
  Clock clock_;
  std::int64_t now_ = power_up_ns;
  std::int64_t device_ns_;
};

constexpr FramePlace counted(std::uint64_t sequence) {
  return {sequence, Numbering::counted};
}

TEST(FrameSequence, AGapThatFullBuffersExplainIsUnreadAndTheNextOneIsNot) {
  for (const Clock clock : {Clock::none, Clock::goes_on}) {
    NumberedCamera camera(FrameNumberKind::wrap32, clock);
    EXPECT_EQ(camera.send(10), counted(0));

    EXPECT_EQ(camera.send(15, 5, true), (FramePlace{5, Numbering::unread}));
    EXPECT_EQ(camera.send(19, 4), counted(9)) << "lost after the buffers had been read";
    // This frame was under way when the next ones found no buffer.
    EXPECT_EQ(camera.send(20, 1, true), counted(10));
    EXPECT_EQ(camera.send(24, 4), (FramePlace{14, Numbering::unread}));
    EXPECT_EQ(camera.send(25, 1, true), counted(15));
    EXPECT_EQ(camera.send(26), counted(16));
    EXPECT_EQ(camera.send(29, 3), counted(19)) << "full buffers two frames before explain nothing";
  }
}

TEST(FrameSequence, StartsAtZeroWhateverTheFirstId) {
  NumberedCamera camera(FrameNumberKind::gvsp16, Clock::goes_on);

  EXPECT_EQ(camera.send(65400), counted(0));
  EXPECT_EQ(camera.send(65401), counted(1));
}

TEST(FrameSequence, ContinuesFrom65535To1WithoutAGap) {
  for (const Clock clock : {Clock::none, Clock::goes_on}) {
    NumberedCamera camera(FrameNumberKind::gvsp16, clock);
    static_cast<void>(camera.send(65534));

    EXPECT_EQ(camera.send(65535), counted(1));
    EXPECT_EQ(camera.send(1), counted(2));
    EXPECT_EQ(camera.send(2), counted(3));
  }
}

TEST(FrameSequence, TakesTheZeroOfACameraThatDoesNotSkipIt) {
  NumberedCamera camera(FrameNumberKind::gvsp16, Clock::goes_on);
  static_cast<void>(camera.send(65535));

  EXPECT_EQ(camera.send(0), counted(1));
  EXPECT_EQ(camera.send(1), counted(2));
}

TEST(FrameSequence, CountsTheLostFramesOfAGapAcrossTheWrap) {
  for (const Clock clock : {Clock::none, Clock::goes_on}) {
    NumberedCamera camera(FrameNumberKind::gvsp16, clock);
    static_cast<void>(camera.send(65530));

    // 65531 ... 65535 and 1 ... 3 are lost: eight frames.
    EXPECT_EQ(camera.send(4, 9), counted(9));
  }
}

TEST(FrameSequence, NeverWrapsOverManyPeriodsOfTheId) {
  for (const Clock clock : {Clock::none, Clock::goes_on}) {
    NumberedCamera camera(FrameNumberKind::gvsp16, clock);
    std::uint64_t expected = 0;
    bool agreed = true;

    for (std::uint64_t k = 0; k < 200'000; ++k, ++expected)
      agreed = agreed && camera.send((65399 + k) % 65535 + 1) == counted(expected);

    EXPECT_TRUE(agreed);
  }
}

TEST(FrameSequence, WrapsThe32BitsOfADriverAndThe16OfASeek) {
  NumberedCamera driver(FrameNumberKind::wrap32, Clock::goes_on);
  NumberedCamera seek(FrameNumberKind::wrap16, Clock::none);
  static_cast<void>(driver.send(0xFFFFFFFEU));
  static_cast<void>(seek.send(0xFFFE));

  EXPECT_EQ(driver.send(0xFFFFFFFFU), counted(1));
  EXPECT_EQ(driver.send(3, 4), counted(5));
  EXPECT_EQ(seek.send(0xFFFF), counted(1));
  EXPECT_EQ(seek.send(0), counted(2));
}

TEST(FrameSequence, PutsAFrameWithoutIdAfterTheLastOne) {
  NumberedCamera camera(FrameNumberKind::gvsp16, Clock::goes_on);
  static_cast<void>(camera.send(100));

  EXPECT_EQ(camera.send(std::nullopt), counted(1));
  EXPECT_EQ(camera.send(102), counted(2));
}

TEST(FrameSequence, FindsTheTruePlaceAgainAfterAFrameWithoutIdInsideAGap) {
  NumberedCamera camera(FrameNumberKind::gvsp16, Clock::goes_on);
  static_cast<void>(camera.send(100));
  static_cast<void>(camera.send(std::nullopt));

  EXPECT_EQ(camera.send(105, 4), counted(5));
}

TEST(FrameSequence, RestartsBehindThePlacesThatFramesWithoutIdWereGiven) {
  FrameSequence sequence(FrameNumberKind::wide, rate_hz);
  std::int64_t now_ns = power_up_ns;
  const auto send = [&](std::optional<std::uint64_t> number) {
    now_ns += 1'000'000;
    return sequence.next({.number = number, .host_time_ns = now_ns});
  };
  EXPECT_EQ(send(500), counted(0));
  // Packets without a leader, which were parts of one frame.
  for (std::uint64_t i = 1; i <= 3; ++i) EXPECT_EQ(send(std::nullopt), counted(i));
  EXPECT_EQ(send(501), counted(1));

  const FramePlace restarted = send(0);

  EXPECT_EQ(restarted.numbering, Numbering::restarted);
  EXPECT_EQ(restarted.sequence, 4u);
}

TEST(FrameSequence, GivesAnOlderFrameItsOlderPlaceAndARepeatedOneItsOwn) {
  for (const Clock clock : {Clock::none, Clock::goes_on}) {
    NumberedCamera camera(FrameNumberKind::gvsp16, clock);
    static_cast<void>(camera.send(10));
    static_cast<void>(camera.send(13, 3));

    EXPECT_EQ(camera.send(13, 0), counted(3));
    EXPECT_EQ(camera.send(12, clock == Clock::none ? 0 : -1), counted(2));
    EXPECT_EQ(camera.send(14, clock == Clock::none ? 1 : 2), counted(4));
  }
}

TEST(FrameSequence, TakesWideIdsAsTheyAreIncludingZero) {
  NumberedCamera camera(FrameNumberKind::wide, Clock::goes_on);

  EXPECT_EQ(camera.send(0), counted(0));
  EXPECT_EQ(camera.send(1), counted(1));
  EXPECT_EQ(camera.send(70'000, 69'999), counted(70'000));
  EXPECT_EQ(camera.send(0x1'0000'0000U, 0x1'0000'0000 - 70'000), counted(0x1'0000'0000U));
}

/// Kind, clock of the camera, last number before, first number after, exposures that were lost between.
using Restart = std::tuple<FrameNumberKind, Clock, std::uint64_t, std::uint64_t, std::int64_t>;

class Restarts : public testing::TestWithParam<Restart> {};

TEST_P(Restarts, AreRecognisedAndTheirGapIsEstimatedFromTime) {
  const auto [kind, clock, last, first, lost] = GetParam();
  NumberedCamera camera(kind, clock, 700 * period_ns);
  const std::uint64_t before = std::min<std::uint64_t>(last, 30);
  for (std::uint64_t k = 0; k < before; ++k) ASSERT_EQ(camera.send(last - before + 1 + k), counted(k));
  camera.begin_anew();

  const FramePlace place = camera.send(first, 1 + lost);

  EXPECT_EQ(place.numbering, Numbering::restarted);
  // The host learns of a frame up to 4 ms late: less than half of a period.
  EXPECT_EQ(place.sequence, before + static_cast<std::uint64_t>(lost));
  EXPECT_EQ(camera.send(first + 1), counted(place.sequence + 1));
  EXPECT_EQ(camera.send(first + 4, 3), counted(place.sequence + 4));
}

std::string restart_name(const testing::TestParamInfo<Restart>& info) {
  const auto [kind, clock, last, first, lost] = info.param;
  return "kind" + std::to_string(static_cast<int>(kind)) + "_clock" + std::to_string(static_cast<int>(clock)) + "_" +
         std::to_string(last) + "_to_" + std::to_string(first) + "_lost" + std::to_string(lost);
}

INSTANTIATE_TEST_SUITE_P(Gvsp16, Restarts,
                         testing::Combine(testing::Values(FrameNumberKind::gvsp16),
                                          testing::Values(Clock::none, Clock::goes_on, Clock::begins_anew),
                                          testing::Values(120, 500, 20000, 32766, 40000, 60000, 65000),
                                          testing::Values(0, 1), testing::Values(0, 1, 30, 59)),
                         restart_name);
INSTANTIATE_TEST_SUITE_P(Wide, Restarts,
                         testing::Combine(testing::Values(FrameNumberKind::wide, FrameNumberKind::wrap32),
                                          testing::Values(Clock::none, Clock::goes_on, Clock::begins_anew),
                                          testing::Values(2, 3, 20, 120, 60000, 0x7FFFFFFE), testing::Values(0, 1),
                                          testing::Values(0, 1, 30, 59)),
                         restart_name);
INSTANTIATE_TEST_SUITE_P(Seek, Restarts,
                         testing::Combine(testing::Values(FrameNumberKind::wrap16), testing::Values(Clock::none),
                                          testing::Values(3, 20, 500, 32000, 60000), testing::Values(0, 1),
                                          testing::Values(0, 1, 30, 59)),
                         restart_name);

/// Aravis drops frames whose ids are up to a hundred below the last one: what comes through goes on at the next id.
class DroppedRestarts : public testing::TestWithParam<std::tuple<FrameNumberKind, Clock, std::uint64_t>> {};

TEST_P(DroppedRestarts, AreSeenByTime) {
  const auto [kind, clock, last] = GetParam();
  NumberedCamera camera(kind, clock);
  for (std::uint64_t k = 1; k <= last; ++k) ASSERT_EQ(camera.send(k), counted(k - 1));
  camera.begin_anew();

  // Ids 1 ... last are sent again and dropped.
  std::uint64_t sequence = 0;
  bool told = false;
  for (std::uint64_t k = 1; k <= 20; ++k) {
    const FramePlace place = camera.send(last + k, k == 1 ? static_cast<std::int64_t>(last) + 1 : 1);
    told = told || place.numbering == Numbering::timed;
    sequence = place.sequence;
  }

  EXPECT_TRUE(told);
  EXPECT_EQ(sequence, 2 * last + 19);
}

INSTANTIATE_TEST_SUITE_P(Gvsp, DroppedRestarts,
                         testing::Combine(testing::Values(FrameNumberKind::gvsp16, FrameNumberKind::gvsp64),
                                          testing::Values(Clock::none, Clock::goes_on, Clock::begins_anew),
                                          testing::Values(30, 45, 59, 100)));
// Of a silence below 0.3 s only the camera's clock can tell.
INSTANTIATE_TEST_SUITE_P(Short, DroppedRestarts,
                         testing::Combine(testing::Values(FrameNumberKind::gvsp16, FrameNumberKind::wide),
                                          testing::Values(Clock::goes_on), testing::Values(1, 2, 5, 14)));

/// The host learns of every frame up to two periods late, in order.
TEST(DroppedRestarts, AreSeenByABusyHost) {
  for (const std::uint64_t last : {30, 45, 59, 88}) {
    for (unsigned seed = 1; seed <= 100; ++seed) {
      std::mt19937 random(seed);
      std::uniform_int_distribution<std::int64_t> delay_ns(0, 2 * period_ns);
      FrameSequence sequence(FrameNumberKind::gvsp16, rate_hz);
      std::int64_t told_ns = 0;
      FramePlace place;
      bool told = false;
      for (std::uint64_t exposure = 1; exposure <= 2 * last + 20; ++exposure) {
        if (exposure > last && exposure <= 2 * last) continue;  // dropped
        const std::uint64_t number = exposure <= last ? exposure : exposure - last;
        told_ns = std::max(told_ns, static_cast<std::int64_t>(exposure) * period_ns + delay_ns(random));
        place = sequence.next({.number = number,
                               .device_time_ns = static_cast<std::int64_t>(number) * period_ns,
                               .host_time_ns = power_up_ns + told_ns,
                               .may_pause = false});
        told = told || place.numbering == Numbering::timed;
      }

      EXPECT_TRUE(told) << last << ", seed " << seed;
      EXPECT_NEAR(static_cast<double>(place.sequence), static_cast<double>(2 * last + 19), 3) << last << ", " << seed;
    }
  }
}

/// After a stall the frames that had been waiting are taken slowly, too.
TEST(FrameSequence, ABusyHostThatStalledHasLostNothing) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<std::int64_t> taken_ns(0, period_ns / 2);
    FrameSequence sequence(FrameNumberKind::gvsp16, rate_hz);
    std::int64_t told_ns = 0;
    for (std::uint64_t k = 1; k <= 160; ++k) {
      const auto exposed_ns = static_cast<std::int64_t>(k) * period_ns;
      const std::int64_t stalled_until_ns = k > 40 ? 80 * period_ns : 0;
      told_ns = std::max({exposed_ns, stalled_until_ns, told_ns + taken_ns(random)});

      const FramePlace place = sequence.next(
          {.number = k, .device_time_ns = exposed_ns, .host_time_ns = power_up_ns + told_ns, .may_pause = false});

      ASSERT_EQ(place, counted(k - 1)) << k << ", seed " << seed;
    }
  }
}

TEST(FrameSequence, AHostThatStalledHasLostNothing) {
  for (const Clock clock : {Clock::none, Clock::goes_on}) {
    FrameSequence sequence(FrameNumberKind::gvsp16, rate_hz);
    // Frame 41 and the 39 behind it reach the program within a moment, 0.8 s late.
    for (std::uint64_t k = 1; k <= 120; ++k) {
      const auto exposed_ns = static_cast<std::int64_t>(k) * period_ns;
      const std::int64_t stalled_until_ns = 80 * period_ns + static_cast<std::int64_t>(k) * 10'000;
      const std::int64_t arrived_ns = k > 40 ? std::max(exposed_ns, stalled_until_ns) : exposed_ns;

      const FramePlace place = sequence.next({.number = k,
                                              .device_time_ns = clock == Clock::none ? 0 : exposed_ns,
                                              .host_time_ns = power_up_ns + arrived_ns,
                                              .may_pause = false});

      ASSERT_EQ(place, counted(k - 1)) << k;
    }
  }
}

TEST(FrameSequence, AClockThatIsSetInMidStreamIsNoGap) {
  for (const std::int64_t jump : {-500'000'000'000, 900'000'000'000'000}) {
    FrameSequence sequence(FrameNumberKind::gvsp64, rate_hz);
    for (std::uint64_t k = 1; k <= 200; ++k) {
      const auto exposed_ns = 600'000'000'000 + static_cast<std::int64_t>(k) * period_ns;

      const FramePlace place = sequence.next({.number = k,
                                              .device_time_ns = exposed_ns + (k > 150 ? jump : 0),
                                              .host_time_ns = power_up_ns + exposed_ns,
                                              .may_pause = false});

      ASSERT_EQ(place, counted(k - 1)) << k;
    }
  }
}

TEST(FrameSequence, AClockThatBeginsAnewWithAFewNumbersIsARestart) {
  NumberedCamera camera(FrameNumberKind::gvsp16, Clock::begins_anew, 700 * period_ns);
  for (std::uint64_t k = 0; k < 30; ++k) static_cast<void>(camera.send(65500 + k));
  camera.begin_anew();

  // By number alone six frames would be missing.
  EXPECT_EQ(camera.send(1), (FramePlace{30, Numbering::restarted}));
  EXPECT_EQ(camera.send(2), counted(31));
}

TEST(FrameSequence, AnotherFrameRateIsOneGapAtMost) {
  NumberedCamera camera(FrameNumberKind::wide, Clock::goes_on);
  for (std::uint64_t k = 0; k < 50; ++k) static_cast<void>(camera.send(k));
  int told = 0;

  for (std::uint64_t k = 50; k < 100; ++k) told += camera.send(k, 4).numbering == Numbering::counted ? 0 : 1;

  EXPECT_LE(told, 1);
}

TEST(FrameSequence, ACorrectionThatInterruptsTheStreamIsNoGap) {
  NumberedCamera camera(FrameNumberKind::wide, Clock::goes_on);
  for (std::uint64_t k = 0; k < 10; ++k) static_cast<void>(camera.send(k));

  const FramePlace place = camera.sequence().next({.number = 10,
                                                   .device_time_ns = 40 * period_ns,
                                                   .host_time_ns = power_up_ns + 40 * period_ns,
                                                   .may_pause = true});

  EXPECT_EQ(place, counted(10));
}

TEST(FrameSequence, LearnsTheRateOfACameraThatStatesNoneOrAWrongOne) {
  for (const double stated : {0.0, 9.0, 400.0, std::nan("")}) {
    FrameSequence sequence(FrameNumberKind::gvsp16, stated);
    const auto at = [&](std::uint64_t number, std::int64_t exposure) {
      return sequence.next({.number = number,
                            .device_time_ns = exposure * period_ns,
                            .host_time_ns = power_up_ns + exposure * period_ns,
                            .may_pause = false});
    };
    for (std::int64_t k = 1; k <= 20; ++k) static_cast<void>(at(60000 + static_cast<std::uint64_t>(k), k));
    const auto last = at(60021, 21).sequence;

    const FramePlace place = at(1, 29);

    EXPECT_EQ(place, (FramePlace{last + 8, Numbering::restarted})) << stated;
  }
}

TEST(FrameSequence, ANumberThatStandsStillIsNotTheSameFrameWhileTheClockGoesOn) {
  NumberedCamera camera(FrameNumberKind::wide, Clock::goes_on);
  for (std::uint64_t k = 0; k < 10; ++k) EXPECT_EQ(camera.send(0).sequence, k);
}

TEST(FrameSequence, AnyStampsGiveAPlaceAndNeverUndefinedBehaviour) {
  for (const auto kind : {FrameNumberKind::gvsp16, FrameNumberKind::gvsp64, FrameNumberKind::wide,
                          FrameNumberKind::wrap32, FrameNumberKind::wrap16}) {
    FrameSequence sequence(kind, rate_hz);
    constexpr auto most = std::numeric_limits<std::int64_t>::max();
    constexpr std::int64_t times[] = {0, 1, most, -1, std::numeric_limits<std::int64_t>::min(), 7, period_ns};
    constexpr std::uint64_t numbers[] = {0, ~0ULL, 1, 0x8000'0000'0000'0000U, 0x7FFF'FFFF'FFFF'FFFFU, 65536, 2};
    for (int k = 0; k < 500; ++k) {
      static_cast<void>(sequence.next({.number = numbers[k % 7],
                                       .device_time_ns = times[(k / 7) % 7],
                                       .host_time_ns = power_up_ns + k,
                                       .may_pause = false}));
    }
  }
}

}  // namespace
}  // namespace todbench
