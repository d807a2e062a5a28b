// SPDX-License-Identifier: GPL-3.0-or-later
// MTF by edges and CTF by bars: of the simulated sensor they are those of its model, and they hold the truth.
#include "bench/run/physical_measures.h"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <iterator>
#include <string>

#include "bench/enhance/bars_questions.h"
#include "bench/plan/descriptions.h"
#include "bench/report/measure_figures.h"
#include "bench/report/report.h"
#include "bench/run/experiment.h"
#include "bench/run/rebuild_report.h"
#include "bench/run/report_data.h"
#include "bench/session/bars_people.h"
#include "bench/session/kept_bars_record.h"
#include "bench/session/open_session.h"
#include "sim_devices/prediction/virtual_mrtd.h"
#include "tests/bench/run/bars_coverage.h"
#include "tests/bench/run/bars_people_check.h"
#include "tests/bench/run/edge_coverage.h"
#include "tests/bench/run/measures_plan.h"
#include "tests/bench/run/mrtd_coverage.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using testing::line_of;
using testing::plan_of_one;
using testing::TemporaryFolder;

TEST(PhysicalMeasures, FindTheMtfOfTheSensorModelAndJudgeIt) {
  const TemporaryFolder folder;
  Plan plan = plan_of_one(&MeasuresPlan::mtf);
  plan.limits.measures = {{"mtf_x", 0.5, std::nullopt}, {"mtf_y", 0.99, std::nullopt}};

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
  // Halos wider than the plate are named, not allowed for.
  EXPECT_GT(x->ci95.low.value(), 0.95 * x->value.value());
  EXPECT_THAT(x->conditions, HasSubstr("relative to a source of the size of the plate"));
  const auto* half = line_of(session->measures->main, "mtf50_x");
  ASSERT_NE(half, nullptr);
  EXPECT_LT(half->ci95.low.value(), half->value.value());
  EXPECT_GT(half->ci95.high.value(), half->value.value());
  ASSERT_NE(line_of(session->measures->twin, "mtf_x_model"), nullptr);
  ASSERT_GE(outcome->verdict.demands.size(), 3u);
  EXPECT_EQ(outcome->verdict.demands[outcome->verdict.demands.size() - 2].decision, VerdictKind::pass);
  EXPECT_EQ(outcome->verdict.demands.back().decision, VerdictKind::fail);
  const std::string page = render_report(*report_data(*session, "session"));
  EXPECT_THAT(page, HasSubstr("MTF along y"));
  EXPECT_THAT(page, HasSubstr("mtf-xsquare"));
}

TEST(PhysicalMeasures, FindTheHaloOfTheSensorAndJudgeIt) {
  const TemporaryFolder folder;
  const std::string sensor = testing::content_of(source_file("sim_devices/sensors/sc2000.toml"));
  folder.write("hazy.toml", sensor + "halo_share = 0.05\nhalo_sigma_pitch = 10\n");
  Plan plan = plan_of_one(&MeasuresPlan::source_size);
  plan.camera.id = "sim:" + (folder.path() / "hazy.toml").string();
  plan.measures.noise = true;
  plan.limits.measures = {{"source_size_loss", std::nullopt, 0.03}, {"transfer_slope_extended", 0.9, 1.1}};
  plan.uncertainty.rows = {{.name = "distance", .value = 0.001, .unit = "1"}};

  const auto outcome = measure_plan(plan, {.folder = folder.path() / "session"}, {}, {});

  ASSERT_TRUE(outcome) << outcome.error().message;
  ASSERT_FALSE(outcome->ended_by) << outcome->ended_by->message;
  ASSERT_TRUE(outcome->measures && outcome->measures->source && outcome->twin_measures->source);
  // The camera has the halo, the twin has none: 0.0486 and 0.0065 in closed form
  // (SourceSize.HoldsTheClosedFormOfAHalo).
  const Estimate camera = outcome->measures->source->effect.loss(10),
                 twin = outcome->twin_measures->source->effect.loss(10);
  EXPECT_LE(camera.low, 0.0486);
  EXPECT_GE(camera.high, 0.0486);
  EXPECT_NEAR(*outcome->twin_measures->source->model_loss, 0.0065, 1e-4);
  EXPECT_LE(twin.low, 0.0065);
  EXPECT_GE(twin.high, 0.0065);
  EXPECT_NEAR(outcome->measures->netd_extended_k().value().value, 0.07, 0.007);
  ASSERT_TRUE(outcome->uncertainty);
  const auto& rows = outcome->uncertainty->points.front().rows;
  const auto of_source =
      std::ranges::find_if(rows, [](const AppliedRow& at) { return at.row.name == source_loss_row; });
  ASSERT_NE(of_source, rows.end());
  // The loss of a square of 4 px against one of 61 px, beyond that of the twin: 5 % of nearly all of the halo's light.
  EXPECT_NEAR(of_source->row.value, 0.047, 0.003);
  const auto session = open_session(folder.path() / "session", {});
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_EQ(session->measures->main->source->effect.points.size(), 5u);
  ASSERT_NE(line_of(session->measures->twin, "source_size_loss_model"), nullptr);
  const auto& demands = outcome->verdict.demands;
  ASSERT_GE(demands.size(), 3u);
  EXPECT_EQ(demands[demands.size() - 3].decision, VerdictKind::fail);
  EXPECT_EQ(demands[demands.size() - 2].decision, VerdictKind::pass);
  EXPECT_EQ(demands.back().decision, VerdictKind::pass);
  EXPECT_THAT(render_report(*report_data(*session, "session")), HasSubstr("Size-of-source effect"));
}

TEST(PhysicalMeasures, FindTheCtfOfTheSensorModelAndJudgeIt) {
  const TemporaryFolder folder;
  Plan plan = plan_of_one(&MeasuresPlan::ctf);
  plan.limits.measures = {
      {"ctf_x", 0.3, std::nullopt}, {"ctf_y", 0.95, std::nullopt}, {"ctf_worst_x", 0.05, std::nullopt}};

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
  EXPECT_EQ(session->measures->main->ctf->bars.groups.size(), 10u);
  EXPECT_TRUE(session->measures->twin->ctf->bars.groups.front().model);
  const auto* x = line_of(session->measures->main, "ctf_x");
  ASSERT_NE(x, nullptr);
  const BarsCtf* stated = outcome->measures->ctf->stated(EdgeAxis::x);
  ASSERT_NE(stated, nullptr);
  EXPECT_NEAR(stated->frequency_per_pitch, 0.4, 0.01);
  EXPECT_EQ(x->value, stated->best.value);
  ASSERT_NE(line_of(session->measures->twin, "ctf_x_model"), nullptr);
  const auto& demands = outcome->verdict.demands;
  ASSERT_GE(demands.size(), 3u);
  EXPECT_EQ(demands[demands.size() - 3].decision, VerdictKind::pass);
  EXPECT_EQ(demands[demands.size() - 2].decision, VerdictKind::fail);
  EXPECT_EQ(demands.back().decision, VerdictKind::pass);
  const std::string page = render_report(*report_data(*session, "session"));
  EXPECT_THAT(page, HasSubstr("ctf-x"));
  EXPECT_THAT(page, HasSubstr("ctf-y"));
}

/// MRTD at one frequency with few frames.
Plan mrtd_plan() {
  Plan plan = plan_of_one(&MeasuresPlan::mrtd);
  plan.measures.mrtd_delta_t_k = {0.004, 0.008, 0.016, 0.032, 0.064};
  plan.measures.mrtd_frames = 8;
  plan.measures.mrtd_set_ups = 5;
  return plan;
}

/// Four people of known thresholds judge the bars of the session in this folder.
void people_judge_bars(const std::filesystem::path& folder) {
  const std::filesystem::path session = folder / "session";
  const auto kept = read_kept_bars(session);
  ASSERT_TRUE(kept && *kept);
  // 12 of 14 bars are below the cut; 5 spots; 2 of the 8 frames at 5 contrasts of both polarities at 5 set-ups.
  EXPECT_EQ((*kept)->pictures.size(), (*kept)->places.size() * 2 * 5 * 2 * 5);
  const BarsRequest request{.times = 3};
  const auto questions = bars_questions(**kept, request);
  ASSERT_TRUE(questions) << questions.error().message;
  EXPECT_EQ(questions->size(), 3u * 3 * 5 * 2 * 5);
  EXPECT_GT(testing::share_of_a_spectral_person(**kept, *questions, 0.06), 0.9);
  const double truths[] = {0.012, 0.016, 0.02, 0.026};
  int held = 0;
  for (std::size_t i = 0; i < std::size(truths); ++i) {
    BarsRequest own = request;
    own.seed = 11 + i;
    const std::filesystem::path shown = folder / ("shown-" + std::to_string(i));
    ASSERT_TRUE(write_bars_questions(shown, session, **kept, own));
    const std::string code = "P" + std::to_string(i + 1);
    testing::enter_answers(
        shown, testing::answers_of(**kept, *bars_questions(**kept, own), code, {.threshold_k = truths[i]}, own.seed));
    auto sitting = read_bars_answers(shown, session, **kept);
    ASSERT_TRUE(sitting) << sitting.error().message;
    sitting->person.code = code;
    for (const BarsThreshold& one : bars_thresholds(*sitting)) {
      ASSERT_TRUE(one.found.half_k) << one.found.reason;
      held += *one.found.ci95.low <= truths[i] && truths[i] <= *one.found.ci95.high ? 1 : 0;
    }
    ASSERT_TRUE(add_bars_sitting(session, *sitting));
  }
  EXPECT_GE(held, 10);  // of 12
  const auto sittings = read_bars_sittings(session);
  ASSERT_TRUE(sittings) << sittings.error().message;
  ASSERT_EQ(sittings->size(), 4u);
  const auto means = bars_means(judged_bars(*sittings));
  ASSERT_EQ(means.size(), 3u);
  for (const BarsMean& mean : means) {
    ASSERT_TRUE(mean.over.ci95);
    EXPECT_LE(mean.over.ci95->first, 0.01776);  // geometric mean of the four
    EXPECT_GE(mean.over.ci95->second, 0.01776);
  }
  const auto open = open_session(session, {});
  ASSERT_TRUE(open) << open.error().message;
  const std::string page = render_report(*report_data_of(*open, session));
  EXPECT_THAT(page, HasSubstr("mean of 4 people"));
  EXPECT_THAT(page, HasSubstr("P3"));
}

TEST(PhysicalMeasures, FindTheMrtdOfTheVirtualBarsAndJudgeIt) {
  const TemporaryFolder folder;
  Plan plan = mrtd_plan();
  plan.limits.measures = {{"mrtd_x", std::nullopt, 0.05}, {"mrtd_y", std::nullopt, 0.005}};
  plan.measures.mrtd_kept_frames = 2;
  VirtualMrtdTask task;
  task.sensor = *load_sensor("sc2000");
  task.plan = full_plan(task.sensor, {}, {});
  task.accuracy = Accuracy::draft();
  task.draws = 600;
  task.frequencies_per_mrad = {0.25 / task.sensor.ifov_mrad()};

  const auto outcome = measure_plan(plan, {.folder = folder.path() / "session"}, {}, {});
  const auto virtual_bars = virtual_mrtd(task);

  ASSERT_TRUE(outcome) << outcome.error().message;
  ASSERT_FALSE(outcome->ended_by) << outcome->ended_by->message;
  ASSERT_TRUE(virtual_bars) << virtual_bars.error().message;
  ASSERT_TRUE(outcome->measures && outcome->twin_measures);
  EXPECT_THAT(outcome->measures->reasons, ::testing::IsEmpty());
  ASSERT_TRUE(outcome->measures->mrtd && outcome->twin_measures->mrtd);
  const MrtdMeasure& found = *outcome->measures->mrtd;
  ASSERT_EQ(found.bars.size(), 14u);
  EXPECT_EQ(found.spots.size(), 5u);
  for (const EdgeAxis axis : {EdgeAxis::x, EdgeAxis::y}) {
    const MrtdPoint* point = found.stated(axis);
    ASSERT_TRUE(point != nullptr && point->threshold_k && point->ci95.low) << point->reason;
    EXPECT_NEAR(point->frequency_per_pitch, 0.25, 0.001);
    // Two half-widths are four standard uncertainties, of both.
    const double apart = std::log(*point->threshold_k / *virtual_bars->front().threshold_k);
    const double half = 0.5 * std::log(*point->ci95.high / *point->ci95.low);
    EXPECT_LT(std::abs(apart), 2 * std::hypot(half, 1.96 * virtual_bars->front().relative_error));
    EXPECT_LT(half, 0.6);
    EXPECT_EQ(point->positive_share.size(), 5u);
    EXPECT_LT(*point->negative_k, 0);
  }
  for (const MrtdPoint& point : found.bars) {
    if (point.frequency_per_pitch > 0.55) {
      EXPECT_THAT(point.reason, HasSubstr("beyond Nyquist"));
    }
  }
  const auto session = open_session(folder.path() / "session", {});
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_EQ(session->plan.measures.mrtd_plate, "mrtd");
  ASSERT_TRUE(session->measures && session->measures->main->mrtd);
  EXPECT_EQ(session->measures->main->mrtd->bars.size(), 14u);
  const auto* x = line_of(session->measures->main, "mrtd_x");
  ASSERT_NE(x, nullptr);
  EXPECT_EQ(x->value, found.stated(EdgeAxis::x)->threshold_k);
  ASSERT_NE(line_of(session->measures->main, "mdtd"), nullptr);
  EXPECT_EQ(outcome->verdict.demands[outcome->verdict.demands.size() - 2].decision, VerdictKind::pass);
  EXPECT_EQ(outcome->verdict.demands.back().decision, VerdictKind::fail);
  const std::string page = render_report(*report_data(*session, "session"));
  EXPECT_THAT(page, HasSubstr("mrtd-x"));
  EXPECT_THAT(page, HasSubstr("half difference"));
  people_judge_bars(folder.path());
}

// Short form of MrtdStudy: the target shows 2 mK more than it reports, which the half difference does not contain.
TEST(BarsJudge, HoldsTheVirtualMrtdWithATargetOfUnknownOffset) {
  const auto found = testing::mrtd_coverage({0.4}, 4, 1500, 0.002);

  ASSERT_TRUE(found) << found.error().message;
  const testing::MrtdCoverage& of = found->front();
  EXPECT_EQ(of.intervals, 8);
  // Five or fewer of eight have a probability of 0.6 % at 95 %; the truth has an error of its own of 3 %.
  EXPECT_GE(of.within, 6.0 / 8);
  EXPECT_LT(std::abs(of.bias), 4 * std::hypot(of.half_width / 2 / std::sqrt(8), of.truth_error));
  // The best phase is 15 % below the mean here. One estimate has a standard deviation of 7 %.
  EXPECT_GE(of.best_within, 6.0 / 8);
  EXPECT_LT(std::abs(of.best_bias), 3 * std::hypot(0.07 / std::sqrt(8), of.truth_error));
}

/// A sample of 2.9 arcmin.
ViewedDisplay bench_display() {
  return {.pixel_pitch_mm = 0.25,
          .viewing_distance_m = 0.6,
          .luminance_white_cd_m2 = 200,
          .luminance_black_cd_m2 = 0.5,
          .zoom = 2};
}

// Threshold and spread are those of the sensor without frames: with the noise of the eye, and with that of the camera
// enlarged by the observer. hvs-1 needs 0.038 K.
TEST(BarsJudge, HasTheVirtualMrtdOfAnObserverWithAnEye) {
  const auto found = testing::mrtd_coverage({0.4}, 1, 128, 0, *load_observer_at("hvs-2", bench_display()));

  ASSERT_TRUE(found) << found.error().message;
  const testing::MrtdCoverage& of = found->front();
  EXPECT_EQ(of.intervals, 2);
  EXPECT_EQ(of.spreads, 2);
  EXPECT_GT(of.truth_k, 0.05);
  const double error = std::hypot(of.half_width / 2 / std::sqrt(2), of.truth_error);
  EXPECT_LT(std::abs(of.bias), 4 * error);
  EXPECT_LT(std::abs(of.lower_bias), 4 * error);
  EXPECT_LT(std::abs(of.upper_bias), 4 * error);
}

TEST(MrtdRecord, StatesTheSpreadOverOpenParametersBesideTheInterval) {
  MrtdMeasure found;
  found.plate = "mrtd", found.observer = "hvs-2", found.pitch_mrad = 1.3;
  for (const EdgeAxis axis : {EdgeAxis::x, EdgeAxis::y}) {
    found.bars.push_back({.place = "bars",
                          .axis = axis,
                          .frequency_per_pitch = 0.25,
                          .threshold_k = 0.02,
                          .ci95 = {0.018, 0.022},
                          .spread_k = std::pair(0.0125, 0.05)});
  }
  found.bars.back().spread_k = std::pair(0.0135, 0.06);
  CameraMeasures measures;
  measures.mrtd = found;

  const auto read = measures_from(measures_json(measures, std::nullopt));

  ASSERT_TRUE(read) << read.error().message;
  ASSERT_TRUE(read->main->mrtd);
  EXPECT_EQ(read->main->mrtd->bars.front().spread_k, std::pair(0.0125, 0.05));
  EXPECT_THAT(line_of(read->main, "mrtd_x")->conditions,
              HasSubstr("; 0.0125 to 0.05 K over the open parameters of the observer (no confidence interval)"));
  EXPECT_THAT(line_of(read->main, "mrtd_mean")->conditions, HasSubstr("; 0.013 to 0.055 K over the open parameters"));
  EXPECT_EQ(mrtd_tables(found, "camera").front().header.back(), "Spread over the open parameters (K)");
  // Without an eye nothing is said of it.
  for (MrtdPoint& point : found.bars) point.spread_k.reset();
  EXPECT_EQ(mrtd_tables(found, "camera").front().header.back(), "Best phase (K)");
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
  no_ctf.limits.measures = {{"ctf_y", 0.5, std::nullopt}};
  Plan triangles = plan_of_one(&MeasuresPlan::mtf), rectangles = plan_of_one(&MeasuresPlan::mtf),
       flat = plan_of_one(&MeasuresPlan::mtf), unasked = plan_of_one(&MeasuresPlan::mtf),
       above = plan_of_one(&MeasuresPlan::mtf);
  triangles.measures.mtf_plate = "tcat-b";
  rectangles.target.plates = {"edge"};
  flat.measures.mtf_delta_t_k = 0;
  unasked.measures.mtf = false;
  unasked.limits.measures = {{"mtf_x", 0.5, std::nullopt}};
  above.limits.measures = {{"mtf_x", std::nullopt, 0.5}};

  Plan no_fives = mrtd_plan(), far_away = mrtd_plan(), twice = mrtd_plan(), no_mrtd = mrtd_plan();
  no_fives.measures.mrtd_plate = "bars";
  far_away.target.distance_m = 20;
  twice.measures.mrtd_delta_t_k = {0.1, 0.1, 0.2};
  no_mrtd.measures.mrtd = false;
  no_mrtd.limits.measures = {{"mrtd_x", std::nullopt, 0.5}};
  EXPECT_EQ(refusal(mrtd_plan()), "");
  Plan seen = mrtd_plan();
  seen.observer = "hvs-2";
  EXPECT_THAT(refusal(seen), HasSubstr("needs a display"));
  seen.display = bench_display();
  EXPECT_EQ(refusal(seen), "");
  EXPECT_THAT(refusal(no_fives), HasSubstr("groups of five bars"));
  EXPECT_THAT(refusal(far_away), HasSubstr("finer than the cut"));
  EXPECT_THAT(refusal(twice), HasSubstr("each stated once"));
  EXPECT_THAT(refusal(no_mrtd), HasSubstr("mrtd = true"));

  Plan no_geometry = plan_of_one(&MeasuresPlan::geometry), distorted = plan_of_one(&MeasuresPlan::geometry),
       narrow = plan_of_one(&MeasuresPlan::geometry);
  no_geometry.measures.geometry = false;
  no_geometry.limits.measures = {{"ifov_y", 0.5, std::nullopt}};
  distorted.limits.measures = {{"distortion", 0.5, std::nullopt}};
  narrow.limits.measures = {{"ifov_x", 1.307, 1.309}};
  narrow.uncertainty.rows = {{.name = "distance", .value = 0.01, .unit = "m"}};

  EXPECT_EQ(refusal(plan_of_one(&MeasuresPlan::geometry)), "");
  EXPECT_THAT(refusal(no_geometry), HasSubstr("geometry = true"));
  EXPECT_THAT(refusal(distorted), HasSubstr("no lower limit"));
  EXPECT_THAT(refusal(narrow), HasSubstr("no unit can pass"));
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
  for (const auto& [aberration_pitch, f_number] : {std::pair(0.0, 1.0), {0.6, 1.0}, {0.0, 2.0}}) {
    const auto coverage = testing::edge_coverage(aberration_pitch, 4, f_number);
    ASSERT_TRUE(coverage) << coverage.error().message;
    EXPECT_EQ(coverage->edges, 40);
    EXPECT_EQ(coverage->single_sided, 0);
    EXPECT_LT(coverage->largest_error, 0.025);
    // 40 edges: standard error 0.035.
    for (const double share : coverage->within)
      EXPECT_GT(share, 0.95 - 4 * 0.035) << aberration_pitch << " " << f_number;
    EXPECT_GT(coverage->half_within, 0.95 - 4 * 0.035) << aberration_pitch << " " << f_number;
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

}  // namespace
}  // namespace todbench
