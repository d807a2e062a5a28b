// SPDX-License-Identifier: GPL-3.0-or-later
// Converts frame numbers of cameras and drivers to an exposure count that never wraps. Checks the numbers against time.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "acquisition/core/frame.h"

namespace todbench {

/// Numbering of frames by transport.
enum class FrameNumberKind {
  gvsp16,  ///< GigE Vision without extended ids: 16 bits, 65535 is followed by 1, 0 is never sent
  gvsp64,  ///< GigE Vision with extended ids
  wide,    ///< 64 bits, never wraps: USB3 Vision
  wrap32,  ///< V4L2
  wrap16,  ///< a 16-bit counter that includes 0: Seek
};

/// Number and times of a frame at its arrival.
struct FrameStamp {
  std::optional<std::uint64_t> number;  ///< empty: lost together with its packet
  std::int64_t device_time_ns = 0;      ///< time on the clock of the camera or driver; 0: none
  std::int64_t host_time_ns = 0;        ///< CLOCK_MONOTONIC at arrival
  bool may_pause = false;               ///< a correction is running: the camera may send no frames without losing
                                        ///< exposures
  bool after_unread = false;  ///< other frames were lost since the last frame because every buffer of the program was
                              ///< full
};

/// Frame::sequence and its origin.
struct FramePlace {
  std::uint64_t sequence = 0;
  Numbering numbering = Numbering::counted;
  bool operator==(const FramePlace&) const = default;
};

/// Converts frame numbers to Frame::sequence: 0 for the first frame of a stream, gaps for lost exposures.
///
/// Numbers are used unless the clocks contradict them. A number that decreases, or increases by far more than the
/// elapsed time, indicates a restart. If numbers are consecutive although several frame periods have passed, frames
/// were lost (Aravis silently drops up to a hundred frames whose ids it has already received). The gap is then
/// estimated from the camera's clock if it agrees with the host's clock, otherwise from the host's clock.
///
/// Frames must be given in the order in which the transport completed them. One thread at a time.
class FrameSequence {
 public:
  /// `frame_rate_hz` as the camera reports it; 0: unknown.
  FrameSequence(FrameNumberKind kind, double frame_rate_hz);

  /// Returns the position of a frame in the sequence. A frame without a number gets the position after the last frame;
  /// its true position is the same or later. 16-bit numbers are unwrapped over gaps of up to 32767 frames (ten minutes
  /// at 50 Hz). A frame that is older than the last frame, by its number and by the camera's clock, gets its older
  /// position. A counted gap before a frame with `after_unread` is `unread`. A gap before the next frame is also
  /// `unread`, because a frame may have been in transfer when the buffers were full.
  [[nodiscard]] FramePlace next(const FrameStamp& as_told);

 private:
  /// The last frame that had a number.
  struct Anchor {
    std::uint64_t number = 0, sequence = 0;
    std::int64_t device_time_ns = 0, host_time_ns = 0;
  };
  /// Frame periods from the anchor to a frame, by each clock; empty if the clock has no time.
  struct Elapsed {
    std::optional<double> device, host;
    double period_ns = 0;  ///< frame period on the host's clock
    /// Returns the number of periods from which to estimate a gap after a restart. The number is that of the camera's
    /// clock. If the host's clock counts far more periods than the camera's clock, the camera's clock has also
    /// restarted; the number is then that of the host's clock.
    [[nodiscard]] std::optional<double> best() const;
  };
  /// Frame period on the camera's clock: the median of the observed periods.
  class DevicePeriod {
   public:
    explicit DevicePeriod(double stated_ns) : stated_ns_(stated_ns) {}
    void learn(double ns);
    void forget();
    [[nodiscard]] std::optional<double> ns() const;
    /// Returns the scatter of the frame period, in periods.
    [[nodiscard]] double scatter() const;

   private:
    double stated_ns_;
    std::deque<double> seen_ns_;
  };
  /// Frame period on the host's clock, on which single frames arrive early or late. It is the stated period, or the
  /// mean of the observed periods if the mean contradicts the stated period.
  class HostPeriod {
   public:
    explicit HostPeriod(double stated_ns) : stated_ns_(stated_ns) {}
    void learn(double ns, std::int64_t frames);
    void forget();
    [[nodiscard]] std::optional<double> ns() const;

   private:
    struct Seen {
      double ns = 0;
      std::int64_t frames = 1;
    };
    double stated_ns_;
    std::deque<Seen> seen_;
  };
  /// Interval without frames on the host's clock. No frame was lost if the frames after the interval arrive faster than
  /// the frame rate.
  struct Silence {
    double missing = 0;  ///< missing frames, in frame periods
    std::int64_t host_time_ns = 0;
    int frames = 0;  ///< number of frames since this interval
  };

  [[nodiscard]] FramePlace place_of(const FrameStamp& as_told);
  [[nodiscard]] std::int64_t step_to(std::uint64_t number) const;
  [[nodiscard]] std::uint64_t steps_in(double periods, const FrameStamp& stamp) const;
  [[nodiscard]] Elapsed elapsed(const FrameStamp& stamp) const;
  [[nodiscard]] bool is_older(std::int64_t step, const FrameStamp& stamp) const;
  [[nodiscard]] bool is_new_exposure(std::int64_t step, const FrameStamp& stamp) const;
  [[nodiscard]] bool claims_too_much(std::int64_t step, const Elapsed& passed, const FrameStamp& stamp) const;
  [[nodiscard]] bool hides_a_gap(std::int64_t step, const Elapsed& passed, const FrameStamp& stamp);
  [[nodiscard]] std::uint64_t dropped_on_arrival(std::int64_t step, const Elapsed& passed, const FrameStamp& stamp);
  void learn(std::int64_t step, const FrameStamp& stamp);
  FramePlace keep(const FrameStamp& stamp, std::uint64_t sequence, Numbering numbering);

  FrameNumberKind kind_;
  DevicePeriod device_period_;
  HostPeriod host_period_;
  bool started_ = false;
  bool after_unread_ = false;  ///< FrameStamp::after_unread of the last frame, if no gap preceded it
  std::optional<Anchor> anchor_;
  std::uint64_t last_ = 0;
  std::optional<double> last_gap_;  ///< gap before the last frame, in frame periods of the device clock, if the frame
                                    ///< numbers do not show it
  std::optional<Silence> silence_;
};

}  // namespace todbench
