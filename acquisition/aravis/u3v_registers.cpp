// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/aravis/u3v_registers.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>

namespace todbench {
namespace {

static_assert(std::endian::native == std::endian::little, "registers are read without swapping bytes");

constexpr std::uint64_t abrm_vendor = 0x004, abrm_model = 0x044, abrm_version = 0x0C4, abrm_serial = 0x144;
constexpr std::size_t abrm_text_bytes = 64;
constexpr std::uint64_t abrm_sbrm = 0x1D8, sbrm_sirm = 0x20;
constexpr std::uint64_t sirm_info = 0x00, sirm_payload = 0x08, sirm_leader = 0x10, sirm_trailer = 0x14;

/// Leaders and trailers have tens of bytes.
constexpr std::uint32_t most_leader_bytes = 64U << 10U;
/// Payloads are aligned to USB transfers of at most 1 KiB; Aravis sends no transfer above 1 MiB.
constexpr std::uint32_t most_alignment_exponent = 16;

std::string text_at(ArvDevice* device, std::uint64_t address) {
  std::string text(abrm_text_bytes, '\0');
  if (arv_device_read_memory(device, address, abrm_text_bytes, text.data(), nullptr) == 0) return {};
  text.resize(std::min(text.find('\0'), text.size()));
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

template <typename Number>
std::optional<Number> number_at(ArvDevice* device, std::uint64_t address) {
  Number value{};
  if (arv_device_read_memory(device, address, sizeof value, &value, nullptr) == 0) return std::nullopt;
  return value;
}

}  // namespace

U3vIdentity u3v_identity(ArvDevice* device) {
  return {.vendor = text_at(device, abrm_vendor),
          .model = text_at(device, abrm_model),
          .version = text_at(device, abrm_version),
          .serial = text_at(device, abrm_serial)};
}

Result<void> check_stream_registers(ArvDevice* device) {
  if (!ARV_IS_UV_DEVICE(device)) return {};
  const auto refused = [](const std::string& what) {
    return fail(ErrorCode::not_found, "the stream registers of the camera are invalid: " + what);
  };
  const auto sbrm = number_at<std::uint64_t>(device, abrm_sbrm);
  const auto sirm = sbrm ? number_at<std::uint64_t>(device, *sbrm + sbrm_sirm) : std::nullopt;
  if (!sirm) return refused("they cannot be found");
  const auto info = number_at<std::uint32_t>(device, *sirm + sirm_info);
  const auto payload = number_at<std::uint64_t>(device, *sirm + sirm_payload);
  const auto leader = number_at<std::uint32_t>(device, *sirm + sirm_leader);
  const auto trailer = number_at<std::uint32_t>(device, *sirm + sirm_trailer);
  if (!info || !payload || !leader || !trailer) return refused("they cannot be read");
  if (*info >> 24U > most_alignment_exponent) return refused("an alignment of 2^" + std::to_string(*info >> 24U));
  if (*payload == 0 || *payload > most_payload_bytes) {
    return refused("a payload of " + std::to_string(*payload) + " bytes");
  }
  if (*leader > most_leader_bytes || *trailer > most_leader_bytes) {
    return refused("a leader of " + std::to_string(*leader) + " and a trailer of " + std::to_string(*trailer) +
                   " bytes");
  }
  return {};
}

}  // namespace todbench
