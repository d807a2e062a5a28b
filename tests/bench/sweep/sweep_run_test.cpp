// SPDX-License-Identifier: GPL-3.0-or-later
// Tasks of sweeps as they run: where results go, what comes back, processes.
#include "bench/sweep/task_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <stop_token>
#include <thread>

#include "bench/plan/descriptions.h"
#include "bench/studies/identification_study.h"
#include "bench/sweep/processes.h"
#include "bench/sweep/result_store.h"
#include "bench/sweep/sweep_table.h"
#include "bench/text/files.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

/// A sweep whose tasks take milliseconds: draft estimates of one contrast.
RunnableSweep quick_sweep(const TemporaryFolder& folder, const std::string& more = "") {
  folder.write("s.toml", "kind = \"estimate\"\nwhere = \"detector_um <= pitch_um\"\n" + more +
                             "[base]\naccuracy = \"draft\"\ndelta_t_k = [16.9]\n[grid]\nnetd_k = [0.07, 0.4]\n"
                             "detector_um = [30, 42.5]\n[repeat]\nseeds = 2\n");
  auto sweep = load_sweep(folder.path() / "s.toml");
  EXPECT_TRUE(sweep) << sweep.error().message;
  return *sweep;
}

/// A sweep of a small aberration with the same random numbers, which a tolerance of 5 % leaves out and one of 0.01 %
/// does not.
RunnableSweep sweep_of_tolerance(const TemporaryFolder& folder, const std::string& tolerance,
                                 const std::string& sigma = "0.05") {
  folder.write("t.toml", "kind = \"estimate\"\npaired = true\n[base]\naccuracy = \"draft\"\ndelta_t_k = [16.9]\n" +
                             tolerance + "[grid]\naberration_sigma_pitch = [" + sigma + "]\n");
  auto sweep = load_sweep(folder.path() / "t.toml");
  EXPECT_TRUE(sweep) << sweep.error().message;
  return *sweep;
}

TEST(SweepRun, AnEstimateSkipsWhatItsStatedToleranceAllows) {
  const TemporaryFolder folder;
  const auto acuity_with = [&](const std::string& tolerance, const std::string& sigma) {
    const RunnableSweep sweep = sweep_of_tolerance(folder, tolerance, sigma);
    const auto result = run_task(sweep, sweep.sweep.task(0), folder.path() / "scratch", {});
    EXPECT_TRUE(result) << result.error().message;
    const Json point = (*result)["points"][0];
    EXPECT_EQ(point.contains("left_out"), !tolerance.empty());
    if (tolerance.starts_with("tolerance_percent = 5")) {
      EXPECT_EQ(point["left_out"].get<std::string>().find("aberration") != std::string::npos, sigma != "0");
    }
    return point["acuity_per_mrad"].get<double>();
  };
  const std::string fine = "tolerance_percent = 0.01\n", coarse = "tolerance_percent = 5\n";

  EXPECT_NE(acuity_with("", "0.05"), acuity_with("", "0"));  // not stated: every effect
  EXPECT_NE(acuity_with(fine, "0.05"), acuity_with(fine, "0"));
  EXPECT_EQ(acuity_with(coarse, "0.05"), acuity_with(coarse, "0"));
  EXPECT_NEAR(acuity_with(coarse, "0.05") / acuity_with("", "0.05"), 1, 0.05);  // the tolerance
}

TEST(SweepRun, PredictsTheTimeOfTheEstimateWithoutTrials) {
  const TemporaryFolder folder;
  const RunnableSweep estimate = sweep_of_tolerance(folder, "");
  RunnableSweep trials = estimate;
  folder.write("u.toml",
               "kind = \"simulate\"\n[base]\naccuracy = \"draft\"\ndelta_t_k = [16.9]\n[grid]\n"
               "aberration_sigma_pitch = [0.05]\n");
  trials = load_sweep(folder.path() / "u.toml").value();

  const auto of_estimate = predicted_task_s(estimate, estimate.sweep.task(0), {});
  const auto of_trials = predicted_task_s(trials, trials.sweep.task(0), {});

  ASSERT_TRUE(of_estimate && of_trials);
  EXPECT_GT(*of_estimate, 0);
  EXPECT_LT(*of_estimate, 0.5 * *of_trials);
}

TEST(SweepRun, IsIdempotentAndTheTableIsTheSameInAnyOrder) {
  const TemporaryFolder one, two;
  const RunnableSweep forwards = quick_sweep(one), backwards = quick_sweep(two);
  ASSERT_EQ(forwards.sweep.count(), 8u);

  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(run_and_store(forwards, i, {}).kind, TaskOutcome::Kind::done);
  for (std::size_t i = 8; i-- > 0;) EXPECT_EQ(run_and_store(backwards, i, {}).kind, TaskOutcome::Kind::done);

  EXPECT_EQ(run_and_store(forwards, 3, {}).kind, TaskOutcome::Kind::already_done);
  const auto a = collected(forwards.sweep, MissingTasks::refused),
             b = collected(backwards.sweep, MissingTasks::refused);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(to_csv(*a), to_csv(*b));
  EXPECT_EQ(a->rows.size(), 8u);
  ASSERT_TRUE(write_sqlite(*a, one.path() / "t.sqlite"));
  EXPECT_TRUE(std::filesystem::exists(one.path() / "t.sqlite"));
  const auto effects = sweep_effects(forwards.sweep, *a, "acuity_per_mrad");
  ASSERT_EQ(effects.size(), 1u);
  // More noise costs acuity.
  const auto& netd = effects[0].parameters[0];
  EXPECT_GT(netd.levels[0].mean, netd.levels[1].mean);
  EXPECT_TRUE(netd.first_order && netd.total && netd.first_order_ci95.low);
}

TEST(SweepStatus, TellsWhatIsDoneMissingStaleAndForeign) {
  const TemporaryFolder folder;
  const RunnableSweep runnable = quick_sweep(folder);
  ASSERT_EQ(run_and_store(runnable, 2, {}).kind, TaskOutcome::Kind::done);
  const auto place = [&](std::size_t i, const char* ending) {
    return result_file(runnable.sweep, runnable.sweep.task(i)).replace_extension(ending);
  };
  std::ofstream(place(4, ".lock")) << "a-host-that-is-not-this-one\n1\n";
  std::ofstream(place(5, ".failed")) << "no such sensor\n";
  // No process has this number: it is above the largest that the kernel gives.
  std::array<char, 256> host{};
  ASSERT_EQ(::gethostname(host.data(), host.size() - 1), 0);
  std::ofstream(place(6, ".lock")) << host.data() << "\n99999999\n";

  const SweepStatus status = sweep_status(runnable.sweep);

  EXPECT_EQ(status.count(TaskState::done), 1u);
  EXPECT_EQ(status.states[4], TaskState::running);
  EXPECT_EQ(status.states[5], TaskState::failed);
  EXPECT_EQ(status.states[6], TaskState::stale);
  EXPECT_EQ(status.open_list(), "0-1,3-7");
  EXPECT_EQ(failure_of(runnable.sweep, 5), "no such sensor");
  EXPECT_EQ(run_and_store(runnable, 4, {}).kind, TaskOutcome::Kind::locked);
  EXPECT_EQ(run_and_store(runnable, 6, {}).kind, TaskOutcome::Kind::done) << "a stale lock is no lock";
  const auto refused = collected(runnable.sweep, MissingTasks::refused);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::not_identifiable);
  EXPECT_EQ(collected(runnable.sweep, MissingTasks::left_out)->rows.size(), 2u);

  const RunnableSweep other = quick_sweep(folder, "seed = 7\n");
  EXPECT_EQ(sweep_status(other.sweep).states[2], TaskState::foreign);
  EXPECT_EQ(run_and_store(other, 2, {}).kind, TaskOutcome::Kind::failed);
  EXPECT_FALSE(collected(other.sweep, MissingTasks::left_out));
}

TEST(SweepRun, OfAnElementThatSlurmStartedAgainTakesOverTheLockOfItsLostNode) {
  const TemporaryFolder folder;
  const RunnableSweep runnable = quick_sweep(folder);
  ASSERT_EQ(run_and_store(runnable, 0, {}).kind, TaskOutcome::Kind::done);
  const auto leave_lock = [&](std::size_t i) {
    std::ofstream(result_file(runnable.sweep, runnable.sweep.task(i)).replace_extension(".lock"))
        << "a-node-that-was-lost\n1\n12_3\n1\n";
  };
  leave_lock(1);
  leave_lock(2);
  ::setenv("SLURM_ARRAY_JOB_ID", "12", 1);
  ::setenv("SLURM_ARRAY_TASK_ID", "3", 1);
  ::setenv("SLURM_RESTART_COUNT", "1", 1);

  const auto same_start = run_and_store(runnable, 1, {}).kind;
  ::setenv("SLURM_RESTART_COUNT", "2", 1);
  const auto later_start = run_and_store(runnable, 1, {}).kind;
  ::setenv("SLURM_ARRAY_TASK_ID", "4", 1);
  const auto another_element = run_and_store(runnable, 2, {}).kind;
  for (const char* name : {"SLURM_ARRAY_JOB_ID", "SLURM_ARRAY_TASK_ID", "SLURM_RESTART_COUNT"}) ::unsetenv(name);

  EXPECT_EQ(same_start, TaskOutcome::Kind::locked);
  EXPECT_EQ(later_start, TaskOutcome::Kind::done);
  EXPECT_EQ(another_element, TaskOutcome::Kind::locked);
}

TEST(SweepCollect, RefusesResultsOfSeveralVersions) {
  const TemporaryFolder folder;
  const RunnableSweep runnable = quick_sweep(folder);
  for (std::size_t i = 0; i < 2; ++i) ASSERT_EQ(run_and_store(runnable, i, {}).kind, TaskOutcome::Kind::done);
  const auto file = result_file(runnable.sweep, runnable.sweep.task(1));
  std::string text = *read_text_file(file);
  const auto place = text.find("\"version\": \"");
  ASSERT_NE(place, std::string::npos);
  text.insert(place + 12, "9");
  ASSERT_TRUE(write_file_atomically(file, text));

  const auto table = collected(runnable.sweep, MissingTasks::left_out);

  ASSERT_FALSE(table);
  EXPECT_THAT(table.error().message, HasSubstr("several versions"));
}

TEST(SweepRun, OfAnIdentificationIsTheStudyOfEachSensorAndAir) {
  const TemporaryFolder folder;
  folder.write("three.toml",
               "name = \"three\"\ntargets = [\"craft-01\", \"craft-07\"]\nazimuths_deg = [90]\nbackground_k = 288\n");
  folder.write("thick.csv", "range_km,transmittance\n5,0.3\n10,0.09\n");
  const auto loaded = [&](const std::string& more) {
    folder.write("s.toml",
                 "kind = \"identify\"\npaired = true\n[base]\nset = \"./three.toml\"\nranges_m = [1000, 2500, 6000]\n"
                 "decisions = 16\naccuracy = \"draft\"\nsensor = \"sc2000\"\n" +
                     more);
    return load_sweep(folder.path() / "s.toml");
  };
  const auto runnable = loaded("[grid]\nnetd_k = [0.05, 0.3]\natmosphere = [\"clear\", \"./thick.csv\"]\n");
  ASSERT_TRUE(runnable) << runnable.error().message;
  std::vector<double> r75_m;
  for (std::size_t i = 0; i < runnable->sweep.count(); ++i) {
    const auto result = run_task(*runnable, runnable->sweep.task(i), folder.path() / "scratch", {});
    ASSERT_TRUE(result) << result.error().message;
    r75_m.push_back((*result)["points"][0]["r75_m"].get<double>());
  }
  ASSERT_EQ(r75_m.size(), 4u);
  EXPECT_GT(r75_m[0], r75_m[2]) << "noise";
  EXPECT_GT(r75_m[2], r75_m[3]) << "air";

  IdentificationStudyTask task;
  task.set = load_target_set((folder.path() / "three.toml").string()).value();
  task.sensor = load_sensor("sc2000").value();
  task.sensor.netd_k = 0.3;
  task.observer = parse_observer(find_resource(ResourceKind::observer, "hvs-1").value()).value();
  task.accuracy = Accuracy::draft();
  task.ranges_m = {1000, 2500, 6000};
  task.decisions = 16;
  task.seed = runnable->sweep.task(2).seed;
  EXPECT_EQ(study_identification(task)->r75_m.value, r75_m[2]);

  const std::string before = runnable->sweep.hash();
  folder.write("thick.csv", "range_km,transmittance\n5,0.3\n10,0.08\n");
  EXPECT_NE(loaded("[grid]\nnetd_k = [0.05, 0.3]\natmosphere = [\"clear\", \"./thick.csv\"]\n")->sweep.hash(), before);
  EXPECT_THAT(loaded("[grid]\natmosphere = [\"fog\"]\n").error().message, HasSubstr("fog"));
  EXPECT_THAT(loaded("[grid]\ncues = [\"none\"]\n").error().message, HasSubstr("all or shape"));
  EXPECT_THAT(loaded("[grid]\nm75 = [0]\n").error().message, HasSubstr("m75: expected"));
}

TEST(ShippedSweeps, GiveATableInTheirShortForm) {
  const TemporaryFolder folder;
  for (const char* name : {"sc2000-sensitivity", "observer-and-sensor", "budget-tolerance"}) {
    const std::string text = *read_text_file(source_file(std::string("bench/sweeps/") + name + ".toml"));
    folder.write(std::string(name) + ".toml", text);
    const auto runnable = load_sweep(folder.path() / (std::string(name) + ".toml"));
    ASSERT_TRUE(runnable) << runnable.error().message;
    EXPECT_EQ(runnable->sweep.refused(), 0u) << name;
    // The first task and the last stand for the others.
    for (const std::size_t i : {std::size_t{0}, runnable->sweep.count() - 1})
      EXPECT_EQ(run_and_store(*runnable, i, {}).kind, TaskOutcome::Kind::done) << name;
    EXPECT_EQ(collected(runnable->sweep, MissingTasks::left_out)->rows.size(), 4u) << name;
  }
}

/// Chunks of two tasks of five, each a shell that says how it ended.
ProcessPool pool_of(const std::string& script, std::size_t jobs) {
  return {.tasks = 5, .jobs = jobs, .chunk = 2, .command = [script](std::size_t first, std::size_t last) {
            return std::vector<std::string>{"/bin/sh", "-c", script, "sh", std::to_string(first), std::to_string(last)};
          }};
}

TEST(ProcessPool, RunsEveryChunkAndSaysTheWorstExitCode) {
  const TemporaryFolder folder;
  for (const std::size_t jobs : {1u, 2u, 9u}) {
    const auto name = folder.path() / std::to_string(jobs);
    ProcessPool pool = pool_of("echo $1-$2 >> " + name.string() + "; exit $1", jobs);
    std::vector<std::size_t> progress;
    pool.on_progress = [&](std::size_t done) { progress.push_back(done); };

    EXPECT_EQ(run_pool(pool, {}).value(), 4);

    const std::string text = *read_text_file(name);
    for (const char* chunk : {"0-1\n", "2-3\n", "4-4\n"}) EXPECT_THAT(text, HasSubstr(chunk));
    EXPECT_EQ(text.size(), 12u);
    EXPECT_EQ(progress.size(), 3u);
    EXPECT_EQ(progress.back(), 5u);
  }
  ProcessPool pool = pool_of("", 2);
  pool.command = [](std::size_t, std::size_t) { return std::vector<std::string>{"/no/such/program"}; };
  EXPECT_EQ(run_pool(pool, {}).error().code, ErrorCode::not_found);
}

TEST(ProcessPool, EndsItsChildrenWhenAskedToStop) {
  // Every child would run for an hour; the first that is there asks for the end of all.
  const TemporaryFolder folder;
  const auto pipe = folder.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::stop_source stop;
  const std::jthread asks([&] {
    std::ifstream reads(pipe);
    reads.get();
    stop.request_stop();
  });

  EXPECT_EQ(run_pool(pool_of("echo > " + pipe.string() + "; exec sleep 3600", 1), stop.get_token()).value(), 130);
  EXPECT_EQ(run_pool(pool_of("exec sleep 3600", 2), stop.get_token()).value(), 130) << "nothing is started any more";
}

}  // namespace
}  // namespace todbench
