// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/v4l2/v4l2_backend.h"

#include "acquisition/base/try.h"
#include "acquisition/core/camera_id.h"
#include "acquisition/core/serial_number.h"
#include "acquisition/v4l2/v4l2_source.h"
#include "acquisition/v4l2/video_listing.h"

namespace todbench {
namespace {

class V4l2Backend final : public CameraBackend {
 public:
  explicit V4l2Backend(V4l2Options options) : options_(std::move(options)) {}

  [[nodiscard]] std::string scheme() const override { return std::string(camera_scheme::v4l2); }

  [[nodiscard]] Result<std::vector<CameraEntry>> list() override {
    TODBENCH_TRY(const auto listing, list_video_nodes());
    std::vector<CameraEntry> cameras;
    for (const auto& node : listing.nodes) {
      cameras.push_back({.id = node.id,
                         .vendor = node.vendor,
                         .model = node.model,
                         .serial = node.serial,
                         .transport = "V4L2 (" + node.driver + ")",
                         .address = node.node,
                         .note = placeholder_serial_warning(node.serial)});
    }
    return cameras;
  }

  [[nodiscard]] Result<std::unique_ptr<FrameSource>> open(const std::string& id) override {
    TODBENCH_TRY(const auto listing, list_video_nodes());
    std::string seen;
    for (const auto& node : listing.nodes) {
      if (node.id == id || camera_id(camera_scheme::v4l2, node.node) == id) return V4l2Source::create(node, options_);
      seen += (seen.empty() ? "" : ", ") + node.id;
    }
    std::string message = "no such camera; found: " + (seen.empty() ? "none" : seen);
    for (const auto& sentence : listing.unreadable) message += "; " + sentence;
    return fail(ErrorCode::not_found, message);
  }

 private:
  V4l2Options options_;
};

}  // namespace

std::unique_ptr<CameraBackend> v4l2_backend(V4l2Options options) {
  return std::make_unique<V4l2Backend>(std::move(options));
}

}  // namespace todbench
