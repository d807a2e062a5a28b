// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/atmosphere/spectral_air.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "acquisition/base/try.h"

namespace todbench {
namespace {

/// Half of the distance between the neighbours: weights of the trapezoid rule.
template <typename Axis>
double cell(std::size_t i, std::size_t count, Axis axis) {
  const double low = axis(i == 0 ? 0 : i - 1), high = axis(i + 1 == count ? i : i + 1);
  return std::abs(high - low) / 2;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::optional<double> number(std::string_view text) {
  text = trimmed(text);
  double value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  // Fortran writes whole numbers as "-9999.".
  if (problem != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Removes the next word from a line and returns it.
std::string_view next_word(std::string_view& line) {
  const auto first = line.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return line = {};
  line.remove_prefix(first);
  const auto word = line.substr(0, line.find_first_of(" \t\r"));
  line.remove_prefix(word.size());
  return word;
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const auto end = text.find('\n');
    lines.push_back(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return lines;
}

/// True for a number of levels and a name: "   36TROPICAL MODEL", "   361976 U S STANDARD".
bool names_a_model(std::string_view line) {
  if (line.find('!') != std::string_view::npos) return false;
  const auto letters = std::count_if(line.begin(), line.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
  const std::string_view text = trimmed(line);
  return letters >= 3 && !text.empty() && text.front() >= '0' && text.front() <= '9';
}

tl::unexpected<Error> wrong(std::size_t line, std::string_view sentence) {
  return fail(ErrorCode::invalid_input, fmt::format("line {}: {}", line + 1, sentence));
}

/// Range from card 3, the line after the name of the model, in front of the header of the columns.
Result<double> range_of(std::span<const std::string_view> lines, std::size_t begin, std::size_t header) {
  for (std::size_t i = begin; i + 1 < header; ++i) {
    if (!names_a_model(lines[i])) continue;
    const std::string_view card = lines[i + 1];
    const auto range = card.size() > 30 ? number(card.substr(30, 10)) : std::nullopt;
    if (!range || *range <= 0) return wrong(i + 1, "card 3 has no range above 0 km in columns 31 to 40");
    return *range;
  }
  return wrong(header, "no line with the name of a model atmosphere before the columns: is this a tape7 file?");
}

/// Reads the rows of a run from `line` on and moves `line` to the end of the run.
Result<void> read_rows(std::span<const std::string_view> lines, std::size_t& line, Tape7Run& run) {
  for (; line < lines.size(); ++line) {
    std::string_view rest = lines[line];
    const std::string_view first_word = next_word(rest);
    if (first_word.empty()) continue;
    const auto first = number(first_word);
    if (first && *first == -9999) {
      ++line;
      break;
    }
    const auto second = number(next_word(rest));
    if (!first || !second) return wrong(line, "expected a wavenumber and a transmittance");
    if (!(*first > 0) || !(*second >= 0 && *second <= 1))
      return wrong(line, "expected a wavenumber above 0 and a transmittance from 0 to 1");
    if (!run.wavenumber_per_cm.empty() && !(*first > run.wavenumber_per_cm.back()))
      return wrong(line, "wavenumbers must increase");
    run.wavenumber_per_cm.push_back(*first);
    run.transmittance.push_back(*second);
  }
  return {};
}

/// Weights dL/dT of the wavenumbers inside the band, 0 outside. dL/dnu = dL/dlambda lambda^2.
Result<std::vector<double>> weights_of(const Tape7Run& run, const SpectralBand& band, double temperature_k) {
  const auto& nu = run.wavenumber_per_cm;
  const double low = 1e4 / band.high_um, high = 1e4 / band.low_um;
  // A run that begins one step late still covers the band.
  const double step = nu.size() > 1 ? (nu.back() - nu.front()) / static_cast<double>(nu.size() - 1) : 0;
  if (nu.size() < 2 || nu.front() > low + step || nu.back() < high - step) {
    return fail(ErrorCode::invalid_input,
                fmt::format("the spectrum does not cover the band from {:g} to {:g} um", band.low_um, band.high_um));
  }
  std::vector<double> weights;
  for (std::size_t i = 0; i < nu.size(); ++i) {
    const double wavelength_um = 1e4 / nu[i];
    const bool inside = nu[i] >= low && nu[i] <= high;
    weights.push_back(inside ? cell(i, nu.size(), [&](std::size_t k) { return nu[k]; }) * wavelength_um *
                                   wavelength_um * thermal_weight(wavelength_um, temperature_k)
                             : 0);
  }
  if (std::all_of(weights.begin(), weights.end(), [](double w) { return w <= 0; }))
    return fail(ErrorCode::invalid_input, "the spectrum has no wavenumber within the band");
  return weights;
}

}  // namespace

Result<Transmittance> air_of_spectrum(std::span<const SpectralExtinction> spectrum, double temperature_k) {
  if (spectrum.size() < 2) return fail(ErrorCode::invalid_input, "a spectrum needs at least two wavelengths");
  if (!(temperature_k > 0))
    return fail(ErrorCode::invalid_input,
                "the temperature of the black body that weights the spectrum must be above 0 K");
  std::vector<double> weights, extinction;
  double sum = 0;
  for (std::size_t i = 0; i < spectrum.size(); ++i) {
    const auto& [wavelength_um, per_km] = spectrum[i];
    if (!std::isfinite(wavelength_um) || wavelength_um <= 0 ||
        (i > 0 && wavelength_um <= spectrum[i - 1].wavelength_um))
      return fail(ErrorCode::invalid_input, "wavelengths must be above 0 um and increase");
    if (!std::isfinite(per_km) || per_km < 0)
      return fail(ErrorCode::invalid_input, "the extinction must be at least 0 per km at every wavelength");
    weights.push_back(cell(i, spectrum.size(), [&](std::size_t k) { return spectrum[k].wavelength_um; }) *
                      thermal_weight(wavelength_um, temperature_k));
    extinction.push_back(per_km);
    sum += weights.back();
  }
  if (!(sum > 0))
    return fail(ErrorCode::invalid_input,
                "the black body that weights the spectrum emits no radiation at its wavelengths");
  return Transmittance::of_spectrum(std::move(weights), std::move(extinction));
}

Result<std::vector<Tape7Run>> parse_tape7(std::string_view text) {
  const auto lines = lines_of(text);
  std::vector<Tape7Run> runs;
  std::size_t line = 0;
  while (line < lines.size()) {
    const std::size_t begin = line;
    while (line < lines.size() && !trimmed(lines[line]).starts_with("FREQ")) ++line;
    if (line == lines.size()) break;
    TODBENCH_TRY(const auto range_km, range_of(lines, begin, line));
    ++line;
    // Runs that contain only transmittance have a second line of names.
    if (line < lines.size() && trimmed(lines[line]).starts_with("CM")) ++line;
    Tape7Run run{.range_km = range_km, .wavenumber_per_cm = {}, .transmittance = {}};
    TODBENCH_TRY_VOID(read_rows(lines, line, run));
    if (run.wavenumber_per_cm.size() < 2) return wrong(begin, "the run has fewer than two wavenumbers");
    runs.push_back(std::move(run));
  }
  if (runs.empty()) return fail(ErrorCode::invalid_input, "no columns with the header FREQ: is this a tape7 file?");
  return runs;
}

Result<double> band_transmittance(const Tape7Run& run, const SpectralBand& band, double temperature_k) {
  TODBENCH_TRY(const auto weights, weights_of(run, band, temperature_k));
  double sum = 0, passed = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i];
    passed += weights[i] * run.transmittance[i];
  }
  return std::min(1.0, passed / sum);
}

Result<Transmittance> air_of_tape7(std::span<const Tape7Run> runs, const SpectralBand& band, double temperature_k) {
  std::vector<TransmittancePoint> rows;
  if (runs.size() == 1) {
    Tape7Run scaled = runs.front();
    constexpr int steps = 60;  // twenty per decade
    for (int i = 0; i <= steps; ++i) {
      const double share = std::pow(1000.0, static_cast<double>(i - steps) / steps);
      for (std::size_t k = 0; k < scaled.transmittance.size(); ++k)
        scaled.transmittance[k] = std::pow(runs.front().transmittance[k], share);
      TODBENCH_TRY(const auto tau, band_transmittance(scaled, band, temperature_k));
      rows.push_back({runs.front().range_km * 1000 * share, tau});
    }
    return Transmittance::of_table(rows);
  }
  for (const auto& run : runs) {
    TODBENCH_TRY(const auto tau, band_transmittance(run, band, temperature_k));
    rows.push_back({run.range_km * 1000, tau});
  }
  std::sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.range_m < b.range_m; });
  return Transmittance::of_table(rows);
}

}  // namespace todbench
