// SPDX-License-Identifier: GPL-3.0-or-later
// The emulated instruments over loopback, seen through a plain socket.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>
#include <cmath>
#include <list>

#include "sim_devices/lab/instruments/black_body.h"
#include "sim_devices/lab/instruments/plate_stage.h"
#include "tests/tod/measurement/fake_clock.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

// A blocking socket without any protocol of its own; receiving ends after 20 s, so that a defect fails instead of
// hanging.
class PlainSocket {
 public:
  explicit PlainSocket(const std::string& endpoint) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const timeval limit{20, 0};
    ::setsockopt(socket_.get(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(std::stoi(endpoint.substr(endpoint.find(':') + 1))));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = ::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  [[nodiscard]] bool connected() const { return connected_; }
  bool send(std::string_view text) {
    while (!text.empty()) {
      const auto sent = ::send(socket_.get(), text.data(), text.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      text.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }
  void end_sending() { ::shutdown(socket_.get(), SHUT_WR); }
  // The next line, "(closed)" when the peer ended the connection, "(nothing)" when the limit passed.
  std::string line() {
    std::string text;
    char c = 0;
    for (;;) {
      const auto count = ::recv(socket_.get(), &c, 1, 0);
      if (count == 0 || (count < 0 && errno == ECONNRESET)) return "(closed)";
      if (count < 0) return "(nothing)";
      if (c == '\n') return text;
      text += c;
    }
  }
  std::string ask(const std::string& text) {
    send(text + "\n");
    return line();
  }

 private:
  Descriptor socket_;
  bool connected_ = false;
};

std::unique_ptr<BlackBody> black_body(const FakeClock& clock) {
  BlackBodyOptions options;
  options.time_constant_s = 4;
  options.now = clock.now();
  return BlackBody::start(options).value();
}

std::unique_ptr<PlateStage> plate_stage(const FakeClock& clock) {
  PlateStageOptions options;
  options.plates = {"coarse", "fine; 2\""};
  options.now = clock.now();
  return PlateStage::start(options).value();
}

TEST(BlackBodyTest, IdentifiesItselfAndStartsStableAtZero) {
  const auto instrument = black_body(FakeClock());
  PlainSocket socket(instrument->endpoint());

  EXPECT_EQ(socket.ask("*IDN?"), "todbench,Emulated differential black body,BB-0001,1.0");
  EXPECT_EQ(socket.ask("TEMP:DIFF?;:STAT:OPER:COND?"), "0.0000;0");
  EXPECT_EQ(socket.ask("TEMP:DIFF? MIN;DIFF? MAX"), "-25.0000;25.0000");
}

TEST(BlackBodyTest, ApproachesItsSetPointExponentiallyAndIsStableWhenTheWindowIsReached) {
  FakeClock clock;
  const auto instrument = black_body(clock);
  PlainSocket socket(instrument->endpoint());

  EXPECT_EQ(socket.ask("SOUR:TEMP:DIFF 2 K;DIFF?;:STAT:OPER:COND?"), "2.0000;2");

  // d(t) = 2 (1 - exp(-t/4)); the clock steps in whole nanoseconds: the error is below 1e-9 K.
  double time_s = 0;
  for (const double step_s : {1.0, 3.0, 8.0}) {
    clock.advance(step_s);
    time_s += step_s;
    const double expected_k = 2 * (1 - std::exp(-time_s / 4));
    EXPECT_NEAR(instrument->state().delta_t_k, expected_k, 1e-8);
    EXPECT_EQ(socket.ask("MEAS:TEMP:DIFF?"), scpi_decimal(expected_k, 4));
    EXPECT_FALSE(instrument->state().is_stable);
  }
  // Within 1 mK after 4 s ln(2/0.001) = 30.40 s, stable after another 0.5 s.
  const double stable_s = 4 * std::log(2 / 0.001) + 0.5;
  clock.advance(stable_s - time_s - 0.001);
  EXPECT_EQ(socket.ask("STAT:OPER:COND?"), "2");
  clock.advance(0.002);
  EXPECT_EQ(socket.ask("STAT:OPER:COND?"), "0");
  EXPECT_NEAR(instrument->state().delta_t_k, 2, 0.001);
}

TEST(BlackBodyTest, ANewSetPointStartsFromWhereTheTemperatureIs) {
  FakeClock clock;
  const auto instrument = black_body(clock);
  PlainSocket socket(instrument->endpoint());
  socket.ask("SOUR:TEMP:DIFF 10;DIFF?");
  clock.advance(4);
  const double reached_k = 10 * (1 - std::exp(-1.0));

  socket.ask("SOUR:TEMP:DIFF -10;DIFF?");

  EXPECT_NEAR(instrument->state().delta_t_k, reached_k, 1e-8);
  clock.advance(4);
  EXPECT_NEAR(instrument->state().delta_t_k, -10 + (reached_k + 10) * std::exp(-1.0), 1e-8);
}

TEST(BlackBodyTest, ShowsTheHeatedPlateAndTheErrorOfItsSensor) {
  FakeClock clock;
  BlackBodyOptions options;
  options.now = clock.now();
  options.ambient_k = 290;
  options.plate_coupling = 0.1;
  options.real_delta_t_k = [](double indicated_k) { return 0.9 * indicated_k + 0.05; };
  const auto instrument = BlackBody::start(options).value();
  PlainSocket socket(instrument->endpoint());

  socket.ask("SOUR:TEMP:DIFF 10;DIFF?");
  clock.advance(1000);  // exp(-250) of the way is left

  EXPECT_NEAR(instrument->state().delta_t_k, 9.05, 1e-9);
  EXPECT_EQ(socket.ask("MEAS:TEMP:DIFF?"), "10.0000");
  EXPECT_EQ(socket.ask("MEAS:TEMP:PLAT?"), "290.9050");
  EXPECT_EQ(socket.ask("MEAS:TEMP:BBOD?"), "299.9550");
}

TEST(BlackBodyTest, ShowsAnotherContrastThanItSaysAndAnotherErrorAtEverySetPoint) {
  FakeClock clock;
  BlackBodyOptions options;
  options.now = clock.now();
  options.real_delta_t_k = [](double indicated_k) { return indicated_k < 1 ? indicated_k + 0.01 : 0.98 * indicated_k; };
  const auto instrument = BlackBody::start(options).value();
  PlainSocket socket(instrument->endpoint());

  socket.ask("SOUR:TEMP:DIFF 0.25;DIFF?");
  clock.advance(1000);  // exp(-250) of the way is left
  EXPECT_NEAR(instrument->state().delta_t_k, 0.26, 1e-9);
  EXPECT_NEAR(instrument->state().indicated_delta_t_k, 0.25, 1e-9);
  EXPECT_EQ(socket.ask("MEAS:TEMP:DIFF?;:SOUR:TEMP:DIFF?;:STAT:OPER:COND?"), "0.2500;0.2500;0");

  socket.ask("SOUR:TEMP:DIFF 2;DIFF?");
  clock.advance(1000);
  EXPECT_NEAR(instrument->state().delta_t_k, 1.96, 1e-9);
  EXPECT_EQ(socket.ask("MEAS:TEMP:DIFF?;:SOUR:TEMP:DIFF?;:STAT:OPER:COND?"), "2.0000;2.0000;0");
}

TEST(BlackBodyTest, RefusesImpossibleOptionsAndASecondOneOnItsPort) {
  BlackBodyOptions bad, nowhere;
  bad.time_constant_s = std::nan("");
  nowhere.real_delta_t_k = [](double) { return std::nan(""); };
  const auto first = black_body(FakeClock());
  BlackBodyOptions same_port;
  same_port.server.port = static_cast<std::uint16_t>(std::stoi(first->endpoint().substr(10)));

  EXPECT_EQ(BlackBody::start(bad).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(BlackBody::start(nowhere).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(BlackBody::start(same_port).error().code, ErrorCode::not_found);
}

TEST(PlateStageTest, RunsInAStraightLineAtItsSpeedAndComesToRest) {
  FakeClock clock;
  const auto stage = plate_stage(clock);
  PlainSocket socket(stage->endpoint());

  // 3-4-5: 5 mm at 10 mm/s are 0.5 s, and 0.2 s to come to rest.
  EXPECT_EQ(socket.ask("SOUR:POS 3,-4 mm;POS?"), "3.0000,-4.0000");

  clock.advance(0.25);
  EXPECT_EQ(socket.ask("MEAS:POS?"), "1.5000,-2.0000");
  EXPECT_NEAR(stage->state().shift_mm.y, -2, 1e-9);
  clock.advance(0.3);
  EXPECT_EQ(socket.ask("MEAS:POS?;:STAT:OPER:COND?"), "3.0000,-4.0000;2");
  clock.advance(0.2);
  EXPECT_EQ(socket.ask("STAT:OPER:COND?"), "0");
}

TEST(PlateStageTest, ChangesPlateAndMountingAfterTheirTimes) {
  FakeClock clock;
  const auto stage = plate_stage(clock);
  PlainSocket socket(stage->endpoint());
  EXPECT_EQ(socket.ask("ROUT:PLAT:CAT?"), R"("coarse","fine; 2""")");

  EXPECT_EQ(socket.ask(R"(ROUT:PLAT "fine; 2""";:ROUT:MOUN VMIRrored;MOUN?)"), "VMIR");

  EXPECT_EQ(socket.ask("ROUT:PLAT:ACT?;:ROUT:MOUN:ACT?;:STAT:OPER:COND?"), R"("coarse";IDEN;2)");
  clock.advance(3.5);
  EXPECT_EQ(stage->state().mounting, Mounting::mirrored_vertically);
  EXPECT_EQ(stage->state().plate, "coarse");
  EXPECT_TRUE(stage->state().is_moving);
  clock.advance(2);
  EXPECT_EQ(socket.ask("ROUT:PLAT:ACT?;:ROUT:MOUN:ACT?;:STAT:OPER:COND?"), R"("fine; 2""";VMIR;0)");
}

TEST(PlateStageTest, RefusesWhatItCannotReachAndStaysWhereItIs) {
  FakeClock clock;
  const auto stage = plate_stage(clock);
  PlainSocket socket(stage->endpoint());

  EXPECT_THAT(socket.ask("SOUR:POS 5.1,0;:SYST:ERR?"), StartsWith("-222"));
  EXPECT_THAT(socket.ask("ROUT:PLAT \"none\";:SYST:ERR?"), StartsWith("-224"));
  EXPECT_THAT(socket.ask("ROUT:MOUN SIDEWAYS;:SYST:ERR?"), StartsWith("-224"));

  EXPECT_EQ(socket.ask("SOUR:POS?;POS:LIM?"), "0.0000,0.0000;-5.0000,5.0000,-5.0000,5.0000");
  EXPECT_FALSE(stage->state().is_moving);
}

TEST(ScpiServerTest, SkipsALineThatIsTooLongAndGoesOn) {
  const auto instrument = black_body(FakeClock());
  PlainSocket socket(instrument->endpoint());

  socket.send(std::string(1'000'000, 'x') + "\n");

  EXPECT_EQ(socket.ask("SYST:ERR?"), "-363,\"Input buffer overrun\"");
  EXPECT_EQ(socket.ask("TEMP:DIFF?"), "0.0000");
}

TEST(ScpiServerTest, AnswersBytesThatAreNoTextWithAnError) {
  const auto instrument = black_body(FakeClock());
  PlainSocket socket(instrument->endpoint());
  std::string bytes;
  for (int i = 0; i < 256; ++i)
    if (i != '\n') bytes += static_cast<char>(i);

  socket.send(bytes + "\n\n\r\n");

  EXPECT_THAT(socket.ask("SYST:ERR?"), StartsWith("-101"));
  EXPECT_THAT(socket.ask("SYST:ERR?"), StartsWith("0,"));
}

TEST(ScpiServerTest, ServesSeveralClientsAndClosesThoseBeyondItsLimit) {
  const auto instrument = black_body(FakeClock());
  std::list<PlainSocket> clients;
  for (int i = 0; i < 8; ++i) {
    clients.emplace_back(instrument->endpoint());
    ASSERT_THAT(clients.back().ask("*IDN?"), HasSubstr("BB-0001"));
  }

  PlainSocket ninth(instrument->endpoint());
  EXPECT_EQ(ninth.line(), "(closed)");

  clients.front().send("SOUR:TEMP:DIFF 1.25\n");
  EXPECT_EQ(clients.front().ask("TEMP:DIFF?"), "1.2500");
  for (auto& client : clients) EXPECT_EQ(client.ask("TEMP:DIFF?"), "1.2500");
}

TEST(ScpiServerTest, DeliversItsAnswersToAClientThatHasFinishedSending) {
  const auto instrument = black_body(FakeClock());
  PlainSocket socket(instrument->endpoint());

  socket.send("*IDN?\nTEMP:DIFF?\n");
  socket.end_sending();

  EXPECT_THAT(socket.line(), HasSubstr("BB-0001"));
  EXPECT_EQ(socket.line(), "0.0000");
  EXPECT_EQ(socket.line(), "(closed)");
}

TEST(ScpiServerTest, DestructionEndsItsConnections) {
  auto instrument = black_body(FakeClock());
  PlainSocket socket(instrument->endpoint());
  ASSERT_THAT(socket.ask("*IDN?"), HasSubstr("BB-0001"));

  instrument.reset();

  EXPECT_EQ(socket.line(), "(closed)");
}

/// A stage whose runs are in a time of their own.
struct RunningStage {
  double camera_s = 2;
  FakeClock clock;
  std::unique_ptr<PlateStage> stage;
  explicit RunningStage(bool trigger = true, double jitter_mm = 0) {
    PlateStageOptions options;
    options.plates = {"coarse"};
    options.travel_mm = 20;
    options.speed_mm_per_s = 100;
    options.now = clock.now();
    options.camera_clock_s = [this] { return camera_s; };
    options.has_trigger = trigger;
    options.run_jitter_mm = jitter_mm;
    stage = PlateStage::start(options).value();
  }
};

TEST(PlateStageTest, RunsAtConstantSpeedInTheTimeOfTheCamera) {
  RunningStage bench;
  PlainSocket socket(bench.stage->endpoint());
  EXPECT_EQ(socket.ask("SCAN:LIM?"), "0.0100,100.0000");
  EXPECT_EQ(socket.ask("MEAS:SCAN?"), "0,0,0,9.91E37");
  socket.ask("POS -10,1;POS?");
  bench.clock.advance(1);

  EXPECT_EQ(socket.ask("SCAN 10,40;:MEAS:SCAN?"), "-10.0000,10.0000,40.0000,2.000000000");

  EXPECT_EQ(socket.ask("STAT:OPER:COND?"), "2");
  bench.clock.advance(3600);  // the run does not know of it
  bench.camera_s = 2.1;
  EXPECT_NEAR(bench.stage->state().shift_mm.x, -6, 1e-9);
  EXPECT_EQ(bench.stage->state().shift_mm.y, 1);
  EXPECT_EQ(bench.stage->state().speed_mm_per_s, 40);
  EXPECT_NEAR(bench.stage->state_at(2.25).shift_mm.x, 0, 1e-9);
  bench.camera_s = 2.6;
  EXPECT_EQ(bench.stage->state().shift_mm.x, 10);
  EXPECT_EQ(bench.stage->state().speed_mm_per_s, 0);
  EXPECT_EQ(socket.ask("STAT:OPER:COND?"), "0");
  // Back, and sent elsewhere on the way.
  EXPECT_EQ(socket.ask("SCAN -10,10;:MEAS:SCAN?"), "10.0000,-10.0000,10.0000,2.600000000");
  bench.camera_s = 2.7;
  EXPECT_EQ(bench.stage->state().speed_mm_per_s, -10);
  EXPECT_NEAR(bench.stage->state().shift_mm.x, 9, 1e-9);
  socket.ask("POS 9,1;POS?");
  bench.clock.advance(1);
  EXPECT_EQ(bench.stage->state().shift_mm, cv::Point2d(9, 1));
  EXPECT_EQ(bench.stage->state().speed_mm_per_s, 0);
}

TEST(PlateStageTest, RefusesRunsThatItCannotMake) {
  RunningStage bench;
  PlainSocket socket(bench.stage->endpoint());
  for (const char* wrong : {"SCAN 21,10", "SCAN 5,0", "SCAN 5,101", "SCAN 5", "SCAN nan,10", "SCAN 0,10"}) {
    socket.send(std::string(wrong) + "\n");
    EXPECT_NE(socket.ask("SYST:ERR?").substr(0, 2), "0,") << wrong;
  }
  EXPECT_EQ(bench.stage->state().speed_mm_per_s, 0);
}

TEST(PlateStageTest, WithoutATriggerDoesNotSayWhenARunBeganAndJitters) {
  RunningStage bench(false, 0.05);
  PlainSocket socket(bench.stage->endpoint());

  EXPECT_EQ(socket.ask("SCAN 10,10;:MEAS:SCAN?"), "0.0000,10.0000,10.0000,9.91E37");

  double squares = 0;
  constexpr int count = 500;
  for (int i = 0; i < count; ++i) {
    const double time_s = 2 + 0.0015 * i;
    squares += std::pow(bench.stage->state_at(time_s).shift_mm.x - 10 * (time_s - 2), 2) / count;
  }
  // The variance of 500 normal numbers has a relative standard error of 6.3 %.
  EXPECT_NEAR(squares / (0.05 * 0.05), 1, 0.26);
}

}  // namespace
}  // namespace todbench
