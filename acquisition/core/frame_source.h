// SPDX-License-Identifier: GPL-3.0-or-later
// Interface of a camera: simulated, recorded, emulated or physical.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "acquisition/core/frame.h"

namespace todbench {

/// Identity and settings of the camera, read back from the device.
struct SourceInfo {
  std::string id;  ///< e.g. "gige:FLIR-48000123": stable over reconnects and reboots
  std::string vendor, model, serial, firmware;
  std::string transport;  ///< "GigE Vision", "simulation", "recording"
  int width = 0, height = 0;
  std::string pixel_format;  ///< PFNC name, e.g. "Mono14"
  int significant_bits = 16;
  double frame_rate_hz = 0;  ///< 0: unknown
  RadiometricScale scale;
  std::map<std::string, std::string> settings;  ///< feature -> value read back, for provenance
  std::vector<std::string> warnings;  ///< one sentence each, e.g. if the system did not grant the socket buffer
};

/// A source of frames in order of exposure. A new source is stopped. One thread at a time, except stop(), which any
/// thread may call. After an error `disconnected` the source is unusable: destroy it and open a new source.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  FrameSource() = default;
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;

  [[nodiscard]] virtual const SourceInfo& info() const = 0;
  /// Starts exposing; no effect if started. Discards frames queued by an earlier run.
  [[nodiscard]] virtual Result<void> start() = 0;
  /// Returns the next frame in order, including incomplete frames (see Frame::status). Errors: `timeout` (no frame in
  /// time), `interrupted` (stop() was called), `disconnected` (camera lost, or end of a recording).
  [[nodiscard]] virtual Result<Frame> next(std::chrono::milliseconds timeout) = 0;
  /// Stops exposing and wakes a waiting next(). No effect if stopped.
  virtual void stop() = 0;

  /// Reads or writes one feature by its SFNC (or vendor) name, values as text. Errors: `invalid_input` (no such
  /// feature, value refused), `disconnected`.
  [[nodiscard]] virtual Result<std::string> get(const std::string& feature) = 0;
  [[nodiscard]] virtual Result<void> set(const std::string& feature, const std::string& value) = 0;
  /// Commands a non-uniformity correction and returns without waiting for its end; frames during it may freeze. Error:
  /// `invalid_input` if the camera has no such command.
  [[nodiscard]] virtual Result<void> correct_nonuniformity() = 0;
};

}  // namespace todbench
