#include "acquisition/aravis/aravis_backend.h"

#include <arpa/inet.h>

#include <cctype>

#include "acquisition/aravis/aravis_source.h"
#include "acquisition/aravis/description_url.h"
#include "acquisition/aravis/genicam_features.h"
#include "acquisition/aravis/glib_ptr.h"
#include "acquisition/aravis/gvcp_client.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;

/// GigE Vision bootstrap strings, the same that discovery reports: address and size in bytes.
struct BootstrapText {
  std::uint64_t address;
  std::uint32_t size;
};
constexpr BootstrapText bootstrap_vendor{0x0048, 32};
constexpr BootstrapText bootstrap_model{0x0068, 32};
constexpr BootstrapText bootstrap_version{0x0088, 32};
constexpr BootstrapText bootstrap_serial{0x00D8, 16};
constexpr std::uint32_t first_url = 0x0200, second_url = 0x0400;
constexpr std::uint16_t url_bytes = 512;

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

/// Asked before the camera is opened, because Aravis needs 5 s to notice.
bool controlled_by_another(const std::string& address) {
  if (!is_ipv4(address)) return false;
  const auto privilege = gvcp_read_register(address, gvcp_control_privilege_register, 500ms);
  return privilege && *privilege != 0;
}

/// Before the camera is opened, because opening believes what the camera states. A camera that cannot be asked is left
/// to the opening.
Result<void> check_description(const std::string& address) {
  if (!is_ipv4(address)) return {};
  for (const std::uint32_t where : {first_url, second_url}) {
    const auto url = gvcp_read_text(address, where, url_bytes, 500ms);
    if (!url || url->empty()) continue;
    if (auto valid = check_description_url(*url); !valid) return valid;
  }
  return {};
}

class AravisBackend : public CameraBackend {
 public:
  explicit AravisBackend(AravisOptions options) : options_(std::move(options)) {}

  [[nodiscard]] std::string scheme() const override {
    return options_.transport == AravisTransport::gige_vision ? "gige" : "u3v";
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
  [[nodiscard]] Result<std::string> aravis_name(const std::string& id);
  [[nodiscard]] SourceInfo identity(ArvDevice* device) const;

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
  camera.id = camera_id(scheme(), camera.vendor, camera.serial);
  return camera;
}

Result<std::vector<CameraEntry>> AravisBackend::list() {
  arv_interface_update_device_list(interface());
  std::vector<CameraEntry> cameras;
  const unsigned count = arv_interface_get_n_devices(interface());
  for (unsigned i = 0; i < count; ++i) cameras.push_back(entry(i));
  return cameras;
}

Result<std::string> AravisBackend::aravis_name(const std::string& id) {
  const std::string name = id.substr(scheme().size() + 1);
  if (options_.transport == AravisTransport::gige_vision && is_ipv4(name)) {
    const auto answer = gvcp_read_register(name, gvcp_version_register, 500ms);
    if (!answer) return fail(ErrorCode::not_found, answer.error().message);
    if (controlled_by_another(name)) return fail(ErrorCode::not_found, "busy: another program controls " + id);
    if (const auto valid = check_description(name); !valid) return tl::unexpected(valid.error());
    return name;
  }
  arv_interface_update_device_list(interface());
  std::string seen;
  const unsigned count = arv_interface_get_n_devices(interface());
  for (unsigned i = 0; i < count; ++i) {
    const std::string candidate = entry(i).id;
    if (candidate == id) {
      if (controlled_by_another(entry(i).address)) {
        return fail(ErrorCode::not_found, "busy: another program controls " + id);
      }
      if (const auto valid = check_description(entry(i).address); !valid) return tl::unexpected(valid.error());
      return text_or_empty(arv_interface_get_device_id(interface(), i));
    }
    seen += (seen.empty() ? "" : ", ") + candidate;
  }
  return fail(ErrorCode::not_found, "no such camera; seen: " + (seen.empty() ? "none" : seen));
}

SourceInfo AravisBackend::identity(ArvDevice* device) const {
  SourceInfo info;
  info.transport = transport_name();
  if (ARV_IS_GV_DEVICE(device)) {
    info.vendor = bootstrap_text(device, bootstrap_vendor);
    info.model = bootstrap_text(device, bootstrap_model);
    info.firmware = bootstrap_text(device, bootstrap_version);
    info.serial = bootstrap_text(device, bootstrap_serial);
  }
  info.vendor = first_of(info.vendor, first_feature(device, {"DeviceVendorName"}));
  info.model = first_of(info.model, first_feature(device, {"DeviceModelName"}));
  info.serial = first_of(info.serial, first_feature(device, {"DeviceSerialNumber", "CameraSN", "DeviceID"}));
  info.firmware = first_of(first_feature(device, {"DeviceFirmwareVersion"}),
                           first_of(info.firmware, first_feature(device, {"DeviceVersion"})));
  info.id = camera_id(scheme(), info.vendor, info.serial);
  return info;
}

Result<std::unique_ptr<FrameSource>> AravisBackend::open(const std::string& id) {
  if (!id.starts_with(scheme() + ":")) {
    return fail(ErrorCode::invalid_input, "'" + id + "' does not begin with " + scheme() + ":");
  }
  const auto name = aravis_name(id);
  if (!name) return tl::unexpected(name.error());
  GErrorSlot error;
  GObjectPtr<ArvDevice> device(arv_interface_open_device(interface(), name->c_str(), error.out()));
  if (!device) {
    return fail(ErrorCode::not_found, "opening " + *name + ": " + (error ? error.message() : "it has gone"));
  }
  if (ARV_IS_GV_DEVICE(device.get()) && arv_gv_device_is_controller(ARV_GV_DEVICE(device.get())) == 0) {
    return fail(ErrorCode::not_found, "busy: another program controls " + *name);
  }
  GObjectPtr<ArvCamera> camera(ARV_CAMERA(arv_camera_new_with_device(device.get(), error.out())));
  if (!camera) return fail(ErrorCode::not_found, "opening " + *name + ": " + error.message());
  SourceInfo info = identity(device.get());
  std::string address = address_of(device.get());
  auto source = AravisSource::create(std::move(camera), options_, std::move(info), std::move(address));
  if (!source) {
    // A camera that vanishes while it is being opened is not a camera lost in use.
    return fail("opening " + *name, with_code(ErrorCode::not_found, source.error()));
  }
  return source;
}

}  // namespace

std::string camera_id(std::string_view scheme, std::string_view vendor, std::string_view serial) {
  const auto sanitised = [](std::string_view text) {
    std::string clean(text);
    for (char& c : clean) {
      if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '.' && c != '_') c = '_';
    }
    return clean;
  };
  return std::string(scheme) + ":" + sanitised(vendor) + "-" + sanitised(serial);
}

std::unique_ptr<CameraBackend> aravis_backend(AravisOptions options) {
  return std::make_unique<AravisBackend>(std::move(options));
}

}  // namespace todbench
