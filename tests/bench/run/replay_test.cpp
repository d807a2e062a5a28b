// A session with instruments that say what they show: what is kept of it, and what a replay makes of it.
#include "bench/run/replay.h"

#include <gmock/gmock.h>

#include <fstream>
#include <functional>
#include <sstream>

#include "acquisition/recording/frame_stream.h"
#include "bench/plan/descriptions.h"
#include "bench/run/recorded_bench.h"
#include "bench/session/manifest.h"
#include "sim_devices/lab/instruments/black_body.h"
#include "sim_devices/lab/instruments/plate_stage.h"
#include "sim_devices/sensor/simulated_camera.h"
#include "tests/support/temporary_folder.h"
#include "tests/tod/measurement/fake_clock.h"
#include "tod/instruments/scpi_target.h"

namespace todbench {
namespace {

using ::testing::Contains;
using testing::content_of;
using ::testing::HasSubstr;
using ::testing::Not;

Plan short_plan() {
  Plan plan = *load_plan("demo");
  plan.camera = {};
  plan.camera.id = "sim:sc2000";
  plan.camera.ifov_mrad = load_sensor("sc2000")->ifov_mrad();
  plan.camera.nuc_interval_s = 3600;
  plan.camera.nuc_wait_s = 0;
  plan.target.plates = {"tcat-a"};
  plan.target.mountings = {Mounting::identity};
  plan.target.delta_t_k = {16.9, 1.93};
  plan.target.phases = 3;
  plan.simulation.accuracy = "draft";
  plan.simulation.phases = 2;
  plan.measurement.registration_frames = 4;
  plan.measurement.contrast_frames = 4;
  plan.measurement.record_frames = true;
  plan.limits = {};
  return plan;
}

/// What the instruments reach is what the simulated camera sees, as the black body really is.
class SceneBehindInstruments final : public Target {
 public:
  SceneBehindInstruments(std::unique_ptr<Target> instruments, std::unique_ptr<Target> scene,
                         const BlackBody& black_body)
      : instruments_(std::move(instruments)), scene_(std::move(scene)), black_body_(black_body) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return instruments_->capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    auto said = instruments_->present(state, stop);
    if (!said) return said;
    TargetState real = said->state;
    real.delta_t_k = black_body_.state().delta_t_k;
    if (auto shown = scene_->present(real, stop); !shown) return shown;
    return said;
  }

 private:
  std::unique_ptr<Target> instruments_, scene_;
  const BlackBody& black_body_;
};

/// An emulated black body, still drifting within its window and 2 % off its scale, an emulated plate stage, and a
/// simulated camera.
class MeasuredSession : public ::testing::Test {
 protected:
  MeasuredSession() {
    const FakeClock clock(0.01);
    BlackBodyOptions black_body;
    black_body.time_constant_s = 1;
    black_body.stable_dwell_s = 0;
    black_body.calibration_gain = 1.02;
    black_body.now = clock.now();
    black_body_ = BlackBody::start(black_body).value();
    PlateStageOptions stage;
    stage.plates = {"tcat-a"};
    stage.now = clock.now();
    stage_ = PlateStage::start(stage).value();
    ScpiTargetOptions options;
    options.black_body = black_body_->endpoint();
    options.stage = stage_->endpoint();
    options.poll_interval = std::chrono::milliseconds(0);
    options.connection = {.connect_timeout = std::chrono::minutes(1), .answer_timeout = std::chrono::minutes(1)};
    options.now = clock.now();
    instruments_ = open_scpi_target(options, {}).value();
  }

  [[nodiscard]] OpenedBench bench(const ExperimentInputs& inputs) {
    const auto spec = load_sensor("sc2000").value();
    auto model = std::make_shared<const SensorModel>(spec, full_plan(spec, {}, {}), Accuracy::draft(), 1);
    PlateScene scene;
    scene.plate = inputs.plates.front();
    scene.distance_m = plan_.target.distance_m;
    const auto holder = std::make_shared<SceneHolder>(scene);
    OpenedBench out;
    out.camera = simulated_source(std::move(model), holder, "1");
    out.target = std::make_unique<SceneBehindInstruments>(std::move(instruments_), scene_target(holder, inputs.plates),
                                                          *black_body_);
    return out;
  }

  [[nodiscard]] Result<ExperimentOutcome> measure(const std::string& name) {
    const auto loaded = LoadedPlan::load(plan_);
    if (!loaded) return tl::unexpected(loaded.error());
    EffectPlanner planner;
    const auto inputs = experiment_inputs(*loaded, planner);
    if (!inputs) return tl::unexpected(inputs.error());
    return measure_on_bench(*loaded, *inputs, bench(*inputs), options(name), {}, {});
  }
  [[nodiscard]] ExperimentOptions options(const std::string& name) const {
    return {.folder = at(name), .existing = ExistingFolder::refuse};
  }
  [[nodiscard]] std::filesystem::path at(const std::string& name) const { return folder_.path() / name; }

  /// The recording of a session once more, with something changed on the way.
  void rewrite_recording(const std::string& session, const std::function<void(FrameStream&)>& change) const {
    auto stream = open_frame_stream(recorded_frames(at(session)));
    ASSERT_TRUE(stream) << stream.error().message;
    change(*stream);
    const std::filesystem::path other = at(session) / "frames" / "other.todrec";
    auto writer = FrameStreamWriter::create(other, stream->header);
    ASSERT_TRUE(writer) << writer.error().message;
    const auto source = recorded_source(stream->recording, Playback::replay);
    ASSERT_TRUE(source->start());
    for (std::uint64_t i = 0; i < stream->recording.frame_count; ++i) {
      const auto frame = source->next(std::chrono::seconds(1));
      ASSERT_TRUE(frame && writer->append(*frame));
    }
    for (const Reading& reading : stream->readings) ASSERT_TRUE(writer->append_reading(reading));
    std::filesystem::rename(other, recorded_frames(at(session)));
    ASSERT_TRUE(refresh_manifest(at(session), {"frames/camera.todrec"}));
  }

  testing::TemporaryFolder folder_;
  Plan plan_ = short_plan();
  std::unique_ptr<BlackBody> black_body_;
  std::unique_ptr<PlateStage> stage_;
  std::unique_ptr<Target> instruments_;
};

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
  EXPECT_THAT(session->provenance.run->notes, Contains(HasSubstr("the target says it shows")));
  EXPECT_EQ(session->twin_presentations.size(), 2u * 2u);
  for (const auto& shown : session->twin_presentations) EXPECT_FALSE(shown.host_time_ns);
  for (const auto& note : session->provenance.twin_run->notes) EXPECT_THAT(note, Not(HasSubstr("the target says")));
  EXPECT_THAT(verify_manifest(at("m")).value(), ::testing::IsEmpty());
  const std::string report = content_of(at("m") / "report.html");
  for (const char* column : {"Read back (K)", "Seen (K)", "Seen − read back (K)", "Longest settling (s)"})
    EXPECT_THAT(report, HasSubstr(column));
}

TEST_F(MeasuredSession, WithinTheToleranceOfThePlanHasNoNoteOfItsReadBack) {
  const auto run = measure("m");

  ASSERT_TRUE(run) << run.error().message;
  EXPECT_THAT(content_of(at("m") / "log.txt"), Not(HasSubstr("the target says it shows")));
}

TEST_F(MeasuredSession, ReplaysWithTheSameTrialsAndTheSameReadings) {
  ASSERT_TRUE(measure("m"));

  const auto replay = replay_session(at("m"), options("r"), {}, {});

  ASSERT_TRUE(replay) << replay.error().message;
  EXPECT_TRUE(replay->same_trials);
  EXPECT_EQ(replay->same_fits, true);
  for (const char* file : {"targets.csv", "targets_simulated.csv", "trials.csv", "trials_simulated.csv"})
    EXPECT_EQ(content_of(at("r") / file), content_of(at("m") / file)) << file;
}

TEST_F(MeasuredSession, OfGradedAnswersReplaysWithTheSameProbabilitiesAndTheFunctionOfTheTwin) {
  plan_.schedule.answers = AnswerKind::graded;
  plan_.schedule.frames_per_presentation = 3;
  plan_.fit.estimator = FitEstimator::twin_shape;
  ASSERT_TRUE(measure("m"));

  const auto replay = replay_session(at("m"), options("r"), {}, {});

  ASSERT_TRUE(replay) << replay.error().message;
  EXPECT_TRUE(replay->same_trials);
  EXPECT_EQ(replay->same_fits, true);
  const auto session = read_session(at("r"));
  ASSERT_TRUE(session) << session.error().message;
  for (const Trial& trial : session->trials) {
    EXPECT_TRUE(trial.probability_correct);
    EXPECT_EQ(trial.frames, 3);
  }
  for (const TodPoint& point : session->curve->points) {
    ASSERT_TRUE(point.fit.twin_shape) << point.set_delta_t_k;
    EXPECT_NEAR(point.fit.twin_shape->size_ratio, 1, 0.1);
    EXPECT_EQ(point.fit.interval, IntervalKind::two_way) << "one set-up";
    EXPECT_TRUE(point.fit.usable());
  }
  EXPECT_THAT(content_of(at("r") / "report.html"), HasSubstr("The function is that of the simulated twin"));
}

TEST_F(MeasuredSession, OfAVersionThatKeptLessOfATrialReplaysAsFarAsItIsKnown) {
  ASSERT_TRUE(measure("m"));
  const std::filesystem::path file = at("m") / "trials.csv";
  // Two columns less are a file before graded answers, one more less is one before saturated pixels.
  for (const int left_out : {2, 1}) {
    std::istringstream lines(content_of(file));
    std::string earlier;
    for (std::string line; std::getline(lines, line);) {
      for (int k = 0; k < left_out; ++k) line.resize(line.rfind(','));
      earlier += line + "\n";
    }
    std::ofstream(file) << earlier;
    ASSERT_TRUE(refresh_manifest(at("m"), {"trials.csv"}));

    const auto replay = replay_session(at("m"), options("r" + std::to_string(left_out)), {}, {});

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
