// SPDX-License-Identifier: GPL-3.0-or-later
// The simulated SC2000 against published numbers, at full accuracy; a twin that is saturated.
#include <cmath>

#include "tests/support/source_file.h"
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

constexpr double pitch_mrad = 47.5 / 36.3;

Json simulated(const std::vector<std::string>& more) {
  const TemporaryFolder folder;
  std::vector<std::string> arguments{"simulate", "--sensor", "sc2000", "--observer", "hvs-1", "--out", "s", "--json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Ended ended = todbench(arguments, {.folder = folder.path()});
  EXPECT_EQ(ended.code, 0) << ended.err;
  return one_object(ended);
}

/// A size at 75 % within 1 % and three standard errors of `pitches`.
void expect_size(const Json& point, double pitches) {
  const double expected_mrad = pitches * pitch_mrad;
  const double tolerance_mrad = 0.01 * expected_mrad + 3 * point["s75_direct_se_mrad"].get<double>();
  EXPECT_NEAR(point["s75_direct_mrad"].get<double>(), expected_mrad, tolerance_mrad) << point;
  // The fit of the trials: a Weibull function is not the true form and the sizes of the plate are not the threshold,
  // which is worth up to 5 %; the interval of the trials comes on top.
  const double half_width_mrad = point["s75_ci95_mrad"][1].get<double>() - point["s75_ci95_mrad"][0].get<double>();
  EXPECT_NEAR(point["s75_mrad"].get<double>(), expected_mrad, 0.05 * expected_mrad + half_width_mrad) << point;
}

TEST(SimulatedSc2000, HasThe75PercentSizesOfTheReferenceObserver) {
  const Json json = simulated({"--delta-t-k", "16.9,0.23"});

  ASSERT_EQ(json["points"].size(), 2u);
  expect_size(json["points"][0], 1.593);
  expect_size(json["points"][1], 2.635);
}

TEST(SimulatedSc2000, SeesSmallerTrianglesWithMicroscan) {
  const Json plain = simulated({"--delta-t-k", "16.9", "--accuracy", "draft"});
  const Json scanned = simulated({"--delta-t-k", "16.9", "--accuracy", "draft", "--microscan", "2"});

  EXPECT_LT(scanned["points"][0]["s75_direct_mrad"].get<double>(),
            0.9 * plain["points"][0]["s75_direct_mrad"].get<double>());
}

TEST(SimulatedSc2000, IsMeasurableWithEveryMicroscanAtTheDistanceThatTheProgramChooses) {
  for (const char* samples : {"3", "4"}) {
    // At 10 K the middle of the sizes would be so far away that windows touch (3) or triangles are unclear (4).
    const Json json = simulated({"--delta-t-k", "10", "--accuracy", "draft", "--microscan", samples});

    ASSERT_EQ(json["points"].size(), 1u) << samples;
    EXPECT_TRUE(json["points"][0]["s75_mrad"].is_number()) << samples;
  }
}

TEST(SimulatedSc2000, AgreesBetweenTheLevelsOfAccuracyWithinTheirErrors) {
  const Json draft = simulated({"--delta-t-k", "16.9", "--accuracy", "draft"})["points"][0];
  const Json reference = simulated({"--delta-t-k", "16.9", "--accuracy", "reference"})["points"][0];

  // Draft promises 5 %, reference 0.2 %; both have standard errors.
  const double a = draft["s75_direct_mrad"], b = reference["s75_direct_mrad"];
  const double se =
      std::hypot(draft["s75_direct_se_mrad"].get<double>(), reference["s75_direct_se_mrad"].get<double>());
  EXPECT_NEAR(a, b, 0.052 * b + 3 * se);
  EXPECT_LT(reference["s75_direct_se_mrad"], draft["s75_direct_se_mrad"]);
}

/// The twin ends at 300.8 K: of 4 K above the surround it shows 0.8 K. Its answers to the camera's own presentations
/// agree with those of the camera, because both are judged in units of the contrast.
TEST(SaturatedTwin, LeavesNoEquivalenceAndKeepsTheAcuityOfTheCamera) {
  const TemporaryFolder folder;
  std::string sensor = content_of(source_file("sim_devices/sensors/sc2000.toml"));
  const std::string key = "kelvin_per_count = 0.01";
  folder.write("twin.toml", sensor.replace(sensor.find(key), key.size(), "kelvin_per_count = 0.0031"));
  std::string plan = small_measurement(8,
                                       "[limits]\nequivalence_margin_percent = 60\n[[limits.acuity]]\n"
                                       "delta_t_k = 4\nleast_acuity_per_mrad = 0.3\n[fit]\nlapse = 0\n");
  const auto put = [&plan](const std::string& old, const std::string& other) {
    plan.replace(plan.find(old), old.size(), other);
  };
  put("delta_t_k = [16.9]", "delta_t_k = [4]");
  put("accuracy = \"draft\"", "accuracy = \"draft\"\nsensor = \"./twin.toml\"");
  folder.write("plan.toml", plan);

  const Ended ended = todbench({"measure", "./plan.toml", "--out", "m", "--json"}, {.folder = folder.path()});

  EXPECT_EQ(ended.code, 3) << ended.err;
  const Json json = one_object(ended), demands = json["judgement"]["demands"];
  ASSERT_EQ(demands.size(), 2u);
  EXPECT_EQ(demands[0]["decision"], "pass");
  EXPECT_EQ(demands[1]["kind"], "equivalence");
  EXPECT_EQ(demands[1]["ratio"], "paired");
  EXPECT_EQ(demands[1]["decision"], "inconclusive");
  EXPECT_LT(demands[1]["interval"][1], demands[1]["limit"]) << "the paired ratio alone would say equivalent";
  EXPECT_THAT(demands[1]["reason"].get<std::string>(),
              ::testing::HasSubstr("in 100 % of the trials, pixels in the window of the triangle are saturated"));
  const Json comparison = Json::parse(content_of(folder.path() / "m" / "comparison.json"));
  EXPECT_TRUE(comparison["points"][0]["withheld"]);
  EXPECT_EQ(comparison["points"][0]["paired"]["verdict"], "inconclusive");
  // The appendix: sums of probabilities are no counts of right answers.
  const std::string page = content_of(folder.path() / "m" / "report.html");
  EXPECT_THAT(page, ::testing::HasSubstr("Mean probability of a correct answer; trials"));
  EXPECT_THAT(page, ::testing::Not(::testing::HasSubstr("Correct / trials")));
}

}  // namespace
}  // namespace todbench::testing
