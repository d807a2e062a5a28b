// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/sweep/sweep_table.h"

#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "acquisition/base/safe_file.h"
#include "acquisition/base/try.h"
#include "bench/text/json_reader.h"
#include "bench/text/spreadsheet.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

Result<Json> read_result(const std::filesystem::path& file) {
  TODBENCH_TRY(const auto text, read_text_file(file));
  Json json = Json::parse(text, nullptr, false);
  const JsonReader reader(json);
  reader.at("format").expect("todbench-sweep-result");
  for (const char* key : {"version", "commit", "sweep_sha256", "task"}) (void)reader.at(key).text();
  for (const char* key : {"index", "repeat", "seed"}) (void)reader.at(key).count();
  (void)reader.at("parameters").items();
  for (const auto& point : reader.at("points").elements()) (void)point.items();
  if (auto read = reader.finish(); !read) return fail(file.string(), read.error());
  return json;
}

/// Returns a parameter as a number if it is one.
Json cell_of(const std::string& value) {
  if (const auto number = parse_number(value)) return *number;
  return value;
}

/// Returns the cells of one point; a list becomes one column per element.
std::vector<std::pair<std::string, Json>> cells_of(const Json& point) {
  std::vector<std::pair<std::string, Json>> cells;
  for (const auto& [key, value] : point.items()) {
    if (value.is_array() && value.size() == 2) {
      cells.emplace_back(key + "_low", value[0]);
      cells.emplace_back(key + "_high", value[1]);
    } else if (value.is_primitive()) {
      cells.emplace_back(key, value);
    }
  }
  return cells;
}

void add_rows(SweepTable& table, const Sweep& sweep, const Json& result) {
  for (const auto& point : result["points"]) {
    std::map<std::string, Json> cells;
    for (const auto& [key, value] : cells_of(point)) {
      cells[key] = value;
      if (std::find(table.columns.begin(), table.columns.end(), key) == table.columns.end())
        table.columns.push_back(key);
    }
    for (const auto& key : sweep.keys()) {
      if (result["parameters"].contains(key)) cells[key] = cell_of(result["parameters"][key].get<std::string>());
    }
    for (const char* key : {"index", "task", "repeat", "seed"}) cells[key] = result[key];
    Json row = Json::array();
    for (const auto& column : table.columns) row.push_back(cells.contains(column) ? cells[column] : Json());
    table.rows.push_back(std::move(row));
  }
}

Result<void> check_versions(const Sweep& sweep, const Json& result, SweepTable& table) {
  const auto text = [&](const char* key) { return result[key].get<std::string>(); };
  if (text("sweep_sha256") != sweep.hash())
    return fail(ErrorCode::invalid_input,
                "result " + one_line(text("task")) + " belongs to another version of the sweep file");
  if (table.version.empty()) {
    table.version = text("version");
    table.commit = text("commit");
  }
  if (table.version == text("version") && table.commit == text("commit")) return {};
  return fail(ErrorCode::invalid_input,
              fmt::format("the results come from several versions of the program: {} ({}) and, from {} on, {} ({})",
                          table.version, table.commit, one_line(text("task")), one_line(text("version")),
                          one_line(text("commit"))));
}

std::string csv_cell(const Json& cell) {
  if (cell.is_null()) return "";
  if (cell.is_number_float()) return number_text(cell.get<double>());
  if (cell.is_string()) return spreadsheet_field(cell.get<std::string>());
  return cell.dump();
}

/// Closes a database and its statements in all cases.
struct Closing {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, Closing>;
using Statement = std::unique_ptr<sqlite3_stmt, Closing>;

std::string quoted_name(std::string name) {
  for (std::size_t i = 0; (i = name.find('"', i)) != std::string::npos; i += 2) name.insert(i, 1, '"');
  return "\"" + name + "\"";
}

int bind(sqlite3_stmt* statement, int place, const Json& cell) {
  if (cell.is_null()) return sqlite3_bind_null(statement, place);
  if (cell.is_number_float()) return sqlite3_bind_double(statement, place, cell.get<double>());
  if (cell.is_number()) return sqlite3_bind_int64(statement, place, cell.get<std::int64_t>());
  const std::string text = cell.is_string() ? cell.get<std::string>() : cell.dump();
  return sqlite3_bind_text(statement, place, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
}

bool filled(sqlite3* database, const SweepTable& table) {
  const auto execute = [&](const std::string& sql) {
    return sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK;
  };
  std::string columns, places;
  for (const auto& column : table.columns) {
    columns += (columns.empty() ? "" : ", ") + quoted_name(column);
    places += places.empty() ? "?" : ", ?";
  }
  if (!execute("BEGIN") || !execute("CREATE TABLE results (" + columns + ")")) return false;
  sqlite3_stmt* made = nullptr;
  const std::string insert = "INSERT INTO results VALUES (" + places + ")";
  if (sqlite3_prepare_v2(database, insert.c_str(), -1, &made, nullptr) != SQLITE_OK) return false;
  const Statement statement(made);
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (bind(made, static_cast<int>(i) + 1, row[i]) != SQLITE_OK) return false;
    }
    if (sqlite3_step(made) != SQLITE_DONE || sqlite3_reset(made) != SQLITE_OK) return false;
  }
  return execute("COMMIT");
}

}  // namespace

Result<SweepTable> collected(const Sweep& sweep, MissingTasks missing) {
  SweepTable table;
  table.columns = {"index", "task"};
  for (const auto& key : sweep.keys()) table.columns.push_back(key);
  table.columns.insert(table.columns.end(), {"repeat", "seed"});
  table.tasks = sweep.count();
  const SweepStatus status = sweep_status(sweep);
  if (const auto foreign = status.count(TaskState::foreign); foreign > 0) {
    return fail(ErrorCode::invalid_input,
                fmt::format("{} results in {} belong to another sweep file", foreign, sweep.file().results.string()));
  }
  table.missing = status.states.size() - status.count(TaskState::done);
  if (table.missing > 0 && missing == MissingTasks::refused) {
    return fail(
        ErrorCode::not_identifiable,
        fmt::format("{} of {} tasks have no result yet (use --partial to leave them out)", table.missing, table.tasks));
  }
  std::vector<Json> results;
  for (std::size_t i = 0; i < status.states.size(); ++i) {
    if (status.states[i] != TaskState::done) continue;
    TODBENCH_TRY(auto result, read_result(result_file(sweep, sweep.task(i))));
    TODBENCH_TRY_VOID(check_versions(sweep, result, table));
    add_rows(table, sweep, result);
  }
  // Rows before the first occurrence of a column are shorter.
  for (auto& row : table.rows) {
    while (row.size() < table.columns.size()) row.push_back(nullptr);
  }
  return table;
}

std::string to_csv(const SweepTable& table) {
  std::string text;
  for (const auto& column : table.columns) text += (text.empty() ? "" : ",") + csv_field(column);
  text += '\n';
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) text += (i == 0 ? "" : ",") + csv_cell(row[i]);
    text += '\n';
  }
  return text;
}

Json to_json(const SweepTable& table) {
  Json rows = Json::array();
  for (const auto& row : table.rows) {
    Json object = Json::object();
    for (std::size_t i = 0; i < table.columns.size(); ++i) object[table.columns[i]] = row[i];
    rows.push_back(std::move(object));
  }
  return {{"columns", table.columns}, {"rows", rows},          {"tasks", table.tasks}, {"missing", table.missing},
          {"version", table.version}, {"commit", table.commit}};
}

Result<void> write_sqlite(const SweepTable& table, const std::filesystem::path& file) {
  TODBENCH_TRY(const auto part, make_file_beside(file));
  ::close(part.descriptor);
  const std::filesystem::path& beside = part.path;
  std::error_code problem;
  sqlite3* opened = nullptr;
  const int code = sqlite3_open(beside.c_str(), &opened);
  Database database(opened);
  if (code != SQLITE_OK || !filled(opened, table)) {
    const std::string reason = opened != nullptr ? sqlite3_errmsg(opened) : "out of memory";
    database.reset();
    std::filesystem::remove(beside, problem);
    return fail(ErrorCode::io, file.string() + ": " + one_line(reason));
  }
  database.reset();
  std::filesystem::rename(beside, file, problem);
  if (!problem) return {};
  const std::string reason = problem.message();
  std::filesystem::remove(beside, problem);
  return fail(ErrorCode::io, file.string() + ": " + reason);
}

}  // namespace todbench
