// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/frame_sequence.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "acquisition/base/median.h"

namespace todbench {
namespace {

/// Ids 1 ... 65535 repeat with this period because 0 is skipped.
constexpr std::int64_t gvsp16_period = 65535;
/// Aravis treats an id that is up to this much below the last one as a late packet and drops it.
constexpr std::int64_t arrival_window = 100;
/// Longest delay of a frame's arrival on a busy host.
constexpr double host_delay_ns = 1e9;
/// Period of the fastest camera, used while the period is unknown.
constexpr double shortest_period_ns = 1e5;
constexpr std::size_t remembered_periods = 15;
/// Observed periods that are needed before they replace the stated one.
constexpr std::size_t enough_periods = 3;
constexpr std::size_t remembered_arrivals = 32, enough_arrivals = 16;
/// Number of frames after a silence that show whether they had only been delayed. Delayed frames arrive as fast as the
/// program takes them, others at the camera's rate, within the delays of a busy host.
constexpr int frames_after_silence = 12;
constexpr double least_pace = 0.6;
/// Shorter silences on the host's clock are ignored.
constexpr double least_silence_ns = 0.3e9;

bool is_period(double ns) {
  return ns > 0 && std::isfinite(ns);
}

bool is_gvsp(FrameNumberKind kind) {
  return kind == FrameNumberKind::gvsp16 || kind == FrameNumberKind::gvsp64;
}

/// Upper limit of the exposures of any camera in a time on the host's clock.
double most_steps(double host_ns) {
  return (2 * std::max(host_ns, 0.0) + host_delay_ns) / shortest_period_ns;
}

}  // namespace

void FrameSequence::DevicePeriod::learn(double ns) {
  seen_ns_.push_back(ns);
  if (seen_ns_.size() > remembered_periods) seen_ns_.pop_front();
}

void FrameSequence::DevicePeriod::forget() {
  seen_ns_.clear();
  stated_ns_ = 0;
}

std::optional<double> FrameSequence::DevicePeriod::ns() const {
  const bool stated = is_period(stated_ns_);
  if (seen_ns_.size() < (stated ? enough_periods : 1)) return stated ? std::optional(stated_ns_) : std::nullopt;
  return median({seen_ns_.begin(), seen_ns_.end()});
}

double FrameSequence::DevicePeriod::scatter() const {
  if (seen_ns_.size() < enough_periods) return 0;
  const double centre = median({seen_ns_.begin(), seen_ns_.end()});
  std::vector<double> off;
  for (const double ns : seen_ns_) off.push_back(std::abs(ns - centre) / centre);
  return median(std::move(off));
}

void FrameSequence::HostPeriod::learn(double ns, std::int64_t frames) {
  seen_.push_back({ns, frames});
  if (seen_.size() > remembered_arrivals) seen_.pop_front();
}

void FrameSequence::HostPeriod::forget() {
  seen_.clear();
  stated_ns_ = 0;
}

std::optional<double> FrameSequence::HostPeriod::ns() const {
  const bool stated = is_period(stated_ns_);
  if (seen_.size() < (stated ? enough_arrivals : 1)) return stated ? std::optional(stated_ns_) : std::nullopt;
  double ns = 0, frames = 0;
  for (const Seen& seen : seen_) {
    ns += seen.ns;
    frames += static_cast<double>(seen.frames);
  }
  const double mean_ns = ns / frames;
  if (stated && std::abs(mean_ns - stated_ns_) < 0.25 * stated_ns_) return stated_ns_;
  return is_period(mean_ns) ? std::optional(mean_ns) : std::nullopt;
}

std::optional<double> FrameSequence::Elapsed::best() const {
  if (!device || !host) return device ? device : host;
  constexpr double jitter_periods = 5, jitter_ns = 0.25e9;
  return *host - *device > std::max(jitter_periods, jitter_ns / period_ns) ? host : device;
}

FrameSequence::FrameSequence(FrameNumberKind kind, double frame_rate_hz)
    : kind_(kind), device_period_(1e9 / frame_rate_hz), host_period_(1e9 / frame_rate_hz) {}

std::int64_t FrameSequence::step_to(std::uint64_t number) const {
  const std::uint64_t from = anchor_->number;
  switch (kind_) {
    case FrameNumberKind::gvsp16: {
      // A camera that does not skip 0 sends it between 65535 and 1.
      if (from == gvsp16_period && number == 0) return 1;
      const auto difference =
          static_cast<std::int64_t>(number % gvsp16_period) - static_cast<std::int64_t>(from % gvsp16_period);
      const std::int64_t forward = ((difference % gvsp16_period) + gvsp16_period) % gvsp16_period;
      return forward <= gvsp16_period / 2 ? forward : forward - gvsp16_period;
    }
    case FrameNumberKind::wrap32:
      return static_cast<std::int32_t>(static_cast<std::uint32_t>(number - from));
    case FrameNumberKind::wrap16:
      return static_cast<std::int16_t>(static_cast<std::uint16_t>(number - from));
    case FrameNumberKind::gvsp64:
    case FrameNumberKind::wide:
      break;
  }
  return static_cast<std::int64_t>(number - from);
}

/// Exposures between two frames with this distance in periods.
std::uint64_t FrameSequence::steps_in(double periods, const FrameStamp& stamp) const {
  const double host_ns = static_cast<double>(stamp.host_time_ns - anchor_->host_time_ns);
  return static_cast<std::uint64_t>(std::clamp(std::round(periods), 1.0, most_steps(host_ns)));
}

FrameSequence::Elapsed FrameSequence::elapsed(const FrameStamp& stamp) const {
  Elapsed out;
  const double host_ns = static_cast<double>(stamp.host_time_ns) - static_cast<double>(anchor_->host_time_ns);
  if (const auto period = host_period_.ns()) {
    out.host = std::max(host_ns, 0.0) / *period;
    out.period_ns = *period;
  }
  const auto period = device_period_.ns();
  const bool both = stamp.device_time_ns > 0 && anchor_->device_time_ns > 0;
  const double device_ns = static_cast<double>(stamp.device_time_ns) - static_cast<double>(anchor_->device_time_ns);
  // A clock that was set or stopped gives no time.
  const bool set_ahead = device_ns > 2 * std::max(host_ns, 0.0) + host_delay_ns;
  const bool set_back = host_ns > 2 * device_ns + host_delay_ns;
  if (both && period && device_ns > 0 && !set_ahead && !set_back) out.device = device_ns / *period;
  return out;
}

/// Only packets on a network overtake each other.
bool FrameSequence::is_older(std::int64_t step, const FrameStamp& stamp) const {
  if (step >= 0 || step < -arrival_window || !is_gvsp(kind_)) return false;
  if (stamp.device_time_ns == 0 || anchor_->device_time_ns == 0) return step >= -2;
  const auto period = device_period_.ns();
  if (stamp.device_time_ns >= anchor_->device_time_ns || !period) return false;
  const double periods = static_cast<double>(stamp.device_time_ns - anchor_->device_time_ns) / *period;
  const auto by_number = static_cast<double>(step);
  return std::abs(periods - by_number) <= std::max(0.6, 0.25 * std::abs(by_number));
}

/// Whether a frame with the number of the last one is a new exposure nevertheless.
bool FrameSequence::is_new_exposure(std::int64_t step, const FrameStamp& stamp) const {
  if (step != 0) return true;
  if (stamp.device_time_ns == 0 || anchor_->device_time_ns == 0) return false;
  const auto period = device_period_.ns();
  const auto moved_ns = static_cast<double>(stamp.device_time_ns - anchor_->device_time_ns);
  return std::abs(moved_ns) > 0.5 * period.value_or(0);
}

/// Whether the numbers advanced by far more than the clocks allow.
bool FrameSequence::claims_too_much(std::int64_t step, const Elapsed& passed, const FrameStamp& stamp) const {
  // A clock that restarts takes the numbers with it, unless they continue one by one.
  if (step > 1 && stamp.device_time_ns > 0 && stamp.device_time_ns < anchor_->device_time_ns) return true;
  const auto claimed = static_cast<double>(step);
  const double claimed_ns = claimed * host_period_.ns().value_or(shortest_period_ns);
  const double host_ns = static_cast<double>(stamp.host_time_ns - anchor_->host_time_ns);
  if (claimed > most_steps(host_ns)) return true;
  if (!passed.device) return claimed_ns > 2 * host_ns + host_delay_ns;
  // The preceding frame may have arrived late on the host, but host time that has not passed cannot be reported.
  return *passed.device < 0.75 * claimed - 1 && host_ns < 0.75 * claimed_ns;
}

/// Whether the camera's clock advanced by frames that its numbers do not count.
bool FrameSequence::hides_a_gap(std::int64_t step, const Elapsed& passed, const FrameStamp& stamp) {
  const auto last_gap = std::exchange(last_gap_, std::nullopt);
  if (!passed.device || stamp.may_pause) return false;
  const auto counted = static_cast<double>(step);
  const double tolerance = std::max({0.6, 0.25 * counted, 6 * device_period_.scatter() * counted});
  if (*passed.device < counted + tolerance) return false;
  const double gap = *passed.device / counted;
  if (last_gap && std::abs(gap - *last_gap) < 0.1 * gap) {
    // The same gap twice in succession is the camera's new rate.
    device_period_.forget();
    host_period_.forget();
    return false;
  }
  last_gap_ = gap;
  return true;
}

/// Exposures dropped on arrival because their numbers had been received before: numbers and camera clock restarted at 0
/// or 1, so that both continue as if nothing had happened. Only the host's clock shows the loss, and only if the
/// silence is as long as the numbers are high. It is confirmed some frames later, if those did not arrive in a burst.
std::uint64_t FrameSequence::dropped_on_arrival(std::int64_t step, const Elapsed& passed, const FrameStamp& stamp) {
  const auto period = host_period_.ns();
  if (!is_gvsp(kind_) || !period || !passed.host) return 0;
  if (silence_) {
    ++silence_->frames;
    if (silence_->frames < frames_after_silence) return 0;
    const Silence over = *std::exchange(silence_, std::nullopt);
    const double since = static_cast<double>(stamp.host_time_ns - over.host_time_ns) / *period;
    return since < least_pace * over.frames ? 0 : steps_in(over.missing, stamp);
  }
  const double missing = *passed.host - static_cast<double>(step);
  const auto number = static_cast<double>(*stamp.number);
  // The frame before the silence may have arrived late, which shortens the silence.
  const bool as_long_as_the_numbers =
      number <= arrival_window + 1 && missing > 0.8 * number - 3 && missing < 2 * number + 3;
  if (step == 1 && !stamp.may_pause && missing * *period > least_silence_ns && as_long_as_the_numbers) {
    silence_ = Silence{.missing = missing, .host_time_ns = stamp.host_time_ns, .frames = 0};
  }
  return 0;
}

void FrameSequence::learn(std::int64_t step, const FrameStamp& stamp) {
  constexpr std::int64_t most = 8;
  if (step < 1 || step > most) return;
  const auto frames = static_cast<double>(step);
  const auto host_ns = static_cast<double>(stamp.host_time_ns - anchor_->host_time_ns);
  host_period_.learn(std::max(host_ns, 0.0), step);
  if (stamp.device_time_ns <= anchor_->device_time_ns || anchor_->device_time_ns == 0) return;
  device_period_.learn(static_cast<double>(stamp.device_time_ns - anchor_->device_time_ns) / frames);
}

FramePlace FrameSequence::keep(const FrameStamp& stamp, std::uint64_t sequence, Numbering numbering) {
  anchor_ = Anchor{.number = *stamp.number,
                   .sequence = sequence,
                   .device_time_ns = stamp.device_time_ns,
                   .host_time_ns = stamp.host_time_ns};
  // Frames without number may have been given places up to a later one.
  last_ = std::max(last_, sequence);
  return {sequence, numbering};
}

FramePlace FrameSequence::next(const FrameStamp& as_told) {
  const std::uint64_t following = started_ ? last_ + 1 : 0;
  FramePlace place = place_of(as_told);
  const bool gap = place.sequence > following, unread = as_told.after_unread || after_unread_;
  after_unread_ = as_told.after_unread && !gap;
  if (gap && unread && place.numbering == Numbering::counted) place.numbering = Numbering::unread;
  return place;
}

FramePlace FrameSequence::place_of(const FrameStamp& as_told) {
  FrameStamp stamp = as_told;
  stamp.device_time_ns = std::max<std::int64_t>(stamp.device_time_ns, 0);
  const bool first = !std::exchange(started_, true);
  const std::uint64_t following = first ? 0 : last_ + 1;
  if (!stamp.number) {
    last_ = following;
    return {following, Numbering::counted};
  }
  if (!anchor_) return keep(stamp, following, Numbering::counted);
  const std::int64_t step = step_to(*stamp.number);
  if (is_older(step, stamp)) {
    const auto back = static_cast<std::uint64_t>(-step);
    return {anchor_->sequence - std::min(back, anchor_->sequence), Numbering::counted};
  }
  if (!is_new_exposure(step, stamp)) return {anchor_->sequence, Numbering::counted};
  const Elapsed passed = elapsed(stamp);
  if (step <= 0 || claims_too_much(step, passed, stamp)) {
    silence_.reset();
    const std::uint64_t at = anchor_->sequence + steps_in(passed.best().value_or(1), stamp);
    return keep(stamp, std::max(at, following), Numbering::restarted);
  }
  if (hides_a_gap(step, passed, stamp)) {
    silence_.reset();
    const std::uint64_t at = anchor_->sequence + steps_in(*passed.device, stamp);
    return keep(stamp, std::max(at, following), Numbering::timed);
  }
  const std::uint64_t dropped = dropped_on_arrival(step, passed, stamp);
  if (!silence_) learn(step, stamp);
  const std::uint64_t sequence = anchor_->sequence + static_cast<std::uint64_t>(step) + dropped;
  return keep(stamp, sequence, dropped > 0 ? Numbering::timed : Numbering::counted);
}

}  // namespace todbench
