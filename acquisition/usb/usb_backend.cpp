// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/usb/usb_backend.h"

#include <sys/time.h>

#include <algorithm>
#include <utility>

#include "acquisition/base/try.h"
#include "acquisition/core/camera_id.h"
#include "acquisition/core/serial_number.h"
#include "acquisition/usb/seek_source.h"
#include "acquisition/usb/usb_connection.h"

namespace todbench {
namespace {

/// A camera that answered, with its id.
struct Found {
  SeekOnBus on_bus;
  UsbConnection connection;
  std::string id, serial;
};

struct Search {
  std::vector<Found> found;
  std::string unusable;  ///< a clause for each camera whose serial number could not be read
};

Result<Search> search(libusb_context* context) {
  TODBENCH_TRY(auto cameras, seek_cameras(context));
  Search search;
  for (auto& camera : cameras) {
    auto connection = UsbConnection::open(camera);
    const auto serial = connection ? connection->serial_number() : tl::unexpected(connection.error());
    if (!serial) {
      search.unusable += "; Seek " + std::string(to_string(camera.model)) + " at " + serial.error().message;
      continue;
    }
    std::string id = seek_camera_id(camera.model, *serial);
    search.found.push_back({std::move(camera), std::move(*connection), std::move(id), *serial});
  }
  return search;
}

class UsbBackend final : public CameraBackend {
 public:
  [[nodiscard]] std::string scheme() const override { return std::string(camera_scheme::usb); }

  [[nodiscard]] Result<std::vector<CameraEntry>> list() override {
    TODBENCH_TRY(auto context, usb_context());
    TODBENCH_TRY(const auto seen, search(context.get()));
    std::vector<CameraEntry> entries;
    for (const auto& camera : seen.found) {
      entries.push_back({.id = camera.id,
                         .vendor = "Seek Thermal",
                         .model = std::string(to_string(camera.on_bus.model)),
                         .serial = camera.serial,
                         .transport = "USB (Seek)",
                         .address = camera.on_bus.address,
                         .note = placeholder_serial_warning(camera.serial)});
    }
    if (entries.empty() && !seen.unusable.empty()) return fail(ErrorCode::not_found, seen.unusable.substr(2));
    return entries;
  }

  [[nodiscard]] Result<std::unique_ptr<FrameSource>> open(const std::string& id) override {
    TODBENCH_TRY(auto context, usb_context());
    TODBENCH_TRY(auto seen, search(context.get()));
    std::string names;
    const auto namesakes =
        std::count_if(seen.found.begin(), seen.found.end(), [&id](const Found& camera) { return camera.id == id; });
    if (namesakes > 1) {
      return fail(ErrorCode::not_found, std::to_string(namesakes) + " cameras have the id " + id +
                                            ". The program cannot distinguish them: connect only one");
    }
    for (auto& camera : seen.found) {
      if (camera.id != id) {
        names += (names.empty() ? "" : ", ") + camera.id;
        continue;
      }
      return SeekSource::create(context, camera.on_bus, camera.id, std::move(camera.connection));
    }
    return fail(ErrorCode::not_found, "no such camera; found: " + (names.empty() ? "none" : names) + seen.unusable);
  }
};

}  // namespace

std::unique_ptr<CameraBackend> usb_backend() {
  return std::make_unique<UsbBackend>();
}

}  // namespace todbench
