// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/text/text.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <bit>
#include <cmath>
#include <limits>

#include "acquisition/base/rng.h"
#include "bench/text/files.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(AtomicFiles, ReplaceNeitherPipesNorDevices) {
  const testing::TemporaryFolder folder;
  const auto path = folder.path() / "pipe";
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);

  const auto refused = write_file_atomically(path, "text");

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_input);
  EXPECT_EQ(std::filesystem::status(path).type(), std::filesystem::file_type::fifo);
}

TEST(NumberText, ReadsBackAsTheSameBitsForAnyDouble) {
  const RandomStream stream(7, "number text");
  int finite = 0;

  for (std::uint64_t i = 0; i < 20000; ++i) {
    const auto words = stream.words(i);
    const double value = std::bit_cast<double>((std::uint64_t{words[0]} << 32) | words[1]);
    if (!std::isfinite(value)) continue;
    ++finite;
    const std::optional<double> back = parse_number(number_text(value));
    ASSERT_TRUE(back) << number_text(value);
    ASSERT_EQ(std::bit_cast<std::uint64_t>(*back), std::bit_cast<std::uint64_t>(value)) << number_text(value);
  }

  EXPECT_GT(finite, 19000);  // 2046 of 2048 exponents are finite
}

TEST(NumberText, IsTheShortestDecimalAndUsesADot) {
  EXPECT_EQ(number_text(0.1), "0.1");
  EXPECT_EQ(number_text(2), "2");
  EXPECT_EQ(number_text(0.1 + 0.2), "0.30000000000000004");
  EXPECT_EQ(number_text(-16.9), "-16.9");
}

TEST(ParseNumber, TakesWholeFiniteNumbersOnly) {
  EXPECT_EQ(parse_number("1e3"), 1000.0);
  EXPECT_EQ(parse_number("+2.5"), 2.5);
  EXPECT_EQ(parse_number("-0"), 0.0);

  for (const char* text : {"", " 1", "1 ", "1,5", "nan", "inf", "-inf", "1e999", "0x10", "1.5mm", "+-1", "--1", "."}) {
    EXPECT_FALSE(parse_number(text)) << '"' << text << '"';
  }
}

TEST(NearestName, FindsTheSlipOfThePenAndNothingFarther) {
  const std::vector<std::string> known{"phases", "plates", "distance_m", "item_condition"};

  EXPECT_EQ(nearest_name("condition", known), "item_condition");
  EXPECT_EQ(nearest_name("phasse", known), "phases");
  EXPECT_EQ(nearest_name("distance", known), "distance_m");
  EXPECT_EQ(nearest_name("lpates", known), "plates");
  EXPECT_EQ(nearest_name("qqqqqq", known), std::nullopt);
  EXPECT_EQ(nearest_name("", known), std::nullopt);
}

TEST(Csv, FieldsWithCommasQuotesAndBlanksSurviveTheRoundTrip) {
  const std::vector<std::string> fields{"row 2, triangle 3", "say \"up\"", "", " blank ", "plain"};
  std::string line;
  for (const std::string& field : fields) line += (line.empty() ? "" : ",") + csv_field(field);

  const Result<std::vector<std::string>> back = split_csv(line);

  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(*back, fields);
}

TEST(Csv, AnEmptyFieldAtTheEndIsAField) {
  EXPECT_THAT(split_csv("a,").value(), ElementsAre("a", ""));
  EXPECT_THAT(split_csv("").value(), ElementsAre(""));
}

TEST(Csv, MisplacedQuotesAreRefused) {
  for (const char* line : {"\"open", "\"a\"b,c", "a\"b"}) {
    const auto fields = split_csv(line);
    ASSERT_FALSE(fields) << line;
    EXPECT_EQ(fields.error().code, ErrorCode::invalid_input);
  }
}

TEST(ReadTextFile, SaysInOneSentenceWhatIsWrong) {
  const testing::TemporaryFolder folder;

  const auto missing = read_text_file(folder.path() / "none.toml");
  const auto directory = read_text_file(folder.path());

  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(missing.error().message, HasSubstr("none.toml: no such file"));
  ASSERT_FALSE(directory);
  EXPECT_THAT(directory.error().message, HasSubstr("is a folder"));
}

TEST(ReadTextFile, ReadsAnEmptyFile) {
  const testing::TemporaryFolder folder;

  const auto text = read_text_file(folder.write("empty", ""));

  ASSERT_TRUE(text) << text.error().message;
  EXPECT_EQ(*text, "");
}

TEST(ReadTextFile, EndsWhereAFileDoesNot) {
  const auto endless = read_text_file("/dev/zero");

  ASSERT_FALSE(endless);
  EXPECT_EQ(endless.error().code, ErrorCode::invalid_input);
}

}  // namespace
}  // namespace todbench
