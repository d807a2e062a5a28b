// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/trials_csv.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>

#include "acquisition/base/try.h"
#include "bench/session/csv_fields.h"
#include "bench/text/csv_table.h"
#include "bench/text/text.h"

namespace todbench {

namespace {

constexpr std::array<std::string_view, 26> trial_columns{"presentation",
                                                         "plate",
                                                         "mounting",
                                                         "triangle",
                                                         "set_delta_t_k",
                                                         "delta_t_k",
                                                         "size_mm",
                                                         "size_mrad",
                                                         "size_px",
                                                         "truth",
                                                         "answer",
                                                         "score_up",
                                                         "score_right",
                                                         "score_down",
                                                         "score_left",
                                                         "phase_x_px",
                                                         "phase_y_px",
                                                         "frame",
                                                         "device_time_ns",
                                                         "host_time_ns",
                                                         "since_nuc_s",
                                                         "saturated_pixels",
                                                         "probability_correct",
                                                         "frames",
                                                         "centroid_x_px",
                                                         "centroid_y_px"};

/// Files of earlier versions end before saturated_pixels, probability_correct or centroid_x_px.
constexpr std::array<std::size_t, 3> earlier_columns{21, 22, 24};

Trial read_trial(FieldReader& fields, std::size_t columns) {
  Trial trial;
  trial.presentation = fields.whole<std::int64_t>();
  trial.plate = fields.text();
  trial.mounting = fields.mounting();
  trial.triangle = fields.text();
  trial.set_delta_t_k = fields.number();
  trial.delta_t_k = fields.number();
  trial.size_mm = fields.number();
  trial.size_mrad = fields.number();
  trial.size_px = fields.number();
  trial.truth = fields.apex();
  trial.answer = fields.apex();
  for (double& score : trial.scores) score = fields.number();
  trial.phase_x_px = fields.number();
  trial.phase_y_px = fields.number();
  trial.frame = fields.whole<std::uint64_t>();
  trial.device_time_ns = fields.whole<std::int64_t>();
  trial.host_time_ns = fields.whole<std::int64_t>();
  trial.since_nuc_s = fields.optional_number().value_or(-1);
  if (columns > earlier_columns[0]) trial.saturated_pixels = fields.count();
  if (columns > earlier_columns[1]) {
    trial.probability_correct = fields.optional_probability();
    trial.frames = fields.count();
  }
  if (columns > earlier_columns[2]) {
    const auto x_px = fields.optional_number();
    const auto y_px = x_px ? std::optional(fields.number()) : fields.optional_number();
    if (x_px && y_px) trial.centroid = PlaceInPicture{*x_px, *y_px};
  }
  return trial;
}

std::string trial_line(const Trial& trial) {
  std::string line = std::to_string(trial.presentation);
  const auto add = [&line](std::string_view field) { (line += ',') += field; };
  add(csv_field(trial.plate));
  add(to_string(trial.mounting));
  add(csv_field(trial.triangle));
  for (const double value : {trial.set_delta_t_k, trial.delta_t_k, trial.size_mm, trial.size_mrad, trial.size_px}) {
    add(number_text(value));
  }
  add(to_string(trial.truth));
  add(to_string(trial.answer));
  for (const double score : trial.scores) add(number_text(score));
  add(number_text(trial.phase_x_px));
  add(number_text(trial.phase_y_px));
  add(std::to_string(trial.frame));
  add(std::to_string(trial.device_time_ns));
  add(std::to_string(trial.host_time_ns));
  add(trial.since_nuc_s < 0 ? std::string() : number_text(trial.since_nuc_s));
  add(std::to_string(trial.saturated_pixels));
  add(trial.probability_correct ? number_text(*trial.probability_correct) : std::string());
  add(std::to_string(trial.frames));
  add(trial.centroid ? number_text(trial.centroid->x_px) : std::string());
  add(trial.centroid ? number_text(trial.centroid->y_px) : std::string());
  return line + "\n";
}

bool all_finite(const Trial& trial) {
  for (const double value :
       {trial.set_delta_t_k, trial.delta_t_k, trial.size_mm, trial.size_mrad, trial.size_px, trial.phase_x_px,
        trial.phase_y_px, trial.since_nuc_s, trial.probability_correct.value_or(0)}) {
    if (!std::isfinite(value)) return false;
  }
  for (const double score : trial.scores) {
    if (!std::isfinite(score)) return false;
  }
  const PlaceInPicture place = trial.centroid.value_or(PlaceInPicture{});
  if (!std::isfinite(place.x_px) || !std::isfinite(place.y_px)) return false;
  return true;
}

/// Position of each wanted column in the header.
struct LevelColumns {
  std::size_t size = 0, correct = 0, total = 0;
  std::optional<std::size_t> cluster;
};

Result<LevelColumns> level_columns(const CsvTable& table) {
  static const std::vector<std::string> known{"size", "correct", "total", "cluster"};
  std::array<std::optional<std::size_t>, 4> places;
  for (std::size_t i = 0; i < table.header.size(); ++i) {
    const auto found = std::find(known.begin(), known.end(), table.header[i]);
    if (found == known.end()) {
      return table.wrong(1, "unknown column '" + one_line(table.header[i]) + "'" +
                                nearest_name_hint(table.header[i], known) + " expected size,correct,total");
    }
    auto& place = places[static_cast<std::size_t>(found - known.begin())];
    if (place) return table.wrong(1, "column '" + *found + "' occurs twice");
    place = i;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (!places[k]) return table.wrong(1, "missing column '" + known[k] + "', expected size,correct,total");
  }
  return LevelColumns{*places[0], *places[1], *places[2], places[3]};
}

Result<Level> read_level(const CsvTable& table, const CsvRow& row, const LevelColumns& columns) {
  const auto number = [&](std::size_t column) { return parse_number(row.fields[column]); };
  const auto wrong = [&](std::size_t column, const std::string& expected) {
    return table.wrong(row.line, "column " + table.header[column] + ": expected " + expected + ", found '" +
                                     one_line(row.fields[column]) + "'");
  };
  const auto count = [&](std::size_t column) -> std::optional<double> {
    const std::optional<double> value = number(column);
    return value && *value >= 0 && std::floor(*value) == *value ? value : std::nullopt;
  };
  const std::optional<double> size = number(columns.size), correct = count(columns.correct),
                              total = count(columns.total);
  if (!size || *size < 0) return wrong(columns.size, "a finite number of 0 or more");
  if (!correct) return wrong(columns.correct, "a whole number of 0 or more");
  if (!total) return wrong(columns.total, "a whole number of 0 or more");
  if (*correct > *total) return wrong(columns.correct, "at most the total of " + number_text(*total));
  Level level{*size, *correct, *total, -1};
  if (columns.cluster) {
    const std::optional<int> cluster = parse_whole<int>(row.fields[*columns.cluster]);
    if (!cluster || *cluster < 0) return wrong(*columns.cluster, "a whole number of 0 or more");
    level.cluster = *cluster;
  }
  return level;
}

}  // namespace

Result<TrialsWriter> TrialsWriter::create(const std::filesystem::path& file) {
  TODBENCH_TRY(AppendFile opened, AppendFile::open(file, AppendFile::Start::empty));
  TODBENCH_TRY_VOID(opened.append(header_line(trial_columns)));
  return TrialsWriter(std::move(opened));
}

Result<void> TrialsWriter::append(const Trial& trial) {
  if (!all_finite(trial)) {
    return fail(ErrorCode::internal, file_.path().string() + ": a trial of presentation " +
                                         std::to_string(trial.presentation) + " has a number that is not finite");
  }
  if ((trial.plate + trial.triangle).find_first_of("\r\n") != std::string::npos) {
    return fail(ErrorCode::internal,
                file_.path().string() + ": a name contains a line end: " + one_line(trial.plate + trial.triangle));
  }
  return file_.append(trial_line(trial));
}

Result<std::vector<Trial>> read_trials(const std::filesystem::path& file) {
  TODBENCH_TRY(const std::string text, read_text_file(file));
  TODBENCH_TRY(const CsvTable table, parse_csv(text, file.string()));
  std::span<const std::string_view> columns(trial_columns);
  if (std::ranges::count(earlier_columns, table.header.size()) > 0) columns = columns.first(table.header.size());
  TODBENCH_TRY_VOID(check_columns(table, columns));
  std::vector<Trial> trials;
  trials.reserve(table.rows.size());
  for (const CsvRow& row : table.rows) {
    FieldReader fields(row.fields, columns);
    trials.push_back(read_trial(fields, columns.size()));
    if (fields.wrong()) return table.wrong(row.line, *fields.wrong());
  }
  return trials;
}

Result<std::vector<Level>> parse_levels(std::string_view text, std::string_view name) {
  TODBENCH_TRY(const CsvTable table, parse_csv(text, name));
  TODBENCH_TRY(const LevelColumns columns, level_columns(table));
  std::vector<Level> levels;
  for (const CsvRow& row : table.rows) {
    TODBENCH_TRY(Level level, read_level(table, row, columns));
    levels.push_back(level);
  }
  return levels;
}

Result<std::vector<Level>> read_levels(const std::filesystem::path& file) {
  TODBENCH_TRY(const std::string text, read_text_file(file));
  return parse_levels(text, file.string());
}

}  // namespace todbench
