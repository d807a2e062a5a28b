// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/aravis/watched_camera.h"

#include <condition_variable>
#include <mutex>
#include <utility>

namespace todbench {

/// Set by one thread, awaited by another.
class WatchedCamera::Flag {
 public:
  /// The waiting thread may destroy this object as soon as the lock is released.
  void set(bool value) {
    const std::lock_guard lock(mutex_);
    value_ = value;
    changed_.notify_all();
  }
  void wait() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return value_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool value_ = false;
};

/// State owned by GLib's closure.
struct WatchedCamera::Listener {
  std::function<void()> on_lost;
  std::shared_ptr<Flag> gone;
};

void WatchedCamera::on_control_lost(ArvDevice*, void* listener) {
  static_cast<Listener*>(listener)->on_lost();
}

void WatchedCamera::on_listener_gone(void* listener, GClosure*) {
  const std::shared_ptr<Flag> gone = static_cast<Listener*>(listener)->gone;
  delete static_cast<Listener*>(listener);
  gone->set(true);
}

void WatchedCamera::on_toggled(void* last, GObject*, gboolean is_last) {
  static_cast<Flag*>(last)->set(is_last != 0);
}

WatchedCamera::WatchedCamera(GObjectPtr<ArvCamera> camera, std::function<void()> on_lost)
    : camera_(std::move(camera)), listener_gone_(std::make_shared<Flag>()) {
  handler_ = g_signal_connect_data(
      arv_camera_get_device(camera_.get()), "control-lost", G_CALLBACK(&WatchedCamera::on_control_lost),
      new Listener{std::move(on_lost), listener_gone_}, &WatchedCamera::on_listener_gone, GConnectFlags{});
}

WatchedCamera::~WatchedCamera() {
  if (!camera_) return;
  auto* device = G_OBJECT(arv_camera_get_device(camera_.get()));
  // An emission that found the listener keeps its closure until it has called it, and by then it holds its reference to
  // the device. A later emission finds no listener, and GLib returns before it takes a reference.
  g_signal_handler_disconnect(device, handler_);
  listener_gone_->wait();
  // The toggle reference reports when it is the last one: then no emission holds any.
  Flag last;
  g_object_add_toggle_ref(device, &WatchedCamera::on_toggled, &last);
  camera_.reset();
  last.wait();
  g_object_remove_toggle_ref(device, &WatchedCamera::on_toggled, &last);
}

}  // namespace todbench
