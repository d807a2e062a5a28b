// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/reference_set/reference_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "acquisition/base/try.h"
#include "bench/text/files.h"
#include "bench/text/json_reader.h"
#include "bench/text/text.h"
#include "sim_devices/sensor/sensor_key.h"

namespace todbench {
namespace {

std::string decimal(double value) {
  const std::string text = number_text(value);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

constexpr std::string_view sums_name = "SHA256SUMS";

}  // namespace

std::string sensor_description(const SensorSpec& sensor) {
  std::string text = "name = \"" + sensor.name + "\"\ndescription = \"" + sensor.description + "\"\n\n";
  for (const SensorKey& key : sensor_keys()) {
    text += std::string(key.name) + " = ";
    if (const auto* number = std::get_if<double SensorSpec::*>(&key.member)) {
      text += decimal(sensor.*(*number));
    } else if (const auto* whole = std::get_if<int SensorSpec::*>(&key.member)) {
      text += std::to_string(sensor.*(*whole));
    } else {
      text += "\"" + std::string(to_string(sensor.*std::get<DisplayReconstruction SensorSpec::*>(key.member))) + "\"";
    }
    text += "  # " + std::string(key.meaning) + "\n";
  }
  return text;
}

std::string set_description(const ReferenceSetOptions& options, const std::vector<ReferenceTruth>& truths) {
  Json cases = Json::array();
  for (std::size_t i = 0; i < options.cases.size(); ++i) {
    const ReferenceCase& c = options.cases[i];
    cases.push_back({{"case", c.name},
                     {"sensor", "sensors/" + c.sensor.name + ".toml"},
                     {"set_delta_t_k", json_number(c.delta_t_k)},
                     {"ifov_mrad", json_number(c.sensor.ifov_mrad())},
                     {"s75_mrad", json_number(truths[i].s75_mrad)},
                     {"s75_standard_error_mrad", json_number(truths[i].standard_error_mrad)},
                     {"tolerance_percent", json_number(reference_tolerance_percent)}});
  }
  return to_page(Json{{"schema", reference_set_name},
                      {"seed", options.seed},
                      {"frames_per_case", options.frames},
                      {"observer", "observers/" + std::string(reference_observer) + ".toml"},
                      {"plates", {"plates/tcat-a.toml", "plates/tcat-b.toml"}},
                      {"distance_m", json_number(reference_distance_m)},
                      {"background_k", json_number(reference_background_k)},
                      {"licence", "GPL-3.0-or-later"},
                      {"cases", std::move(cases)}});
}

std::string set_readme(const ReferenceSetOptions& options) {
  return fmt::format(
      R"(# {}

Frames of simulated thermal cameras with a known 75 % triangle size (TOD), to check an automatic TOD measurement.
Made by `todbench reference-set --out DIR --seed {}`; the same seed gives the same bytes. Licence: GPL-3.0-or-later.

S75 is the size (square root of the area over the distance, mrad) at which the observer of `observers/` names the direction
of 75 % of the triangles, averaged over sampling phases, noise and directions. It was computed without trials and without
a psychometric form; `set.json` states it with its standard error. It is the threshold of that observer, not of people.

| file | content |
|---|---|
| `set.json` | cases with contrast, IFOV, S75, its standard error and the tolerance |
| `CASE.tif` | {} pages of 16 bits: counts, linear in temperature as `sensors/` says (`kelvin_per_count`, `offset_k`) |
| `CASE.todrec` | the same frames as a recording of todbench, with the scale |
| `CASE-frames.csv` | `frame` (from 0), `plate`, `mounting`, `shift_x_mm`, `shift_y_mm` |
| `CASE-triangles.csv` | `frame`, `triangle`, `size_mm`, `size_mrad`, `apex` as mounted, `x_px`, `y_px` of the centroid (pixel centres at whole numbers) |
| `plates/`, `observers/`, `sensors/` | descriptions of everything that was simulated |
| `SHA256SUMS` | SHA-256 of every other file |

## A result

A CSV file with the columns `case`, `s75_mrad` and, if there is an interval, `s75_ci95_low_mrad` and `s75_ci95_high_mrad`;
one row for each case. `todbench reference-set --check RESULT.csv --against DIR` reports the deviation of each case.
A result passes if every case is within {} % of its S75.
)",
      reference_set_name, options.seed, options.frames, number_text(reference_tolerance_percent));
}

Result<std::string> set_sums(const std::filesystem::path& folder) {
  std::vector<std::string> files;
  std::error_code problem;
  for (std::filesystem::recursive_directory_iterator at(folder, problem), end; !problem && at != end;
       at.increment(problem)) {
    if (!at->is_directory(problem)) files.push_back(at->path().lexically_relative(folder).generic_string());
  }
  if (problem) return fail(ErrorCode::io, folder.string() + ": " + problem.message());
  std::sort(files.begin(), files.end());
  std::string text;
  for (const std::string& file : files) {
    if (file == sums_name) continue;
    TODBENCH_TRY(auto sum, sha256_of_file(folder / file));
    text += sum + "  " + file + "\n";
  }
  return text;
}

Result<std::vector<ReferenceTruth>> read_truths(const std::filesystem::path& folder) {
  const auto refuse = [&](const std::string& why) {
    return fail(ErrorCode::invalid_input, folder.string() + ": " + why);
  };
  TODBENCH_TRY(const auto text, read_text_file(folder / "set.json"));
  TODBENCH_TRY(const auto listed, read_text_file(folder / sums_name));
  TODBENCH_TRY(const auto found, set_sums(folder));
  if (listed != found) return refuse("its files differ from those that SHA256SUMS lists");
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return refuse("set.json is not valid JSON");
  const JsonReader reader(json);
  reader.at("schema").expect(reference_set_name);
  std::vector<ReferenceTruth> out;
  for (const JsonReader& c : reader.at("cases").elements())
    out.push_back({c.at("case").text(), c.at("s75_mrad").number(), c.at("s75_standard_error_mrad").number()});
  if (auto read = reader.finish(); !read) return refuse("set.json: " + read.error().message);
  for (const ReferenceTruth& truth : out) {
    if (!(truth.s75_mrad > 0) || !(truth.standard_error_mrad >= 0))
      return refuse("set.json: expected thresholds above 0 with a standard error of at least 0");
  }
  return out;
}

}  // namespace todbench
