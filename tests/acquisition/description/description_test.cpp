// SPDX-License-Identifier: GPL-3.0-or-later
// What of descriptions is refused before anybody evaluates them, and what is not.
#include "acquisition/description/description.h"

#include <gmock/gmock.h>

#include "acquisition/description/description_url.h"
#include "acquisition/description/description_zip.h"
#include "acquisition/description/formula_range.h"
#include "sim_devices/lab/gige/camera_models.h"
#include "tests/acquisition/description/hostile_descriptions.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using namespace testing_support;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string description_of(CameraModel model) {
  return genicam_xml(describe_camera(model, {}).genicam);
}

std::string described(const std::string& nodes) {
  return "<RegisterDescription ModelName=\"M\" VendorName=\"V\">" + nodes + "</RegisterDescription>";
}

std::vector<std::uint8_t> bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

TEST(Description, OfEveryEmulatedCameraIsAccepted) {
  for (const auto model :
       {CameraModel::ax5, CameraModel::a_series, CameraModel::legacy_science, CameraModel::unlisted}) {
    const Description description(description_of(model));

    EXPECT_THAT(description.faults(), IsEmpty()) << to_string(model);
    EXPECT_THAT(description.faults_of("Width"), IsEmpty());
    EXPECT_THAT(description.lengths_of("Width"), IsEmpty());
  }
}

class Hostile : public ::testing::TestWithParam<HostileDescription> {};

TEST_P(Hostile, IsToldByItsSentence) {
  const Description description(with_hostile_nodes(description_of(CameraModel::ax5), GetParam()));

  std::string all;
  for (const auto& fault : description.faults()) all += fault.node + ": " + fault.sentence + "\n";
  if (description.faults().empty()) {
    for (const auto& fault : description.faults_of("Width")) all += fault.node + ": " + fault.sentence + "\n";
    if (!description.lengths_of("Width").empty()) all += "only the camera knows";
  }

  EXPECT_THAT(all, HasSubstr(GetParam().says));
}

INSTANTIATE_TEST_SUITE_P(Descriptions, Hostile, ::testing::ValuesIn(hostile_descriptions()),
                         [](const auto& row) { return row.param.name; });

TEST(Description, TellsTheWayOfACycle) {
  const Description description(
      described("<Integer Name=\"A\"><pValue>B</pValue></Integer>"
                "<Integer Name=\"B\"><pValue>C</pValue></Integer>"
                "<Integer Name=\"C\"><pValue>A</pValue></Integer>"));

  ASSERT_EQ(description.faults().size(), 1U);
  EXPECT_EQ(description.faults().front().kind, DescriptionFaultKind::cycle);
  EXPECT_EQ(description.faults().front().node, "A");
  EXPECT_EQ(description.faults().front().sentence, "its value has a circular reference through B, C");
}

TEST(Description, MayHaveCyclesThatNobodyEvaluates) {
  const Description description(described(
      "<Integer Name=\"A\"><pSelected>B</pSelected><pMax>MaxA</pMax><Value>1</Value></Integer>"
      "<Integer Name=\"B\"><pSelected>A</pSelected><pMax>MaxB</pMax><Value>1</Value></Integer>"
      // The offset is limited by the width, and the width by the offset.
      "<IntSwissKnife Name=\"MaxA\"><pVariable Name=\"V\">B</pVariable><Formula>9 - V</Formula></IntSwissKnife>"
      "<IntSwissKnife Name=\"MaxB\"><pVariable Name=\"V\">A</pVariable><Formula>9 - V</Formula></IntSwissKnife>"
      "<IntReg Name=\"R\"><Address>0</Address><pInvalidator>R</pInvalidator></IntReg>"
      "<Category Name=\"Root\"><pFeature>Root</pFeature></Category>"));

  EXPECT_THAT(description.faults(), IsEmpty());
}

TEST(Description, WithADocumentTypeIsRefused) {
  const Description description("<!DOCTYPE RegisterDescription [<!ENTITY e \"x\">]>" + described("&e;"));

  ASSERT_EQ(description.faults().size(), 1U);
  EXPECT_EQ(description.faults().front().kind, DescriptionFaultKind::entities);
}

TEST(Description, ThatIsNoneIsRefused) {
  for (const auto* text :
       {"", "x", "<html/>", "<RegisterDescription>", "<RegisterDescription/><RegisterDescription/>"}) {
    const Description description(text);

    ASSERT_EQ(description.faults().size(), 1U) << text;
    EXPECT_EQ(description.faults().front().kind, DescriptionFaultKind::not_xml) << text;
  }
}

TEST(Description, NamesInSentencesArePrintable) {
  const Description description(
      described("<Integer Name=\"A&#9;&#xE9;[31m\"><pValue>A&#9;&#xE9;[31m</pValue></Integer>"
                "<Integer Name=\"B\"><pValue>B</pValue></Integer>"));

  ASSERT_FALSE(description.faults().empty());
  for (const char c : description.faults().front().node) EXPECT_TRUE(c > ' ' && c < 0x7F);
}

TEST(Description, LengthsThatOnlyTheCameraKnowsComeInTheOrderOfTheirNeed) {
  const Description description(
      described("<Port Name=\"P\"/>"
                "<IntReg Name=\"Known\"><Address>0</Address><pLength>Four</pLength><pPort>P</pPort></IntReg>"
                "<Integer Name=\"Four\"><Value>4</Value></Integer>"
                "<IntReg Name=\"Outer\"><Address>0</Address><pLength>Middle</pLength><pPort>P</pPort></IntReg>"
                "<IntReg Name=\"Middle\"><Address>4</Address><pLength>Inner</pLength><pPort>P</pPort></IntReg>"
                "<IntReg Name=\"Inner\"><Address>8</Address><Length>4</Length><pPort>P</pPort></IntReg>"));

  EXPECT_THAT(description.faults(), IsEmpty());
  EXPECT_THAT(description.lengths_of("Known"), IsEmpty());
  EXPECT_THAT(description.lengths_of("Outer"), ::testing::ElementsAre("Inner", "Middle"));
}

TEST(Description, DivisionsThatCannotTrapAreAccepted) {
  const Description description(described(
      "<Port Name=\"P\"/>"
      "<IntReg Name=\"R\"><Address>0</Address><Length>4</Length><pPort>P</pPort><Sign>Signed</Sign></IntReg>"
      "<IntSwissKnife Name=\"A\"><pVariable Name=\"R\">R</pVariable><Formula>(R * 8) / R</Formula></IntSwissKnife>"
      "<SwissKnife Name=\"B\"><pVariable Name=\"R\">R</pVariable><Formula>1.5 / R % 2</Formula></SwissKnife>"));

  EXPECT_THAT(description.faults_of("A"), IsEmpty());
  EXPECT_THAT(description.faults_of("B"), IsEmpty());
}

IntegerRange whole(const std::string& formula, IntegerRange x = {}) {
  return range_of_formula(formula, FormulaMode::whole, [x](const std::string&) { return x; }).value;
}

TEST(FormulaRange, HoldsWhatTheFormulaCanBe) {
  EXPECT_EQ(whole("2 + 3 * 4"), (IntegerRange{14, 14}));
  EXPECT_EQ(whole("(2 + 3) * 4"), (IntegerRange{20, 20}));
  EXPECT_EQ(whole("0x10 - 010"), (IntegerRange{8, 8}));
  EXPECT_EQ(whole("-X", {-3, 5}), (IntegerRange{-5, 3}));
  EXPECT_EQ(whole("X & 0xFF"), (IntegerRange{0, 255}));
  EXPECT_EQ(whole("X > 3 ? 7 : 9"), (IntegerRange{7, 9}));
  EXPECT_EQ(whole("1 << X", {0, 4}), (IntegerRange{1, 16}));
  EXPECT_EQ(whole("X * X", {0, std::int64_t{1} << 40}), IntegerRange{});
  EXPECT_EQ(whole("X X"), IntegerRange{});
}

TEST(FormulaRange, TellsWhichDivisionsMayTrap) {
  const auto traps = [](const std::string& formula, IntegerRange x, FormulaMode mode = FormulaMode::whole) {
    return range_of_formula(formula, mode, [x](const std::string&) { return x; }).may_trap;
  };
  EXPECT_TRUE(traps("X / X", {}));
  EXPECT_TRUE(traps("X % (0 - 1)", {}, FormulaMode::real));
  EXPECT_TRUE(traps("1 1 /", {}));
  EXPECT_TRUE(traps("0 ? X / X : 1", {}));
  // For the evaluator the first is 2^63, which is the smallest number again.
  EXPECT_TRUE(traps("9223372036854775807 / X", {}));
  EXPECT_TRUE(traps("(1 << 63) / (0 - 1)", {}));
  EXPECT_FALSE(traps("X / X", {}, FormulaMode::real));
  EXPECT_FALSE(traps("X / 8", {}));
  EXPECT_FALSE(traps("100 / X", {}));
  EXPECT_FALSE(traps("X / X", {0, 1 << 20}));
}

TEST(ZippedDescription, IsUnpacked) {
  const std::string text = description_of(CameraModel::ax5);
  const auto archive = bytes_of(zip_archive(text));

  const auto unpacked = unzip_description(archive, most_description_bytes);

  ASSERT_TRUE(unpacked) << unpacked.error().message;
  EXPECT_EQ(*unpacked, text);
}

TEST(ZippedDescription, ThatIsLargerThanItStatesOrThanIsAcceptedIsRefused) {
  const std::string zeros(std::size_t{8} << 20U, ' ');

  EXPECT_FALSE(unzip_description(bytes_of(zip_archive(zeros)), 1U << 20U));
  EXPECT_FALSE(unzip_description(bytes_of(zip_archive(zeros, 0xFFFFFFF0)), most_description_bytes));
  EXPECT_FALSE(unzip_description(bytes_of(zip_archive(zeros, 1U << 20U)), most_description_bytes));
  EXPECT_FALSE(unzip_description(bytes_of(zip_archive(zeros, 9U << 20U)), most_description_bytes));
}

TEST(ZippedDescription, DamagedInAnyByteOrCutAnywhereIsRefusedOrHasItsStatedSize) {
  const std::string archive = zip_archive("<RegisterDescription/>" + std::string(400, ' '));

  for (std::size_t at = 0; at < archive.size(); ++at) {
    EXPECT_FALSE(unzip_description(bytes_of(archive.substr(0, at)), 4096)) << at;
    for (const int value : {0, 1, 0x7F, 0xFF}) {
      std::string damaged = archive;
      damaged[at] = static_cast<char>(value);
      const auto unpacked = unzip_description(bytes_of(damaged), 4096);
      if (unpacked) {
        EXPECT_LE(unpacked->size(), 4096U);
      }
    }
  }
}

TEST(DescriptionUrl, OfAReasonableSizeIsAccepted) {
  const auto plain = parse_description_url("Local:camera.xml;5C000;8A3");
  const auto zipped = parse_description_url("local:camera.zip;0xFFE00000;0x1FFFF?SchemaVersion=1.1.0");

  ASSERT_TRUE(plain && zipped);
  EXPECT_EQ(plain->address, 0x5C000U);
  EXPECT_EQ(plain->bytes, 0x8A3U);
  EXPECT_FALSE(plain->zipped);
  EXPECT_EQ(zipped->address, 0xFFE00000U);
  EXPECT_TRUE(zipped->zipped);
}

TEST(DescriptionUrl, ThatWouldReserveMemoryWithoutBoundIsRefused) {
  EXPECT_THAT(parse_description_url("Local:camera.xml;1000;FFFFFFFF").error().message,
              HasSubstr("its size is not 1 ... "));
  for (const auto* url : {"Local:camera.xml;1000;FFFFFFFFFFFFFFFFFF", "Local:camera.xml;1000;0", "Local:camera.xml",
                          "http://example.org/camera.xml", "", "camera.xml", "Local:a;1;2;3", "Local:a;FFFFFFFF;10"}) {
    EXPECT_FALSE(parse_description_url(url)) << url;
  }
}

TEST(DescriptionUrl, OfAFileHasItsPath) {
  EXPECT_EQ(parse_description_url("File:///usr/share/camera.xml?SchemaVersion=1.0.0")->path, "/usr/share/camera.xml");
  EXPECT_EQ(parse_description_url("file:/tmp/a.xml")->path, "/tmp/a.xml");
  EXPECT_FALSE(parse_description_url("file:"));
}

TEST(DescriptionFile, ThatIsNoPlainFileIsRefused) {
  const testing::TemporaryFolder folder;
  folder.write("camera.xml", "<x/>");
  const auto in_folder = [&](const char* name) { return (folder.path() / name).string(); };

  EXPECT_EQ(read_description_file(in_folder("camera.xml")).value_or(""), "<x/>");
  for (const std::string path : {"/dev/zero", "/proc/kmsg", "/proc/self/maps", "/", "/nowhere"}) {
    EXPECT_FALSE(read_description_file(path)) << path;
  }
}

}  // namespace
}  // namespace todbench
