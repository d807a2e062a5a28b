// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/history/history_session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <system_error>

#include "acquisition/base/normal.h"
#include "acquisition/base/safe_text.h"
#include "acquisition/base/try.h"
#include "acquisition/core/serial_number.h"
#include "bench/plan/joined_uncertainty.h"
#include "bench/plan/strict_toml.h"
#include "bench/session/manifest.h"
#include "bench/session/open_session.h"
#include "bench/session/uncertainty_record.h"
#include "bench/text/csv_table.h"
#include "bench/text/files.h"
#include "bench/text/json.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

/// Reads a session file that the manifest confirms.
Result<std::string> vouched_text(const std::filesystem::path& folder, const std::string& name) {
  if (!is_there(folder / name)) {
    return fail(ErrorCode::invalid_input,
                folder.string() + ": has no " + name + "; a run that ended early has no results");
  }
  TODBENCH_TRY(const auto listed, is_listed(folder, name));
  if (!listed)
    return fail(ErrorCode::invalid_input, (folder / name).string() + ": was changed after the session ended");
  return read_text_file(folder / name);
}

Result<Json> vouched_json(const std::filesystem::path& folder, const std::string& name) {
  TODBENCH_TRY(const auto text, vouched_text(folder, name));
  Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return fail(ErrorCode::invalid_input, (folder / name).string() + ": is not valid JSON");
  return json;
}

std::string text_at(const Json& json, const char* key) {
  return json.is_object() && json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "";
}

std::optional<double> number_at(const Json& json, const char* key) {
  if (!json.is_object() || !json.contains(key) || !json[key].is_number()) return std::nullopt;
  return json[key].get<double>();
}

/// Returns the camera setting that names the lens.
std::string lens_of(const Json& camera) {
  if (!camera.contains("settings") || !camera["settings"].is_object()) return "";
  for (const auto& [name, value] : camera["settings"].items()) {
    if (lower_case(name).starts_with("lens") && value.is_string()) return value.get<std::string>();
  }
  return "";
}

/// File of a session without a curve (`todbench scene-dependence`).
constexpr const char* curveless = "scene-dependence.json";

/// Returns the uncertainty of ln acuity by contrast, from all rows of the budget that are not common to a series: the
/// half-width of their 95 % interval, as a normal standard deviation. The statistical interval cannot be joined with
/// the stated rows, because it contains the scatter of the contrast, which has a row of its own.
Result<std::map<double, double>> budget_uncertainties(const std::filesystem::path& folder) {
  std::map<double, double> of_budget;
  if (!is_there(folder / "uncertainty.json")) return of_budget;
  TODBENCH_TRY(const auto json, vouched_json(folder, "uncertainty.json"));
  TODBENCH_TRY(const auto budget, uncertainty_from(json));
  for (const PointUncertainty& point : budget.points) {
    JoinedUncertainty sum;
    bool with_trials = false;
    for (const AppliedRow& applied : point.rows) {
      if (std::ranges::find(applied.row.common, BudgetCommon::series) != applied.row.common.end()) continue;
      sum.add(applied.contribution, applied.row.degrees_of_freedom);
      with_trials = with_trials || applied.row.name == finite_trials_row;
    }
    if (with_trials) of_budget[point.set_delta_t_k] = sum.half_width(0.025) / normal_z95;
  }
  return of_budget;
}

/// Returns the contrasts whose threshold is unfit for a decision; they are not used in the history either.
Result<std::vector<double>> unfit_contrasts(const std::filesystem::path& folder) {
  std::vector<double> unfit;
  if (!is_there(folder / "fits.json")) return unfit;
  TODBENCH_TRY(const auto fits, vouched_json(folder, "fits.json"));
  if (!fits.contains("main") || !fits["main"].contains("points")) return unfit;
  for (const Json& point : fits["main"]["points"]) {
    const auto contrast_k = number_at(point, "set_delta_t_k");
    const bool adequate =
        !point.contains("adequacy") || !point["adequacy"].is_object() || point["adequacy"].value("adequate", true);
    if (contrast_k && !adequate) unfit.push_back(*contrast_k);
  }
  return unfit;
}

Result<void> add_acuities(HistorySession& session, const std::filesystem::path& folder, const std::string& side) {
  if (is_there(folder / curveless)) return {};
  TODBENCH_TRY(const auto text, vouched_text(folder, "curve.csv"));
  TODBENCH_TRY(const auto table, parse_csv(text, (folder / "curve.csv").string()));
  TODBENCH_TRY(const auto of_budget, budget_uncertainties(folder));
  TODBENCH_TRY(const auto unfit, unfit_contrasts(folder));
  const auto column = [&](const char* name) { return table.column(name).value_or(table.header.size()); };
  const std::size_t of_side = column("side"), contrast = column("set_delta_t_k"), acuity = column("acuity_per_mrad"),
                    low = column("acuity_ci95_low_per_mrad"), high = column("acuity_ci95_high_per_mrad"),
                    verdict = column("verdict");
  for (const std::size_t index : {of_side, contrast, acuity, low, high, verdict}) {
    if (index >= table.header.size())
      return table.wrong(1,
                         "a column of curve.csv is missing, expected side, set_delta_t_k, acuity_per_mrad, "
                         "acuity_ci95_low_per_mrad, acuity_ci95_high_per_mrad and verdict");
  }
  for (const CsvRow& row : table.rows) {
    if (row.fields[of_side] != side) continue;
    // A ridge, or a slope at its bound, gives no value.
    const std::string& found = row.fields[verdict];
    if (found == "underdetermined" || found == "flat_or_decreasing") continue;
    const auto contrast_k = parse_number(row.fields[contrast]), value = parse_number(row.fields[acuity]),
               from = parse_number(row.fields[low]), to = parse_number(row.fields[high]);
    // Values without uncertainty are not kept.
    if (!contrast_k || !value || !from || !to || !(*value > 0) || !(*from > 0) || !(*to > *from)) continue;
    if (std::ranges::find(unfit, *contrast_k) != unfit.end()) continue;
    const auto budget = of_budget.find(*contrast_k);
    session.values.push_back({"acuity", "dT=" + number_text(*contrast_k) + "K", "1/mrad", "ln", std::log(*value),
                              budget == of_budget.end() ? std::log(*to / *from) / (2 * normal_z95) : budget->second});
  }
  return {};
}

Result<void> add_measures(HistorySession& session, const std::filesystem::path& folder) {
  if (!is_there(folder / "measures.json")) return {};
  TODBENCH_TRY(const auto json, vouched_json(folder, "measures.json"));
  if (!json.contains("main") || !json["main"].is_object() || !json["main"].contains("quantities")) return {};
  for (const Json& line : json["main"]["quantities"]) {
    const auto value = number_at(line, "value");
    if (!value || !line.contains("ci95") || !line["ci95"].is_array() || line["ci95"].size() != 2) continue;
    // Uncertainties of the bench are new for each measurement, for example the distance of an IFOV.
    const bool expanded = line.contains("expanded_ci95") && line["expanded_ci95"].is_array() &&
                          line["expanded_ci95"].size() == line["ci95"].size();
    const Json& interval = expanded ? line["expanded_ci95"] : line["ci95"];
    if (!interval[0].is_number() || !interval[1].is_number()) continue;
    const double u = (interval[1].get<double>() - interval[0].get<double>()) / (2 * normal_z95);
    if (u > 0) session.values.push_back({text_at(line, "measure"), "", text_at(line, "unit"), "linear", *value, u});
  }
  return {};
}

/// Returns the first text with this key. The file may be long, so that it is not parsed.
std::string first_text(const std::string& json, const std::string& name) {
  const std::string key = "\"" + name + "\": \"";
  const std::size_t at = json.find(key);
  const std::size_t from = at == std::string::npos ? json.size() : at + key.size();
  return json.substr(from, json.find('"', from) - from);
}

/// Who was measured by whom, as stated at the end of the run.
struct CurveNames {
  std::string sensor, observer;
};

/// Names of the curve; of a session without a curve the camera in its own file.
Result<CurveNames> names_of(const std::filesystem::path& folder) {
  if (is_there(folder / curveless)) {
    TODBENCH_TRY(const auto json, vouched_json(folder, curveless));
    return CurveNames{text_at(json, "camera"), ""};
  }
  TODBENCH_TRY(const auto fits, vouched_text(folder, "fits.json"));
  return CurveNames{first_text(fits, "sensor"), first_text(fits, "observer")};
}

/// Returns the unit in the words of the plan, if many units share the serial number.
Result<std::string> unit_without_serial(const std::filesystem::path& folder, const std::string& serial) {
  TODBENCH_TRY(const auto text, vouched_text(folder, "session.toml"));
  TODBENCH_TRY(auto plan, TomlReader::parse(text, "session.toml"));
  const std::string unit = plan.text("unit", "");
  if (!unit.empty()) return "unit:" + unit;
  return fail(ErrorCode::invalid_input,
              folder.string() + ": the camera's serial number " + one_line(serial) +
                  " is a placeholder that many units share, and the plan of the session does not state 'unit'");
}

Result<void> set_unit(HistorySession& session, const std::filesystem::path& folder, const Json& provenance) {
  TODBENCH_TRY(const auto names, names_of(folder));
  const std::string& sensor = names.sensor;
  session.observer = names.observer;
  if (!provenance.contains("camera") || !provenance["camera"].is_object()) {
    session.unit = {"simulation", sensor, "", ""};
    return {};
  }
  const Json& camera = provenance["camera"];
  session.unit = {text_at(camera, "vendor"), text_at(camera, "model"), text_at(camera, "serial"), lens_of(camera)};
  session.firmware = text_at(camera, "firmware");
  if (session.unit.serial.empty())
    return fail(ErrorCode::invalid_input, folder.string() + ": the camera has no serial number");
  if (!sensor.ends_with(session.unit.serial)) {
    return fail(ErrorCode::invalid_input, folder.string() + ": the session began with serial number " +
                                              one_line(session.unit.serial) + ", but its curve belongs to '" +
                                              one_line(sensor) + "'");
  }
  if (is_placeholder_serial(session.unit.serial)) {
    TODBENCH_TRY(session.unit.serial, unit_without_serial(folder, session.unit.serial));
  }
  return {};
}

}  // namespace

std::string stated_condition(const HistorySession& session, const HistoryValue& value) {
  const bool named = value.measure == "acuity" && !session.observer.empty() && session.observer != "hvs-1";
  return value.condition + (named ? " observer " + session.observer : "");
}

Result<HistorySession> read_history_session(const std::filesystem::path& folder) {
  TODBENCH_TRY(auto digest, manifest_digest(folder));
  TODBENCH_TRY(const auto provenance, vouched_json(folder, "provenance.json"));
  HistorySession session;
  session.manifest_sha256 = std::move(digest);
  std::error_code problem;
  const auto absolute = std::filesystem::weakly_canonical(folder, problem);
  session.path = (problem ? folder : absolute).string();
  session.started_utc = text_at(provenance, "started_utc");
  session.program = text_at(provenance, "program_version");
  session.state = text_at(provenance, "state");
  if (provenance.contains("origin") && provenance["origin"].is_object()) {
    const Json& origin = provenance["origin"];
    session.judged_again = !(origin.contains("resumed") && origin["resumed"] == true);
    if (!session.judged_again) session.resumes_sha256 = text_at(origin, "manifest_sha256");
  }
  if (!days_of_utc(session.started_utc))
    return fail(ErrorCode::invalid_input,
                (folder / "provenance.json").string() + ": started_utc is missing or is not a time in UTC");
  TODBENCH_TRY_VOID(set_unit(session, folder, provenance));
  TODBENCH_TRY_VOID(add_acuities(session, folder, text_at(provenance, "side")));
  TODBENCH_TRY_VOID(add_measures(session, folder));
  return session;
}

Result<std::vector<std::filesystem::path>> session_folders_below(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> found;
  std::error_code problem;
  if (!std::filesystem::is_directory(folder, problem))
    return fail(ErrorCode::not_found, folder.string() + ": no such folder");
  if (is_there(folder / "session.toml")) return std::vector{folder};
  auto entry = std::filesystem::recursive_directory_iterator(
      folder, std::filesystem::directory_options::skip_permission_denied, problem);
  for (const auto end = std::filesystem::recursive_directory_iterator(); !problem && entry != end;
       entry.increment(problem)) {
    std::error_code ignored;
    if (!entry->is_directory(ignored) || entry->is_symlink(ignored)) continue;
    if (!is_there(entry->path() / "session.toml")) continue;
    found.push_back(entry->path());
    entry.disable_recursion_pending();
  }
  if (problem) return fail(ErrorCode::io, folder.string() + ": " + problem.message());
  std::sort(found.begin(), found.end());
  return found;
}

std::optional<double> days_of_utc(const std::string& utc) {
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0;
  char zone = 0;
  if (std::sscanf(utc.c_str(), "%4d-%2d-%2dT%2d:%2d:%2d%c", &year, &month, &day, &hour, &minute, &second, &zone) != 7 ||
      zone != 'Z')
    return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!date.ok()) return std::nullopt;
  return static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count()) + hour / 24.0 + minute / 1440.0 +
         second / 86400.0;
}

std::string date_of_days(double days) {
  const double within = std::clamp(days, -719162.0, 2932896.0);  // years 1 to 9999
  const std::chrono::year_month_day date{
      std::chrono::sys_days(std::chrono::days(static_cast<int>(std::floor(within))))};
  char text[16];
  std::snprintf(text, sizeof text, "%04d-%02u-%02u", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                static_cast<unsigned>(date.day()));
  return text;
}

Result<void> verify_history_session(const std::filesystem::path& folder) {
  TODBENCH_TRY(const SessionCheck check, check_session(folder));
  if (check.not_vouched_for.empty()) return {};
  return fail(ErrorCode::invalid_input, folder.string() + ": the session was changed: " + check.sentence);
}

}  // namespace todbench
