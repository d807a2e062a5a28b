// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/instruments/scpi_client.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <future>
#include <thread>

#include "sim_devices/lab/instruments/scpi_server.h"

namespace todbench {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Far beyond the test's own time limit: a wait that is not ended by what the test does fails the test.
constexpr milliseconds for_ever = std::chrono::hours(1);

// Accepts one connection and says at once what it was given to say, whatever it hears.
class Peer {
 public:
  // Afterwards it stays silent, or, if it does not stay, closes when something more is said to it.
  explicit Peer(std::string speech, bool stays = true) : listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    ::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), size);
    ::listen(listener_.get(), 1);
    ::getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&address), &size);
    endpoint_ = "127.0.0.1:" + std::to_string(ntohs(address.sin_port));
    thread_ = std::jthread([this, speech = std::move(speech), stays](const std::stop_token& stop) {
      if (wait_on(listener_.get(), WaitFor::reading, std::nullopt, stop) == Waited::stopped) return;
      const Descriptor socket(::accept(listener_.get(), nullptr, nullptr));
      std::string_view left = speech;
      while (!left.empty()) {
        const auto sent = ::send(socket.get(), left.data(), left.size(), MSG_NOSIGNAL);
        if (sent <= 0) return;
        left.remove_prefix(static_cast<std::size_t>(sent));
      }
      std::array<char, 256> heard{};
      while (wait_on(socket.get(), WaitFor::reading, std::nullopt, stop) == Waited::ready)
        if (::recv(socket.get(), heard.data(), heard.size(), 0) <= 0 || !stays) return;
    });
  }
  [[nodiscard]] const std::string& endpoint() const { return endpoint_; }

 private:
  Descriptor listener_;
  std::string endpoint_;
  std::jthread thread_;
};

Result<ScpiClient> connect(const std::string& endpoint, milliseconds answer_timeout = for_ever,
                           const std::stop_token& stop = {}) {
  ScpiClientOptions options;
  options.connect_timeout = for_ever;
  options.answer_timeout = answer_timeout;
  return ScpiClient::connect(endpoint, options, stop);
}

std::unique_ptr<ScpiServer> instrument(std::vector<ScpiCommand> commands) {
  return ScpiServer::start({}, {"maker,\"model, large\",42,1.0", std::move(commands)}).value();
}

ScpiCommand answering(std::string header, std::string answer) {
  return {std::move(header), [answer](std::span<const std::string>) -> ScpiAnswer { return answer; }};
}

TEST(ScpiClientTest, ReadsTheFourFieldsOfTheIdentity) {
  const auto server = instrument({});

  const auto client = connect(server->endpoint());

  ASSERT_TRUE(client) << client.error().message;
  EXPECT_EQ(client->identity(), (ScpiIdentity{"maker", "model, large", "42", "1.0"}));
}

TEST(ScpiClientTest, QueriesAndCommandsReportWhatTheInstrumentRefuses) {
  const auto server = instrument({answering("VALue?", "1.5,-2E3"), answering("TEXT?", "\"1,2\""), answering("GO", "")});
  auto client = connect(server->endpoint()).value();

  EXPECT_THAT(client.query_form("VAL?", "{},{}", {}).value(), ElementsAre(1.5, -2000));
  EXPECT_EQ(client.query("TEXT?", {}).value(), "\"1,2\"");
  EXPECT_TRUE(client.command("GO", {}));
  const auto refused_command = client.command("STOP", {});
  const auto refused_query = client.query("STOP?", {});
  ASSERT_FALSE(refused_command);
  ASSERT_FALSE(refused_query);
  EXPECT_EQ(refused_command.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(refused_query.error().message,
              HasSubstr("STOP?: rejected by the instrument: '-113,\"Undefined header\"'"));
  EXPECT_THAT(client.query_form("VAL?", "{},{}", {}).value(), ElementsAre(1.5, -2000)) << "still in step";
}

TEST(ScpiClientTest, AnswersThatAreNotTheNumbersAskedForEndTheConnection) {
  for (const std::string answer : {"1", "1,2,3", "1,nan", "1,x", ","}) {
    const auto server = instrument({answering("VALue?", answer)});
    auto client = connect(server->endpoint()).value();

    const auto numbers = client.query_form("VAL?", "{},{}", {});

    ASSERT_FALSE(numbers) << answer;
    EXPECT_EQ(numbers.error().code, ErrorCode::disconnected);
    EXPECT_FALSE(client.is_open());
  }
}

TEST(ScpiClientTest, EndpointsThatAreNoneAreRefused) {
  for (const std::string endpoint :
       {"", ":5025", "127.0.0.1:", "127.0.0.1:x", "127.0.0.1:0", "127.0.0.1:65536", "a:1:"}) {
    const auto client = connect(endpoint);

    ASSERT_FALSE(client) << endpoint;
    EXPECT_EQ(client.error().code, ErrorCode::invalid_input) << endpoint;
  }
}

TEST(ScpiClientTest, NobodyListeningIsNotFound) {
  std::string endpoint;
  { endpoint = instrument({})->endpoint(); }

  const auto client = connect(endpoint);

  ASSERT_FALSE(client);
  EXPECT_EQ(client.error().code, ErrorCode::not_found);
  EXPECT_THAT(client.error().message, HasSubstr(endpoint));
}

TEST(ScpiClientTest, APeerThatSaysNothingIsNoInstrument) {
  const Peer peer("");

  const auto client = connect(peer.endpoint(), milliseconds(50));

  ASSERT_FALSE(client);
  EXPECT_EQ(client.error().code, ErrorCode::not_found);
  EXPECT_THAT(client.error().message, HasSubstr("no answer within 0.05 s"));
}

TEST(ScpiClientTest, GarbageInPlaceOfAnIdentityIsNoInstrument) {
  for (const std::string& garbage :
       {std::string("HTTP/1.1 400 Bad Request\r\n"), std::string("\n"), std::string("a,,,\n"),
        std::string(1'000'000, 'x'), std::string("\x1b[2J\0\xff,b\n", 9)}) {
    const Peer peer(garbage);

    const auto client = connect(peer.endpoint());

    ASSERT_FALSE(client);
    EXPECT_EQ(client.error().code, ErrorCode::not_found);
    EXPECT_LT(client.error().message.size(), 300U);
    EXPECT_EQ(client.error().message.find('\x1b'), std::string::npos);
  }
}

TEST(ScpiClientTest, APeerThatHangsUpIsDisconnectedAndStaysSo) {
  const Peer peer("maker,model,1,1\n", false);
  auto client = connect(peer.endpoint()).value();

  const auto first = client.query("VAL?", {});
  const auto second = client.command("GO", {});

  ASSERT_FALSE(first);
  EXPECT_EQ(first.error().code, ErrorCode::disconnected) << first.error().message;
  EXPECT_EQ(second.error().code, ErrorCode::disconnected);
}

TEST(ScpiClientTest, AnAnswerThatDoesNotComeIsATimeoutAndClosesTheConnection) {
  std::promise<void> released;
  const auto server = instrument({{"WAIT?", [&](std::span<const std::string>) -> ScpiAnswer {
                                     released.get_future().wait();
                                     return "late";
                                   }}});
  ScpiClientOptions options;
  options.answer_timeout = milliseconds(2000);  // also for *IDN?, which must come in time on a busy machine
  auto client = ScpiClient::connect(server->endpoint(), options, {});
  ASSERT_TRUE(client) << client.error().message;

  const auto answer = client->query("WAIT?", {});
  released.set_value();

  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::timeout);
  EXPECT_FALSE(client->is_open()) << "or the late answer would be taken for the next one";
}

TEST(ScpiClientTest, AStopRequestEndsAWaitForAnAnswer) {
  std::stop_source stop;
  std::promise<void> released;
  const auto server = instrument({{"WAIT?", [&](std::span<const std::string>) -> ScpiAnswer {
                                     stop.request_stop();
                                     released.get_future().wait();
                                     return "late";
                                   }}});
  auto client = connect(server->endpoint()).value();

  const auto answer = client.query("WAIT?", stop.get_token());
  released.set_value();

  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::interrupted);
}

TEST(ScpiClientTest, FieldsAreSplitOutsideQuotes) {
  EXPECT_THAT(scpi_fields(R"("a, ""b""", c,"")"), ElementsAre("a, \"b\"", "c", ""));
  EXPECT_THAT(scpi_fields(""), ElementsAre(""));
  for (const std::string text : {"", "plain", "\"", "a\"\"b", "a,b;c"})
    EXPECT_THAT(scpi_fields(scpi_quoted(text)), ElementsAre(text));
}

}  // namespace
}  // namespace todbench
