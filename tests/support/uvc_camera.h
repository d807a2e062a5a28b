// SPDX-License-Identifier: GPL-3.0-or-later
// A USB Video Class camera as a model: what a kernel's uvcvideo driver needs to see of a thermal camera. USB Video
// Class 1.0, uncompressed payload, bulk streaming.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>

#include "acquisition/base/result.h"
#include "sim_devices/lab/usb/usb_device.h"
#include "sim_devices/lab/video/video_frames.h"

namespace todbench {

/// Exposes while the host streams: the next exposure begins when the frame before has been fetched and its period is
/// over, so that a slow host slows the camera and loses nothing.
class UvcCamera final : public UsbDevice {
 public:
  /// Picture number `exposure_index`, counted from 0 over all streams, of the configured geometry.
  using Exposure = std::function<cv::Mat1w(std::uint64_t exposure_index)>;

  /// Errors: `invalid_input`: configuration; kinds other than y16, lepton and temperature_rows have no UVC format.
  [[nodiscard]] static Result<std::unique_ptr<UvcCamera>> create(VideoCameraConfig config, Exposure exposure);
  ~UvcCamera() override;

  [[nodiscard]] const UsbDescriptors& descriptors() const override;
  [[nodiscard]] std::optional<UsbBytes> control(const UsbSetup& setup, std::span<const std::uint8_t> data) override;
  [[nodiscard]] bool bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> data) override;
  [[nodiscard]] std::optional<UsbBytes> bulk_in(std::uint8_t endpoint, std::size_t length,
                                                std::stop_token stop) override;

  [[nodiscard]] std::uint64_t exposures() const;

 private:
  struct State;
  explicit UvcCamera(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace todbench
