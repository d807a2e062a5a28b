// SPDX-License-Identifier: GPL-3.0-or-later
// The target of a real bench against the emulated instruments, over loopback, with a time base that tests move.
#include "tod/instruments/scpi_target.h"
#include "tod/instruments/scpi_client.h"

#include <gmock/gmock.h>

#include <cmath>
#include <future>
#include <stdexcept>
#include <thread>
#include <vector>

#include "bench/plan/instrument_description.h"
#include "sim_devices/lab/instruments/black_body.h"
#include "sim_devices/lab/instruments/plate_stage.h"
#include "tests/tod/measurement/fake_clock.h"

namespace todbench {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ScpiTargetTest : public ::testing::Test {
 protected:
  // Every reading of the clock, by either instrument or by the target, takes 10 ms: a settling of many seconds needs
  // some thousand readings and no waiting.
  ScpiTargetTest() : ScpiTargetTest(FakeClock(0.01)) {}
  explicit ScpiTargetTest(FakeClock clock) : clock_(std::move(clock)) {
    BlackBodyOptions black_body;
    black_body.now = clock_.now();
    black_body.time_constant_s = 1;
    black_body_ = BlackBody::start(black_body).value();
    PlateStageOptions stage;
    stage.plates = {"coarse", "fine"};
    stage.now = clock_.now();
    stage_ = PlateStage::start(stage).value();
    options_.black_body = black_body_->endpoint();
    options_.stage = stage_->endpoint();
    options_.black_body_table = load_instrument("scpi-black-body").value();
    options_.stage_table = load_instrument("scpi-stage").value();
    options_.poll_interval = milliseconds(0);
    options_.connection.answer_timeout = std::chrono::minutes(1);
    options_.now = clock_.now();
  }

  std::unique_ptr<Target> target() {
    auto opened = open_scpi_target(options_, {});
    if (!opened) throw std::runtime_error(opened.error().message);
    return std::move(*opened);
  }

  FakeClock clock_;
  std::unique_ptr<BlackBody> black_body_;
  std::unique_ptr<PlateStage> stage_;
  ScpiTargetOptions options_;
};

// Nothing settles: the time of the instruments stands still.
class FrozenBenchTest : public ScpiTargetTest {
 protected:
  FrozenBenchTest() : ScpiTargetTest(FakeClock()) {}
};

TEST_F(ScpiTargetTest, NamesItsInstrumentsWithTheirSerialNumbers) {
  const auto bench = target();

  EXPECT_THAT(bench->capabilities().description, HasSubstr("serial BB-0001"));
  EXPECT_THAT(bench->capabilities().description, HasSubstr("serial PS-0001"));
  EXPECT_TRUE(bench->capabilities().sets_shift);
}

TEST_F(ScpiTargetTest, PresentsAStateAndReturnsWhenBothInstrumentsHaveSettled) {
  const auto bench = target();

  const auto presented = bench->present({"fine", Mounting::mirrored_horizontally, -2, {0.25, -0.125}}, {});

  ASSERT_TRUE(presented) << presented.error().message;
  const auto& reached = presented->state;
  EXPECT_EQ(reached.plate, "fine");
  EXPECT_EQ(reached.mounting, Mounting::mirrored_horizontally);
  EXPECT_NEAR(reached.delta_t_k, -2, 0.0011);  // stable window 1 mK, read with 0.1 mK
  EXPECT_NEAR(reached.shift_mm.x, 0.25, 1e-9);
  EXPECT_NEAR(reached.shift_mm.y, -0.125, 1e-9);
  // Two sensors, each rounded to 0.1 mK and read some ticks apart within the window of 1 mK.
  EXPECT_NEAR(*presented->black_body_temperature_k - *presented->plate_temperature_k, -2, 0.0022);
  EXPECT_EQ(stage_->state().plate, "fine");
  EXPECT_TRUE(black_body_->state().is_stable);
  // ln(2/0.001) = 7.60 s into the window and 0.5 s there. The wait begins some commands (below 20 ticks) after the
  // set-point and ends within two rounds of reading (below 30 ticks) after the flag.
  EXPECT_NEAR(presented->settling_s, std::log(2 / 0.001) + 0.5, 0.3);
}

TEST_F(ScpiTargetTest, AStateThatIsThereAlreadyIsReturnedAtOnce) {
  const auto bench = target();
  const TargetState state{"fine", Mounting::identity, 0.5, {0, 0}};
  ASSERT_TRUE(bench->present(state, {}));

  const auto again = bench->present(state, {});

  ASSERT_TRUE(again) << again.error().message;
  EXPECT_LT(again->settling_s, 0.3);  // one round of reading: below 30 ticks of 10 ms
}

TEST_F(ScpiTargetTest, ABandEndsTheWaitWhereAFirstOrderApproachIsNearAndSlow) {
  options_.settling_band = 0.1;
  options_.max_relative_rate_per_s = 0.06;
  const auto bench = target();
  // The change of the plate takes longer than the wait below.
  ASSERT_TRUE(bench->present({.plate = "fine", .delta_t_k = 0}, {}));

  const auto presented = bench->present({.plate = "fine", .delta_t_k = 2, .wait = ContrastWait::within_band}, {});

  ASSERT_TRUE(presented) << presented.error().message;
  // 2 exp(-t) K are missing: below 10 % after 2.3 s, and slower than 0.06 / s after ln(1 / 0.06) = 2.8 s; a rate takes
  // at least 0.2 s of readings. To settle takes 8.1 s.
  EXPECT_NEAR(presented->settling_s, std::log(1 / 0.06), 0.7);
  EXPECT_NEAR(presented->state.delta_t_k, 2 * (1 - 0.06), 0.06);
  EXPECT_FALSE(black_body_->state().is_stable);
}

TEST_F(ScpiTargetTest, WithinABandTheNextShiftDoesNotWaitAgain) {
  const auto bench = target();
  ASSERT_TRUE(bench->present({.plate = "fine", .delta_t_k = 2, .wait = ContrastWait::within_band}, {}));

  const auto next =
      bench->present({.plate = "fine", .delta_t_k = 2, .shift_mm = {0.1, 0}, .wait = ContrastWait::within_band}, {});

  ASSERT_TRUE(next) << next.error().message;
  EXPECT_LT(next->settling_s, 0.7);  // the stage moves and comes to rest
}

TEST_F(ScpiTargetTest, AContrastOnItsWayIsNotWaitedForButThePlateIs) {
  const auto bench = target();
  ASSERT_TRUE(bench->present({.plate = "fine", .delta_t_k = 2, .wait = ContrastWait::within_band}, {}));

  const auto next =
      bench->present({.plate = "fine", .delta_t_k = 20, .shift_mm = {0.1, 0}, .wait = ContrastWait::none}, {});

  ASSERT_TRUE(next) << next.error().message;
  EXPECT_NEAR(next->state.shift_mm.x, 0.1, 1e-9);
  EXPECT_LT(next->state.delta_t_k, 15);
  EXPECT_LT(next->settling_s, 0.7);
}

TEST_F(ScpiTargetTest, StatesBeyondTheInstrumentsAreRefusedBeforeAnythingMoves) {
  const auto bench = target();
  const std::vector<TargetState> impossible{{"fine", Mounting::identity, 26, {0, 0}},
                                            {"fine", Mounting::identity, std::nan(""), {0, 0}},
                                            {"fine", Mounting::identity, 1, {5.5, 0}},
                                            {"fine", Mounting::identity, 1, {0, std::nan("")}},
                                            {"none", Mounting::identity, 1, {0, 0}}};

  for (const auto& state : impossible) {
    const auto presented = bench->present(state, {});

    ASSERT_FALSE(presented);
    EXPECT_EQ(presented.error().code, ErrorCode::invalid_input);
    EXPECT_TRUE(black_body_->state().is_stable);
    EXPECT_FALSE(stage_->state().is_moving);
  }
}

TEST_F(FrozenBenchTest, WhatDoesNotSettleIsATimeoutThatNamesInstrumentAskedAndReached) {
  FakeClock patience(60);  // every look at the clock is a minute later
  options_.now = patience.now();
  const auto bench = target();

  const auto presented = bench->present({"fine", Mounting::rotated_180, 2, {1, 0}}, {});

  ASSERT_FALSE(presented);
  EXPECT_EQ(presented.error().code, ErrorCode::timeout);
  EXPECT_EQ(presented.error().message,
            "black body (todbench Emulated differential black body, serial BB-0001): asked for 2.0000 K, reached "
            "0.0000 K, still "
            "settling; plate stage (todbench Emulated plate stage, serial PS-0001): asked for plate 'fine' rotated by "
            "180 degrees "
            "at 1.000,0.000 mm, reached plate 'coarse' not turned at 0.000,0.000 mm, still moving after 600.0 s");
}

TEST_F(ScpiTargetTest, TellsWhatIsWaitedForWhileItTakesItsTime) {
  std::vector<std::optional<TargetWait>> told;
  options_.on_wait = [&](const std::optional<TargetWait>& wait) { told.push_back(wait); };
  const auto bench = target();

  const auto presented = bench->present({"fine", Mounting::identity, 2, {0.25, 0}}, {});

  ASSERT_TRUE(presented) << presented.error().message;
  ASSERT_GE(told.size(), 3u);
  EXPECT_FALSE(told.back()) << "the wait is over";
  told.pop_back();
  double before_s = 0;
  for (const auto& wait : told) {
    ASSERT_TRUE(wait);
    EXPECT_EQ(wait->asked.delta_t_k, 2);
    EXPECT_FALSE(wait->contrast_there && wait->plate_there);
    // The interval, less one reading of the clock, which takes 10 ms, between the wait and the decision to tell of it.
    EXPECT_GE(wait->waited_s - before_s, 0.49 - 1e-9);
    EXPECT_EQ(wait->timeout_s, 600);
    before_s = wait->waited_s;
  }
  EXPECT_LE(before_s, presented->settling_s);
  EXPECT_LT(std::abs(told.front()->reached.delta_t_k - 0), std::abs(told.back()->reached.delta_t_k - 0));
  EXPECT_THAT(sentence(*told.front()), HasSubstr("2.000 K"));
  told.clear();
  ASSERT_TRUE(bench->present({"fine", Mounting::identity, 2, {0.25, 0}}, {}));
  EXPECT_THAT(told, IsEmpty()) << "what is there at once is not waited for";
}

TEST_F(FrozenBenchTest, AStopRequestEndsTheWaitForTheNextPoll) {
  options_.poll_interval = std::chrono::hours(1);  // far beyond the test's time limit
  std::promise<void> first_poll;
  int looks = 0;
  options_.now = [&, now = clock_.now()] {
    if (++looks == 2) first_poll.set_value();  // the first look is the start, the second follows the first reading
    return now();
  };
  const auto bench = target();
  std::stop_source stop;
  auto presented = std::async(std::launch::async, [&] {
    return bench->present({"coarse", Mounting::identity, 2, {0, 0}}, stop.get_token());
  });

  first_poll.get_future().wait();
  stop.request_stop();

  const auto result = presented.get();
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::interrupted);
}

TEST_F(FrozenBenchTest, AStopRequestedBeforehandMovesNothing) {
  const auto bench = target();
  std::stop_source stop;
  stop.request_stop();

  const auto presented = bench->present({"fine", Mounting::identity, 2, {0, 0}}, stop.get_token());

  EXPECT_EQ(presented.error().code, ErrorCode::interrupted);
  EXPECT_EQ(black_body_->state().set_point_k, 0);
}

TEST_F(FrozenBenchTest, AnInstrumentThatVanishesWhileSettlingIsDisconnected) {
  int looks = 0;
  options_.now = [&, now = clock_.now()] {
    if (++looks == 2) black_body_.reset();
    return now();
  };
  const auto bench = target();

  const auto presented = bench->present({"coarse", Mounting::identity, 2, {0, 0}}, {});

  ASSERT_FALSE(presented);
  EXPECT_EQ(presented.error().code, ErrorCode::disconnected);
  EXPECT_THAT(presented.error().message, HasSubstr("serial BB-0001"));
  EXPECT_EQ(bench->present({"coarse", Mounting::identity, 2, {0, 0}}, {}).error().code, ErrorCode::disconnected);
}

TEST_F(ScpiTargetTest, AnInstrumentThatComesBackIsUsedAgainAndAnotherInItsPlaceIsNot) {
  const auto bench = target();
  const auto endpoint = black_body_->endpoint();
  const auto restart_as = [&](const std::string& serial) {
    black_body_.reset();
    BlackBodyOptions options;
    options.now = clock_.now();
    options.serial = serial;
    options.time_constant_s = 0.1;
    options.server.port = static_cast<std::uint16_t>(std::stoi(endpoint.substr(endpoint.find(':') + 1)));
    black_body_ = BlackBody::start(options).value();
  };
  const TargetState state{"coarse", Mounting::identity, 2, {0, 0}};

  restart_as("BB-0001");
  EXPECT_EQ(bench->present(state, {}).error().code, ErrorCode::disconnected);
  EXPECT_TRUE(bench->present(state, {}));

  restart_as("BB-0002");
  EXPECT_EQ(bench->present(state, {}).error().code, ErrorCode::disconnected);
  EXPECT_THAT(bench->present(state, {}).error().message, HasSubstr("serial BB-0001 and is now todbench"));
}

TEST_F(ScpiTargetTest, ARefusalInMidRunIsTheInstrumentsAndNoMistakeOfThePlan) {
  const auto bench = target();
  ASSERT_TRUE(bench->present({"coarse", Mounting::identity, 1, {0, 0}}, {}));
  const auto endpoint = black_body_->endpoint();
  black_body_.reset();
  BlackBodyOptions weaker;
  weaker.now = clock_.now();
  weaker.max_delta_t_k = 1.5;
  weaker.server.port = static_cast<std::uint16_t>(std::stoi(endpoint.substr(endpoint.find(':') + 1)));
  black_body_ = BlackBody::start(weaker).value();
  const TargetState state{"coarse", Mounting::identity, 2, {0, 0}};
  ASSERT_FALSE(bench->present(state, {}));  // the old connection

  const auto refused = bench->present(state, {});

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::disconnected);
  EXPECT_THAT(refused.error().message, HasSubstr("SOUR:TEMP:DIFF 2.0000: rejected by the instrument: '-222"));
}

TEST_F(ScpiTargetTest, ATemperatureThatNothingCanHaveIsRefused) {
  for (const double plate_k : {-500.0, -1.0, 1e6}) {
    BlackBodyOptions options;
    options.now = clock_.now();
    options.time_constant_s = 1;
    options.plate_coupling = plate_k - options.ambient_k;
    black_body_ = BlackBody::start(options).value();
    options_.black_body = black_body_->endpoint();
    const auto bench = target();

    const auto presented = bench->present({"coarse", Mounting::identity, 1, {0, 0}}, {});

    ASSERT_FALSE(presented) << plate_k;
    EXPECT_EQ(presented.error().code, ErrorCode::disconnected);
    EXPECT_THAT(presented.error().message, HasSubstr("MEAS:TEMP:PLAT? answered"));
    EXPECT_THAT(presented.error().message, HasSubstr("K, which is not a possible temperature"));
  }
}

TEST_F(ScpiTargetTest, InstrumentsAtEachOthersAddressAreNotFound) {
  std::swap(options_.black_body, options_.stage);

  const auto opened = open_scpi_target(options_, {});

  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::not_found);
  EXPECT_THAT(opened.error().message, HasSubstr("black body (todbench Emulated plate stage"));
}

// A stage that obeys at once, writes down what it is told, and can be made to lie about its plate.
class StageOnPaper {
 public:
  [[nodiscard]] std::string endpoint() const { return server_->endpoint(); }
  [[nodiscard]] std::vector<std::string> take_orders() { return std::exchange(orders_, {}); }

  std::string plate = "coarse", mounting = "IDEN", position = "0,0";  // set while no present() runs
  std::string plate_in_beam;                                          // empty: the one asked for

 private:
  ScpiCommand order(std::string header, std::string StageOnPaper::*value) {
    return {header, [this, header, value](std::span<const std::string> parameters) -> ScpiAnswer {
              std::string all;
              for (const auto& parameter : parameters) all += (all.empty() ? "" : ",") + parameter;
              orders_.push_back(header + " " + all);
              this->*value = all;
              return "";
            }};
  }
  template <typename F>
  static ScpiCommand answer(std::string header, F text) {
    return {std::move(header), [text](std::span<const std::string>) -> ScpiAnswer { return text(); }};
  }

  std::vector<std::string> orders_;
  std::unique_ptr<ScpiServer> server_ =
      ScpiServer::start({},
                        {"maker,stage,7,1",
                         {order("ROUTe:PLATe", &StageOnPaper::plate), order("ROUTe:MOUNting", &StageOnPaper::mounting),
                          order("SOURce:POSition", &StageOnPaper::position),
                          answer("ROUTe:PLATe?", [this] { return scpi_quoted(plate); }),
                          answer("ROUTe:PLATe:ACTual?",
                                 [this] { return scpi_quoted(plate_in_beam.empty() ? plate : plate_in_beam); }),
                          answer("ROUTe:PLATe:CATalog?", [] { return std::string(R"("coarse","fine")"); }),
                          answer("ROUTe:MOUNting?", [this] { return mounting; }),
                          answer("ROUTe:MOUNting:ACTual?", [this] { return mounting; }),
                          answer("SOURce:POSition?", [this] { return position; }),
                          answer("SOURce:POSition:LIMits?", [] { return std::string("-5,5,-5,5"); }),
                          answer("MEASure:POSition?", [this] { return position; }),
                          answer("STATus:OPERation:CONDition?", [] { return std::string("0"); })}})
          .value();
};

TEST_F(ScpiTargetTest, MovesOnlyWhatChanged) {
  StageOnPaper stage;
  options_.stage = stage.endpoint();
  const auto bench = target();

  ASSERT_TRUE(bench->present({"coarse", Mounting::identity, 1, {0, 0}}, {}));
  EXPECT_THAT(stage.take_orders(), IsEmpty());
  ASSERT_TRUE(bench->present({"coarse", Mounting::identity, 1, {0.5, 0.25}}, {}));
  EXPECT_THAT(stage.take_orders(), ElementsAre("SOURce:POSition 0.5000,0.2500"));
  ASSERT_TRUE(bench->present({"fine", Mounting::mirrored_vertically, 1, {0.5, 0.25}}, {}));
  EXPECT_THAT(stage.take_orders(), ElementsAre("ROUTe:PLATe fine", "ROUTe:MOUNting VMIR"));

  stage.plate = "coarse";  // turned by hand
  ASSERT_TRUE(bench->present({"fine", Mounting::mirrored_vertically, 1, {0.5, 0.25}}, {}));
  EXPECT_THAT(stage.take_orders(), ElementsAre("ROUTe:PLATe fine"));
}

TEST_F(ScpiTargetTest, AnInstrumentAtRestInTheWrongPlaceIsNotBelieved) {
  StageOnPaper stage;
  stage.plate_in_beam = "coarse";
  options_.stage = stage.endpoint();
  options_.settle_timeout = std::chrono::seconds(30);
  const auto bench = target();

  const auto presented = bench->present({"fine", Mounting::identity, 0, {0, 0}}, {});

  ASSERT_FALSE(presented);
  EXPECT_EQ(presented.error().code, ErrorCode::timeout);
  EXPECT_THAT(presented.error().message, HasSubstr("asked for plate 'fine' not turned at 0.000,0.000 mm, reached plate "
                                                   "'coarse' not turned at 0.000,0.000 mm, at rest"));
}

}  // namespace
}  // namespace todbench
