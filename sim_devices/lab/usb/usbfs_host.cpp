// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/usb/usbfs_host.h"

#include <umockdev.h>

#include <algorithm>
#include <atomic>
#include <cerrno>

#include "acquisition/base/try.h"
#include "sim_devices/lab/usb/usbfs_state.h"
#include "sim_devices/lab/usb/usbfs_text.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// Number of the first device of this bus. Video cameras of the emulated system use the lower ports.
constexpr int first_number = 51;
std::atomic<int> next_number{first_number};

}  // namespace

PluggedUsbDevice::State::~State() {
  end_workers();
  answers = {};
}

void PluggedUsbDevice::State::end_workers() {
  for (auto& [endpoint, worker] : workers) worker.request_stop();
  workers.clear();
  device.reset();
}

void PluggedUsbDevice::State::perform(const std::stop_token& stop, std::uint8_t endpoint) {
  std::unique_lock lock(mutex);
  while (changed.wait(lock, stop, [&] { return !waiting[endpoint].empty(); })) {
    UsbfsTransferPtr transfer = std::move(waiting[endpoint].front());
    waiting[endpoint].pop_front();
    performing[endpoint] = transfer.get();
    const std::stop_callback pull(stop, [&] { transfer->cancelled.request_stop(); });
    lock.unlock();
    exchange(*device, *transfer);
    lock.lock();
    performing[endpoint] = nullptr;
    if (transfer->client == nullptr) continue;  // its program has ended
    if (unplugged) transfer->status = -ESHUTDOWN;
    done.push_back(std::move(transfer));
    changed.notify_all();
  }
}

UsbfsTransferPtr PluggedUsbDevice::State::finished_for(UMockdevIoctlClient* client) {
  const auto found = std::find_if(done.begin(), done.end(), [&](const auto& t) { return t->client == client; });
  if (found == done.end()) return nullptr;
  UsbfsTransferPtr transfer = std::move(*found);
  done.erase(found);
  return transfer;
}

void PluggedUsbDevice::State::answer_reapers(const std::stop_token& stop) {
  std::unique_lock lock(mutex);
  while (!stop.stop_requested()) {
    auto next = Clock::now() + 1h;
    for (auto reaper = reapers.begin(); reaper != reapers.end();) {
      UMockdevIoctlClient* client = reaper->client;
      if (const auto transfer = finished_for(client)) {
        const int error = hand_over(client, *transfer);
        umockdev_ioctl_client_complete(client, error != 0 ? -1 : 0, error);
        g_object_unref(client);
        reaper = reapers.erase(reaper);
      } else if (reaper->patience_ends && *reaper->patience_ends <= Clock::now()) {
        umockdev_ioctl_client_complete(client, -1, unplugged ? ENODEV : EAGAIN);
        g_object_unref(client);
        reaper = reapers.erase(reaper);
      } else {
        if (reaper->patience_ends) next = std::min(next, *reaper->patience_ends);
        ++reaper;
      }
    }
    changed.wait_until(lock, stop, next, [&] {
      return std::any_of(reapers.begin(), reapers.end(), [&](const Reaper& r) {
        return (r.patience_ends && *r.patience_ends < next) ||
               std::any_of(done.begin(), done.end(), [&](const auto& t) { return t->client == r.client; });
      });
    });
  }
}

/// Ends the transfers of a program that has ended, or of all programs (null) after unplugging.
void PluggedUsbDevice::State::cancel(UMockdevIoctlClient* client, int status) {
  const auto concerns = [&](const UsbfsTransfer& t) { return client == nullptr || t.client == client; };
  for (auto& [endpoint, transfer] : performing) {
    if (transfer == nullptr || !concerns(*transfer)) continue;
    if (client != nullptr) transfer->client = nullptr;
    transfer->cancelled.request_stop();
  }
  for (auto& [endpoint, queue] : waiting) {
    std::deque<UsbfsTransferPtr> left;
    for (auto& transfer : queue) {
      if (!concerns(*transfer)) {
        left.push_back(std::move(transfer));
      } else if (client == nullptr) {
        transfer->status = status;
        done.push_back(std::move(transfer));
      }
    }
    queue = std::move(left);
  }
  if (client != nullptr) std::erase_if(done, [&](const auto& t) { return t->client == client; });
  changed.notify_all();
}

UMockdevIoctlBase* PluggedUsbDevice::State::handler(const std::shared_ptr<State>& state) {
  UMockdevIoctlBase* made = umockdev_ioctl_base_new();
  const auto connect = [&](const char* signal, GCallback callback) {
    const GClosureNotify forget = [](gpointer data, GClosure*) {
      const std::unique_ptr<std::shared_ptr<State>> ended(static_cast<std::shared_ptr<State>*>(data));
    };
    auto given = std::make_unique<std::shared_ptr<State>>(state);
    g_signal_connect_data(made, signal, callback, given.release(), forget, static_cast<GConnectFlags>(0));
  };
  connect("handle-ioctl", G_CALLBACK(&State::on_ioctl));
  connect("client-vanished", G_CALLBACK(&State::on_vanished));
  return made;
}

PluggedUsbDevice::PluggedUsbDevice(std::shared_ptr<MockSystem> system, std::shared_ptr<State> state)
    : system_(std::move(system)), state_(std::move(state)) {}

PluggedUsbDevice::~PluggedUsbDevice() {
  unplug();
  state_->end_workers();
}

Result<std::unique_ptr<PluggedUsbDevice>> PluggedUsbDevice::plug(std::shared_ptr<MockSystem> system,
                                                                 std::shared_ptr<UsbDevice> device) {
  if (device->descriptors().device.size() != 18) {
    return fail(ErrorCode::internal, "emulated USB device: the device descriptor is missing");
  }
  auto state = std::make_shared<State>();
  state->number = next_number++;
  const std::string sysfs = usbfs_description(device->descriptors(), state->number);
  state->device = std::move(device);
  const std::string node = usbfs_node(state->number);
  // Attached first, because a hot-plug listener opens the node as soon as it is announced.
  UMockdevIoctlBase* handler = State::handler(state);
  GError* error = nullptr;
  const bool attached = umockdev_testbed_attach_ioctl(system->testbed(), node.c_str(), handler, &error) != 0;
  g_object_unref(handler);  // owned by the emulated system from here on
  if (!attached) {
    const std::string message = error != nullptr ? error->message : "unknown error";
    g_clear_error(&error);
    return fail(ErrorCode::internal, "emulated USB device: " + message);
  }
  state->answers = std::jthread([raw = state.get()](const std::stop_token& stop) { raw->answer_reapers(stop); });
  TODBENCH_TRY_VOID(system->add(sysfs));
  return std::unique_ptr<PluggedUsbDevice>(new PluggedUsbDevice(std::move(system), std::move(state)));
}

std::string PluggedUsbDevice::node() const {
  return usbfs_node(state_->number);
}

void PluggedUsbDevice::unplug() {
  {
    const std::lock_guard lock(state_->mutex);
    if (state_->unplugged) return;
    state_->unplugged = true;
    state_->cancel(nullptr, -ESHUTDOWN);
    // Answers calls that wait without limit.
    for (auto& reaper : state_->reapers) {
      if (!reaper.patience_ends) reaper.patience_ends = Clock::now() + usbfs_reap_patience;
    }
  }
  state_->changed.notify_all();
  const std::string path = "/sys" + usbfs_sys_path(state_->number);
  system_->announce(path, "remove");
  system_->remove(path);
}

}  // namespace todbench
