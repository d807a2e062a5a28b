// SPDX-License-Identifier: GPL-3.0-or-later
// Every hint of the alignment, provoked with a badly set up emulated laboratory.
#include <numbers>

#include "bench/gui/presenters/align_presenter.h"
#include "bench/plan/descriptions.h"
#include "sim_devices/lab/laboratory.h"
#include "tests/bench/gui/gui_test_support.h"
#include "tod/instruments/scpi_client.h"

namespace todbench::testing {
namespace {

using ::testing::Contains;
using ::testing::IsEmpty;

LaboratoryOptions laboratory_options() {
  LaboratoryOptions options;
  options.sensor = *load_sensor("sc2000");
  options.plan = full_plan(options.sensor, {}, {});
  options.plates = {*load_plate("tcat-a")};
  options.black_body.server.port = options.stage.server.port = 0;
  options.black_body.time_constant_s = options.black_body.stable_dwell_s = 0.05;
  options.stage.speed_mm_per_s = 200;
  options.stage.settle_s = 0.02;
  options.stage.plate_change_s = options.stage.mounting_change_s = 0.1;
  return options;
}

/// The plate as it is seen when it stands at an angle about its vertical axis: places by the perspective, sizes by the
/// local magnification.
TargetPlate tilted(TargetPlate plate, double angle_deg, double distance_m) {
  const double angle = angle_deg * std::numbers::pi / 180;
  for (auto& t : plate.triangles) {
    const double nearness = 1 / (1 + t.position_mm.x * std::sin(angle) / (1000 * distance_m));
    t.position_mm = {t.position_mm.x * std::cos(angle) * nearness, t.position_mm.y * nearness};
    t.size_mm *= nearness * std::sqrt(std::cos(angle));
  }
  return plate;
}

/// Alignment of the plan of the small tests before a laboratory.
class Aligning {
 public:
  explicit Aligning(LaboratoryOptions options) {
    auto started = Laboratory::start(std::move(options));
    EXPECT_TRUE(started) << started.error().message;
    laboratory_ = std::move(*started);
    Plan plan = with_laboratory(small_plan(bench_.plan(), 2), *laboratory_);
    EXPECT_TRUE(bench_.select_device(QString::fromStdString(plan.camera.id)));
    bench_.set_plan(plan);
    QObject::connect(&bench_, &Workbench::trouble, [this](const QString& text) { trouble_ = text.toStdString(); });
    presenter_.start();
  }
  ~Aligning() { bench_.shut_down(); }

  /// Hints after so many looks.
  std::vector<AlignmentHint> hints_after(int looks) {
    EXPECT_TRUE(wait_until([&] { return presenter_.looks() >= looks || !trouble_.empty(); }));
    EXPECT_EQ(trouble_, "");
    std::vector<AlignmentHint> hints;
    if (presenter_.alignment())
      for (const auto& remark : presenter_.alignment()->remarks) hints.push_back(remark.hint);
    return hints;
  }
  AlignPresenter& presenter() { return presenter_; }
  Laboratory& laboratory() { return *laboratory_; }

 private:
  TemporaryFolder folder_;
  Workbench bench_{folder_.path()};
  std::unique_ptr<Laboratory> laboratory_;
  AlignPresenter presenter_{bench_};
  std::string trouble_;
};

TEST(AlignmentHints, AreSilentInAGoodSetUp) {
  Aligning aligning(laboratory_options());

  EXPECT_THAT(aligning.hints_after(4), IsEmpty());
  EXPECT_THAT(aligning.presenter().hints(), IsEmpty());
}

TEST(AlignmentHints, SayThatTheLensIsOutOfFocus) {
  LaboratoryOptions options = laboratory_options();
  options.sensor.aberration_sigma_pitch = 0.6;
  options.plan = full_plan(options.sensor, {}, {});
  Aligning aligning(std::move(options));

  EXPECT_THAT(aligning.hints_after(1), ::testing::ElementsAre(AlignmentHint::out_of_focus));
  EXPECT_TRUE(aligning.presenter().hints().front().startsWith("Out of focus"));
}

TEST(AlignmentHints, SayThatThePlateIsTilted) {
  LaboratoryOptions options = laboratory_options();
  options.plates = {tilted(options.plates.front(), 14, options.distance_m)};  // cos 14 degrees is 0.970
  Aligning aligning(std::move(options));

  EXPECT_THAT(aligning.hints_after(1), ::testing::ElementsAre(AlignmentHint::tilted));
}

TEST(AlignmentHints, SayThatAWindowLeavesThePicture) {
  LaboratoryOptions options = laboratory_options();
  options.centre_px = {126, 0};  // of 160: the triangles are in the picture, the windows of the outer ones are not
  Aligning aligning(std::move(options));

  EXPECT_THAT(aligning.hints_after(1), ::testing::ElementsAre(AlignmentHint::near_edge));
}

TEST(AlignmentHints, SayThatThePlateHasMovedSinceTheFirstLook) {
  Aligning aligning(laboratory_options());
  EXPECT_THAT(aligning.hints_after(1), IsEmpty());
  auto stage = ScpiClient::connect(aligning.laboratory().stage_endpoint(), {}, {});
  ASSERT_TRUE(stage) << stage.error().message;

  // 0.38 pixels: 1 mm at 0.382 px/mm.
  ASSERT_TRUE(stage->command("POS 1.0,0.0", {}));

  EXPECT_TRUE(wait_until([&] {
    const auto& alignment = aligning.presenter().alignment();
    return alignment && !alignment->remarks.empty();
  }));
  EXPECT_TRUE(wait_until([&] { return std::abs(aligning.presenter().alignment()->drift_px - 0.38) < 0.05; }));
  EXPECT_THAT(aligning.hints_after(1), Contains(AlignmentHint::drifting));
}

TEST(AlignmentHints, SayThatThePlateIsNotThere) {
  LaboratoryOptions options = laboratory_options();
  options.centre_px = {400, 0};
  Aligning aligning(std::move(options));

  EXPECT_THAT(aligning.hints_after(1), ::testing::ElementsAre(AlignmentHint::not_found));
}

}  // namespace
}  // namespace todbench::testing
