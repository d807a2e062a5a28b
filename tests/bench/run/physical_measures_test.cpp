// SPDX-License-Identifier: GPL-3.0-or-later
// Physical measures that a plan asks for: of the simulated sensor, whose noise and scale are known, and in a session.
#include "bench/run/physical_measures.h"

#include <gmock/gmock.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "acquisition/core/forwarding_source.h"
#include "bench/plan/descriptions.h"
#include "bench/report/report.h"
#include "bench/run/experiment.h"
#include "bench/run/replay.h"
#include "bench/run/report_data.h"
#include "bench/session/measure_pictures.h"
#include "bench/session/measures_record.h"
#include "bench/session/open_session.h"
#include "bench/text/base64.h"
#include "bench/text/files.h"
#include "bench/text/text.h"
#include "sim_devices/sensor/pixel_faults.h"
#include "tests/bench/run/measures_plan.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using testing::line_of;
using testing::measures_plan;
using testing::plan_of_one;
using testing::TemporaryFolder;

/// A camera with one feature, which reads back otherwise than at the start.
class SwitchedCamera final : public ForwardingSource {
 public:
  SwitchedCamera(std::unique_ptr<FrameSource> camera, std::string feature)
      : ForwardingSource(std::move(camera)), info_(ForwardingSource::info()), feature_(std::move(feature)) {
    info_.settings = {{feature_, "HighGain"}};
  }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] Result<std::string> get(const std::string& feature) override {
    return feature == feature_ ? Result<std::string>("LowGain") : ForwardingSource::get(feature);
  }

 private:
  SourceInfo info_;
  std::string feature_;
};

TEST(PhysicalMeasures, OfACameraWhoseScaleChangedAreNotStated) {
  for (const std::string feature : {"SensorGainMode", "FanSpeed"}) {
    const TemporaryFolder folder;
    const LoadedPlan loaded = LoadedPlan::load(measures_plan()).value();
    EffectPlanner planner;
    const ExperimentInputs inputs = experiment_inputs(loaded, planner).value();
    OpenedBench bench = open_bench(loaded, {}, {}, {}, {}).value();
    bench.camera = std::make_unique<SwitchedCamera>(std::move(bench.camera), feature);

    const auto outcome =
        measure_on_bench(loaded, inputs, std::move(bench), {.folder = folder.path() / "session"}, {}, {});

    ASSERT_TRUE(outcome) << outcome.error().message;
    ASSERT_TRUE(outcome->measures);
    EXPECT_EQ(outcome->measures->noise.has_value(), feature == "FanSpeed");
    ASSERT_FALSE(outcome->measures->reasons.empty());
    EXPECT_THAT(outcome->measures->reasons.back(), HasSubstr(feature + " was HighGain at the start"));
  }
}

TEST(PhysicalMeasures, FindTheNoiseAndTheScaleOfTheSimulatedSensor) {
  const TemporaryFolder folder;
  const SensorSpec sensor = *load_sensor("sc2000");

  const auto outcome = simulate_plan(measures_plan(), {.folder = folder.path() / "session"}, {}, {});

  ASSERT_TRUE(outcome) << outcome.error().message;
  ASSERT_FALSE(outcome->ended_by) << outcome->ended_by->message;
  ASSERT_TRUE(outcome->measures);
  EXPECT_THAT(outcome->measures->reasons, ::testing::IsEmpty());
  const auto session = open_session(folder.path() / "session", {});
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_TRUE(session->measures);
  EXPECT_FALSE(session->measures->twin);
  const auto* noise = line_of(session->measures->main, "temporal_noise");
  const auto* slope = line_of(session->measures->main, "transfer_slope");
  const auto* netd = line_of(session->measures->main, "netd");
  const auto* pixels = line_of(session->measures->main, "noise_tvh");
  ASSERT_TRUE(noise && slope && netd && pixels);
  // White noise of the sensor and of rounding to its counts; four standard errors of a standard deviation from 16
  // frames of some ten thousand pixels are 0.8 %.
  const double expected_k = std::hypot(sensor.netd_k, sensor.kelvin_per_count / std::sqrt(12.0));
  EXPECT_NEAR(noise->value.value(), expected_k, 0.01 * expected_k);
  EXPECT_LT(noise->ci95.low.value(), noise->value.value());
  EXPECT_GT(noise->ci95.high.value(), noise->value.value());
  EXPECT_NEAR(pixels->value.value(), expected_k, 0.01 * expected_k);
  // The sensor's scale is right. A contrast from 8 frames and the medians of a few triangles is known to some 15 mK,
  // a slope over 8 K to 3 mK/K.
  EXPECT_NEAR(slope->value.value(), 1, 0.012);
  EXPECT_NEAR(netd->value.value(), noise->value.value() / slope->value.value(), 1e-9);
  const auto relative = [](const MeasureLine* line) {
    return 0.5 * (*line->ci95.high - *line->ci95.low) / *line->value;
  };
  EXPECT_NEAR(relative(netd) / std::hypot(relative(noise), relative(slope)), 1, 0.01);
  const auto* model = line_of(session->measures->main, "netd_model");
  ASSERT_NE(model, nullptr);
  EXPECT_NEAR(model->value.value(), expected_k, 1e-3 * expected_k);
  // No rows, columns or whole frames flicker in it: their variances are below a hundredth of the pixels'.
  for (const char* name : {"noise_t", "noise_tv", "noise_th"}) {
    const auto* line = line_of(session->measures->main, name);
    ASSERT_NE(line, nullptr);
    EXPECT_LT(line->value.value(), 0.1 * expected_k) << name;
  }
}

TEST(PhysicalMeasures, StandBesideTheTwinInTheReportAndAreNotRepeatedByAReplay) {
  const TemporaryFolder folder;
  Plan plan = measures_plan();
  plan.measurement.record_frames = true;
  plan.measures.triangles = true;

  const auto outcome = measure_plan(plan, {.folder = folder.path() / "session"}, {}, {});

  ASSERT_TRUE(outcome) << outcome.error().message;
  ASSERT_FALSE(outcome->ended_by) << outcome->ended_by->message;
  const auto session = open_session(folder.path() / "session", {});
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_TRUE(session->measures && session->measures->main && session->measures->twin);
  const double camera = line_of(session->measures->main, "temporal_noise")->value.value();
  const double twin = line_of(session->measures->twin, "temporal_noise")->value.value();
  EXPECT_NEAR(camera, twin, 0.02 * twin);  // the camera is the same sensor here
  for (const auto* side : {&session->measures->main, &session->measures->twin}) {
    const auto* left = line_of(*side, "picture_residual_over_noise");
    ASSERT_NE(left, nullptr);
    EXPECT_NEAR(left->value.value(), 1, 0.06);
    ASSERT_TRUE((*side)->picture);
    EXPECT_TRUE(is_base64((*side)->picture->seen));
    EXPECT_EQ((*side)->picture->outlines.size(), 20u);
    ASSERT_EQ((*side)->maps.size(), 3u);
    // Six windows of 16 pixels, two columns between them.
    EXPECT_EQ((*side)->maps[2].name, "triangles");
    EXPECT_EQ((*side)->maps[2].width, 6 * 16 + 5 * 2);
    EXPECT_EQ((*side)->maps[2].height, 16);
    EXPECT_GT((*side)->maps[2].white_k, (*side)->maps[2].black_k + 1);
  }
  const auto data = report_data(*session, "session");
  ASSERT_TRUE(data) << data.error().message;
  const std::string page = render_report(*data);
  EXPECT_THAT(page, HasSubstr("Physical measures"));
  EXPECT_THAT(page, HasSubstr("3-D noise tvh"));
  EXPECT_THAT(page, HasSubstr("transfer-residuals"));
  EXPECT_THAT(page, HasSubstr("href=\"data:image/png;base64,iVBOR"));
  const auto replayed = replay_session(folder.path() / "session", {.folder = folder.path() / "again"}, {}, {}, {});
  ASSERT_TRUE(replayed) << replayed.error().message;
  EXPECT_TRUE(replayed->same_trials);
  EXPECT_FALSE(replayed->run.measures);
}

TEST(PhysicalMeasures, LeaveAMeasuredSimulatedSceneWithoutTimesOfPresentations) {
  const TemporaryFolder folder;
  Plan plan = plan_of_one(&MeasuresPlan::noise);

  const auto run = measure_plan(plan, {.folder = folder.path() / "m", .existing = ExistingFolder::refuse}, {}, {});

  ASSERT_TRUE(run) << run.error().message;
  ASSERT_FALSE(run->presentations.empty());
  for (const Presentation& shown : run->presentations) EXPECT_FALSE(shown.host_time_ns);
  const auto session = read_session(folder.path() / "m");
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_EQ(session->presentations.size(), run->presentations.size());
  for (const Presentation& shown : session->presentations) EXPECT_FALSE(shown.host_time_ns);
}

TEST(PhysicalMeasures, AreNotThereWhereNoneIsAskedForAndHaveAReasonWhereTheyCannotBe) {
  const TemporaryFolder folder;
  Plan none = measures_plan();
  none.measures = {};
  Plan unseen = measures_plan();
  unseen.measures.noise = false;
  unseen.measures.transfer_steps_k = {-0.02, 0.01, 0.02};

  const auto without = simulate_plan(none, {.folder = folder.path() / "none"}, {}, {});
  const auto lost = simulate_plan(unseen, {.folder = folder.path() / "unseen"}, {}, {});

  ASSERT_TRUE(without);
  EXPECT_FALSE(without->measures);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "none" / "measures.json"));
  ASSERT_TRUE(lost) << lost.error().message;
  EXPECT_FALSE(lost->ended_by);
  ASSERT_TRUE(lost->measures);
  EXPECT_FALSE(lost->measures->transfer);
  ASSERT_EQ(lost->measures->reasons.size(), 1u);
  EXPECT_THAT(lost->measures->reasons[0], HasSubstr("finding the plate"));
}

/// measures.json of a session, with another text in place of the first one found.
void edit_measures(const std::filesystem::path& session, const std::string& from, const std::string& to) {
  std::string text = *read_text_file(session / "measures.json");
  const auto at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  ASSERT_TRUE(write_file_atomically(session / "measures.json", text.replace(at, from.size(), to)));
}

TEST(PhysicalMeasures, KeepTheirPicturesInFilesOfTheSession) {
  const TemporaryFolder folder;
  Plan plan = measures_plan();
  plan.measures.transfer = false;
  const auto path = folder.path() / "session";
  const auto outcome = simulate_plan(plan, {.folder = path}, {}, {});
  ASSERT_TRUE(outcome) << outcome.error().message;
  const std::string text = *read_text_file(path / "measures.json");
  EXPECT_LT(text.size(), 20'000u);
  const Json json = Json::parse(text);
  EXPECT_EQ(json["main"]["picture"]["seen_png"], "pictures/main-plate-seen.png");
  EXPECT_EQ(json["main"]["maps"][0]["png"], "pictures/main-temporal_noise.png");
  const auto check = check_manifest(path);
  ASSERT_TRUE(check);
  EXPECT_TRUE(check->intact());
  EXPECT_THAT(*read_text_file(path / "manifest.json"), HasSubstr("pictures/main-fixed_pattern.png"));
  const auto whole = open_session(path, {});
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_EQ(from_base64(whole->measures->main->picture->seen), *read_text_file(path / "pictures/main-plate-seen.png"));
  // A session of an older program has the pictures in the record.
  Json old = json;
  for (const char* side : {"seen", "expected", "difference"}) {
    const std::string key = std::string(side) + "_png";
    old["main"]["picture"][key] = base64(*read_text_file(path / ("pictures/main-plate-" + std::string(side) + ".png")));
  }
  for (Json& map : old["main"]["maps"]) map["png"] = base64(*read_text_file(path / map["png"].get<std::string>()));
  const auto as_it_was = with_pictures(old, folder.path() / "nowhere");
  ASSERT_TRUE(as_it_was);
  EXPECT_EQ(*as_it_was, old);
  EXPECT_EQ(*with_pictures(json, path), old);

  // What was changed is read only when that is accepted; a picture that is missing costs no number.
  std::filesystem::remove(path / "pictures/main-temporal_noise.png");
  EXPECT_FALSE(open_session(path, {}));
  const auto without = open_session(path, {.accept_changed = true});
  ASSERT_TRUE(without) << without.error().message;
  EXPECT_EQ(without->measures->main->maps.size(), whole->measures->main->maps.size() - 1);
  EXPECT_EQ(without->measures->main->lines.size(), whole->measures->main->lines.size());
  EXPECT_EQ(without->measures->main->reasons.size(), 1u);
  edit_measures(path, "pictures/main-fixed_pattern.png", "../manifest.json.png");
  EXPECT_FALSE(open_session(path, {.accept_changed = true}));
  edit_measures(path, "../manifest.json.png", "pictures/main-fixed_pattern.png");
  ASSERT_TRUE(write_file_atomically(path / "pictures/main-fixed_pattern.png", "<script>"));
  EXPECT_FALSE(open_session(path, {.accept_changed = true}));
}

TEST(PhysicalMeasures, FindTheDefectsOfTheArrayAndJudgeThemByZones) {
  const TemporaryFolder folder;
  Plan plan = measures_plan();
  plan.measures.noise_frames = 48;
  plan.measures.pixels = true;
  plan.measures.pixels_area = PixelArea::frame;
  plan.limits.zones = {{.name = "whole", .bad_pixels = 1000, .substituted_pixels = 0},
                       {.name = "corner", .area = {0, 0, 0.1, 0.1}, .clusters = 20}};
  plan.simulation.sensor = (folder.path() / "faulty.toml").string();
  ASSERT_TRUE(
      write_file_atomically(plan.simulation.sensor, find_resource(ResourceKind::sensor, "sc2000")->text +
                                                        "dead_pixel_share = 0.0005\ndefective_pixel_share = 0.001\n"));
  const SensorSpec sensor = *load_sensor(plan.simulation.sensor);

  const auto outcome = simulate_plan(plan, {.folder = folder.path() / "session"}, {}, {});

  ASSERT_TRUE(outcome) << outcome.error().message;
  ASSERT_TRUE(outcome->measures && outcome->measures->pixels);
  const auto faults = pixel_faults(sensor);
  ASSERT_GT(faults.size(), 40u);
  const PixelDefects& found = outcome->measures->pixels->defects;
  int missed = 0;
  for (const PixelFault& fault : faults) missed += found.bad(fault.detector) == 0 ? 1 : 0;
  // A fault beside a pixel that the camera replaces is not missed; five more of a level are there by chance in 1e-9.
  EXPECT_EQ(missed, 0);
  EXPECT_GT(found.response_tested, 0);  // the largest triangles are 5 pixels large
  const auto session = open_session(folder.path() / "session", {});
  ASSERT_TRUE(session) << session.error().message;
  const auto* bad = line_of(session->measures->main, "bad_pixels");
  ASSERT_NE(bad, nullptr);
  EXPECT_GE(bad->value.value(), static_cast<double>(faults.size()));
  // What a replaced pixel takes over from a faulty neighbour makes it bad too: at most four for each.
  EXPECT_LE(bad->value.value(), static_cast<double>(faults.size()) + 6);
  ASSERT_TRUE(session->verdict);
  for (const Demand& demand : session->verdict->demands) {
    if (demand.kind == DemandKind{"zone_bad_pixels"}) {
      EXPECT_EQ(demand.decision, VerdictKind::pass) << demand.reason;
    }
    if (demand.kind == DemandKind{"zone_substituted_pixels"}) {
      EXPECT_EQ(demand.decision, VerdictKind::fail) << demand.reason;
    }
  }
  ASSERT_EQ(session->measures->main->maps.size(), 3u);
  const auto data = report_data(*session, "session");
  ASSERT_TRUE(data) << data.error().message;
  const std::string page = render_report(*data);
  for (const char* id : {"pixels-main-temporal-noise", "pixels-main-fixed-pattern", "pixels-main-defects"})
    EXPECT_THAT(page, HasSubstr(id));
}

TEST(PhysicalMeasures, ZonesThatOverlapAreRefused) {
  Plan plan = measures_plan();
  plan.measures.noise_frames = 64;
  plan.measures.pixels = true;
  plan.limits.zones = {{.name = "whole", .bad_pixels = 10},
                       {.name = "centre", .bad_pixels = 0},
                       {.name = "left", .area = {0, 0, 0.25, 1}, .bad_pixels = 3}};
  EXPECT_TRUE(validate(plan));

  plan.limits.zones[2].area[2] = 0.26;
  const auto overlapping = validate(plan);
  ASSERT_FALSE(overlapping);
  EXPECT_THAT(overlapping.error().message, HasSubstr("overlaps zone 'centre'"));
  plan.limits.zones[2].area = {0.3, 0, 0.1, 1};
  EXPECT_FALSE(validate(plan));
  plan.limits.zones.pop_back();
  plan.limits.zones[1].bad_pixels.reset();
  EXPECT_FALSE(validate(plan));
  plan.limits.zones.pop_back();
  plan.measures.noise_frames = 47;
  EXPECT_FALSE(validate(plan));
  plan.measures.noise_frames = 48;
  EXPECT_TRUE(validate(plan));
  plan.measures.noise = false;
  EXPECT_FALSE(validate(plan));
}

TEST(PhysicalMeasures, ArePlannedWithThreeStepsOrMore) {
  Plan plan = measures_plan();
  plan.measures.transfer_steps_k = {1, 2, 1};
  const auto loaded = LoadedPlan::load(plan);
  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().message, HasSubstr("transfer_steps_k"));
  EXPECT_THAT(loaded.error().message, HasSubstr("at least three different steps"));
}

}  // namespace
}  // namespace todbench
