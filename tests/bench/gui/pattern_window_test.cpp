// SPDX-License-Identifier: GPL-3.0-or-later
// Test pictures on a screen, pixel for pixel, and as the target of the bench.
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QScreen>
#include <QSignalSpy>
#include <QSlider>
#include <algorithm>
#include <cmath>

#include "bench/devices/display_target.h"
#include "bench/gui/presenters/chain_presenter.h"
#include "bench/gui/views/page_check.h"
#include "bench/gui/views/pattern_window.h"
#include "bench/report/pattern_truth.h"
#include "hvs/shape/polygon_coverage.h"
#include "tests/bench/gui/gui_test_support.h"
#include "tod/pattern/test_picture.h"

namespace todbench::testing {
namespace {

/// The truth says where the triangles are; the screen has eight bits.
cv::Mat1f screen_of_truth(const TestPicture& picture) {
  cv::Mat1d cover(picture.levels.size(), 0.0);
  for (const auto& triangle : picture.plate.triangles)
    cover += pixel_coverage(outline_px(triangle, cover.size()), cover.size());
  cv::Mat1f levels(cover.size());
  for (int row = 0; row < cover.rows; ++row) {
    for (int column = 0; column < cover.cols; ++column)
      levels(row, column) = static_cast<float>(std::lround(255 * std::min(cover(row, column), 1.0))) / 255;
  }
  return levels;
}

TEST(PatternWindow, ShowsWhatTheTruthSaysPixelForPixel) {
  PatternWindow window(*QGuiApplication::primaryScreen());
  window.fill_screen();
  ASSERT_TRUE(QTest::qWaitForWindowExposed(&window));
  const auto picture = drawn_picture({.size = window.screen_px(), .kind = TodPicture{}});
  ASSERT_TRUE(picture) << picture.error().message;
  ASSERT_GE(picture->plate.triangles.size(), 20u);

  ASSERT_TRUE(window.show_levels(picture->levels));
  QCoreApplication::processEvents();
  const auto seen = window.on_screen();

  ASSERT_TRUE(seen) << seen.error().message;
  ASSERT_EQ(seen->size(), picture->levels.size());
  // Half a level where a share lies between two of them: both ways of summing shares round apart there.
  const cv::Mat1f truth = screen_of_truth(*picture);
  EXPECT_LE(cv::norm(*seen, truth, cv::NORM_INF), 1.001 / 255);
  EXPECT_LE(cv::countNonZero(cv::abs(*seen - truth) > 0.5 / 255), 4);
}

TEST(PatternWindow, KnowsFlatPicturesByTheirLevel) {
  const auto quarter = picture_kind_named("flat:0.25");
  ASSERT_TRUE(quarter) << quarter.error().message;
  EXPECT_EQ(std::get<FlatPicture>(*quarter).level, 0.25);
  for (const char* wrong : {"flat:", "flat:1.1", "flat:nan", "flat:x", "flat:-0.1"}) {
    const auto refused = picture_kind_named(wrong);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(refused.error().code, ErrorCode::invalid_input);
  }
}

TEST(PatternWindow, StepsByTheKeyboardAndRefusesWhatIsLarger) {
  PatternWindow window(*QGuiApplication::primaryScreen());
  window.fill_screen();
  std::vector<NamedPattern> patterns;
  for (const double level : {0.2, 0.4, 0.6}) patterns.push_back({"flat", cv::Mat1d(8, 8, level)});
  window.set_patterns(patterns);
  ASSERT_TRUE(QTest::qWaitForWindowExposed(&window));
  QSignalSpy ended(&window, &PatternWindow::ended);
  const auto level = [&] {
    QCoreApplication::processEvents();
    const auto seen = window.on_screen();
    return seen ? static_cast<double>((*seen)(4, 4)) : -1;
  };

  EXPECT_NEAR(level(), 0.2, 1e-6);
  QTest::keyClick(&window, Qt::Key_Right);
  EXPECT_NEAR(level(), 0.4, 1e-6);
  QTest::keyClick(&window, Qt::Key_Left);
  QTest::keyClick(&window, Qt::Key_Left);
  EXPECT_EQ(window.current(), 2u);
  EXPECT_NEAR(level(), 0.6, 1e-6);
  QTest::keyClick(&window, Qt::Key_Escape);
  EXPECT_EQ(ended.count(), 1);
  const cv::Size room = window.screen_px();
  EXPECT_FALSE(window.show_levels(cv::Mat1d(room.height + 1, 8, 0.5)));
}

// The program of the window as the bench starts it, and the bench's own check of what is on the screen.
TEST(DisplayTarget, IsSteppedByTheBenchThroughTheProgram) {
  TargetPlate plate;
  plate.name = "one";
  plate.width_mm = plate.height_mm = 100;
  plate.triangles = {{.name = "t", .position_mm = {10, -5}, .size_mm = 20, .apex = Apex::right}};
  auto show = shown_by_program(std::string(TODBENCH_GUI_PROGRAM) + " --pictures");
  ASSERT_TRUE(show) << show.error().message;
  std::vector<cv::Mat1f> shown;
  const auto target = display_target({.plates = {plate},
                                      .display = {.size_px = {640, 480}, .pixel_mm = 0.25},
                                      .span_k = 10,
                                      .settle = std::chrono::milliseconds(0)},
                                     [&](const cv::Mat1f& levels) {
                                       auto answer = (*show)(levels);
                                       if (answer) shown.push_back(*answer);
                                       return answer;
                                     });

  const auto first = target->present({.plate = "one", .delta_t_k = 4}, {});
  const auto second = target->present(
      {.plate = "one", .mounting = Mounting::rotated_180, .delta_t_k = -4, .shift_mm = {0.1, 0.05}}, {});
  const auto faint = target->present({.plate = "one", .delta_t_k = 0.1}, {});
  const auto outside = target->present({.plate = "one", .delta_t_k = 4, .shift_mm = {80, 0}}, {});

  ASSERT_TRUE(first) << first.error().message;
  ASSERT_TRUE(second) << second.error().message;
  EXPECT_FALSE(faint);
  EXPECT_FALSE(outside);
  EXPECT_EQ(first->state.delta_t_k, 4);  // 102 of 255 levels
  ASSERT_EQ(shown.size(), 2u);
  // The middle of the triangle, and the same place the other way round.
  EXPECT_NEAR(static_cast<double>(shown[0](220, 360) - shown[0](10, 10)), 0.4, 1e-6);
  EXPECT_NEAR(static_cast<double>(shown[1](260, 280) - shown[1](10, 10)), -0.4, 1e-6);
}

TEST(ChainOfAScene, FollowsTheSliderOfTheRange) {
  ShownWindow window("sim:sc2000");
  window->resize(1280, 690);
  window->show_view(View::chain);
  auto& scenes = window.part<QComboBox>("chainScene");
  auto& slider = window.part<QSlider>("chainRange");
  EXPECT_FALSE(slider.isVisible());
  const auto side_of_scene = [&] {
    const auto& pictures = window->chain().pictures();
    return pictures.empty() || !pictures.front().grey_k
               ? 0.0
               : pictures.front().kelvin.rows / pictures.front().pixels_per_pitch;
  };

  scenes.setCurrentText("craft-at-sea");
  slider.setValue(slider.minimum());
  ASSERT_TRUE(wait_until([&] { return !window->chain().busy() && side_of_scene() > 0; }));
  const double near = side_of_scene();
  slider.setValue(slider.maximum() / 2);
  ASSERT_TRUE(wait_until([&] { return !window->chain().busy(); }));

  EXPECT_TRUE(slider.isVisible());
  EXPECT_FALSE(window.part<QDoubleSpinBox>("chainSize").isVisible());
  EXPECT_EQ(window->chain().problem(), "");
  // What is shown is the target with room round it: fewer pitches farther away.
  EXPECT_LT(side_of_scene(), near);
  EXPECT_EQ(faults_of(*window).join("; ").toStdString(), "");
  scenes.setCurrentIndex(0);
  ASSERT_TRUE(wait_until([&] { return !window->chain().busy() && side_of_scene() == 0; }));
  EXPECT_FALSE(slider.isVisible());
}

}  // namespace
}  // namespace todbench::testing
