// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/targets_csv.h"

#include <array>
#include <cmath>
#include <span>
#include <string>

#include "acquisition/base/try.h"
#include "bench/session/csv_fields.h"
#include "bench/text/csv_table.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr std::array<std::string_view, 24> target_columns{"presentation",
                                                          "plate",
                                                          "mounting",
                                                          "set_delta_t_k",
                                                          "reached_delta_t_k",
                                                          "delta_t_k",
                                                          "plate_temperature_k",
                                                          "black_body_temperature_k",
                                                          "settling_s",
                                                          "host_time_ns",
                                                          "set_shift_x_mm",
                                                          "set_shift_y_mm",
                                                          "reached_plate",
                                                          "reached_mounting",
                                                          "reached_shift_x_mm",
                                                          "reached_shift_y_mm",
                                                          "air_transmittance",
                                                          "delta_t_se_k",
                                                          "reference_triangles",
                                                          "asked_x_px",
                                                          "asked_y_px",
                                                          "seen_x_px",
                                                          "seen_y_px",
                                                          "seen_error_px"};

std::string number_field(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? number_text(*value) : std::string();
}

std::string target_line(const Presentation& shown) {
  const PresentedTarget& said = shown.said;
  std::string line = std::to_string(shown.presentation);
  const auto add = [&line](std::string_view field) { (line += ',') += field; };
  add(csv_field(shown.set.plate));
  add(to_string(shown.set.mounting));
  add(number_text(shown.set.delta_t_k));
  add(number_field(said.state.delta_t_k));
  add(number_field(shown.delta_t_k));
  add(number_field(said.plate_temperature_k));
  add(number_field(said.black_body_temperature_k));
  add(number_field(said.settling_s));
  add(shown.host_time_ns ? std::to_string(*shown.host_time_ns) : std::string());
  add(number_text(shown.set.shift_mm.x));
  add(number_text(shown.set.shift_mm.y));
  add(csv_field(said.state.plate));
  add(to_string(said.state.mounting));
  add(number_field(said.state.shift_mm.x));
  add(number_field(said.state.shift_mm.y));
  add(number_field(shown.air_transmittance));
  add(number_field(shown.delta_t_se_k));
  add(shown.reference_triangles > 0 ? std::to_string(shown.reference_triangles) : std::string());
  for (const auto& place : {shown.asked_px, shown.seen_px}) {
    add(place ? number_text(place->x) : std::string());
    add(place ? number_text(place->y) : std::string());
  }
  add(number_field(shown.seen_error_px));
  return line + "\n";
}

/// Column counts of earlier files: without the air, without the error of the contrast, without the position in the
/// picture.
constexpr std::size_t without_air = 16, without_error = 17, without_place = 19;

Presentation read_target(FieldReader& fields, std::size_t columns) {
  // A non-finite number from the instrument.
  const auto said = [&fields] { return fields.optional_number().value_or(std::nan("")); };
  Presentation shown;
  shown.presentation = fields.whole<std::int64_t>();
  shown.set.plate = fields.text();
  shown.set.mounting = fields.mounting();
  shown.set.delta_t_k = fields.number();
  shown.said.state.delta_t_k = said();
  shown.delta_t_k = fields.optional_number();
  shown.said.plate_temperature_k = fields.optional_number();
  shown.said.black_body_temperature_k = fields.optional_number();
  shown.said.settling_s = said();
  shown.host_time_ns = fields.optional_whole<std::int64_t>();
  shown.set.shift_mm.x = fields.number();
  shown.set.shift_mm.y = fields.number();
  shown.said.state.plate = fields.text();
  shown.said.state.mounting = fields.mounting();
  shown.said.state.shift_mm.x = said();
  shown.said.state.shift_mm.y = said();
  if (columns > without_air) shown.air_transmittance = fields.optional_number();
  if (columns > without_error) {
    shown.delta_t_se_k = fields.optional_number();
    shown.reference_triangles = fields.optional_whole<int>().value_or(0);
  }
  if (columns > without_place) {
    for (auto* place : {&shown.asked_px, &shown.seen_px}) {
      const auto x = fields.optional_number(), y = fields.optional_number();
      if (x && y) *place = cv::Point2d(*x, *y);
    }
    shown.seen_error_px = fields.optional_number();
  }
  return shown;
}

}  // namespace

Result<TargetsWriter> TargetsWriter::create(const std::filesystem::path& file) {
  TODBENCH_TRY(AppendFile opened, AppendFile::open(file, AppendFile::Start::empty));
  TODBENCH_TRY_VOID(opened.append(header_line(target_columns)));
  return TargetsWriter(std::move(opened));
}

Result<void> TargetsWriter::append(const Presentation& shown) {
  const TargetState& set = shown.set;
  const std::string names = set.plate + shown.said.state.plate;
  if (!std::isfinite(set.delta_t_k) || !std::isfinite(set.shift_mm.x) || !std::isfinite(set.shift_mm.y)) {
    return fail(ErrorCode::internal, file_.path().string() + ": presentation " + std::to_string(shown.presentation) +
                                         " has a set-point that is not finite");
  }
  if (names.find_first_of("\r\n") != std::string::npos)
    return fail(ErrorCode::internal, file_.path().string() + ": a name contains a line end: " + one_line(names));
  return file_.append(target_line(shown));
}

Result<std::vector<Presentation>> read_targets(const std::filesystem::path& file) {
  TODBENCH_TRY(const std::string text, read_text_file(file));
  TODBENCH_TRY(const CsvTable table, parse_csv(text, file.string()));
  const std::size_t had = table.header.size();
  const std::span columns(target_columns.data(), had == without_air || had == without_error || had == without_place
                                                     ? had
                                                     : target_columns.size());
  TODBENCH_TRY_VOID(check_columns(table, columns));
  std::vector<Presentation> presentations;
  presentations.reserve(table.rows.size());
  for (const CsvRow& row : table.rows) {
    FieldReader fields(row.fields, target_columns);
    presentations.push_back(read_target(fields, columns.size()));
    if (fields.wrong()) return table.wrong(row.line, *fields.wrong());
  }
  return presentations;
}

}  // namespace todbench
