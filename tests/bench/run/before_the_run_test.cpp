// SPDX-License-Identifier: GPL-3.0-or-later
// What is found before a run instead of during it: units, IFOV and twin, plates of the stage; and the note on the
// scale.
#include <gmock/gmock.h>

#include "bench/twin/experiment_inputs.h"
#include "tests/bench/run/measured_session.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::MeasuredSession;
using ::testing::Not;

class BeforeTheRun : public MeasuredSession {
 protected:
  [[nodiscard]] Result<ExperimentInputs> inputs() const {
    const auto loaded = LoadedPlan::load(plan_);
    if (!loaded) return tl::unexpected(loaded.error());
    EffectPlanner planner;
    return experiment_inputs(*loaded, planner);
  }
  [[nodiscard]] std::string notes(const std::string& session) const {
    const auto read = read_session(at(session)).value();
    std::string all;
    for (const std::string& note : read.provenance.run->notes) all += note + "\n";
    return all;
  }
};

TEST_F(BeforeTheRun, AnIfovInRadiansIsRefusedWithTheUnit) {
  plan_.camera.ifov_mrad /= 1000;

  const auto found = inputs();

  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(found.error().message, HasSubstr("is the value in rad?"));
}

TEST_F(BeforeTheRun, AnIfovThatDiffersFromPitchOverFocalLengthIsReported) {
  const double of_twin = plan_.camera.ifov_mrad;
  const SensorSpec sensor = load_sensor("sc2000").value();
  EXPECT_THAT(check_ifov(plan_, sensor).value(), IsEmpty());

  plan_.camera.ifov_mrad = 1.009 * of_twin;
  EXPECT_THAT(check_ifov(plan_, sensor).value(), IsEmpty());
  plan_.camera.ifov_mrad = 1.011 * of_twin;
  EXPECT_THAT(check_ifov(plan_, sensor).value(), HasSubstr("of sc2000"));
  SensorSpec finer = sensor;
  finer.microscan = 2;
  plan_.camera.ifov_mrad = of_twin / 2;
  EXPECT_THAT(check_ifov(plan_, finer).value(), IsEmpty());
  EXPECT_THAT(check_ifov(plan_, sensor).value(), Not(IsEmpty()));
}

TEST_F(BeforeTheRun, ADistanceInMillimetresIsRefusedWithTheUnit) {
  plan_.target.distance_m *= 1000;
  const auto found = inputs();
  ASSERT_TRUE(found) << found.error().message;

  const auto fits = check_measured_geometry(plan_, *found, {320, 240});

  ASSERT_FALSE(fits);
  EXPECT_THAT(fits.error().message, HasSubstr("is distance_m in mm?"));
}

TEST_F(BeforeTheRun, APlateThatTheStageDoesNotHaveIsRefusedBeforeAnythingMoves) {
  ScpiTargetOptions options;
  options.black_body = black_body_->endpoint();
  options.stage = stage_->endpoint();
  options.black_body_table = load_instrument("scpi-black-body").value();
  options.stage_table = load_instrument("scpi-stage").value();
  options.requested = {{"tcat-a", Mounting::identity, 1, {0, 0}}};
  instruments_.reset();
  ASSERT_TRUE(open_scpi_target(options, {}));
  options.requested.push_back({"tcat-b", Mounting::identity, 1, {0, 0}});

  const auto refused = open_scpi_target(options, {});

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(refused.error().message, HasSubstr("has no plate 'tcat-b'; available: tcat-a"));
}

TEST_F(BeforeTheRun, TheRightScaleIsNoNote) {
  ASSERT_TRUE(measure("right"));
  EXPECT_THAT(notes("right"), Not(HasSubstr("in the picture than at")));
}

TEST_F(BeforeTheRun, AScaleOfHalfAPercentLessIsNotedWithItsCause) {
  plan_.camera.ifov_mrad *= 0.995;

  const auto run = measure("m");

  ASSERT_TRUE(run) << run.error().message;
  // The picture has fewer pixels per millimetre than the smaller IFOV would give.
  EXPECT_THAT(notes("m"), HasSubstr("plate tcat-a is 0.5"));
  EXPECT_THAT(notes("m"), HasSubstr("% smaller in the picture than at 2 m"));
}

}  // namespace
}  // namespace todbench
