// SPDX-License-Identifier: GPL-3.0-or-later
// Single measures, as a user and other programs ask for them.
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <vector>

#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"
#include "tests/system/system_test_support.h"
#include "tests/tod/measures/measures_reference.h"
#include "tests/tod/measures/star_picture.h"

namespace todbench::testing {
namespace {

using test::reference_cases;

/// A cube of counts as a recording without a header.
std::string raw_recording(const TemporaryFolder& folder, const Json& cube) {
  const std::filesystem::path path = folder.path() / "cube.raw";
  std::ofstream file(path, std::ios::binary);
  for (const auto& value : cube["cube"]) {
    const auto count = value.get<std::uint16_t>();
    file.write(reinterpret_cast<const char*>(&count), sizeof count);
  }
  return path.string() + "?width=" + cube["columns"].dump() + "&height=" + cube["rows"].dump();
}

std::string npy_picture(const TemporaryFolder& folder, const cv::Mat1d& picture) {
  std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (" + std::to_string(picture.rows) + ", " +
                       std::to_string(picture.cols) + "), }";
  header.append(63 - (10 + header.size()) % 64, ' ');
  header.push_back('\n');
  const std::filesystem::path path = folder.path() / "edge.npy";
  std::ofstream file(path, std::ios::binary);
  file.write("\x93NUMPY\x01\x00", 8);
  file.put(static_cast<char>(header.size() % 256)).put(static_cast<char>(header.size() / 256));
  file << header;
  for (int y = 0; y < picture.rows; ++y)
    file.write(reinterpret_cast<const char*>(picture.ptr(y)),
               static_cast<std::streamsize>(sizeof(double)) * picture.cols);
  return path.string();
}

TEST(NoiseComponents, AreThoseOfTheReferenceWithIntervals) {
  for (const auto& reference : reference_cases("noise3d", "cubes")) {
    const TemporaryFolder folder;

    const Ended ended = todbench({"noise", raw_recording(folder, reference), "--components-only", "--json"});

    ASSERT_EQ(ended.code, 0) << ended.err;
    const Json json = one_object(ended);
    EXPECT_EQ(json["unit"], "counts");
    EXPECT_EQ(json["frames"], reference["frames"]);
    const double tolerance = 1e-9 * reference["unbiased_variance"]["tvh"].get<double>();
    for (const auto& [name, variance] : reference["unbiased_variance"].items()) {
      EXPECT_NEAR(json["variances"][name].get<double>(), variance.get<double>(), tolerance) << name;
      EXPECT_LT(json["intervals"][name][0].get<double>(), json["variances"][name].get<double>());
      EXPECT_GT(json["intervals"][name][1].get<double>(), json["variances"][name].get<double>());
    }
    EXPECT_NEAR(json["intervals"]["tvh"][0].get<double>(), reference["tvh_variance_ci95"][0].get<double>(), tolerance);
  }
}

TEST(NoiseComponents, RefuseACubeAcrossACorrectionUnlessAskedToTakeIt) {
  const TemporaryFolder folder;
  const RandomStream random(1, "corrected cube");
  Json cube{{"rows", 24}, {"columns", 32}};
  for (int k = 0; k < 20; ++k) {
    for (int i = 0; i < 24 * 32; ++i) {
      const auto pixel = static_cast<std::uint64_t>(i);
      const double pattern = k < 12 ? 0 : 20 * static_cast<double>(random.sub(99).normal(pixel));
      cube["cube"].push_back(std::lround(
          8000 + pattern + 10 * static_cast<double>(random.sub(static_cast<std::uint64_t>(k)).normal(pixel))));
    }
  }
  const std::string recording = raw_recording(folder, cube);

  expect_refused(todbench({"noise", recording, "--components-only", "--json"}), 2,
                 "the camera performed a correction (NUC) before frame 13");
  EXPECT_EQ(todbench({"noise", recording, "--components-only", "--across-corrections"}).code, 0);
}

TEST(Sfr, FindsTheMtfOfAnEdgeAndItsAngle) {
  const TemporaryFolder folder;
  const test::EdgePicture made;

  const Ended ended =
      todbench({"sfr", npy_picture(folder, made.picture()), "--axis", "x", "--pitch-mrad", "0.5", "--json"});

  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json json = one_object(ended);
  EXPECT_EQ(json["axis"], "x");
  EXPECT_NEAR(json["angle_deg"].get<double>(), 5, 0.001);
  ASSERT_EQ(json["frequency_per_pitch"].size(), json["mtf"].size());
  ASSERT_EQ(json["mtf_ci95"].size(), json["mtf"].size());
  for (std::size_t i = 0; i < json["mtf"].size(); ++i) {
    const double frequency = json["frequency_per_pitch"][i], truth = made.mtf(frequency);
    EXPECT_EQ(json["frequency_per_mrad"][i].get<double>(), frequency / 0.5);
    // The method's error of slanted_edge_test, and what is more beyond half a cycle.
    EXPECT_NEAR(json["mtf"][i].get<double>(), truth, frequency <= 0.5 ? 0.0003 : 0.0023);
    EXPECT_LE(json["mtf_ci95"][i][0].get<double>(), truth + 1e-12);
    EXPECT_GE(json["mtf_ci95"][i][1].get<double>(), truth - 1e-12);
  }
}

TEST(Sfr, NamesAStatedLensThatCannotHaveMadeThePicture) {
  const TemporaryFolder folder;
  const std::string picture = npy_picture(folder, test::EdgePicture().picture());
  const auto of_lens = [&](const char* f_number) {
    return todbench({"sfr", picture, "--f-number", f_number, "--wavelength-um", "10", "--pitch-um", "10", "--json"});
  };

  const Ended plain = todbench({"sfr", picture, "--json"}), contradicted = of_lens("4"), possible = of_lens("0.1");

  // At f/4 the cut-off is 0.25 cycles per pitch.
  ASSERT_EQ(contradicted.code, 3) << contradicted.err;
  EXPECT_THAT(contradicted.err, ::testing::HasSubstr("the stated lens contradicts the picture"));
  const Json json = one_object(contradicted);
  EXPECT_LT(json["above_stated_lens_per_pitch"].get<double>(), 0.25);
  EXPECT_EQ(json["mtf"], one_object(plain)["mtf"]);
  EXPECT_TRUE(one_object(plain)["above_stated_lens_per_pitch"].is_null());
  EXPECT_EQ(possible.code, 0) << possible.err;
}

TEST(Sfr, ALimitOfZeroExcludesHalosOfEveryWidth) {
  const TemporaryFolder folder;
  const std::string picture = npy_picture(folder, test::EdgePicture().noisy(0.01, 1));

  const Json json = one_object(todbench({"sfr", picture, "--halo-at-most", "0", "--json"}));

  EXPECT_LT(json["wide_halo_ci95"][1].get<double>(), 0.001);
  EXPECT_EQ(json["mtf_ci95"], json["mtf_ci95_in_picture"]);
}

TEST(Sfr, MeasuresEveryEdgeOfAStar) {
  const TemporaryFolder folder;
  const test::StarPicture made;
  const std::string picture = npy_picture(folder, made.picture());

  const Ended ended = todbench({"sfr", picture, "--star", "150.3,99.6,80", "--pitch-mrad", "0.5", "--json"});

  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json json = one_object(ended);
  ASSERT_EQ(json["edges"].size(), 8u);
  for (const Json& edge : json["edges"]) {
    EXPECT_EQ(edge["direction"], "central");
    const double truth = made.edge_of(edge["normal_deg"]).mtf(edge["frequency_per_pitch"][30]);
    EXPECT_NEAR(edge["mtf"][30].get<double>(), truth, 0.001) << edge["edge_deg"];
    EXPECT_LE(edge["mtf_ci95"][30][0].get<double>(), truth) << edge["edge_deg"];
    EXPECT_GE(edge["mtf_ci95"][30][1].get<double>(), truth) << edge["edge_deg"];
  }
  EXPECT_THAT(todbench({"sfr", picture, "--star", "150.3,99.6,80"}).out, ::testing::HasSubstr("central"));
  expect_refused(todbench({"sfr", picture, "--star", "150,99,120"}), 2, "the star extends beyond the picture");
  expect_refused(todbench({"sfr", picture, "--star", "60,60,40"}), 2, "expected an even number of at least 4");
  expect_refused(todbench({"sfr", picture, "--star", "150,99,80", "--region", "1,1,9,9"}), 2, "excludes");
}

TEST(Sfr, RefusesEveryEdgeThatItCannotMeasureWithOneSentence) {
  const TemporaryFolder folder;
  const auto refuse = [&](const cv::Mat1d& picture, const std::string& sentence,
                          const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"sfr", npy_picture(folder, picture), "--json"};
    words.insert(words.end(), more.begin(), more.end());
    expect_refused(todbench(words), 2, sentence);
  };
  const cv::Mat1d picture = test::EdgePicture().picture();
  test::EdgePicture upright;
  upright.angle_deg = 0.2;
  cv::Mat1d broken = picture.clone();
  broken(1, 1) = std::nan("");
  refuse(upright.picture(), "less than one pixel");
  refuse(cv::min(picture, 0.8), "clipped");
  refuse(broken, "not finite");
  refuse(cv::Mat1d::zeros(80, 41), "no edge");
  refuse(picture, "slanted by", {"--axis", "y"});
  refuse(picture, "beyond the picture", {"--region", "10,10,100,20"});
  expect_refused(todbench({"sfr", "absent.tiff"}), 2, "no such file");
  expect_refused(todbench({"sfr", source_file("tests/golden/README.md")}), 2, "expected a TIFF or .npy file");
}

TEST(Sitf, GivesTheLineOfTheReferenceWithAndWithoutUncertainties) {
  const TemporaryFolder folder;
  const Json reference = reference_cases("sitf_netd", "sitf")[1];
  std::string stated = "delta_t_k,counts,counts_se\n", plain = "delta_t_k,counts\n";
  for (std::size_t i = 0; i < reference["counts"].size(); ++i) {
    const std::string step = reference["delta_t_k"][i].dump() + "," + reference["counts"][i].dump();
    stated += step + "," + reference["counts_se"][i].dump() + "\n", plain += step + "\n";
  }

  const Json json = one_object(todbench({"sitf", folder.write("stated.csv", stated), "--json"}));
  const Json without = one_object(todbench({"sitf", folder.write("plain.csv", plain), "--json"}));

  EXPECT_NEAR(json["slope"].get<double>(), reference["slope_counts_per_k"].get<double>(), 1e-9 * 250);
  EXPECT_NEAR(json["slope_u"].get<double>(), reference["slope_se_from_stated"].get<double>(), 1e-9);
  EXPECT_NEAR(json["offset"].get<double>(), reference["offset_counts"].get<double>(), 1e-9 * 20000);
  EXPECT_NEAR(json["chi2"].get<double>(), reference["chi_square"].get<double>(), 1e-8);
  EXPECT_NEAR(json["p"].get<double>(), reference["p_of_fit"].get<double>(), 1e-9);
  EXPECT_NEAR(json["nonlinearity_percent"].get<double>(), reference["nonlinearity_percent_of_span"].get<double>(),
              1e-9);
  EXPECT_TRUE(without["chi2"].is_null());
  EXPECT_TRUE(without["slope_u_stated"].is_null());
  EXPECT_EQ(without["slope_u"], without["slope_u_scatter"]);
}

TEST(Sitf, RefusesStepsThatGiveNoLine) {
  const TemporaryFolder folder;
  const auto refuse = [&](const std::string& text, const std::string& sentence) {
    expect_refused(todbench({"sitf", folder.write("steps.csv", text), "--json"}), 2, sentence);
  };
  refuse("", "empty");
  refuse("delta_t_k,counts\n", "three steps");
  refuse("delta_t_k,counts\n1,1\n1,2\n1,3\n", "no spread");
  refuse("delta_t_k,counts\n1,1\n2,nan\n3,3\n", "steps.csv:3: column counts: expected a number");
  refuse("delta_t_k,counts,counts_se\n1,1,1\n2,2,0\n3,3,1\n",
         "steps.csv:3: the uncertainty of the signal must be above 0");
  refuse("delta_t_k,counts,counts_se\n1,1,1\n2,2,\n3,3,1\n", "for all steps or for none");
  refuse("celsius,counts\n1,1\n2,2\n3,3\n", "delta_t_k");
}

TEST(ConformityCommand, DecidesAndEndsWithTheFittingCode) {
  const auto run = [](const std::string& value, const std::string& rule) {
    return todbench({"conformity", "--value", value, "--u", "0.0071", "--at-least", "0.4", "--rule", rule, "--json"});
  };
  const Json json = one_object(run("0.4763", "guarded"));
  EXPECT_EQ(json["decision"], "pass");
  EXPECT_NEAR(json["p_conformity"].get<double>(), 1, 1e-12);
  EXPECT_NEAR(json["guard_band"].get<double>(), 0.0142, 1e-12);
  EXPECT_NEAR(json["acceptance_limits"][0].get<double>(), 0.4142, 1e-12);
  EXPECT_TRUE(json["acceptance_limits"][1].is_null());
  EXPECT_EQ(run("0.4763", "simple").code, 0);
  EXPECT_EQ(run("0.41", "non_binary").code, 3);
  EXPECT_EQ(run("0.41", "guarded").code, 1);
  EXPECT_EQ(run("0.41", "guarded_acceptance_and_rejection").code, 3);
  EXPECT_EQ(run("0.3", "non_binary").code, 1);
  EXPECT_EQ(one_object(run("0.398", "non_binary"))["decision"], "conditional fail");
  // GUM, table G.2: 95.45 % of Student's t with two degrees of freedom are within 4.53.
  const Json few =
      one_object(todbench({"conformity", "--value", "2", "--u", "0.1", "--nu", "2", "--at-least", "1.8", "--json"}));
  EXPECT_NEAR(few["guard_band"].get<double>(), 0.453, 0.0005);
  EXPECT_EQ(few["decision"], "inconclusive");
  expect_refused(todbench({"conformity", "--value", "1", "--u", "0", "--at-least", "0"}), 2, "greater than 0");
  expect_refused(todbench({"conformity", "--value", "nan", "--u", "1", "--at-least", "0"}), 2, "--value");
  expect_refused(todbench({"conformity", "--value", "1", "--u", "1"}), 2, "no limit");
  expect_refused(todbench({"conformity", "--value", "1", "--u", "1", "--at-least", "0", "--rule", "mild"}), 2,
                 "--rule");
}

TEST(BudgetCommand, CombinesTheRowsOfAFile) {
  const TemporaryFolder folder;
  const Json reference = reference_cases("conformity", "budgets")[1];
  std::string text;
  for (const auto& row : reference["components"]) {
    text += "[[component]]\nname = " + row["name"].dump() + "\nvalue = " + row["value"].dump() +
            "\ndistribution = " + row["kind"].dump() + "\n";
    if (!row["degrees_of_freedom"].is_null()) text += "degrees_of_freedom = " + row["degrees_of_freedom"].dump() + "\n";
  }
  const std::string file = folder.write("budget.toml", text);

  const Ended ended = todbench({"budget", file, "--json"});

  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json json = one_object(ended);
  EXPECT_NEAR(json["u"].get<double>(), reference["combined"].get<double>(), 1e-10);
  EXPECT_NEAR(json["nu_eff"].get<double>(), reference["effective_degrees_of_freedom"].get<double>(), 1e-7);
  EXPECT_NEAR(json["k"].get<double>(), reference["coverage_factor_95"].get<double>(), 1e-8);
  EXPECT_NEAR(json["expanded_gum"].get<double>(), reference["expanded_95"].get<double>(), 1e-9);
  const double monte_carlo = reference["monte_carlo_half_width_95"];
  EXPECT_NEAR(json["expanded_monte_carlo"].get<double>(), monte_carlo, 0.01 * monte_carlo);
  EXPECT_EQ(json["rows"].size(), 3u);
  EXPECT_EQ(todbench({"budget", file, "--json"}).out, ended.out);
  expect_refused(todbench({"budget", folder.write("budget.toml", "[[component]]\nname = 'a'\nvalue = -1\n")}), 2,
                 "budget.toml:3");
}

}  // namespace
}  // namespace todbench::testing
