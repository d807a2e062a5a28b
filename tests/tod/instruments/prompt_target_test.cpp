// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/instruments/prompt_target.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <deque>
#include <future>
#include <sstream>
#include <thread>

#include "acquisition/base/descriptor.h"
#include "tests/tod/measurement/fake_clock.h"
#include "tod/instruments/operator_terminal.h"

namespace todbench {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// Answers from a list; at its end the operator has gone.
class WrittenAnswers final : public LineSource {
 public:
  explicit WrittenAnswers(std::deque<std::string> answers) : answers_(std::move(answers)) {}
  Result<std::string> next_line(const std::stop_token&) override {
    if (answers_.empty()) return fail(ErrorCode::disconnected, "end of input");
    auto answer = answers_.front();
    answers_.pop_front();
    return answer;
  }

 private:
  std::deque<std::string> answers_;
};

class PromptTargetTest : public ::testing::Test {
 protected:
  std::unique_ptr<Target> target(std::deque<std::string> answers) {
    return prompt_target(operator_at_terminal(out_, std::make_shared<WrittenAnswers>(std::move(answers))));
  }
  // What was written since the last look.
  std::string said() {
    auto text = out_.str();
    out_.str("");
    return text;
  }

  std::ostringstream out_;
  const TargetState state_{"coarse", Mounting::identity, 2, {0, 0}};
};

TEST_F(PromptTargetTest, TheFirstPromptStatesEverything) {
  const auto hand = target({""});

  const auto presented = hand->present(state_, {});

  ASSERT_TRUE(presented);
  EXPECT_EQ(presented->state, state_);
  EXPECT_FALSE(presented->plate_temperature_k.has_value());
  EXPECT_FALSE(hand->capabilities().sets_shift);
  EXPECT_EQ(said(),
            "Please:\n"
            "  - insert plate 'coarse', as drawn, front to the camera\n"
            "  - set the black body to +2.000 K relative to the plate and wait until it is stable\n"
            "Press Enter when done, or type q to stop: ");
}

TEST_F(PromptTargetTest, LaterPromptsAskOnlyForWhatChanged) {
  const auto hand = target({"", "", "", ""});
  auto state = state_;
  ASSERT_TRUE(hand->present(state, {}));
  said();

  state.delta_t_k = -0.5;
  ASSERT_TRUE(hand->present(state, {}));
  EXPECT_THAT(said(), AllOf(HasSubstr("-0.500 K"), Not(HasSubstr("insert")), Not(HasSubstr("remount"))));

  state.mounting = Mounting::mirrored_horizontally;
  ASSERT_TRUE(hand->present(state, {}));
  EXPECT_THAT(said(), AllOf(HasSubstr("remount"), HasSubstr("left and right swapped"), Not(HasSubstr(" K "))));

  state.shift_mm = {0.5, -0.25};
  ASSERT_TRUE(hand->present(state, {}));
  EXPECT_THAT(said(), AllOf(HasSubstr("slightly, by about 0.5 mm right and 0.2 mm up"), Not(HasSubstr("remount"))));
}

TEST_F(PromptTargetTest, TheSameStateAgainAsksNothing) {
  const auto hand = target({""});
  ASSERT_TRUE(hand->present(state_, {}));
  said();

  ASSERT_TRUE(hand->present(state_, {}));

  EXPECT_EQ(said(), "");
}

TEST_F(PromptTargetTest, QStopsAndTheNextPromptStatesEverythingAgain) {
  const auto hand = target({"", " q ", ""});
  ASSERT_TRUE(hand->present(state_, {}));
  auto hotter = state_;
  hotter.delta_t_k = 5;

  const auto stopped = hand->present(hotter, {});

  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::interrupted);
  said();
  ASSERT_TRUE(hand->present(hotter, {}));
  EXPECT_THAT(said(), HasSubstr("insert plate 'coarse'"));
}

TEST_F(PromptTargetTest, AnyOtherAnswerIsAskedAgainAndTheEndOfInputIsAnError) {
  const auto hand = target({"what?", "no"});

  const auto presented = hand->present(state_, {});

  ASSERT_FALSE(presented);
  EXPECT_EQ(presented.error().code, ErrorCode::disconnected);
  const auto text = said();
  std::size_t prompts = 0;
  for (auto at = text.find("Enter when done"); at != std::string::npos; at = text.find("Enter when done", at + 1))
    ++prompts;
  EXPECT_EQ(prompts, 3U);
}

TEST_F(PromptTargetTest, StatesWithoutAPlateOrWithANumberThatIsNoneAreRefused) {
  const auto hand = target({"", "", ""});
  auto no_plate = state_, no_contrast = state_, no_shift = state_;
  no_plate.plate = "";
  no_contrast.delta_t_k = std::nan("");
  no_shift.shift_mm.x = INFINITY;

  for (const auto& state : {no_plate, no_contrast, no_shift})
    EXPECT_EQ(hand->present(state, {}).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(said(), "");
}

TEST_F(PromptTargetTest, TheTimeOfTheOperatorIsTheSettlingTime) {
  FakeClock clock(12.5);
  PromptTargetOptions options;
  options.now = clock.now();
  const auto hand = prompt_target([](const auto&, const auto&) { return OperatorAnswer::done; }, options);

  EXPECT_DOUBLE_EQ(hand->present(state_, {})->settling_s, 12.5);
}

/// Nobody reads a word: what is asked for and what is answered are values.
TEST(PromptTarget, AsksInStepsAndIsAnsweredByAValue) {
  std::vector<OperatorRequest> asked;
  OperatorAnswer answer = OperatorAnswer::done;
  const auto hand = prompt_target([&](const OperatorRequest& request, const std::stop_token&) {
    asked.push_back(request);
    return answer;
  });
  const TargetState first{"coarse", Mounting::identity, 2, {0, 0}};
  const TargetState moved{"coarse", Mounting::identity, 2, {0.5, -0.25}};
  const TargetState turned{"coarse", Mounting::rotated_180, -1, {0.5, -0.25}};

  ASSERT_TRUE(hand->present(first, {}));
  ASSERT_TRUE(hand->present(moved, {}));
  answer = OperatorAnswer::stop;
  const auto stopped = hand->present(turned, {});

  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::interrupted);
  EXPECT_THAT(asked, ElementsAre(OperatorRequest{{PutInPlate{"coarse", Mounting::identity}, SetContrast{2}}},
                                 OperatorRequest{{MoveSlightly{{0.5, -0.25}}}},
                                 OperatorRequest{{Remount{Mounting::rotated_180}, SetContrast{-1}}}));
}

TEST(PromptTarget, AnErrorOfWhoeverAsksIsItsOwn) {
  const auto hand = prompt_target([](const OperatorRequest&, const std::stop_token&) -> Result<OperatorAnswer> {
    return fail(ErrorCode::disconnected, "the window is closed");
  });

  EXPECT_EQ(hand->present({"coarse", Mounting::identity, 1, {0, 0}}, {}).error().code, ErrorCode::disconnected);
}

class PipeTest : public ::testing::Test {
 protected:
  PipeTest() {
    std::array<int, 2> ends{};
    EXPECT_EQ(::pipe(ends.data()), 0);
    read_end_ = Descriptor(ends[0]);
    write_end_ = Descriptor(ends[1]);
    lines_ = descriptor_lines(read_end_.get());
  }
  void write(const std::string& text) {
    ASSERT_EQ(::write(write_end_.get(), text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }

  Descriptor read_end_, write_end_;
  std::unique_ptr<LineSource> lines_;
};

TEST_F(PipeTest, LinesComeOneByOneWithoutTheirEnds) {
  write("first\r\n\nthi");
  write("rd\nunfinished");
  write_end_.close();

  EXPECT_EQ(lines_->next_line({}).value(), "first");
  EXPECT_EQ(lines_->next_line({}).value(), "");
  EXPECT_EQ(lines_->next_line({}).value(), "third");
  EXPECT_EQ(lines_->next_line({}).error().code, ErrorCode::disconnected);
}

TEST_F(PipeTest, ALineTooLongIsCutAndTheNextIsWhole) {
  write(std::string(20000, 'x') + "\nnext\n");

  EXPECT_EQ(lines_->next_line({}).value(), std::string(4096, 'x'));
  EXPECT_EQ(lines_->next_line({}).value(), "next");
}

TEST_F(PipeTest, AStopRequestEndsTheWaitForTheOperator) {
  std::stop_source stop;
  auto line = std::async(std::launch::async, [&] { return lines_->next_line(stop.get_token()); });

  stop.request_stop();

  EXPECT_EQ(line.get().error().code, ErrorCode::interrupted);
}

TEST_F(PipeTest, APromptOnAPipeIsAnsweredThroughIt) {
  std::ostringstream out;
  const auto hand = prompt_target(operator_at_terminal(out, std::move(lines_)));
  write("\n");

  EXPECT_TRUE(hand->present({"coarse", Mounting::identity, 1, {0, 0}}, {}));
}

}  // namespace
}  // namespace todbench
