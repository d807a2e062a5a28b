// SPDX-License-Identifier: GPL-3.0-or-later
// A USB device that misbehaves at one step of its conversation, and is itself otherwise.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "sim_devices/lab/usb/usb_device.h"

namespace todbench::testing_support {

/// What happens at the step, and at every one after it where it says so.
enum class Misbehaviour {
  stalls,        ///< the request is refused
  stalls_after,  ///< this one and all that follow
  short_answer,  ///< half of the bytes
  no_bytes,      ///< an answer without any
  drips_after,   ///< one byte at a time from here on
  is_silent,     ///< no answer at all, until the client gives up
  silent_after,  ///< the same for all that follow
  garbage,       ///< every byte of the answer is another one
};

/// Counts the transfers, from 0, and misbehaves at number `step`.
class HostileUsbDevice final : public UsbDevice {
 public:
  HostileUsbDevice(std::shared_ptr<UsbDevice> device, Misbehaviour misbehaviour, int step)
      : device_(std::move(device)), misbehaviour_(misbehaviour), step_(step) {}

  [[nodiscard]] const UsbDescriptors& descriptors() const override { return device_->descriptors(); }

  [[nodiscard]] std::optional<UsbBytes> control(const UsbSetup& setup, std::span<const std::uint8_t> data) override {
    // Standard requests are the carrier's; a device that refuses those is not seen at all.
    if ((setup.request_type & 0x60U) == 0) return device_->control(setup, data);
    const bool now = misbehaves();
    if (now && (stalls() || silent())) return std::nullopt;
    return bent(device_->control(setup, data), now);
  }

  [[nodiscard]] bool bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> data) override {
    const bool now = misbehaves();
    if (now && stalls()) return false;
    if (now && (silent() || misbehaviour_ == Misbehaviour::no_bytes)) return true;  // taken, and never answered
    return device_->bulk_out(endpoint, data);
  }

  [[nodiscard]] std::optional<UsbBytes> bulk_in(std::uint8_t endpoint, std::size_t length,
                                                std::stop_token stop) override {
    const bool now = misbehaves();
    if (now && stalls()) return std::nullopt;
    if (now && silent()) {
      std::mutex mutex;
      std::condition_variable_any never;
      std::unique_lock lock(mutex);
      never.wait(lock, stop, [] { return false; });
      return std::nullopt;
    }
    if (now && misbehaviour_ == Misbehaviour::drips_after) length = std::min<std::size_t>(length, 1);
    return bent(device_->bulk_in(endpoint, length, stop), now);
  }

  /// Transfers so far.
  [[nodiscard]] int steps() const {
    const std::lock_guard lock(mutex_);
    return steps_;
  }
  /// Waits until transfer `step` has begun; false when it was told to stop before.
  [[nodiscard]] bool wait_for(int step, const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    return stepped_.wait(lock, stop, [&] { return steps_ > step; });
  }

 private:
  [[nodiscard]] bool misbehaves() {
    int step = 0;
    {
      const std::lock_guard lock(mutex_);
      step = steps_++;
    }
    stepped_.notify_all();
    const bool stays = misbehaviour_ == Misbehaviour::stalls_after || misbehaviour_ == Misbehaviour::silent_after ||
                       misbehaviour_ == Misbehaviour::drips_after;
    return stays ? step >= step_ : step == step_;
  }
  [[nodiscard]] bool stalls() const {
    return misbehaviour_ == Misbehaviour::stalls || misbehaviour_ == Misbehaviour::stalls_after;
  }
  [[nodiscard]] bool silent() const {
    return misbehaviour_ == Misbehaviour::is_silent || misbehaviour_ == Misbehaviour::silent_after;
  }
  [[nodiscard]] std::optional<UsbBytes> bent(std::optional<UsbBytes> answer, bool now) const {
    if (!answer || !now) return answer;
    if (misbehaviour_ == Misbehaviour::short_answer) answer->resize(answer->size() / 2);
    if (misbehaviour_ == Misbehaviour::no_bytes) answer->clear();
    if (misbehaviour_ == Misbehaviour::garbage) {
      for (auto& byte : *answer) byte = static_cast<std::uint8_t>(byte ^ 0xA5U);
    }
    return answer;
  }

  const std::shared_ptr<UsbDevice> device_;
  const Misbehaviour misbehaviour_;
  const int step_;
  mutable std::mutex mutex_;
  std::condition_variable_any stepped_;
  int steps_ = 0;
};

}  // namespace todbench::testing_support
