// SPDX-License-Identifier: GPL-3.0-or-later
// Instruments as data: their words, their ways (TCP, serial port, VXI-11), and hostile ones.
#include "tod/instruments/instrument_table.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <mutex>
#include <thread>

#include "bench/plan/instrument_description.h"
#include "sim_devices/lab/instruments/black_body.h"
#include "sim_devices/lab/instruments/plate_stage.h"
#include "tests/support/source_file.h"
#include "tests/tod/instruments/scpi_lines.h"
#include "tests/tod/measurement/fake_clock.h"
#include "tod/instruments/instrument_check.h"
#include "tod/instruments/onc_rpc.h"
#include "tod/instruments/scpi_target.h"
#include "tod/instruments/vxi11_line.h"

namespace todbench {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Optional;

std::string example_instrument(const std::string& file) {
  return source_file("docs/examples/instruments/" + file);
}

// Patient with a busy machine: what the test waits for comes, or the test program is ended.
ScpiClientOptions patient() {
  ScpiClientOptions options;
  options.connect_timeout = options.answer_timeout = std::chrono::minutes(1);
  return options;
}

ScpiCommand says(std::string header, std::string answer) {
  return {std::move(header), [answer](std::span<const std::string>) -> ScpiAnswer { return answer; }};
}

// Listens on loopback; each connection is served by `serve` until the test ends.
class LoopbackPeer {
 public:
  using Serve = std::function<void(const std::stop_token&, int fd)>;
  explicit LoopbackPeer(Serve serve) : listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    ::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), size);
    ::listen(listener_.get(), 4);
    ::getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&address), &size);
    address_ = "127.0.0.1:" + std::to_string(ntohs(address.sin_port));
    thread_ = std::jthread([this, serve = std::move(serve)](const std::stop_token& stop) {
      while (wait_on(listener_.get(), WaitFor::reading, std::nullopt, stop) == Waited::ready) {
        const Descriptor socket(::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
        serve(stop, socket.get());
      }
    });
  }
  [[nodiscard]] const std::string& address() const { return address_; }

 private:
  Descriptor listener_;
  std::string address_;
  std::jthread thread_;
};

// Hands bytes on between a client and an instrument and keeps what the client said.
class Tap {
 public:
  explicit Tap(const std::string& instrument)
      : peer_([this, instrument](const std::stop_token& stop, int client) {
          const auto place = instrument_address(instrument).value();
          const auto ours = connect_tcp(place.host, place.port, soon(), stop).value();
          const StopEvent stop_event(stop);
          while (!stop.stop_requested()) {
            std::array<pollfd, 3> polled{{{client, POLLIN, 0}, {ours.get(), POLLIN, 0}, {stop_event.fd(), POLLIN, 0}}};
            ::poll(polled.data(), polled.size(), -1);
            if (polled[0].revents != 0) {
              const auto some = receive_some(client, soon(), stop);
              if (!some) return;
              {
                const std::scoped_lock lock(mutex_);
                said_ += *some;
              }
              if (!send_all(ours.get(), *some, soon(), stop)) return;
            }
            if (polled[1].revents != 0) {
              const auto some = receive_some(ours.get(), soon(), stop);
              if (!some || !send_all(client, *some, soon(), stop)) return;
            }
          }
        }) {}
  [[nodiscard]] const std::string& address() const { return peer_.address(); }
  [[nodiscard]] std::string said() {
    const std::scoped_lock lock(mutex_);
    return said_;
  }

 private:
  static InstrumentLine::TimePoint soon() { return std::chrono::steady_clock::now() + std::chrono::minutes(1); }
  std::mutex mutex_;
  std::string said_;
  LoopbackPeer peer_;
};

TEST(InstrumentTableTest, AnswersHaveToLookLikeTheirForm) {
  EXPECT_THAT(numbers_in("1.5", "{}"), Optional(ElementsAre(1.5)));
  EXPECT_THAT(numbers_in(" +1.5 , -2E3 ", "{},{}"), Optional(ElementsAre(1.5, -2000)));
  EXPECT_THAT(numbers_in("D=  2499 mK", "D={} mK"), Optional(ElementsAre(2499)));
  EXPECT_THAT(numbers_in("D=2499mK", "D={} mK"), Optional(ElementsAre(2499)));
  for (const auto* wrong : {"", "1.5 K", "nan", "inf", "1e999", "1.5,2", "--1", "+-"})
    EXPECT_FALSE(numbers_in(wrong, "{}")) << wrong;
  EXPECT_FALSE(numbers_in("D=2.499 K", "D={} mK"));
  EXPECT_FALSE(numbers_in("2499 mK", "D={} mK"));
}

TEST(InstrumentTableTest, AddressesSayTheWay) {
  EXPECT_EQ(instrument_address("10.0.0.7")->port, 5025);
  EXPECT_EQ(instrument_address("[::1]:77")->host, "::1");
  EXPECT_EQ(instrument_address("serial:/dev/ttyUSB0")->device, "/dev/ttyUSB0");
  EXPECT_EQ(instrument_address("vxi11:bench")->device, "inst0");
  EXPECT_EQ(instrument_address("vxi11:bench:1024/gpib0,5")->device, "gpib0,5");
  EXPECT_EQ(instrument_address("vxi11:bench:1024")->port, 1024);
  for (const auto* wrong : {"", "serial:", "serial:ttyUSB0", "vxi11:", "vxi11:a:0", "vxi11:a/", "a b:1", "x/y:1",
                            "a:70000", "serial:/dev/tty\nS0"})
    EXPECT_FALSE(instrument_address(wrong)) << wrong;
}

// What the program sent before instruments were files; the shipped files have to say the same, byte for byte.
TEST(InstrumentTableTest, TheShippedTablesSayWhatTheProgramAlwaysSaid) {
  const FakeClock clock(0.01);
  BlackBodyOptions heat;
  heat.now = clock.now();
  const auto black_body = BlackBody::start(heat).value();
  PlateStageOptions moves;
  moves.plates = {"coarse", "fi\"ne"};
  moves.now = clock.now();
  moves.plate_change_s = moves.mounting_change_s = moves.settle_s = 0;
  moves.speed_mm_per_s = 1e9;
  const auto stage = PlateStage::start(moves).value();
  Tap heard_by_black_body(black_body->endpoint()), heard_by_stage(stage->endpoint());
  ScpiTargetOptions options;
  options.black_body = heard_by_black_body.address();
  options.stage = heard_by_stage.address();
  options.black_body_table = load_instrument("scpi-black-body").value();
  options.stage_table = load_instrument("scpi-stage").value();
  options.connection = patient();
  options.poll_interval = milliseconds(0);
  options.now = clock.now();

  const auto target = open_scpi_target(options, {}).value();
  // Below the tolerance: there at once, so that there is one round of reading.
  ASSERT_TRUE(target->present({"fi\"ne", Mounting::mirrored_vertically, 0.001, {0.25, -0.5}}, {}));

  const auto each = [](std::initializer_list<const char*> words) {
    std::string text = "*CLS\n*IDN?\n";
    for (const auto* word : words) text += std::string(word) + "\nSYST:ERR?\n";
    return text;
  };
  EXPECT_THAT(heard_by_black_body.said(),
              ::testing::StartsWith(
                  each({"SOUR:TEMP:DIFF? MIN", "SOUR:TEMP:DIFF? MAX", "SOUR:TEMP:DIFF?", "SOUR:TEMP:DIFF 0.0010",
                        "STAT:OPER:COND?", "MEAS:TEMP:DIFF?", "MEAS:TEMP:PLAT?", "MEAS:TEMP:BBOD?"})));
  EXPECT_THAT(heard_by_stage.said(),
              ::testing::StartsWith(each({"SOUR:POS:LIM?", "ROUT:PLAT:CAT?", "ROUT:PLAT?", R"(ROUT:PLAT "fi""ne")",
                                          "ROUT:MOUN?", "ROUT:MOUN VMIR", "SOUR:POS?", "SOUR:POS 0.2500,-0.5000",
                                          "STAT:OPER:COND?", "ROUT:PLAT:ACT?", "ROUT:MOUN:ACT?", "MEAS:POS?"})));
}

TEST(InstrumentTableTest, FilesAreReadStrictly) {
  const std::string good =
      "kind = \"black_body\"\ndescription = \"x\"\n[difference]\nunit = \"K\"\nset = \"S {}\"\nmeasured = \"M\"\n"
      "range = [-5, 5]\ntolerance = 0.01\n[settled]\ndwell_s = 1\n";
  const auto parsed = [](const std::string& text) { return parse_instrument({"x.toml", text}); };
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  };
  ASSERT_TRUE(parsed(good)) << parsed(good).error().message;
  const std::vector<std::pair<std::string, const char*>> wrong{
      {good + "answerr = 1\n", "settled.answerr"},
      {changed("\"S {}\"", "\"S\""), "difference.set"},
      {changed("\"S {}\"", "\"S {} {}\""), "difference.set"},
      {changed("\"S {}\"", "\"S {}\\n*RST\""), "difference.set"},
      {changed("\"K\"", "\"degrees\""), "difference.unit"},
      {changed("[-5, 5]", "[5, -5]"), "difference.range"},
      {changed("[-5, 5]", "[nan, 5]"), "difference.range"},
      {changed("range = [-5, 5]\n", ""), "difference.limits"},
      {changed("0.01", "0"), "difference.tolerance"},
      {changed("measured = \"M\"\n", ""), "difference.measured"},
      {changed("dwell_s = 1", "query = \"Q\""), "settled.query"},
      {changed("dwell_s = 1", "dwell_s = 0"), "settled.dwell_s"},
      {changed("dwell_s = 1", "query = \"Q\"\nbit = 16"), "settled.bit"},
      {good + "[serial]\nbaud = 9601\n", "serial.baud"},
      {good + "[errors]\nasked = \"with each command\"\n", "errors.asked"},
      {good + "[plate]\nset = \"{}\"\n", "plate"},
      {changed("\"black_body\"", "\"oven\""), "kind"}};
  for (const auto& [text, key] : wrong) {
    const auto table = parsed(text);

    ASSERT_FALSE(table) << text;
    EXPECT_EQ(table.error().code, ErrorCode::invalid_input) << text;
    ASSERT_TRUE(table.error().key) << text;
    EXPECT_EQ(table.error().key->name, key) << text;
  }
}

// The instrument of docs/examples/instruments/plain-black-body.toml.
ScpiLanguage plain_black_body(std::shared_ptr<std::atomic<int>> difference_mk) {
  return {"unused",
          {says("ID", "AREA 4 BLACKBODY V2.1"),
           {"SD",
            [difference_mk](std::span<const std::string> words) -> ScpiAnswer {
              *difference_mk = std::stoi(words.front());
              return "OK";
            }},
           {"RD",
            [difference_mk](std::span<const std::string>) -> ScpiAnswer {
              return "D= " + std::to_string(*difference_mk + 1) + " mK";
            }},
           says("RT", "T= 21.50 C"),
           says("ST", "STABLE")}};
}

TEST(InstrumentTableTest, AnInstrumentOfItsOwnWordsOnASerialPortIsMeasuredWith) {
  const auto difference_mk = std::make_shared<std::atomic<int>>(0);
  const auto port = ScpiSerialPort::start(plain_black_body(difference_mk), "\r").value();
  const FakeClock clock(0.1);
  PlateStageOptions moves;
  moves.plates = {"fine"};
  moves.now = clock.now();
  const auto stage = PlateStage::start(moves).value();
  ScpiTargetOptions options;
  options.black_body = port->address();
  options.stage = stage->endpoint();
  options.black_body_table = load_instrument(example_instrument("plain-black-body.toml")).value();
  options.black_body_table.speech.answer_timeout_s.reset();
  options.stage_table = load_instrument("scpi-stage").value();
  options.connection = patient();
  options.poll_interval = milliseconds(0);
  options.now = clock.now();

  const auto target = open_scpi_target(options, {});
  ASSERT_TRUE(target) << target.error().message;
  const auto shown = (*target)->present({"fine", Mounting::identity, 2.5, {0, 0}}, {});

  ASSERT_TRUE(shown) << shown.error().message;
  EXPECT_EQ(*difference_mk, 2500);
  EXPECT_NEAR(shown->state.delta_t_k, 2.501, 1e-12);
  EXPECT_NEAR(shown->plate_temperature_k.value_or(0), 294.65, 1e-9);
  EXPECT_FALSE(shown->black_body_temperature_k);
  EXPECT_GE(shown->settling_s, 2) << "as long as its file wants it in place";
  EXPECT_EQ((*target)->present({"fine", Mounting::identity, 51, {0, 0}}, {}).error().code, ErrorCode::invalid_input);
}

TEST(InstrumentTableTest, WhatIsNoSerialPortIsNotFound) {
  for (const auto* path : {"serial:/dev/null", "serial:/nonexistent/tty", "serial:/proc/self/status"}) {
    const auto client = ScpiClient::connect(path, patient(), {});

    ASSERT_FALSE(client) << path;
    EXPECT_EQ(client.error().code, ErrorCode::not_found) << client.error().message;
  }
}

TEST(InstrumentTableTest, ASerialPortInUseIsSaidToBe) {
  const auto port = ScpiSerialPort::start({"a,b,c,d", {}}).value();
  const auto first = ScpiClient::connect(port->address(), patient(), {});
  ASSERT_TRUE(first) << first.error().message;

  const auto second = ScpiClient::connect(port->address(), patient(), {});

  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("in use"));
}

TEST(InstrumentTableTest, Vxi11CarriesTheSameTalk) {
  const auto server = ScpiVxi11Server::start({"maker,model,42,1.0",
                                              {says("MEASure:LONG?", std::string(5000, '7')), says("VALue?", "1.5,-2"),
                                               says("SOURce:SOMEthing", "")}})
                          .value();
  auto client = ScpiClient::connect(server->address(), patient(), {});
  ASSERT_TRUE(client) << client.error().message;

  EXPECT_EQ(client->identity().serial, "42");
  EXPECT_THAT(client->query_form("VAL?", "{},{}", {}).value(), ElementsAre(1.5, -2));
  EXPECT_EQ(client->query("MEAS:LONG?", {}).value(), std::string(5000, '7')) << "in more than one piece";
  EXPECT_TRUE(client->command("SOUR:SOME 1,2,3,4,5,6,7,8,9", {}));
  EXPECT_EQ(client->command("NONSENSE", {}).error().code, ErrorCode::invalid_input);
  const auto refused = client->query("NONSENSE?", {});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("-113"));
  EXPECT_THAT(client->query_form("VAL?", "{},{}", {}).value(), ElementsAre(1.5, -2)) << "still in step";
}

TEST(InstrumentTableTest, ThePortMapperSaysWhereVxi11Is) {
  const auto server = ScpiVxi11Server::start({"maker,model,42,1.0", {}}).value();
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  const auto address = instrument_address("vxi11:127.0.0.1").value();

  {
    const auto line = open_vxi11_line(address, deadline, {}, server->port());
    EXPECT_TRUE(line) << line.error().message;
  }
  auto elsewhere = address;
  elsewhere.device = "inst7";
  const auto none = open_vxi11_line(elsewhere, deadline, {}, server->port());

  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::not_found) << none.error().message;
}

TEST(InstrumentTableTest, RecordsThatAreNoneOfRpcAreRefused) {
  const auto peer_saying = [](std::string bytes) {
    return [bytes](const std::stop_token& stop, int fd) {
      (void)send_all(fd, bytes, std::chrono::steady_clock::now() + std::chrono::minutes(1), stop);
      (void)wait_on(fd, WaitFor::reading, std::nullopt, stop);
    };
  };
  XdrWriter accepted;  // answers call 1, with a result that is too short
  for (const std::uint32_t value : {1U, 1U, 0U, 0U, 0U, 0U, 0U}) accepted.number(value);
  for (const std::string& bytes : {std::string("HTTP/1.1 400 Bad Request\r\n\r\n"), std::string(8, '\xff'),
                                   std::string(4, '\0'), rpc_record("x"), rpc_record(accepted.data())}) {
    const LoopbackPeer peer(peer_saying(bytes));

    const auto client = ScpiClient::connect("vxi11:" + peer.address(), patient(), {});

    ASSERT_FALSE(client);
    EXPECT_EQ(client.error().code, ErrorCode::not_found) << client.error().message;
  }
}

InstrumentStep step_of(const InstrumentCheck& check, const std::string& name) {
  for (const auto& step : check.steps) {
    if (step.name == name) return step;
  }
  return {};
}

TEST(InstrumentCheckTest, EmulatedInstrumentsPassWithTheirCommands) {
  const auto black_body = BlackBody::start({}).value();
  PlateStageOptions moves;
  moves.plates = {"a", "b"};
  const auto stage = PlateStage::start(moves).value();

  const auto heat = check_instrument(load_instrument("scpi-black-body").value(), black_body->endpoint(),
                                     InstrumentCommands::in_place, patient(), {});
  const auto place = check_instrument(load_instrument("scpi-stage").value(), stage->endpoint(),
                                      InstrumentCommands::in_place, patient(), {});

  for (const auto& check : {heat, place}) {
    ASSERT_TRUE(check) << check.error().message;
    EXPECT_TRUE(check->passed());
    for (const auto& step : check->steps) EXPECT_EQ(step.outcome, StepOutcome::answered) << step.name << step.said;
  }
  EXPECT_EQ(step_of(*place, "plates").said, "a, b");
  EXPECT_EQ(step_of(*heat, "difference command").sent, "SOUR:TEMP:DIFF 0.0000");
}

TEST(InstrumentCheckTest, SaysEachStepThatIsAnsweredWrongly) {
  const auto answers = [](const std::string& temperature, const std::string& condition) {
    return ScpiServer::start(
               {}, {"maker,model,1,1",
                    {says("SOURce:TEMPerature:DIFFerence?", "1"), says("MEASure:TEMPerature:DIFFerence?", temperature),
                     says("MEASure:TEMPerature:PLATe?", "295"), says("MEASure:TEMPerature:BBODy?", "22"),
                     says("STATus:OPERation:CONDition?", condition)}})
        .value();
  };
  const auto table = load_instrument("scpi-black-body").value();
  for (const auto* temperature : {"nan", "inf", "1.5 F", "1,2", "1.5V", "-"}) {
    const auto server = answers(temperature, "70000");

    const auto check = check_instrument(table, server->endpoint(), InstrumentCommands::none, patient(), {});

    ASSERT_TRUE(check) << check.error().message;
    EXPECT_FALSE(check->passed());
    EXPECT_EQ(step_of(*check, "limits").outcome, StepOutcome::failed) << "lowest and highest are the same";
    EXPECT_EQ(step_of(*check, "set-point").outcome, StepOutcome::answered);
    EXPECT_EQ(step_of(*check, "measured difference").outcome, StepOutcome::failed) << temperature;
    EXPECT_EQ(step_of(*check, "plate temperature").outcome, StepOutcome::answered) << "after a new connection";
    EXPECT_EQ(step_of(*check, "settled").outcome, StepOutcome::failed);
  }
}

TEST(InstrumentCheckTest, SilentEndlessAndHalfAnswersEndInASentence) {
  const auto table = load_instrument("scpi-black-body").value();
  for (const std::string& speech : {std::string(), std::string(100'000, 'x'), std::string("maker,mod")}) {
    const LoopbackPeer peer([&](const std::stop_token& stop, int fd) {
      (void)send_all(fd, speech, std::chrono::steady_clock::now() + std::chrono::minutes(1), stop);
      while (wait_on(fd, WaitFor::reading, std::nullopt, stop) == Waited::ready)
        if (!receive_some(fd, std::chrono::steady_clock::now(), stop)) return;
    });
    ScpiClientOptions options = patient();
    options.answer_timeout = milliseconds(50);

    const auto check = check_instrument(table, peer.address(), InstrumentCommands::none, options, {});

    ASSERT_TRUE(check);
    EXPECT_FALSE(check->reached);
    EXPECT_FALSE(check->passed());
    ASSERT_EQ(check->steps.size(), 1U);
    EXPECT_LT(check->steps.front().said.size(), 300U);
  }
  EXPECT_EQ(check_instrument(table, "nowhere:x", InstrumentCommands::none, {}, {}).error().code,
            ErrorCode::invalid_input);
}

TEST(InstrumentCheckTest, AnotherInstrumentThanTheFileIsAboutIsRefused) {
  const auto port = ScpiSerialPort::start({"unused", {says("ID", "OVEN 7")}}, "\r").value();
  auto table = load_instrument(example_instrument("plain-black-body.toml")).value();
  table.speech.answer_timeout_s.reset();

  const auto check = check_instrument(table, port->address(), InstrumentCommands::none, patient(), {});

  ASSERT_TRUE(check);
  EXPECT_FALSE(check->reached);
  EXPECT_THAT(check->steps.front().said, HasSubstr("BLACKBODY"));
}

TEST(InstrumentCheckTest, TwoAxesWithCommandsOfTheirOwn) {
  std::vector<std::string> orders;
  const auto order = [&](const char* header) {
    return ScpiCommand{header, [&orders, header](std::span<const std::string>) -> ScpiAnswer {
                         orders.emplace_back(header);
                         return "";
                       }};
  };
  const auto server =
      ScpiServer::start(
          {}, {"unused", {says("1TP?", "1500"), says("2TP?", "-251"), order("1PA1500.0"), order("2PA-251.0")}})
          .value();
  const auto table = load_instrument(example_instrument("two-axis-stage.toml")).value();

  const auto check = check_instrument(table, server->endpoint(), InstrumentCommands::in_place, patient(), {});

  ASSERT_TRUE(check) << check.error().message;
  EXPECT_TRUE(check->passed());
  EXPECT_EQ(step_of(*check, "measured position").said, "1.500, -0.251 mm");
  EXPECT_EQ(step_of(*check, "position command").sent, "1PA1500.0; 2PA-251.0");
}

}  // namespace
}  // namespace todbench
