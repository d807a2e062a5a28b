// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/reference_set/reference_set.h"

#include <gmock/gmock.h>

#include "acquisition/recording/frame_stream.h"
#include "bench/plan/descriptions.h"
#include "bench/reference_set/reference_files.h"
#include "bench/reference_set/reference_score.h"
#include "bench/text/csv_table.h"
#include "bench/text/files.h"
#include "bench/text/text.h"
#include "hvs/observer/template_observer.h"
#include "tests/support/temporary_folder.h"
#include "tod/registration/patch_windows.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;

const std::vector<ReferenceTruth> truths{{"case-1", 2.0, 0.01}, {"case-2", 4.0, 0.02}};

std::string refusal(const std::string& text) {
  const auto parsed = parse_reference_result(text, "r.csv", truths);
  if (parsed) return "taken";
  EXPECT_EQ(parsed.error().code, ErrorCode::invalid_input);
  return parsed.error().message;
}

TEST(ReferenceResult, IsScoredByCaseWhateverTheOrder) {
  const auto results = parse_reference_result(
      "s75_mrad,case,s75_ci95_low_mrad,s75_ci95_high_mrad\n4.2,case-2,4.1,4.4\n1.9,case-1,,\n", "r.csv", truths);
  ASSERT_TRUE(results) << results.error().message;

  const ReferenceScore found = score(truths, *results);

  EXPECT_NEAR(found.cases[0].deviation_percent, -5, 1e-9);
  EXPECT_NEAR(found.cases[1].deviation_percent, 5, 1e-9);
  EXPECT_FALSE(found.cases[0].interval_holds);
  EXPECT_EQ(found.cases[1].interval_holds, false);
  EXPECT_TRUE(found.passed);
  EXPECT_NEAR(found.rms_deviation_percent, 5, 1e-9);
  EXPECT_NEAR(found.mean_deviation_percent, 100 * (std::sqrt(0.95 * 1.05) - 1), 1e-9);
}

TEST(ReferenceResult, OffByMoreThanTheToleranceFails) {
  const auto results = *parse_reference_result("case,s75_mrad\ncase-1,2.0\ncase-2,4.41\n", "r.csv", truths);

  EXPECT_FALSE(score(truths, results).passed);
  EXPECT_TRUE(score(truths, results).cases[0].within);
}

TEST(ReferenceResult, IsRefusedWithItsRow) {
  EXPECT_THAT(refusal("case,s75_mrad\ncase-1,2\n"), HasSubstr("missing row of case 'case-2'"));
  EXPECT_THAT(refusal("case,s75_mrad\ncase-1,2\ncase-2,4\ncase-1,2\n"),
              HasSubstr("r.csv:4: case 'case-1' occurs twice"));
  EXPECT_THAT(refusal("case,s75_mrad\ncase-1,nan\ncase-2,4\n"),
              HasSubstr("r.csv:2: column s75_mrad: expected a number above 0"));
  EXPECT_THAT(refusal("case,s75_mrad\ncase-1,2\ncase-2,-4\n"), HasSubstr("r.csv:3: column s75_mrad"));
  EXPECT_THAT(refusal("case,s75_mrad\ncase-1,2\ncase-2,inf\n"), HasSubstr("r.csv:3"));
  EXPECT_THAT(refusal("case,s75_mrad\ncase-1,2\ncase-2,\n"), HasSubstr("r.csv:3"));
  EXPECT_THAT(refusal("case,s75_mrad\ncase-1,2\ncase-3,4\n"), HasSubstr("r.csv:3: unknown case 'case-3'"));
  EXPECT_THAT(refusal("case,s75\ncase-1,2\n"), HasSubstr("unknown column 's75'"));
  EXPECT_THAT(refusal("case\ncase-1\n"), HasSubstr("missing column 's75_mrad'"));
  EXPECT_THAT(refusal("case,case,s75_mrad\na,a,2\n"), HasSubstr("occurs twice"));
  EXPECT_THAT(refusal("case,s75_mrad,s75_ci95_low_mrad\ncase-1,2,1\n"), HasSubstr("needs both columns"));
  EXPECT_THAT(refusal("case,s75_mrad,s75_ci95_low_mrad,s75_ci95_high_mrad\ncase-1,2,2.1,3\n"),
              HasSubstr("r.csv:2: column s75_ci95_low_mrad"));
  EXPECT_THAT(refusal(""), HasSubstr("r.csv"));
}

/// One case of the set, small enough for a test.
ReferenceSetOptions one_case(std::uint64_t seed, int frames) {
  ReferenceSetOptions options;
  options.seed = seed;
  options.frames = frames;
  options.cases.resize(1);
  return options;
}

/// Answers of the observer of the set, told where the triangles are.
std::vector<Level> judged(const std::filesystem::path& folder, const ReferenceCase& c) {
  const auto stream = open_frame_stream(folder / (c.name + ".todrec"));
  EXPECT_TRUE(stream);
  const auto table = *parse_csv(*read_text_file(folder / (c.name + "-triangles.csv")), "triangles");
  TemplateObserver observer(*load_observer((folder / "observers/hvs-1.toml").string()), triangle_alternatives());
  std::vector<Level> out;
  const RandomStream noise(3, "test.reference");
  std::uint64_t number = 0;
  const auto scale = std::make_shared<const RadiometricScale>(stream->recording.info.scale);
  for (const CsvRow& row : table.rows) {
    const auto value = [&](std::size_t column) { return *parse_number(row.fields[column]); };
    Frame frame;
    frame.counts = stream->recording.read(static_cast<std::uint64_t>(value(0)))->counts;
    frame.scale = scale;
    const auto prepared = *observer.prepare(value(3) / c.sensor.ifov_mrad(), 1);
    const auto window = patch_window({value(5), value(6)}, prepared->window_samples());
    const auto kelvin = *to_kelvin(frame);
    const Patch patch{.kelvin = kelvin(window.pixels).clone(), .phase = window.phase, .noise_k = 0};
    const int answer = prepared->choose(patch, c.delta_t_k, noise.sub(++number)).alternative;
    const bool right = answer == static_cast<int>(*apex_from(row.fields[4]));
    out.push_back({.size = value(3), .correct = right ? 1.0 : 0.0, .total = 1, .cluster = -1});
  }
  return out;
}

TEST(ReferenceSet, IsTheSameToTheByteForASeedAndItsFramesHaveItsThreshold) {
  const testing::TemporaryFolder folder;
  const auto options = one_case(7, 24);
  ASSERT_TRUE(write_reference_set(folder.path() / "a", options, {}));
  ASSERT_TRUE(write_reference_set(folder.path() / "b", options, {}));
  ASSERT_TRUE(write_reference_set(folder.path() / "c", one_case(8, 2), {}));

  const auto sums = set_sums(folder.path() / "a");

  ASSERT_TRUE(sums);
  EXPECT_EQ(*sums, *set_sums(folder.path() / "b"));
  EXPECT_NE(*sha256_of_file(folder.path() / "a/case-1.tif"), *sha256_of_file(folder.path() / "c/case-1.tif"));
  const auto found = read_truths(folder.path() / "a");
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->front().s75_mrad, read_truths(folder.path() / "c")->front().s75_mrad);
  // The sensor that is described is the one that was simulated.
  const auto sensor = load_sensor((folder.path() / "a/sensors/reference-plain.toml").string());
  ASSERT_TRUE(sensor) << sensor.error().message;
  EXPECT_EQ(sensor->netd_k, options.cases[0].sensor.netd_k);
  EXPECT_EQ(sensor->ifov_mrad(), options.cases[0].sensor.ifov_mrad());
  // A measurement of 480 binary answers told where the triangles are is within three standard errors, the tolerance.
  const auto fit = fit_psychometric(judged(folder.path() / "a", options.cases[0]), {});
  ASSERT_TRUE(fit && fit->threshold);
  const std::string row = "case-1," + number_text(*fit->threshold);
  const auto result = parse_reference_result("case,s75_mrad\n" + row + "\n", "own", *found);
  ASSERT_TRUE(result);
  EXPECT_TRUE(score(*found, *result).passed) << row;
}

TEST(ReferenceSet, ThatWasChangedIsRefused) {
  const testing::TemporaryFolder folder;
  ASSERT_TRUE(write_reference_set(folder.path() / "a", one_case(1, 2), {}));

  folder.write("a/case-1-frames.csv", "frame\n");

  EXPECT_THAT(read_truths(folder.path() / "a").error().message, HasSubstr("SHA256SUMS"));
  EXPECT_EQ(read_truths(folder.path() / "none").error().code, ErrorCode::invalid_input);
}

TEST(ReferenceSet, IsSmallEnoughToPublish) {
  double bytes = 0;
  for (const ReferenceCase& c : ReferenceSetOptions{}.cases)
    bytes += 2.0 * ReferenceSetOptions{}.frames * 2 * c.sensor.width * c.sensor.height;
  // Pages, records and text beside the pixels: below a twentieth.
  EXPECT_LT(1.05 * bytes, 50e6);
}

}  // namespace
}  // namespace todbench
