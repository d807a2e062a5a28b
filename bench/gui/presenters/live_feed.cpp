// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/live_feed.h"

#include <utility>

namespace todbench {

void LiveFeed::open(const SourceInfo& info) {
  const std::lock_guard lock(mutex_);
  info_ = info;
  IntegrityOptions options;
  options.width = info.width;
  options.height = info.height;
  gate_.emplace(options);
  arrivals_ns_.clear();
  latest_.reset();
}

void LiveFeed::put(const Frame& frame) {
  const std::lock_guard lock(mutex_);
  if (!gate_) gate_.emplace(IntegrityOptions{});
  const auto rejection = gate_->judge(frame);
  // The first frame after a gap is complete: it is not measured, but can be shown.
  const bool showable = !rejection || *rejection == Rejection::gapped;
  arrivals_ns_.push_back(frame.host_time_ns);
  while (arrivals_ns_.size() > 2 && arrivals_ns_.front() < frame.host_time_ns - 1'000'000'000) arrivals_ns_.pop_front();
  FrameCounters counters{.good = gate_->accepted(), .lost = gate_->lost(), .rejected = {}, .rate_hz = 0};
  for (const auto& [reason, count] : gate_->rejected_by_reason())
    counters.rejected[std::string(to_string(reason))] = count;
  const auto span_ns = arrivals_ns_.back() - arrivals_ns_.front();
  if (span_ns > 0) counters.rate_hz = static_cast<double>(arrivals_ns_.size() - 1) * 1e9 / static_cast<double>(span_ns);
  // A rejected frame is counted but not shown, unless there is no better one.
  if (showable || !latest_) {
    latest_ = LiveFrame{frame, std::move(counters)};
  } else {
    latest_->counters = std::move(counters);
  }
}

std::optional<LiveFrame> LiveFeed::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(latest_, std::nullopt);
}

std::optional<SourceInfo> LiveFeed::info() const {
  const std::lock_guard lock(mutex_);
  return info_;
}

}  // namespace todbench
