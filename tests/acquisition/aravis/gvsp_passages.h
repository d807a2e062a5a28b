// SPDX-License-Identifier: GPL-3.0-or-later
// What tests of the camera on plain sockets do again and again: a quick camera, opened and started, frames compared.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <optional>

#include "tests/support/gvsp_test_support.h"

namespace todbench::testing_support {

/// What came of a number of frames.
struct Received {
  int complete = 0, incomplete = 0, wrong_size = 0, false_pixels = 0, gaps = 0;
};

/// Takes frames; complete ones are compared with the exposure that they say they are.
inline Received receive(FrameSource& source, const GvspCameraConfig& config, int frames) {
  Received out;
  std::optional<std::uint64_t> last;
  for (int k = 0; k < frames; ++k) {
    const auto frame = source.next(patience);
    EXPECT_TRUE(frame) << frame.error().message;
    if (!frame) return out;
    if (last && frame->sequence > *last + 1) out.gaps += static_cast<int>(frame->sequence - *last - 1);
    last = frame->sequence;
    if (frame->status == FrameStatus::incomplete) ++out.incomplete;
    if (frame->status == FrameStatus::wrong_size) ++out.wrong_size;
    if (frame->status != FrameStatus::complete) continue;
    ++out.complete;
    const auto index = exposure_index(*frame, config.frame_rate_hz);
    const auto truth = test_picture(index, config.width, config.height, config.significant_bits);
    if (!same_pixels(frame->counts, truth)) ++out.false_pixels;
  }
  return out;
}

/// With the counts of the model: the A series sends hundredths of a kelvin in 16 bits.
inline GvspCameraConfig quick(CameraModel model = CameraModel::ax5) {
  GvspCameraConfig config;
  config.model = model;
  if (model == CameraModel::a_series || model == CameraModel::legacy_science) {
    config.significant_bits = 16;
    config.kelvin_per_count = 0.01;
  }
  config.width = 160;
  config.height = 128;
  config.frame_rate_hz = 100;
  return config;
}

inline std::unique_ptr<FrameSource> open_started(const AravisOptions& options = {}) {
  auto source = open_camera(options);
  const bool started = source && source->start().has_value();
  EXPECT_TRUE(started);
  return source;
}

}  // namespace todbench::testing_support
