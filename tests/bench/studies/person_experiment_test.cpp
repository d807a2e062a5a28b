// SPDX-License-Identifier: GPL-3.0-or-later
// A person in place of the observer: what is asked, what the answers say, what is kept.
#include "bench/studies/person_experiment.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <tuple>

#include "bench/plan/descriptions.h"
#include "bench/plan/target_sets.h"
#include "bench/text/text.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

IdentificationStudyTask three_craft() {
  IdentificationStudyTask task;
  task.set = load_target_set("small-craft").value();
  task.set.targets.resize(3);
  task.set.azimuths_deg = {90, 45};
  for (auto& target : task.set.targets) target.aspects.resize(2);
  task.sensor = load_sensor("sc2000").value();
  task.accuracy = Accuracy::draft();
  task.ranges_m = {500, 1000};
  task.seed = 4;
  return task;
}

VirtualMrtdTask two_frequencies() {
  VirtualMrtdTask task;
  task.sensor = load_sensor("sc2000").value();
  task.plan = full_plan(task.sensor, {}, {});
  task.accuracy = Accuracy::draft();
  task.frequencies_per_mrad = {0.15, 0.3};
  task.seed = 4;
  return task;
}

TEST(PersonExperiment, AsksOfEveryTargetAtEveryRangeAsOften) {
  const auto experiment = PersonExperiment::of_set(three_craft(), 4);
  ASSERT_TRUE(experiment) << experiment.error().message;
  ASSERT_EQ(experiment->trials().size(), 24u);
  ASSERT_EQ(experiment->icons().size(), 3u);
  std::map<std::pair<std::size_t, std::size_t>, int> asked;
  std::vector<std::size_t> order;
  for (const PersonTrial& trial : experiment->trials()) {
    ++asked[{trial.condition, trial.truth}];
    order.push_back(trial.truth);
    const cv::Mat1f picture = experiment->picture_k(trial).value();
    EXPECT_EQ(picture.rows, picture.cols);
    EXPECT_LT(cv::norm(picture, experiment->picture_k(trial).value(), cv::NORM_INF), 1e-9) << "the same again";
    // The same grey for all targets of a range.
    EXPECT_EQ(experiment->grey(trial).white_k, -experiment->grey(trial).black_k);
  }
  ASSERT_EQ(asked.size(), 6u);
  for (const auto& [what, count] : asked) EXPECT_EQ(count, 4);
  EXPECT_FALSE(std::is_sorted(order.begin(), order.end()));
  const auto again = PersonExperiment::of_set(three_craft(), 4);
  for (std::size_t i = 0; i < 24; ++i) EXPECT_EQ(again->trials()[i].draw, experiment->trials()[i].draw);
  // No icon is empty or like another.
  for (std::size_t a = 0; a < 3; ++a) {
    EXPECT_GT(cv::norm(experiment->icons()[a] - 0.5, cv::NORM_INF), 0.1);
    for (std::size_t b = 0; b < a; ++b)
      EXPECT_GT(cv::norm(experiment->icons()[a], experiment->icons()[b], cv::NORM_INF), 0.1);
  }
}

/// Someone who is always right at the first condition and right every other time at the second.
std::vector<ExperimentAnswer> answers_of(const PersonExperiment& experiment,
                                         const std::function<bool(const PersonTrial&)>& sees) {
  std::map<std::size_t, int> asked;
  std::vector<ExperimentAnswer> answers;
  for (const PersonTrial& trial : experiment.trials()) {
    const bool right = sees(trial) || asked[trial.condition]++ % 2 == 0;
    const std::size_t other = (trial.truth + 1) % experiment.alternatives().size();
    answers.push_back({.answer = right ? trial.truth : other, .response_s = 0.5});
  }
  return answers;
}

TEST(PersonExperiment, FindsTheRangeBetweenSeenAndHalfSeen) {
  const auto experiment = PersonExperiment::of_set(three_craft(), 20);
  ASSERT_TRUE(experiment);
  const auto answers = answers_of(*experiment, [](const PersonTrial& trial) { return trial.condition == 0; });

  const PersonResult result = person_result(*experiment, answers);

  // From 1 at 500 m to 1/2 at 1000 m: 3/4 half way in ln range.
  EXPECT_NEAR(result.r75_m.value.value(), std::sqrt(500.0 * 1000.0), 1e-6);
  EXPECT_LT(result.r75_m.ci95.low.value(), *result.r75_m.value);
  EXPECT_GT(result.r75_m.ci95.high.value(), *result.r75_m.value);
  EXPECT_EQ(result.conditions[0].right, 60);
  EXPECT_EQ(result.conditions[1].right, 30);
  int right = 0;
  for (std::size_t t = 0; t < 3; ++t) right += result.confusion[1][t][t];
  EXPECT_EQ(right, 30);
}

TEST(PersonExperiment, OfBarsFindsTheContrastOfEveryFrequency) {
  const auto experiment = PersonExperiment::of_bars(two_frequencies(), 10);
  ASSERT_TRUE(experiment) << experiment.error().message;
  ASSERT_EQ(experiment->conditions().size(), 12u);
  const auto& conditions = experiment->conditions();
  EXPECT_NEAR(conditions[1].contrast_k / conditions[0].contrast_k, 1.6, 1e-9);
  int left = 0;
  for (const PersonTrial& trial : experiment->trials()) left += trial.truth == 0 ? 1 : 0;
  EXPECT_NEAR(left, 60, 4 * std::sqrt(30.0)) << "four bars are on the left as often";
  // Four on the left and five on the right are as wide as one another.
  EXPECT_GT(experiment->picture_k(experiment->trials()[0])->cols, experiment->picture_k(experiment->trials()[0])->rows);

  const PersonResult result = person_result(*experiment, answers_of(*experiment, [](const PersonTrial& trial) {
    return trial.condition % 6 >= (trial.condition < 6 ? 3U : 2U);
  }));

  ASSERT_EQ(result.thresholds_k.size(), 2u);
  EXPECT_NEAR(result.thresholds_k[0].value.value(), std::sqrt(conditions[2].contrast_k * conditions[3].contrast_k),
              1e-9);
  EXPECT_NEAR(result.thresholds_k[1].value.value(), std::sqrt(conditions[7].contrast_k * conditions[8].contrast_k),
              1e-9);
  EXPECT_LT(result.thresholds_k[0].ci95.low.value(), *result.thresholds_k[0].value);
}

// Yes or no: who says yes to bars from the third contrast on and never to nothing has a threshold; who says yes to all
// has none.
TEST(PersonExperiment, OfResolvedBarsAsksWhetherThereAreAnyAndCountsFalseAlarms) {
  VirtualMrtdTask task = two_frequencies();
  task.criterion = BarCriterion::bars_resolved;
  const auto experiment = PersonExperiment::of_bars(task, 6);
  ASSERT_TRUE(experiment) << experiment.error().message;
  const auto& conditions = experiment->conditions();
  ASSERT_EQ(conditions.size(), 12u);
  ASSERT_EQ(experiment->trials().size(), 12u * (6 + 2));
  EXPECT_NEAR(conditions[1].contrast_k / conditions[0].contrast_k, 2, 1e-9);
  const auto strength = [&](const PersonTrial& trial) {
    cv::Scalar mean, sd;
    cv::meanStdDev(experiment->picture_k(trial).value(), mean, sd);
    return sd[0];
  };
  for (const PersonTrial& trial : experiment->trials()) {
    if (trial.condition != 5) continue;
    // The highest contrast of a frequency is 64 times what an ideal observer needs.
    if (trial.truth == 0)
      EXPECT_GT(strength(trial), 0.15 * conditions[5].contrast_k);
    else
      EXPECT_LT(strength(trial), 3 * task.sensor.netd_k);
  }
  std::vector<ExperimentAnswer> honest, always;
  for (const PersonTrial& trial : experiment->trials()) {
    const bool sees = trial.truth == 0 && trial.condition % 6 >= 2;
    honest.push_back({.answer = sees ? 0U : 1U});
    always.push_back({.answer = 0});
  }

  const PersonResult result = person_result(*experiment, honest);
  const PersonResult of_always = person_result(*experiment, always);

  ASSERT_EQ(result.thresholds_k.size(), 2u);
  EXPECT_EQ(result.conditions[0].shown, 6) << "frames with bars only";
  EXPECT_EQ(result.conditions[0].right, 0);
  EXPECT_EQ(result.conditions[2].right, 6);
  for (const PersonShare& alarms : result.false_alarms) {
    EXPECT_EQ(alarms.shown, 12);
    EXPECT_EQ(alarms.right, 0);
  }
  // From none to all between two contrasts: three quarters of the way in their logarithms.
  for (const std::size_t f : {0U, 1U}) {
    EXPECT_NEAR(result.thresholds_k[f].value.value(), conditions[6 * f + 1].contrast_k * std::pow(2, 0.75), 1e-9);
    EXPECT_EQ(of_always.false_alarms[f].right, 12);
    EXPECT_FALSE(of_always.thresholds_k[f].value);
  }
}

TEST(PersonExperiment, OfDetectionShowsBarsOnOneSideAndNothingOnTheOther) {
  VirtualMrtdTask task = two_frequencies();
  task.criterion = BarCriterion::detection;
  const auto experiment = PersonExperiment::of_bars(task, 2);
  ASSERT_TRUE(experiment) << experiment.error().message;
  EXPECT_EQ(experiment->description()["criterion"], "detection");
  for (const PersonTrial& trial : experiment->trials()) {
    if (trial.condition % 6 != 5) continue;
    const cv::Mat1f picture = experiment->picture_k(trial).value();
    const int half = (picture.cols - 4) / 2;
    const double left = cv::mean(picture.colRange(0, half))[0],
                 right = cv::mean(picture.colRange(half + 4, picture.cols))[0];
    EXPECT_EQ(left > right, trial.truth == 0);
  }
}

TEST(PersonExperiment, KeepsWhatWasAnsweredAndNothingTwice) {
  const testing::TemporaryFolder folder;
  const auto experiment = PersonExperiment::of_set(three_craft(), 2);
  ASSERT_TRUE(experiment);
  auto answers = answers_of(*experiment, [](const PersonTrial&) { return true; });
  answers.resize(7);
  PersonFacts person;
  person.code = "P7";
  person.age_years = 41;

  ASSERT_TRUE(write_person(folder.path() / "p", *experiment, answers, person, false));

  std::ifstream file(folder.path() / "p" / "person.json");
  const Json json = Json::parse(file);
  EXPECT_EQ(json["task"], "identify");
  EXPECT_EQ(json["observer"], "human");
  EXPECT_EQ(json["person"]["code"], "P7");
  EXPECT_EQ(json["person"]["age_years"], 41);
  EXPECT_EQ(json["person"]["acuity_decimal"], nullptr);
  EXPECT_EQ(json["complete"], false);
  EXPECT_EQ(json["answers"], 7);
  ASSERT_EQ(json["ranges"].size(), 2u);
  int shown = 0;
  for (const auto& range : json["ranges"])
    for (const auto& row : range["confusion"])
      for (const auto& count : row) shown += count.get<int>();
  EXPECT_EQ(shown, 7);
  const auto csv = read_text_file(folder.path() / "p" / "answers.csv");
  ASSERT_TRUE(csv);
  EXPECT_EQ(std::count(csv->begin(), csv->end(), '\n'), 8);
  const auto twice = write_person(folder.path() / "p", *experiment, answers, person, false);
  ASSERT_FALSE(twice);
  EXPECT_EQ(twice.error().code, ErrorCode::invalid_input);
}

TEST(PersonExperiment, RefusesWhatTheCommandsRefuse) {
  IdentificationStudyTask task = three_craft();
  task.ranges_m = {1000, 500};
  EXPECT_FALSE(PersonExperiment::of_set(task, 1));
  task.ranges_m = {};
  EXPECT_FALSE(PersonExperiment::of_set(task, 1));
  VirtualMrtdTask bars = two_frequencies();
  bars.frequencies_per_mrad = {0};
  EXPECT_FALSE(PersonExperiment::of_bars(bars, 1));
}

}  // namespace
}  // namespace todbench
