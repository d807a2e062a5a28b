// Physical measures that a plan asks for: of the simulated sensor, whose noise and scale are known, and in a session.
#include "bench/run/physical_measures.h"

#include <gmock/gmock.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "bench/plan/descriptions.h"
#include "bench/report/report.h"
#include "bench/run/experiment.h"
#include "bench/run/plate_picture.h"
#include "bench/run/replay.h"
#include "bench/run/report_data.h"
#include "bench/session/measure_pictures.h"
#include "bench/session/measures_record.h"
#include "bench/session/open_session.h"
#include "bench/text/base64.h"
#include "bench/text/files.h"
#include "bench/text/text.h"
#include "sim_devices/sensor/pixel_faults.h"
#include "tests/bench/run/bars_coverage.h"
#include "tests/bench/run/edge_coverage.h"
#include "tests/bench/run/measures_plan.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using testing::line_of;
using testing::measures_plan;
using testing::plan_of_one;
using testing::TemporaryFolder;

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

TEST(PhysicalMeasures, FindTheMtfOfTheSensorModelAndJudgeIt) {
  const TemporaryFolder folder;
  Plan plan = plan_of_one(&MeasuresPlan::mtf);
  plan.limits.measures = {{LimitedMeasure::mtf_x, 0.5, std::nullopt}, {LimitedMeasure::mtf_y, 0.99, std::nullopt}};

  const auto outcome = measure_plan(plan, {.folder = folder.path() / "session"}, {}, {});

  ASSERT_TRUE(outcome) << outcome.error().message;
  ASSERT_FALSE(outcome->ended_by) << outcome->ended_by->message;
  ASSERT_TRUE(outcome->measures && outcome->twin_measures);
  EXPECT_THAT(outcome->measures->reasons, ::testing::IsEmpty());
  ASSERT_TRUE(outcome->measures->mtf && outcome->twin_measures->mtf);
  ASSERT_EQ(outcome->twin_measures->mtf->edges.size(), 2u);
  for (const EdgeMtf& edge : outcome->twin_measures->mtf->edges) {
    EXPECT_EQ(edge.sides, 2);
    EXPECT_NEAR(std::abs(edge.angle_deg), 5, 0.1);
    ASSERT_EQ(edge.model.size(), edge.mtf.size());
    // Noise of 0.07 K over sqrt(64) against 10 K on 30 lines: 0.003 at half a cycle; and the edge's own length.
    for (std::size_t i = 0; i <= 50; i += 5) EXPECT_NEAR(edge.mtf[i], edge.model[i], 0.015) << i;
  }
  for (const EdgeMtf& edge : outcome->measures->mtf->edges) EXPECT_TRUE(edge.model.empty());
  const auto session = open_session(folder.path() / "session", {});
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_EQ(session->plan.measures.mtf_plate, "edge");
  ASSERT_TRUE(session->measures && session->measures->main->mtf);
  EXPECT_EQ(session->measures->main->mtf->edges.size(), 2u);
  const auto* x = line_of(session->measures->main, "mtf_x");
  ASSERT_NE(x, nullptr);
  EXPECT_EQ(x->value, outcome->measures->mtf->edges[0].at(0.25));
  EXPECT_LT(x->ci95.low.value(), x->value.value());
  ASSERT_NE(line_of(session->measures->twin, "mtf_x_model"), nullptr);
  ASSERT_GE(outcome->verdict.demands.size(), 3u);
  EXPECT_EQ(outcome->verdict.demands[outcome->verdict.demands.size() - 2].decision, VerdictKind::pass);
  EXPECT_EQ(outcome->verdict.demands.back().decision, VerdictKind::fail);
  const std::string page = render_report(*report_data(*session, "session"));
  EXPECT_THAT(page, HasSubstr("MTF along y"));
  EXPECT_THAT(page, HasSubstr("mtf-xsquare"));
}

TEST(PhysicalMeasures, FindTheCtfOfTheSensorModelAndJudgeIt) {
  const TemporaryFolder folder;
  Plan plan = plan_of_one(&MeasuresPlan::ctf);
  plan.limits.measures = {{LimitedMeasure::ctf_x, 0.3, std::nullopt}, {LimitedMeasure::ctf_y, 0.95, std::nullopt}};

  const auto outcome = measure_plan(plan, {.folder = folder.path() / "session"}, {}, {});

  ASSERT_TRUE(outcome) << outcome.error().message;
  ASSERT_FALSE(outcome->ended_by) << outcome->ended_by->message;
  ASSERT_TRUE(outcome->measures && outcome->twin_measures);
  EXPECT_THAT(outcome->measures->reasons, ::testing::IsEmpty());
  ASSERT_TRUE(outcome->measures->ctf && outcome->twin_measures->ctf);
  ASSERT_EQ(outcome->twin_measures->ctf->bars.groups.size(), 10u);
  for (const BarsCtf& group : outcome->twin_measures->ctf->bars.groups) {
    ASSERT_TRUE(group.model);
    // Noise of 0.07 K over sqrt(64) against 10 K, and what the optics spread far away.
    EXPECT_NEAR(group.best.value, group.model->best, 0.015) << group.group;
    EXPECT_NEAR(group.worst.value, group.model->worst, 0.015) << group.group;
    EXPECT_LT(group.best.low, group.best.value);
  }
  for (const BarsCtf& group : outcome->measures->ctf->bars.groups) EXPECT_FALSE(group.model);
  const auto session = open_session(folder.path() / "session", {});
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_TRUE(session->measures && session->measures->main->ctf && session->measures->twin->ctf);
  EXPECT_EQ(session->measures->main->ctf->groups.size(), 10u);
  EXPECT_TRUE(session->measures->twin->ctf->groups.front().model);
  const auto* x = line_of(session->measures->main, "ctf_x");
  ASSERT_NE(x, nullptr);
  const BarsCtf* stated = outcome->measures->ctf->stated(EdgeAxis::x);
  ASSERT_NE(stated, nullptr);
  EXPECT_NEAR(stated->frequency_per_pitch, 0.4, 0.01);
  EXPECT_EQ(x->value, stated->best.value);
  ASSERT_NE(line_of(session->measures->twin, "ctf_x_model"), nullptr);
  ASSERT_GE(outcome->verdict.demands.size(), 3u);
  EXPECT_EQ(outcome->verdict.demands[outcome->verdict.demands.size() - 2].decision, VerdictKind::pass);
  EXPECT_EQ(outcome->verdict.demands.back().decision, VerdictKind::fail);
  const std::string page = render_report(*report_data(*session, "session"));
  EXPECT_THAT(page, HasSubstr("ctf-x"));
  EXPECT_THAT(page, HasSubstr("ctf-y"));
}

TEST(PlateBars, HoldTheTruthAtBestAndWorstPhase) {
  for (const double aberration_pitch : {0.0, 0.6}) {
    SensorSpec sensor = *load_sensor("sc2000");
    sensor.aberration_sigma_pitch = aberration_pitch;
    const auto coverage = testing::bars_coverage(sensor, 0.001, 12, 4);
    ASSERT_TRUE(coverage) << coverage.error().message;
    ASSERT_EQ(coverage->groups.size(), 10u);
    EXPECT_LT(coverage->largest_error, 0.02);
    double within = 0;
    for (const auto& group : coverage->groups) within += (group.within[0] + group.within[2]) / 20;
    // 240 intervals of which those of one picture share the contrast: as if 12 were independent, 0.063.
    EXPECT_GT(within, 0.95 - 3 * 0.063) << aberration_pitch;
  }
}

TEST(PlateBars, AreRefusedWhereTheyCannotBeRead) {
  const TargetPlate plate = *load_plate("bars");
  Registration where;
  where.plate_to_pixel = {0.38, 0, 160, 0, 0.38, 120, 0, 0, 1};
  EXPECT_FALSE(plate_bars_ctf(cv::Mat1d(240, 320, 5.0), plate, where));
  EXPECT_FALSE(plate_bars_ctf(cv::Mat1d(90, 90, 5.0), plate, where));
  TargetPlate no_squares = plate, no_bars = plate;
  no_squares.rectangles.clear(), no_bars.bars.clear();
  EXPECT_FALSE(plate_bars_ctf(cv::Mat1d(240, 320, 5.0), no_squares, where));
  EXPECT_FALSE(plate_bars_ctf(cv::Mat1d(240, 320, 5.0), no_bars, where));
  // So far away that no bar is long enough in pixels.
  SensorSpec sensor = *load_sensor("sc2000");
  const SensorModel model(sensor, full_plan(sensor, {}, {}), Accuracy::draft(), 1);
  PlateScene scene;
  scene.plate = plate;
  scene.distance_m = 8;
  const double scale = 1 / (scene.distance_m * sensor.ifov_mrad());
  where.plate_to_pixel = {scale, 0, 159.5, 0, scale, 119.5, 0, 0, 1};
  cv::Mat1d small;
  model.unit_signal(scene)->convertTo(small, CV_64F);
  const auto far = plate_bars_ctf(small, plate, where);
  EXPECT_TRUE(!far || far->groups.empty());
}

/// The plate as a sensor with noise sees it, the mean of 16 frames, found at the place where it is.
PlateView seen_by(const SensorSpec& sensor, const TargetPlate& plate, std::uint64_t seed) {
  const SensorModel model(sensor, full_plan(sensor, {}, {}), Accuracy::draft(), seed);
  PlateScene scene;
  scene.plate = plate;
  scene.delta_t_k = 4;
  scene.rotation_deg = 0.7;
  PlateView seen;
  seen.frames = 16;
  seen.set_delta_t_k = 4;
  seen.picture = model.size();
  seen.field = {120, 65, 75, 110};
  seen.temporal_noise_k = sensor.netd_k;
  cv::Mat1f mean(model.size(), 0.0F);
  for (int k = 0; k < seen.frames; ++k) mean += model.picture(scene, static_cast<std::uint64_t>(k)) / seen.frames;
  mean(seen.field).convertTo(seen.kelvin, CV_64F);
  // Found a little beside the truth, as a registration does.
  const double scale = 1.0005 / (scene.distance_m * sensor.ifov_mrad());
  const double angle = 0.71 * std::numbers::pi / 180;
  const cv::Point2d middle = scene_pixel(scene, {0, 0}, sensor.ifov_mrad(), model.size()) + cv::Point2d(0.02, -0.01);
  seen.where.plate_to_pixel = {scale * std::cos(angle),
                               -scale * std::sin(angle),
                               middle.x,
                               scale * std::sin(angle),
                               scale * std::cos(angle),
                               middle.y,
                               0,
                               0,
                               1};
  seen.where.scale_px_per_mm = scale;
  seen.where.rotation_deg = 0.71;
  return seen;
}

TEST(PlatePictures, LeaveTheNoiseOfARightModelAndMoreThanThatOfAWrongOne) {
  const TargetPlate plate = *load_plate("tcat-a");
  const SensorSpec right = *load_sensor("sc2000");
  SensorSpec wrong = right, other_size = right;
  wrong.aberration_sigma_pitch = 0.5;
  other_size.width = 160;
  const auto model = [](const SensorSpec& sensor) {
    return std::make_unique<SensorModel>(sensor, full_plan(sensor, {}, {}), Accuracy::draft(), 1);
  };
  int within = 0;
  constexpr int seeds = 20;
  for (std::uint64_t seed = 11; seed < 11 + seeds; ++seed) {
    const PlateView seen = seen_by(right, plate, seed);
    const auto picture = plate_picture(seen, plate, *model(right), {});
    ASSERT_TRUE(picture) << picture.error().message;
    EXPECT_NEAR(picture->contrast_k, 4, 0.02);
    EXPECT_NEAR(picture->moved_px, std::hypot(0.02, 0.01), 0.01);
    EXPECT_EQ(picture->outlines.size(), plate.triangles.size());
    // White noise of the sensor and of rounding to its counts.
    const double expected = std::hypot(1, right.kelvin_per_count / std::sqrt(12.0) / right.netd_k);
    const double relative = 1.96 / std::sqrt(2.0 * static_cast<double>(seen.kelvin.total()));
    within += std::abs(picture->residual_over_noise().value() / expected - 1) < relative ? 1 : 0;
  }
  // 20 seeds at 95 %: fewer than 15 come by chance once in 3000.
  EXPECT_GE(within, 15);
  const PlateView seen = seen_by(right, plate, 3);
  const auto apart = plate_picture(seen, plate, *model(wrong), {});
  ASSERT_TRUE(apart) << apart.error().message;
  EXPECT_GT(apart->residual_over_noise().value(), 2);
  EXPECT_FALSE(plate_picture(seen, plate, *model(other_size), {}));
}

TEST(PhysicalMeasures, RefusePlatesThatDoNotHaveWhatIsAskedOfThem) {
  const auto refusal = [](const Plan& plan) {
    const auto loaded = LoadedPlan::load(plan);
    return loaded ? std::string() : loaded.error().message;
  };
  Plan no_bars = plan_of_one(&MeasuresPlan::ctf), no_contrast = plan_of_one(&MeasuresPlan::ctf),
       no_ctf = plan_of_one(&MeasuresPlan::ctf);
  no_bars.measures.ctf_plate = "edge";
  no_contrast.measures.ctf_delta_t_k = 0;
  no_ctf.measures.ctf = false;
  no_ctf.limits.measures = {{LimitedMeasure::ctf_y, 0.5, std::nullopt}};
  Plan triangles = plan_of_one(&MeasuresPlan::mtf), rectangles = plan_of_one(&MeasuresPlan::mtf),
       flat = plan_of_one(&MeasuresPlan::mtf), unasked = plan_of_one(&MeasuresPlan::mtf),
       above = plan_of_one(&MeasuresPlan::mtf);
  triangles.measures.mtf_plate = "tcat-b";
  rectangles.target.plates = {"edge"};
  flat.measures.mtf_delta_t_k = 0;
  unasked.measures.mtf = false;
  unasked.limits.measures = {{LimitedMeasure::mtf_x, 0.5, std::nullopt}};
  above.limits.measures = {{LimitedMeasure::mtf_x, std::nullopt, 0.5}};

  Plan no_geometry = plan_of_one(&MeasuresPlan::geometry), distorted = plan_of_one(&MeasuresPlan::geometry),
       narrow = plan_of_one(&MeasuresPlan::geometry);
  no_geometry.measures.geometry = false;
  no_geometry.limits.measures = {{LimitedMeasure::ifov_y, 0.5, std::nullopt}};
  distorted.limits.measures = {{LimitedMeasure::distortion, 0.5, std::nullopt}};
  narrow.limits.measures = {{LimitedMeasure::ifov_x, 1.307, 1.309}};
  narrow.uncertainty.rows = {{.name = "distance", .value = 0.01, .unit = "m"}};

  EXPECT_EQ(refusal(plan_of_one(&MeasuresPlan::geometry)), "");
  EXPECT_THAT(refusal(no_geometry), HasSubstr("geometry = true"));
  EXPECT_THAT(refusal(distorted), HasSubstr("no lower limit"));
  EXPECT_THAT(refusal(narrow), HasSubstr("nothing can pass"));
  EXPECT_EQ(refusal(plan_of_one(&MeasuresPlan::mtf)), "");
  EXPECT_EQ(refusal(plan_of_one(&MeasuresPlan::ctf)), "");
  EXPECT_THAT(refusal(no_bars), HasSubstr("ctf_plate"));
  EXPECT_THAT(refusal(no_contrast), HasSubstr("ctf_delta_t_k"));
  EXPECT_THAT(refusal(no_ctf), HasSubstr("ctf = true"));
  EXPECT_THAT(refusal(triangles), HasSubstr("mtf_plate"));
  EXPECT_THAT(refusal(rectangles), HasSubstr("plates"));
  EXPECT_THAT(refusal(flat), HasSubstr("mtf_delta_t_k"));
  EXPECT_THAT(refusal(unasked), HasSubstr("mtf = true"));
  EXPECT_THAT(refusal(above), HasSubstr("no upper limit"));
  // The same plan with an MTF asked for reads the plate that it did not need before.
  Plan without = plan_of_one(&MeasuresPlan::mtf);
  without.measures.mtf = false;
  const auto loaded = LoadedPlan::load(without);
  ASSERT_TRUE(loaded);
  EXPECT_FALSE(loaded->parts().mtf_plate);
  EXPECT_TRUE(loaded->with(plan_of_one(&MeasuresPlan::mtf)).value().parts().mtf_plate);
  Plan both = plan_of_one(&MeasuresPlan::mtf);
  both.measures.ctf = true;
  const auto more = loaded->with(both);
  ASSERT_TRUE(more) << more.error().message;
  EXPECT_TRUE(more->parts().mtf_plate && more->parts().ctf_plate);
  EXPECT_EQ(more->shown_plates().size(), 3u);
}

TEST(PlateEdges, AreFoundInTheMiddleAndInTheCornersAndHoldTheTruth) {
  for (const double aberration_pitch : {0.0, 0.6}) {
    const auto coverage = testing::edge_coverage(aberration_pitch, 15);
    ASSERT_TRUE(coverage) << coverage.error().message;
    EXPECT_EQ(coverage->edges, 150);
    EXPECT_EQ(coverage->single_sided, 0);
    EXPECT_LT(coverage->largest_error, 0.025);
    // 150 edges: standard error 0.018; the intervals are wider than they need to be (docs/physical-measures.md).
    for (const double share : coverage->within) EXPECT_GT(share, 0.95 - 4 * 0.018) << aberration_pitch;
  }
}

TEST(PlateEdges, AreRefusedWhereTheyAreNotInThePicture) {
  TargetPlate plate = testing::five_squares();
  Registration where;
  where.plate_to_pixel = {0.38, 0, 160, 0, 0.38, 120, 0, 0, 1};
  cv::Mat1d noise(240, 320);
  const RandomStream random(1, "no edge");
  for (int i = 0; i < static_cast<int>(noise.total()); ++i)
    noise(i / 320, i % 320) = random.normal(static_cast<std::uint64_t>(i));
  EXPECT_FALSE(plate_edges(noise, plate, where));
  EXPECT_FALSE(plate_edges(cv::Mat1d(240, 320, 5.0), plate, where));
  EXPECT_FALSE(plate_edges(cv::Mat1d(100, 100, 5.0), plate, where));
  noise(3, 3) = std::nan("");
  EXPECT_FALSE(plate_edges(noise, plate, where));
  plate.rectangles.clear();
  EXPECT_FALSE(plate_edges(cv::Mat1d(240, 320, 5.0), plate, where));
}

TEST(PlatePictures, OfARecordAreBase64AndNothingElse) {
  EXPECT_EQ(base64("Man"), "TWFu");
  EXPECT_EQ(base64("Ma"), "TWE=");
  EXPECT_EQ(base64("M"), "TQ==");
  for (const char* good : {"TWFu", "TWE=", "TQ==", "+/+/"}) EXPECT_TRUE(is_base64(good)) << good;
  for (const char* bad : {"", "TWF", "T===", "TW=u", "\"/><script>", "TWFu\n"}) EXPECT_FALSE(is_base64(bad)) << bad;
  CameraMeasures measures;
  measures.picture = PlatePicture{};
  measures.picture->seen.kelvin = cv::Mat1d(4, 5, 300.0);
  measures.picture->seen.kelvin(1, 1) = 301;
  measures.picture->expected_k = cv::Mat1d(4, 5, 300.0);
  Json record = measures_json(measures, std::nullopt);
  ASSERT_TRUE(measures_from(record));
  record["main"]["picture"]["seen_png"] = "\"/><script>";
  EXPECT_FALSE(measures_from(record));
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
    if (demand.kind == DemandKind::zone_bad_pixels) {
      EXPECT_EQ(demand.decision, VerdictKind::pass) << demand.reason;
    }
    if (demand.kind == DemandKind::zone_substituted_pixels) {
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
  EXPECT_THAT(loaded.error().message, HasSubstr("three steps or more"));
}

}  // namespace
}  // namespace todbench
