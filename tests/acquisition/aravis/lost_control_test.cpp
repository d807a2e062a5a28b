// SPDX-License-Identifier: GPL-3.0-or-later
// The end of a camera whose control is lost, while Aravis still says so.
#include <arv.h>
#include <gmock/gmock.h>

#include <condition_variable>
#include <mutex>
#include <thread>

#include "acquisition/aravis/aravis_source.h"
#include "tests/support/gvsp_test_support.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;

/// A slow listener to "control-lost": it comes after the source's own and returns when the source has long gone.
class SlowListener {
 public:
  explicit SlowListener(ArvDevice* device) {
    g_signal_connect(device, "control-lost", G_CALLBACK(&SlowListener::on_control_lost), this);
    g_object_weak_ref(G_OBJECT(device), &SlowListener::on_destruction, this);
  }

  void wait_until_called() {
    wait([this] { return called_; });
  }
  void wait_until_destroyed() {
    wait([this] { return destroyed_; });
  }
  void source_is_gone() {
    change([this] { source_gone_ = true; });
  }

  [[nodiscard]] std::thread::id emitting() const { return emitting_; }
  [[nodiscard]] std::thread::id destroying() const { return destroying_; }
  [[nodiscard]] bool returned_before_destruction() const { return returned_first_; }

 private:
  static void on_control_lost(ArvDevice* device, void* data) {
    auto& self = *static_cast<SlowListener*>(data);
    const auto references = [&] { return g_atomic_int_get(&G_OBJECT(device)->ref_count); };
    const int of_the_source = 2;  // of its camera and of its stream
    const int without_source = references() - of_the_source;
    self.change([&] {
      self.called_ = true;
      self.emitting_ = std::this_thread::get_id();
    });
    self.wait([&] { return self.source_gone_; });
    // Time to drop them: the last one must not be left to this thread.
    for (int k = 0; k < 200 && references() > without_source; ++k) std::this_thread::sleep_for(5ms);
    self.change([&] { self.returned_first_ = !self.destroyed_; });
  }
  static void on_destruction(void* data, GObject*) {
    auto& self = *static_cast<SlowListener*>(data);
    self.change([&] {
      self.destroyed_ = true;
      self.destroying_ = std::this_thread::get_id();
    });
  }
  template <typename Change>
  void change(Change make) {
    const std::lock_guard lock(mutex_);
    make();
    changed_.notify_all();
  }
  template <typename Condition>
  void wait(Condition met) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, met);
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool called_ = false, source_gone_ = false, destroyed_ = false, returned_first_ = false;
  std::thread::id emitting_, destroying_;
};

/// Frames until there are no more, and why.
Error end_of(FrameSource& source) {
  for (;;) {
    const auto frame = source.next(300ms);
    if (!frame && frame.error().code != ErrorCode::timeout) return frame.error();
  }
}

TEST(LostControl, TheCameraIsNotDestroyedByTheThreadThatTellsOfItsLoss) {
  const auto camera = testing_support::start_gvsp_camera({});
  GObjectPtr<ArvCamera> opened(arv_camera_new("127.0.0.1", nullptr));
  ASSERT_TRUE(camera && opened);
  ArvDevice* device = arv_camera_get_device(opened.get());
  auto source = AravisSource::create(std::move(opened), {}, {}, "127.0.0.1");
  ASSERT_TRUE(source) << source.error().message;
  SlowListener listener(device);
  ASSERT_TRUE((*source)->start());

  camera->reset(50ms);
  EXPECT_EQ(end_of(**source).code, ErrorCode::disconnected);
  listener.wait_until_called();
  source->reset();
  listener.source_is_gone();
  listener.wait_until_destroyed();

  EXPECT_TRUE(listener.returned_before_destruction());
  EXPECT_NE(listener.destroying(), listener.emitting());
}

}  // namespace
}  // namespace todbench
