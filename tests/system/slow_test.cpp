// The simulated SC2000 against published numbers, at full accuracy.
#include <cmath>

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

}  // namespace
}  // namespace todbench::testing
