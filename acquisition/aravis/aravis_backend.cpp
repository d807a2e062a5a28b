// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/aravis/aravis_backend.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "acquisition/aravis/aravis_source.h"
#include "acquisition/aravis/description_guard.h"
#include "acquisition/aravis/genicam_features.h"
#include "acquisition/aravis/gev_registers.h"
#include "acquisition/aravis/glib_ptr.h"
#include "acquisition/aravis/gvcp_client.h"
#include "acquisition/aravis/host_network.h"
#include "acquisition/aravis/u3v_registers.h"
#include "acquisition/base/try.h"
#include "acquisition/core/camera_id.h"
#include "acquisition/core/serial_number.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;

/// A bootstrap string of GigE Vision, as reported by discovery: address and size in bytes.
struct BootstrapText {
  std::uint64_t address;
  std::uint32_t size;
};
constexpr BootstrapText bootstrap_vendor{gev::vendor_name, 32};
constexpr BootstrapText bootstrap_model{gev::model_name, 32};
constexpr BootstrapText bootstrap_version{gev::device_version, 32};
constexpr BootstrapText bootstrap_serial{gev::serial_number, 16};

std::string bootstrap_text(ArvDevice* device, BootstrapText field) {
  std::string text(field.size, '\0');
  if (arv_device_read_memory(device, field.address, field.size, text.data(), nullptr) == 0) return {};
  text.resize(text.find('\0') == std::string::npos ? field.size : text.find('\0'));
  return text;
}

std::string first_feature(ArvDevice* device, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    auto value = get_feature(device, name);
    if (value && !value->empty()) return std::move(*value);
  }
  return {};
}

std::string first_of(std::string preferred, std::string fallback) {
  return preferred.empty() ? std::move(fallback) : std::move(preferred);
}

bool is_ipv4(const std::string& text) {
  in_addr address{};
  return inet_pton(AF_INET, text.c_str(), &address) == 1;
}

std::string address_of(ArvDevice* device) {
  if (!ARV_IS_GV_DEVICE(device)) return {};
  GSocketAddress* address = arv_gv_device_get_device_address(ARV_GV_DEVICE(device));
  if (address == nullptr || !G_IS_INET_SOCKET_ADDRESS(address)) return {};
  const GPtr<char> text(g_inet_address_to_string(g_inet_socket_address_get_address(G_INET_SOCKET_ADDRESS(address))));
  return text_or_empty(text.get());
}

/// Substitute for the serial number of a GigE camera that has none.
std::string mac_address(ArvDevice* device) {
  guint32 high = 0, low = 0;
  if (!ARV_IS_GV_DEVICE(device) || arv_device_read_register(device, gev::mac_high, &high, nullptr) == 0 ||
      arv_device_read_register(device, gev::mac_low, &low, nullptr) == 0 || (high == 0 && low == 0)) {
    return {};
  }
  return fmt::format("{:02x}:{:02x}:{:02x}:{:02x}:{:02x}:{:02x}", high >> 8U & 0xFFU, high & 0xFFU, low >> 24U,
                     low >> 16U & 0xFFU, low >> 8U & 0xFFU, low & 0xFFU);
}

/// Call it before opening the camera, because Aravis needs 5 s to notice.
bool controlled_by_another(const std::string& address) {
  if (!is_ipv4(address)) return false;
  const auto privilege = gvcp_read_register(address, gvcp_control_privilege_register, 500ms);
  return privilege && *privilege != 0;
}

class AravisBackend : public CameraBackend {
 public:
  explicit AravisBackend(AravisOptions options) : options_(std::move(options)) {}

  [[nodiscard]] std::string scheme() const override {
    return std::string(options_.transport == AravisTransport::gige_vision ? camera_scheme::gige : camera_scheme::u3v);
  }
  [[nodiscard]] Result<std::vector<CameraEntry>> list() override;
  [[nodiscard]] Result<std::unique_ptr<FrameSource>> open(const std::string& id) override;

 private:
  [[nodiscard]] ArvInterface* interface() const {
    return options_.transport == AravisTransport::gige_vision ? arv_gv_interface_get_instance()
                                                              : arv_uv_interface_get_instance();
  }
  [[nodiscard]] std::string transport_name() const {
    return options_.transport == AravisTransport::gige_vision ? "GigE Vision" : "USB3 Vision";
  }
  [[nodiscard]] CameraEntry entry(unsigned index) const;
  /// Indices of the cameras, each once. A camera with two network ports, or visible through two interfaces, has several
  /// entries. Entries with the same vendor, model and serial number are one unit; if the serial number is a
  /// placeholder, entries with the same hardware address. The first entry with an address in a network of this computer
  /// is kept.
  [[nodiscard]] std::vector<unsigned> units() const;
  /// A present camera by its names in Aravis.
  struct Found {
    std::string name, address;
    UsbNames usb{};  ///< of a USB camera
  };
  [[nodiscard]] Result<Found> find(const std::string& id, const std::string& name);
  /// Returns the device of a camera whose description is safe to evaluate.
  [[nodiscard]] Result<GObjectPtr<ArvDevice>> open_device(const Found& found);
  [[nodiscard]] SourceInfo identity(ArvDevice* device, const std::string& aravis_name) const;

  AravisOptions options_;
};

CameraEntry AravisBackend::entry(unsigned index) const {
  ArvInterface* cameras = interface();
  CameraEntry camera;
  camera.vendor = text_or_empty(arv_interface_get_device_vendor(cameras, index));
  camera.model = text_or_empty(arv_interface_get_device_model(cameras, index));
  camera.serial = first_of(text_or_empty(arv_interface_get_device_serial_nbr(cameras, index)),
                           text_or_empty(arv_interface_get_device_physical_id(cameras, index)));
  camera.address = text_or_empty(arv_interface_get_device_address(cameras, index));
  camera.transport = transport_name();
  camera.id = camera_id(scheme(), {camera.vendor, camera.serial});
  camera.note = placeholder_serial_warning(camera.serial);
  if (options_.transport == AravisTransport::gige_vision && camera.note.empty())
    camera.note = wrong_network(camera.address, host_addresses());
  return camera;
}

std::vector<unsigned> AravisBackend::units() const {
  std::vector<unsigned> found;
  const unsigned count = arv_interface_get_n_devices(interface());
  const auto hosts = host_addresses();
  for (unsigned i = 0; i < count; ++i) {
    const CameraEntry camera = entry(i);
    const auto same = [&](unsigned other) {
      const CameraEntry before = entry(other);
      if (before.id != camera.id || before.model != camera.model) return false;
      const std::string one = text_or_empty(arv_interface_get_device_physical_id(interface(), i)),
                        two = text_or_empty(arv_interface_get_device_physical_id(interface(), other));
      return !is_placeholder_serial(camera.serial) || (!one.empty() && one == two);
    };
    const auto twin = std::find_if(found.begin(), found.end(), same);
    if (twin == found.end()) {
      found.push_back(i);
    } else if (!wrong_network(entry(*twin).address, hosts).empty()) {
      *twin = i;
    }
  }
  return found;
}

Result<std::vector<CameraEntry>> AravisBackend::list() {
  arv_interface_update_device_list(interface());
  std::vector<CameraEntry> cameras;
  for (const unsigned i : units()) cameras.push_back(entry(i));
  return cameras;
}

Result<AravisBackend::Found> AravisBackend::find(const std::string& id, const std::string& name) {
  if (options_.transport == AravisTransport::gige_vision && is_ipv4(name)) {
    const auto answer = gvcp_read_register(name, gvcp_version_register, 500ms);
    if (!answer) {
      const std::string elsewhere = wrong_network(name, host_addresses());
      return fail(ErrorCode::not_found, answer.error().message + (elsewhere.empty() ? "" : ". " + elsewhere));
    }
    if (controlled_by_another(name)) return fail(ErrorCode::not_found, "busy: another program controls " + id);
    return Found{.name = name, .address = name};
  }
  arv_interface_update_device_list(interface());
  std::string seen;
  const std::vector<unsigned> cameras = units();
  const auto namesakes = std::count_if(cameras.begin(), cameras.end(), [&](unsigned i) { return entry(i).id == id; });
  if (namesakes > 1) {
    return fail(ErrorCode::not_found, std::to_string(namesakes) + " cameras have the id " + id +
                                          ". Open one of them by its address, or disconnect the others");
  }
  for (const unsigned i : cameras) {
    const std::string candidate = entry(i).id;
    if (candidate == id) {
      const std::string elsewhere = options_.transport == AravisTransport::gige_vision
                                        ? wrong_network(entry(i).address, host_addresses())
                                        : std::string();
      if (!elsewhere.empty()) return fail(ErrorCode::not_found, elsewhere);
      if (controlled_by_another(entry(i).address)) {
        return fail(ErrorCode::not_found, "busy: another program controls " + id);
      }
      return Found{text_or_empty(arv_interface_get_device_id(interface(), i)),
                   entry(i).address,
                   {.vendor = text_or_empty(arv_interface_get_device_vendor(interface(), i)),
                    .product = text_or_empty(arv_interface_get_device_model(interface(), i)),
                    .serial = text_or_empty(arv_interface_get_device_serial_nbr(interface(), i))}};
    }
    seen += (seen.empty() ? "" : ", ") + candidate;
  }
  return fail(ErrorCode::not_found, "no such camera; found: " + (seen.empty() ? "none" : seen));
}

/// Reads the identity from the bootstrap registers, otherwise from the description, otherwise from the discovery.
SourceInfo AravisBackend::identity(ArvDevice* device, const std::string& aravis_name) const {
  SourceInfo info;
  info.transport = transport_name();
  if (ARV_IS_GV_DEVICE(device)) {
    info.vendor = bootstrap_text(device, bootstrap_vendor);
    info.model = bootstrap_text(device, bootstrap_model);
    info.firmware = bootstrap_text(device, bootstrap_version);
    info.serial = bootstrap_text(device, bootstrap_serial);
  } else if (ARV_IS_UV_DEVICE(device)) {
    const U3vIdentity said = u3v_identity(device);
    info.vendor = said.vendor;
    info.model = said.model;
    info.firmware = said.version;
    info.serial = said.serial;
  }
  info.vendor = first_of(info.vendor, first_feature(device, {"DeviceVendorName"}));
  info.model = first_of(info.model, first_feature(device, {"DeviceModelName"}));
  info.serial = first_of(info.serial, first_feature(device, {"DeviceSerialNumber", "CameraSN", "DeviceID"}));
  info.firmware = first_of(first_feature(device, {"DeviceFirmwareVersion"}),
                           first_of(info.firmware, first_feature(device, {"DeviceVersion"})));
  const unsigned count = arv_interface_get_n_devices(interface());
  for (unsigned i = 0; i < count; ++i) {
    if (text_or_empty(arv_interface_get_device_id(interface(), i)) != aravis_name) continue;
    const CameraEntry found = entry(i);
    info.vendor = first_of(info.vendor, found.vendor);
    info.model = first_of(info.model, found.model);
    info.serial = first_of(info.serial, found.serial);
  }
  if (info.serial.empty()) info.serial = mac_address(device);
  info.id = camera_id(scheme(), {info.vendor, info.serial});
  if (auto warning = placeholder_serial_warning(info.serial); !warning.empty())
    info.warnings.push_back(std::move(warning));
  if (info.serial.empty()) {
    info.warnings.emplace_back(
        "The camera has no serial number. If the connection is lost, the program cannot identify the camera again.");
  }
  return info;
}

Result<GObjectPtr<ArvDevice>> AravisBackend::open_device(const Found& found) {
  const DescriptionReading reading{
      .patience = options_.description_patience, .stop = options_.stop, .on_progress = options_.on_progress};
  const bool on_usb = options_.transport == AravisTransport::usb3_vision;
  TODBENCH_TRY(auto description, on_usb                   ? read_safe_description(found.usb, reading)
                                 : is_ipv4(found.address) ? read_safe_description(found.address, reading)
                                                          : Result<std::optional<std::string>>(std::nullopt));
  GErrorSlot error;
  GObjectPtr<ArvDevice> device(arv_interface_open_device(interface(), found.name.c_str(), error.out()));
  if (!device) return fail(ErrorCode::not_found, error ? error.message() : "the camera is no longer connected");
  if (ARV_IS_GV_DEVICE(device.get()) && arv_gv_device_is_controller(ARV_GV_DEVICE(device.get())) == 0) {
    return fail(ErrorCode::not_found, "busy: another program controls it");
  }
  TODBENCH_TRY_VOID(guard_device(device.get(), description));
  return device;
}

Result<std::unique_ptr<FrameSource>> AravisBackend::open(const std::string& id) {
  const auto stated = camera_name(id, scheme());
  if (!stated) return fail(ErrorCode::invalid_input, "'" + id + "' does not begin with " + scheme() + ":");
  TODBENCH_TRY(const auto found, find(id, *stated));
  const std::string& name = found.name;
  auto opened = open_device(found);
  if (!opened) return fail("opening " + name, opened.error());
  GObjectPtr<ArvDevice> device = std::move(*opened);
  GErrorSlot error;
  GObjectPtr<ArvCamera> camera(ARV_CAMERA(arv_camera_new_with_device(device.get(), error.out())));
  if (!camera) return fail(ErrorCode::not_found, "opening " + name + ": " + error.message());
  SourceInfo info = identity(device.get(), name);
  std::string address = address_of(device.get());
  device.reset();
  auto source = AravisSource::create(std::move(camera), options_, std::move(info), std::move(address));
  if (!source) {
    // A camera that vanishes while it is being opened is not a camera lost in use.
    return fail("opening " + name, with_code(ErrorCode::not_found, source.error()));
  }
  return source;
}

}  // namespace

std::unique_ptr<CameraBackend> aravis_backend(AravisOptions options) {
  return std::make_unique<AravisBackend>(std::move(options));
}

}  // namespace todbench
