// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/devices/reconnecting_source.h"

#include <algorithm>
#include <cassert>
#include <condition_variable>
#include <optional>
#include <utility>

#include "acquisition/base/background.h"

namespace todbench {
namespace {

using Clock = std::chrono::steady_clock;

/// Features that vary between readings, belong to the connection, or are only reported while streaming: the dead pixels
/// of a Seek are in its first frame.
constexpr std::array volatile_settings{"DeviceTemperature", "SensorTemperature", "HousingTemperature",
                                       "SocketBufferBytes", "DeadPixels"};

/// Result of a connection attempt, shared between the attempt and the waiting thread.
template <typename Value>
struct Outcome {
  std::mutex mutex;
  std::condition_variable_any changed;
  std::optional<Value> value;
};

/// Runs `work` on its own thread and returns its result, or an empty value as soon as a stop is requested. Then the
/// work ends later, before the program does, and its result is destroyed there.
template <typename Value, typename Work>
std::optional<Value> unless_stopped(const std::stop_token& stop, Work work) {
  const auto outcome = std::make_shared<Outcome<Value>>();
  finish_in_background([outcome, work = std::move(work)]() mutable {
    Value made = work();
    const std::lock_guard lock(outcome->mutex);
    outcome->value = std::move(made);
    outcome->changed.notify_all();
  });
  std::unique_lock lock(outcome->mutex);
  if (!outcome->changed.wait(lock, stop, [&] { return outcome->value.has_value(); })) return std::nullopt;
  return std::move(outcome->value);
}

std::string differing(const std::string& what, const std::string& before, const std::string& now) {
  return what + " was " + before + " and is " + now;
}

/// Returns the differences in the properties of a camera that must stay; empty if there are none.
std::string difference(const SourceInfo& before, const SourceInfo& now) {
  // Two empty serial numbers would match, and so would another camera of the model.
  if (before.serial.empty() || now.serial.empty()) return "the camera has no serial number to identify it";
  if (now.serial != before.serial) return differing("the serial number", before.serial, now.serial);
  if (now.width != before.width || now.height != before.height) {
    return differing("the picture", std::to_string(before.width) + " x " + std::to_string(before.height),
                     std::to_string(now.width) + " x " + std::to_string(now.height));
  }
  if (now.pixel_format != before.pixel_format)
    return differing("the pixel format", before.pixel_format, now.pixel_format);
  if (now.scale.describe() != before.scale.describe())
    return differing("the temperature scale", before.scale.describe(), now.scale.describe());
  for (const auto& [feature, value] : before.settings) {
    if (std::find(volatile_settings.begin(), volatile_settings.end(), feature) != volatile_settings.end()) continue;
    const auto found = now.settings.find(feature);
    const std::string present = found == now.settings.end() ? "absent" : found->second;
    if (present != value) return differing(feature, value, present);
  }
  return {};
}

}  // namespace

Result<void> restore_settings(FrameSource& source, const std::map<std::string, std::string>& settings,
                              const SourceInfo& before) {
  const auto lost = [](const auto& done) { return !done && done.error().code == ErrorCode::disconnected; };
  for (const auto& [feature, value] : settings) {
    const auto done = source.set(feature, value);
    if (lost(done)) return done;
    if (!done) return fail(ErrorCode::not_found, "setting " + feature + " again: " + done.error().message);
  }
  // Settings changed during the measurement, or by the camera itself.
  for (const auto& [feature, value] : before.settings) {
    const auto& now = source.info().settings;
    const auto found = now.find(feature);
    if (found == now.end() || found->second == value) continue;
    if (std::find(volatile_settings.begin(), volatile_settings.end(), feature) != volatile_settings.end()) continue;
    if (const auto done = source.set(feature, value); lost(done)) return done;
  }
  if (const auto what = difference(before, source.info()); !what.empty()) {
    return fail(ErrorCode::not_found, "the camera differs after reconnection: " + what);
  }
  return {};
}

ReconnectingSource::ReconnectingSource(std::unique_ptr<FrameSource> source, ReopenCamera reopen,
                                       ReconnectionOptions options)
    : reopen_(std::move(reopen)), options_(std::move(options)), info_(source->info()), source_(std::move(source)) {}

std::shared_ptr<FrameSource> ReconnectingSource::present() const {
  const std::lock_guard lock(mutex_);
  return source_;
}

void ReconnectingSource::go(LinkEvent event) {
  const auto next = next_state(state_, event);
  assert(next);
  if (next) state_ = *next;
}

namespace {
tl::unexpected<Error> no_connection(const SourceInfo& info) {
  return fail(ErrorCode::disconnected, "there is no connection to camera " + info.id);
}
}  // namespace

Result<void> ReconnectingSource::start() {
  const auto source = present();
  return source ? source->start() : Result<void>(no_connection(info_));
}

Result<Frame> ReconnectingSource::next(std::chrono::milliseconds timeout) {
  const auto source = present();
  if (!source) return no_connection(info_);
  auto frame = source->next(timeout);
  if (!frame) return frame;
  frame->sequence += sequence_offset_;
  next_sequence_ = std::max(next_sequence_, frame->sequence + 1);
  return frame;
}

void ReconnectingSource::stop() {
  if (const auto source = present()) source->stop();
}

Result<std::string> ReconnectingSource::get(const std::string& feature) {
  const auto source = present();
  return source ? source->get(feature) : Result<std::string>(no_connection(info_));
}

Result<void> ReconnectingSource::set(const std::string& feature, const std::string& value) {
  const auto source = present();
  if (!source) return no_connection(info_);
  auto done = source->set(feature, value);
  info_ = source->info();
  return done;
}

Result<void> ReconnectingSource::correct_nonuniformity() {
  const auto source = present();
  if (!source) return no_connection(info_);
  auto done = source->correct_nonuniformity();
  info_ = source->info();
  return done;
}

LinkEvent ReconnectingSource::wait_before(int attempt, Clock::time_point deadline, const std::stop_token& stop) {
  if (Clock::now() >= deadline) return LinkEvent::out_of_time;
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  never.wait_until(lock, stop, std::min(deadline, Clock::now() + back_off(attempt)), [] { return false; });
  return stop.stop_requested() ? LinkEvent::abort : LinkEvent::done;
}

Result<void> ReconnectingSource::recover(std::stop_token stop) {
  const auto deadline = Clock::now() + options_.patience;
  if (is_final(state_)) return no_connection(info_);
  go(LinkEvent::lost);
  int attempt = 0;
  Restored made;
  while (!is_final(state_) && state_ != LinkState::registering) {
    if (state_ == LinkState::releasing) {
      std::shared_ptr<FrameSource> old;
      {
        const std::lock_guard lock(mutex_);
        old = std::move(source_);
      }
      const auto gone =
          unless_stopped<bool>(stop, [old = std::move(old), half_made = std::exchange(made, {})]() mutable {
            old.reset();
            half_made.source.reset();
            return true;
          });
      go(gone ? LinkEvent::done : LinkEvent::abort);
    } else if (state_ == LinkState::waiting) {
      go(wait_before(attempt++, deadline, stop));
    } else if (state_ == LinkState::opening) {
      auto opened = unless_stopped<Result<std::unique_ptr<FrameSource>>>(stop, reopen_);
      if (opened && *opened) made.source = std::move(**opened);
      if (opened && !*opened) reason_ = opened->error().message;
      go(!opened ? LinkEvent::abort : *opened ? LinkEvent::done : LinkEvent::failed);
    } else if (state_ == LinkState::restoring) {
      auto restored = unless_stopped<Restored>(
          stop, [source = std::move(made.source), settings = options_.settings, before = info_]() mutable {
            auto done = restore_settings(*source, settings, before);
            if (done) done = source->start();
            Restored out{.source = std::move(source), .event = LinkEvent::done, .why = {}};
            if (done) return out;
            out.why = done.error().message;
            out.event = done.error().code == ErrorCode::disconnected ? LinkEvent::lost : LinkEvent::refused;
            return out;
          });
      if (restored) made = std::move(*restored);
      if (restored && made.event != LinkEvent::done) reason_ = made.why;
      go(restored ? made.event : LinkEvent::abort);
    }
  }
  if (state_ == LinkState::aborted) return fail(ErrorCode::interrupted, "stopped on request");
  if (state_ == LinkState::gave_up) {
    return fail(ErrorCode::disconnected, "camera " + info_.id +
                                             " was lost and did not return with the same identity and settings" +
                                             (reason_.empty() ? "" : ": " + reason_));
  }
  sequence_offset_ = next_sequence_;
  const std::lock_guard lock(mutex_);
  source_ = std::move(made.source);
  if (stop.stop_requested()) source_->stop();
  return {};
}

void ReconnectingSource::confirm_registration() {
  if (state_ == LinkState::registering) go(LinkEvent::done);
}

}  // namespace todbench
