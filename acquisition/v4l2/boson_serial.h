// SPDX-License-Identifier: GPL-3.0-or-later
// Serial port of a FLIR Boson: gain mode and non-uniformity correction, which USB video does not offer. Framing and
// function codes as in FLIR's published software development kit (FSLP, FunctionCodes.h, EnumTypes.h).
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "acquisition/base/descriptor.h"
#include "acquisition/base/result.h"

namespace todbench {

/// Functions of the camera that the program uses.
enum class BosonFunction : std::uint32_t {
  run_correction = 0x00050007,
  set_correction_mode = 0x00050012,
  get_correction_mode = 0x00050013,
  set_gain_mode = 0x00050014,
  get_gain_mode = 0x00050015,
};

/// Answer of the camera to a request.
struct BosonReply {
  std::uint32_t sequence = 0, function = 0;
  std::uint32_t status = 0;  ///< 0: done
  std::string payload;
};

/// Returns the bytes of a request: start byte, channel 0, sequence, function, four bytes FF, payload, CRC, end byte.
/// The three bytes that the framing uses are escaped inside the request.
[[nodiscard]] std::string boson_request(std::uint32_t sequence, BosonFunction function, std::string_view payload = {});

/// Reads the bytes from a start byte to the next end byte, both included. Error: `invalid_input` (no complete frame, an
/// unknown escape, a wrong CRC, a wrong channel, too few bytes).
[[nodiscard]] Result<BosonReply> boson_reply(std::string_view frame);

/// Return the names of the modes that the features GainMode and FFCMode use; empty for an unknown number.
[[nodiscard]] std::string_view boson_gain_mode(std::uint32_t number);
[[nodiscard]] std::string_view boson_correction_mode(std::uint32_t number);

/// An open serial port. One thread at a time.
class BosonPort {
 public:
  /// Opens a port. Error: `io`.
  [[nodiscard]] static Result<BosonPort> open(const std::filesystem::path& node);

  /// Sends a request and waits for its answer. Errors: `timeout`, `io`, `invalid_input` (the camera refuses the
  /// request, or its answer is damaged).
  [[nodiscard]] Result<std::string> call(BosonFunction function, std::string_view payload = {},
                                         std::chrono::milliseconds patience = std::chrono::milliseconds(2000));
  /// Calls a function that reads a mode, and returns the mode. Errors as call().
  [[nodiscard]] Result<std::uint32_t> mode(BosonFunction function);
  [[nodiscard]] Result<void> set_mode(BosonFunction function, std::uint32_t number);

 private:
  explicit BosonPort(Descriptor port) : port_(std::move(port)) {}
  Descriptor port_;
  std::uint32_t sequence_ = 0;
};

/// Returns the node of the serial port that belongs to a USB device, by its folder in sysfs; empty if it has none.
[[nodiscard]] std::optional<std::filesystem::path> serial_port_of(const std::filesystem::path& usb_device);

}  // namespace todbench
