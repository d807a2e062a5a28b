// SPDX-License-Identifier: GPL-3.0-or-later
// todbench history add, show, check, prior, export, event
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <tuple>

#include "bench/cli/commands.h"
#include "bench/history/control_chart.h"
#include "bench/history/fleet_history.h"
#include "bench/history/history_index.h"
#include "bench/history/history_series.h"
#include "bench/judgement/verdict.h"
#include "bench/session/manifest.h"
#include "bench/session/provenance.h"
#include "bench/text/files.h"
#include "bench/text/spreadsheet.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

struct HistoryArguments {
  std::string index{default_history_file().string()};
  std::vector<std::string> folders;
  std::string serial, measure, kind, text, utc, out, model, vendor, lens;
  std::optional<double> at_least, at_most;
  double horizon_days = 365;
};

/// Kinds of events that start a new series, because the unit has changed.
constexpr std::array begins_anew{"repair", "firmware", "recalibration", "transport"};

Json unit_json(const HistoryUnit& unit) {
  return {{"vendor", unit.vendor}, {"model", unit.model}, {"serial", unit.serial}, {"lens", unit.lens}};
}

double months_between(const HistorySeries& series) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < series.values.size(); ++i)
    gaps.push_back(series.values[i].days - series.values[i - 1].days);
  if (gaps.empty()) return 0;
  std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2), gaps.end());
  return gaps[gaps.size() / 2] / 30.436875;
}

/// Returns the limit, on the scale of the chart.
std::optional<double> limit_of(const HistorySeries& series, const HistoryArguments& a) {
  const auto& limit = a.at_least ? a.at_least : a.at_most;
  if (!limit) return std::nullopt;
  return series.scale == "ln" ? std::log(*limit) : *limit;
}

Json crossing_json(const LimitCrossing& found) {
  const auto date = [](const std::optional<double>& days) { return days ? Json(date_of_days(*days)) : Json(); };
  return {{"kind", to_string(found.kind)},
          {"slope_per_year", json_number(found.slope_per_year)},
          {"slope_u_per_year", json_number(found.slope_u_per_year)},
          {"best", date(found.best_days)},
          {"not_before", date(found.earliest_days)},
          {"not_after", date(found.latest_days)}};
}

Json chart_json(const HistorySeries& series, const HistoryArguments& a) {
  const ChartDesign design;
  Json json{{"unit", unit_json(series.unit)}, {"measure", series.measure}, {"condition", series.condition},
            {"unit_text", series.unit_text},  {"scale", series.scale},     {"values", Json::array()},
            {"earlier", Json::array()}};
  for (const EarlierValue& earlier : series.earlier) {
    json["earlier"].push_back({{"started_utc", earlier.started_utc},
                               {"value", json_number(shown_value(series, earlier.value.value))},
                               {"u", json_number(earlier.value.u)},
                               {"ended_by", earlier.ended_by}});
  }
  const auto chart = control_chart(series.values, design);
  for (std::size_t i = 0; i < series.values.size(); ++i) {
    Json value{{"started_utc", series.started_utc[i]},
               {"value", json_number(shown_value(series, series.values[i].value))},
               {"u", json_number(series.values[i].u)}};
    if (chart) {
      const ChartPoint& point = chart->points[i];
      value["z"] = json_number(point.z);
      value["ewma"] = json_number(point.ewma);
      value["ewma_limit"] = point.in_reference ? Json() : json_number(point.ewma_limit);
      value["cusum_up"] = json_number(point.cusum_up);
      value["cusum_down"] = json_number(point.cusum_down);
      value["signal"] = point.signal;
    }
    json["values"].push_back(std::move(value));
  }
  json["chart"] = nullptr;
  if (chart) {
    const double months = months_between(series);
    json["chart"] = {{"reference", json_number(shown_value(series, chart->reference))},
                     {"reference_u", json_number(chart->reference_u)},
                     {"scatter", json_number(chart->scatter)},
                     {"signal", chart->signalled()},
                     {"run_length_months",
                      {{"ewma_in_control", json_number(months * ewma_run_length(design.lambda, design.ewma_limit, 0))},
                       {"ewma_one_sd", json_number(months * ewma_run_length(design.lambda, design.ewma_limit, 1))},
                       {"cusum_in_control", json_number(months * cusum_run_length(design.cusum_k, design.cusum_h, 0))},
                       {"cusum_one_sd", json_number(months * cusum_run_length(design.cusum_k, design.cusum_h, 1))}}}};
  }
  json["crossing"] = nullptr;
  if (const auto limit = limit_of(series, a)) {
    if (const auto found = crossing(series.values, chart ? chart->scatter : 0, *limit))
      json["crossing"] = crossing_json(*found);
  }
  return json;
}

int run_add(Console& console, const HistoryArguments& a) {
  auto index = HistoryIndex::open(a.index);
  if (!index) return report_error(console, index.error());
  std::map<Adding, int> number;
  std::vector<std::string> refused;
  for (const std::string& folder : a.folders) {
    const auto sessions = session_folders_below(folder);
    if (!sessions) return report_error(console, sessions.error());
    if (sessions->empty()) refused.push_back(folder + ": contains no session folder");
    for (const auto& one : *sessions) {
      const auto session = verified_session(*index, one);
      if (!session) {
        refused.push_back(session.error().message);
        continue;
      }
      const auto done = index->add(*session);
      if (!done) return report_error(console, done.error());
      ++number[*done];
    }
  }
  for (const std::string& sentence : refused) console.note(sentence);
  const int added = number[Adding::added], known = number[Adding::known], moved = number[Adding::moved],
            again = number[Adding::judged_again];
  if (again > 0) {
    console.note("sessions not added, because they judge the frames of other sessions again: " + std::to_string(again));
  }
  if (console.json()) {
    console.object({{"index", a.index},
                    {"added", added},
                    {"known", known},
                    {"moved", moved},
                    {"judged_again", again},
                    {"refused", refused}});
  } else {
    console.text("added " + std::to_string(added) + ", known " + std::to_string(known) + ", moved " +
                 std::to_string(moved) + ", judged again " + std::to_string(again) + ", refused " +
                 std::to_string(refused.size()));
  }
  return refused.empty() ? 0 : exit_code(ErrorCode::invalid_input);
}

int show_units(Console& console, const HistoryIndex& index) {
  const auto sessions = index.sessions(std::nullopt);
  if (!sessions) return report_error(console, sessions.error());
  struct Line {
    HistoryUnit unit;
    int sessions;
    std::string first, last;
  };
  std::vector<Line> lines;
  for (const HistorySession& session : *sessions) {
    if (lines.empty() || !(lines.back().unit == session.unit))
      lines.push_back({session.unit, 0, session.started_utc, session.started_utc});
    ++lines.back().sessions;
    lines.back().last = session.started_utc;
  }
  if (console.json()) {
    Json units = Json::array();
    for (const Line& line : lines) {
      Json unit = unit_json(line.unit);
      unit["sessions"] = line.sessions;
      unit["first_utc"] = line.first;
      unit["last_utc"] = line.last;
      units.push_back(std::move(unit));
    }
    console.object({{"units", units}});
    return 0;
  }
  std::vector<TableRow> rows;
  for (const Line& line : lines) {
    rows.push_back({line.unit.vendor, line.unit.model, line.unit.serial, line.unit.lens, std::to_string(line.sessions),
                    line.first, line.last});
  }
  console.table({"vendor", "model", "serial", "lens", "sessions", "first", "last"}, rows);
  return 0;
}

int run_show(Console& console, const HistoryArguments& a) {
  const auto index = HistoryIndex::open(a.index);
  if (!index) return report_error(console, index.error());
  if (a.serial.empty()) return show_units(console, *index);
  const auto all = history_series(*index, a.serial, a.measure, WithoutChart::listed);
  if (!all) return report_error(console, all.error());
  const auto events = index->events(a.serial);
  if (!events) return report_error(console, events.error());
  if (all->empty())
    return report_error(console, {ErrorCode::not_found, a.serial + ": no values of this unit in the index " + a.index});
  if (console.json()) {
    Json charts = Json::array();
    for (const HistorySeries& series : *all) charts.push_back(chart_json(series, a));
    Json listed = Json::array();
    for (const HistoryEvent& event : *events)
      listed.push_back({{"utc", event.utc}, {"kind", event.kind}, {"text", event.text}});
    console.object({{"charts", charts}, {"events", listed}});
    return 0;
  }
  std::vector<TableRow> rows;
  for (const HistorySeries& series : *all) {
    const std::string name = series.measure + (series.condition.empty() ? "" : " " + series.condition) +
                             (series.unit_text.empty() ? "" : " [" + series.unit_text + "]");
    const auto add = [&](const std::string& started_utc, const ChartValue& value, const ChartPoint* point,
                         const std::string& state) {
      const bool charted = point != nullptr && !point->in_reference;
      // An uncertainty of ln x is relative.
      const double shown = shown_value(series, value.value), u = series.scale == "ln" ? value.u * shown : value.u;
      rows.push_back({name, started_utc, fixed(shown, 4), fixed(u, 4),
                      charted ? fixed(point->ewma, 2) + " of " + fixed(point->ewma_limit, 2) : "",
                      charted ? fixed(point->cusum_up, 1) + ", " + fixed(point->cusum_down, 1) : "", state});
    };
    for (const EarlierValue& earlier : series.earlier)
      add(earlier.started_utc, earlier.value, nullptr, "before " + earlier.ended_by);
    const auto chart = control_chart(series.values, ChartDesign());
    for (std::size_t i = 0; i < series.values.size(); ++i) {
      const ChartPoint* point = chart ? &chart->points[i] : nullptr;
      add(series.started_utc[i], series.values[i], point,
          point == nullptr      ? ""
          : point->in_reference ? "reference"
          : point->signal       ? "ALARM"
                                : "in control");
    }
  }
  console.table({"measure", "started", "value", "u", "EWMA (sd)", "CUSUM up, down (sd)", "state"}, rows);
  return 0;
}

/// Returns the reasons why sessions are not as they were added: a manifest that differs from the index, and files that
/// are missing or differ from the manifest.
std::vector<std::string> changed_sessions(const std::vector<HistorySession>& sessions) {
  std::vector<std::string> reasons;
  for (const HistorySession& session : sessions) {
    const auto check = check_manifest(session.path);
    if (!check || check->manifest_sha256 != session.manifest_sha256) {
      reasons.push_back(session.path + ": the session is missing or has changed since it was added");
      continue;
    }
    for (const auto& [files, problem] :
         {std::pair(&check->changed, "has changed since it was written"), std::pair(&check->missing, "is missing"),
          std::pair(&check->links, "is a symbolic link")}) {
      for (const std::string& file : *files) reasons.push_back(session.path + ": " + one_line(file) + " " + problem);
    }
  }
  return reasons;
}

/// Rejects a check of units that are not in the index, or against an impossible limit: it could not report anything.
Result<void> can_be_checked(const std::vector<HistorySession>& sessions, const HistoryArguments& a) {
  if (!a.serial.empty() && sessions.empty())
    return fail(ErrorCode::not_found, a.serial + ": no unit with this serial number in the index " + a.index);
  if (a.measure.empty()) return {};
  const auto limit = a.at_least ? a.at_least : a.at_most;
  bool known = false;
  for (const HistorySession& session : sessions) {
    for (const HistoryValue& value : session.values) {
      if (value.measure != a.measure) continue;
      known = true;
      if (limit && (!std::isfinite(*limit) || (value.scale == "ln" && !(*limit > 0))))
        return fail(ErrorCode::invalid_input,
                    "history check: expected a finite limit of " + a.measure + (value.scale == "ln" ? " above 0" : ""));
    }
  }
  if (!known)
    return fail(ErrorCode::not_found, "no value of measure '" + one_line(a.measure) + "' in the index " + a.index);
  return {};
}

int run_check(Console& console, const HistoryArguments& a) {
  if (a.at_least && a.at_most)
    return report_error(console,
                        {ErrorCode::invalid_input, "history check: --at-least and --at-most exclude each other"});
  if ((a.at_least || a.at_most) && a.measure.empty())
    return report_error(console, {ErrorCode::invalid_input, "history check: --at-least and --at-most need --measure"});
  const auto index = HistoryIndex::open(a.index);
  if (!index) return report_error(console, index.error());
  const auto sessions = index->sessions(a.serial.empty() ? std::nullopt : std::optional(a.serial));
  if (!sessions) return report_error(console, sessions.error());
  if (auto possible = can_be_checked(*sessions, a); !possible) return report_error(console, possible.error());
  const auto all = history_series(*index, a.serial, a.measure);
  if (!all) return report_error(console, all.error());
  std::vector<std::string> warnings = changed_sessions(*sessions), predicted;
  for (const HistorySeries& series : *all) {
    const std::string name = series.unit.model + " " + series.unit.serial + ", " + series.measure +
                             (series.condition.empty() ? "" : " at " + series.condition);
    const auto chart = control_chart(series.values, {});
    if (chart && chart->signalled()) warnings.push_back(name + ": a value is beyond the limits of the control chart");
    const auto limit = limit_of(series, a);
    if (!limit) continue;
    const double last = series.values.back().value;
    if (a.at_least ? last < *limit : last > *limit) {
      predicted.push_back(name + ": the last value is beyond the limit");
      continue;
    }
    const auto found = crossing(series.values, chart ? chart->scatter : 0, *limit);
    if (found && found->kind == CrossingKind::found && found->best_days &&
        *found->best_days <= series.values.back().days + a.horizon_days) {
      predicted.push_back(name + ": predicted to reach the limit about " + date_of_days(*found->best_days) +
                          ", not before " + date_of_days(*found->earliest_days) + " (95 %)");
    }
  }
  const int code = !predicted.empty() ? exit_code(VerdictKind::fail)
                                      : exit_code(warnings.empty() ? VerdictKind::pass : VerdictKind::inconclusive);
  if (console.json()) {
    console.object({{"warnings", warnings}, {"limits_ahead", predicted}});
  } else {
    for (const std::string& sentence : warnings) console.text("warning: " + sentence);
    for (const std::string& sentence : predicted) console.text("limit: " + sentence);
    if (code == 0) console.text("nothing to report");
  }
  return code;
}

int run_export(Console& console, const HistoryArguments& a) {
  const auto index = HistoryIndex::open(a.index);
  if (!index) return report_error(console, index.error());
  const auto sessions = index->sessions(a.serial.empty() ? std::nullopt : std::optional(a.serial));
  if (!sessions) return report_error(console, sessions.error());
  std::string csv = "vendor,model,serial,lens,firmware,started_utc,state,measure,condition,unit,scale,value,u,path\n";
  for (const HistorySession& s : *sessions) {
    for (const HistoryValue& v : s.values) {
      for (const std::string& field : {s.unit.vendor, s.unit.model, s.unit.serial, s.unit.lens, s.firmware,
                                       s.started_utc, s.state, v.measure, v.condition, v.unit, v.scale})
        csv += spreadsheet_field(field) + ",";
      csv += number_text(v.value) + "," + number_text(v.u) + "," + spreadsheet_field(s.path) + "\n";
    }
  }
  if (a.out.empty()) {
    csv.pop_back();
    console.text(csv);
    return 0;
  }
  if (auto written = write_file_atomically(a.out, csv); !written) return report_error(console, written.error());
  console.note("written: " + a.out);
  return 0;
}

int run_event(Console& console, const HistoryArguments& a) {
  const std::string utc = a.utc.empty() ? utc_now() : a.utc;
  if (!days_of_utc(utc))
    return report_error(console, {ErrorCode::invalid_input,
                                  "--utc: expected \"YYYY-MM-DDTHH:MM:SSZ\", found \"" + one_line(utc) + "\""});
  auto index = HistoryIndex::open(a.index);
  if (!index) return report_error(console, index.error());
  if (auto added = index->add_event({a.serial, utc, a.kind, a.text}); !added)
    return report_error(console, added.error());
  console.note("recorded: " + a.kind + " of " + a.serial + ", " + utc);
  return 0;
}

int run_prior(Console& console, const HistoryArguments& a) {
  const auto index = HistoryIndex::open(a.index);
  if (!index) return report_error(console, index.error());
  auto fleets = fleets_of(*index, {a.vendor, a.model, a.lens, a.serial});
  if (!fleets) return report_error(console, fleets.error());
  if (!a.measure.empty())
    std::erase_if(*fleets, [&](const FleetFound& found) { return found.row.measure != a.measure; });
  const bool none =
      std::all_of(fleets->begin(), fleets->end(), [](const auto& found) { return !found.refused.empty(); });
  if (none) {
    const std::string why = fleets->empty() ? "no value of measure '" + one_line(a.measure) + "'"
                                            : fleets->front().row.measure + ": " + fleets->front().refused;
    return report_error(console, {ErrorCode::invalid_input, one_line(a.model) + ": no prior; " + why});
  }
  if (!a.out.empty()) {
    if (auto written = write_file_atomically(a.out, fleets_toml(*fleets)); !written)
      return report_error(console, written.error());
    console.note("written: " + a.out);
  }
  if (console.json()) {
    Json listed = Json::array(), refused = Json::array();
    for (const FleetFound& found : *fleets) {
      const FleetRow& row = found.row;
      if (!found.refused.empty()) {
        refused.push_back(
            {{"measure", row.measure}, {"delta_t_k", json_number(row.delta_t_k)}, {"why", found.refused}});
        continue;
      }
      const SpreadInterval spread = spread_interval(prior_of(row));
      listed.push_back({{"measure", row.measure},
                        {"delta_t_k", json_number(row.delta_t_k)},
                        {"unit_text", found.unit_text},
                        {"mean", json_number(row.mean)},
                        {"sd", json_number(row.sd)},
                        {"sd_ci95", {json_number(spread.low), json_number(spread.high)}},
                        {"u", json_number(row.u)},
                        {"units", row.units},
                        {"first_utc", found.first_utc},
                        {"last_utc", found.last_utc}});
    }
    console.object({{"fleets", listed}, {"refused", refused}});
  } else if (a.out.empty()) {
    std::string toml = fleets_toml(*fleets);
    toml.resize(toml.find_last_not_of('\n') + 1);
    console.text(toml);
  }
  return 0;
}

}  // namespace

void add_history_command(CLI::App& app, Program& program) {
  auto* history =
      app.add_subcommand("history", "keeps the sessions of each unit over the years: control charts and drift");
  history->require_subcommand(1);
  const auto begun = [&](const char* name, const char* sentence) {
    auto* command = history->add_subcommand(name, sentence);
    auto a = std::make_shared<HistoryArguments>();
    command
        ->add_option("--index", a->index,
                     "file of the index, which 'history add' can create again from the session folders")
        ->capture_default_str();
    return std::pair(command, a);
  };
  {
    const auto [command, a] =
        begun("add", "adds session folders, or all session folders below a folder; known sessions are left unchanged");
    command->add_option("DIR", a->folders, "session folders, or folders that contain them")->required();
    finish_command(*command, program, [a = a](Console& console) { return run_add(console, *a); });
  }
  {
    const auto [command, a] = begun("show", "lists the units, or the values and charts of one unit");
    auto* serial = command->add_option("SERIAL", a->serial, "serial number; default: list of all units");
    command->add_option("--measure", a->measure, "measure, for example acuity or netd; default: all")->needs(serial);
    command->add_option("--at-least", a->at_least, "lower limit; predicts when the measure crosses it")
        ->check(number_in(-1e12, 1e12))
        ->needs(serial);
    command->add_option("--at-most", a->at_most, "upper limit; predicts when the measure crosses it")
        ->check(number_in(-1e12, 1e12))
        ->needs(serial)
        ->excludes("--at-least");
    finish_command(*command, program, [a = a](Console& console) { return run_show(console, *a); });
  }
  {
    const auto [command, a] =
        begun("check", "checks for changed sessions, alarms of the control charts and limits that are reached soon");
    command->add_option("SERIAL", a->serial, "serial number; default: all units");
    command->add_option("--measure", a->measure, "measure, for example acuity or netd; default: all");
    command->add_option("--at-least", a->at_least, "lower limit of the measure")->check(number_in(-1e12, 1e12));
    command->add_option("--at-most", a->at_most, "upper limit of the measure")->check(number_in(-1e12, 1e12));
    command->add_option("--horizon-days", a->horizon_days, "reports limits that are reached within this number of days")
        ->check(number_in(0, 36525))
        ->capture_default_str();
    finish_command(*command, program, [a = a](Console& console) { return run_check(console, *a); });
  }
  {
    const auto [command, a] =
        begun("prior", "computes a prior for the next unit from the units of the same model, as rows of a plan");
    command->add_option("MODEL", a->model, "model of the cameras")->required();
    command->add_option("--vendor", a->vendor, "vendor; required if several vendors have this model");
    command->add_option("--lens", a->lens, "lens; required if the units have different lenses");
    command->add_option("--without", a->serial, "serial number of the unit to be judged, which the prior must exclude");
    command->add_option("--measure", a->measure, "measure, for example acuity or netd; default: all");
    command->add_option("--out", a->out, "file for the rows; default: standard output");
    finish_command(*command, program, [a = a](Console& console) { return run_prior(console, *a); });
  }
  {
    const auto [command, a] = begun("export", "writes every value as CSV");
    command->add_option("SERIAL", a->serial, "serial number; default: all units");
    command->add_option("--out", a->out, "CSV file; default: standard output");
    finish_command(*command, program, [a = a](Console& console) { return run_export(console, *a); });
  }
  {
    const auto [command, a] = begun("event", "records an event of a unit; its charts begin anew after the event");
    command->add_option("SERIAL", a->serial, "serial number of the unit")->required();
    command->add_option("--kind", a->kind, "kind of the event: repair, firmware, recalibration or transport")
        ->required()
        ->check(CLI::IsMember(std::vector<std::string>(begins_anew.begin(), begins_anew.end())));
    command->add_option("--text", a->text, "description of the event");
    command->add_option("--utc", a->utc, "time of the event, YYYY-MM-DDTHH:MM:SSZ; default: now");
    finish_command(*command, program, [a = a](Console& console) { return run_event(console, *a); });
  }
}

}  // namespace todbench
