// A camera of eight bits with gain control through the GigE path, beside the same camera with its temperatures.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

#include "bench/run/emulation.h"
#include "bench/run/experiment.h"
#include "bench/session/open_session.h"
#include "bench/text/csv_table.h"
#include "bench/text/text.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

Plan grey_plan() {
  Plan plan = *load_plan("demo");
  plan.target.mountings = {Mounting::identity};
  plan.target.delta_t_k = {16.9, 1.93};
  plan.target.phases = 6;
  plan.simulation.phases = 1;
  plan.simulation.accuracy = "draft";
  plan.simulation.tolerance_percent = 20;
  plan.measurement.registration_frames = 8;
  plan.measurement.contrast_frames = 8;
  plan.measurement.frame_timeout_ms = 20000;
  plan.limits = {};
  return plan;
}

/// The plan with an emulated Ax5, its instruments and these settings of the camera.
struct Ax5Bench {
  std::unique_ptr<Laboratory> laboratory;
  Plan plan;

  explicit Ax5Bench(Plan wanted, const std::map<std::string, std::string>& settings = {}) {
    EmulationArguments arguments = emulation_for(wanted);
    arguments.camera = "gige-ax5";
    auto started = start_laboratory(arguments);
    if (!started) return;
    laboratory = *std::move(started);
    plan = with_laboratory(std::move(wanted), *laboratory);
    for (const auto& [name, value] : settings) plan.camera.settings[name] = value;
  }
};

const std::map<std::string, std::string> eight_bits{{"PixelFormat", "Mono8"}, {"ImageAdjustMethod", "Linear"}};

TEST(GreyCamera, WithGainControlHasTheCurveOfTheSameCameraWithTemperatures) {
  const testing::TemporaryFolder folder;
  Result<ExperimentOutcome> in_kelvin = fail(ErrorCode::internal, "not run"), in_grey = in_kelvin;
  {
    const Ax5Bench bench(grey_plan());
    ASSERT_TRUE(bench.laboratory);
    in_kelvin = measure_plan(bench.plan, {.folder = folder.path() / "kelvin"}, {}, {});
  }
  ASSERT_TRUE(in_kelvin) << in_kelvin.error().message;
  {
    Ax5Bench bench(grey_plan(), eight_bits);
    ASSERT_TRUE(bench.laboratory);
    bench.plan.camera.contrast = ContrastUnit::grey_levels;
    in_grey = measure_plan(bench.plan, {.folder = folder.path() / "grey"}, {}, {});
  }
  ASSERT_TRUE(in_grey) << in_grey.error().message;
  ASSERT_FALSE(in_grey->ended_by) << in_grey->ended_by->message;
  ASSERT_EQ(in_grey->curve.points.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const TodPoint& kelvin = in_kelvin->curve.points[i];
    const TodPoint& grey = in_grey->curve.points[i];
    ASSERT_TRUE(kelvin.fit.threshold && grey.fit.threshold && kelvin.fit.ci95.low && kelvin.fit.ci95.high &&
                grey.fit.ci95.low && grey.fit.ci95.high);
    const auto half = [](const TodPoint& p) { return std::log(*p.fit.ci95.high / *p.fit.ci95.low) / 2; };
    EXPECT_LT(std::abs(std::log(*grey.fit.threshold / *kelvin.fit.threshold)),
              1.7 * std::hypot(half(grey), half(kelvin)))
        << grey.set_delta_t_k << " K: 1.7 of a 95 % half-width is a chance of 1 in 1200";
    EXPECT_NEAR(grey.delta_t_k, grey.set_delta_t_k, 0.01) << "that of the black body";
    EXPECT_GT(grey.delta_t_se_k, 0.0003 * grey.delta_t_k);
    EXPECT_LT(grey.delta_t_se_k, 0.1 * grey.delta_t_k);
  }
  EXPECT_TRUE(check_session(folder.path() / "grey")->files.foreign.empty()) << "the file is one of the session";
  const auto text = read_text_file(folder.path() / "grey" / "grey-levels.csv");
  ASSERT_TRUE(text);
  const auto table = parse_csv(*text, "grey-levels.csv");
  ASSERT_TRUE(table);
  EXPECT_EQ(table->rows.size(), 2u * 2 * 6) << "a row for every frame that was judged";
}

TEST(GreyCamera, IsRefusedInKelvinAndWithoutLargeTriangles) {
  const testing::TemporaryFolder folder;
  Ax5Bench bench(grey_plan(), eight_bits);
  ASSERT_TRUE(bench.laboratory);
  const auto in_kelvin = measure_plan(bench.plan, {.folder = folder.path() / "kelvin"}, {}, {});
  ASSERT_FALSE(in_kelvin);
  EXPECT_EQ(in_kelvin.error().code, ErrorCode::calibration);

  bench.plan.camera.contrast = ContrastUnit::grey_levels;
  bench.plan.measurement.min_reference_px = 5.5;
  const auto too_small = measure_plan(bench.plan, {.folder = folder.path() / "small"}, {}, {});
  ASSERT_FALSE(too_small);
  EXPECT_EQ(too_small.error().code, ErrorCode::invalid_input);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "small")) << "nothing was begun";

  bench.plan.measurement.min_reference_px = 4;
  bench.plan.measures.noise = true;
  EXPECT_FALSE(validate(bench.plan)) << "grey levels are no kelvin";
}

}  // namespace
}  // namespace todbench
