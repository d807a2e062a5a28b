// SPDX-License-Identifier: GPL-3.0-or-later
// Answers of then to the questions of now.
#include "bench/run/recorded_answers.h"

#include <gmock/gmock.h>

namespace todbench {
namespace {

using ::testing::HasSubstr;

const TargetState state{
    .plate = "tcat-a", .mounting = Mounting::rotated_180, .delta_t_k = 0.23, .shift_mm = {1.0 / 3, -2}};

TEST(RecordedAnswers, ComeBackBitForBitToTheSameQuestions) {
  const PresentedTarget said{.state = {.plate = "tcat-a",
                                       .mounting = Mounting::rotated_180,
                                       .delta_t_k = 0.2300000000000001,
                                       .shift_mm = {0.33, -2.001}},
                             .plate_temperature_k = 295.0 + 1.0 / 3,
                             .black_body_temperature_k = std::nullopt,
                             .settling_s = 1.0 / 7};
  RecordedAnswers answers("r", {rest_answer(true), rest_answer(false), target_answer(state, said), calls_answer(77),
                                clock_answer(Moment::scene_changed, 1234567890123456789), recovery_answer({})});

  EXPECT_EQ(answers.rest(), true);
  EXPECT_EQ(answers.rest(), false);
  EXPECT_EQ(answers.target(state), said);
  EXPECT_EQ(answers.calls(), 77);
  EXPECT_EQ(answers.clock(Moment::scene_changed), 1234567890123456789);
  EXPECT_TRUE(answers.recovery());
  EXPECT_TRUE(answers.agreed());
}

TEST(RecordedAnswers, FailuresComeBackAsTheyWere) {
  RecordedAnswers answers("r", {target_answer(state, fail(ErrorCode::timeout, "still settling")),
                                recovery_answer(fail(ErrorCode::interrupted, "stopped"))});

  const auto target = answers.target(state);
  const auto recovery = answers.recovery();

  ASSERT_FALSE(target);
  EXPECT_EQ(target.error().code, ErrorCode::timeout);
  EXPECT_EQ(target.error().message, "still settling");
  ASSERT_FALSE(recovery);
  EXPECT_EQ(recovery.error().code, ErrorCode::interrupted);
  EXPECT_TRUE(answers.agreed());
}

TEST(RecordedAnswers, AnotherQuestionIsRefusedAndNothingIsShifted) {
  RecordedAnswers answers("r.todrec", {rest_answer(false), clock_answer(Moment::corrected, 5), calls_answer(3)});
  ASSERT_TRUE(answers.rest());

  const auto now = answers.clock(Moment::scene_changed);
  const auto calls = answers.calls();

  ASSERT_FALSE(now);
  EXPECT_EQ(now.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(now.error().message, HasSubstr("r.todrec: answer 2: expected 'clock.scene_changed', found "
                                             "'clock.corrected'"));
  ASSERT_FALSE(calls) << "the answer fits, its place does not";
  EXPECT_EQ(calls.error().message, now.error().message);
  ASSERT_FALSE(answers.agreed());
  EXPECT_EQ(answers.agreed().error().message, now.error().message);
}

TEST(RecordedAnswers, ATargetThatWasSetOtherwiseIsAnotherQuestion) {
  PresentedTarget reached;
  reached.state = state;
  RecordedAnswers answers("r", {target_answer(state, reached)});
  TargetState other = state;
  other.delta_t_k = 1.93;

  const auto said = answers.target(other);

  ASSERT_FALSE(said);
  EXPECT_EQ(said.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(said.error().message, HasSubstr("expected a target set to tcat-a rotated_180 at 1.93 K"));
  EXPECT_THAT(said.error().message, HasSubstr("found tcat-a rotated_180 at 0.23 K"));
}

TEST(RecordedAnswers, AnAnswerThatWasDamagedIsRefused) {
  RecordedAnswers damaged("r", {Reading{}}), odd("r", {Reading{"calls", "many"}}), torn("r", {Reading{"target", "{"}});

  EXPECT_THAT(damaged.rest().error().message, HasSubstr("expected 'rest', found a damaged answer"));
  EXPECT_THAT(odd.calls().error().message, HasSubstr("expected a whole number for 'calls', found 'many'"));
  EXPECT_EQ(torn.target(state).error().code, ErrorCode::invalid_input);
}

TEST(RecordedAnswers, ATargetAsksAgainWhereItDidAndNowhereElse) {
  PresentedTarget reached;
  reached.state = state;
  RecordedAnswers answers("r", {target_answer(state, reached), again_answer(), target_answer(state, reached)});

  ASSERT_TRUE(answers.target(state));
  EXPECT_TRUE(answers.again());
  EXPECT_FALSE(answers.again()) << "the next answer is a report";
  ASSERT_TRUE(answers.target(state));
  EXPECT_FALSE(answers.again()) << "older recordings end here";
  EXPECT_TRUE(answers.agreed());
}

TEST(RecordedAnswers, BehindTheLastOneTheRecordingEndsLikeItsFrames) {
  RecordedAnswers answers("r", {});

  const auto now = answers.clock(Moment::scene_changed);

  ASSERT_FALSE(now);
  EXPECT_EQ(now.error().code, ErrorCode::disconnected);
  EXPECT_TRUE(answers.agreed());
}

}  // namespace
}  // namespace todbench
