// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/round_robin/blind_items.h"

#include <gmock/gmock.h>

#include <cmath>

#include "bench/reference_set/reference_files.h"
#include "bench/round_robin/sealed_truth.h"
#include "bench/text/files.h"
#include "bench/text/text.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(BlindItems, OfTwoLaboratoriesAreJudgedToTheSealedTruth) {
  const testing::TemporaryFolder folder;
  const BlindOptions options{.laboratories = 2, .items = 2, .frames = 24, .seed = 77};
  const auto written = write_blind_comparison(folder.path() / "c", options, {});
  ASSERT_TRUE(written) << written.error().message;

  std::vector<SubmittedResult> results;
  for (const char* name : {"laboratory-1", "laboratory-2"}) {
    const auto own = judged_items(folder.path() / "c" / name, name, "hvs-1", 1, {});
    ASSERT_TRUE(own) << own.error().message;
    const auto read = parse_submitted_results(submitted_csv(*own), "own.csv");
    ASSERT_TRUE(read) << read.error().message;
    results.insert(results.end(), read->begin(), read->end());
  }
  const auto found = evaluated(*compared_items(results), 1);
  const auto checks = checked_against(*found, *read_sealed(folder.path() / "c/sealed.json"));

  ASSERT_TRUE(checks) << checks.error().message;
  for (const TruthCheck& check : *checks) {
    // The Weibull function biases S75 by up to 2 %, and two laboratories of 3 % have 2 % together.
    EXPECT_LT(std::abs(check.difference / check.truth.value), 0.08) << check.truth.item;
  }
  // Frames of their own.
  EXPECT_NE(*sha256_of_file(folder.path() / "c/laboratory-1/item-1.tif"),
            *sha256_of_file(folder.path() / "c/laboratory-2/item-1.tif"));
  EXPECT_NE(results[0].value, results[2].value);
}

TEST(BlindItems, AreTheSameForASeedAndDoNotStateWhatIsSealed) {
  const testing::TemporaryFolder folder;
  const BlindOptions options{.laboratories = 2, .items = 1, .frames = 8, .seed = 5};
  const auto a = write_blind_comparison(folder.path() / "a", options, {});
  const auto b = write_blind_comparison(folder.path() / "b", options, {});
  ASSERT_TRUE(a && b);

  const auto place = folder.path() / "a/laboratory-1";

  EXPECT_EQ(*set_sums(place), *set_sums(folder.path() / "b/laboratory-1"));
  EXPECT_EQ(a->sealed_sha256, *sha256_of_file(folder.path() / "a/sealed.json"));
  const SensorSpec sensor = blind_cases(options).front().sensor;
  EXPECT_THAT(*read_text_file(place / "protocol.html"), HasSubstr(a->sealed_sha256));
  for (const auto& file : std::filesystem::recursive_directory_iterator(place)) {
    if (!file.is_regular_file()) continue;
    const std::string text = *read_text_file(file.path());
    EXPECT_THAT(text, Not(HasSubstr(number_text(sensor.netd_k)))) << file.path();
    EXPECT_THAT(text, Not(HasSubstr(number_text(sensor.aberration_sigma_pitch)))) << file.path();
    EXPECT_THAT(text, Not(HasSubstr(number_text(a->truths.front().s75_mrad)))) << file.path();
  }
  EXPECT_EQ(judged_items(folder.path() / "none", "A", "hvs-1", 1, {}).error().code, ErrorCode::invalid_input);
  // The recordings state neither a display nor the noise of the camera.
  EXPECT_THAT(judged_items(place, "A", "hvs-2", 1, {}).error().message, HasSubstr("has an eye and needs a display"));
  EXPECT_THAT(judged_items(place, "A", "human-like-1", 1, {}).error().message, HasSubstr("enlarges the noise"));
}

TEST(BlindItems, WithDamagedFilesAreRefused) {
  const testing::TemporaryFolder folder;
  folder.write("items.csv", "item,quantity,set_delta_t_k,ifov_mrad\n../a,q,1,1\n");
  EXPECT_THAT(judged_items(folder.path(), "A", "hvs-1", 1, {}).error().message, HasSubstr("items.csv:2: column item"));
  folder.write("items.csv", "item,quantity,set_delta_t_k\na,q,1\n");
  EXPECT_THAT(judged_items(folder.path(), "A", "hvs-1", 1, {}).error().message,
              HasSubstr("missing column 'ifov_mrad'"));
  folder.write("items.csv", "item,quantity,set_delta_t_k,ifov_mrad\na,q,nan,1\n");
  EXPECT_THAT(judged_items(folder.path(), "A", "hvs-1", 1, {}).error().message, HasSubstr("column set_delta_t_k"));
}

}  // namespace
}  // namespace todbench
