// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/round_robin/blind_items.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/plan/descriptions.h"
#include "bench/reference_set/reference_files.h"
#include "bench/reference_set/reference_set.h"
#include "bench/report/html.h"
#include "bench/round_robin/blind_protocol.h"
#include "bench/round_robin/sealed_truth.h"
#include "bench/text/files.h"
#include "bench/text/folders.h"
#include "bench/text/json.h"
#include "bench/text/spreadsheet.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

double between(double low, double high, double uniform) {
  return low + (high - low) * uniform;
}

/// The items without what is sealed.
std::string items_csv(const std::vector<ReferenceCase>& cases) {
  std::string out = "item,quantity,set_delta_t_k,ifov_mrad,distance_m,observer\n";
  for (const ReferenceCase& c : cases) {
    out += c.name + "," + std::string(blind_quantity) + "," + number_text(c.delta_t_k) + "," +
           number_text(c.sensor.ifov_mrad()) + "," + number_text(reference_distance_m) + "," +
           std::string(reference_observer) + "\n";
  }
  return out;
}

std::string sealed_text(const BlindOptions& options, const std::vector<ReferenceCase>& cases,
                        const std::vector<ReferenceTruth>& truths) {
  Json items = Json::array();
  for (std::size_t i = 0; i < cases.size(); ++i) {
    items.push_back({{"item", cases[i].name},
                     {"quantity", blind_quantity},
                     {"value", json_number(truths[i].s75_mrad)},
                     {"u", json_number(truths[i].standard_error_mrad)},
                     {"set_delta_t_k", json_number(cases[i].delta_t_k)},
                     {"sensor", sensor_description(cases[i].sensor)}});
  }
  return to_page(Json{{"schema", sealed_schema},
                      {"seed", options.seed},
                      {"laboratories", options.laboratories},
                      {"frames_per_item", options.frames},
                      {"items", std::move(items)}});
}

Result<void> write_laboratory(const std::filesystem::path& folder, int number, const BlindOptions& options,
                              const std::vector<ReferenceCase>& cases, const std::string& sealed_sha256,
                              const std::stop_token& stop) {
  TODBENCH_TRY_VOID(make_folder(folder));
  TODBENCH_TRY_VOID(write_plates_and_observer(folder));
  ReferenceSetOptions frames{.seed = options.seed, .frames = options.frames, .cases = {}};
  const std::string name = "laboratory-" + std::to_string(number);
  std::string answers = "laboratory,item,quantity,value,u\n";
  for (std::size_t i = 0; i < cases.size(); ++i) {
    // Streams of their own: every laboratory has other noise and other sub-pixel phases.
    const auto stream = static_cast<std::uint64_t>(number) * 1000 + i;
    if (auto written = write_reference_case(folder, cases[i], stream, frames, stop); !written)
      return fail(cases[i].name, written.error());
    answers += name + "," + cases[i].name + "," + std::string(blind_quantity) + ",,\n";
  }
  const std::pair<const char*, std::string> files[]{
      {"items.csv", items_csv(cases)},
      {"results.csv", answers},
      {"protocol.html", render_html(blind_protocol({name, cases, options.frames, sealed_sha256}))}};
  for (const auto& [file, content] : files) {
    TODBENCH_TRY_VOID(write_file_atomically(folder / file, content));
  }
  TODBENCH_TRY(const std::string sums, set_sums(folder));
  return write_file_atomically(folder / "SHA256SUMS", sums);
}

}  // namespace

std::vector<ReferenceCase> blind_cases(const BlindOptions& options) {
  const SensorSpec known = reference_cases().front().sensor;
  std::vector<ReferenceCase> out;
  for (int i = 0; i < options.items; ++i) {
    const RandomStream stream = RandomStream(options.seed, "round_robin.items").sub(static_cast<std::uint64_t>(i));
    ReferenceCase made{"item-" + std::to_string(i + 1), known, 0};
    made.sensor.name = made.name;
    made.sensor.description = "blind item of an interlaboratory comparison";
    made.sensor.netd_k = between(0.04, 0.12, stream.uniform(0));
    made.sensor.aberration_sigma_pitch = between(0, 0.5, stream.uniform(1));
    // 0.3 to 10 K: from limited by noise to limited by the optics, with thresholds inside the sizes of the plates.
    made.delta_t_k = std::round(100 * 0.3 * std::pow(10 / 0.3, stream.uniform(2))) / 100;
    out.push_back(std::move(made));
  }
  return out;
}

Result<BlindComparison> write_blind_comparison(const std::filesystem::path& folder, const BlindOptions& options,
                                               std::stop_token stop) {
  const auto cases = blind_cases(options);
  BlindComparison out;
  TODBENCH_TRY(out.truths, reference_truths(cases, stop));
  TODBENCH_TRY_VOID(make_folder(folder));
  const std::string sealed = sealed_text(options, cases, out.truths);
  out.sealed_sha256 = sha256_of(sealed);
  for (int number = 1; number <= options.laboratories; ++number) {
    const auto place = folder / ("laboratory-" + std::to_string(number));
    TODBENCH_TRY_VOID(write_laboratory(place, number, options, cases, out.sealed_sha256, stop));
    if (options.on_progress)
      options.on_progress(static_cast<std::size_t>(number), static_cast<std::size_t>(options.laboratories));
  }
  TODBENCH_TRY_VOID(write_file_atomically(folder / "sealed.json", sealed));
  return out;
}

std::string submitted_csv(const std::vector<SubmittedResult>& results) {
  std::string out = "laboratory,item,quantity,unit,value,u\n";
  for (const SubmittedResult& r : results) {
    for (const std::string& text : {r.laboratory, r.item, r.quantity, r.unit}) out += spreadsheet_field(text) + ",";
    out += number_text(r.value) + "," + number_text(r.u) + "\n";
  }
  return out;
}

}  // namespace todbench
