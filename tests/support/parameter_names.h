// SPDX-License-Identifier: GPL-3.0-or-later
// Names of values that tests take as parameters: without them GoogleTest lists a test with the bytes of its parameter.
#pragma once

#include <array>
#include <ostream>

#include "acquisition/core/integrity_gate.h"
#include "acquisition/pixel_formats/pixel_formats.h"
#include "acquisition/usb/seek_protocol.h"
#include "sim_devices/lab/video/video_frames.h"

namespace todbench {

inline void PrintTo(Rejection reason, std::ostream* out) {
  *out << to_string(reason);
}

inline void PrintTo(PixelFormat format, std::ostream* out) {
  *out << to_string(format);
}

inline void PrintTo(SeekModel model, std::ostream* out) {
  *out << to_string(model);
}

namespace test {

[[nodiscard]] inline const char* name_of(VideoCameraKind kind) {
  constexpr std::array<const char*, 6> kinds{"Y16", "Y14", "Grey", "Lepton", "Boson", "TemperatureRows"};
  return kinds.at(static_cast<std::size_t>(kind));
}

}  // namespace test

inline void PrintTo(VideoCameraKind kind, std::ostream* out) {
  *out << test::name_of(kind);
}

}  // namespace todbench
