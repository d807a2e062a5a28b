// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/frame.h"

namespace todbench {

std::string_view to_string(FrameStatus status) {
  switch (status) {
    case FrameStatus::complete:
      return "complete";
    case FrameStatus::incomplete:
      return "incomplete";
    case FrameStatus::wrong_size:
      return "wrong size";
  }
  return "unknown";
}

std::string_view to_string(Numbering numbering) {
  switch (numbering) {
    case Numbering::counted:
      return "counted";
    case Numbering::restarted:
      return "restarted";
    case Numbering::timed:
      return "timed";
    case Numbering::unread:
      return "unread";
  }
  return "unknown";
}

Result<cv::Mat1d> to_kelvin(const Frame& frame) {
  cv::Mat1d kelvin(frame.counts.size());
  if (const LinearScale* line = frame.scale->straight_line()) {
    for (int row = 0; row < kelvin.rows; ++row) {
      const std::uint16_t* counts = frame.counts.ptr<std::uint16_t>(row);
      double* out = kelvin[row];
      for (int column = 0; column < kelvin.cols; ++column)
        out[column] = line->offset_k + line->kelvin_per_count * counts[column];
    }
    return kelvin;
  }
  for (int row = 0; row < kelvin.rows; ++row) {
    for (int column = 0; column < kelvin.cols; ++column) {
      const auto value = frame.scale->kelvin(frame.counts(row, column));
      if (!value) {
        return fail(ErrorCode::calibration, "pixel (" + std::to_string(column) + ", " + std::to_string(row) +
                                                ") with " + std::to_string(frame.counts(row, column)) +
                                                " counts has no temperature on this scale (" + frame.scale->describe() +
                                                ")");
      }
      kelvin(row, column) = *value;
    }
  }
  return kelvin;
}

}  // namespace todbench
