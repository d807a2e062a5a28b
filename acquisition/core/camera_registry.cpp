// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/camera_registry.h"

#include "acquisition/core/camera_id.h"

namespace todbench {

void CameraRegistry::add(std::unique_ptr<CameraBackend> backend) {
  backends_.push_back(std::move(backend));
}

CameraRegistry::Listing CameraRegistry::list() {
  Listing listing;
  for (const auto& backend : backends_) {
    auto cameras = backend->list();
    if (!cameras) {
      listing.warnings.push_back("listing " + backend->scheme() + " cameras: " + cameras.error().message);
      continue;
    }
    for (const CameraEntry& camera : *cameras) {
      if (!camera.note.empty()) listing.warnings.push_back(camera.id + ": " + camera.note);
    }
    listing.cameras.insert(listing.cameras.end(), cameras->begin(), cameras->end());
  }
  return listing;
}

Result<std::unique_ptr<FrameSource>> CameraRegistry::open(const std::string& id) {
  std::string schemes;
  for (const auto& backend : backends_) {
    const std::string scheme = backend->scheme();
    if (has_scheme(id, scheme)) {
      auto source = backend->open(id);
      if (!source) return fail("opening camera " + id, source.error());
      return source;
    }
    schemes += (schemes.empty() ? "" : ", ") + scheme + ":";
  }
  return fail(ErrorCode::invalid_input, "camera id '" + id + "' does not begin with one of " + schemes);
}

}  // namespace todbench
