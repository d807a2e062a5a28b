// SPDX-License-Identifier: GPL-3.0-or-later
// A frame of a camera.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <string_view>

#include "acquisition/core/radiometric_scale.h"

namespace todbench {

/// Integrity of a frame's pixels as reported by the transport.
enum class FrameStatus {
  complete,
  incomplete,  ///< data are missing or late; the frame is never measured
  wrong_size,  ///< geometry or payload differs from the negotiated values
};

[[nodiscard]] std::string_view to_string(FrameStatus status);

/// State of the non-uniformity correction as the camera reports it in a telemetry row, a chunk or a node.
enum class CorrectionState {
  unknown,  ///< not reported
  idle,
  running,  ///< imminent, or the shutter is closed
};

/// Origin of a frame's sequence number.
enum class Numbering : std::uint8_t {
  counted,    ///< from the numbers of the camera or its driver, which agree with the elapsed time
  restarted,  ///< the numbers restarted or jumped, and all clocks contradict them; the loss is estimated from time
  timed,      ///< the numbers are consecutive, but time is missing; the loss is estimated from time
  unread,     ///< as counted; frames before this one were lost because all buffers of the program were full
};

[[nodiscard]] std::string_view to_string(Numbering numbering);

struct JudgedPicture;

/// One exposed image. Immutable after it is handed out: pixels are shared, copying is cheap, any thread may read.
struct Frame {
  cv::Mat1w counts;                 ///< counts as sent by the camera, row by row from the top
  std::uint64_t sequence = 0;       ///< number of the exposure, unwrapped; a gap means lost frames
  std::int64_t device_time_ns = 0;  ///< the camera's clock, by default at the start of transfer; 0: none
  std::int64_t host_time_ns = 0;    ///< CLOCK_MONOTONIC when the complete frame reached the program
  FrameStatus status = FrameStatus::complete;
  Numbering numbering = Numbering::counted;
  CorrectionState correction = CorrectionState::unknown;  ///< state while this frame was exposed
  double since_correction_s = -1;                         ///< time since the last correction; negative: not reported
  int significant_bits = 16;                              ///< the full scale is 2^significant_bits - 1 counts
  std::shared_ptr<const RadiometricScale> scale;          ///< never null
  std::shared_ptr<const JudgedPicture> judged{};  ///< picture that is judged instead of the counts; null: the counts
                                                  ///< are judged
};

/// Returns the temperatures of the frame in kelvin. Error: `calibration` if the scale has no temperature for some
/// pixel.
[[nodiscard]] Result<cv::Mat1d> to_kelvin(const Frame& frame);

}  // namespace todbench
