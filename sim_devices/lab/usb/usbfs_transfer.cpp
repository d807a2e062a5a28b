// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/usb/usbfs_transfer.h"

#include <sys/ioctl.h>
#include <umockdev.h>
// after sys/ioctl.h
#include <linux/usbdevice_fs.h>

#include <cerrno>
#include <span>

namespace todbench {

UsbfsTransfer::~UsbfsTransfer() {
  if (buffer != nullptr) g_object_unref(buffer);
  if (urb != nullptr) g_object_unref(urb);
}

bool UsbfsTransfer::is_control() const {
  return type == USBDEVFS_URB_TYPE_CONTROL;
}

bool UsbfsTransfer::is_in() const {
  return is_control() ? !sent.empty() && (sent[0] & 0x80U) != 0 : (endpoint & 0x80U) != 0;
}

UsbSetup usb_setup_of(const UsbBytes& b) {
  const auto word = [&](std::size_t k) { return static_cast<std::uint16_t>(b[k] | b[k + 1] << 8U); };
  return {.request_type = b[0], .request = b[1], .value = word(2), .index = word(4), .length = word(6)};
}

UMockdevIoctlData* client_memory(UMockdevIoctlData* data, std::size_t offset, std::size_t size) {
  GError* error = nullptr;
  UMockdevIoctlData* found = umockdev_ioctl_data_resolve(data, offset, size, &error);
  if (error == nullptr) return found;
  g_clear_error(&error);
  if (found != nullptr) g_object_unref(found);
  return nullptr;
}

void exchange(UsbDevice& device, UsbfsTransfer& transfer) {
  if (transfer.is_control()) {
    const auto setup = usb_setup_of(transfer.sent);
    std::span<const std::uint8_t> data(transfer.sent);
    data = setup.device_to_host() ? std::span<const std::uint8_t>() : data.subspan(usb_setup_size);
    auto answer = usb_control(device, setup, data);
    transfer.status = answer ? 0 : -EPIPE;
    if (answer && setup.device_to_host()) transfer.received = std::move(*answer);
    transfer.actual = !answer ? 0 : setup.device_to_host() ? transfer.received.size() : data.size();
  } else if (transfer.is_in()) {
    const auto length = static_cast<std::size_t>(transfer.buffer_length);
    auto answer = device.bulk_in(transfer.endpoint, length, transfer.cancelled.get_token());
    if (answer && answer->size() > length) answer->resize(length);
    transfer.status = answer ? 0 : transfer.cancelled.stop_requested() ? -ENOENT : -EPIPE;
    if (answer) transfer.received = std::move(*answer);
    transfer.actual = transfer.received.size();
  } else {
    const bool accepted = device.bulk_out(transfer.endpoint, transfer.sent);
    transfer.status = accepted ? 0 : -EPIPE;
    transfer.actual = accepted ? transfer.sent.size() : 0;
  }
}

int hand_over(UMockdevIoctlClient* client, UsbfsTransfer& transfer) {
  UMockdevIoctlData* pointer = client_memory(umockdev_ioctl_client_get_arg(client), 0, sizeof(void*));
  if (pointer == nullptr) return EFAULT;
  if (transfer.buffer != nullptr && !transfer.received.empty()) {
    const std::size_t offset = transfer.is_control() ? usb_setup_size : 0;
    umockdev_ioctl_data_update(transfer.buffer, offset, transfer.received.data(),
                               static_cast<gint>(transfer.received.size()));
  }
  const auto put = [&](std::size_t offset, int value) {
    umockdev_ioctl_data_update(transfer.urb, offset, reinterpret_cast<guint8*>(&value), sizeof value);
  };
  put(offsetof(usbdevfs_urb, status), transfer.status);
  put(offsetof(usbdevfs_urb, actual_length), static_cast<int>(transfer.actual));
  umockdev_ioctl_data_set_ptr(pointer, 0, transfer.urb);
  g_object_unref(pointer);
  return 0;
}

}  // namespace todbench
