// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/serve/live_server.h"

#include <httplib.h>

#include <condition_variable>
#include <mutex>
#include <string_view>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/serve/guarded_server.h"
#include "bench/serve/live_page.h"

namespace todbench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t longest_request = 1024;
constexpr auto somebody_looks = std::chrono::seconds(5);

void answer(httplib::Response& response, std::string_view text, const char* type) {
  guard(response);
  if (text.empty()) {
    response.status = 404;
    return;
  }
  response.set_content(text.data(), text.size(), type);
}

}  // namespace

struct LiveServer::Serving {
  GuardedServer server;
  std::mutex mutex;
  std::condition_variable changed;
  std::shared_ptr<const LivePages> pages = std::make_shared<const LivePages>();
  bool seen = false;
  Clock::time_point last_asked{};

  [[nodiscard]] std::shared_ptr<const LivePages> now() {
    const std::lock_guard lock(mutex);
    return pages;
  }
  [[nodiscard]] std::shared_ptr<const LivePages> looked_at() {
    std::shared_ptr<const LivePages> shown;
    {
      const std::lock_guard lock(mutex);
      seen = true;
      last_asked = Clock::now();
      shown = pages;
    }
    changed.notify_all();
    return shown;
  }

  void route(const std::string& token) {
    server.set_payload_max_length(longest_request);
    const auto at = [&token](const char* name) { return "/" + token + "/" + name; };
    using Request = httplib::Request;
    using Response = httplib::Response;
    server.Get(at(""), [](const Request&, Response& r) { answer(r, live_html(), "text/html; charset=utf-8"); });
    server.Get(at("live\\.css"), [](const Request&, Response& r) { answer(r, live_css(), "text/css; charset=utf-8"); });
    server.Get(at("live\\.js"),
               [](const Request&, Response& r) { answer(r, live_js(), "text/javascript; charset=utf-8"); });
    server.Get(at("state\\.json"),
               [this](const Request&, Response& r) { answer(r, looked_at()->state_json, "application/json"); });
    server.Get(at("curve\\.svg"),
               [this](const Request&, Response& r) { answer(r, now()->curve_svg, "image/svg+xml"); });
    server.Get(at("picture\\.png"),
               [this](const Request&, Response& r) { answer(r, now()->picture_png, "image/png"); });
  }
};

LiveServer::LiveServer() : serving_(std::make_unique<Serving>()) {}

Result<std::unique_ptr<LiveServer>> LiveServer::start(const ServeAddress& address) {
  std::unique_ptr<LiveServer> out(new LiveServer);  // NOLINT: the constructor is private
  const std::string token = random_token();
  Serving& serving = *out->serving_;
  serving.route(token);
  TODBENCH_TRY(const auto port, bind_to(serving.server, address));
  out->url_ = url_of(address, port) + token + "/";
  serving.server.start_listening();
  return out;
}

LiveServer::~LiveServer() {
  serving_->server.stop_listening();
}

void LiveServer::show(std::shared_ptr<const LivePages> pages) {
  const std::lock_guard lock(serving_->mutex);
  serving_->pages = std::move(pages);
  serving_->seen = false;
}

void LiveServer::wait_until_seen(std::chrono::milliseconds patience) {
  std::unique_lock lock(serving_->mutex);
  if (serving_->last_asked == Clock::time_point() || Clock::now() - serving_->last_asked > somebody_looks) return;
  serving_->changed.wait_for(lock, patience, [this] { return serving_->seen; });
}

}  // namespace todbench
