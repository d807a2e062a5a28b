// SPDX-License-Identifier: GPL-3.0-or-later
// A camera of eight bits that looks at a monitor: the program of the window draws, an emulated GigE camera sees what is
// on its screen.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>

#include "bench/devices/display_target.h"
#include "bench/devices/emulation.h"
#include "bench/plan/descriptions.h"
#include "bench/run/experiment.h"
#include "sim_devices/lab/gvsp_laboratory.h"
#include "sim_devices/lab/monitor_view.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "tests/support/temporary_folder.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

constexpr double monitor_gamma = 2.2, span_k = 30, pixel_mm = 0.4;

/// The program on a screen of 800 x 800 pixels that nobody sees.
std::string shown_on(const std::filesystem::path& copy) {
  return "QT_QPA_PLATFORM=offscreen '" TODBENCH_GUI_PROGRAM "' --pictures --copy '" + copy.string() + "'";
}

Plan display_plan(const std::filesystem::path& shown) {
  Plan plan = *load_plan("demo");
  plan.fit.estimator = EstimatorChoice::weibull;  // not of the function of the twin, which takes longer than the rest
  plan.camera.contrast = ContrastUnit::grey_levels;
  plan.camera.settings = {{"PixelFormat", "Mono8"}, {"ImageAdjustMethod", "Linear"}};
  plan.target.mountings = {Mounting::identity};
  plan.schedule.frames_per_presentation = {8};
  plan.target.delta_t_k = {16.9, 4};
  plan.target.phases = 6;
  plan.target.display = shown_on(shown);
  plan.target.display_width_px = plan.target.display_height_px = 780;
  plan.target.display_pixel_mm = pixel_mm;
  plan.target.display_span_k = span_k;
  plan.target.display_gamma = monitor_gamma;
  plan.target.display_settle_s = 0;
  plan.simulation.accuracy = "draft";
  plan.simulation.tolerance_percent = 20;
  plan.measurement.registration_frames = 8;
  plan.measurement.contrast_frames = 8;
  plan.measurement.frame_timeout_ms = 20000;
  plan.measurement.max_rejected_share = 0.9;  // a busy machine loses frames, and the others say the same
  plan.limits = {};
  return plan;
}

/// An emulated Ax5 before a monitor that shows `seen`.
struct MonitorBench {
  std::unique_ptr<Laboratory> laboratory;
  Plan plan;

  MonitorBench(Plan wanted, const std::filesystem::path& seen) {
    EmulationArguments arguments = emulation_for(wanted);
    arguments.camera = "gige-ax5";
    arguments.monitor_file = seen.string();
    arguments.monitor_pixel_mm = pixel_mm;
    arguments.monitor_span_k = span_k;
    arguments.monitor_gamma = monitor_gamma;
    auto started = start_laboratory(arguments);
    if (!started) return;
    laboratory = *std::move(started);
    plan = with_laboratory(std::move(wanted), *laboratory);
    plan.target.kind = TargetKind::display;
  }
};

TEST(DisplayBench, HasTheCurveOfTheDirectEstimate) {
  const testing::TemporaryFolder folder;
  const auto shown = folder.path() / "shown.npy";
  const MonitorBench bench(display_plan(shown), shown);
  ASSERT_TRUE(bench.laboratory);

  const auto measured = measure_plan(bench.plan, {.folder = folder.path() / "session"}, {}, {});

  ASSERT_TRUE(measured) << measured.error().message;
  ASSERT_FALSE(measured->ended_by) << measured->ended_by->message;
  ASSERT_EQ(measured->curve.points.size(), 2u);
  const SensorSpec sensor = with_counts_of(CameraModel::ax5, load_sensor("sc2000").value());
  TemplateObserver observer(load_observer("hvs-1").value(), triangle_alternatives());
  for (const TodPoint& point : measured->curve.points) {
    const auto direct = direct_estimate(sensor, full_plan(sensor, {}, {}), observer, {point.delta_t_k}, {});
    ASSERT_TRUE(direct) << direct.error().message;
    ASSERT_TRUE(point.fit.threshold && point.fit.ci95.low && point.fit.ci95.high);
    const double expected_mrad = direct->front().s75_pitch * sensor.ifov_mrad();
    const double half = std::log(*point.fit.ci95.high / *point.fit.ci95.low) / 2;
    EXPECT_LT(std::abs(std::log(*point.fit.threshold / expected_mrad)), 1.7 * half)
        << point.set_delta_t_k << " K: 1.7 of a 95 % half-width is a chance of 1 in 1200";
    // A level of the screen is at most this much light at gamma 2.2.
    EXPECT_NEAR(point.delta_t_k, point.set_delta_t_k, 0.5 * monitor_gamma / 255 * span_k);
  }
}

TEST(DisplayBench, WhoseCameraSeesAnotherPictureIsNotMeasured) {
  const testing::TemporaryFolder folder;
  const MonitorBench bench(display_plan(folder.path() / "shown.npy"), folder.path() / "another.npy");
  ASSERT_TRUE(bench.laboratory);

  const auto measured = measure_plan(bench.plan, {.folder = folder.path() / "session"}, {}, {});

  ASSERT_FALSE(measured);
  EXPECT_EQ(measured.error().code, ErrorCode::calibration);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "shown.npy"));
}

TEST(DisplayBench, SaysAtOnceWhatCannotBeShown) {
  const testing::TemporaryFolder folder;
  const std::string command = shown_on(folder.path() / "shown.npy");
  const auto code_of = [&](const DisplayTargetOptions& options, const std::string& program) {
    const auto opened = open_display_target(options, program);
    return opened ? std::optional<ErrorCode>() : opened.error().code;
  };
  const DisplayTargetOptions fits{.plates = {*load_plate("tcat-a")},
                                  .display = {.size_px = {780, 780}, .pixel_mm = pixel_mm},
                                  .span_k = span_k,
                                  .tone = {.gamma = monitor_gamma},
                                  .delta_t_k = {16.9}};
  EXPECT_EQ(code_of(fits, command), std::nullopt);
  DisplayTargetOptions large = fits;
  large.display.size_px.width = 1000;
  EXPECT_EQ(code_of(large, command), ErrorCode::invalid_input) << "larger than the screen";
  DisplayTargetOptions small = fits;
  small.display.pixel_mm = 0.2;
  EXPECT_EQ(code_of(small, command), ErrorCode::invalid_input) << "the plate is larger than the display";
  DisplayTargetOptions faint = fits;
  faint.delta_t_k = {16.9, 1};
  EXPECT_EQ(code_of(faint, command), ErrorCode::invalid_input) << "too few levels";
  EXPECT_EQ(code_of(fits, "env -u DISPLAY -u WAYLAND_DISPLAY -u QT_QPA_PLATFORM '" TODBENCH_GUI_PROGRAM "' --pictures"),
            ErrorCode::not_found);
  EXPECT_EQ(code_of(fits, "/no/such/program"), ErrorCode::not_found);
}

TEST(MonitorView, ShowsNoMoreThanWhiteAndNoLessThanBlack) {
  SensorSpec spec;
  spec.width = spec.height = 16;
  const SensorModel model(spec, full_plan(spec, {}, {}), Accuracy::draft(), 1);
  const auto frame_of = [&](float high, float low) {
    cv::Mat1f levels(32, 32, 0.5F);
    levels(cv::Rect(8, 8, 8, 8)) = high;
    levels(cv::Rect(16, 16, 8, 8)) = low;
    const auto shown = std::make_shared<const cv::Mat1f>(levels);
    auto view = MonitorView::make({.pixel_mm = spec.ifov_mrad() / 2, .levels = [shown] { return shown; }}, model,
                                  Accuracy::draft(), 1, {0, 0});
    return view ? view->expose(0) : cv::Mat1w();
  };
  const cv::Mat1w right = frame_of(1, 0);
  ASSERT_FALSE(right.empty());
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (const auto& [high, low] : {std::pair(2.0F, -1.0F), std::pair(infinity, -infinity),
                                  std::pair(infinity, std::numeric_limits<float>::quiet_NaN())})
    EXPECT_EQ(cv::norm(frame_of(high, low), right, cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(frame_of(0.9F, 0), right, cv::NORM_INF), 0);
  for (const Monitor& wrong : {Monitor{.pixel_mm = 0}, Monitor{.pixel_mm = 10}, Monitor{.span_k = -1}})
    EXPECT_FALSE(MonitorView::make(wrong, model, Accuracy::draft(), 1, {0, 0}));
}

}  // namespace
}  // namespace todbench
