// SPDX-License-Identifier: GPL-3.0-or-later
// Calls of clients on the node of an emulated USB device: one function per ioctl.
#include <sys/ioctl.h>
#include <umockdev.h>
// after sys/ioctl.h
#include <linux/usbdevice_fs.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>

#include "sim_devices/lab/usb/usbfs_state.h"

namespace todbench {
namespace {

using Clock = std::chrono::steady_clock;

/// Limit for the untrusted length of a client's transfer. No camera needs more.
constexpr int longest_transfer = 64 << 20;
constexpr std::uint32_t capabilities =
    USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_NO_PACKET_SIZE_LIM | USBDEVFS_CAP_REAP_AFTER_DISCONNECT;

}  // namespace

int PluggedUsbDevice::State::submit(UMockdevIoctlClient* client) {
  auto transfer = std::make_unique<UsbfsTransfer>();
  transfer->client = client;
  transfer->urb = client_memory(umockdev_ioctl_client_get_arg(client), 0, sizeof(usbdevfs_urb));
  if (transfer->urb == nullptr) return EFAULT;
  usbdevfs_urb wanted;  // its flexible array of packets cannot be initialised
  std::memcpy(&wanted, transfer->urb->data, sizeof wanted);
  transfer->type = wanted.type;
  transfer->endpoint = wanted.endpoint;
  transfer->buffer_length = wanted.buffer_length;
  if (!transfer->is_control() && wanted.type != USBDEVFS_URB_TYPE_BULK) return EINVAL;
  if (wanted.buffer_length < 0 || wanted.buffer_length > longest_transfer) return EINVAL;
  if (wanted.buffer_length > 0) {
    transfer->buffer =
        client_memory(transfer->urb, offsetof(usbdevfs_urb, buffer), static_cast<std::size_t>(wanted.buffer_length));
    if (transfer->buffer == nullptr) return EFAULT;
  }
  if (transfer->is_control() || (wanted.endpoint & 0x80U) == 0) {
    const auto* bytes = transfer->buffer != nullptr ? transfer->buffer->data : nullptr;
    transfer->sent.assign(bytes, bytes + wanted.buffer_length);
  }
  if (transfer->is_control() && (transfer->sent.size() < usb_setup_size ||
                                 usb_setup_of(transfer->sent).length + usb_setup_size > transfer->sent.size())) {
    return EINVAL;
  }
  const std::uint8_t endpoint = transfer->is_control() ? 0 : wanted.endpoint;
  waiting[endpoint].push_back(std::move(transfer));
  if (!workers.contains(endpoint)) {
    workers[endpoint] = std::jthread([this, endpoint](const std::stop_token& stop) { perform(stop, endpoint); });
  }
  changed.notify_all();
  return 0;
}

int PluggedUsbDevice::State::discard(UMockdevIoctlClient* client) {
  gulong address = 0;
  std::memcpy(&address, umockdev_ioctl_client_get_arg(client)->data, sizeof address);
  const auto is_it = [&](const UsbfsTransfer& t) { return t.client == client && t.urb->client_addr == address; };
  for (auto& [endpoint, transfer] : performing) {
    if (transfer == nullptr || !is_it(*transfer)) continue;
    transfer->cancelled.request_stop();
    return 0;
  }
  for (auto& [endpoint, queue] : waiting) {
    const auto found = std::find_if(queue.begin(), queue.end(), [&](const auto& t) { return is_it(*t); });
    if (found == queue.end()) continue;
    (*found)->status = -ENOENT;
    done.push_back(std::move(*found));
    queue.erase(found);
    changed.notify_all();
    return 0;
  }
  return EINVAL;
}

std::pair<int, int> PluggedUsbDevice::State::transfer_now(UMockdevIoctlClient* client, unsigned long request) {
  // USBDEVFS_CONTROL and USBDEVFS_BULK block the caller. Only control transfers are served, because the device answers
  // them at once.
  if (request != USBDEVFS_CONTROL) return {-1, ENOTTY};
  UMockdevIoctlData* data = client_memory(umockdev_ioctl_client_get_arg(client), 0, sizeof(usbdevfs_ctrltransfer));
  if (data == nullptr) return {-1, EFAULT};
  usbdevfs_ctrltransfer wanted{};
  std::memcpy(&wanted, data->data, sizeof wanted);
  UMockdevIoctlData* buffer =
      wanted.wLength > 0 ? client_memory(data, offsetof(usbdevfs_ctrltransfer, data), wanted.wLength) : nullptr;
  const UsbSetup setup{wanted.bRequestType, wanted.bRequest, wanted.wValue, wanted.wIndex, wanted.wLength};
  std::span<const std::uint8_t> sent;
  if (buffer != nullptr && !setup.device_to_host()) sent = {buffer->data, wanted.wLength};
  auto answer = usb_control(*device, setup, sent);
  if (answer && buffer != nullptr && setup.device_to_host() && !answer->empty()) {
    umockdev_ioctl_data_update(buffer, 0, answer->data(), static_cast<gint>(answer->size()));
  }
  const int size = !answer ? -1 : setup.device_to_host() ? static_cast<int>(answer->size()) : int{wanted.wLength};
  if (buffer != nullptr) g_object_unref(buffer);
  g_object_unref(data);
  return {size, answer ? 0 : EPIPE};
}

int PluggedUsbDevice::State::claim(UMockdevIoctlClient* client, std::size_t size, unsigned long request) {
  UMockdevIoctlData* data = client_memory(umockdev_ioctl_client_get_arg(client), 0, size);
  if (data == nullptr) return EFAULT;
  unsigned interface = 0;  // first member of all structures that name an interface
  std::memcpy(&interface, data->data, sizeof interface);
  g_object_unref(data);
  const auto owner = claims.find(interface);
  if (request == USBDEVFS_RELEASEINTERFACE) {
    if (owner == claims.end() || owner->second != client) return EINVAL;
    claims.erase(owner);
    return 0;
  }
  if (owner != claims.end() && owner->second != client) return EBUSY;
  claims[interface] = client;
  return 0;
}

/// Result and errno of a call; empty if it is answered later.
std::optional<std::pair<int, int>> PluggedUsbDevice::State::serve(UMockdevIoctlClient* client) {
  const auto result = [](int error) { return std::pair(error != 0 ? -1 : 0, error); };
  const unsigned long request = umockdev_ioctl_client_get_request(client) & 0xFFFFFFFFU;
  if (request == USBDEVFS_REAPURB || request == USBDEVFS_REAPURBNDELAY) {
    // Transfers that ended before unplugging can still be reaped.
    const bool blocks = request == USBDEVFS_REAPURB && !unplugged;
    g_object_ref(client);  // the only reference until the call is answered
    reapers.push_back(
        {client, blocks ? std::nullopt : std::optional<Clock::time_point>(Clock::now() + usbfs_reap_patience)});
    changed.notify_all();
    return std::nullopt;
  }
  if (unplugged) return result(ENODEV);
  switch (request) {
    case USBDEVFS_SUBMITURB:
      return result(submit(client));
    case USBDEVFS_DISCARDURB:
      return result(discard(client));
    case USBDEVFS_CONTROL:
    case USBDEVFS_BULK:
      return transfer_now(client, request);
    case USBDEVFS_CLAIMINTERFACE:
    case USBDEVFS_RELEASEINTERFACE:
      return result(claim(client, sizeof(unsigned), request));
    case USBDEVFS_DISCONNECT_CLAIM:
      return result(claim(client, sizeof(usbdevfs_disconnect_claim), request));
    case USBDEVFS_GET_CAPABILITIES: {
      UMockdevIoctlData* data = client_memory(umockdev_ioctl_client_get_arg(client), 0, sizeof capabilities);
      if (data == nullptr) return result(EFAULT);
      std::uint32_t value = capabilities;
      umockdev_ioctl_data_update(data, 0, reinterpret_cast<guint8*>(&value), sizeof value);
      g_object_unref(data);
      return result(0);
    }
    case USBDEVFS_GETDRIVER:
      return result(ENODATA);
    case USBDEVFS_IOCTL:  // (dis)connects a driver: there is none
      return result(ENODATA);
    case USBDEVFS_GET_SPEED:
      return std::pair(static_cast<int>(device->descriptors().speed), 0);
    case USBDEVFS_CLEAR_HALT:
    case USBDEVFS_RESETEP:
    case USBDEVFS_RESET:
    case USBDEVFS_SETCONFIGURATION:
    case USBDEVFS_SETINTERFACE:
      return result(0);
    default:
      return result(ENOTTY);
  }
}

int PluggedUsbDevice::State::on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, void* data) {
  auto& state = *static_cast<std::shared_ptr<State>*>(data);
  const std::lock_guard lock(state->mutex);
  const auto answer = state->serve(client);
  if (answer) umockdev_ioctl_client_complete(client, answer->first, answer->second);
  return TRUE;
}

void PluggedUsbDevice::State::on_vanished(UMockdevIoctlBase*, UMockdevIoctlClient* client, void* data) {
  auto& state = *static_cast<std::shared_ptr<State>*>(data);
  const std::lock_guard lock(state->mutex);
  state->cancel(client, -ENOENT);
  state->reapers.remove_if([&](const Reaper& r) {
    if (r.client != client) return false;
    g_object_unref(client);
    return true;
  });
  std::erase_if(state->claims, [&](const auto& claim) { return claim.second == client; });
}

}  // namespace todbench
