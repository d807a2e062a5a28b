// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/atmospheres.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/plan/resources.h"
#include "bench/text/csv_table.h"
#include "bench/text/json_reader.h"
#include "bench/text/text.h"
#include "sim_devices/atmosphere/spectral_air.h"

namespace todbench {
namespace {

constexpr double band_reach_um = 0.6;
constexpr double longest_um = 1000;  // longest wavelength of a spectrum, beyond any thermal camera

struct ShippedRow {
  std::string model, haze;
  SpectralBand band;
  double air_k = 0;
  std::vector<TransmittancePoint> points;
};

/// Converts names: "US standard 1976" -> "us-standard", "rural 23 km" -> "rural-23km".
std::string short_name(std::string_view text) {
  std::string name;
  for (const char c : text) name += c == ' ' ? '-' : static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  if (name.ends_with("-1976")) name.resize(name.size() - 5);
  if (name.ends_with("-km")) name.erase(name.size() - 3, 1);
  return name;
}

SpectralBand band_from(const std::string& text) {
  const auto dash = text.find('-');
  return {parse_number(text.substr(0, dash)).value_or(0), parse_number(text.substr(dash + 1)).value_or(0)};
}

/// Compiled-in table. The build has checked its contents.
std::vector<ShippedRow> shipped_rows() {
  const auto resource = find_resource(ResourceKind::atmosphere, "lowtran7_band_tables");
  if (!resource) return {};
  const Json json = Json::parse(resource->text, nullptr, false);
  std::vector<ShippedRow> rows;
  for (const JsonReader& entry : JsonReader(json).at("bands").elements()) {
    ShippedRow row{.model = short_name(entry.at("model").text()),
                   .haze = short_name(entry.at("haze").text()),
                   .band = band_from(entry.at("band_um").text()),
                   .air_k = entry.at("air_temperature_k").number(),
                   .points = {}};
    const auto ranges = entry.at("range_km").numbers(), passed = entry.at("transmittance").numbers();
    for (std::size_t i = 0; i < std::min(ranges.size(), passed.size()); ++i)
      row.points.push_back({1000 * ranges[i], passed[i]});
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<std::string> names_in(std::string ShippedRow::*member) {
  std::vector<std::string> names;
  for (const auto& row : shipped_rows()) {
    if (std::find(names.begin(), names.end(), row.*member) == names.end()) names.push_back(row.*member);
  }
  return names;
}

double mismatch_um(const SpectralBand& a, const SpectralBand& b) {
  return std::max(std::abs(a.low_um - b.low_um), std::abs(a.high_um - b.high_um));
}

std::string band_text(const SpectralBand& band) {
  return fmt::format("{:g}-{:g} um", band.low_um, band.high_um);
}

Result<Atmosphere> shipped(std::string_view name, const AtmosphereRequest& request) {
  const auto hazes = haze_names();
  if (std::find(hazes.begin(), hazes.end(), request.haze) == hazes.end()) {
    return fail(ErrorCode::invalid_input, "unknown haze '" + one_line(request.haze) + "'" +
                                              nearest_name_hint(request.haze, hazes) +
                                              " (known: " + quoted_list(hazes) + ")");
  }
  std::optional<ShippedRow> best;
  for (auto& row : shipped_rows()) {
    if (row.model != name || row.haze != request.haze) continue;
    if (!best || mismatch_um(row.band, request.band) < mismatch_um(best->band, request.band)) best = std::move(row);
  }
  if (!best) return fail(ErrorCode::internal, "the shipped table of transmittances has no " + std::string(name));
  const double mismatch = mismatch_um(best->band, request.band);
  if (mismatch > band_reach_um) {
    return fail(ErrorCode::invalid_input,
                fmt::format("the shipped tables of transmittance have no band near {}: state --band 7.5-13, 8-12, 8-14 "
                            "or 3-5 if one of them applies, or use a table of your own",
                            band_text(request.band)));
  }
  TODBENCH_TRY(auto air, Transmittance::of_table(best->points));
  Atmosphere found{
      .name = std::string(name),
      .source = fmt::format("LOWTRAN 7 (revision 4.2, 1992), {}, horizontal at sea level, aerosol {}, band "
                            "{}, weight dB/dT at 300 K",
                            name, best->haze, band_text(best->band)),
      .air = std::move(air),
      .air_k = best->air_k,
      .table_band = best->band};
  if (mismatch > 0) {
    found.notes.push_back(
        fmt::format("the band of the camera is {}; the transmittance is that of the nearest table, {}",
                    band_text(request.band), band_text(best->band)));
  }
  return found;
}

/// Returns the number in column `column`, or an error with the line.
Result<double> number_at(const CsvTable& table, const CsvRow& row, std::size_t column) {
  const auto value = parse_number(row.fields[column]);
  if (value) return *value;
  return table.wrong(
      row.line, "column " + table.header[column] + ": expected a number, found '" + one_line(row.fields[column]) + "'");
}

/// Returns the rows of two columns.
Result<std::vector<std::pair<double, double>>> pairs_of(const CsvTable& table, std::size_t a, std::size_t b) {
  std::vector<std::pair<double, double>> pairs;
  for (const auto& row : table.rows) {
    const auto first = number_at(table, row, a), second = number_at(table, row, b);
    if (!first) return tl::unexpected(first.error());
    if (!second) return tl::unexpected(second.error());
    pairs.emplace_back(*first, *second);
  }
  return pairs;
}

/// Returns a note if a spectrum does not match the camera's band: all of it is averaged.
std::optional<std::string> spectrum_note(const std::vector<SpectralExtinction>& spectrum, const SpectralBand& band) {
  if (spectrum.empty() || !(band.high_um > band.low_um)) return std::nullopt;
  const SpectralBand own{spectrum.front().wavelength_um, spectrum.back().wavelength_um};
  if (own.low_um >= band.low_um - band_reach_um && own.high_um <= band.high_um + band_reach_um) return std::nullopt;
  const bool apart = own.high_um <= band.low_um || own.low_um >= band.high_um;
  return fmt::format(
      "the spectrum of the air, {}, {} the band of the camera, {}; the transmittance is averaged over the whole "
      "spectrum",
      band_text(own), apart ? "does not overlap" : "extends beyond", band_text(band));
}

Result<Transmittance> air_of_csv(const CsvTable& table, const AtmosphereRequest& request,
                                 std::vector<std::string>& notes) {
  const auto kilometres = table.column("range_km"), metres = table.column("range_m");
  const auto transmittance = table.column("transmittance"), tau = table.column("tau");
  const auto wavelength = table.column("wavelength_um"), extinction = table.column("extinction_per_km");
  if (const auto range = kilometres ? kilometres : metres; range && (transmittance || tau)) {
    TODBENCH_TRY(const auto pairs, pairs_of(table, *range, transmittance ? *transmittance : *tau));
    std::vector<TransmittancePoint> points;
    for (const auto& [at, passed] : pairs) points.push_back({kilometres ? 1000 * at : at, passed});
    return Transmittance::of_table(points);
  }
  if (wavelength && extinction) {
    TODBENCH_TRY(const auto pairs, pairs_of(table, *wavelength, *extinction));
    std::vector<SpectralExtinction> spectrum;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const auto& [at, per_km] = pairs[i];
      if (at > longest_um)
        return table.wrong(table.rows[i].line, fmt::format("a wavelength of {:g} um is too long; is it in nm?", at));
      spectrum.push_back({at, per_km});
    }
    if (auto note = spectrum_note(spectrum, request.band)) notes.push_back(*std::move(note));
    return air_of_spectrum(spectrum, request.weight_temperature_k);
  }
  return table.wrong(1,
                     "expected the columns range_km (or range_m) and transmittance (or tau), or wavelength_um and "
                     "extinction_per_km, found " +
                         quoted_list(table.header));
}

/// Blanks comment lines (#); empty lines keep the line numbers correct.
std::string without_remarks(std::string_view text) {
  std::string rest;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    if (!text.starts_with('#')) rest += text.substr(0, end);
    rest += '\n';
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return rest;
}

Result<Atmosphere> from_file(const std::string& file, const AtmosphereRequest& request) {
  TODBENCH_TRY(const auto text, read_text_file(file));
  return parse_atmosphere(text, file, request);
}

}  // namespace

Result<Atmosphere> parse_atmosphere(std::string_view text, const std::string& file, const AtmosphereRequest& request) {
  Atmosphere found{.name = file, .source = "table of the file " + file};
  const bool csv = std::filesystem::path(file).extension() == ".csv";
  Result<Transmittance> air = found.air;
  if (csv) {
    TODBENCH_TRY(const auto table, parse_csv(without_remarks(text), file));
    air = air_of_csv(table, request, found.notes);
  } else {
    const auto runs = parse_tape7(text);
    if (!runs) return fail(file, runs.error());
    air = air_of_tape7(*runs, request.band, request.weight_temperature_k);
    found.source = fmt::format("tape7 file {}, {} runs, band {}, weight dB/dT at {:g} K", file, runs->size(),
                               band_text(request.band), request.weight_temperature_k);
    if (runs->size() == 1)
      found.notes.emplace_back(
          "tape7 has one run; transmittances at shorter ranges are computed from its spectrum as if every line were "
          "resolved");
  }
  if (!air) {
    if (air.error().message.starts_with(file)) return tl::unexpected(air.error());
    return fail(file, air.error());
  }
  found.air = *std::move(air);
  return found;
}

std::vector<std::string> atmosphere_names() {
  std::vector<std::string> names{"clear", "beer-lambert"};
  for (auto& name : names_in(&ShippedRow::model)) names.push_back(std::move(name));
  return names;
}

std::vector<std::string> haze_names() {
  return names_in(&ShippedRow::haze);
}

Result<Atmosphere> load_atmosphere(std::string_view reference, const AtmosphereRequest& request) {
  TODBENCH_TRY_VOID(validate(request.band));
  if (request.extinction_per_km > 0 && reference != "beer-lambert") {
    return fail(ErrorCode::invalid_input,
                one_line(reference) + ": this atmosphere has its own extinction; leave out --extinction-per-km");
  }
  if (reference == "clear") return Atmosphere{.name = "clear", .source = "no air"};
  if (reference == "beer-lambert") {
    return Atmosphere{.name = "beer-lambert",
                      .source = fmt::format("one coefficient, {:g} per km at every range", request.extinction_per_km),
                      .air = Transmittance::beer_lambert(request.extinction_per_km)};
  }
  if (reference.find_first_of("/.") != std::string_view::npos) return from_file(std::string(reference), request);
  const auto names = atmosphere_names();
  if (std::find(names.begin(), names.end(), reference) != names.end()) return shipped(reference, request);
  return fail(ErrorCode::invalid_input, "unknown atmosphere '" + one_line(reference) + "'" +
                                            nearest_name_hint(reference, names) + " (known: " + quoted_list(names) +
                                            "; a file needs a slash or a dot)");
}

}  // namespace todbench
