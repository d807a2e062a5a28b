// SPDX-License-Identifier: GPL-3.0-or-later
// Camera that reconnects: one FrameSource over several connections to the same camera.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>

#include "acquisition/core/frame_source.h"
#include "bench/devices/reconnection.h"

namespace todbench {

/// Options of the reconnection.
struct ReconnectionOptions {
  std::chrono::milliseconds patience{60000};      ///< a camera that is away for longer is lost
  std::map<std::string, std::string> settings{};  ///< settings of the plan, which are written first
};

/// Reopens the camera. Called on a thread that may outlive an aborted source. The function must therefore own all
/// objects that it uses.
using ReopenCamera = std::function<Result<std::unique_ptr<FrameSource>>()>;

/// Source that forwards all calls to the present connection, for every back end. Sequence numbers continue across
/// connections. One thread at a time, except stop().
class ReconnectingSource final : public FrameSource {
 public:
  ReconnectingSource(std::unique_ptr<FrameSource> source, ReopenCamera reopen, ReconnectionOptions options);

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override;
  void stop() override;
  [[nodiscard]] Result<std::string> get(const std::string& feature) override;
  [[nodiscard]] Result<void> set(const std::string& feature, const std::string& value) override;
  [[nodiscard]] Result<void> correct_nonuniformity() override;

  /// Reconnects after `disconnected`, through the states from releasing to registering. Returns when the camera with
  /// the same serial number streams again with the same settings. Errors: `disconnected` (not back in time, or
  /// settings, geometry or scale differ; the message states which), `interrupted` within 0.1 s of a stop request in
  /// every state. A connection attempt that is in progress then ends on its own thread.
  [[nodiscard]] Result<void> recover(std::stop_token stop);
  /// Confirms that the plate is at its former position. This is the last step of a reconnection.
  void confirm_registration();

  /// Returns the state of the connection.
  [[nodiscard]] LinkState state() const { return state_; }

 private:
  struct Restored {
    std::unique_ptr<FrameSource> source;
    LinkEvent event = LinkEvent::failed;
    std::string why;
  };
  [[nodiscard]] std::shared_ptr<FrameSource> present() const;
  void go(LinkEvent event);
  [[nodiscard]] LinkEvent wait_before(int attempt, std::chrono::steady_clock::time_point deadline,
                                      const std::stop_token& stop);

  ReopenCamera reopen_;
  ReconnectionOptions options_;
  SourceInfo info_;  ///< description of the camera from the first connection, with the settings at its loss
  LinkState state_ = LinkState::streaming;
  std::string reason_;
  mutable std::mutex mutex_;             ///< guards the pointer
  std::shared_ptr<FrameSource> source_;  ///< null while there is no connection
  std::uint64_t sequence_offset_ = 0;
  std::uint64_t next_sequence_ = 0;
};

/// Writes all settings again and compares the camera with its former state. Succeeds if there is no difference. Errors:
/// `disconnected`; `not_found` with the differences. Temperatures that the camera measures may differ.
[[nodiscard]] Result<void> restore_settings(FrameSource& source, const std::map<std::string, std::string>& settings,
                                            const SourceInfo& before);

}  // namespace todbench
