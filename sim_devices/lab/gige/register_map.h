// The registers of an emulated GigE Vision camera: its memory, what may be written and when.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "sim_devices/lab/genicam/genicam_description.h"
#include "sim_devices/lab/gige/gvcp_message.h"

namespace todbench {

/// Memory with rules. The standard's own registers (0 ... 0xAFF and stream channel 0 at 0xD00 ... 0xD2F) can be read
/// everywhere and written where the standard lets a client write; the camera's registers as their table says; nothing
/// else exists. Thread-safe.
class RegisterMap {
 public:
  /// Registers of the features at their power-up values, and `xml` to be read from `xml_address` on.
  RegisterMap(CameraDescription description, std::string xml);

  /// Where the description lies.
  static constexpr std::uint32_t xml_address = 0x00100000;

  /// As a client reads: whole words. Errors: bad_alignment, invalid_address.
  [[nodiscard]] tl::expected<Bytes, GvcpStatus> read(std::uint32_t address, std::size_t bytes) const;
  /// As a client writes one word. Errors: bad_alignment, invalid_address, write_protect, busy (locked while streaming).
  [[nodiscard]] GvcpStatus write(std::uint32_t address, std::uint32_t value);
  /// From now on registers that are locked while streaming refuse a write, or take it again.
  void lock_transport();
  void unlock_transport();

  /// Puts the features' registers to their power-up values again.
  void power_up();

  /// As the camera itself reads and writes: no rules. Addresses below 64 KiB.
  [[nodiscard]] std::uint32_t get(std::uint32_t address) const;
  void set(std::uint32_t address, std::uint32_t value);
  void set_text(std::uint32_t address, std::string_view text, std::size_t bytes);

 private:
  struct Rule {
    FeatureAccess access = FeatureAccess::read_write;
    bool locked_while_streaming = false;
  };
  [[nodiscard]] bool exists(std::uint32_t address) const;

  CameraDescription description_;
  mutable std::mutex mutex_;
  Bytes memory_;
  std::string xml_;
  std::map<std::uint32_t, Rule> rules_;  ///< by address of a word
  bool locked_ = false;
};

}  // namespace todbench
