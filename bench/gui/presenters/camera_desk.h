// SPDX-License-Identifier: GPL-3.0-or-later
// Controls of the camera whose live picture is shown. Requests come from the window, and the thread of the camera
// executes them.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/frame_source.h"
#include "acquisition/recording/frame_stream.h"

namespace todbench {

/// Camera settings that the window shows next to a live picture.
enum class CameraControl { frame_rate, gain, range, exposure };
inline constexpr std::array all_camera_controls{CameraControl::frame_rate, CameraControl::gain, CameraControl::range,
                                                CameraControl::exposure};
/// Returns the label of the control.
[[nodiscard]] std::string_view to_string(CameraControl control);

/// Feature of a camera that implements a control, with its value. Names of features differ between cameras: SFNC names,
/// older and vendor names of GenICam, controls of V4L2 drivers.
struct ControlReading {
  CameraControl control = CameraControl::frame_rate;
  std::string feature;  ///< empty: the camera has no feature with a known name
  std::string value;    ///< read back
};

/// Returns a reading for each control. A feature that cannot be read is treated as absent.
[[nodiscard]] std::vector<ControlReading> read_controls(FrameSource& camera);

/// Sets a feature and reads it back. If a camera rejects the change while streaming, stops the camera, sets the feature
/// and starts the camera. Errors: those of FrameSource::set(), after which the camera streams again; `disconnected`.
[[nodiscard]] Result<std::string> change_feature(FrameSource& camera, const std::string& feature,
                                                 const std::string& value);

/// Queue of requests from the window to the thread of the camera, and recorder of its frames. Thread-safe.
class CameraDesk {
 public:
  using Request = std::function<void(FrameSource&)>;

  /// Discards requests to a previous camera. Call this function after a camera was opened.
  void open();
  /// Adds a request.
  void ask(Request request);
  /// Executes the requests. Called by the thread of the camera.
  void serve(FrameSource& camera);

  /// Starts a recording of the frames that follow. Errors: `io` with the path.
  [[nodiscard]] Result<void> record(const std::filesystem::path& file, const SourceInfo& info);
  /// Returns whether frames are being recorded.
  [[nodiscard]] bool recording() const;
  /// Appends a frame to the recording, if there is one. An error ends the recording.
  [[nodiscard]] Result<void> append(const Frame& frame);
  /// Ends the recording and reads it back. Returns its number of frames; empty without a recording. Errors: `io`.
  [[nodiscard]] Result<std::optional<std::uint64_t>> end_recording();

 private:
  mutable std::mutex mutex_;
  std::vector<Request> requests_;
  std::optional<FrameStreamWriter> stream_;
};

}  // namespace todbench
