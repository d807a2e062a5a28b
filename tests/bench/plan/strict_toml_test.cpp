// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/strict_toml.h"

#include <gmock/gmock.h>

namespace todbench {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// Reads a document like a small plan would and returns the message of finish(), empty when all is well.
std::string complaint(std::string_view text) {
  Result<TomlReader> reader = TomlReader::parse(text, "plan.toml");
  if (!reader) return reader.error().message;
  (void)reader->text("name", "unnamed");
  TomlReader target = reader->section("target");
  (void)target.number("distance_m", NumberRange::positive(), 2.0);
  (void)target.whole("phases", 1, 100, 16);
  (void)target.numbers("delta_t_k", NumberRange::any(), std::vector<double>{});
  const std::vector<std::string> kinds{"scpi", "prompt", "scene"};
  (void)target.choice("kind", kinds, "scene");
  (void)target.choices("kinds", kinds, std::vector<std::string>{});
  (void)target.number_or("lapse", NumberRange::between(0, 0.1), "free", 0.0);
  for (TomlReader& limit : reader->sections("limit")) (void)limit.number("least", NumberRange::any(), std::nullopt);
  const Result<void> read = reader->finish();
  return read ? "" : read.error().message;
}

struct TomlMistake {
  const char* name;
  const char* toml;
  const char* message;
};

void PrintTo(const TomlMistake& mistake, std::ostream* out) {
  *out << mistake.name;
}

class StrictToml : public ::testing::TestWithParam<TomlMistake> {};

TEST_P(StrictToml, NamesFileLineKeyAndWhatWasExpected) {
  EXPECT_EQ(complaint(GetParam().toml), GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    Mistakes, StrictToml,
    ::testing::Values(
        TomlMistake{"unknown_key", "name = \"x\"\n[target]\nphasse = 4\n",
                    "plan.toml:3: unknown key 'phasse' in [target], did you mean 'phases'?"},
        TomlMistake{"unknown_key_far_from_all", "\n\nzzzzzz = 1\n", "plan.toml:3: unknown key 'zzzzzz'"},
        TomlMistake{"key_of_another_section", "distance_m = 1\n",
                    "plan.toml:1: unknown key 'distance_m', it is a key of [target]"},
        TomlMistake{"unknown_table", "[tarjet]\ndistance_m = 1\n",
                    "plan.toml:1: unknown key 'tarjet', did you mean 'target'?"},
        TomlMistake{"unknown_before_missing", "[[limit]]\n\nleats = 1\n",
                    "plan.toml:3: unknown key 'leats' in [limit], did you mean 'least'?"},
        TomlMistake{
            "decimal_comma", "[target]\ndistance_m = 1,309\n",
            "plan.toml:2: not valid TOML: Error while parsing key-value pair: expected a comment or whitespace, "
            "saw ','; decimals have a point: distance_m = 1.309"},
        TomlMistake{
            "text_without_quotes", "name = mine # of us\n",
            "plan.toml:1: not valid TOML: Error while parsing value: could not determine value type; a text has "
            "quotes: name = \"mine\""},
        TomlMistake{"missing_key", "\n[[limit]]\n",
                    "plan.toml:2: missing key 'least' in [limit], expected a finite number"},
        TomlMistake{"wrong_type", "[target]\ndistance_m = \"2\"\n",
                    "plan.toml:2: key 'distance_m' in [target]: expected a number above 0, found \"2\""},
        TomlMistake{"out_of_range", "[target]\ndistance_m = -2\n",
                    "plan.toml:2: key 'distance_m' in [target]: expected a number above 0, found -2"},
        TomlMistake{"not_a_number", "[target]\ndistance_m = nan\n",
                    "plan.toml:2: key 'distance_m' in [target]: expected a number above 0, found nan"},
        TomlMistake{"infinite", "[target]\ndistance_m = inf\n",
                    "plan.toml:2: key 'distance_m' in [target]: expected a number above 0, found inf"},
        TomlMistake{"fraction_for_whole", "[target]\nphases = 2.5\n",
                    "plan.toml:2: key 'phases' in [target]: expected a whole number from 1 to 100, found 2.5"},
        TomlMistake{"element_on_its_line", "[target]\ndelta_t_k = [\n  1,\n  true\n]\n",
                    "plan.toml:4: key 'delta_t_k' in [target]: expected a finite number, found true"},
        TomlMistake{
            "choice", "[target]\nkind = \"scen\"\n",
            "plan.toml:2: key 'kind' in [target]: expected one of 'scpi', 'prompt', 'scene', found \"scen\", did "
            "you mean "
            "'scene'?"},
        TomlMistake{"choices", "[target]\nkinds = [\"scene\",\n \"?\"]\n",
                    "plan.toml:3: key 'kinds' in [target]: expected one of 'scpi', 'prompt', 'scene', found \"?\""},
        TomlMistake{"number_or_word", "[target]\nlapse = \"fre\"\n",
                    "plan.toml:2: key 'lapse' in [target]: expected a number from 0 to 0.1 or \"free\", found \"fre\""},
        TomlMistake{"table_for_value", "[name]\n", "plan.toml:1: key 'name': expected a text in quotes, found a table"},
        TomlMistake{"value_for_table", "target = 3\n", "plan.toml:1: key 'target': expected a table [target], found 3"},
        TomlMistake{"first_line_first", "[target]\nphases = 0\ndistance_m = 0\n",
                    "plan.toml:2: key 'phases' in [target]: expected a whole number from 1 to 100, found 0"}),
    [](const auto& row) { return std::string(row.param.name); });

TEST(TomlReader, WhatIsNotTomlIsRefusedWithItsLine) {
  const std::string message = complaint("name = \"x\"\n[target\n");

  EXPECT_THAT(message, HasSubstr("plan.toml:2: not valid TOML: "));
  EXPECT_THAT(message, Not(HasSubstr("\n")));
}

TEST(TomlReader, AKeyGivenTwiceIsRefused) {
  EXPECT_THAT(complaint("name = \"x\"\nname = \"y\"\n"), HasSubstr("plan.toml:2: not valid TOML"));
}

TEST(TomlReader, MessagesStayOnOneLineWhateverTheValue) {
  EXPECT_THAT(complaint("[target]\nkind = \"a\\nb\"\n"), Not(HasSubstr("\n")));
}

TEST(TomlReader, HandsOutValuesAndFallbacks) {
  auto reader = TomlReader::parse("a = 3\nb = [1, 2.5]\nlapse = \"free\"\n[s]\nx = 1.5\ny = true\nz = \"t\"\n", "f");
  ASSERT_TRUE(reader) << reader.error().message;

  EXPECT_EQ(reader->number("a", NumberRange::any(), 0.0), 3);
  EXPECT_THAT(reader->numbers("b", NumberRange::any(), std::nullopt), ElementsAre(1, 2.5));
  EXPECT_EQ(reader->number_or("lapse", NumberRange::any(), "free", 0.0), std::nullopt);
  EXPECT_EQ(reader->number("missing", NumberRange::any(), 7.0), 7);
  EXPECT_EQ(reader->optional_number("absent", NumberRange::any()), std::nullopt);
  EXPECT_FALSE(reader->section("nowhere").present());
  const std::map<std::string, std::string> expected{{"x", "1.5"}, {"y", "true"}, {"z", "t"}};
  EXPECT_EQ(reader->free_table("s"), expected);
  EXPECT_TRUE(reader->finish());
}

TEST(TomlReader, ARejectedElementIsReportedOnItsOwnLine) {
  auto reader = TomlReader::parse("a = [1,\n2,\n3]\n", "f");
  ASSERT_TRUE(reader) << reader.error().message;
  (void)reader->numbers("a", NumberRange::any(), std::nullopt);

  reader->reject("a", 2, "three is too many");

  ASSERT_FALSE(reader->finish());
  EXPECT_EQ(reader->finish().error().message, "f:3: key 'a': three is too many");
}

std::optional<ErrorKey> key_of_complaint(std::string_view text) {
  Result<TomlReader> reader = TomlReader::parse(text, "plan.toml");
  if (!reader) return reader.error().key;
  TomlReader target = reader->section("target");
  (void)target.number("distance_m", NumberRange::positive(), std::nullopt);
  const Result<void> read = reader->finish();
  return read ? std::nullopt : read.error().key;
}

TEST(StrictTomlKeys, AnErrorHasTheKeyItIsAboutAndWhatIsWrongWithIt) {
  EXPECT_EQ(key_of_complaint("[target]\ndistance_m = -2\n"),
            (ErrorKey{"target.distance_m", "expected a number above 0, found -2"}));
  EXPECT_EQ(key_of_complaint("[target]\n"), (ErrorKey{"target.distance_m", "missing, expected a number above 0"}));
  EXPECT_EQ(key_of_complaint("[target]\ndistanc_m = 2\n"),
            (ErrorKey{"target.distanc_m", "unknown, did you mean 'distance_m'?"}));
  EXPECT_EQ(key_of_complaint("tarjet = 2\n"), (ErrorKey{"tarjet", "unknown, did you mean 'target'?"}));
}

TEST(StrictTomlKeys, ADateWithoutQuotesIsItsText) {
  auto reader = TomlReader::parse("received = 2026-03-09\n", "plan.toml");
  ASSERT_TRUE(reader) << reader.error().message;

  EXPECT_EQ(reader->text("received", ""), "2026-03-09");
  EXPECT_TRUE(reader->finish());
}

TEST(StrictTomlKeys, ABrokenFileIsAboutItsLine) {
  const auto key = key_of_complaint("a = 1\nb = =\n");

  ASSERT_TRUE(key);
  EXPECT_EQ(key->name, "plan.toml:2");
}

}  // namespace
}  // namespace todbench
