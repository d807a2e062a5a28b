// A camera that comes back: the same FrameSource over several connections to the same camera.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>

#include "acquisition/core/frame_source.h"
#include "bench/run/reconnection.h"

namespace todbench {

struct ReconnectionOptions {
  std::chrono::milliseconds patience{60000};      ///< longer away than this is lost for good
  std::map<std::string, std::string> settings{};  ///< of the plan: written first
};

/// Opens the camera anew. Called on a thread that may outlive the source when it is aborted: owns what it needs.
using ReopenCamera = std::function<Result<std::unique_ptr<FrameSource>>()>;

/// Passes everything on to the present connection, whatever back end it comes from. Sequence numbers go on where the
/// connection before left off. One thread at a time, except stop().
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

  /// After `disconnected`: from releasing to registering. Returns when the camera with the same serial number streams
  /// again with the same settings. Errors: `disconnected` (did not come back in time, or its settings, geometry or
  /// scale are not what they were; a sentence says which), `interrupted` within 0.1 s of a stop request in every state.
  /// A connection attempt that is under way then ends by itself on its own thread.
  [[nodiscard]] Result<void> recover(std::stop_token stop);
  /// The plate was found where it was: the last step.
  void confirm_registration();

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
  SourceInfo info_;  ///< of the first connection, settings as they were when it was lost
  LinkState state_ = LinkState::streaming;
  std::string reason_;
  mutable std::mutex mutex_;             ///< guards the pointer
  std::shared_ptr<FrameSource> source_;  ///< null while there is no connection
  std::uint64_t sequence_offset_ = 0;
  std::uint64_t next_sequence_ = 0;
};

/// Writes every setting again and compares what the camera then is with what it was. Success: the camera is the same.
/// Errors: `disconnected`, or `not_found` with what differs. Temperatures that the camera measures may differ.
[[nodiscard]] Result<void> restore_settings(FrameSource& source, const std::map<std::string, std::string>& settings,
                                            const SourceInfo& before);

}  // namespace todbench
