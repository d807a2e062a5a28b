// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/usb/u3v_camera.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "sim_devices/lab/genicam/picture_encoder.h"
#include "sim_devices/lab/genicam/thermal_features.h"
#include "sim_devices/lab/usb/u3v_protocol.h"

namespace todbench {

namespace {

using namespace u3v;
using Clock = std::chrono::steady_clock;

/// Limit of unread answers, so that a client that does not read them cannot make the camera grow.
constexpr std::size_t most_answers = 8;
/// Value of padding and surplus bytes: as pixels they would be near full scale.
constexpr std::uint8_t surplus_byte = 0x3E;

constexpr std::uint32_t own(std::uint64_t offset) {
  return static_cast<std::uint32_t>(camera_registers + offset);
}

constexpr ThermalRegisters registers_of_this{.vendor = abrm_vendor,
                                             .model = abrm_model,
                                             .firmware = abrm_version,
                                             .serial = abrm_serial,
                                             .name_bytes = 64,
                                             .serial_bytes = 64,
                                             .width = own(reg_width),
                                             .height = own(reg_height),
                                             .offset_x = own(reg_offset_x),
                                             .offset_y = own(reg_offset_y),
                                             .pixel_format = own(reg_pixel_format),
                                             .largest_count = own(reg_largest_count),
                                             .payload_size = own(reg_payload_size),
                                             .acquisition_mode = own(reg_acquisition_mode),
                                             .acquisition = own(reg_acquisition),
                                             .period_us = own(reg_period_us),
                                             .ir_format = own(reg_ir_format),
                                             .linear_scale = own(reg_scale),
                                             .linear_offset = own(reg_offset),
                                             .nuc_mode = own(reg_nuc_mode),
                                             .nuc_action = own(reg_nuc)};

CameraDescription described(const U3vCameraConfig& c) {
  auto camera = thermal_camera(registers_of_this, options_of(c));
  camera.name_space = "U3V";
  camera.order = std::endian::little;
  feature_named(camera, "PayloadSize").initial += static_cast<std::uint32_t>(c.row_padding_bytes * c.height);
  if (c.identity_nodes == U3vIdentityNodes::absent) {
    for (const char* name : {"DeviceVendorName", "DeviceModelName", "DeviceFirmwareVersion", "DeviceSerialNumber"}) {
      auto& members = more_of(camera, "DeviceControl");
      std::erase_if(members, [name](const CameraFeature& f) { return f.name == name; });
    }
  }
  return camera;
}

class Camera final : public U3vCamera {
 public:
  Camera(U3vCameraConfig config, Exposure exposure);

  [[nodiscard]] const UsbDescriptors& descriptors() const override { return descriptors_; }
  /// A host clears halts of the stream endpoint after a stop; the rest of the frame is then dropped.
  [[nodiscard]] std::optional<UsbBytes> control(const UsbSetup&, std::span<const std::uint8_t>) override { return {}; }
  [[nodiscard]] bool bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> data) override;
  [[nodiscard]] std::optional<UsbBytes> bulk_in(std::uint8_t endpoint, std::size_t length,
                                                std::stop_token stop) override;

  [[nodiscard]] std::uint64_t exposures() const override {
    const std::lock_guard lock(mutex_);
    return exposures_;
  }
  [[nodiscard]] std::uint64_t nonuniformity_corrections() const override {
    const std::lock_guard lock(mutex_);
    return corrections_;
  }
  void lose_exposures(unsigned count) override {
    const std::lock_guard lock(mutex_);
    to_lose_ += count;
  }
  void truncate_next_frame(std::size_t bytes) override {
    const std::lock_guard lock(mutex_);
    truncated_ = bytes;
  }
  void lengthen_next_frame(std::size_t bytes) override {
    const std::lock_guard lock(mutex_);
    surplus_ = bytes;
  }
  void restart_numbers(std::uint64_t block_id) override {
    const std::lock_guard lock(mutex_);
    next_block_id_ = block_id;
  }

 private:
  enum class Phase { idle, leader, payload, trailer };

  void fill_bootstrap();
  [[nodiscard]] std::uint32_t register_of_this(std::uint64_t offset) { return camera_.u32(own(offset)); }
  [[nodiscard]] UsbBytes answer(std::span<const std::uint8_t> command);
  [[nodiscard]] std::uint16_t read(std::uint64_t address, std::size_t size, UsbBytes& into);
  [[nodiscard]] std::uint16_t write(std::uint64_t address, std::span<const std::uint8_t> data);
  [[nodiscard]] bool streaming() {
    return (bootstrap_.u32(sirm + si_control) & 1U) != 0 && register_of_this(reg_acquisition) != 0;
  }
  [[nodiscard]] std::chrono::microseconds period() {
    return std::chrono::microseconds(std::clamp(register_of_this(reg_period_us), 1000U, 10'000'000U));
  }
  [[nodiscard]] std::optional<UsbBytes> stream(std::unique_lock<std::mutex>& lock, std::size_t length,
                                               const std::stop_token& stop);
  [[nodiscard]] bool begin_frame(std::unique_lock<std::mutex>& lock, const std::stop_token& stop);
  [[nodiscard]] UsbBytes next_picture(std::unique_lock<std::mutex>& lock, std::uint64_t index);
  [[nodiscard]] UsbBytes padded(UsbBytes picture) const;
  [[nodiscard]] UsbBytes leader();
  [[nodiscard]] UsbBytes trailer() const;

  const U3vCameraConfig config_;
  const Exposure exposure_;
  const UsbDescriptors descriptors_;
  UsbBytes description_;

  mutable std::mutex mutex_;  ///< guards all members below
  std::condition_variable_any changed_;
  Registers bootstrap_{0, bootstrap_size};
  Registers camera_{camera_registers, camera_size};
  std::deque<UsbBytes> answers_;
  Phase phase_ = Phase::idle;
  std::uint64_t stream_number_ = 0;  ///< counts stops, so that a frame of an ended stream is dropped
  std::uint64_t exposures_ = 0, corrections_ = 0, clock_ns_ = 0, block_id_ = 0;
  unsigned to_lose_ = 0;
  int frozen_frames_ = 0;
  std::optional<std::size_t> truncated_;
  std::size_t surplus_ = 0;                     ///< of the next frame
  std::optional<std::uint64_t> next_block_id_;  ///< restarts the numbers
  PictureEncoder encoder_;                      ///< used by the thread of the stream endpoint
  UsbBytes picture_;                            ///< the last one, without padding
  UsbBytes payload_;                            ///< as sent last
  std::size_t sent_ = 0;
  Clock::time_point next_exposure_ = Clock::now();
};

Camera::Camera(U3vCameraConfig config, Exposure exposure)
    : config_(std::move(config)),
      exposure_(std::move(exposure)),
      descriptors_(descriptors_of(config_)),
      encoder_(config_.kelvin_per_count, config_.offset_k, {}) {
  const CameraDescription description = described(config_);
  const std::string xml = config_.description_text.empty() ? genicam_xml(description) : config_.description_text;
  description_ =
      config_.description == U3vDescription::zipped ? zipped("camera.xml", xml) : UsbBytes(xml.begin(), xml.end());
  fill_bootstrap();
  for (const auto& [address, bytes] : power_up_contents(description)) {
    auto& registers = address < camera_registers ? bootstrap_ : camera_;
    std::copy(bytes.begin(), bytes.end(), registers.at(address, bytes.size()).begin());
  }
}

void Camera::fill_bootstrap() {
  bootstrap_.set(0, std::uint32_t{0x00010000});
  bootstrap_.set(abrm_vendor, config_.vendor);
  bootstrap_.set(abrm_model, config_.model);
  bootstrap_.set(abrm_version, config_.firmware);
  bootstrap_.set(abrm_serial, config_.serial);
  bootstrap_.set(abrm_family, std::string("thermal"));
  bootstrap_.set(abrm_capability, std::uint64_t{0});
  bootstrap_.set(abrm_response_time, std::uint32_t{500});
  bootstrap_.set(abrm_manifest, manifest);
  bootstrap_.set(abrm_sbrm, sbrm);
  bootstrap_.set(abrm_tick, std::uint32_t{1});
  bootstrap_.set(sbrm, std::uint32_t{0x00010000});
  bootstrap_.set(sbrm + 0x14, static_cast<std::uint32_t>(longest_transfer));
  bootstrap_.set(sbrm + 0x18, static_cast<std::uint32_t>(longest_transfer));
  bootstrap_.set(sbrm + 0x1C, std::uint32_t{1});
  bootstrap_.set(sbrm + 0x20, sirm);
  bootstrap_.set(sbrm + 0x28, std::uint32_t{0x30});
  bootstrap_.set(sbrm + 0x2C, eirm);
  bootstrap_.set(sbrm + 0x34, std::uint32_t{0x0C});
  bootstrap_.set(sbrm + 0x40, std::uint32_t{0x04});  // high speed
  bootstrap_.set(sirm + si_info, std::uint32_t{0});  // payload transfers of any length
  const int row_bytes = 2 * config_.width + config_.row_padding_bytes;
  bootstrap_.set(sirm + si_payload, static_cast<std::uint64_t>(row_bytes * config_.height));
  bootstrap_.set(sirm + si_leader, static_cast<std::uint32_t>(leader_size));
  bootstrap_.set(sirm + si_trailer, static_cast<std::uint32_t>(trailer_size));
  for (const auto& [address, value] : config_.false_registers) bootstrap_.set(address, value);
  bootstrap_.set(manifest, std::uint64_t{1});
  bootstrap_.set(manifest + 8, std::uint32_t{0x01000000});  // version of the file
  // Schema 1.1; bit 10: zipped.
  const bool zip = config_.description == U3vDescription::zipped;
  bootstrap_.set(manifest + 12, std::uint32_t{0x01010000} | (zip ? std::uint32_t{1} << 10U : 0U));
  bootstrap_.set(manifest + 16, description_address);
  bootstrap_.set(manifest + 24, config_.stated_description_bytes != 0 ? config_.stated_description_bytes
                                                                      : std::uint64_t{description_.size()});
}

// --- control ----------------------------------------------------------------------------------------------------

bool Camera::bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> data) {
  if (endpoint != control_out) return false;
  const std::lock_guard lock(mutex_);
  if (answers_.size() >= most_answers) answers_.pop_front();
  if (auto reply = answer(data); !reply.empty()) answers_.push_back(std::move(reply));
  changed_.notify_all();
  return true;
}

/// Returns empty bytes for data that are not a command.
UsbBytes Camera::answer(std::span<const std::uint8_t> command) {
  if (command.size() < header_size || get<std::uint32_t>(command, 0) != command_magic) return {};
  const auto code = get<std::uint16_t>(command, 6);
  const std::size_t length = get<std::uint16_t>(command, 8);
  const auto content = command.subspan(header_size);
  UsbBytes data;
  std::uint16_t status = status_not_implemented;
  if (length != content.size()) {
    status = status_invalid_parameter;
  } else if (code == read_memory) {
    status = length == 12 ? read(get<std::uint64_t>(content, 0), get<std::uint16_t>(content, 10), data)
                          : status_invalid_parameter;
  } else if (code == write_memory) {
    status = length > 8 ? write(get<std::uint64_t>(content, 0), content.subspan(8)) : status_invalid_parameter;
    put(data, std::uint16_t{0});
    put(data, static_cast<std::uint16_t>(status == status_ok ? length - 8 : 0));
  }
  UsbBytes reply;
  put(reply, command_magic);
  put(reply, status);
  put(reply, static_cast<std::uint16_t>(code + 1));
  put(reply, static_cast<std::uint16_t>(data.size()));
  put(reply, get<std::uint16_t>(command, 10));
  reply.insert(reply.end(), data.begin(), data.end());
  return reply;
}

std::uint16_t Camera::read(std::uint64_t address, std::size_t size, UsbBytes& into) {
  if (size > longest_transfer - header_size) return status_invalid_parameter;
  if (bootstrap_.contains(address, size)) {
    const auto found = bootstrap_.at(address, size);
    into.assign(found.begin(), found.end());
  } else if (camera_.contains(address, size)) {
    const auto found = camera_.at(address, size);
    into.assign(found.begin(), found.end());
  } else if (address >= description_address && address - description_address < description_.size()) {
    // A client may round the length up.
    const auto from = description_.begin() + static_cast<std::ptrdiff_t>(address - description_address);
    into.assign(from, from + std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(size), description_.end() - from));
    into.resize(size);
  } else {
    return status_invalid_address;
  }
  return status_ok;
}

std::uint16_t Camera::write(std::uint64_t address, std::span<const std::uint8_t> data) {
  const bool stream_register = address >= sirm && address + data.size() <= sirm + 0x30;
  const bool camera_register = camera_.contains(address, data.size()) && address >= own(reg_pixel_format) &&
                               address + data.size() <= own(reg_scale);
  if (!stream_register && !camera_register) {
    return bootstrap_.contains(address, data.size()) || camera_.contains(address, data.size()) ? status_write_protected
                                                                                               : status_invalid_address;
  }
  const bool was_streaming = streaming();
  auto registers = stream_register ? bootstrap_.at(address, data.size()) : camera_.at(address, data.size());
  std::copy(data.begin(), data.end(), registers.begin());
  if (register_of_this(reg_nuc) != 0) {
    camera_.set(own(reg_nuc), std::uint32_t{0});
    ++corrections_;
    frozen_frames_ = config_.nuc_freeze_frames;
  }
  if (was_streaming != streaming()) {
    // A frame in transmission is completed, unless the stream itself was switched off.
    ++stream_number_;
    if (stream_register) phase_ = Phase::idle;
    if (streaming()) block_id_ = 0;
    changed_.notify_all();
  }
  return status_ok;
}

// --- stream -----------------------------------------------------------------------------------------------------

UsbBytes Camera::next_picture(std::unique_lock<std::mutex>& lock, std::uint64_t index) {
  if (frozen_frames_ > 0 && !picture_.empty()) {
    --frozen_frames_;
    return picture_;
  }
  EncoderSettings settings;
  if (register_of_this(reg_ir_format) == ir_format_100mk) settings.signal = SignalKind::tenths;
  settings.significant_bits = static_cast<unsigned>(config_.significant_bits);
  lock.unlock();
  const cv::Mat1w counts = exposure_(index);
  CV_Assert(counts.rows == config_.height && counts.cols == config_.width);
  auto bytes = encoder_.encode(counts, settings);
  lock.lock();
  picture_ = bytes;
  return bytes;
}

/// Waits for the time of the next exposure and exposes. Returns false if stopped.
bool Camera::begin_frame(std::unique_lock<std::mutex>& lock, const std::stop_token& stop) {
  for (;;) {
    if (!changed_.wait(lock, stop, [this] { return streaming(); })) return false;
    const auto number = stream_number_;
    changed_.wait_until(lock, stop, next_exposure_, [&] { return stream_number_ != number; });
    if (stop.stop_requested()) return false;
    if (stream_number_ != number) continue;
    next_exposure_ = std::max(next_exposure_, Clock::now() - std::chrono::seconds(1)) + period();
    for (; to_lose_ > 0; --to_lose_) {
      ++exposures_;
      ++block_id_;
      clock_ns_ += static_cast<std::uint64_t>(std::chrono::nanoseconds(period()).count());
    }
    const std::uint64_t index = exposures_++;
    clock_ns_ += static_cast<std::uint64_t>(std::chrono::nanoseconds(period()).count());
    auto picture = next_picture(lock, index);
    if (stream_number_ != number) continue;  // stopped during the exposure, which is lost
    payload_ = padded(std::move(picture));
    payload_.resize(payload_.size() + std::exchange(surplus_, 0), surplus_byte);
    if (next_block_id_) block_id_ = *std::exchange(next_block_id_, std::nullopt);
    sent_ = 0;
    phase_ = Phase::leader;
    return true;
  }
}

UsbBytes Camera::padded(UsbBytes picture) const {
  if (config_.row_padding_bytes == 0) return picture;
  const auto row_bytes = static_cast<std::ptrdiff_t>(picture.size()) / config_.height;
  UsbBytes out;
  for (auto row = picture.begin(); row != picture.end(); row += row_bytes) {
    out.insert(out.end(), row, row + row_bytes);
    out.insert(out.end(), static_cast<std::size_t>(config_.row_padding_bytes), surplus_byte);
  }
  return out;
}

UsbBytes Camera::leader() {
  UsbBytes bytes;
  put(bytes, leader_magic);
  put(bytes, std::uint16_t{0});
  put(bytes, static_cast<std::uint16_t>(leader_size));
  put(bytes, block_id_);
  put(bytes, std::uint16_t{0});
  put(bytes, std::uint16_t{1});  // image
  put(bytes, clock_ns_);
  put(bytes, register_of_this(reg_pixel_format));
  put(bytes, static_cast<std::uint32_t>(config_.width));
  put(bytes, static_cast<std::uint32_t>(config_.height));
  put(bytes, std::uint32_t{0});
  put(bytes, std::uint32_t{0});
  put(bytes, static_cast<std::uint16_t>(config_.states_padding ? config_.row_padding_bytes : 0));
  put(bytes, std::uint16_t{0});
  return bytes;
}

UsbBytes Camera::trailer() const {
  UsbBytes bytes;
  put(bytes, trailer_magic);
  put(bytes, std::uint16_t{0});
  put(bytes, static_cast<std::uint16_t>(trailer_size));
  put(bytes, block_id_);
  put(bytes, std::uint32_t{0});  // status: success
  put(bytes, static_cast<std::uint64_t>(payload_.size()));
  put(bytes, static_cast<std::uint32_t>(config_.height));
  return bytes;
}

std::optional<UsbBytes> Camera::stream(std::unique_lock<std::mutex>& lock, std::size_t length,
                                       const std::stop_token& stop) {
  if (phase_ == Phase::idle && !begin_frame(lock, stop)) return std::nullopt;
  UsbBytes bytes;
  switch (phase_) {
    case Phase::leader:
      bytes = leader();
      phase_ = Phase::payload;
      break;
    case Phase::payload: {
      const std::size_t wanted = std::min(length, payload_.size() - sent_);
      std::size_t size = wanted;
      // A truncated frame: transfers are short, down to zero bytes.
      if (truncated_) size = std::min(size, *truncated_ - std::min(*truncated_, sent_));
      const auto from = payload_.begin() + static_cast<std::ptrdiff_t>(sent_);
      bytes.assign(from, from + static_cast<std::ptrdiff_t>(size));
      sent_ += wanted;
      if (sent_ == payload_.size()) phase_ = Phase::trailer;
      break;
    }
    default:
      bytes = trailer();
      truncated_.reset();
      ++block_id_;
      phase_ = Phase::idle;
  }
  return bytes;
}

std::optional<UsbBytes> Camera::bulk_in(std::uint8_t endpoint, std::size_t length, std::stop_token stop) {
  std::unique_lock lock(mutex_);
  if (endpoint == stream_in) return stream(lock, length, stop);
  if (endpoint != control_in) return std::nullopt;
  if (!changed_.wait(lock, stop, [this] { return !answers_.empty(); })) return std::nullopt;
  UsbBytes reply = std::move(answers_.front());
  answers_.pop_front();
  if (reply.size() > length) reply.resize(length);
  return reply;
}

}  // namespace

Result<std::shared_ptr<U3vCamera>> U3vCamera::create(U3vCameraConfig config, Exposure exposure) {
  const auto bad = [](const std::string& what) {
    return fail(ErrorCode::invalid_input, "emulated USB3 Vision camera: " + what);
  };
  if (auto valid = validate_emulation("emulated USB3 Vision camera", config); !valid) {
    return tl::unexpected(valid.error());
  }
  if (config.vendor.empty()) return bad("a vendor is needed");
  if (!exposure) return bad("the exposure function is missing");
  return std::make_shared<Camera>(std::move(config), std::move(exposure));
}

}  // namespace todbench
