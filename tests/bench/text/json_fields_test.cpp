// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/text/json_fields.h"

#include <gmock/gmock.h>

#include <array>
#include <cstdint>
#include <limits>

#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::EndsWith;
using ::testing::StartsWith;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double no_end = std::numeric_limits<double>::infinity();

enum class Lamp { off, on };
constexpr std::array lamps{Lamp::off, Lamp::on};
std::string_view to_string(Lamp lamp) {
  return lamp == Lamp::on ? "on" : "off";
}

struct Pair {
  double a = 0;
  int b = 0;
  bool operator==(const Pair&) const = default;
};

struct Sample {
  double number = 0.5;
  std::optional<double> unknown{};
  int whole = -3;
  std::uint64_t count = std::numeric_limits<std::uint64_t>::max();
  bool flag = true;
  std::string text = "a \"text\"", reason{};
  Lamp lamp = Lamp::on;
  std::optional<Lamp> other_lamp{};
  Interval interval{0.25, std::nullopt};
  std::vector<double> numbers{1, 2.5};
  std::vector<std::string> texts{"x"};
  std::vector<Lamp> all{Lamp::off, Lamp::on};
  std::map<std::string, std::uint64_t> counts{{"gap", 2}};
  std::vector<Pair> pairs{{1, 2}, {3, 4}};
  std::optional<Pair> absent{}, beside = Pair{5, 6};
  double newer = 7;
  std::optional<std::string> note{};
  double tolerant = 8;
};

void pair_fields(JsonFields& json, Pair& pair) {
  json.value("a", pair.a);
  json.value("b", pair.b);
}

void sample_fields(JsonFields& json, Sample& sample) {
  json.constant("schema", "sample-1");
  json.value("number", sample.number);
  json.value("unknown", sample.unknown);
  json.value("whole", sample.whole);
  json.value("count", sample.count);
  json.value("flag", sample.flag);
  json.value("text", sample.text);
  json.text_or_null("reason", sample.reason);
  json.value("lamp", sample.lamp, lamps);
  json.value("other_lamp", sample.other_lamp, lamps);
  json.value("interval", sample.interval);
  json.derived("twice", 2 * sample.number);
  json.value("numbers", sample.numbers);
  json.value("texts", sample.texts);
  json.value("all", sample.all, lamps);
  json.value("counts", sample.counts);
  json.value("pairs", sample.pairs, pair_fields);
  json.value("absent", sample.absent, pair_fields);
  json.begin("a", sample.beside);
  json.member("a", sample.beside, &Pair::a);
  json.member("b", sample.beside, &Pair::b);
  json.later("newer", sample.newer);
  json.if_any("note", sample.note);
  json.number_or("tolerant", sample.tolerant, 9);
}

Result<Sample> sample_from(const Json& json) {
  return from_json<Sample>(json, sample_fields);
}

TEST(JsonFields, WriteTheKeysInTheOrderOfTheDescription) {
  EXPECT_EQ(to_line(json_of(Sample{}, sample_fields).value()),
            R"({"schema":"sample-1","number":0.5,"unknown":null,"whole":-3,"count":18446744073709551615,"flag":true,)"
            R"("text":"a \"text\"","reason":null,"lamp":"on","other_lamp":null,"interval":[0.25,null],"twice":1.0,)"
            R"("numbers":[1.0,2.5],"texts":["x"],"all":["off","on"],"counts":{"gap":2},)"
            R"("pairs":[{"a":1.0,"b":2},{"a":3.0,"b":4}],"absent":null,"a":5.0,"b":6,"newer":7.0,"tolerant":8.0})");
}

TEST(JsonFields, ReadWhatTheyWrote) {
  Sample sample;
  sample.unknown = 0.125;
  sample.reason = "because";
  sample.other_lamp = Lamp::off;
  sample.absent = Pair{-1, -2};
  sample.beside.reset();
  sample.note = "a note";
  sample.pairs.clear();
  const Json written = json_of(sample, sample_fields).value();

  const Result<Sample> back = sample_from(Json::parse(to_page(written)));

  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(to_line(json_of(*back, sample_fields).value()), to_line(written));
  EXPECT_EQ(back->unknown, 0.125);
  EXPECT_EQ(back->count, std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(back->reason, "because");
  EXPECT_EQ(back->other_lamp, Lamp::off);
  EXPECT_EQ(back->interval.low, 0.25);
  EXPECT_EQ(back->absent, (Pair{-1, -2}));
  EXPECT_EQ(back->beside, std::nullopt);
  EXPECT_EQ(back->note, "a note");
  EXPECT_TRUE(back->pairs.empty());
}

TEST(JsonFields, KeepTheMemberWhereAnOlderRecordLacksTheKey) {
  Json json = json_of(Sample{}, sample_fields).value();
  json.erase("newer");
  json["tolerant"] = nullptr;

  const Sample from_old = sample_from(json).value();
  json["newer"] = nullptr;
  const Sample from_null = sample_from(json).value();

  EXPECT_EQ(from_old.newer, 7);
  EXPECT_EQ(from_null.newer, 7);
  EXPECT_EQ(from_old.note, std::nullopt);
  EXPECT_EQ(from_old.tolerant, 9);
}

struct Mistake {
  const char* name;
  std::function<void(Json&)> make;
  const char* message;
};

void PrintTo(const Mistake& mistake, std::ostream* out) {
  *out << mistake.name;
}

class MistakenRecord : public ::testing::TestWithParam<Mistake> {};

TEST_P(MistakenRecord, IsNamedWithItsKey) {
  Json json = json_of(Sample{}, sample_fields).value();
  GetParam().make(json);

  const Result<Sample> read = sample_from(json);

  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::invalid_input);
  EXPECT_EQ(read.error().message, GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    Keys, MistakenRecord,
    ::testing::Values(
        Mistake{"schema", [](Json& j) { j["schema"] = "sample-2"; }, "'schema': expected 'sample-1'"},
        Mistake{"missing", [](Json& j) { j.erase("number"); }, "missing key 'number'"},
        Mistake{"null_number", [](Json& j) { j["number"] = nullptr; }, "'number': expected a number"},
        Mistake{"whole", [](Json& j) { j["whole"] = 1.5; }, "'whole': expected a whole number"},
        Mistake{"count", [](Json& j) { j["count"] = -1; }, "'count': expected a whole number of 0 or more"},
        Mistake{"flag", [](Json& j) { j["flag"] = 1; }, "'flag': expected true or false"},
        Mistake{"text", [](Json& j) { j["text"] = 1; }, "'text': expected a text"},
        Mistake{"text_or_null", [](Json& j) { j["reason"] = 1; }, "'reason': expected a text"},
        Mistake{"word", [](Json& j) { j["lamp"] = "dim"; }, "'lamp': expected a known word"},
        Mistake{"interval", [](Json& j) { j["interval"] = {1}; }, "'interval': expected two ends, low and high"},
        Mistake{"list", [](Json& j) { j["numbers"] = 1; }, "'numbers': expected a list"},
        Mistake{"element", [](Json& j) { j["numbers"][1] = nullptr; }, "'numbers[1]': expected a number"},
        Mistake{"map", [](Json& j) { j["counts"]["gap"] = "2"; }, "'counts.gap': expected a whole number of 0 or more"},
        Mistake{"nested", [](Json& j) { j["pairs"][1].erase("b"); }, "missing key 'pairs[1].b'"},
        Mistake{"optional_record", [](Json& j) { j["absent"] = 3; }, "'absent': expected an object"},
        Mistake{"member", [](Json& j) { j["b"] = nullptr; }, "'b': expected a whole number"},
        Mistake{"newer", [](Json& j) { j["newer"] = "7"; }, "'newer': expected a number"},
        Mistake{"no_object", [](Json& j) { j = Json::array(); }, "'': expected an object"}),
    [](const auto& instance) { return std::string(instance.param.name); });

TEST(JsonFields, RefuseToWriteANumberThatIsNotFinite) {
  for (const double bad : {not_a_number, no_end, -no_end}) {
    Sample sample, in_list, nested;
    sample.number = bad;
    in_list.numbers[1] = bad;
    nested.pairs[1].a = bad;

    const Result<Json> written = json_of(sample, sample_fields);

    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, ErrorCode::internal);
    EXPECT_THAT(written.error().message, StartsWith("'number': expected a finite number, found "));
    EXPECT_THAT(json_of(in_list, sample_fields).error().message, StartsWith("'numbers[1]': expected a finite number"));
    EXPECT_THAT(json_of(nested, sample_fields).error().message, StartsWith("'pairs[1].a': expected a finite number"));
    EXPECT_EQ(printed_json(sample, sample_fields)["number"], nullptr);
  }
}

TEST(JsonFields, WriteAnOptionalNumberThatIsNotFiniteAsNull) {
  for (const double bad : {not_a_number, no_end}) {
    Sample sample;
    sample.unknown = bad;
    sample.interval.high = bad;
    sample.tolerant = bad;

    const Sample back = sample_from(json_of(sample, sample_fields).value()).value();

    EXPECT_EQ(back.unknown, std::nullopt);
    EXPECT_EQ(back.interval.high, std::nullopt);
    EXPECT_EQ(back.tolerant, 9);
  }
}

TEST(JsonFields, WriteADerivedNumberThatIsNotFiniteAsNull) {
  const Result<Json> written = json_of(Sample{}, [](JsonFields& json, Sample& sample) {
    json.derived("number", not_a_number);
    json.derived("numbers", std::vector{1.0, no_end});
    json.derived("pair", Pair{not_a_number, 2}, pair_fields);
    json.derived("absent", sample.absent, pair_fields);
    json.derived("lamp", sample.lamp);
  });

  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(to_line(*written),
            R"({"number":null,"numbers":[1.0,null],"pair":{"a":null,"b":2},"absent":null,"lamp":"on"})");
}

TEST(JsonFile, IsNotWrittenIfTheRecordHasAMistake) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "sample.json";
  Sample bad;
  bad.number = not_a_number;

  const Result<void> refused = write_json_file(file, json_of(bad, sample_fields));
  const bool there = std::filesystem::exists(file);
  const Result<void> written = write_json_file(file, json_of(Sample{}, sample_fields));

  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, StartsWith(file.string() + ": 'number': expected a finite number"));
  EXPECT_FALSE(there);
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(testing::content_of(file), to_page(json_of(Sample{}, sample_fields).value()));
  EXPECT_THAT(testing::content_of(file), EndsWith("\n"));
}

}  // namespace
}  // namespace todbench
