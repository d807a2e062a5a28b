// What a FLIR Lepton says in its telemetry rows. A pure function over untrusted words.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace todbench {

/// Where the camera is in a flat-field correction: bits 4-5 of the status.
enum class FfcState { never, imminent, in_progress, complete };

/// The parts of the Lepton's telemetry that a measurement needs. Words count from the first telemetry row (row A is
/// words 0-79, B 80-159, C 160-239); 32-bit numbers have their low word first (Lepton engineering data sheet, telemetry
/// data content encoding).
struct LeptonTelemetry {
  std::uint16_t revision = 0;
  std::uint32_t time_ms = 0;  ///< since power-up
  std::uint32_t status = 0;
  std::uint32_t frame_counter = 0;         ///< at the sensor's own rate of 26 Hz: a repeated frame repeats it
  double fpa_temperature_k = 0;            ///< of the detector
  double fpa_temperature_ffc_k = 0;        ///< at the last flat-field correction
  std::uint32_t time_last_ffc_ms = 0;      ///< since power-up, of the last flat-field correction
  std::optional<double> kelvin_per_count;  ///< of the linear temperature mode; nothing: counts are proportional to flux

  [[nodiscard]] bool ffc_desired() const { return (status >> 3U & 1U) != 0; }
  [[nodiscard]] FfcState ffc_state() const { return static_cast<FfcState>(status >> 4U & 3U); }
  /// Automatic gain: the counts mean nothing.
  [[nodiscard]] bool agc() const { return (status >> 12U & 1U) != 0; }
  [[nodiscard]] bool shutter_locked() const { return (status >> 15U & 1U) != 0; }
  [[nodiscard]] bool too_hot() const { return (status >> 20U & 1U) != 0; }
  /// Since the last correction, across a wrap of the 32-bit clock; nothing before the first.
  [[nodiscard]] std::optional<double> since_ffc_s() const;
  bool operator==(const LeptonTelemetry&) const = default;
};

/// Words of the three telemetry lines of 80.
inline constexpr std::size_t lepton_telemetry_words = 240;

/// Rows of a picture `width` wide that the telemetry fills: 3 of a Lepton 2 (80), 2 of a Lepton 3 (160).
[[nodiscard]] int lepton_telemetry_rows(int width);

/// Nothing when there are fewer than 240 words, or the revision word is not that of a telemetry row (0, or all bits
/// set, as rows of nothing are; high byte 1 ... 31).
[[nodiscard]] std::optional<LeptonTelemetry> parse_lepton_telemetry(std::span<const std::uint16_t> words);

/// The inverse, for devices that send telemetry: 240 words, those that are not in the struct zero.
[[nodiscard]] std::array<std::uint16_t, lepton_telemetry_words> encode_lepton_telemetry(
    const LeptonTelemetry& telemetry);

}  // namespace todbench
