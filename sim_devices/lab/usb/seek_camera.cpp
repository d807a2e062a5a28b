// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/usb/seek_camera.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>

namespace todbench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint16_t full_scale = 0x3FFF;
/// Level of a living pixel in the calibration frame.
constexpr std::uint16_t calibration_level = 0x2000;
/// Kind of a calibration frame that clients do not use.
constexpr std::uint16_t other_kind = 8;

void put16(UsbBytes& bytes, unsigned value) {
  bytes.push_back(static_cast<std::uint8_t>(value & 0xFFU));
  bytes.push_back(static_cast<std::uint8_t>(value >> 8U & 0xFFU));
}

UsbDescriptors descriptors_of(const SeekCameraConfig& config) {
  UsbDescriptors d;
  d.device = {18, 1, 0x00, 0x02, 0, 0, 0, 64};
  put16(d.device, seek_vendor_id);
  put16(d.device, geometry(config.model).product_id);
  put16(d.device, 0x0100);
  const std::uint8_t serial_index = config.serial.empty() ? 0 : 3;
  d.device.insert(d.device.end(), {1, 2, serial_index, 1});
  d.configuration = {9, 2, 0,    0, 1,    1,    0, 0x80, 250,  // configuration
                     9, 4, 0,    0, 2,    0xFF, 0, 0,    0,    // interface, vendor class
                     7, 5, 0x81, 2, 0x00, 0x02, 0,             // bulk in, 512 bytes
                     7, 5, 0x02, 2, 0x00, 0x02, 0};            // bulk out
  d.configuration[2] = static_cast<std::uint8_t>(d.configuration.size());
  d.strings = {"Seek Thermal", "PIR206 Thermal Camera"};
  if (!config.serial.empty()) d.strings.push_back(config.serial);
  d.speed = UsbSpeed::high;
  return d;
}

class Camera final : public SeekCamera {
 public:
  Camera(SeekCameraConfig config, Exposure exposure)
      : config_(std::move(config)), exposure_(std::move(exposure)), descriptors_(descriptors_of(config_)) {
    const cv::Size size = geometry(config_.model).picture.size();
    shutter_.create(size);
    // A pattern in which neighbouring pixels have different offsets.
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const int offset = config_.fixed_pattern_counts == 0 ? 0 : (31 * x + 17 * y) % config_.fixed_pattern_counts;
        shutter_(y, x) = static_cast<std::uint16_t>(seek_shutter_level + offset);
      }
    }
  }

  [[nodiscard]] const UsbDescriptors& descriptors() const override { return descriptors_; }
  [[nodiscard]] std::optional<UsbBytes> control(const UsbSetup& setup, std::span<const std::uint8_t> data) override;
  [[nodiscard]] bool bulk_out(std::uint8_t, std::span<const std::uint8_t>) override { return false; }
  [[nodiscard]] std::optional<UsbBytes> bulk_in(std::uint8_t endpoint, std::size_t length,
                                                std::stop_token stop) override;

  [[nodiscard]] std::uint64_t exposures() const override {
    const std::lock_guard lock(mutex_);
    return exposures_;
  }
  void lose_exposures(unsigned count) override {
    const std::lock_guard lock(mutex_);
    exposures_ += count;
  }
  void truncate_next_frame(std::size_t bytes) override {
    const std::lock_guard lock(mutex_);
    truncated_ = bytes;
  }

 private:
  [[nodiscard]] std::optional<UsbBytes> vendor_request(SeekRequest request, std::size_t length,
                                                       std::span<const std::uint8_t> data);
  [[nodiscard]] UsbBytes frame(std::uint16_t kind, std::uint64_t index, const cv::Mat1w& picture) const;
  [[nodiscard]] UsbBytes next_frame(std::unique_lock<std::mutex>& lock);

  const SeekCameraConfig config_;
  const Exposure exposure_;
  const UsbDescriptors descriptors_;
  cv::Mat1w shutter_;  ///< never written after construction

  mutable std::mutex mutex_;  ///< guards all members below
  std::condition_variable_any changed_;
  bool awake_ = false;
  bool asked_ = false;  ///< a frame was requested
  UsbBytes sending_;    ///< the requested frame
  std::size_t sent_ = 0;
  bool frame_begun_ = false;
  std::uint64_t since_start_ = 0;  ///< frames since initialisation
  std::uint64_t exposures_ = 0;
  std::optional<std::size_t> truncated_;
  Clock::time_point next_exposure_ = Clock::now();
};

std::optional<UsbBytes> Camera::control(const UsbSetup& setup, std::span<const std::uint8_t> data) {
  if ((setup.request_type & 0x7FU) != 0x41) return std::nullopt;  // vendor, interface
  const std::lock_guard lock(mutex_);
  return vendor_request(static_cast<SeekRequest>(setup.request), setup.length, data);
}

std::optional<UsbBytes> Camera::vendor_request(SeekRequest request, std::size_t length,
                                               std::span<const std::uint8_t> data) {
  switch (request) {
    case SeekRequest::target_platform:
      // A camera that was left streaming rejects this until it has been put to sleep.
      return awake_ ? std::nullopt : std::optional(UsbBytes());
    case SeekRequest::set_operation_mode:
      if (data.size() != 2) return std::nullopt;
      awake_ = data[0] == 1;
      asked_ = false;
      frame_begun_ = false;
      since_start_ = 0;
      return UsbBytes();
    case SeekRequest::get_operation_mode:
      return UsbBytes{static_cast<std::uint8_t>(awake_ ? 1 : 0), 0};
    case SeekRequest::read_chip_id:
      return UsbBytes{0x54, 0x42, 0x30, 0x30, 0x30, 0x31, 0, 1, 2, 3, 4, 5};
    case SeekRequest::get_firmware_info:
    case SeekRequest::get_factory_settings: {
      UsbBytes answer(std::min<std::size_t>(length, 64));
      for (std::size_t k = 0; k < answer.size(); ++k) answer[k] = static_cast<std::uint8_t>(k + 1);
      return answer;
    }
    case SeekRequest::start_image_transfer: {
      if (!awake_ || asked_ || data.size() != 4) return std::nullopt;
      if (seek_frame_request(config_.model).data != UsbBytes(data.begin(), data.end())) return std::nullopt;
      asked_ = true;
      frame_begun_ = false;
      changed_.notify_all();
      return UsbBytes();
    }
    case SeekRequest::set_image_processing_mode:
    case SeekRequest::set_firmware_info_features:
    case SeekRequest::set_factory_settings_features:
      return data.empty() ? std::nullopt : std::optional(UsbBytes());
    default:
      return std::nullopt;
  }
}

UsbBytes Camera::frame(std::uint16_t kind, std::uint64_t index, const cv::Mat1w& picture) const {
  const SeekGeometry& g = geometry(config_.model);
  std::vector<std::uint16_t> words(g.frame_words());
  for (int y = 0; y < g.picture.height; ++y) {
    const auto row = static_cast<std::size_t>((g.picture.y + y) * g.raw_width + g.picture.x);
    std::copy(picture[y], picture[y] + g.picture.width, words.begin() + static_cast<std::ptrdiff_t>(row));
  }
  for (const auto& p : config_.dead) {
    words[static_cast<std::size_t>((g.picture.y + p.y) * g.raw_width + g.picture.x + p.x)] = 0;
  }
  words[g.kind_word] = kind;
  words[g.counter_word] = static_cast<std::uint16_t>(config_.first_counter + index);
  words[g.temperature_word] = 0x1234;
  UsbBytes bytes;
  bytes.reserve(2 * words.size());
  for (const auto word : words) put16(bytes, word);
  return bytes;
}

/// Exposes without holding the lock.
UsbBytes Camera::next_frame(std::unique_lock<std::mutex>& lock) {
  const std::uint64_t index = exposures_++;
  const std::uint64_t k = since_start_++;
  const auto interval = static_cast<std::uint64_t>(config_.shutter_interval_frames);
  const bool closes = k == 2 || (interval > 0 && k > 2 && (k - 2) % (interval + 1) == 0);
  lock.unlock();
  UsbBytes bytes;
  const cv::Size size = shutter_.size();
  if (k == 0) {
    bytes = frame(static_cast<std::uint16_t>(SeekFrameKind::calibration), index, cv::Mat1w(size, calibration_level));
  } else if (k == 1) {
    bytes = frame(other_kind, index, cv::Mat1w(size, calibration_level));
  } else if (closes) {
    bytes = frame(static_cast<std::uint16_t>(SeekFrameKind::shutter), index, shutter_);
  } else {
    cv::Mat1w counts = exposure_(index);
    CV_Assert(counts.size() == size);
    cv::Mat1w sent(size);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const int offset = shutter_(y, x) - seek_shutter_level;
        sent(y, x) = static_cast<std::uint16_t>(std::min(counts(y, x), full_scale) + offset);
      }
    }
    bytes = frame(static_cast<std::uint16_t>(SeekFrameKind::image), index, sent);
  }
  lock.lock();
  return bytes;
}

std::optional<UsbBytes> Camera::bulk_in(std::uint8_t endpoint, std::size_t length, std::stop_token stop) {
  if (endpoint != seek_bulk_in_endpoint) return std::nullopt;
  std::unique_lock lock(mutex_);
  if (!changed_.wait(lock, stop, [this] { return asked_; })) return std::nullopt;
  if (!frame_begun_) {
    changed_.wait_until(lock, stop, next_exposure_, [] { return false; });
    if (stop.stop_requested() || !asked_) return std::nullopt;
    next_exposure_ =
        std::max(next_exposure_, Clock::now() - std::chrono::seconds(1)) +
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / config_.frame_rate_hz));
    sending_ = next_frame(lock);
    if (truncated_) sending_.resize(std::min(sending_.size(), *std::exchange(truncated_, std::nullopt)));
    sent_ = 0;
    frame_begun_ = true;
  }
  const std::size_t size = std::min(length, sending_.size() - sent_);
  UsbBytes bytes(sending_.begin() + static_cast<std::ptrdiff_t>(sent_),
                 sending_.begin() + static_cast<std::ptrdiff_t>(sent_ + size));
  sent_ += size;
  // A truncated frame ends with an empty packet.
  if (sent_ == sending_.size() && (size == 0 || sending_.size() == geometry(config_.model).frame_bytes())) {
    asked_ = false;
  }
  return bytes;
}

}  // namespace

Result<std::shared_ptr<SeekCamera>> SeekCamera::create(SeekCameraConfig config, Exposure exposure) {
  const auto bad = [](const std::string& what) {
    return fail(ErrorCode::invalid_input, "emulated Seek camera: " + what);
  };
  if (!(config.frame_rate_hz >= 0.1 && config.frame_rate_hz <= 1000))
    return bad("the frame rate must be 0.1 ... 1000 Hz");
  if (config.shutter_interval_frames < 0) return bad("the shutter interval must not be negative");
  if (config.fixed_pattern_counts < 0 || config.fixed_pattern_counts > 0x4000)
    return bad("the fixed pattern must be 0 ... 16384 counts");
  const cv::Rect inside({}, geometry(config.model).picture.size());
  for (const auto& p : config.dead) {
    if (!inside.contains(p)) return bad("a dead pixel is outside the picture");
  }
  if (!exposure) return bad("the exposure function is missing");
  return std::make_shared<Camera>(std::move(config), std::move(exposure));
}

}  // namespace todbench
