// SPDX-License-Identifier: GPL-3.0-or-later
// The choice of a camera: what of the demonstration may stay, how the camera is controlled, whose failure it was.
#include "bench/gui/presenters/device_plan.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <optional>

#include "acquisition/recording/frame_stream.h"
#include "bench/gui/presenters/look_presenter.h"
#include "tests/bench/gui/gui_test_support.h"
#include "tod/presentation/target_failure.h"

namespace todbench {
namespace {

using testing::wait_until;

Plan demo_plan() {
  auto plan = load_plan("demo");
  EXPECT_TRUE(plan);
  return plan.value_or(Plan{});
}

TEST(PlanForCamera, KeepsNothingOfTheDemonstration) {
  const Plan demo = demo_plan();

  const Plan plan = plan_for_camera(demo, "gige:Maker-0815");

  EXPECT_EQ(plan.camera.id, "gige:Maker-0815");
  EXPECT_EQ(plan.camera.ifov_mrad, 0) << "nobody stated it";
  EXPECT_EQ(plan.target.kind, TargetKind::prompt);
  EXPECT_NE(plan.name, demo.name);
  for (const std::string* words :
       {&plan.description, &plan.operator_name, &plan.place, &plan.unit, &plan.target.black_body, &plan.target.stage})
    EXPECT_EQ(*words, "");
  EXPECT_TRUE(plan.limits.acuity.empty());
  EXPECT_EQ(plan.target.plate_change_s, TargetPlan{}.plate_change_s) << "a person is slower than emulated instruments";
  EXPECT_EQ(plan.target.delta_t_k, demo.target.delta_t_k) << "the test itself stays";
  Plan back = plan_for_laboratory(plan);
  EXPECT_NEAR(back.camera.ifov_mrad, demo.camera.ifov_mrad, 1e-4) << "of the sensor, not rounded";
  back.camera.ifov_mrad = demo.camera.ifov_mrad;
  EXPECT_TRUE(back == demo) << "the way back";
}

TEST(PlanForCamera, KeepsNoLimitAndNoBudgetOfTheAcceptancePlan) {
  const auto acceptance = load_plan("acceptance");
  ASSERT_TRUE(acceptance);
  ASSERT_FALSE(acceptance->limits.measures.empty());
  ASSERT_FALSE(acceptance->limits.zones.empty());

  const Plan plan = plan_for_camera(*acceptance, "gige:Maker-0815");

  EXPECT_EQ(plan.description, "");
  EXPECT_EQ(plan.unit, "");
  EXPECT_TRUE(plan.limits.acuity.empty());
  EXPECT_TRUE(plan.limits.measures.empty()) << "IFOV and NETD of another camera";
  EXPECT_TRUE(plan.limits.zones.empty());
  EXPECT_TRUE(plan.uncertainty.rows.empty()) << "certificates of a laboratory that does not exist";
  EXPECT_TRUE(plan.uncertainty.require) << "the budget that the plan demands has to be stated";
  EXPECT_TRUE(plan.measures.mtf) << "the test itself stays";

  Plan mine = *acceptance;
  mine.uncertainty.rows.front().value += 1;
  const std::vector<BudgetRow> kept = plan_for_camera(mine, "gige:Maker-0815").uncertainty.rows;
  ASSERT_EQ(kept.size(), 1u) << "the other rows are still those of the example";
  EXPECT_EQ(kept.front(), mine.uncertainty.rows.front());
}

TEST(PlanForCamera, KeepsTheStatementsOfTheUser) {
  Plan mine = demo_plan();
  mine.operator_name = "A. Example";
  mine.limits.acuity.front().least_acuity_per_mrad = 0.7;
  mine.target.black_body = "10.0.0.7:5025";
  mine.camera.settings = {{"Gain", "2"}};

  const Plan plan = plan_for_camera(mine, "gige:Maker-0815");

  EXPECT_EQ(plan.operator_name, "A. Example");
  EXPECT_EQ(plan.limits.acuity, mine.limits.acuity);
  EXPECT_EQ(plan.target.kind, TargetKind::scpi) << "instruments of the user's own";
  EXPECT_EQ(plan.target.black_body, "10.0.0.7:5025");
  EXPECT_TRUE(plan.camera.settings.empty()) << "features of another camera";
  EXPECT_EQ(plan_for_camera(plan, "gige:Maker-0815"), plan) << "the same camera chosen again";
}

TEST(PlanForCamera, KeepsNoReportNumberAndNoConditionOfAnotherUnit) {
  Plan mine = plan_for_camera(demo_plan(), "gige:Maker-0815");
  mine.order = {.customer = "Example Ltd", .report_number = "R-17", .item = "EX-1 no. 0815", .issued = "2026-11-28"};

  const Plan same = plan_for_camera(mine, "gige:Maker-0815"), other = plan_for_camera(mine, "gige:Maker-0816");

  EXPECT_EQ(same.order, mine.order);
  EXPECT_EQ(other.order, (OrderPlan{.customer = "Example Ltd"})) << "two units with one report number";
  Plan early = demo_plan();
  early.order = mine.order;
  EXPECT_EQ(plan_for_camera(early, "gige:Maker-0815").order, mine.order) << "stated before the first camera was chosen";
}

TEST(Workbench, FollowsTheCameraOfAPlanThatIsLoaded) {
  testing::TemporaryFolder folder;
  Workbench bench(folder.path());
  Plan plan = bench.plan();
  plan.camera.id = "gige:Maker-0815";

  bench.set_plan(plan);

  EXPECT_EQ(bench.device(), QString("gige:Maker-0815"));
  EXPECT_EQ(bench.plan(), plan) << "a loaded plan is used as it is";
  EXPECT_EQ(bench.devices().back().id, QString("gige:Maker-0815"));
  bench.shut_down();
}

/// Health of the device and the remedy that the window offers after a job that ends with an error.
struct Ended {
  DeviceHealth health = DeviceHealth::ready;
  std::optional<Remedy> remedy;
};
Ended after(const Error& error) {
  testing::TemporaryFolder folder;
  Workbench bench(folder.path());
  EXPECT_TRUE(bench.select_device("sim:sc2000"));
  Ended ended;
  QObject::connect(&bench, &Workbench::trouble, [&](const QString&, Remedy remedy) { ended.remedy = remedy; });
  bench.run(Activity::measuring,
            [&](const Plan&, const std::stop_token&) { return Result<void>(tl::unexpected(error)); });
  EXPECT_TRUE(wait_until([&] { return bench.activity() == Activity::idle; }));
  for (const DeviceEntry& entry : bench.devices()) {
    if (entry.id == bench.device()) ended.health = entry.health;
  }
  bench.shut_down();
  return ended;
}

TEST(Workbench, MarksTheCameraAsLostOnlyIfItWasTheCamera) {
  const Error gone{ErrorCode::not_found, "no connection within the time limit"};

  EXPECT_EQ(after(gone).health, DeviceHealth::lost);
  EXPECT_EQ(after(target_failure("opening the target", gone).value()).health, DeviceHealth::ready);
  EXPECT_EQ(after(with_context("measuring", target_failure("presenting the target", gone).value())).health,
            DeviceHealth::ready);
}

TEST(Workbench, OffersToTryAgainOnlyWhatCanBeTriedAgain) {
  for (const ErrorCode code : {ErrorCode::not_found, ErrorCode::disconnected, ErrorCode::timeout})
    EXPECT_EQ(after({code, "gone"}).remedy, Remedy::try_again);
  for (const ErrorCode code : {ErrorCode::invalid_input, ErrorCode::calibration, ErrorCode::io})
    EXPECT_EQ(after({code, "wrong"}).remedy, Remedy::none);
}

/// A camera that changes its frame rate only while it stands still.
class RefusingCamera final : public FrameSource {
 public:
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] Result<void> start() override {
    ++starts;
    streaming = true;
    return {};
  }
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds) override { return fail(ErrorCode::timeout, "none"); }
  void stop() override { streaming = false; }
  [[nodiscard]] Result<std::string> get(const std::string& feature) override {
    if (feature == "IRFrameRate") return rate;
    if (feature == "GainRaw") return std::string("3");
    return fail(ErrorCode::invalid_input, "no feature '" + feature + "'");
  }
  [[nodiscard]] Result<void> set(const std::string&, const std::string& value) override {
    if (streaming) return fail(ErrorCode::invalid_input, "locked while streaming");
    if (value == "9999") return fail(ErrorCode::invalid_input, "out of range");
    rate = value;
    return {};
  }
  [[nodiscard]] Result<void> correct_nonuniformity() override { return {}; }

  int starts = 0;
  bool streaming = false;
  std::string rate = "50";

 private:
  SourceInfo info_;
};

TEST(CameraDesk, FindsTheFeatureBehindAControlByTheNamesOfTheMakers) {
  RefusingCamera camera;

  const auto readings = read_controls(camera);

  ASSERT_EQ(readings.size(), all_camera_controls.size());
  EXPECT_EQ(readings[0].feature, "IRFrameRate");
  EXPECT_EQ(readings[0].value, "50");
  EXPECT_EQ(readings[1].feature, "GainRaw");
  EXPECT_EQ(readings[2].feature, "") << "has no range";
}

TEST(CameraDesk, StopsACameraThatRefusesWhileItStreamsAndStartsItAgain) {
  RefusingCamera camera;
  ASSERT_TRUE(camera.start());

  const auto set = change_feature(camera, "IRFrameRate", "25");

  ASSERT_TRUE(set) << set.error().message;
  EXPECT_EQ(*set, "25");
  EXPECT_TRUE(camera.streaming);
  EXPECT_FALSE(change_feature(camera, "IRFrameRate", "9999"));
  EXPECT_TRUE(camera.streaming) << "a refusal does not end the picture";
  EXPECT_EQ(camera.rate, "25");
}

TEST(LookPresenter, RecordsAndTakesSnapshotsAndShowsARecordingWhoseTargetFails) {
  testing::TemporaryFolder folder;
  Workbench bench(folder.path());
  LookPresenter look(bench);
  QStringList notes;
  QObject::connect(&bench, &Workbench::noted, [&](const QString& sentence) { notes << sentence; });
  ASSERT_TRUE(bench.select_device("sim:sc2000"));
  look.start();
  ASSERT_TRUE(wait_until([&] { return look.latest().has_value() && !look.controls().empty(); }));

  const auto picture = look.snapshot();
  look.toggle_recording();
  ASSERT_TRUE(look.recording());
  // The picture may be older than the recording by many frames, and so may the next one that was already shown.
  const auto good = [&] { return look.latest()->counters.good; };
  for (int picture_after = 0; picture_after < 2; ++picture_after) {
    ASSERT_TRUE(wait_until([&, before = good()] { return good() > before; }));
  }
  ASSERT_TRUE(wait_until([&, before = good()] { return good() >= before + 3; }));
  look.toggle_recording();
  look.stop();
  ASSERT_TRUE(wait_until([&] { return bench.activity() == Activity::idle; }));

  ASSERT_TRUE(picture) << picture.error().message;
  EXPECT_GT(std::filesystem::file_size(*picture), 2u * 320 * 240);
  std::filesystem::path file;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    if (entry.path().extension() == ".todrec") file = entry.path();
  }
  const auto stream = open_frame_stream(file);
  ASSERT_TRUE(stream) << stream.error().message;
  EXPECT_GE(stream->recording.frame_count, 3u);
  EXPECT_THAT(notes.join('\n').toStdString(), ::testing::HasSubstr("Recorded"));

  // The recording in place of a camera, before instruments that do not answer.
  ASSERT_TRUE(bench.select_device(QString::fromStdString("file:" + file.string())));
  Plan plan = bench.plan();
  plan.camera.ifov_mrad = 1.3085;
  plan.target.kind = TargetKind::scpi;
  plan.target.black_body = plan.target.stage = "127.0.0.1:1";
  bench.set_plan(plan);
  look.start();
  const auto told = [&] { return notes.join('\n').contains("without its target"); };
  EXPECT_TRUE(wait_until(told)) << notes.join('\n').toStdString();
  bench.shut_down();
}

}  // namespace
}  // namespace todbench
