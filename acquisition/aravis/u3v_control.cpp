// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/aravis/u3v_control.h"

#include <libusb-1.0/libusb.h>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "acquisition/base/try.h"

namespace todbench {
namespace {

using Clock = std::chrono::steady_clock;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t message_magic = 0x43563355;
constexpr std::uint16_t wants_acknowledge = 0x4000, read_command = 0x0800, read_acknowledge = 0x0801,
                        pending_acknowledge = 0x0805;
constexpr std::size_t header_bytes = 12;
constexpr std::uint32_t most_block_bytes = 512;
constexpr unsigned transfer_ms = 500;
/// Limit of unrelated or pending acknowledges before a command fails.
constexpr int most_other_answers = 20;
/// Registers of the technology-agnostic bootstrap map and of the tables to which it points.
constexpr std::uint64_t manifest_register = 0x1D0, longest_acknowledge = 0x18;
constexpr std::uint64_t manifest_entry_bytes = 64;
/// Class of the interface for control messages.
constexpr std::uint8_t vision_class = 0xEF, vision_subclass = 0x05, control_protocol = 0x00;

struct UsbExit {
  void operator()(libusb_context* context) const { libusb_exit(context); }
};
struct UsbClose {
  void operator()(libusb_device_handle* handle) const { libusb_close(handle); }
};
using Handle = std::unique_ptr<libusb_device_handle, UsbClose>;

template <typename T>
void put(Bytes& out, T value) {
  for (std::size_t k = 0; k < sizeof value; ++k)
    out.push_back(static_cast<std::uint8_t>(std::uint64_t{value} >> (8 * k)));
}

std::uint64_t number(const std::uint8_t* bytes, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t k = count; k-- > 0;) value = value << 8 | bytes[k];
  return value;
}

std::string text_of(libusb_device_handle* handle, std::uint8_t index) {
  std::array<unsigned char, 256> text{};
  if (index == 0) return {};
  const int size = libusb_get_string_descriptor_ascii(handle, index, text.data(), static_cast<int>(text.size()) - 1);
  return size > 0 ? std::string(reinterpret_cast<const char*>(text.data())) : std::string();
}

/// The control interface and its endpoints.
struct ControlInterface {
  int number = -1;
  std::uint8_t in = 0, out = 0;
};

std::optional<ControlInterface> control_interface(libusb_device* device) {
  libusb_config_descriptor* raw = nullptr;
  if (libusb_get_config_descriptor(device, 0, &raw) != 0) return std::nullopt;
  const std::unique_ptr<libusb_config_descriptor, decltype(&libusb_free_config_descriptor)> config(
      raw, &libusb_free_config_descriptor);
  for (int i = 0; i < config->bNumInterfaces; ++i) {
    if (config->interface[i].num_altsetting < 1) continue;
    const auto& setting = config->interface[i].altsetting[0];
    if (setting.bInterfaceClass != vision_class || setting.bInterfaceSubClass != vision_subclass ||
        setting.bInterfaceProtocol != control_protocol) {
      continue;
    }
    ControlInterface found;
    found.number = setting.bInterfaceNumber;
    for (int e = 0; e < setting.bNumEndpoints; ++e) {
      const std::uint8_t address = setting.endpoint[e].bEndpointAddress;
      ((address & LIBUSB_ENDPOINT_IN) != 0 ? found.in : found.out) = address;
    }
    if (found.in != 0 && found.out != 0) return found;
  }
  return std::nullopt;
}

/// A claimed control interface.
class Channel {
 public:
  Channel(Handle handle, ControlInterface where) : handle_(std::move(handle)), where_(where) {}
  ~Channel() {
    if (handle_) libusb_release_interface(handle_.get(), where_.number);
  }
  Channel(Channel&&) = default;
  Channel& operator=(Channel&&) = delete;
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;

  [[nodiscard]] Result<Bytes> read(std::uint64_t address, std::uint16_t bytes);

 private:
  [[nodiscard]] std::optional<Bytes> receive();

  Handle handle_;
  ControlInterface where_;
  std::uint16_t id_ = 0;
};

std::optional<Bytes> Channel::receive() {
  Bytes answer(header_bytes + 1024);
  int got = 0;
  const int done =
      libusb_bulk_transfer(handle_.get(), where_.in, answer.data(), static_cast<int>(answer.size()), &got, transfer_ms);
  if (done != 0 || got < static_cast<int>(header_bytes)) return std::nullopt;
  answer.resize(static_cast<std::size_t>(got));
  return answer;
}

Result<Bytes> Channel::read(std::uint64_t address, std::uint16_t bytes) {
  const auto refused = [](const char* why) { return fail(ErrorCode::not_found, why); };
  Bytes command;
  put(command, message_magic);
  put(command, wants_acknowledge);
  put(command, read_command);
  put(command, std::uint16_t{12});
  put(command, ++id_);
  put(command, address);
  put(command, std::uint16_t{0});
  put(command, bytes);
  int sent = 0;
  if (libusb_bulk_transfer(handle_.get(), where_.out, command.data(), static_cast<int>(command.size()), &sent,
                           transfer_ms) != 0) {
    return refused("the camera does not accept commands");
  }
  for (int i = 0; i < most_other_answers; ++i) {
    const auto answer = receive();
    if (!answer) return refused("the camera does not answer");
    const std::uint8_t* head = answer->data();
    if (number(head, 4) != message_magic || number(head + 10, 2) != id_) continue;
    if (number(head + 6, 2) == pending_acknowledge) continue;
    if (number(head + 6, 2) != read_acknowledge || number(head + 4, 2) != 0)
      return refused("the camera rejects the read request");
    if (number(head + 8, 2) != bytes || answer->size() != header_bytes + bytes) {
      return refused("the camera answers with bytes other than those requested");
    }
    return Bytes(answer->begin() + header_bytes, answer->end());
  }
  return refused("the camera does not answer");
}

std::optional<Channel> open_channel(libusb_context* context, const UsbNames& names) {
  libusb_device** raw = nullptr;
  const auto count = libusb_get_device_list(context, &raw);
  if (count < 0) return std::nullopt;
  const std::unique_ptr<libusb_device*, void (*)(libusb_device**)> devices(
      raw, [](libusb_device** list) { libusb_free_device_list(list, 1); });
  for (ssize_t i = 0; i < count; ++i) {
    libusb_device_descriptor facts{};
    const auto where = control_interface(raw[i]);
    libusb_device_handle* opened = nullptr;
    if (!where || libusb_get_device_descriptor(raw[i], &facts) != 0 || libusb_open(raw[i], &opened) != 0) continue;
    Handle handle(opened);
    if (text_of(opened, facts.iManufacturer) != names.vendor || text_of(opened, facts.iProduct) != names.product ||
        text_of(opened, facts.iSerialNumber) != names.serial) {
      continue;
    }
    libusb_set_auto_detach_kernel_driver(opened, 1);
    if (libusb_claim_interface(opened, where->number) != 0) return std::nullopt;
    return Channel(std::move(handle), *where);
  }
  return std::nullopt;
}

struct ManifestEntry {
  std::uint64_t address = 0, bytes = 0;
  bool zipped = false;
  std::uint16_t block = 0;  ///< bytes of one read
};

Result<ManifestEntry> read_manifest(Channel& camera) {
  TODBENCH_TRY(const auto pointers, camera.read(manifest_register, 16));
  const std::uint64_t manifest = number(pointers.data(), 8);
  TODBENCH_TRY(const auto longest, camera.read(number(pointers.data() + 8, 8) + longest_acknowledge, 4));
  TODBENCH_TRY(const auto entry, camera.read(manifest + 8, manifest_entry_bytes));
  const auto acknowledge = number(longest.data(), 4);
  if (acknowledge < header_bytes + manifest_entry_bytes) {
    return fail(ErrorCode::not_found, "the camera states a maximum answer length of " + std::to_string(acknowledge) +
                                          " bytes, which is too short");
  }
  ManifestEntry found;
  found.address = number(entry.data() + 8, 8);
  found.bytes = number(entry.data() + 16, 8);
  // The client uses five bits for the kind of file.
  const auto kind = number(entry.data() + 4, 4) >> 10U & 0x1FU;
  if (kind > 1) return fail(ErrorCode::not_found, "the camera's description has an unknown file type");
  found.zipped = kind == 1;
  found.block = static_cast<std::uint16_t>(std::min<std::uint64_t>(acknowledge - header_bytes, most_block_bytes));
  return found;
}

Result<std::string> read_content(Channel& camera, const ManifestEntry& entry, const U3vReading& reading) {
  const auto deadline = Clock::now() + reading.patience;
  std::string content;
  while (content.size() < entry.bytes) {
    if (reading.stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
    if (Clock::now() >= deadline) {
      return fail(ErrorCode::not_found, "the camera sent only " + std::to_string(content.size()) + " of " +
                                            std::to_string(entry.bytes) + " bytes in " +
                                            std::to_string(reading.patience.count() / 1000) + " s");
    }
    const auto wanted = static_cast<std::uint16_t>(std::min<std::uint64_t>(entry.block, entry.bytes - content.size()));
    TODBENCH_TRY(const auto block, camera.read(entry.address + content.size(), wanted));
    content.append(block.begin(), block.end());
    if (reading.on_bytes) reading.on_bytes(content.size(), entry.bytes);
  }
  return content;
}

}  // namespace

Result<std::optional<U3vDescriptionContent>> u3v_read_description(const UsbNames& names, const U3vReading& reading) {
  libusb_context* raw = nullptr;
  if (libusb_init(&raw) != 0) return std::optional<U3vDescriptionContent>();
  const std::unique_ptr<libusb_context, UsbExit> context(raw);
  auto camera = open_channel(raw, names);
  if (!camera) return std::optional<U3vDescriptionContent>();
  TODBENCH_TRY(const auto entry, read_manifest(*camera));
  if (entry.bytes == 0 || entry.bytes > reading.most_bytes) {
    return fail(ErrorCode::not_found, "the camera states a description of " + std::to_string(entry.bytes) +
                                          " bytes, expected 1 ... " + std::to_string(reading.most_bytes));
  }
  TODBENCH_TRY(auto content, read_content(*camera, entry, reading));
  return U3vDescriptionContent{std::move(content), entry.zipped};
}

}  // namespace todbench
