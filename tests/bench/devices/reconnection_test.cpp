// SPDX-License-Identifier: GPL-3.0-or-later
// A camera that is lost and comes back: the states, and what acts on them, with a camera that does as it is told.
#include <gmock/gmock.h>

#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

#include "bench/devices/reconnecting_source.h"
#include "bench/devices/reconnection.h"
#include "tests/support/patience.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

TEST(Reconnection, GoesThroughEveryStateWhenAllGoesWell) {
  auto state = next_state(LinkState::streaming, LinkEvent::lost);
  EXPECT_EQ(state, LinkState::releasing);
  for (const auto expected :
       {LinkState::waiting, LinkState::opening, LinkState::restoring, LinkState::registering, LinkState::streaming}) {
    state = next_state(*state, LinkEvent::done);
    EXPECT_EQ(state, expected);
  }
}

TEST(Reconnection, CanBeAbortedInEveryStateThatIsNotFinal) {
  for (const auto state : all_link_states) {
    const auto next = next_state(state, LinkEvent::abort);
    EXPECT_EQ(next.has_value(), !is_final(state)) << to_string(state);
    EXPECT_EQ(next.value_or(LinkState::aborted), LinkState::aborted);
  }
}

TEST(Reconnection, LeadsFromEveryStateToAFinalOneOrBackToStreaming) {
  // Breadth first over all events: no state is a trap.
  for (const auto start : all_link_states) {
    std::set<LinkState> reached{start};
    std::vector<LinkState> frontier{start};
    while (!frontier.empty()) {
      const auto state = frontier.back();
      frontier.pop_back();
      for (const auto event : all_link_events) {
        const auto next = next_state(state, event);
        if (next && reached.insert(*next).second) frontier.push_back(*next);
      }
    }
    EXPECT_TRUE(is_final(start) || reached.count(LinkState::streaming) == 1) << to_string(start);
    EXPECT_TRUE(is_final(start) || reached.count(LinkState::gave_up) == 1) << to_string(start);
  }
}

TEST(Reconnection, ThrowsAwayAConnectionThatFailsBeforeItTriesAnother) {
  for (const auto state : {LinkState::restoring, LinkState::registering}) {
    EXPECT_EQ(next_state(state, LinkEvent::lost), LinkState::releasing);
    EXPECT_EQ(next_state(state, LinkEvent::failed), LinkState::releasing);
    EXPECT_EQ(next_state(state, LinkEvent::refused), LinkState::gave_up);
  }
  EXPECT_EQ(next_state(LinkState::streaming, LinkEvent::done), std::nullopt);
}

TEST(Reconnection, WaitsLongerEveryTimeAndNeverLongerThanAHeartbeat) {
  EXPECT_EQ(back_off(0), 100ms);
  EXPECT_EQ(back_off(1), 200ms);
  EXPECT_EQ(back_off(20), 3000ms);
}

/// What a scripted camera does; shared by its connections.
struct Script {
  std::mutex mutex;
  std::condition_variable changed;
  std::map<std::string, std::string> at_power_up{{"Mode", "Automatic"}, {"DeviceTemperature", "30"}};
  std::string serial = "1";
  int refuse_to_open = 0;     ///< this many attempts fail
  bool hang_in_open = false;  ///< until released
  bool hang_in_set = false;
  bool hang_in_destruction = false;
  bool hangs = false;
  int opened = 0, destroyed = 0;
  std::vector<std::string> written;

  void wait_while(bool& hanging) {
    std::unique_lock lock(mutex);
    if (!hanging) return;
    hangs = true;
    changed.notify_all();
    changed.wait(lock, [&] { return !hanging; });
  }
  void release() {
    const std::lock_guard lock(mutex);
    hang_in_open = hang_in_set = hang_in_destruction = false;
    changed.notify_all();
  }
};

/// Delivers five frames per connection.
class ScriptedSource final : public FrameSource {
 public:
  explicit ScriptedSource(std::shared_ptr<Script> script) : script_(std::move(script)) {
    info_.id = "script:1";
    info_.serial = script_->serial;
    info_.settings = script_->at_power_up;
    ++script_->opened;
  }
  ~ScriptedSource() override {
    script_->wait_while(script_->hang_in_destruction);
    ++script_->destroyed;
  }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] Result<void> start() override { return {}; }
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds) override {
    if (frames_ == 5) return fail(ErrorCode::disconnected, "unplugged");
    Frame frame;
    frame.sequence = frames_++;
    return frame;
  }
  void stop() override {}
  [[nodiscard]] Result<std::string> get(const std::string& feature) override { return info_.settings[feature]; }
  [[nodiscard]] Result<void> set(const std::string& feature, const std::string& value) override {
    script_->wait_while(script_->hang_in_set);
    script_->written.push_back(feature + "=" + value);
    info_.settings[feature] = value;
    return {};
  }
  [[nodiscard]] Result<void> correct_nonuniformity() override { return set("Mode", "Manual"); }

 private:
  std::shared_ptr<Script> script_;
  SourceInfo info_;
  std::uint64_t frames_ = 0;
};

class ReconnectingSourceTest : public ::testing::Test {
 protected:
  ~ReconnectingSourceTest() override { script_->release(); }

  ReconnectingSource& lost_source(ReconnectionOptions options = {}) {
    source_ = std::make_unique<ReconnectingSource>(
        std::make_unique<ScriptedSource>(script_),
        [script = script_]() -> Result<std::unique_ptr<FrameSource>> {
          script->wait_while(script->hang_in_open);
          if (script->refuse_to_open-- > 0) return fail(ErrorCode::not_found, "busy");
          return std::make_unique<ScriptedSource>(script);
        },
        std::move(options));
    EXPECT_TRUE(source_->correct_nonuniformity());
    while (source_->next(1ms)) {
    }
    return *source_;
  }

  std::shared_ptr<Script> script_ = std::make_shared<Script>();
  std::unique_ptr<ReconnectingSource> source_;
};

TEST_F(ReconnectingSourceTest, ComesBackWithEverySettingAsItWasAndGoesOnCounting) {
  auto& source = lost_source({.settings = {{"Gain", "High"}}});
  script_->at_power_up["DeviceTemperature"] = "35";

  const auto back = source.recover({});

  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(source.state(), LinkState::registering);
  source.confirm_registration();
  EXPECT_EQ(source.state(), LinkState::streaming);
  EXPECT_EQ(*source.get("Mode"), "Manual");
  EXPECT_EQ(*source.get("Gain"), "High");
  EXPECT_EQ(source.next(1ms)->sequence, 5U);
  EXPECT_EQ(script_->destroyed, 1);
}

TEST_F(ReconnectingSourceTest, TriesUntilTheCameraLetsItIn) {
  auto& source = lost_source();
  script_->refuse_to_open = 3;

  EXPECT_TRUE(source.recover({}));

  EXPECT_EQ(script_->opened, 2);
}

TEST_F(ReconnectingSourceTest, GivesUpWhenItsPatienceEnds) {
  auto& source = lost_source({.patience = 250ms});
  script_->refuse_to_open = 1000;

  const auto back = source.recover({});

  ASSERT_FALSE(back);
  EXPECT_EQ(back.error().code, ErrorCode::disconnected);
  EXPECT_THAT(back.error().message, HasSubstr("busy"));
  EXPECT_EQ(source.state(), LinkState::gave_up);
  EXPECT_FALSE(source.recover({}));
}

TEST_F(ReconnectingSourceTest, RefusesAnotherCameraAtTheSamePlace) {
  auto& source = lost_source();
  script_->serial = "2";

  const auto back = source.recover({});

  ASSERT_FALSE(back);
  EXPECT_EQ(back.error().code, ErrorCode::disconnected);
  EXPECT_THAT(back.error().message, HasSubstr("serial number was 1 and is 2"));
}

TEST_F(ReconnectingSourceTest, RefusesACameraWithoutASerialNumberBecauseAnotherWouldBeTheSame) {
  script_->serial = "";
  auto& source = lost_source();

  const auto back = source.recover({});

  ASSERT_FALSE(back);
  EXPECT_EQ(back.error().code, ErrorCode::disconnected);
  EXPECT_THAT(back.error().message, HasSubstr("no serial number"));
}

TEST_F(ReconnectingSourceTest, IsAbortedWithinASecondInEveryState) {
  const auto abort_while = [this](bool Script::*hanging, LinkState during) {
    script_ = std::make_shared<Script>();
    auto& source = lost_source({.settings = {{"Gain", "High"}}});
    (*script_).*hanging = true;
    std::stop_source stop;
    std::optional<Error> error;
    std::chrono::steady_clock::duration took{};
    std::thread waiting([&] {
      auto back = source.recover(stop.get_token());
      if (!back) error = back.error();
    });
    {
      std::unique_lock lock(script_->mutex);
      script_->changed.wait(lock, [&] { return script_->hangs; });
    }
    const auto asked = std::chrono::steady_clock::now();
    stop.request_stop();
    waiting.join();
    took = std::chrono::steady_clock::now() - asked;
    script_->release();
    ASSERT_TRUE(error) << to_string(during);
    EXPECT_EQ(error->code, ErrorCode::interrupted) << to_string(during);
    EXPECT_LT(took, testing_support::patience(1s)) << to_string(during);
  };

  abort_while(&Script::hang_in_destruction, LinkState::releasing);
  abort_while(&Script::hang_in_open, LinkState::opening);
  abort_while(&Script::hang_in_set, LinkState::restoring);
}

TEST_F(ReconnectingSourceTest, IsAbortedWhileItWaits) {
  auto& source = lost_source();
  script_->refuse_to_open = 1000;
  std::stop_source stop;
  std::thread aborting([&] { stop.request_stop(); });

  const auto back = source.recover(stop.get_token());

  aborting.join();
  ASSERT_FALSE(back);
  EXPECT_EQ(back.error().code, ErrorCode::interrupted);
  EXPECT_EQ(source.state(), LinkState::aborted);
}

}  // namespace
}  // namespace todbench
