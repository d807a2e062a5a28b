// SPDX-License-Identifier: GPL-3.0-or-later
// An Aravis camera that reports the loss of control and is destroyed only when that is safe. Private to the Aravis back
// end.
//
// Aravis emits "control-lost" on a thread of the device (heartbeat, USB events), and the destruction of the device
// joins that thread. An emission holds a reference to the device. If the emission holds the last reference, the thread
// joins itself and GLib aborts the program. The owner must therefore hold the last reference, and waits until no
// emission can be running.
#pragma once

#include <functional>
#include <memory>

#include "acquisition/aravis/glib_ptr.h"

namespace todbench {

/// Owner of an Aravis camera.
class WatchedCamera {
 public:
  /// `on_lost` is called on a thread of Aravis. `on_lost` must not wait for the thread that destroys this object.
  WatchedCamera(GObjectPtr<ArvCamera> camera, std::function<void()> on_lost);
  /// Destroys camera and device on this thread, after every emission of "control-lost" has ended and every other
  /// reference to the device has been released. Destroy streams first. Takes five seconds if the camera does not
  /// answer.
  ~WatchedCamera();
  WatchedCamera(WatchedCamera&&) noexcept = default;
  WatchedCamera& operator=(WatchedCamera&&) = delete;
  WatchedCamera(const WatchedCamera&) = delete;
  WatchedCamera& operator=(const WatchedCamera&) = delete;

  [[nodiscard]] ArvCamera* get() const { return camera_.get(); }

 private:
  class Flag;
  struct Listener;
  static void on_control_lost(ArvDevice* device, void* listener);
  static void on_listener_gone(void* listener, GClosure* closure);
  static void on_toggled(void* last, GObject* device, gboolean is_last);

  GObjectPtr<ArvCamera> camera_;
  std::shared_ptr<Flag> listener_gone_;
  gulong handler_ = 0;
};

}  // namespace todbench
