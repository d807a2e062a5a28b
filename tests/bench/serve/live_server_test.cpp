// SPDX-License-Identifier: GPL-3.0-or-later
// The live page with a client, a browser that is dead, and a run that leaves its values.
#include "bench/serve/live_server.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <httplib.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "bench/run/running_fit.h"
#include "bench/serve/live_page.h"
#include "bench/serve/live_run.h"
#include "bench/text/json.h"
#include "tests/support/patience.h"
#include "tests/support/read_png.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

struct Served {
  Served() {
    auto started = LiveServer::start({"127.0.0.1", 0});
    if (!started) throw std::runtime_error(started.error().message);
    server = std::move(*started);
    const std::string url = server->url();
    const auto slash = url.find('/', 7);
    port = std::stoi(url.substr(url.rfind(':', slash) + 1));
    path = url.substr(slash);
    client.emplace("127.0.0.1", port);
    client->set_read_timeout(60);
  }
  [[nodiscard]] httplib::Response get(const std::string& file) {
    const auto result = client->Get(file);
    if (!result) throw std::runtime_error(file + ": no answer");
    return *result;
  }

  std::unique_ptr<LiveServer> server;
  int port = 0;
  std::string path;  ///< "/TOKEN/"
  std::optional<httplib::Client> client;
};

TEST(ServeAddress, IsOfThisComputerUnlessTheNetworkIsAllowed) {
  for (const char* good : {"127.0.0.1:8080", "127.1.2.3:1", "[::1]:8080", "localhost:0"})
    EXPECT_TRUE(serve_address(good, Reach::this_computer)) << good;
  for (const char* elsewhere : {"0.0.0.0:8080", "192.168.1.2:80", "[::]:80", "127.0.0.1.example:80", "127.1:80",
                                "lab-pc:80", "127.0.0.256:80", "127.0.0.1.:80"}) {
    const auto refused = serve_address(elsewhere, Reach::this_computer);
    ASSERT_FALSE(refused) << elsewhere;
    EXPECT_EQ(refused.error().code, ErrorCode::invalid_input);
  }
  EXPECT_TRUE(serve_address("0.0.0.0:8080", Reach::network));
  for (const char* wrong : {"", ":", "127.0.0.1", "127.0.0.1:", "127.0.0.1:x", "127.0.0.1:65536", "127.0.0.1:-1",
                            ":8080", "::1:8080", "[]:80", "a b:80", "a\n:80"})
    EXPECT_FALSE(serve_address(wrong, Reach::network)) << wrong;
}

TEST(LiveServer, AnswersBehindItsTokenOnlyAndTakesNothing) {
  Served s;
  s.server->show(std::make_shared<const LivePages>(LivePages{R"({"name":"x"})", "<svg/>", "png"}));

  EXPECT_EQ(s.path.size(), 34u) << "128 bits and two slashes";
  EXPECT_EQ(s.get(s.path).body, live_html());
  EXPECT_EQ(s.get(s.path + "state.json").body, R"({"name":"x"})");
  EXPECT_EQ(s.get(s.path + "curve.svg").body, "<svg/>");
  EXPECT_EQ(s.get(s.path + "picture.png").get_header_value("Content-Type"), "image/png");
  std::string wrong = s.path;
  wrong[5] = wrong[5] == '0' ? '1' : '0';
  for (const std::string& nothing : {std::string("/"), std::string("/state.json"), wrong, wrong + "state.json",
                                     s.path + "../state.json", s.path + "liveXjs"})
    EXPECT_EQ(s.get(nothing).status, 404) << nothing;
  const auto posted = s.client->Post(s.path + "state.json", "{}", "application/json");
  ASSERT_TRUE(posted);
  EXPECT_EQ(posted->status, 404);
  EXPECT_EQ(s.get(s.path + "state.json").body, R"({"name":"x"})");
}

TEST(LiveServer, LetsThePageAskForNothingFromElsewhere) {
  Served s;

  const httplib::Response page = s.get(s.path);

  EXPECT_THAT(page.get_header_value("Content-Security-Policy"), HasSubstr("default-src 'none'"));
  EXPECT_EQ(page.get_header_value("Referrer-Policy"), "no-referrer");
  for (const std::string_view file : {live_html(), live_css(), live_js()}) EXPECT_THAT(file, Not(HasSubstr("//")));
}

TEST(LiveServer, GivesEveryServerATokenOfItsOwn) {
  EXPECT_NE(Served().path, Served().path);
}

TEST(LiveServer, AnAddressThatIsTakenIsSaid) {
  Served s;

  const auto second = LiveServer::start({"127.0.0.1", s.port});

  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::io);
}

/// Asks and never reads, or begins to ask and never ends.
class DeadBrowser {
 public:
  DeadBrowser(int port, const std::string& sent) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::send(socket_, sent.data(), sent.size(), MSG_NOSIGNAL), static_cast<ssize_t>(sent.size()));
  }
  ~DeadBrowser() { ::close(socket_); }
  DeadBrowser(const DeadBrowser&) = delete;
  DeadBrowser& operator=(const DeadBrowser&) = delete;

 private:
  int socket_;
};

TEST(LiveServer, IsNotStoppedByBrowsersThatAreDead) {
  Served s;
  // More than a socket holds, so that who does not read stops the thread that writes.
  const std::string large(16 << 20, 'x');
  s.server->show(std::make_shared<const LivePages>(LivePages{"{}", large, ""}));
  std::vector<std::unique_ptr<DeadBrowser>> dead;
  // Together more than the server has threads.
  dead.push_back(std::make_unique<DeadBrowser>(s.port, "GET /"));
  for (int i = 0; i < 2; ++i) {
    dead.push_back(std::make_unique<DeadBrowser>(s.port, "GET " + s.path + "curve.svg HTTP/1.1\r\nHost: x\r\n\r\n"));
    dead.push_back(std::make_unique<DeadBrowser>(s.port, "GET /"));
  }

  for (int i = 0; i < 1000; ++i)
    s.server->show(std::make_shared<const LivePages>(LivePages{std::to_string(i), large, ""}));
  s.server->wait_until_seen(std::chrono::milliseconds(1));

  EXPECT_EQ(s.get(s.path + "state.json").body, "999") << "and who is alive gets his answer";
}

/// Sockets that this process has open.
std::size_t open_sockets() {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code gone;
    const std::string target = std::filesystem::read_symlink(entry.path(), gone);
    if (!gone && target.starts_with("socket:")) ++count;
  }
  return count;
}

TEST(LiveServer, HoldsAFewOfManyIdleConnectionsAndAnswersBesideThem) {
  Served s;
  s.server->show(std::make_shared<const LivePages>(LivePages{"{}", "", ""}));
  constexpr std::size_t idle = 60, held = 24;
  const std::size_t before = open_sockets();
  std::vector<std::unique_ptr<DeadBrowser>> browsers;
  for (std::size_t i = 0; i < idle; ++i) browsers.push_back(std::make_unique<DeadBrowser>(s.port, "G"));

  // Both ends of a connection are of this process. What was not taken from the backlog yet is no descriptor.
  EXPECT_LE(open_sockets(), before + idle + held);

  // A connection that is one too many is closed, as a browser sees and asks again.
  const auto deadline = std::chrono::steady_clock::now() + testing_support::patience(std::chrono::milliseconds(60'000));
  bool answered = false;
  while (!answered && std::chrono::steady_clock::now() < deadline) {
    const auto result = s.client->Get(s.path + "state.json");
    answered = result && result->body == "{}";
    EXPECT_LE(open_sockets(), before + idle + held);
  }
  EXPECT_TRUE(answered);
}

TEST(LiveCurve, IsTheCurveOfTheAnswersThatWereAdded) {
  Plan plan;
  plan.target.delta_t_k = {2};
  LiveCurve live(plan);
  EXPECT_EQ(live.latest(), nullptr);
  std::vector<Trial> trials;
  for (int i = 0; i < 400; ++i) {
    Trial trial;
    trial.delta_t_k = trial.set_delta_t_k = 2;
    trial.size_mrad = 1 + i % 5;
    // Wrong with a share that falls with the size, in turn.
    trial.truth = Apex::up;
    trial.answer = (i / 5) % 8 < 8 - 6 / (1 + i % 5) ? Apex::up : Apex::left;
    trials.push_back(trial);
    live.add(SessionCurve::main, trial);
  }

  // The last fit is of all of them: it begins again as long as there are newer answers.
  const auto expected = RunningFit(plan).curve_of(trials, {});
  ASSERT_TRUE(expected);
  const auto whole = [&] {
    const auto now = live.latest();
    return now && now->measured && now->measured->points.front().fit.trials == 400;
  };
  const auto deadline = std::chrono::steady_clock::now() + testing_support::patience(std::chrono::milliseconds(60'000));
  while (!whole() && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));

  ASSERT_TRUE(whole());
  EXPECT_EQ(live.latest()->measured->points.front().fit.threshold, expected->points.front().fit.threshold);
  EXPECT_FALSE(live.latest()->twin);
}

TEST(LiveRun, ShowsWhatTheRunLeaves) {
  Served s;
  Plan plan;
  plan.name = "Täst <b>";
  plan.target.delta_t_k = {2};
  const LiveCurve curve(plan);
  LiveRun live(*s.server, curve, plan);
  std::string heard;
  ExperimentListener inner;
  inner.on_phase = [&](std::string_view phase) { heard = phase; };
  const ExperimentListener listener = live.listening(inner);

  listener.on_phase("measuring");
  listener.on_progress(3, 8);
  Frame frame;
  frame.counts = cv::Mat1w(24, 32, static_cast<std::uint16_t>(1000));
  frame.counts(3, 4) = 9000;
  listener.on_frame(frame);
  live.end("the run is over", "pass");

  EXPECT_EQ(heard, "measuring") << "who listened before still does";
  const Json state = Json::parse(s.get(s.path + "state.json").body);
  EXPECT_EQ(state["name"], "Täst <b>");
  EXPECT_EQ(state["phase"], "the run is over");
  EXPECT_EQ(state["done"], 3);
  EXPECT_EQ(state["planned"], 8);
  EXPECT_EQ(state["verdict"], "pass");
  EXPECT_EQ(state["state"], "finished");
  EXPECT_EQ(state["reason"], nullptr);
  EXPECT_EQ(state["curve"], 0);
  EXPECT_GT(state["picture"], 0);
  EXPECT_EQ(state["over"], true);
  const std::string png = s.get(s.path + "picture.png").body;
  const cv::Mat picture = testing::read_png(png);
  EXPECT_EQ(picture.size(), cv::Size(32, 24));
  EXPECT_EQ(picture.at<unsigned char>(3, 4), 255);
  EXPECT_EQ(picture.at<unsigned char>(0, 0), 0);
  EXPECT_EQ(s.get(s.path + "curve.svg").status, 404);
}

TEST(LiveRun, SaysWhatTheRunIsWaitingFor) {
  Served s;
  const Plan plan;
  const LiveCurve curve(plan);
  LiveRun live(*s.server, curve, plan);
  const ExperimentListener listener = live.listening({});
  // The page is drawn about twice a second.
  const auto says = [&](const std::string& word) {
    const auto deadline =
        std::chrono::steady_clock::now() + testing_support::patience(std::chrono::milliseconds(60'000));
    Json state;
    do {
      state = Json::parse(s.get(s.path + "state.json").body);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    } while (state["state"] != word && std::chrono::steady_clock::now() < deadline);
    EXPECT_EQ(state["state"], word);
    return state;
  };
  TargetWait wait;
  wait.plate_there = true;

  EXPECT_FALSE(says("running")["over"]);
  listener.on_wait(wait);
  says("settling");
  wait.plate_there = false;
  listener.on_wait(wait);
  EXPECT_NE(says("plate-change")["waiting"], "");
  live.ask("put in plate a");
  EXPECT_EQ(says("operator")["step"], "put in plate a");
  live.ask("");
  listener.on_wait(std::nullopt);
  says("running");
  listener.on_lost({}, std::chrono::milliseconds(1000));
  says("camera-lost");
  Frame frame;
  frame.counts = cv::Mat1w(24, 32, static_cast<std::uint16_t>(1000));
  listener.on_frame(frame);
  says("running");
  live.ask("put in plate b");
  live.end("there is no result", std::nullopt, "the camera was lost");

  const Json state = Json::parse(s.get(s.path + "state.json").body);
  EXPECT_EQ(state["state"], "stopped");
  EXPECT_EQ(state["reason"], "the camera was lost");
  EXPECT_EQ(state["step"], "");
  EXPECT_EQ(state["verdict"], nullptr);
}

}  // namespace
}  // namespace todbench
