// SPDX-License-Identifier: GPL-3.0-or-later
// Telemetry rows of a FLIR Lepton. Pure functions over untrusted words.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace todbench {

/// State of the flat-field correction: bits 4-5 of the status.
enum class FfcState { never, imminent, in_progress, complete };

/// The fields of the Lepton's telemetry that a measurement needs. Words are numbered from the first telemetry row (row
/// A: words 0-79, B: 80-159, C: 160-239). The low word of a 32-bit number is first (Lepton engineering data sheet,
/// telemetry data content encoding).
struct LeptonTelemetry {
  std::uint16_t revision = 0;
  std::uint32_t time_ms = 0;  ///< since power-up
  std::uint32_t status = 0;
  std::uint32_t frame_counter = 0;         ///< number of the frame at the rate of the sensor, 26 Hz; unchanged in a
                                           ///< repeated frame
  double fpa_temperature_k = 0;            ///< temperature of the detector
  double fpa_temperature_ffc_k = 0;        ///< temperature of the detector at the last flat-field correction
  std::uint32_t time_last_ffc_ms = 0;      ///< since power-up, of the last flat-field correction
  std::optional<double> kelvin_per_count;  ///< scale in the linear temperature mode; empty: counts are proportional to
                                           ///< radiant flux

  [[nodiscard]] FfcState ffc_state() const { return static_cast<FfcState>(status >> 4U & 3U); }
  /// Returns whether automatic gain is on. The counts then have no radiometric meaning.
  [[nodiscard]] bool agc() const { return (status >> 12U & 1U) != 0; }
  /// Returns the time since the last correction, also across a wrap of the 32-bit clock; empty before the first
  /// correction.
  [[nodiscard]] std::optional<double> since_ffc_s() const;
  bool operator==(const LeptonTelemetry&) const = default;
};

/// Number of words in three telemetry lines of 80 words.
inline constexpr std::size_t lepton_telemetry_words = 240;

/// Returns the number of telemetry rows in a picture of this width: 3 for a Lepton 2 (80), 2 for a Lepton 3 (160).
[[nodiscard]] int lepton_telemetry_rows(int width);

/// Parses telemetry. Empty if there are fewer than 240 words or the revision word does not belong to a telemetry row.
/// The high byte of the revision word is 1 ... 31 in telemetry. In other rows it is 0 or has all bits set.
[[nodiscard]] std::optional<LeptonTelemetry> parse_lepton_telemetry(std::span<const std::uint16_t> words);

/// Encodes telemetry for a device that sends it: 240 words. Words without a member in the struct are zero.
[[nodiscard]] std::array<std::uint16_t, lepton_telemetry_words> encode_lepton_telemetry(
    const LeptonTelemetry& telemetry);

}  // namespace todbench
