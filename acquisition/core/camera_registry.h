// SPDX-License-Identifier: GPL-3.0-or-later
// Finding and opening cameras by identity.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "acquisition/core/frame_source.h"

namespace todbench {

/// A camera that a back end lists.
struct CameraEntry {
  std::string id;  ///< "gige:VENDOR-SERIAL", "sim:sc2000", "file:PATH"
  std::string vendor, model, serial, transport;
  std::string address;  ///< present location; never part of the identity
  std::string note{};   ///< one sentence if the camera cannot be opened in its present state or cannot be identified
                        ///< again; otherwise empty
};

/// A back end for one family of cameras. To add one, implement list() and open().
class CameraBackend {
 public:
  virtual ~CameraBackend() = default;
  /// Returns the prefix of the ids of this back end, without the colon: "gige".
  [[nodiscard]] virtual std::string scheme() const = 0;
  /// Lists the cameras that can be opened now. Takes up to two seconds on a network.
  [[nodiscard]] virtual Result<std::vector<CameraEntry>> list() = 0;
  /// Opens by identity. Errors: `not_found` (absent, busy, access denied, no usable pixel format).
  [[nodiscard]] virtual Result<std::unique_ptr<FrameSource>> open(const std::string& id) = 0;
};

/// The back ends of a program, by scheme. Owns them. One thread at a time.
class CameraRegistry {
 public:
  void add(std::unique_ptr<CameraBackend> backend);
  /// Cameras of every back end. A back end that fails contributes a warning instead of cameras.
  struct Listing {
    std::vector<CameraEntry> cameras;
    std::vector<std::string> warnings;
  };
  [[nodiscard]] Listing list();
  /// Opens by id. Error: `invalid_input`, with the known schemes, if the id has no known scheme.
  [[nodiscard]] Result<std::unique_ptr<FrameSource>> open(const std::string& id);

 private:
  std::vector<std::unique_ptr<CameraBackend>> backends_;
};

}  // namespace todbench
