#include "acquisition/recording/recorded_source.h"

#include <atomic>
#include <chrono>
#include <utility>

namespace todbench {
namespace {

class RecordedSource : public FrameSource {
 public:
  explicit RecordedSource(Recording recording)
      : recording_(std::move(recording)), scale_(std::make_shared<const RadiometricScale>(recording_.info.scale)) {}

  [[nodiscard]] const SourceInfo& info() const override { return recording_.info; }

  [[nodiscard]] Result<void> start() override {
    if (dead_) return tl::unexpected(end());
    if (!running_.exchange(true)) position_ = 0;
    return {};
  }

  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds) override {
    if (dead_) return tl::unexpected(end());
    if (!running_) return fail(ErrorCode::interrupted, recording_.info.id + " is stopped");
    if (position_ >= recording_.frame_count) {
      dead_ = true;
      return tl::unexpected(end());
    }
    auto recorded = recording_.read(position_);
    if (!recorded) {
      dead_ = true;
      return fail("reading frame " + std::to_string(position_) + " of " + recording_.info.id,
                  Error{ErrorCode::disconnected, recorded.error().message});
    }
    return frame(std::move(*recorded));
  }

  void stop() override { running_ = false; }

  [[nodiscard]] Result<std::string> get(const std::string& feature) override {
    const auto setting = recording_.info.settings.find(feature);
    if (setting != recording_.info.settings.end()) return setting->second;
    return fail(ErrorCode::invalid_input, "the recording does not tell " + feature);
  }

  [[nodiscard]] Result<void> set(const std::string& feature, const std::string& value) override {
    return fail(ErrorCode::invalid_input, "setting " + feature + "=" + value + ": a recording cannot be changed");
  }

  [[nodiscard]] Result<void> correct_nonuniformity() override {
    return fail(ErrorCode::invalid_input, "a recording cannot correct its non-uniformity");
  }

 private:
  [[nodiscard]] Frame frame(RecordedFrame recorded) {
    Frame result;
    result.counts = std::move(recorded.counts);
    result.sequence = position_++;
    result.device_time_ns = recorded.device_time_ns;
    result.host_time_ns =
        std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
            .count();
    result.significant_bits = recording_.info.significant_bits;
    result.scale = scale_;
    const bool as_stated = result.counts.cols == recording_.info.width && result.counts.rows == recording_.info.height;
    result.status = as_stated ? FrameStatus::complete : FrameStatus::wrong_size;
    return result;
  }

  [[nodiscard]] Error end() const {
    return {ErrorCode::disconnected, recording_.info.id + " ends after " + std::to_string(position_) + " frames"};
  }

  Recording recording_;
  std::shared_ptr<const RadiometricScale> scale_;
  std::uint64_t position_ = 0;
  bool dead_ = false;
  std::atomic<bool> running_ = false;  ///< the only thing that stop() touches from another thread
};

}  // namespace

std::unique_ptr<FrameSource> recorded_source(Recording recording) {
  return std::make_unique<RecordedSource>(std::move(recording));
}

}  // namespace todbench
