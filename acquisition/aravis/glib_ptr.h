// SPDX-License-Identifier: GPL-3.0-or-later
// Ownership of GLib and Aravis objects. Private to the Aravis back end.
#pragma once

#include <arv.h>

#include <memory>
#include <string>

#include "acquisition/base/result.h"

namespace todbench {

struct GObjectUnref {
  void operator()(void* object) const { g_object_unref(object); }
};
/// One reference to a GObject.
template <typename T>
using GObjectPtr = std::unique_ptr<T, GObjectUnref>;

struct GFree {
  void operator()(void* memory) const { g_free(memory); }
};
/// Memory that GLib allocated.
template <typename T>
using GPtr = std::unique_ptr<T, GFree>;

/// Receives a GError: pass `error.out()` to one call, then test the object.
class GErrorSlot {
 public:
  GErrorSlot() = default;
  ~GErrorSlot() { g_clear_error(&error_); }
  GErrorSlot(const GErrorSlot&) = delete;
  GErrorSlot& operator=(const GErrorSlot&) = delete;

  /// Clears an earlier error. The pointer is valid as long as this object.
  [[nodiscard]] GError** out() {
    g_clear_error(&error_);
    return &error_;
  }
  [[nodiscard]] explicit operator bool() const { return error_ != nullptr; }
  [[nodiscard]] std::string message() const { return error_ != nullptr ? error_->message : "unknown error"; }
  /// Returns true if the device did not answer, and false if it refused.
  [[nodiscard]] bool lost() const {
    return error_ != nullptr && error_->domain == ARV_DEVICE_ERROR &&
           (error_->code == ARV_DEVICE_ERROR_TIMEOUT || error_->code == ARV_DEVICE_ERROR_NOT_CONNECTED ||
            error_->code == ARV_DEVICE_ERROR_TRANSFER_ERROR);
  }
  /// Returns the error "DOING: message" with code `disconnected` if the device did not answer, otherwise `refused`.
  [[nodiscard]] tl::unexpected<Error> failure(ErrorCode refused, const std::string& doing) const {
    return fail(lost() ? ErrorCode::disconnected : refused, doing + ": " + message());
  }

 private:
  GError* error_ = nullptr;
};

inline std::string text_or_empty(const char* text) {
  return text != nullptr ? text : "";
}

}  // namespace todbench
