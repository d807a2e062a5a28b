// What a frame is.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <string_view>

#include "acquisition/core/radiometric_scale.h"

namespace todbench {

/// How far the pixels of a frame can be trusted, as the transport tells.
enum class FrameStatus {
  complete,
  incomplete,  ///< data missing or late; never measured
  wrong_size,  ///< geometry or payload differs from what was negotiated
};

[[nodiscard]] std::string_view to_string(FrameStatus status);

/// What the camera itself says about its non-uniformity correction: a telemetry row, a chunk or a node.
enum class CorrectionState {
  unknown,  ///< the camera does not say
  idle,
  running,  ///< imminent, or the shutter is closed
};

/// How the sequence of a frame came about.
enum class Numbering : std::uint8_t {
  counted,    ///< by the numbers of the camera or its driver, which fit the time that passed
  restarted,  ///< the numbers began anew or jumped against all clocks; what is missing is estimated from time
  timed,      ///< the numbers go on, the time does not: what is missing is estimated from time
};

[[nodiscard]] std::string_view to_string(Numbering numbering);

struct JudgedPicture;

/// One exposed image. Immutable once handed out: pixels are shared, copying is cheap, any thread may read.
struct Frame {
  cv::Mat1w counts;            ///< as the camera sent them, row by row from the top
  std::uint64_t sequence = 0;  ///< counts exposures, unwrapped; a gap is a lost frame
  std::int64_t device_time_ns =
      0;  ///< the camera's own clock (start of transfer where the camera does not say more); 0: none
  std::int64_t host_time_ns = 0;  ///< CLOCK_MONOTONIC when the complete frame reached the program
  FrameStatus status = FrameStatus::complete;
  Numbering numbering = Numbering::counted;
  CorrectionState correction = CorrectionState::unknown;  ///< while this frame was exposed
  double since_correction_s = -1;                         ///< as the camera says; negative: it does not
  int significant_bits = 16;                              ///< full scale is 2^significant_bits - 1 counts
  std::shared_ptr<const RadiometricScale> scale;          ///< never null
  std::shared_ptr<const JudgedPicture> judged{};          ///< null: the counts themselves
};

/// The frame in kelvin. Fails with `calibration` when the scale cannot say for some pixel.
[[nodiscard]] Result<cv::Mat1d> to_kelvin(const Frame& frame);

}  // namespace todbench
