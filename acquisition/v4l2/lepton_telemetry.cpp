// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/v4l2/lepton_telemetry.h"

#include <cmath>

namespace todbench {
namespace {

// Word numbers, from the first telemetry row.
constexpr std::size_t word_revision = 0, word_time = 1, word_status = 3, word_frame_counter = 20, word_fpa = 24,
                      word_fpa_ffc = 29, word_time_ffc = 30, word_tlinear = 160 + 48, word_tlinear_fine = 160 + 49;
constexpr double kelvin_per_unit = 0.01;
constexpr double fine_k = 0.01, coarse_k = 0.1;

std::uint32_t two_words(std::span<const std::uint16_t> words, std::size_t first) {
  return words[first] | static_cast<std::uint32_t>(words[first + 1]) << 16U;
}

}  // namespace

std::optional<double> LeptonTelemetry::since_ffc_s() const {
  if (ffc_state() == FfcState::never) return std::nullopt;
  const std::uint32_t ms = time_ms - time_last_ffc_ms;
  return ms * 1e-3;
}

int lepton_telemetry_rows(int width) {
  const auto words = static_cast<int>(lepton_telemetry_words);
  return width > 0 ? (words + width - 1) / width : 0;
}

std::optional<LeptonTelemetry> parse_lepton_telemetry(std::span<const std::uint16_t> words) {
  if (words.size() < lepton_telemetry_words) return std::nullopt;
  const unsigned major = words[word_revision] >> 8U;
  if (major == 0 || major > 31) return std::nullopt;
  LeptonTelemetry telemetry;
  telemetry.revision = words[word_revision];
  telemetry.time_ms = two_words(words, word_time);
  telemetry.status = two_words(words, word_status);
  telemetry.frame_counter = two_words(words, word_frame_counter);
  telemetry.fpa_temperature_k = kelvin_per_unit * words[word_fpa];
  telemetry.fpa_temperature_ffc_k = kelvin_per_unit * words[word_fpa_ffc];
  telemetry.time_last_ffc_ms = two_words(words, word_time_ffc);
  if (words[word_tlinear] != 0) telemetry.kelvin_per_count = words[word_tlinear_fine] != 0 ? fine_k : coarse_k;
  return telemetry;
}

std::array<std::uint16_t, lepton_telemetry_words> encode_lepton_telemetry(const LeptonTelemetry& telemetry) {
  std::array<std::uint16_t, lepton_telemetry_words> words{};
  const auto put = [&words](std::size_t first, std::uint32_t value) {
    words[first] = static_cast<std::uint16_t>(value);
    words[first + 1] = static_cast<std::uint16_t>(value >> 16U);
  };
  words[word_revision] = telemetry.revision;
  put(word_time, telemetry.time_ms);
  put(word_status, telemetry.status);
  put(word_frame_counter, telemetry.frame_counter);
  words[word_fpa] = static_cast<std::uint16_t>(std::lround(telemetry.fpa_temperature_k / kelvin_per_unit));
  words[word_fpa_ffc] = static_cast<std::uint16_t>(std::lround(telemetry.fpa_temperature_ffc_k / kelvin_per_unit));
  put(word_time_ffc, telemetry.time_last_ffc_ms);
  words[word_tlinear] = telemetry.kelvin_per_count ? 1 : 0;
  words[word_tlinear_fine] = telemetry.kelvin_per_count && *telemetry.kelvin_per_count < 0.05 ? 1 : 0;
  return words;
}

}  // namespace todbench
