// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/aravis/description_guard.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "acquisition/aravis/gev_registers.h"
#include "acquisition/aravis/gvcp_client.h"
#include "acquisition/base/try.h"
#include "acquisition/description/description.h"
#include "acquisition/description/description_url.h"
#include "acquisition/description/description_zip.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;

constexpr std::uint16_t url_bytes = 512;
constexpr auto url_patience = 500ms;
constexpr auto progress_interval = 1s;
constexpr const char* guard_key = "todbench-description-guard";

/// Features that Aravis evaluates by itself while a camera is opened, set up and streams (arvcamera.c, arvgvdevice.c,
/// arvgvstream.c, arvuvstream.c of 0.8). Features that begin with Arv are Aravis's own unless the description defines
/// them.
constexpr std::array features_of_client{"DeviceVendorName",
                                        "DeviceModelName",
                                        "Width",
                                        "Height",
                                        "OffsetX",
                                        "OffsetY",
                                        "PixelFormat",
                                        "PayloadSize",
                                        "AcquisitionStart",
                                        "AcquisitionStop",
                                        "TLParamsLocked",
                                        "GevSCPD",
                                        "GevSCPSFireTestPacket",
                                        "GevSCPSPacketSize",
                                        "ArvGevNumberOfNetworkInterfaces",
                                        "ArvGevSCCFGMultipart",
                                        "ArvGevSCDA",
                                        "ArvGevSCPAddrCalc",
                                        "ArvGevSCPD",
                                        "ArvGevSCPHostPort",
                                        "ArvGevSCPSBigEndian",
                                        "ArvGevSCPSDoNotFragment",
                                        "ArvGevSCPSFireTestPacket",
                                        "ArvGevSCPSPacketSize",
                                        "ArvGevSCSP",
                                        "ArvGevStreamChannelCount",
                                        "ArvGevStreamChannelSelector",
                                        "ArvGevTimestampTickFrequency"};

/// Evaluated only while the camera is opened: their lengths are checked directly before.
constexpr std::array features_of_opening{"DeviceVendorName", "DeviceModelName"};

bool evaluated_once(std::string_view feature) {
  return std::find(features_of_opening.begin(), features_of_opening.end(), feature) != features_of_opening.end();
}

std::string about(const DescriptionFault& fault) {
  return fault.node.empty() ? fault.sentence : "node " + fault.node + ": " + fault.sentence;
}

/// State of the guard, kept with a device.
class Guard {
 public:
  explicit Guard(std::string_view xml) : description_(xml) {}

  [[nodiscard]] Result<void> check() const;
  [[nodiscard]] std::optional<std::string> fault_of(ArvDevice* device, const std::string& feature);

 private:
  struct Known {
    std::optional<std::string> fault;
    std::vector<std::string> lengths;
  };

  Description description_;
  std::map<std::string, Known> known_;  ///< by feature
};

Result<void> Guard::check() const {
  const auto refused = [](const std::string& why) {
    return fail(ErrorCode::not_found, "the camera's description is rejected: " + why);
  };
  if (!description_.faults().empty()) return refused(about(description_.faults().front()));
  for (const char* feature : features_of_client) {
    const auto faults = description_.faults_of(feature);
    if (!faults.empty()) return refused(about(faults.front()));
    const auto lengths = description_.lengths_of(feature);
    if (!lengths.empty() && !evaluated_once(feature)) {
      return refused("node " + std::string(feature) + ": only the camera knows its length, " +
                     printable_name(lengths.front()));
    }
  }
  return {};
}

std::optional<std::string> Guard::fault_of(ArvDevice* device, const std::string& feature) {
  auto [at, is_new] = known_.try_emplace(feature);
  Known& known = at->second;
  if (is_new) {
    const auto faults = description_.faults_of(feature);
    if (!faults.empty()) known.fault = about(faults.front());
    known.lengths = description_.lengths_of(feature);
  }
  if (known.fault) return known.fault;
  for (const auto& length : known.lengths) {
    GErrorSlot error;
    const auto bytes = arv_device_get_integer_feature_value(device, length.c_str(), error.out());
    if (error) return "its length cannot be read: " + error.message();
    if (bytes < 1 || bytes > longest_register_bytes) return "its length is " + std::to_string(bytes) + " bytes";
  }
  return std::nullopt;
}

/// Reports the kilobytes read of a description about once a second.
class Progress {
 public:
  explicit Progress(const DescriptionReading& reading) : reading_(reading) {}
  void operator()(std::uint64_t done, std::uint64_t bytes) {
    const auto now = std::chrono::steady_clock::now();
    if (!reading_.on_progress || now < next_) return;
    next_ = now + progress_interval;
    reading_.on_progress("reading the camera's description: " + std::to_string(done / 1000) + " of " +
                         std::to_string((bytes + 999) / 1000) + " kB");
  }

 private:
  const DescriptionReading& reading_;
  std::chrono::steady_clock::time_point next_ = std::chrono::steady_clock::now() + progress_interval;
};

tl::unexpected<Error> unreadable(const Error& why) {
  const auto code = why.code == ErrorCode::interrupted ? ErrorCode::interrupted : ErrorCode::not_found;
  return fail("reading the camera's description", with_code(code, why));
}

Result<std::string> unzipped(const std::string& archive) {
  return unzip_description({reinterpret_cast<const std::uint8_t*>(archive.data()), archive.size()},
                           most_description_bytes);
}

Result<std::string> read_from_camera(const std::string& ipv4, const DescriptionUrl& url,
                                     const DescriptionReading& reading) {
  Progress progress(reading);
  auto content =
      gvcp_read_memory(ipv4, url.address, url.bytes,
                       {.patience = reading.patience, .stop = reading.stop, .on_bytes = [&](std::uint64_t done) {
                          progress(done, url.bytes);
                        }});
  if (!content) return unreadable(content.error());
  return url.zipped ? unzipped(*content) : content;
}

}  // namespace

Result<std::optional<std::string>> read_safe_description(const std::string& ipv4, const DescriptionReading& reading) {
  for (const std::uint32_t where : {gev::first_url, gev::second_url}) {
    const auto text = gvcp_read_text(ipv4, where, url_bytes, url_patience);
    if (!text || text->empty()) continue;
    TODBENCH_TRY(const auto url, parse_description_url(*text));
    TODBENCH_TRY(auto xml, url.place == DescriptionUrl::Place::file ? read_description_file(url.path)
                                                                    : read_from_camera(ipv4, url, reading));
    TODBENCH_TRY_VOID(Guard(xml).check());
    return std::optional(std::move(xml));
  }
  return std::optional<std::string>();
}

Result<std::optional<std::string>> read_safe_description(const UsbNames& names, const DescriptionReading& reading) {
  Progress progress(reading);
  auto read = u3v_read_description(
      names, {.most_bytes = most_description_bytes,
              .patience = reading.patience,
              .stop = reading.stop,
              .on_bytes = [&](std::uint64_t done, std::uint64_t bytes) { progress(done, bytes); }});
  if (!read) return unreadable(read.error());
  if (!*read) return std::optional<std::string>();
  TODBENCH_TRY(auto xml, (*read)->zipped ? unzipped((*read)->content) : Result<std::string>((*read)->content));
  TODBENCH_TRY_VOID(Guard(xml).check());
  return std::optional(std::move(xml));
}

Result<void> guard_device(ArvDevice* device, const std::optional<std::string>& expected) {
  std::size_t bytes = 0;
  const char* xml = arv_device_get_genicam_xml(device, &bytes);
  if (xml == nullptr || bytes == 0) return fail(ErrorCode::not_found, "the camera has no description");
  const std::string_view text(xml, bytes);
  if (expected && text != *expected) {
    return fail(ErrorCode::not_found, "the camera sends a different description at each request");
  }
  auto guard = std::make_unique<Guard>(text);
  TODBENCH_TRY_VOID(guard->check());
  for (const char* feature : features_of_opening) {
    if (const auto fault = guard->fault_of(device, feature)) {
      return fail(ErrorCode::not_found,
                  "the camera's description is rejected: feature " + std::string(feature) + ": " + *fault);
    }
  }
  g_object_set_data_full(G_OBJECT(device), guard_key, guard.release(),
                         [](void* held) { const std::unique_ptr<Guard> gone(static_cast<Guard*>(held)); });
  return {};
}

std::optional<std::string> feature_fault(ArvDevice* device, const std::string& feature) {
  auto* guard = static_cast<Guard*>(g_object_get_data(G_OBJECT(device), guard_key));
  if (guard == nullptr) {
    if (const auto safe = guard_device(device, std::nullopt); !safe) return safe.error().message;
    guard = static_cast<Guard*>(g_object_get_data(G_OBJECT(device), guard_key));
  }
  return guard->fault_of(device, feature);
}

}  // namespace todbench
