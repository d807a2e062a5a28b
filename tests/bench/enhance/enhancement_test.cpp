// Enhancement under test: what must not change anything does not, what is known comes out.
#include "bench/enhance/enhancement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <cmath>
#include <functional>

#include "acquisition/core/rng.h"
#include "bench/enhance/dynamic_measurement.h"
#include "bench/enhance/enhancement_page.h"
#include "bench/enhance/model_comparison_page.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/plan.h"
#include "bench/plan/plan_options.h"
#include "bench/report/html.h"
#include "bench/text/files.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "sim_devices/sensor/super_resolution.h"
#include "tests/bench/enhance/paired_ratio_coverage.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::TemporaryFolder;

LoadedPlan small_plan(const std::string& contrasts, int phases, const std::string& more = "") {
  const std::string text =
      "name = \"small\"\n[target]\nkind = \"scene\"\ndistance_m = 2\nplates = [\"tcat-a\"]\n"
      "mountings = [\"identity\"]\ndelta_t_k = [" +
      contrasts + "]\n[simulation]\nsensor = \"sc2000\"\naccuracy = \"draft\"\nphases = " + std::to_string(phases) +
      "\n" + more;
  const auto plan = parse_plan({.origin = "small", .text = text}, ".");
  EXPECT_TRUE(plan) << plan.error().message;
  auto loaded = LoadedPlan::load(*plan);
  EXPECT_TRUE(loaded) << loaded.error().message;
  return *loaded;
}

EnhancementPackage package_of(std::vector<StagePlan> stages, const std::string& name = "package") {
  EnhancementPackage package;
  package.name = name;
  package.stages = std::move(stages);
  return package;
}

cv::Mat1f noise(cv::Size size, std::uint64_t index) {
  cv::Mat1f picture(size);
  RandomStream(3, "stages").sub(index).fill_normal({picture.ptr<float>(), picture.total()});
  return picture;
}

TEST(ChainStages, LeaveAPictureAsItIsAtTheirNeutralValues) {
  const cv::Mat1f picture = noise({40, 30}, 1);
  for (const auto& stage : {recursive_filter(1), sharpening(0)}) {
    (void)stage->process(noise({40, 30}, 2)).value();
    EXPECT_EQ(cv::norm(stage->process(picture).value(), picture, cv::NORM_INF), 0);
    EXPECT_EQ(stage->memory_frames(), 0);
  }
  const cv::Mat1f flat(30, 40, 7.0F);
  for (const auto& stage : {sharpening(2), median_filter(3), median_filter(5), clahe(2, 4), plateau_equalisation(1)})
    EXPECT_NEAR(cv::norm(stage->process(flat).value(), flat, cv::NORM_INF), 0, 1e-5);
}

TEST(ChainStages, OfRecursionLeaveTheVarianceOfTheirClosedForm) {
  const double share = 0.25;
  const auto stage = recursive_filter(share);
  cv::Mat1f answer;
  for (int i = 0; i <= stage->memory_frames(); ++i)
    answer = stage->process(noise({320, 240}, static_cast<std::uint64_t>(i))).value();

  cv::Scalar mean, deviation;
  cv::meanStdDev(answer, mean, deviation);
  // The variance of so many independent values has a relative standard error of sqrt(2 / 76800) = 0.5 %.
  EXPECT_NEAR(deviation[0] * deviation[0] / (share / (2 - share)), 1, 0.02);
  EXPECT_EQ(stage->memory_frames(), 25);  // 0.75^25 = 0.00075
}

TEST(ChainStages, OfEqualisationKeepOrderAndRange) {
  const cv::Mat1f picture = 300 + noise({64, 48}, 4);
  double low = 0, high = 0, new_low = 0, new_high = 0;
  cv::minMaxLoc(picture, &low, &high);
  const cv::Mat1f answer = plateau_equalisation(5)->process(picture).value();

  cv::minMaxLoc(answer, &new_low, &new_high);
  EXPECT_GE(new_low, low);
  EXPECT_LE(new_high, high);
  for (int i = 1; i < 500; ++i) {
    const float a = *(picture.begin() + i), b = *(picture.begin() + i - 1);
    const float new_a = *(answer.begin() + i), new_b = *(answer.begin() + i - 1);
    EXPECT_TRUE(a == b || (a < b ? new_a <= new_b : new_a >= new_b));
  }
  // Without a limit by class the answer is uniform: half of it below the middle, within sqrt(1 / 4 / 3072) = 0.9 %.
  const cv::Mat1f uniform = plateau_equalisation(100)->process(picture).value();
  const double middle = (low + high) / 2;
  EXPECT_NEAR(cv::countNonZero(uniform < middle) / 3072.0, 0.5, 0.03);
}

/// A bright square with soft edges, displaced.
cv::Mat1f soft_square(cv::Point2d displaced) {
  cv::Mat1f picture(48, 64);
  for (int j = 0; j < picture.rows; ++j) {
    for (int i = 0; i < picture.cols; ++i) {
      const double x = i - 30.3 - displaced.x, y = j - 22.8 - displaced.y;
      picture(j, i) = static_cast<float>(300 + 10 * std::exp(-(std::pow(x / 9, 4) + std::pow(y / 7, 4))));
    }
  }
  return picture;
}

TEST(SuperResolutionStage, GivesWhatTheLibraryGivesOfTheLastFrames) {
  for (const FrameShifts kind : {FrameShifts::scan, FrameShifts::measured}) {
    const auto stage = super_resolution_stage({.frames = 4, .factor = 2, .shifts = kind});
    std::vector<cv::Mat1f> all;
    cv::Mat1f answer;
    for (std::uint64_t k = 0; k < 6; ++k) {
      all.push_back(soft_square(dither_px(2, k)) + 0.01 * noise({64, 48}, k));
      answer = stage->process(all.back()).value();
      EXPECT_EQ(answer.size(), cv::Size(128, 96)) << "also before there are four";
    }

    const std::vector<cv::Mat1f> last(all.begin() + 2, all.end());
    std::vector<cv::Point2d> shifts;
    for (std::uint64_t k = 2; k < 6; ++k) shifts.push_back(dither_px(2, k) - dither_px(2, 2));
    if (kind == FrameShifts::measured) shifts = frame_shifts(last).value();
    const auto library = super_resolve(last, shifts);
    ASSERT_TRUE(library) << library.error().message;
    EXPECT_EQ(cv::norm(answer, library->picture, cv::NORM_INF), 0);
    cv::Point2d mean(0, 0);
    for (const auto& shift : shifts) mean += shift / 4.0;
    EXPECT_EQ(stage->first_px(), library->first_px + mean);
    EXPECT_EQ(stage->memory_frames(), 3);
  }
  const auto stage = super_resolution_stage({});
  for (int k = 0; k < 3; ++k) (void)stage->process(soft_square({0, 0})).value();
  const auto never_moved = stage->process(soft_square({0, 0}));
  ASSERT_FALSE(never_moved) << "three cells of a pixel have no frame";
  EXPECT_EQ(never_moved.error().code, ErrorCode::not_identifiable);
}

TEST(Enhancement, ByMeasuredShiftsOutlivesChangesOfTheTargetButNotACameraThatRests) {
  const auto plan = small_plan("16.9", 3, "[measurement]\nregistration_frames = 8\ncontrast_frames = 4\n");
  const StagePlan measured{.kind = StagePlan::Kind::super_resolution,
                           .super_resolution = {.frames = 4, .factor = 2, .shifts = FrameShifts::measured}};

  const auto moved = compare_packages(plan, {package_of({measured})}, {.dither = 2}, {});
  const auto at_rest = compare_packages(plan, {package_of({measured})}, {}, {});

  ASSERT_TRUE(moved) << moved.error().message;
  EXPECT_FALSE(moved->results[1].error) << moved->results[1].error->message;
  EXPECT_EQ(moved->results[1].trials.size(), 3u * 20);
  ASSERT_TRUE(at_rest) << at_rest.error().message;
  ASSERT_TRUE(at_rest->results[1].error) << "three cells of a pixel have no frame";
  EXPECT_EQ(at_rest->results[1].error->code, ErrorCode::integrity);
  EXPECT_TRUE(at_rest->results[1].trials.empty());
}

TEST(Enhancement, BySuperResolutionOfADitheredSensorIsThatOfFinerSampling) {
  const auto plan = small_plan("0.6", 8);
  const StagePlan finer{.kind = StagePlan::Kind::super_resolution,
                        .super_resolution = {.frames = 4, .factor = 2, .shifts = FrameShifts::scan}};

  const auto found = compare_packages(plan, {package_of({finer})}, {.dither = 2}, {});

  ASSERT_TRUE(found) << found.error().message;
  const PackageResult& result = found->results[1];
  ASSERT_FALSE(result.error) << result.error->message;
  EXPECT_EQ(result.samples_per_pixel, 2);
  EXPECT_EQ(result.trials.size(), 8u * 20);
  SensorSpec fine = plan.sensor();
  fine.super_resolution_frames = 4;
  TemplateObserver observer(plan.observer(), triangle_alternatives());
  const auto direct =
      direct_estimate(fine, full_plan(fine, {}, {}), observer, {0.6}, {.accuracy = Accuracy::draft(), .seed = 1});
  ASSERT_TRUE(direct) << direct.error().message;
  const PsychometricFit& fit = result.curve.points.front().fit;
  const double expected_mrad = direct->front().s75_pitch * fine.ifov_mrad();
  EXPECT_LT(fit.ci95.low.value(), expected_mrad);
  EXPECT_GT(fit.ci95.high.value(), expected_mrad);
  // Pixels are those of the camera, and its contrast: sizes are the same in both.
  EXPECT_EQ(result.trials.front().size_px, found->results[0].trials.front().size_px);
  EXPECT_NEAR(result.curve.points.front().delta_t_k / 0.6, 1, 0.03);
  EXPECT_LT(fit.ci95.high.value(), found->results[0].curve.points.front().fit.ci95.low.value())
      << "finer sampling resolves more";
  const auto at_rest = compare_packages(plan, {package_of({finer})}, {}, {});
  ASSERT_FALSE(at_rest) << "a scan of a sensor that does not scan";
  EXPECT_EQ(at_rest.error().code, ErrorCode::invalid_input);
}

TEST(Enhancement, OfNeutralStagesChangesNoAnswer) {
  const auto plan = small_plan("16.9", 2);
  StagePlan all{.kind = StagePlan::Kind::recursive, .share = 1}, none{.kind = StagePlan::Kind::sharpen, .amount = 0};

  const auto found = compare_packages(plan, {package_of({all, none})}, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->results.size(), 2u);
  ASSERT_FALSE(found->results[1].error) << found->results[1].error->message;
  EXPECT_GT(found->results[0].trials.size(), 10u);
  ASSERT_EQ(found->results[0].trials.size(), found->results[1].trials.size());
  for (std::size_t i = 0; i < found->results[0].trials.size(); ++i)
    EXPECT_EQ(found->results[0].trials[i].scores, found->results[1].trials[i].scores);
  for (const auto& ratio : found->results[1].ratios) {
    EXPECT_EQ(ratio.ratio.value_or(1), 1);
  }
}

TEST(Enhancement, ByARecursiveFilterIsThatOfLessNoise) {
  // The noise that a share of a third leaves has the standard deviation sqrt(1/5) = 0.447.
  const auto plan = small_plan("0.6", 8);
  StagePlan third{.kind = StagePlan::Kind::recursive, .share = 1.0 / 3};

  const auto found = compare_packages(plan, {package_of({third})}, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->settle_frames, 18);
  ASSERT_EQ(found->results[1].ratios.size(), 1u);
  const auto& ratio = found->results[1].ratios[0];
  ASSERT_TRUE(ratio.ratio && ratio.ci95.low);
  EXPECT_GT(*ratio.ci95.low, 1) << "less noise, better acuity";

  PlanParts parts = plan.parts();
  parts.sensor.netd_k *= std::sqrt(0.2);
  const auto quiet = compare_packages(LoadedPlan::of(plan.plan(), parts).value(), {}, {}, {});
  ASSERT_TRUE(quiet) << quiet.error().message;
  const auto &filtered_fit = found->results[1].curve.points.at(0).fit,
             &quiet_fit = quiet->results[0].curve.points.at(0).fit;
  ASSERT_TRUE(filtered_fit.threshold && quiet_fit.threshold);
  const double se = std::hypot(filtered_fit.se_ln_threshold.value(), quiet_fit.se_ln_threshold.value());
  EXPECT_NEAR(std::log(*filtered_fit.threshold / *quiet_fit.threshold), 0, 4 * se);
}

TEST(Enhancement, KeepsTheTrialsOfAPackageThatFailsAndGoesOn) {
  ::signal(SIGPIPE, SIG_IGN);
  const auto plan = small_plan("16.9", 2);
  // Registration takes 32 frames, the contrast 16, every presentation one: it ends with the second.
  StagePlan module{.kind = StagePlan::Kind::module};
  module.module.process.command = TODBENCH_MODULE_EXAMPLE " ends 49";
  module.module.process.limit = std::chrono::seconds(60);
  StagePlan dead{.kind = StagePlan::Kind::module};
  dead.module.process.command = TODBENCH_MODULE_EXAMPLE " crash";
  StagePlan restarted{.kind = StagePlan::Kind::module};
  restarted.module.process.command = TODBENCH_MODULE_EXAMPLE " identity";
  restarted.module.process.limit = std::chrono::seconds(60);
  restarted.module.restart_frames = 20;

  const auto found =
      compare_packages(plan, {package_of({module}), package_of({dead}), package_of({restarted})}, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->results.size(), 4u);
  const auto& [none, ended, crashed, whole] =
      std::tie(found->results[0], found->results[1], found->results[2], found->results[3]);
  ASSERT_TRUE(ended.error && crashed.error);
  EXPECT_EQ(ended.error->code, ErrorCode::disconnected);
  EXPECT_GT(ended.trials.size(), 0u);
  EXPECT_LT(ended.trials.size(), none.trials.size());
  EXPECT_EQ(crashed.error->code, ErrorCode::disconnected);
  EXPECT_THAT(crashed.error_lines, ::testing::Contains("the licence has expired"));
  EXPECT_FALSE(whole.error);
  ASSERT_EQ(whole.trials.size(), none.trials.size());
  for (std::size_t i = 0; i < none.trials.size(); ++i) EXPECT_EQ(whole.trials[i].scores, none.trials[i].scores);
  EXPECT_THAT(render_html(enhancement_page(plan, {}, *found)), HasSubstr("the module ended"));
  EXPECT_EQ(side_by_side(*found).rows, 240);
}

TEST(Enhancement, RefusesPlansThatShowEachPackageOtherFrames) {
  const auto found = compare_packages(small_plan("16.9", 2, "[schedule]\nkind = \"adaptive\"\n"), {}, {}, {});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::invalid_input);
}

ComparedModel sensor_model(const std::string& name, const std::function<void(SensorSpec&)>& change = {}) {
  ComparedModel model;
  model.name = model.reference = name;
  model.sensor = load_sensor("sc2000").value();
  if (change) change(model.sensor);
  return model;
}

TEST(ModelComparison, OfAModelWithItselfFindsNothing) {
  const auto plan = small_plan("16.9", 4);

  const auto found = compare_models(plan, sensor_model("a"), sensor_model("b"), {}, {});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(found->keys.empty());
  ASSERT_EQ(found->pixels.size(), 2u);
  for (const auto& pixels : found->pixels) EXPECT_EQ(pixels.rms_k.value(), 0) << pixels.what;
  EXPECT_FALSE(found->parts_at_per_mrad);
  ASSERT_EQ(found->ratios.size(), 1u);
  EXPECT_EQ(found->ratios[0].ratio.value_or(1), 1);
  EXPECT_FALSE(parts(found->ratios[0]).value_or(false));
}

TEST(ModelComparison, FindsWhereTwoSensorsPart) {
  const auto plan = small_plan("16.9", 8);
  const auto blurred = sensor_model("blurred", [](SensorSpec& sensor) { sensor.aberration_sigma_pitch = 0.6; });

  const auto found = compare_models(plan, sensor_model("sharp"), blurred, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->keys.size(), 1u);
  EXPECT_EQ(found->keys[0].key, "aberration_sigma_pitch");
  ASSERT_TRUE(found->parts_at_per_mrad);
  // The only factor that differs: exp(-2 pi^2 sigma^2 f^2), f in cycles per pitch.
  for (const auto& point : found->transfer) {
    const double f = point.frequency_per_mrad * found->a.sensor.ifov_mrad();
    EXPECT_NEAR(point.b, point.a * std::exp(-2 * 9.869604401 * 0.36 * f * f), 1e-6) << f;
  }
  EXPECT_GT(found->pixels[0].rms_k.value(), 0);
  ASSERT_TRUE(found->ratios[0].ratio);
  EXPECT_LT(*found->ratios[0].ratio, 1);
  EXPECT_TRUE(parts(found->ratios[0]).value_or(false));
  EXPECT_THAT(render_html(model_comparison_page(plan, *found)), HasSubstr("aberration_sigma_pitch"));
}

TEST(ModelComparison, KnowsTheTransferOfALinearPackageAndThatEqualisationHasNone) {
  const auto plan = small_plan("16.9", 2);
  ComparedModel none, sharp, equalised;
  none.kind = sharp.kind = equalised.kind = ModelKind::package;
  sharp.package = package_of({StagePlan{.kind = StagePlan::Kind::sharpen, .amount = 1.5}});
  equalised.package = package_of({StagePlan{.kind = StagePlan::Kind::clahe, .tiles = 4}});

  const auto found = compare_models(plan, none, sharp, {}, {});
  const auto other = compare_models(plan, none, equalised, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  // x + a (x - mean of 3): along x the mean passes (1 + 2 cos 2 pi f) / 3.
  for (const auto& point : found->transfer) {
    const double f = point.frequency_per_mrad * plan.sensor().ifov_mrad();
    const double gain = 1 + 1.5 * (1 - (1 + 2 * std::cos(2 * 3.14159265358979 * f)) / 3);
    EXPECT_NEAR(point.b, gain, 1e-3) << f;
    EXPECT_EQ(point.a, 1);
  }
  EXPECT_TRUE(found->notes.empty());
  ASSERT_TRUE(other) << other.error().message;
  EXPECT_FALSE(other->notes.empty()) << "equalisation depends on content";
}

TEST(ModelComparison, OfAnObserverWithTheSameTemplatesAsAProgramFindsNothing) {
  const auto plan = small_plan("16.9", 4);
  const TemporaryFolder folder;
  const auto file = (folder.path() / "program.toml").string();
  ASSERT_TRUE(write_file_atomically(file,
                                    "name = \"program\"\nblur_sigma_samples = 0.6\ninternal_noise = 0.07\n[[module]]\n"
                                    "command = \"" TODBENCH_MODULE_EXAMPLE " hvs identity\"\nlimit_ms = 60000\n"));
  const auto built_in = read_compared_model("hvs-1"), program = read_compared_model(file);
  ASSERT_TRUE(built_in && program) << program.error().message;

  const auto found = compare_models(plan, *built_in, *program, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_FALSE(found->result_b.error);
  ASSERT_EQ(found->keys.size(), 1u);
  EXPECT_EQ(found->keys[0].key, "module");
  ASSERT_EQ(found->result_a.trials.size(), found->result_b.trials.size());
  for (std::size_t i = 0; i < found->result_a.trials.size(); ++i)
    EXPECT_EQ(found->result_a.trials[i].answer, found->result_b.trials[i].answer) << i;
  EXPECT_TRUE(found->transfer.empty());
  EXPECT_FALSE(found->notes.empty()) << "says why there is no transfer";
  EXPECT_THAT(render_html(model_comparison_page(plan, *found)), Not(HasSubstr("Transfer along x")));
  EXPECT_FALSE(load_observer(file)) << "elsewhere the program would be left out";
}

TEST(ModelComparison, IsRefusedBetweenKinds) {
  const auto sensor = read_compared_model("sc2000"), observer = read_compared_model("hvs-1");
  ASSERT_TRUE(sensor && observer);
  const auto found = compare_models(small_plan("16.9", 1), *sensor, *observer, {}, {});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::invalid_input);
  EXPECT_FALSE(read_compared_model("no-such-model"));
  EXPECT_FALSE(read_compared_model("/no/such/file.toml"));
}

TEST(PairedRatios, OfTheSameTrialsAreOneWithoutWidth) {
  std::vector<Trial> trials;
  for (int presentation = 0; presentation < 12; ++presentation) {
    for (int size = 1; size <= 6; ++size) {
      Trial trial;
      trial.presentation = presentation;
      trial.set_delta_t_k = 2;
      trial.size_mrad = size;
      trial.answer = (presentation * 7 + size * 3) % 8 < size + 1 ? Apex::up : Apex::down;
      trials.push_back(trial);
    }
  }
  auto better = trials;
  for (auto& trial : better) trial.size_mrad /= 1.25;

  const auto same = paired_ratios(trials, trials, {}), ratio = paired_ratios(better, trials, {});

  ASSERT_TRUE(same.size() == 1 && same[0].ratio && same[0].ci95.low);
  EXPECT_EQ(*same[0].ratio, 1);
  EXPECT_EQ(*same[0].ci95.high - *same[0].ci95.low, 0);
  // Sizes in the same proportion at every answer: the ratio is exact and so is every group's.
  EXPECT_NEAR(ratio[0].ratio.value(), 1.25, 1e-6);
  EXPECT_NEAR(ratio[0].ci95.low.value(), 1.25, 1e-4);
}

TEST(PairedRatios, HoldTheTrueRatioAsOftenAsTheySay) {
  const auto found = testing::coverage_of({.presentations = 24}, 50, 7);

  EXPECT_EQ(found.intervals, 50);
  // Of 50 with 95 % fewer than 42 hold it with a probability of 1e-3.
  EXPECT_GE(found.holding, 42);
  EXPECT_LT(found.mean_half_width, 0.2);
}

TEST(PackageFile, IsRefusedInASentence) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& text) {
    folder.write("p.toml", text);
    const auto package = read_package(folder.path() / "p.toml");
    return package ? std::string("taken") : package.error().message;
  };
  EXPECT_THAT(refusal(""), HasSubstr("no [[stage]]"));
  EXPECT_THAT(refusal("[[stage]]\nkind = \"blur\"\n"), HasSubstr("kind"));
  EXPECT_THAT(refusal("[[stage]]\nkind = \"recursive\"\nshare = 0\n"), HasSubstr("share"));
  EXPECT_THAT(refusal("[[stage]]\nkind = \"median\"\nsize = 4\n"), HasSubstr("3 or 5"));
  EXPECT_THAT(refusal("[[stage]]\nkind = \"median\"\nshare = 1\n"), HasSubstr("share"));
  EXPECT_THAT(refusal("[[stage]]\nkind = \"module\"\n"), HasSubstr("command"));
  EXPECT_THAT(refusal("[[stage]]\nkind = \"super-resolution\"\nfactor = 3\nframes = 8\n"), HasSubstr("frames"));
  EXPECT_EQ(refusal("[[stage]]\nkind = \"clahe\"\n[[stage]]\nkind = \"plateau\"\n"), "taken");
  for (const char* name : {"recursive", "sharpen", "plateau", "module", "super-resolution"}) {
    const auto package = read_package(source_file(std::string("docs/examples/packages/") + name + ".toml"));
    EXPECT_TRUE(package) << package.error().message;
  }
}

/// Remembers what was presented.
class RememberingTarget final : public Target {
 public:
  explicit RememberingTarget(Target& target) : target_(target) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return target_.capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    states.push_back(state);
    return target_.present(state, stop);
  }
  [[nodiscard]] MovingTarget* moving() override { return target_.moving(); }
  std::vector<TargetState> states;

 private:
  Target& target_;
};

TEST(MovingMeasurement, OfAPlateAtRestIsTheStaticOneBitForBit) {
  // Without noise a frame does not depend on its number: every window, its phase and its answer has to be the same.
  const LoadedPlan plan = small_plan("16.9", 2);
  SensorSpec sensor = plan.sensor();
  sensor.netd_k = 0;
  TemplateObserverSpec spec;
  spec.internal_noise = 0;
  TemplateObserver observer(spec, triangle_alternatives());
  const auto model = std::make_shared<const SensorModel>(sensor, full_plan(sensor, {}, {}), Accuracy::draft(), 1);
  OpenedBench moving = simulated_bench(model, plan.plates(), 2, {}),
              still = simulated_bench(model, plan.plates(), 2, {});
  RememberingTarget target(*moving.target);
  MeasurementOptions at_rest = measurement_options(plan.plan(), plan.plates(), sensor.ifov_mrad());
  at_rest.frames_after_change = 0;
  at_rest.integrity.reject_frozen = false;
  MovingMeasurementOptions options{.measurement = at_rest,
                                   .mountings = {Mounting::identity},
                                   .delta_t_k = {16.9},
                                   .speeds_mrad_s = {0},
                                   .passes = 3,
                                   .frames = 2};

  const auto found = measure_moving(*moving.camera, target, observer, options, *moving.host, {}, {});
  ASSERT_TRUE(found) << found.error().message;
  ListedSchedule schedule({target.states.begin() + 1, target.states.end()});  // one at the place of the registration
  const auto measured = measure(*still.camera, *still.target, observer, schedule, at_rest, *still.host, {}, {});

  ASSERT_TRUE(measured) << measured.error().message;
  const std::size_t triangles = plan.plates()[0].triangles.size();
  ASSERT_EQ(measured->trials.size(), 4 * triangles);
  std::vector<Trial> answers;
  for (const MovingAnswer& answer : found->answers) {
    if (answer.observer == SequenceObserver::single_frame) answers.push_back(answer.trial);
  }
  ASSERT_EQ(answers.size(), 3 * triangles);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const Trial& same = measured->trials[triangles + i];
    EXPECT_EQ(answers[i].triangle, same.triangle);
    EXPECT_EQ(answers[i].answer, same.answer);
    EXPECT_EQ(answers[i].delta_t_k, same.delta_t_k);
    EXPECT_EQ(answers[i].phase_x_px, same.phase_x_px);
    EXPECT_EQ(answers[i].phase_y_px, same.phase_y_px);
  }
}

std::string bolometer(const TemporaryFolder& folder) {
  std::string text = testing::content_of(source_file("sim_devices/sensors/sc2000.toml"));
  return folder.write("bolometer.toml", text + "\ntime_constant_ms = 12\nexposure_ms = 4\n").string();
}

TEST(MovingMeasurement, OfASimulatedSensorFindsItsTimeConstantAndLosesAcuityWithSpeed) {
  const TemporaryFolder folder;
  Plan plan =
      small_plan("16.9", 2, "[motion]\nspeeds_mrad_s = [30, 90]\npasses = 4\nframes = 4\nlead_frames = 2\n").plan();
  plan.simulation.sensor = bolometer(folder);
  const auto loaded = LoadedPlan::load(plan);
  ASSERT_TRUE(loaded) << loaded.error().message;

  const auto found = measure_dynamic(*loaded, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(found->time_constant.has_value());
  EXPECT_EQ(found->time_constant->passes, 8);
  EXPECT_NEAR(found->time_constant->time_constant_ms, 12, 0.6) << "5 %";
  EXPECT_LT(found->residual_px, 0.05);
  ASSERT_EQ(found->contrasts.size(), 1u);
  const auto& speeds = found->contrasts[0].speeds;
  ASSERT_EQ(speeds.size(), 3u);
  EXPECT_EQ(speeds[0].speed_mrad_s, 0);
  EXPECT_EQ(speeds[0].points[0].ratio.value_or(0), 1);
  const auto right = [&](double speed) {
    double correct = 0, total = 0;
    for (const MovingAnswer& answer : found->measured.answers) {
      if (answer.speed_mrad_s != speed || answer.observer != SequenceObserver::tracking_sum) continue;
      correct += answer.trial.correct() ? 1 : 0;
      total += 1;
    }
    return correct / total;
  };
  EXPECT_GT(right(0), right(90));
}

TEST(MovingMeasurement, FollowsTheLineOfTheStageWhereItIsAskedTo) {
  const auto plan = small_plan("16.9", 2,
                               "[motion]\nspeeds_mrad_s = [40]\npasses = 2\nframes = 3\nlead_frames = 1\nplaces = "
                               "\"stage\"\n");

  const auto found = measure_dynamic(plan, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_FALSE(found->time_constant.has_value()) << "two passes do not make an interval";
  for (const MovingPassRecord& pass : found->measured.passes) {
    EXPECT_EQ(pass.dropped, "");
    if (pass.speed_mrad_s == 0) continue;
    EXPECT_NEAR(pass.measured_px_s / pass.said_px_s, 1, 0.01);
    EXPECT_NEAR(pass.said_px_s, 40 / plan.sensor().ifov_mrad(), 0.1);
    EXPECT_NEAR(*pass.lag_s, 0, 1e-3);
  }
}

TEST(TimeConstant, FromReversedMotionIsTheLagWithoutTheOffset) {
  std::vector<MovingPassRecord> passes;
  const RandomStream noise(4, "lag");
  for (int i = 0; i < 40; ++i) {
    MovingPassRecord pass;
    pass.along_x = i % 2 == 0 ? 1 : -1;
    pass.said_px_s = i % 4 < 2 ? 10 : 40;
    const double place_px =
        0.3 * pass.along_x + 0.02 * static_cast<double>(noise.normal(static_cast<std::uint64_t>(i)));
    pass.lag_s = 0.012 + 0.003 / 2 + place_px / pass.said_px_s;
    passes.push_back(pass);
  }

  const auto found = time_constant_of(passes, 3);

  ASSERT_TRUE(found.has_value());
  // Of 40 places with 0.02 px at 10 and 40 px/s: 0.02 / sqrt(40 x 850) s = 0.11 ms.
  EXPECT_NEAR(found->time_constant_ms, 12, 4 * 0.11);
  EXPECT_NEAR(*found->ci95_ms.high - *found->ci95_ms.low, 4 * 0.11, 0.2);
  EXPECT_NEAR(found->offset_px, 0.3, 0.02);
  for (auto& pass : passes) pass.along_x = 1;
  EXPECT_FALSE(time_constant_of(passes, 3)) << "one direction does not tell lag from offset";
  for (auto& pass : passes) pass.lag_s.reset();
  EXPECT_FALSE(time_constant_of(passes, 3)) << "no trigger";
}

}  // namespace
}  // namespace todbench
