// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/look_presenter.h"

#include <gmock/gmock.h>

#include <numeric>

#include "tests/bench/gui/gui_test_support.h"

namespace todbench {
namespace {

using testing::wait_until;

struct LookingBench {
  LookingBench() {
    EXPECT_TRUE(bench.select_device("sim:sc2000"));
    presenter.start();
    EXPECT_TRUE(wait_until([&] { return presenter.latest().has_value(); }));
  }
  ~LookingBench() { bench.shut_down(); }

  testing::TemporaryFolder folder;
  Workbench bench{folder.path()};
  LookPresenter presenter{bench};
};

TEST(LookPresenter, ShowsEveryPixelOfTheFrameAndReadsItInCountsAndKelvin) {
  LookingBench b;
  const Frame& frame = b.presenter.latest()->frame;

  EXPECT_EQ(b.presenter.image().size(), QSize(frame.counts.cols, frame.counts.rows));
  const auto& histogram = b.presenter.histogram();
  EXPECT_EQ(std::accumulate(histogram.begin(), histogram.end(), 0), frame.counts.cols * frame.counts.rows);
  const auto reading = b.presenter.reading(7, 3);
  ASSERT_TRUE(reading && reading->kelvin);
  EXPECT_EQ(reading->counts, frame.counts(3, 7));
  // 10 mK per count above 250 K, as the simulated sensor says.
  EXPECT_NEAR(*reading->kelvin, 250 + 0.01 * frame.counts(3, 7), 1e-9);
  EXPECT_FALSE(b.presenter.reading(frame.counts.cols, 0));
  EXPECT_FALSE(b.presenter.reading(0, -1));
}

TEST(LookPresenter, HoldsLevelAndSpanWhenToldTo) {
  LookingBench b;

  b.presenter.set_level_mode(LevelMode::fixed);
  b.presenter.set_level(5000, 200);
  const auto good = b.presenter.latest()->counters.good;
  ASSERT_TRUE(wait_until([&] { return b.presenter.latest()->counters.good > good + 2; }));

  EXPECT_EQ(b.presenter.level().low, 4900);
  EXPECT_EQ(b.presenter.level().high, 5100);
  b.presenter.set_level_mode(LevelMode::automatic);
  ASSERT_TRUE(wait_until([&] { return b.presenter.level().high != 5100; }));
}

}  // namespace
}  // namespace todbench
