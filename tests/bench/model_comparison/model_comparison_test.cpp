// SPDX-License-Identifier: GPL-3.0-or-later
// Two models before the same scenes: of the same they find nothing, of others where they part.
#include "bench/model_comparison/model_comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "bench/model_comparison/model_comparison_page.h"
#include "bench/plan/descriptions.h"
#include "bench/report/html.h"
#include "bench/text/files.h"
#include "tests/bench/enhance/enhancement_support.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::TemporaryFolder;
using namespace testing_support;

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
  EXPECT_THAT(render_html(model_comparison_page(plan, *found)), Not(HasSubstr("Transfer functions along x")));
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

TEST(ModelComparison, StatesTheSpreadOfAnObserverWithAnEye) {
  const auto plan = small_plan("16.9", 6,
                               "[display]\npixel_pitch_mm = 0.27\nviewing_distance_m = 0.5\nzoom = 3\n"
                               "luminance_white_cd_m2 = 200\n");
  const auto blind = read_compared_model("hvs-1"), seeing = read_compared_model("hvs-2");
  ASSERT_TRUE(blind && seeing);

  const auto found = compare_models(plan, *blind, *seeing, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  const TodPoint &of_blind = found->result_a.curve.points.at(0), &of_seeing = found->result_b.curve.points.at(0);
  EXPECT_FALSE(of_blind.s75_spread_mrad);
  ASSERT_TRUE(of_seeing.s75_spread_mrad && of_seeing.fit.threshold);
  EXPECT_LT(of_seeing.s75_spread_mrad->first, *of_seeing.fit.threshold);
  EXPECT_GT(of_seeing.s75_spread_mrad->second, *of_seeing.fit.threshold);
  EXPECT_FALSE(found->ratios.at(0).spread) << "of two observers";
}

TEST(ModelComparison, OfPackagesHasTheSpreadOfTheirRatioFromTheSameFrames) {
  auto plan = small_plan("1.93", 6,
                         "[display]\npixel_pitch_mm = 0.27\nviewing_distance_m = 0.5\nzoom = 3\n"
                         "luminance_white_cd_m2 = 200\n[observer]\nname = \"hvs-2\"\n");
  const TemporaryFolder folder;
  const auto sharp =
      read_compared_model(folder.write("sharp.toml", "name = \"sharp\"\n[[stage]]\nkind = \"sharpen\"\n").string());
  const auto none = read_compared_model("none");
  ASSERT_TRUE(none && sharp) << sharp.error().message;

  const auto found = compare_models(plan, *none, *sharp, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  const PairedRatio& ratio = found->ratios.at(0);
  ASSERT_TRUE(ratio.spread && found->result_b.curve.points.at(0).s75_spread_mrad);
  EXPECT_LE(ratio.spread->first, *ratio.ratio);
  EXPECT_GE(ratio.spread->second, *ratio.ratio);
  EXPECT_THAT(render_html(model_comparison_page(plan, *found)), HasSubstr("over the open parameters"));
}

}  // namespace
}  // namespace todbench
