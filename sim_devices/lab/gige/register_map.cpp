// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/gige/register_map.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include "acquisition/aravis/gev_registers.h"

namespace todbench {
namespace {

constexpr std::size_t memory_bytes = 0x10000;

/// Registers of the standard that a client may write.
constexpr std::array standard_writable{gev::heartbeat_timeout,  gev::control_privilege,   gev::stream_port,
                                       gev::stream_packet_size, gev::stream_packet_delay, gev::stream_destination};

bool is_standard(std::uint32_t address) {
  return address < gev::end_of_bootstrap || (address >= gev::stream_port && address < gev::end_of_stream_channel);
}

}  // namespace

RegisterMap::RegisterMap(CameraDescription description, std::string xml)
    : description_(std::move(description)), memory_(memory_bytes), xml_(std::move(xml)) {
  for (const auto address : standard_writable) rules_[address] = {};
  for (const auto& [category, features] : description_.categories) {
    for (const auto& f : features) {
      if (!owns_register(f)) continue;
      const auto end = f.address + register_bytes(f);
      assert(f.address % 4 == 0 && end <= memory_bytes);
      for (std::uint32_t word = f.address; word < end; word += 4) {
        rules_[word] = {f.access, f.locked_while_streaming};
      }
    }
  }
  // The description is read in whole words.
  xml_.resize((xml_.size() + 3) / 4 * 4, '\n');
  power_up();
}

void RegisterMap::power_up() {
  const std::lock_guard lock(mutex_);
  for (const auto& [address, bytes] : power_up_contents(description_)) {
    std::copy(bytes.begin(), bytes.end(), memory_.begin() + address);
  }
}

bool RegisterMap::exists(std::uint32_t address) const {
  const auto rule = rules_.find(address);
  if (rule != rules_.end()) return rule->second.access != FeatureAccess::write_only;
  return is_standard(address);
}

tl::expected<Bytes, GvcpStatus> RegisterMap::read(std::uint32_t address, std::size_t bytes) const {
  if (address % 4 != 0 || bytes % 4 != 0) return tl::unexpected(GvcpStatus::bad_alignment);
  if (address >= xml_address) {
    const std::size_t offset = address - xml_address;
    if (offset > xml_.size() || xml_.size() - offset < bytes) return tl::unexpected(GvcpStatus::invalid_address);
    const auto begin = xml_.begin() + static_cast<std::ptrdiff_t>(offset);
    return Bytes(begin, begin + static_cast<std::ptrdiff_t>(bytes));
  }
  if (bytes > memory_bytes || address > memory_bytes - bytes) return tl::unexpected(GvcpStatus::invalid_address);
  const std::lock_guard lock(mutex_);
  for (std::uint32_t word = address; word < address + bytes; word += 4) {
    if (!exists(word)) return tl::unexpected(GvcpStatus::invalid_address);
  }
  const auto begin = memory_.begin() + address;
  return Bytes(begin, begin + static_cast<std::ptrdiff_t>(bytes));
}

GvcpStatus RegisterMap::write(std::uint32_t address, std::uint32_t value) {
  if (address % 4 != 0) return GvcpStatus::bad_alignment;
  {
    const std::lock_guard lock(mutex_);
    const auto rule = rules_.find(address);
    if (rule == rules_.end()) return is_standard(address) ? GvcpStatus::write_protect : GvcpStatus::invalid_address;
    if (rule->second.access == FeatureAccess::read_only) return GvcpStatus::write_protect;
    if (locked_ && rule->second.locked_while_streaming) return GvcpStatus::busy;
  }
  set(address, value);
  return GvcpStatus::success;
}

void RegisterMap::lock_transport() {
  const std::lock_guard lock(mutex_);
  locked_ = true;
}

void RegisterMap::unlock_transport() {
  const std::lock_guard lock(mutex_);
  locked_ = false;
}

std::uint32_t RegisterMap::get(std::uint32_t address) const {
  const std::lock_guard lock(mutex_);
  return static_cast<std::uint32_t>(big_endian_at(memory_, address, 4));
}

void RegisterMap::set(std::uint32_t address, std::uint32_t value) {
  assert(address + 4 <= memory_bytes);
  Bytes word;
  append_big_endian(word, value, 4);
  const std::lock_guard lock(mutex_);
  std::copy(word.begin(), word.end(), memory_.begin() + address);
}

void RegisterMap::set_text(std::uint32_t address, std::string_view text, std::size_t bytes) {
  assert(address + bytes <= memory_bytes);
  const std::lock_guard lock(mutex_);
  const auto field = memory_.begin() + address;
  std::fill(field, field + static_cast<std::ptrdiff_t>(bytes), std::uint8_t{0});
  std::copy_n(text.begin(), std::min(text.size(), bytes - 1), field);
}

}  // namespace todbench
