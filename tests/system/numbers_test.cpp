// SPDX-License-Identifier: GPL-3.0-or-later
// JSON of fit, mtf and render: exactly the keys that others rely on, and values with closed forms.
#include <cmath>
#include <numbers>

#include "acquisition/recording/picture_file.h"
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::UnorderedElementsAre;

Json fit(const std::string& rows, int code, const std::vector<std::string>& more = {}) {
  const TemporaryFolder folder;
  folder.write("trials.csv", "size,correct,total\n" + rows);
  std::vector<std::string> arguments{"fit", "trials.csv", "--json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Ended ended = todbench(arguments, {.folder = folder.path()});
  EXPECT_EQ(ended.code, code) << ended.out << ended.err;
  EXPECT_EQ(ended.err, "");
  return one_object(ended);
}

TEST(FitJson, HasTheKeysOfTheContractAndAThresholdBetweenTheLevels) {
  const Json json = fit("1,26,100\n2,50,100\n3,80,100\n4,96,100\n6,100,100\n", 0);

  EXPECT_THAT(keys_of(json), UnorderedElementsAre("verdict", "threshold", "ci95", "slope", "lapse", "log_likelihood",
                                                  "deviance", "degrees_of_freedom", "posterior", "slope_at_cap",
                                                  "adequacy", "estimator", "estimator_reason", "sensitivity"));
  EXPECT_THAT(keys_of(json["sensitivity"]), UnorderedElementsAre("free_lapse_threshold", "shift_in_half_widths"));
  EXPECT_EQ(json["adequacy"], Json::parse(R"({"adequate": true, "findings": []})"));
  EXPECT_THAT(keys_of(json["posterior"]), UnorderedElementsAre("median", "ci95", "prior_bound"));
  EXPECT_EQ(json["verdict"], "ok");
  EXPECT_GT(json["threshold"], 2);
  EXPECT_LT(json["threshold"], 3);
  EXPECT_LT(json["ci95"][0], json["threshold"]);
  EXPECT_GT(json["ci95"][1], json["threshold"]);
  EXPECT_EQ(json["degrees_of_freedom"], 3);  // five levels, threshold and slope
}

TEST(FitJson, ExactProportionsOfAWeibullFunctionGiveItsThresholdBack) {
  // 75 % at size 2 with slope 3: p(S) = 1/4 + 3/4 (1 - exp(-ln 3 (S/2)^3)); in 10^9 trials a level the counts are
  // rounded by at most half a trial, 1e-9 in p, which moves the threshold by less than 1e-7.
  std::string rows;
  for (const double size : {1.0, 1.5, 2.0, 2.5, 3.0}) {
    const double p = 0.25 + 0.75 * (1 - std::exp(-std::log(3.0) * std::pow(size / 2, 3)));
    rows += std::to_string(size) + "," + std::to_string(std::llround(p * 1e9)) + ",1000000000\n";
  }

  const Json json = fit(rows, 0);

  EXPECT_NEAR(json["threshold"].get<double>(), 2, 2e-6);
  EXPECT_NEAR(json["slope"].get<double>(), 3, 3e-5);
}

TEST(FitJson, WhatCannotBeIdentifiedIsNullAndInconclusive) {
  EXPECT_EQ(fit("1,0,0\n2,0,0\n", 3)["threshold"], nullptr);
  EXPECT_EQ(fit("1,25,100\n2,26,100\n3,24,100\n4,25,100\n", 3)["ci95"][1], nullptr);
  const Json ridge = fit("1,30,60\n2,55,60\n", 3, {"--lapse", "free"});
  EXPECT_EQ(ridge["verdict"], "underdetermined");
  EXPECT_EQ(fit("1,30,60\n2,55,60\n", 0)["verdict"], "ok");
  const Json all_right = fit("1,100,100\n2,100,100\n3,100,100\n", 3);
  EXPECT_EQ(all_right["ci95"][0], nullptr);
  EXPECT_TRUE(all_right["ci95"][1].is_number());
}

TEST(FitJson, RowsMayBeUnsortedAndRepeatedAndTheFormMatters) {
  const Json sorted = fit("1,26,100\n2,50,100\n3,80,100\n4,96,100\n", 0);
  const Json shuffled = fit("4,96,100\n3,40,50\n1,26,100\n3,40,50\n9,0,0\n2,50,100\n", 0);
  const Json acuity = fit("1,26,100\n2,50,100\n3,80,100\n4,96,100\n", 0, {"--form", "acuity", "--lapse", "free"});

  EXPECT_NEAR(shuffled["threshold"].get<double>(), sorted["threshold"].get<double>(), 1e-9);
  EXPECT_NE(acuity["threshold"], sorted["threshold"]);
}

// Counts of a Weibull function of acuity: psi = 1/4 + 3/4 exp(-ln 1.5 (2/S)^2).
TEST(FitJson, AFormThatDoesNotFitIsSaidWithItsFigureAndDecidesNothing) {
  std::string rows;
  for (const double size : {0.8, 1.0, 1.25, 1.6, 2.0, 2.5, 3.2, 4.0, 5.0, 6.4}) {
    const double p = 0.25 + 0.75 * std::exp(-std::log(1.5) * std::pow(2 / size, 2));
    rows += std::to_string(size) + "," + std::to_string(std::llround(p * 1000)) + ",1000\n";
  }

  const Json wrong = fit(rows, 3);
  const Json right = fit(rows, 0, {"--form", "acuity"});

  EXPECT_EQ(wrong["verdict"], "ok");
  EXPECT_GT(wrong["threshold"].get<double>(), 2.1);
  EXPECT_EQ(wrong["adequacy"]["adequate"], false);
  for (const Json& finding : wrong["adequacy"]["findings"]) {
    EXPECT_THAT(keys_of(finding), UnorderedElementsAre("kind", "value", "limit", "sentence", "unfit"));
    EXPECT_GT(finding["value"].get<double>(), finding["limit"].get<double>());
  }
  EXPECT_THAT(wrong["adequacy"].dump(), ::testing::HasSubstr("the acuity form"));
  EXPECT_EQ(right["adequacy"]["adequate"], true) << right["adequacy"];
  EXPECT_NEAR(right["threshold"].get<double>(), 2, 0.02);
}

// 5 % lapses at slope 3.5; the expected counts at 80 trials.
TEST(FitJson, LapsesAreLookedForUnlessTheFitAllowsForThem) {
  std::string rows;
  for (const double size : {0.5, 0.6, 0.75, 0.9, 1.1, 1.35, 1.65, 2.0}) {
    const double p = 0.25 + 0.7 * (1 - std::exp(-std::log(0.7 / 0.2) * std::pow(size, 3.5)));
    rows += std::to_string(size) + "," + std::to_string(std::llround(p * 80)) + ",80\n";
  }

  const Json fixed = fit(rows, 3);

  EXPECT_THAT(fixed["adequacy"].dump(), ::testing::HasSubstr(R"("kind":"lapse")"));
  EXPECT_EQ(fit(rows, 0, {"--lapse", "free"})["adequacy"]["adequate"], true);
}

TEST(FitJson, AColumnOfClustersWidensTheIntervalAndExplainsTheScatter) {
  const TemporaryFolder folder;
  // Presentations by turns far better and far worse than the mean.
  std::string rows;
  for (int cluster = 0; cluster < 40; ++cluster) {
    const double threshold = cluster % 2 == 0 ? 0.75 : 1.35;
    for (const double size : {0.5, 0.7, 0.85, 1.0, 1.2, 1.5, 2.0}) {
      const double p = 0.25 + 0.75 * (1 - std::exp(-std::log(3.0) * std::pow(size / threshold, 3.5)));
      rows +=
          std::to_string(size) + "," + std::to_string(std::llround(p * 16)) + ",16," + std::to_string(cluster) + "\n";
    }
  }
  folder.write("clusters.csv", "size,correct,total,cluster\n" + rows);
  std::string without = "size,correct,total\n";
  for (const std::string& line : lines_of(rows)) without += line.substr(0, line.rfind(',')) + "\n";
  folder.write("alone.csv", without);

  const Json clustered = one_object(todbench({"fit", "clusters.csv", "--json"}, {.folder = folder.path()}));
  const Ended alone = todbench({"fit", "alone.csv", "--json", "--svg", "fit.svg"}, {.folder = folder.path()});
  const Json independent = one_object(alone);

  const auto width = [](const Json& json) { return json["ci95"][1].get<double>() - json["ci95"][0].get<double>(); };
  EXPECT_GT(width(clustered), 1.5 * width(independent));
  EXPECT_THAT(clustered["adequacy"].dump(), ::testing::Not(::testing::HasSubstr("overdispersion")));
  EXPECT_THAT(independent["adequacy"].dump(), ::testing::HasSubstr("overdispersion"));
  EXPECT_EQ(alone.code, 3);
  EXPECT_TRUE(std::filesystem::file_size(folder.path() / "fit.svg") > 0);
}

TEST(FitJson, ASlopeAtTheEndOfItsDomainIsToldAndAFunctionThatFallsIsUnfit) {
  EXPECT_EQ(fit("1,25,100\n1.0001,100,100\n", 3)["slope_at_cap"], true);
  EXPECT_EQ(fit("1,26,100\n2,50,100\n3,80,100\n4,96,100\n", 0)["slope_at_cap"], false);
  EXPECT_THAT(fit("1,80,100\n2,70,100\n3,60,100\n", 3)["adequacy"].dump(), ::testing::HasSubstr("slope"));
}

TEST(MtfJson, DetectorAndOpticsFollowTheirClosedForms) {
  const Ended ended = todbench({"mtf", "--sensor", "sc2000", "--frequency-per-pitch", "0,0.25,0.5,1", "--json"});

  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json json = one_object(ended);
  EXPECT_THAT(keys_of(json),
              UnorderedElementsAre("frequency_per_pitch", "frequency_per_mrad", "optics", "detector", "system"));
  const double ifov_mrad = 47.5 / 36.3;
  for (std::size_t i = 0; i < 4; ++i) {
    const double f = json["frequency_per_pitch"][i];
    const double x = std::numbers::pi * f * 42.5 / 47.5;
    EXPECT_NEAR(json["detector"][i].get<double>(), x == 0 ? 1 : std::sin(x) / x, 1e-12);
    EXPECT_NEAR(json["frequency_per_mrad"][i].get<double>(), f / ifov_mrad, 1e-12);
    EXPECT_NEAR(json["system"][i].get<double>(), json["optics"][i].get<double>() * json["detector"][i].get<double>(),
                1e-12);
    // Diffraction at f/1 between the ends of the band of 7.5 to 13 um.
    const auto diffraction = [&](double wavelength_um) {
      const double nu = f * wavelength_um / 47.5;
      return 2 / std::numbers::pi * (std::acos(nu) - nu * std::sqrt(1 - nu * nu));
    };
    EXPECT_LE(json["optics"][i].get<double>(), diffraction(7.5) + 1e-12);
    EXPECT_GE(json["optics"][i].get<double>(), diffraction(13) - 1e-12);
  }
}

TEST(RenderJson, IsAWindowOfKelvinThatScalesWithTheContrastAndTurnsWithTheApex) {
  const auto render = [](const std::string& apex, const std::string& contrast) {
    const Ended ended = todbench(
        {"render", "--sensor", "sc2000", "--size-pitch", "3", "--apex", apex, "--delta-t-k", contrast, "--json"});
    EXPECT_EQ(ended.code, 0) << ended.err;
    return one_object(ended);
  };
  const Json up = render("up", "1");
  const Json hot = render("up", "-4");
  const Json down = render("down", "1");

  EXPECT_THAT(keys_of(up), UnorderedElementsAre("values", "pitch_mrad", "max_error_estimate"));
  EXPECT_NEAR(up["pitch_mrad"].get<double>(), 47.5 / 36.3, 1e-12);
  ASSERT_EQ(up["values"].size(), 9u);
  ASSERT_EQ(up["values"][0].size(), 9u);
  const double error = up["max_error_estimate"];
  EXPECT_LT(error, 1e-3);
  for (std::size_t j = 0; j < 9; ++j) {
    for (std::size_t i = 0; i < 9; ++i) {
      const double value = up["values"][j][i];
      EXPECT_NEAR(hot["values"][j][i].get<double>(), -4 * value, 1e-12);
      EXPECT_NEAR(down["values"][8 - j][i].get<double>(), value, 2 * error + 1e-12);
      EXPECT_NEAR(up["values"][j][8 - i].get<double>(), value, 2 * error + 1e-12);
    }
  }
}

TEST(RenderJson, TheTiffHoldsTheSameNumbers) {
  const TemporaryFolder folder;

  const Ended ended = todbench({"render", "--sensor", "sc2000", "--size-pitch", "5", "--tiff", "t.tiff", "--json"},
                               {.folder = folder.path()});

  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json json = one_object(ended);
  const auto image = read_picture(folder.path() / "t.tiff");
  ASSERT_TRUE(image.has_value());
  EXPECT_FALSE(image->counts.has_value());  // floating point
  ASSERT_EQ(image->picture.size(), cv::Size(9, 9));
  EXPECT_EQ(image->picture(4, 4), json["values"][4][4].get<float>());
  EXPECT_EQ(image->picture(2, 7), json["values"][2][7].get<float>());
}

TEST(RangeJson, ReadsTheCurveOfASessionAndFollowsTheTargetLine) {
  const TemporaryFolder folder;
  folder.write("plan.toml", small_plan(8));
  const Ended simulated = todbench({"simulate", "./plan.toml", "--out", "s", "--json"}, {.folder = folder.path()});
  ASSERT_TRUE(completed(simulated));
  const double acuity = one_object(simulated)["points"][0]["acuity_per_mrad"];
  const auto predict = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"range", "--tod", "s", "--size-m", "4.9", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return todbench(arguments, {.folder = folder.path()});
  };

  const Ended met = predict({"--delta-t-k", "20", "--v50", "8.5"});
  const Ended faint = predict({"--delta-t-k", "0.01", "--m75", "5.1", "--extinction-per-km", "0.2"});

  ASSERT_EQ(met.code, 0) << met.err;
  const Json json = one_object(met);
  EXPECT_NEAR(json["r75_m"].get<double>(), 4900 * acuity / 5.1, 1e-6);  // acuity is constant above 16.9 K
  EXPECT_LT(json["r75_ci95_m"][0], json["r75_m"]);
  EXPECT_GT(json["r75_ci95_m"][1], json["r75_m"]);
  ASSERT_GT(json["curve"].size(), 10u);
  EXPECT_TRUE(json["curve"][0].contains("range_m"));
  EXPECT_GT(json["curve"][0]["probability"], 0.99);
  EXPECT_EQ(faint.code, 3) << faint.err;
  EXPECT_TRUE(one_object(faint)["r75_m"].is_null());
  EXPECT_THAT(one_object(faint)["reason"].get<std::string>(), ::testing::HasSubstr("below the lowest contrast"));
  expect_refused(predict({"--delta-t-k", "1", "--v50", "8.5", "--m75", "5.1"}), 2, "range");
  expect_refused(todbench({"range", "--tod", "none", "--size-m", "1", "--delta-t-k", "1"}), 2, "none");
}

TEST(SimulatedSensor, ThatEndsBelowTheTargetIsNotFitForADecision) {
  const TemporaryFolder folder;
  ChildOptions options;
  options.folder = folder.path();

  // The SC2000 ends at 413.8 K, 114 K above the background.
  const Ended clipped = todbench(
      {"simulate", "--sensor", "sc2000", "--delta-t-k", "300", "--accuracy", "draft", "--out", "s", "--json"}, options);

  EXPECT_EQ(clipped.code, 3) << clipped.err;
  const Json json = one_object(clipped);
  EXPECT_EQ(json["verdict"], "inconclusive");
  const Json& adequacy = json["points"][0]["adequacy"];
  EXPECT_EQ(adequacy["adequate"], false);
  EXPECT_THAT(adequacy["findings"].dump(), ::testing::HasSubstr("\"clipping\"")) << adequacy;

  const Ended ranged = todbench({"range", "--tod", "s", "--size-m", "3", "--delta-t-k", "300", "--json"}, options);
  EXPECT_EQ(ranged.code, 3) << ranged.err;
  EXPECT_GT(one_object(ranged)["r75_m"].get<double>(), 0);
  EXPECT_EQ(one_object(ranged)["adequacy"]["adequate"], false);
}

}  // namespace
}  // namespace todbench::testing
