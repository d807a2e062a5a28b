// SPDX-License-Identifier: GPL-3.0-or-later
// Runs started over HTTP: by clients of every kind, through the sockets of the server.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <httplib.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <thread>

#include "bench/run/experiment.h"
#include "bench/run_control/control_server.h"
#include "bench/session/manifest.h"
#include "bench/text/json.h"
#include "bench/text/text.h"
#include "tests/support/patience.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;

/// A run of a second; `more` is added at its end.
std::string controlled_plan(const std::string& more = "") {
  return "name = \"small\"\n[target]\ndistance_m = 2\nplates = [\"tcat-a\"]\nmountings = [\"identity\"]\n"
         "delta_t_k = [16.9]\nphases = 16\n[fit]\nestimator = \"weibull\"\n[simulation]\naccuracy = \"draft\"\n" +
         more;
}

/// The same with an operator who changes the target.
std::string prompting_plan() {
  return "name = \"prompting\"\n[camera]\nid = \"sim:sc2000\"\nifov_mrad = 1.3085399449\n[target]\nkind = \"prompt\"\n"
         "distance_m = 2\nplates = [\"tcat-a\"]\nmountings = [\"identity\"]\ndelta_t_k = [16.9]\nphases = 16\n";
}

class RunControl : public ::testing::Test {
 protected:
  RunControl() {
    auto started = ControlServer::start({.address = {"127.0.0.1", 0}, .sessions = folder.path()});
    if (!started) throw std::runtime_error(started.error().message);
    server = std::move(*started);
    const std::string& url = server->url();
    port = std::stoi(url.substr(url.rfind(':') + 1));
    client.emplace("127.0.0.1", port);
    client->set_read_timeout(60);
    client->set_default_headers({{"Authorization", "Bearer " + server->token()}});
  }

  httplib::Response get(const std::string& path) {
    const auto result = client->Get(path);
    if (!result) throw std::runtime_error(path + ": no answer");
    seen.insert({"get", path, result->status});
    return *result;
  }
  httplib::Response post(const std::string& path, const std::string& body,
                         const std::string& type = "application/json") {
    const auto result = client->Post(path, body, type);
    if (!result) throw std::runtime_error(path + ": no answer");
    seen.insert({"post", path, result->status});
    return *result;
  }
  std::string start(const Json& run) {
    const httplib::Response made = post("/api/v1/runs", run.dump());
    EXPECT_EQ(made.status, 201) << made.body;
    return Json::parse(made.body)["id"];
  }
  Json run(const std::string& id) { return Json::parse(get("/api/v1/runs/" + id).body); }
  Json wait_until_over(const std::string& id) {
    return wait_until(id, [](const Json& now) { return now["over"] == true; });
  }
  Json wait_until(const std::string& id, const std::function<bool(const Json&)>& enough) {
    const auto begin = std::chrono::steady_clock::now();
    for (;;) {
      Json now = run(id);
      if (enough(now)) return now;
      if (std::chrono::steady_clock::now() - begin > testing_support::patience(std::chrono::seconds(60))) {
        ADD_FAILURE() << now.dump();
        return now;
      }
      std::this_thread::yield();
    }
  }

  struct Seen {
    std::string method, path;
    int status;
    auto operator<=>(const Seen&) const = default;
  };

  testing::TemporaryFolder folder;
  std::unique_ptr<ControlServer> server;
  int port = 0;
  std::optional<httplib::Client> client;
  std::set<Seen> seen;
};

/// Connection whose client sends what it is told and reads only if asked.
class RawClient {
 public:
  RawClient(int port, const std::string& sent) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    const int small = 2048;
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::send(socket_, sent.data(), sent.size(), MSG_NOSIGNAL), static_cast<ssize_t>(sent.size()));
  }
  ~RawClient() { ::close(socket_); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;
  /// Everything up to the end of the connection.
  [[nodiscard]] std::string all() const { return until({}); }
  /// What arrives until `end` is in it, or up to the end of the connection; an empty `end` never arrives.
  [[nodiscard]] std::string until(std::string_view end) const {
    std::string text;
    std::array<char, 4096> some{};
    while (end.empty() || text.find(end) == std::string::npos) {
      const ssize_t got = ::recv(socket_, some.data(), some.size(), 0);
      if (got <= 0) break;
      text.append(some.data(), static_cast<std::size_t>(got));
    }
    return text;
  }

 private:
  int socket_;
};

TEST_F(RunControl, GivesTheVerdictOfTheCommandLineByteForByte) {
  const std::string id = start({{"plan_toml", controlled_plan()}, {"seed", 7}});
  auto asked = requested_run({.plan_toml = controlled_plan(), .mode = RunMode::simulate, .seed = 7}, folder.path(),
                             PlanPrograms::none);
  ASSERT_TRUE(asked);
  ASSERT_TRUE(simulate_plan(asked->plan, {.folder = folder.path() / "direct"}, {}, {}));

  const Json over = wait_until_over(id);

  EXPECT_EQ(over["state"], "finished");
  EXPECT_EQ(get("/api/v1/runs/" + id + "/files/verdict.json").body,
            read_text_file(folder.path() / "direct" / "verdict.json").value());
  EXPECT_EQ(over["points"].size(), 1u);
  EXPECT_THAT(get("/api/v1/runs/" + id + "/files/report.html").body, HasSubstr("</html>"));
}

TEST_F(RunControl, RunsOneAfterTheOtherAndRemovesOneThatWaits) {
  const std::string first = start({{"plan_toml", prompting_plan()}});
  const std::string second = start({{"plan_toml", controlled_plan()}});
  const std::string third = start({{"plan_toml", controlled_plan()}});
  wait_until(first, [](const Json& now) { return !now["question"].is_null() || now["over"] == true; });

  EXPECT_EQ(run(second)["state"], "queued");
  EXPECT_EQ(post("/api/v1/runs/" + third + "/stop", "").status, 202);
  EXPECT_EQ(run(third)["state"], "stopped");
  EXPECT_EQ(run(third)["exit_code"], 130);
  EXPECT_EQ(post("/api/v1/runs/" + first + "/stop", "").status, 202);
  EXPECT_EQ(wait_until_over(first)["state"], "stopped");
  EXPECT_EQ(wait_until_over(second)["state"], "finished");
}

TEST_F(RunControl, PassesARequestToTheOperatorAndTheAnswerBack) {
  const std::string id = start({{"plan_toml", prompting_plan()}});

  const Json asking = wait_until(id, [](const Json& now) { return !now["question"].is_null() || now["over"] == true; });

  ASSERT_FALSE(asking["question"].is_null()) << asking.dump();
  EXPECT_THAT(asking["question"]["steps"][0].get<std::string>(), HasSubstr("tcat-a"));
  const std::uint64_t number = asking["question"]["number"];
  EXPECT_EQ(post("/api/v1/runs/" + id + "/answer", Json{{"answer", "done"}, {"number", number + 1}}.dump()).status,
            409);
  EXPECT_EQ(post("/api/v1/runs/" + id + "/answer", R"({"answer":"perhaps"})").status, 400);
  EXPECT_EQ(post("/api/v1/runs/" + id + "/answer", Json{{"answer", "stop"}, {"number", number}}.dump()).status, 202);
  EXPECT_EQ(wait_until_over(id)["exit_code"], 130);
  EXPECT_EQ(post("/api/v1/runs/" + id + "/answer", R"({"answer":"done"})").status, 409);
}

TEST_F(RunControl, SendsTheStatesOfARunUntilItIsOver) {
  const std::string id = start({{"plan_toml", controlled_plan()}});

  const RawClient reader(
      port, "GET /api/v1/runs/" + id + "/events?token=" + server->token() + " HTTP/1.1\r\nHost: x\r\n\r\n");
  const std::string events = reader.all();

  EXPECT_THAT(events, HasSubstr("Content-Type: text/event-stream"));
  EXPECT_THAT(events, HasSubstr("\"state\":\"finished\",\"over\":true"));
  EXPECT_TRUE(events.ends_with("\n\n"));
}

TEST_F(RunControl, IsNotSlowedByAClientThatStopsReading) {
  const std::string id = start({{"plan_toml", controlled_plan()}});
  const std::string request =
      "GET /api/v1/runs/" + id + "/events?token=" + server->token() + " HTTP/1.1\r\nHost: x\r\n\r\n";
  std::vector<std::unique_ptr<RawClient>> dead;
  for (std::size_t i = 0; i < 8; ++i) dead.push_back(std::make_unique<RawClient>(port, request));
  for (std::size_t i = 0; i < 8; ++i)
    dead.push_back(std::make_unique<RawClient>(port, "POST /api/v1/runs HTTP/1.1\r\n"));

  EXPECT_EQ(wait_until_over(id)["state"], "finished");
}

TEST_F(RunControl, HasRoomForSixteenStreams) {
  const std::string id = start({{"plan_toml", prompting_plan()}});
  wait_until(id, [](const Json& now) { return !now["question"].is_null() || now["over"] == true; });
  const std::string path = "/api/v1/runs/" + id + "/events";
  std::vector<std::unique_ptr<RawClient>> open;
  for (int i = 0; i < 16; ++i) {
    open.push_back(std::make_unique<RawClient>(
        port, "GET " + path + "?token=" + server->token() + " HTTP/1.1\r\nHost: x\r\n\r\n"));
    // The first state comes from the streams themselves: whoever has it is counted.
    EXPECT_THAT(open.back()->until("event: state"), HasSubstr("event: state"));
  }

  EXPECT_EQ(get(path).status, 503);
  post("/api/v1/runs/" + id + "/stop", "");
}

TEST_F(RunControl, RefusesWhatItWasNotBuiltFor) {
  httplib::Client stranger("127.0.0.1", port);
  EXPECT_EQ(stranger.Get("/api/v1/runs")->status, 401);
  EXPECT_EQ(stranger.Get("/api/v1/runs", {{"Authorization", "Bearer " + std::string(32, '0')}})->status, 401);
  EXPECT_EQ(stranger.Get("/nothing")->status, 401) << "a stranger does not learn which paths exist";
  EXPECT_EQ(stranger.Get("/")->status, 200);

  EXPECT_EQ(post("/api/v1/runs", std::string(300 * 1024, ' ')).status, 413);
  EXPECT_EQ(post("/api/v1/runs", "{}", "text/plain").status, 415);
  EXPECT_EQ(post("/api/v1/runs", "{").status, 400);
  EXPECT_EQ(post("/api/v1/runs", std::string(100000, '[')).status, 400);
  EXPECT_EQ(post("/api/v1/runs", R"({"plan":"demo","speed":1})").status, 400);
  EXPECT_EQ(post("/api/v1/runs", R"({"plan":"no-such-plan"})").status, 422);
  EXPECT_EQ(get("/api/v1/" + std::string(600, 'a')).status, 404);
  EXPECT_EQ(get("/api/v1/runs/" + std::string(600, 'a')).status, 414);
  EXPECT_EQ(client->Get("/api/v1/plans", {{"Range", "bytes=0-1"}})->status, 400);
  EXPECT_EQ(client->Put("/api/v1/plans", "", "application/json")->status, 405);
  const RawClient chunked(port,
                          "POST /api/v1/runs HTTP/1.1\r\nHost: x\r\nAuthorization: Bearer " + server->token() +
                              "\r\nContent-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\n2\r\n{}\r\n");
  EXPECT_THAT(chunked.all(), HasSubstr(" 411 "));
}

TEST_F(RunControl, StartsNoProgramThatAPlanNamesUnlessItMay) {
  const std::string plan = controlled_plan("[[module]]\nplace = \"picture\"\ncommand = \"/bin/false\"\n");

  const httplib::Response refused = post("/api/v1/runs", Json{{"plan_toml", plan}}.dump());

  EXPECT_EQ(refused.status, 422);
  EXPECT_THAT(refused.body, HasSubstr("--allow-modules"));
}

TEST_F(RunControl, GivesFilesByTheNamesInTheManifestOnly) {
  const std::string id = start({{"plan_toml", controlled_plan()}});
  const std::string session = wait_until_over(id)["session"];
  std::ofstream(std::filesystem::path(session) / "secret.txt") << "secret";
  std::ofstream(folder.path() / "above.txt") << "secret";
  const std::string files = "/api/v1/runs/" + id + "/files";

  EXPECT_EQ(Json::parse(get(files).body)["files"].size() + 1, session_files(session).size() + 1);
  EXPECT_EQ(get(files + "/manifest.json").status, 200);
  EXPECT_EQ(get(files + "/inputs/plate-tcat-a.toml").status, 200);
  for (const char* other : {"/secret.txt", "/../above.txt", "/..%2fabove.txt", "//etc/passwd",
                            "/inputs/../../above.txt", "/verdict.json%00", "/"})
    EXPECT_EQ(get(files + other).status, 404) << other;
}

/// "/api/v1/runs/3/stop" belongs to "/api/v1/runs/{id}/stop".
std::string described_path(const Json& paths, const std::string& path) {
  for (const auto& [pattern, methods] : paths.items()) {
    if (pattern == path) return pattern;
  }
  const std::string runs = "/api/v1/runs/";
  if (!path.starts_with(runs)) return "";
  const auto end = path.find('/', runs.size());
  if (end == std::string::npos) return runs + "{id}";
  const std::string rest = path.substr(end);
  return runs + "{id}" + (rest.starts_with("/files/") ? "/files/{file}" : rest);
}

TEST_F(RunControl, IsDescribedPathForPathAndStatusForStatus) {
  const Json description = Json::parse(get("/api/v1/openapi.json").body);
  const Json& paths = description["paths"];
  std::set<std::pair<std::string, std::string>> described, routed;
  for (const auto& [path, methods] : paths.items()) {
    for (const auto& [method, operation] : methods.items()) described.insert({method, path});
  }
  for (const auto& route : ControlApi::routes())
    routed.insert({route.method == "GET" ? "get" : "post", std::string(route.path)});
  EXPECT_EQ(described, routed);

  const std::string body = Json{{"plan_toml", controlled_plan()}}.dump();
  const std::string id = start(Json::parse(body));
  wait_until_over(id);
  const std::string asking = start({{"plan_toml", prompting_plan()}});
  wait_until(asking, [](const Json& now) { return !now["question"].is_null() || now["over"] == true; });
  for (const auto& route : ControlApi::routes()) {
    for (const std::string& number : {id, asking, std::string("999")}) {
      std::string path(route.path);
      if (const auto at = path.find("{id}"); at != std::string::npos) path.replace(at, 4, number);
      if (const auto at = path.find("{file}"); at != std::string::npos) path.replace(at, 6, "verdict.json");
      if (path.ends_with("/events") && number == asking) continue;
      if (path.ends_with("/stop") && number == asking) continue;
      get(path);
      if (path != "/api/v1/runs") post(path, "{}");
      if (route.method != "POST") continue;
      post(path, std::string(300 * 1024, ' '));
      post(path, "{}", "text/plain");
      post(path, path.ends_with("check") ? body : R"({"answer":"done","number":77})");
    }
  }
  post("/api/v1/runs/" + asking + "/answer", R"({"answer":"stop"})");
  wait_until_over(asking);

  std::set<std::string> keys;
  const Json ended = run(id);
  for (const auto& [key, value] : ended.items()) keys.insert(key);
  std::set<std::string> described_keys;
  for (const auto& [key, value] : description["components"]["schemas"]["Run"]["properties"].items())
    described_keys.insert(key);
  EXPECT_EQ(keys, described_keys);
  for (const Seen& one : seen) {
    const std::string path = described_path(paths, one.path);
    ASSERT_TRUE(paths.contains(path)) << one.path;
    const Json& methods = paths[path];
    // A method that the path does not have: the description of the other one has its status.
    const Json& operation = methods.contains(one.method) ? methods[one.method] : methods.begin().value();
    EXPECT_TRUE(operation["responses"].contains(std::to_string(one.status)))
        << one.method << " " << one.path << " answers " << one.status;
  }
}

TEST(TokenFile, IsMadeForItsOwnerAndReadAgain) {
  const testing::TemporaryFolder folder;
  const auto file = folder.path() / "token";

  const auto made = kept_token(file);

  ASSERT_TRUE(made);
  EXPECT_EQ(made->size(), 32u);
  EXPECT_EQ(kept_token(file), *made);
  EXPECT_EQ(std::filesystem::status(file).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  EXPECT_FALSE(kept_token(folder.write("short", "abc\n")));
  EXPECT_FALSE(kept_token(folder.write("blank", "0123456789 0123456789\n")));
}

}  // namespace
}  // namespace todbench
