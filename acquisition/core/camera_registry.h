// Finding and opening cameras by identity.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "acquisition/core/frame_source.h"
#include "acquisition/core/result.h"

namespace todbench {

/// A camera that a back end sees.
struct CameraEntry {
  std::string id;  ///< "gige:VENDOR-SERIAL", "sim:sc2000", "file:PATH"
  std::string vendor, model, serial, transport;
  std::string address;  ///< where it is now; never part of the identity
};

/// A family of cameras: two functions are all that is needed to add one.
class CameraBackend {
 public:
  virtual ~CameraBackend() = default;
  /// Prefix of the ids that it opens, without the colon: "gige".
  [[nodiscard]] virtual std::string scheme() const = 0;
  /// What can be opened now. Takes up to two seconds on a network.
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
  /// Opens by id; `invalid_input` for an id without a known scheme, with the schemes named.
  [[nodiscard]] Result<std::unique_ptr<FrameSource>> open(const std::string& id);

 private:
  std::vector<std::unique_ptr<CameraBackend>> backends_;
};

}  // namespace todbench
