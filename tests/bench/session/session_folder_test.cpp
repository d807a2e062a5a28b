// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/session_folder.h"
#include "tests/support/verify_manifest.h"

#include <gmock/gmock.h>

#include <cmath>

#include "bench/judgement/verdict_record.h"
#include "bench/session/build_info.h"
#include "bench/session/fit_record.h"
#include "bench/text/files.h"
#include "tests/bench/session/trial_values.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::MatchesRegex;

RunRecord full_run() {
  RunRecord run;
  run.wall_s = 12.5;
  run.frames_used = 1000;
  run.frames_rejected = {{"incomplete", 3}, {"frozen", 1}};
  run.frames_lost = 2;
  run.temporal_noise_k = 0.071;
  SetUpRecord set_up;
  set_up.plate = "tcat-a";
  set_up.mounting = Mounting::rotated_180;
  set_up.registration.plate_to_pixel = {0.38, 0.01, 160, -0.01, 0.38, 120, 1e-6, 0, 1};
  set_up.registration.residual_px = 1.0 / 30;
  set_up.registration.triangles_used = 9;
  set_up.registration.scale_px_per_mm = 0.3821;
  set_up.registration.rotation_deg = -1.5;
  set_up.registration.scale_deviation = 0.003;
  set_up.registration.contrast_sign = -1;
  run.set_ups = {set_up};
  run.notes = {"a note"};
  run.measures_s = 2.5;
  return run;
}

Provenance full_provenance(const Plan& plan) {
  Provenance provenance = begin_provenance(plan, Side::measured);
  provenance.camera = CameraRecord{"gige:X-1",
                                   "X",
                                   "Y",
                                   "1",
                                   "1.0",
                                   "GigE Vision",
                                   "Mono14",
                                   320,
                                   240,
                                   14,
                                   50,
                                   "0.01 K/count",
                                   {{"IRFormat", "TemperatureLinear10mK"}},
                                   {"small socket buffer"}};
  provenance.target = "black body BB-1";
  provenance.effects.decisions = {{Effect::quantisation, Decision::skip, "tiny", 0.01}};
  provenance.run = full_run();
  provenance.twin_run = full_run();
  provenance.forecast = TimeForecast{.total_s = 60, .parts_s = {{"Changes of the target", 24.5}}};
  provenance.camera_optics = CameraOpticsRecord{.aberration_sigma_pitch = 0.5,
                                                .aberration_se_pitch = 0.001,
                                                .f_number_ratio = 1.01,
                                                .f_number_ratio_se = 0.02,
                                                .samples_per_pitch = 2,
                                                .chi2 = 1.5,
                                                .chi2_limit = 1.1,
                                                .degrees_of_freedom = 3500,
                                                .netd_k = 0.07,
                                                .row_noise_k = 0.01,
                                                .column_noise_k = 0.02,
                                                .fixed_pattern_k = 0.03,
                                                .noise_correlation = 0.6,
                                                .refused = true,
                                                .surrogate_taken = true,
                                                .contrast_response = {{"tcat-a", 0.98}}};
  return provenance;
}

/// Of a limit that is in no plan here: it can only come from the file.
Verdict stored_verdict() {
  const TodCurve curve = testing::full_curve();
  return judge({.limits = {{{curve.points.front().set_delta_t_k, 1e6}}, std::nullopt},
                .curve = curve,
                .comparison = std::nullopt});
}

/// Writes a complete session and returns its folder.
std::filesystem::path write_session(const testing::TemporaryFolder& parent, const std::vector<Trial>& trials,
                                    ScheduleKind kind = ScheduleKind::constant) {
  Plan plan;
  plan.name = "acceptance";
  plan.schedule.kind = kind;
  auto folder = SessionFolder::create(parent.path() / "session", ExistingFolder::refuse).value();
  EXPECT_TRUE(folder.write_plan(LoadedPlan::load(plan).value()));
  Provenance provenance = full_provenance(plan);
  EXPECT_TRUE(folder.write_provenance(provenance));
  EXPECT_TRUE(folder.log("started"));
  for (const SessionCurve which : {SessionCurve::main, SessionCurve::twin}) {
    TrialsWriter writer = folder.open_trials(which).value();
    for (const Trial& trial : trials) EXPECT_TRUE(writer.append(trial));
    EXPECT_TRUE(writer.sync());
    TargetsWriter targets = folder.open_targets(which).value();
    EXPECT_TRUE(targets.append(testing::full_presentation()));
  }
  EXPECT_TRUE(folder.write_curves(testing::full_curve(), testing::full_curve(), Side::measured));
  Comparison comparison;
  comparison.points.push_back(
      {16.9, 16.8, 16.9, 1.0, {0.9, 1.1}, {0.92, 1.08}, 0.9, 0.01, 10, ComparisonVerdict::equivalent});
  comparison.verdict = ComparisonVerdict::equivalent;
  EXPECT_TRUE(folder.write_comparison(comparison));
  EXPECT_TRUE(folder.write_verdict(stored_verdict()));
  EXPECT_TRUE(folder.write_report("<!DOCTYPE html><title>x</title>"));
  EXPECT_TRUE(folder.finish(provenance, SessionState::complete));
  return folder.path();
}

TEST(SessionFolder, ComesBackAsTheValuesThatWereWritten) {
  const testing::TemporaryFolder parent;
  const std::vector<Trial> trials = testing::random_trials(20);

  const std::filesystem::path folder = write_session(parent, trials);

  const Result<Session> session = read_session(folder);
  ASSERT_TRUE(session) << session.error().message;
  Plan plan;
  plan.name = "acceptance";
  plan.schedule.frames_per_presentation = {4};  // what a session had where its plan left them open
  EXPECT_EQ(session->plan, plan);
  EXPECT_TRUE(session->complete());
  ASSERT_EQ(session->trials.size(), 20u);
  EXPECT_EQ(session->twin_trials.size(), 20u);
  EXPECT_EQ(session->presentations, std::vector{testing::full_presentation()});
  EXPECT_EQ(session->twin_presentations, std::vector{testing::full_presentation()});
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(testing::values_of(session->trials[i]), testing::values_of(trials[i]));
  EXPECT_EQ(to_line(curve_record(*session->curve).value()), to_line(curve_record(testing::full_curve()).value()));
  EXPECT_TRUE(session->twin);
  EXPECT_EQ(session->comparison->verdict, ComparisonVerdict::equivalent);
  ASSERT_TRUE(session->verdict);
  EXPECT_EQ(to_line(verdict_json(*session->verdict)), to_line(verdict_json(stored_verdict())));
}

TEST(SessionFolder, OfAnAdaptiveScheduleWithoutAnswersHadThoseOfItsTrials) {
  std::vector<Trial> right_and_wrong = testing::random_trials(20);
  std::vector<Trial> graded = right_and_wrong;
  for (Trial& trial : right_and_wrong) trial.probability_correct.reset();
  for (Trial& trial : graded) trial.probability_correct = 0.75;
  const auto answers_of = [](const std::vector<Trial>& trials, ScheduleKind kind) {
    const testing::TemporaryFolder parent;
    return read_session(write_session(parent, trials, kind)).value().plan.schedule.answers;
  };

  EXPECT_EQ(answers_of(right_and_wrong, ScheduleKind::adaptive), AnswersChoice::binary);
  EXPECT_EQ(answers_of(graded, ScheduleKind::adaptive), AnswersChoice::automatic);
  EXPECT_EQ(answers_of(right_and_wrong, ScheduleKind::constant), AnswersChoice::automatic);
}

TEST(SessionVerdict, IsTheStoredOneWhateverThePlanSays) {
  const testing::TemporaryFolder parent;
  const Session session = read_session(write_session(parent, testing::random_trials(3))).value();
  ASSERT_TRUE(session.plan.limits.acuity.empty());

  const Verdict verdict = verdict_of(session);

  EXPECT_EQ(verdict.judged, JudgedWhen::at_end_of_run);
  EXPECT_EQ(verdict.demands.at(0).kind, DemandKind::acuity);
  EXPECT_EQ(verdict.demands.at(0).limit, 1e6);
}

TEST(SessionVerdict, OfAnOldSessionIsJudgedOnceAndSaysSo) {
  const testing::TemporaryFolder parent;
  const std::filesystem::path folder = write_session(parent, testing::random_trials(3));
  std::filesystem::remove(folder / "verdict.json");
  ASSERT_TRUE(write_manifest(folder));
  const Session old = read_session(folder).value();
  ASSERT_FALSE(old.verdict);

  const Verdict verdict = verdict_of(old);
  ASSERT_TRUE(keep_verdict(folder, verdict));

  EXPECT_EQ(verdict.judged, JudgedWhen::afterwards);
  EXPECT_FALSE(limits_asked(verdict));  // the plan has none
  EXPECT_THAT(verify_manifest(folder).value(), IsEmpty());
  EXPECT_THAT(session_files(folder), Contains("verdict.json"));
  const Session again = read_session(folder).value();
  ASSERT_TRUE(again.verdict);
  EXPECT_EQ(to_line(verdict_json(verdict_of(again))), to_line(verdict_json(verdict)));
}

TEST(SessionVerdict, KeepingOneDoesNotBlessOtherChanges) {
  const testing::TemporaryFolder parent;
  const std::filesystem::path folder = write_session(parent, testing::random_trials(3));
  parent.write("session/curve.csv", "forged");

  ASSERT_TRUE(keep_verdict(folder, stored_verdict()));

  EXPECT_THAT(verify_manifest(folder).value(), ElementsAre("curve.csv: changed since the session was written"));
}

TEST(SessionVerdict, OfARunThatWasCutOffIsJudgedByWhatThereIsAndNotKept) {
  const testing::TemporaryFolder parent;
  auto folder = SessionFolder::create(parent.path() / "s", ExistingFolder::refuse).value();
  Plan plan;
  plan.limits.acuity = {{16.9, 0.4}};
  ASSERT_TRUE(folder.write_plan(LoadedPlan::load(plan).value()));
  ASSERT_TRUE(folder.write_provenance(begin_provenance(plan, Side::measured)));

  const Verdict verdict = verdict_of(read_session(folder.path()).value());
  ASSERT_TRUE(keep_verdict(folder.path(), verdict));

  EXPECT_EQ(verdict.decision, VerdictKind::inconclusive);
  EXPECT_EQ(verdict.ended_early, "the session was not finished");
  EXPECT_EQ(verdict.demands.at(0).reason, "this contrast was not measured");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "verdict.json"));
}

TEST(SessionVerdict, ThatIsDamagedIsNamedByFileAndKey) {
  const testing::TemporaryFolder parent;
  const std::filesystem::path folder = write_session(parent, testing::random_trials(3));
  Json json = verdict_json(stored_verdict());
  json["demands"][0].erase("limit");
  parent.write("session/verdict.json", to_page(json));

  const Result<Session> session = read_session(folder);

  ASSERT_FALSE(session);
  EXPECT_EQ(session.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(session.error().message, HasSubstr("verdict.json: missing key 'demands[0].limit'"));
}

TEST(SessionFolder, ProvenanceComesBackWithEveryField) {
  const testing::TemporaryFolder parent;
  Plan plan;
  plan.seed = 42;
  plan.instruments = {{"black body", "BB-1", "C-77", "2027-02-28"}};
  const Provenance provenance = full_provenance(plan);

  const Result<Provenance> back = provenance_from(Json::parse(to_page(provenance_json(provenance).value())));

  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(to_line(provenance_json(*back).value()), to_line(provenance_json(provenance).value()));
  EXPECT_EQ(back->camera, provenance.camera);
  EXPECT_EQ(back->camera_optics, provenance.camera_optics);
  EXPECT_EQ(back->forecast, provenance.forecast);
  EXPECT_EQ(back->seeds.at("plan"), 42u);
  EXPECT_EQ(back->instruments, plan.instruments);
  EXPECT_EQ(back->run->set_ups.at(0).registration.plate_to_pixel, full_run().set_ups[0].registration.plate_to_pixel);
  EXPECT_EQ(back->run->frames_rejected, full_run().frames_rejected);
  EXPECT_EQ(back->effects.decisions.at(0).predicted_change_percent, 0.01);
}

TEST(SessionFolder, ProvenanceSaysWhichProgramWroteIt) {
  const Provenance provenance = begin_provenance(Plan{}, Side::measured);

  EXPECT_EQ(provenance.program_version, build_info().version);
  EXPECT_THAT(std::string(build_info().version), MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
  EXPECT_THAT(provenance.git_commit, MatchesRegex("unknown|[0-9a-f]{12,}(-modified)?"));
  EXPECT_THAT(provenance.started_utc, MatchesRegex("[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}Z"));
}

TEST(SessionFolder, TheStoredPlanStandsOnItsOwnWhenItsFilesAreGone) {
  const testing::TemporaryFolder parent;
  std::string sensor = testing::content_of(source_file("sim_devices/sensors/sc2000.toml"));
  sensor.replace(sensor.find("netd_k = 0.07"), 13, "netd_k = 0.05");
  parent.write("parts/sc2000.toml", sensor);
  const auto plan = read_plan(parent.write("plan.toml", "[simulation]\nsensor = \"parts/sc2000.toml\"\n").string());
  ASSERT_TRUE(plan) << plan.error().message;
  auto folder = SessionFolder::create(parent.path() / "s", ExistingFolder::refuse).value();

  ASSERT_TRUE(folder.write_plan(*plan));
  std::filesystem::remove_all(parent.path() / "parts");
  std::filesystem::rename(parent.path() / "s", parent.path() / "moved");

  const auto stored = read_plan((parent.path() / "moved/session.toml").string());
  ASSERT_TRUE(stored) << stored.error().message;
  EXPECT_EQ(stored->sensor().netd_k, 0.05);
}

TEST(SessionFolder, ANonEmptyFolderIsRefusedUnlessItMayBeOverwritten) {
  const testing::TemporaryFolder parent;
  const std::filesystem::path path = write_session(parent, testing::random_trials(3));
  parent.write("session/mine.txt", "keep me");

  const auto refused = SessionFolder::create(path, ExistingFolder::refuse);
  const bool still_there = std::filesystem::exists(path / "trials.csv");
  const auto overwritten = SessionFolder::create(path, ExistingFolder::overwrite);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(refused.error().message, HasSubstr("the folder is not empty"));
  EXPECT_TRUE(still_there);
  ASSERT_TRUE(overwritten) << overwritten.error().message;
  EXPECT_THAT(session_files(path), IsEmpty());
  EXPECT_FALSE(std::filesystem::exists(path / "manifest.json"));
  EXPECT_EQ(testing::content_of(path / "mine.txt"), "keep me");
}

// Two runs in one folder would leave the trials of both under a manifest that vouches for them.
TEST(SessionFolder, OfARunThatIsBeingWrittenIsNotOverwrittenByAnother) {
  const testing::TemporaryFolder parent;
  auto running = std::optional(SessionFolder::create(parent.path() / "s", ExistingFolder::refuse));
  ASSERT_TRUE(*running) << running->error().message;

  const auto beside = SessionFolder::create(parent.path() / "s", ExistingFolder::overwrite);
  const auto numbered = SessionFolder::create(parent.path() / "s", ExistingFolder::number);
  running.reset();
  const auto after = SessionFolder::create(parent.path() / "s", ExistingFolder::overwrite);

  ASSERT_FALSE(beside);
  EXPECT_EQ(beside.error().code, ErrorCode::invalid_input);
  ASSERT_TRUE(numbered) << numbered.error().message;
  EXPECT_EQ(numbered->path(), parent.path() / "s-2");
  EXPECT_TRUE(after) << after.error().message;
}

TEST(SessionFolder, AFileInTheWayIsRefused) {
  const testing::TemporaryFolder parent;

  const auto folder = SessionFolder::create(parent.write("file", "x"), ExistingFolder::overwrite);

  ASSERT_FALSE(folder);
  EXPECT_EQ(folder.error().code, ErrorCode::invalid_input);
}

TEST(SessionFolder, ARunThatWasCutOffIsReadableAndNotComplete) {
  const testing::TemporaryFolder parent;
  auto folder = SessionFolder::create(parent.path() / "s", ExistingFolder::refuse).value();
  ASSERT_TRUE(folder.write_plan(LoadedPlan::load(Plan{}).value()));
  ASSERT_TRUE(folder.write_provenance(begin_provenance(Plan{}, Side::measured)));
  TrialsWriter writer = folder.open_trials(SessionCurve::main).value();
  for (const Trial& trial : testing::random_trials(7)) ASSERT_TRUE(writer.append(trial));

  const Result<Session> session = read_session(folder.path());

  ASSERT_TRUE(session) << session.error().message;
  EXPECT_FALSE(session->complete());
  EXPECT_EQ(session->provenance.state, SessionState::running);
  EXPECT_EQ(session->trials.size(), 7u);
  EXPECT_FALSE(session->curve);
  EXPECT_FALSE(verify_manifest(folder.path()));
}

TEST(SessionFolder, AnInterruptedRunSaysSoAndHasAManifest) {
  const testing::TemporaryFolder parent;
  auto folder = SessionFolder::create(parent.path() / "s", ExistingFolder::refuse).value();
  ASSERT_TRUE(folder.write_plan(LoadedPlan::load(Plan{}).value()));
  Provenance provenance = begin_provenance(Plan{}, Side::measured);
  provenance.run = full_run();
  provenance.run->ended_by = "stopped on request";

  ASSERT_TRUE(folder.finish(provenance, SessionState::interrupted));

  const Session session = read_session(folder.path()).value();
  EXPECT_EQ(session.provenance.state, SessionState::interrupted);
  EXPECT_EQ(session.provenance.run->ended_by, "stopped on request");
  EXPECT_THAT(testing::content_of(folder.path() / "provenance.json"), HasSubstr("\"state\": \"interrupted\""));
  EXPECT_THAT(verify_manifest(folder.path()).value(), IsEmpty());
}

TEST(SessionFolder, AFolderThatIsNoSessionIsRefused) {
  const testing::TemporaryFolder parent;

  const Result<Session> session = read_session(parent.path());

  ASSERT_FALSE(session);
  EXPECT_EQ(session.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(session.error().message, HasSubstr("not a session folder"));
}

TEST(SessionFolder, ADamagedFileIsNamed) {
  const testing::TemporaryFolder parent;
  const std::filesystem::path folder = write_session(parent, testing::random_trials(3));
  parent.write("session/fits.json", "{\"main\": null");

  const Result<Session> session = read_session(folder);

  ASSERT_FALSE(session);
  EXPECT_THAT(session.error().message, HasSubstr("fits.json: not valid JSON"));
}

TEST(Manifest, KnowsTheSha256OfThePublishedTestVector) {
  const testing::TemporaryFolder folder;

  // FIPS 180-2, appendix B.1
  EXPECT_EQ(sha256_of_file(folder.write("abc", "abc")).value(),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Manifest, ListsEveryFileOfTheSessionAndFindsItIntact) {
  const testing::TemporaryFolder parent;
  const std::filesystem::path folder = write_session(parent, testing::random_trials(3));

  EXPECT_THAT(session_files(folder),
              IsSupersetOf({"session.toml", "provenance.json", "trials.csv", "trials_simulated.csv", "targets.csv",
                            "targets_simulated.csv", "fits.json", "curve.csv", "comparison.json", "verdict.json",
                            "report.html", "log.txt", "inputs/observer-hvs-1.toml", "inputs/plate-tcat-a.toml",
                            "inputs/plate-tcat-b.toml", "inputs/sensor-sc2000.toml"}));
  EXPECT_THAT(verify_manifest(folder).value(), IsEmpty());
}

TEST(Manifest, FindsOneChangedByteAMissingAndAnAddedFile) {
  const testing::TemporaryFolder parent;
  const std::filesystem::path folder = write_session(parent, testing::random_trials(3));
  std::string trials = testing::content_of(folder / "trials.csv");
  trials[trials.size() / 2] = trials[trials.size() / 2] == '1' ? '2' : '1';
  parent.write("session/trials.csv", trials);
  std::filesystem::remove(folder / "log.txt");
  parent.write("session/frames/0.raw", "x");

  EXPECT_THAT(verify_manifest(folder).value(),
              ElementsAre("log.txt: missing", "trials.csv: changed since the session was written",
                          "frames/0.raw: not in the manifest"));
}

TEST(Manifest, ARebuiltReportIsTakenOverWithoutBlessingOtherChanges) {
  const testing::TemporaryFolder parent;
  const std::filesystem::path folder = write_session(parent, testing::random_trials(3));
  parent.write("session/report.html", "new");
  parent.write("session/curve.csv", "forged");

  ASSERT_TRUE(refresh_manifest(folder, {"report.html"}));

  EXPECT_THAT(verify_manifest(folder).value(), ElementsAre("curve.csv: changed since the session was written"));
}

TEST(CurveCsv, HasARowPerSideAndContrastAndEmptyFieldsForWhatDoesNotExist) {
  TodPoint point;
  point.set_delta_t_k = point.delta_t_k = 0.5;
  point.fit.verdict = FitVerdict::above_range;
  point.fit.ci95.low = 4;

  const std::string text = curve_csv({"o", "s", {point}}, std::nullopt, Side::measured);

  EXPECT_THAT(text, HasSubstr("\nmeasured,0.5,0.5,,,4,,,,0.25,,0,0,,,above_range\n"));
}

}  // namespace
}  // namespace todbench
