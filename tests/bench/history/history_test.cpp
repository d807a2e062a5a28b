// SPDX-License-Identifier: GPL-3.0-or-later
// Charts against their references, and the index against the folders that it is made from.
#include <gmock/gmock.h>
#include <sqlite3.h>

#include <cmath>
#include <fstream>
#include <map>
#include <string>

#include "bench/history/control_chart.h"
#include "bench/history/fleet_history.h"
#include "bench/history/history_index.h"
#include "bench/history/history_series.h"
#include "bench/plan/budget_row.h"
#include "bench/session/manifest.h"
#include "bench/session/uncertainty_record.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"
#include "tests/tod/measures/measures_reference.h"

namespace todbench {
namespace {

using testing::content_of;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

std::optional<double> number(const nlohmann::json& json) {
  return json.is_null() ? std::nullopt : std::optional(json.get<double>());
}

TEST(RunLength, IsThatOfTheReference) {
  for (const auto& reference : test::reference_cases("conformity", "run_lengths")) {
    const double shift = reference["shift_sd"], expected = reference["average_run_length"];
    const double found = reference.contains("weight")
                             ? ewma_run_length(reference["weight"], reference["limit_in_sd"], shift)
                             : cusum_run_length(reference["reference_value"], reference["decision_interval"], shift);
    EXPECT_NEAR(found, expected, 1e-7 * expected) << reference.dump();
  }
}

std::vector<ChartValue> values_of(const nlohmann::json& reference) {
  std::vector<ChartValue> values;
  for (std::size_t i = 0; i < reference["day"].size(); ++i)
    values.push_back({reference["day"][i], reference["value"][i], reference["standard_uncertainty"][i]});
  return values;
}

TEST(ControlChart, IsThatOfTheReference) {
  for (const auto& reference : test::reference_cases("conformity", "series")) {
    const ChartDesign design{.lambda = reference["ewma_weight"],
                             .ewma_limit = reference["ewma_limit_factor"],
                             .cusum_k = reference["cusum_reference_value"],
                             .cusum_h = reference["cusum_decision_interval"],
                             .reference = reference["reference"].get<double>(),
                             .scatter = reference["between_sd"].get<double>()};

    const auto chart = control_chart(values_of(reference), design);

    ASSERT_TRUE(chart);
    for (std::size_t i = 0; i < chart->points.size(); ++i) {
      const ChartPoint& point = chart->points[i];
      EXPECT_NEAR(point.z, reference["standardised"][i].get<double>(), 1e-8);
      EXPECT_NEAR(point.ewma, reference["ewma"][i].get<double>(), 1e-8);
      EXPECT_NEAR(point.ewma_limit, reference["ewma_limit"][i].get<double>(), 1e-8);
      EXPECT_NEAR(point.cusum_up, reference["cusum_high"][i].get<double>(), 1e-8);
      EXPECT_NEAR(point.cusum_down, reference["cusum_low"][i].get<double>(), 1e-8);
    }
  }
}

TEST(LimitCrossing, HasTheLineOfTheReference) {
  for (const auto& reference : test::reference_cases("conformity", "series")) {
    const auto found =
        crossing(values_of(reference), reference["between_sd"].get<double>(), reference["limit"].get<double>());

    ASSERT_TRUE(found);
    EXPECT_NEAR(found->slope_per_year / 365.25, reference["slope_per_day"].get<double>(), 1e-11);
    EXPECT_NEAR(found->slope_u_per_year / 365.25, reference["slope_se"].get<double>(), 1e-11);
    const auto day = number(reference["crossing_day"]);
    EXPECT_EQ(found->best_days.has_value(), day.has_value());
    if (day) {
      EXPECT_NEAR(*found->best_days, *day, 1e-4);
    }
  }
}

TEST(LimitCrossing, IsFoundBetweenTheEndsOfFieller) {
  // x = 0.5 - 0.0002 t without scatter of the points: met at day 500.
  std::vector<ChartValue> values;
  for (int i = 0; i < 12; ++i) values.push_back({30.0 * i, 0.5 - 0.0002 * 30 * i, 0.005});

  const auto found = crossing(values, 0, 0.4);

  ASSERT_TRUE(found);
  EXPECT_EQ(found->kind, CrossingKind::found);
  EXPECT_NEAR(found->best_days.value(), 500, 1e-9);
  // Both ends satisfy the equality of Fieller.
  double w = 0, mean = 0, stt = 0;
  for (const ChartValue& value : values) w += 1 / 0.000025, mean += value.days / 12;
  for (const ChartValue& value : values) stt += std::pow(value.days - mean, 2) / 0.000025;
  for (const double t : {found->earliest_days.value(), found->latest_days.value()}) {
    const double distance = 0.5 - 0.0002 * t - 0.4;
    EXPECT_NEAR(distance * distance, 1.959963984540054 * 1.959963984540054 * (1 / w + std::pow(t - mean, 2) / stt),
                1e-12);
  }
}

TEST(LimitCrossing, IsOpenWhereTheSlopeMayBeNone) {
  const std::vector<ChartValue> level{{0, 0.5, 0.01}, {30, 0.501, 0.01}, {60, 0.4995, 0.01}};

  const auto found = crossing(level, 0, 0.4);

  ASSERT_TRUE(found);
  EXPECT_EQ(found->kind, CrossingKind::not_before);
  EXPECT_GT(found->earliest_days.value(), 60);
  EXPECT_FALSE(found->latest_days);
  EXPECT_FALSE(crossing({{0, 1, 1}, {0, 1, 1}, {0, 1, 1}}, 0, 2));
}

class History : public ::testing::Test {
 protected:
  std::filesystem::path session(const std::string& name) const {
    const auto folder = folder_.path() / name;
    std::filesystem::create_directories(folder.parent_path());
    std::filesystem::copy(source_file("tests/golden/session-0.1"), folder, std::filesystem::copy_options::recursive);
    return folder;
  }
  [[nodiscard]] std::filesystem::path file() const { return folder_.path() / "index" / "history.sqlite"; }
  TemporaryFolder folder_;
};

TEST_F(History, KnowsASessionByItsManifestAndFindsItWhereItWasMoved) {
  const auto folder = session("all/a");
  auto index = HistoryIndex::open(file());
  ASSERT_TRUE(index) << index.error().message;
  const auto found = session_folders_below(folder_.path() / "all");
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 1u);

  EXPECT_EQ(index->add(*read_history_session(found->front())).value(), Adding::added);
  EXPECT_EQ(index->add(*read_history_session(found->front())).value(), Adding::known);
  EXPECT_EQ(index->add(*read_history_session(session("copy"))).value(), Adding::known);
  EXPECT_THAT(index->sessions(std::nullopt)->front().path, HasSubstr("all/a"));
  std::filesystem::rename(folder, folder_.path() / "all/b");
  EXPECT_EQ(index->add(*read_history_session(folder_.path() / "all/b")).value(), Adding::moved);

  const auto sessions = index->sessions(std::nullopt);
  ASSERT_TRUE(sessions) << sessions.error().message;
  ASSERT_EQ(sessions->size(), 1u);
  EXPECT_THAT(sessions->front().path, HasSubstr("all/b"));
  EXPECT_EQ(sessions->front().unit.vendor, "simulation");
  ASSERT_FALSE(sessions->front().values.empty());
  // 0.4929 with 0.4241 to 0.5768 in curve.csv at 16.9 K.
  const HistoryValue& acuity = sessions->front().values.front();
  EXPECT_EQ(acuity.measure, "acuity");
  EXPECT_NEAR(std::exp(acuity.value), 0.49288, 1e-5);
  EXPECT_NEAR(acuity.u, std::log(0.57682673 / 0.42409196) / (2 * 1.96), 1e-5);
}

/// Replaces the first place of a text in a file.
void change(const std::filesystem::path& file, const std::string& from, const std::string& to) {
  std::string text = content_of(file);
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << file;
  std::ofstream(file, std::ios::binary) << text.replace(at, from.size(), to);
}

/// Makes the session one of a camera with this serial number.
void give_camera(const std::filesystem::path& folder, const std::string& serial, const std::string& unit) {
  change(folder / "provenance.json", "\"camera\": null",
         R"("camera": {"vendor": "Topdon", "model": "TC001", "serial": ")" + serial + R"("})");
  change(folder / "fits.json", R"("sensor": "sc2000")", R"("sensor": "v4l2:Topdon-TC001-)" + serial + "\"");
  change(folder / "session.toml", "unit = \"\"", "unit = \"" + unit + "\"");
  ASSERT_TRUE(write_manifest(folder));
}

// The statistical interval contains the scatter of the contrast, whose row must not be counted a second time.
TEST_F(History, TakesTheUncertaintyOfTheRowsThatAreNotCommonToASeries) {
  const auto folder = session("a");
  const auto row = [](std::string_view name, double u, std::optional<double> freedom, bool of_series) {
    AppliedRow applied;
    applied.row.name = name;
    applied.row.degrees_of_freedom = freedom;
    if (of_series) applied.row.common = {BudgetCommon::series};
    applied.contribution = u;
    return applied;
  };
  CurveUncertainty budget;
  budget.points.push_back({.set_delta_t_k = 16.9,
                           .rows = {row(finite_trials_row, 0.004, 9, false), row(seen_contrast_row, 0.012, 7, false),
                                    row("form", 0.003, std::nullopt, false), row("certificate", 0.05, 50, true)},
                           .u_stated = 0.0515,
                           .u_not_series = 0.0124});
  std::ofstream(folder / "uncertainty.json", std::ios::binary) << uncertainty_record(budget)->dump();
  ASSERT_TRUE(write_manifest(folder));

  const auto found = read_history_session(folder);

  ASSERT_TRUE(found) << found.error().message;
  // u = sqrt(0.004^2 + 0.012^2 + 0.003^2) = 0.013; nu = 0.013^4 / (0.004^4 / 9 + 0.012^4 / 7) = 9.55; the quantile of t
  // there is 2.2424.
  EXPECT_NEAR(found->values.front().u, 0.013 * 2.2424 / 1.95996, 1e-5);
}

TEST_F(History, CountsNoFrameTwiceAndMixesNoObservers) {
  const auto measured = session("measured"), judged = session("judged"), by_another = session("by_another");
  change(judged / "provenance.json", "\"camera\": null", R"("camera": null, "origin": {"session": "measured"})");
  change(by_another / "fits.json", R"("observer": "hvs-1")", R"("observer": "hvs-2")");
  for (const auto& folder : {judged, by_another}) ASSERT_TRUE(write_manifest(folder));
  auto index = HistoryIndex::open(file());
  ASSERT_TRUE(index) << index.error().message;

  EXPECT_EQ(index->add(*read_history_session(measured)).value(), Adding::added);
  EXPECT_EQ(index->add(*read_history_session(judged)).value(), Adding::judged_again);
  EXPECT_EQ(index->add(*read_history_session(by_another)).value(), Adding::added);

  std::map<std::string, int> values;
  const auto sessions = index->sessions(std::nullopt);
  ASSERT_TRUE(sessions);
  for (const HistorySession& one : *sessions) {
    for (const HistoryValue& value : one.values) ++values[value.condition];
  }
  EXPECT_EQ(values["dT=16.9K"], 1);
  EXPECT_EQ(values["dT=16.9K observer hvs-2"], 1);
}

TEST_F(History, ReplacesAnInterruptedSessionByTheOneThatResumedIt) {
  const auto interrupted = session("interrupted"), resumed = session("resumed");
  const std::string digest = read_history_session(interrupted)->manifest_sha256;
  change(resumed / "provenance.json", "\"camera\": null",
         R"("camera": null, "origin": {"resumed": true, "manifest_sha256": ")" + digest + "\"}");
  ASSERT_TRUE(write_manifest(resumed));
  auto index = HistoryIndex::open(file());
  ASSERT_TRUE(index) << index.error().message;

  EXPECT_EQ(index->add(*read_history_session(interrupted)).value(), Adding::added);
  EXPECT_EQ(index->add(*read_history_session(resumed)).value(), Adding::added);
  EXPECT_EQ(index->add(*read_history_session(interrupted)).value(), Adding::known);

  const auto sessions = index->sessions(std::nullopt);
  ASSERT_TRUE(sessions && sessions->size() == 2);
  EXPECT_TRUE(sessions->at(0).values.empty()) << sessions->at(0).path;
  EXPECT_FALSE(sessions->at(1).values.empty());
}

TEST_F(History, TakesNoPlaceholderOfASerialNumberForAUnit) {
  const auto nameless = session("nameless"), first = session("first"), second = session("second"),
             told = session("told");
  give_camera(nameless, "200901010001", "");
  give_camera(first, "200901010001", "sample 1");
  give_camera(second, "200901010001", "sample 2");
  give_camera(told, "48000123", "sample 3");

  const auto refused = read_history_session(nameless);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("200901010001 is a placeholder"));
  EXPECT_EQ(read_history_session(first)->unit.serial, "unit:sample 1");
  EXPECT_EQ(read_history_session(second)->unit.serial, "unit:sample 2");
  EXPECT_EQ(read_history_session(told)->unit.serial, "48000123");
}

TEST_F(History, IsMadeAgainFromFoldersAndEvents) {
  const auto folder = session("a");
  const HistoryEvent repair{"42", "2026-01-31T12:00:00Z", "repair", "new \"window\", cleaned"};
  {
    auto index = HistoryIndex::open(file());
    ASSERT_TRUE(index) << index.error().message;
    ASSERT_TRUE(index->add(*read_history_session(folder)));
    ASSERT_TRUE(index->add_event(repair));
  }
  for (const char* end : {"", "-wal", "-shm"}) std::filesystem::remove(file().string() + end);

  auto index = HistoryIndex::open(file());
  ASSERT_TRUE(index) << index.error().message;
  ASSERT_TRUE(index->add(*read_history_session(folder)));

  EXPECT_EQ(index->sessions(std::nullopt)->size(), 1u);
  const auto events = index->events("42");
  ASSERT_TRUE(events);
  ASSERT_EQ(events->size(), 1u);
  EXPECT_EQ(events->front().text, repair.text);
}

TEST_F(History, RefusesWhatIsNoSessionAnyMore) {
  const auto folder = session("a");
  std::ofstream(folder / "curve.csv", std::ios::app) << "measured,1,1,1,1,1,1,1,1,1,1,1,1,1,1,ok\n";

  const auto refused = read_history_session(folder);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(refused.error().message, HasSubstr("curve.csv"));
}

TEST_F(History, VerifiesTheFilesThatItDoesNotReadToo) {
  const auto folder = session("a");
  EXPECT_TRUE(verify_history_session(folder));
  std::ofstream(folder / "trials.csv", std::ios::app) << "1\n";

  const auto refused = verify_history_session(folder);

  EXPECT_TRUE(read_history_session(folder));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(refused.error().message, HasSubstr("trials.csv"));
}

TEST_F(History, SaysOfASessionWithoutResultThatItHasNone) {
  const auto folder = session("a");
  std::filesystem::remove(folder / "curve.csv");

  const auto refused = read_history_session(folder);

  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("has no curve.csv"));
}

TEST_F(History, RefusesAnIndexThatIsNone) {
  folder_.write("index/history.sqlite", std::string(5000, 'x'));
  const auto damaged = HistoryIndex::open(file());
  ASSERT_FALSE(damaged);
  EXPECT_EQ(damaged.error().code, ErrorCode::invalid_input);

  sqlite3* other = nullptr;
  const auto another = folder_.path() / "other.sqlite";
  ASSERT_EQ(sqlite3_open(another.c_str(), &other), SQLITE_OK);
  sqlite3_exec(other, "CREATE TABLE mine(x)", nullptr, nullptr, nullptr);
  sqlite3_close(other);
  const auto foreign = HistoryIndex::open(another);
  ASSERT_FALSE(foreign);
  EXPECT_EQ(foreign.error().code, ErrorCode::invalid_input);
}

TEST_F(History, SaysWhoIsInTheWay) {
  const auto folder = session("a");
  auto index = HistoryIndex::open(file(), std::chrono::milliseconds(50));
  ASSERT_TRUE(index) << index.error().message;
  sqlite3* other = nullptr;
  ASSERT_EQ(sqlite3_open(file().c_str(), &other), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(other, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr), SQLITE_OK);

  const auto refused = index->add(*read_history_session(folder));
  sqlite3_exec(other, "ROLLBACK", nullptr, nullptr, nullptr);
  sqlite3_close(other);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::io);
  EXPECT_TRUE(index->add(*read_history_session(folder)));
}

/// Sessions of several units, each with an older value that counts no more.
HistorySession session_of(int unit, int year, double ln_acuity, double u) {
  const std::string serial = "S" + std::to_string(unit), utc = std::to_string(year) + "-01-01T00:00:00Z";
  return {.unit = {"FLIR", "SC2000", serial, ""},
          .path = "/sessions/" + serial + utc,
          .manifest_sha256 = serial + utc,
          .started_utc = utc,
          .program = "1",
          .state = "complete",
          .firmware = "1",
          .values = {{"acuity", "dT=0.23K", "1/mrad", "ln", ln_acuity, u}}};
}

TEST_F(History, SaysOfAKindOfCameraWhatItsUnitsAre) {
  auto index = HistoryIndex::open(file());
  ASSERT_TRUE(index) << index.error().message;
  double mean = 0, squares = 0;
  constexpr int units = 12;
  const auto value = [](int unit) { return -1.2 + 0.03 * ((unit * 5) % units); };
  for (int unit = 0; unit < units; ++unit) {
    ASSERT_TRUE(index->add(session_of(unit, 2024, 0, 0.5)));
    ASSERT_TRUE(index->add(session_of(unit, 2025, value(unit), 0.02)));
    HistorySession late = session_of(unit, 2026, 3, 0.02);
    late.state = "interrupted";
    ASSERT_TRUE(index->add(late));
    mean += value(unit) / units;
  }
  for (int unit = 0; unit < units; ++unit) squares += std::pow(value(unit) - mean, 2) / (units - 1);
  ASSERT_TRUE(index->add(session_of(99, 2025, 5, 0.02)));

  const auto found = fleets_of(*index, {.model = "SC2000", .without_serial = "S99"});

  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->size(), 1u);
  const FleetRow& row = found->front().row;
  EXPECT_EQ(found->front().refused, "");
  EXPECT_EQ(row.units, units);
  EXPECT_NEAR(row.delta_t_k.value(), 0.23, 1e-12);
  EXPECT_NEAR(row.mean, std::exp(mean), 1e-12);
  EXPECT_NEAR(row.u, 0.02, 1e-12);
  EXPECT_NEAR(row.sd, std::sqrt(squares - 0.0004), 1e-12);
  // A plan takes the rows as they are written.
  const auto plan = parse_plan({.origin = "test", .text = "[target]\ndistance_m = 2\n" + fleets_toml(*found)}, ".");
  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_EQ(plan->limits.fleets, std::vector{row});
}

TEST_F(History, ListsWhatLiesBeforeAnEventOrAnotherFirmwareApartFromTheChart) {
  auto index = HistoryIndex::open(file());
  ASSERT_TRUE(index) << index.error().message;
  for (int year = 2020; year < 2026; ++year) {
    HistorySession session = session_of(1, year, 0.1 * (year - 2020), 0.02);
    session.firmware = year < 2024 ? "1" : "2";
    ASSERT_TRUE(index->add(session));
  }
  ASSERT_TRUE(index->add(session_of(2, 2021, 0.5, 0.02)));
  ASSERT_TRUE(index->add_event({"S1", "2022-01-01T00:00:00Z", "repair", ""}));
  ASSERT_TRUE(index->add_event({"S2", "2022-06-01T00:00:00Z", "transport", ""}));

  const auto charts = history_series(*index, "", "");
  const auto listed = history_series(*index, "", "", WithoutChart::listed);

  ASSERT_TRUE(charts && listed);
  ASSERT_EQ(charts->size(), 1u);
  ASSERT_EQ(listed->size(), 2u);
  const HistorySeries& first = listed->front();
  ASSERT_EQ(first.values.size(), 2u);
  EXPECT_EQ(first.started_utc.front(), "2024-01-01T00:00:00Z");
  EXPECT_EQ(charts->front().started_utc, first.started_utc);
  ASSERT_EQ(first.earlier.size(), 4u);
  for (std::size_t i = 0; i < first.earlier.size(); ++i) {
    EXPECT_EQ(first.earlier[i].ended_by, i < 2 ? "repair" : "firmware");
    EXPECT_EQ(first.earlier[i].value.value, 0.1 * static_cast<double>(i));
  }
  EXPECT_TRUE(listed->back().values.empty());
  ASSERT_EQ(listed->back().earlier.size(), 1u);
  EXPECT_EQ(listed->back().earlier.front().ended_by, "transport");
}

TEST_F(History, RefusesAPriorOfTooFewUnitsOrOfSeveralKinds) {
  auto index = HistoryIndex::open(file());
  ASSERT_TRUE(index) << index.error().message;
  EXPECT_EQ(fleets_of(*index, {.model = "SC2000"}).error().code, ErrorCode::not_found);
  for (int unit = 0; unit < least_fleet_units - 1; ++unit)
    ASSERT_TRUE(index->add(session_of(unit, 2025, 0.1 * unit, 0.02)));
  const auto few = fleets_of(*index, {.model = "SC2000"});
  ASSERT_TRUE(few);
  EXPECT_NE(few->front().refused, "");
  EXPECT_EQ(fleets_toml(*few).front(), '#');
  HistorySession other = session_of(50, 2025, 1, 0.02);
  other.unit.vendor = "another";
  ASSERT_TRUE(index->add(other));
  EXPECT_EQ(fleets_of(*index, {.model = "SC2000"}).error().code, ErrorCode::invalid_input);
  EXPECT_TRUE(fleets_of(*index, {.vendor = "FLIR", .model = "SC2000"}));
}

}  // namespace
}  // namespace todbench
