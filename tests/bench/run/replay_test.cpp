// SPDX-License-Identifier: GPL-3.0-or-later
// A session with instruments that say what they show: what is kept of it, and what a replay makes of it.
#include "bench/run/replay.h"
#include "tests/support/verify_manifest.h"

#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "acquisition/recording/frame_stream.h"
#include "bench/plan/bench_air.h"
#include "bench/plan/descriptions.h"
#include "bench/session/manifest.h"
#include "tests/bench/run/measured_session.h"

namespace todbench {
namespace {

using ::testing::Contains;
using testing::content_of;
using ::testing::HasSubstr;
using testing::MeasuredSession;
using ::testing::Not;

TEST_F(MeasuredSession, KeepsWhatTheInstrumentsSaidOfEveryPresentation) {
  plan_.measurement.max_readback_deviation_k = 1e-6;

  const auto run = measure("m");

  ASSERT_TRUE(run) << run.error().message;
  ASSERT_FALSE(run->ended_by) << run->ended_by->message;
  const auto session = read_session(at("m"));
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_EQ(session->presentations.size(), 2u * 3u);
  double largest_k = 0;
  for (std::size_t i = 0; i < session->presentations.size(); ++i) {
    const Presentation& shown = session->presentations[i];
    const Trial& trial = session->trials[i * 20];
    EXPECT_EQ(shown.presentation, trial.presentation);
    EXPECT_EQ(shown.set.delta_t_k, trial.set_delta_t_k);
    EXPECT_EQ(shown.delta_t_k, trial.delta_t_k);
    EXPECT_LE(shown.host_time_ns, trial.host_time_ns);
    const double deviation_k = shown.said.state.delta_t_k - shown.set.delta_t_k;
    largest_k = std::max(largest_k, std::abs(deviation_k));
    EXPECT_LT(std::abs(deviation_k), 0.002);
    ASSERT_TRUE(shown.said.plate_temperature_k && shown.said.black_body_temperature_k);
    // Both temperatures are as they are, the difference is as the sensors say: 2 % apart.
    EXPECT_NEAR(*shown.said.black_body_temperature_k - *shown.said.plate_temperature_k,
                1.02 * shown.said.state.delta_t_k, 0.002);
    EXPECT_GE(shown.said.settling_s, 0);
  }
  EXPECT_GT(largest_k, 1e-6) << "the black body was still on its way within its window";
  EXPECT_GT(session->presentations.front().said.settling_s, 1) << "nothing settles at once";
  EXPECT_THAT(session->provenance.run->notes, Contains(HasSubstr("the target reports")));
  EXPECT_EQ(session->twin_presentations.size(), 2u * 2u);
  for (const auto& shown : session->twin_presentations) EXPECT_FALSE(shown.host_time_ns);
  for (const auto& note : session->provenance.twin_run->notes) EXPECT_THAT(note, Not(HasSubstr("the target reports")));
  EXPECT_THAT(verify_manifest(at("m")).value(), ::testing::IsEmpty());
  const std::string report = content_of(at("m") / "report.html");
  for (const char* column : {"Read back (K)", "Observed (K)", "Observed − read back (K)", "Longest settling (s)"})
    EXPECT_THAT(report, HasSubstr(column));
  ASSERT_TRUE(run->forecast);
  EXPECT_EQ(session->provenance.forecast, run->forecast);
  EXPECT_THAT(report, HasSubstr("Forecast (s)"));
}

TEST_F(MeasuredSession, WithinTheToleranceOfThePlanHasNoNoteOfItsReadBackAndStatesTheAir) {
  plan_.target.air_humidity_percent = 60;

  const auto run = measure("m");

  ASSERT_TRUE(run) << run.error().message;
  const auto session = read_session(at("m"));
  ASSERT_TRUE(session) << session.error().message;
  const double air = bench_transmittance({.temperature_c = 20, .humidity_percent = 60}, 2, {7.5, 13}).value();
  for (const Presentation& shown : session->presentations) EXPECT_EQ(shown.air_transmittance, air);
  EXPECT_THAT(content_of(at("m") / "report.html"), HasSubstr("Read back × transmittance (K)"));
  // Neither its twin nor a simulation has air.
  for (const Presentation& shown : session->twin_presentations) EXPECT_FALSE(shown.air_transmittance);
  EXPECT_THAT(content_of(at("m") / "log.txt"), Not(HasSubstr("the target reports")));
}

TEST_F(MeasuredSession, ReplaysWithTheSameTrialsAndTheSameReadings) {
  plan_.fit.estimator = EstimatorChoice::automatic;
  ASSERT_TRUE(measure("m"));

  const auto replay = replay_session(at("m"), options("r"), {}, {});

  ASSERT_TRUE(replay) << replay.error().message;
  EXPECT_TRUE(replay->same_trials);
  EXPECT_EQ(replay->same_fits, true);
  for (const char* file : {"targets.csv", "targets_simulated.csv", "trials.csv", "trials_simulated.csv"})
    EXPECT_EQ(content_of(at("r") / file), content_of(at("m") / file)) << file;
  EXPECT_FALSE(read_session(at("r")).value().provenance.forecast) << "the presentations were before this run";
}

TEST_F(MeasuredSession, WithLimitsOnPhysicalMeasuresReplaysWithoutThem) {
  plan_.measures.geometry = true;
  plan_.limits.measures.push_back({.measure = "ifov_x", .at_least = 1.0, .at_most = 2.0});
  ASSERT_TRUE(measure("m"));

  const auto replay = replay_session(at("m"), options("r"), {}, {});

  ASSERT_TRUE(replay) << replay.error().message;
  EXPECT_TRUE(replay->same_trials);
  EXPECT_THAT(content_of(at("r") / "log.txt"), HasSubstr("limits on physical measures are left out"));
}

TEST_F(MeasuredSession, OfAVersionThatKeptLessOfATrialReplaysAsFarAsItIsKnown) {
  ASSERT_TRUE(measure("m"));
  const std::filesystem::path file = at("m") / "trials.csv";
  // Two columns less are a file before places in the picture, two more less one before graded answers, one more less
  // one before saturated pixels.
  int version = 0;
  for (const int left_out : {2, 2, 1}) {
    std::istringstream lines(content_of(file));
    std::string earlier;
    for (std::string line; std::getline(lines, line);) {
      for (int k = 0; k < left_out; ++k) line.resize(line.rfind(','));
      earlier += line + "\n";
    }
    std::ofstream(file) << earlier;
    ASSERT_TRUE(refresh_manifest(at("m"), {"trials.csv"}));

    const auto replay = replay_session(at("m"), options("r" + std::to_string(++version)), {}, {});

    ASSERT_TRUE(replay) << replay.error().message;
    EXPECT_TRUE(replay->same_trials);
  }
  auto trials = read_trials(file).value();
  trials[7].answer = trials[7].answer == Apex::up ? Apex::down : Apex::up;
  auto writer = TrialsWriter::create(file);
  for (const Trial& trial : trials) ASSERT_TRUE(writer->append(trial));
  ASSERT_TRUE(refresh_manifest(at("m"), {"trials.csv"}));
  EXPECT_FALSE(replay_session(at("m"), options("changed"), {}, {})->same_trials);
}

TEST_F(MeasuredSession, OfAnotherFormatIsRefused) {
  ASSERT_TRUE(measure("m"));
  for (const auto& [format, said] : {std::pair("3", "found format 3"), std::pair("", "found format 1")}) {
    rewrite_recording("m", [&](FrameStream& stream) {
      stream.header.annotations["answers_format"] = format;
      // The first versions did not say so, and wrote no questions.
      if (std::string(format).empty()) stream.header.annotations.erase("answers_format");
    });

    const auto replay = replay_session(at("m"), options("r"), {}, {});

    ASSERT_FALSE(replay) << format;
    EXPECT_EQ(replay.error().code, ErrorCode::invalid_input);
    EXPECT_THAT(replay.error().message, HasSubstr("expected a measurement with answers in format 2"));
    EXPECT_THAT(replay.error().message, HasSubstr(said));
    EXPECT_FALSE(std::filesystem::exists(at("r")));
  }
}

TEST_F(MeasuredSession, WhoseMeasurementAskedOtherwiseIsRefusedAlsoInTheMiddle) {
  ASSERT_TRUE(measure("m"));
  rewrite_recording("m", [](FrameStream& stream) {
    // A version that did not look at the clock before one of its presentations.
    const auto due = clock_answer(Moment::correction_due, 0).tag;
    std::size_t seen = 0;
    std::erase_if(stream.readings, [&](const Reading& reading) { return reading.tag == due && ++seen == 4; });
  });

  const auto replay = replay_session(at("m"), options("r"), {}, {});

  ASSERT_FALSE(replay);
  EXPECT_EQ(replay.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(replay.error().message, HasSubstr("expected 'clock.correction_due', found 'target'"));
}

TEST_F(MeasuredSession, ThatWasCutOffReplaysAsFarAsItsAnswersGo) {
  ASSERT_TRUE(measure("m"));
  const auto file = recorded_frames(at("m"));
  std::filesystem::resize_file(file, std::filesystem::file_size(file) * 9 / 10);
  ASSERT_TRUE(refresh_manifest(at("m"), {"frames/camera.todrec"}));

  const auto replay = replay_session(at("m"), options("r"), {}, {});

  ASSERT_TRUE(replay) << replay.error().message;
  ASSERT_TRUE(replay->run.ended_by);
  EXPECT_EQ(replay->run.ended_by->code, ErrorCode::disconnected);
  const std::string then = content_of(at("m") / "trials.csv"), now = content_of(at("r") / "trials.csv");
  EXPECT_GT(now.size(), 1000u);
  EXPECT_TRUE(then.starts_with(now));
}

}  // namespace
}  // namespace todbench
