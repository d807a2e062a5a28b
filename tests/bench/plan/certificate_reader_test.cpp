// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/certificate_reader.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <string>

#include "bench/plan/loaded_plan.h"
#include "bench/text/files.h"
#include "bench/text/text.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

/// A black body with two temperatures, the first in the elements of D-SI 2.1, the list in those of D-SI 2.2.
std::string black_body_dcc() {
  const auto text = read_text_file(source_file("tests/fuzz/corpus/certificate/black-body.xml"));
  EXPECT_TRUE(text);
  return text.value_or("");
}

std::string plan_text(const std::string& more) {
  return "[target]\ndistance_m = 2\nplates = [\"tcat-a\"]\nmountings = [\"identity\"]\ndelta_t_k = [2]\n" + more;
}

Result<LoadedPlan> plan_with(const TemporaryFolder& folder, const std::string& more, const std::string& dcc) {
  EXPECT_TRUE(write_file_atomically(folder.path() / "bb.xml", dcc));
  return read_plan(Resource{"plan.toml", plan_text(more)}, folder.path());
}

TEST(CertificateReader, ReadsNumberSerialAndTheQuantitiesWithAnUncertainty) {
  const auto read = parse_certificate(black_body_dcc());

  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->number, "C-2026-117");
  EXPECT_EQ(read->serial, "BB-17");
  ASSERT_EQ(read->values.size(), 4u) << "the room temperature has none, the resistance has one";
  EXPECT_EQ(read->values[0].name, "temperature difference");
  EXPECT_EQ(read->values[0].unit, "\\kelvin");
  EXPECT_EQ(read->values[0].value, 2.003);
  EXPECT_EQ(read->values[0].uncertainty, 0.012);
  EXPECT_EQ(read->values[2].value, 20.01);
  EXPECT_EQ(read->values[2].uncertainty, 18);
  EXPECT_EQ(read->values[2].coverage_factor, 2.2);
}

TEST(CertificateReader, PutsTheLargestUncertaintyOfATemperatureIntoTheBudget) {
  const TemporaryFolder folder;

  const auto loaded = plan_with(folder, "[[instrument]]\nname = \"black body\"\ndcc = \"bb.xml\"\n", black_body_dcc());

  ASSERT_TRUE(loaded) << loaded.error().message;
  const Plan& plan = loaded->plan();
  ASSERT_EQ(plan.uncertainty.rows.size(), 1u);
  const BudgetRow& row = plan.uncertainty.rows.front();
  EXPECT_EQ(input_of(row), BudgetInput::black_body_calibration);
  EXPECT_DOUBLE_EQ(row.value, 0.018) << "18 mK of the list; the 12 mK at 2 K and the ohm are smaller or no temperature";
  EXPECT_EQ(row.coverage_factor, 2.2);
  EXPECT_DOUBLE_EQ(standard_of(row), 0.018 / 2.2);
  EXPECT_EQ(row.unit, "K");
  EXPECT_EQ(row.certificate, "C-2026-117");
  EXPECT_THAT(row.source, HasSubstr(sha256_of(black_body_dcc())));
  EXPECT_EQ(plan.instruments.front().serial, "BB-17");
  EXPECT_EQ(plan.instruments.front().certificate, "C-2026-117");
  // The written plan has the numbers and does not read the file again.
  const auto again = parse_plan(Resource{"plan.toml", to_toml(plan)}, "/nowhere");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(*again, plan);
}

TEST(CertificateReader, TakesTheQuantityThatThePlanNames) {
  const TemporaryFolder folder;

  const auto loaded = plan_with(folder,
                                "[[instrument]]\nname = \"Schwarzer Strahler\"\nrole = \"black body\"\n"
                                "dcc = \"bb.xml\"\ndcc_quantity = \"temperature difference\"\n",
                                black_body_dcc());

  ASSERT_TRUE(loaded) << loaded.error().message;
  ASSERT_EQ(loaded->plan().uncertainty.rows.size(), 1u);
  EXPECT_DOUBLE_EQ(loaded->plan().uncertainty.rows[0].value, 0.012);
  EXPECT_THAT(loaded->plan().uncertainty.rows[0].source,
              ::testing::EndsWith("Differential black body, temperature difference"));
}

TEST(CertificateReader, OfAnotherInstrumentGivesItsIdentityOnly) {
  const TemporaryFolder folder;

  const auto loaded = plan_with(folder, "[[instrument]]\nname = \"thermometer\"\nrole = \"other\"\ndcc = \"bb.xml\"\n",
                                black_body_dcc());

  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_TRUE(loaded->plan().uncertainty.rows.empty());
  EXPECT_EQ(loaded->plan().instruments[0].serial, "BB-17");
}

TEST(CertificateReader, IgnoresTheConditionsOfTheMeasurement) {
  std::string text = black_body_dcc();
  const std::string room = "<si:value>23.1</si:value><si:unit>\\degreecelsius</si:unit>";
  const auto at = text.find(room);
  ASSERT_NE(at, std::string::npos);
  text.insert(at + room.size(),
              "<si:expandedUnc><si:uncertainty>0.5</si:uncertainty><si:coverageFactor>2"
              "</si:coverageFactor></si:expandedUnc>");

  const auto read = parse_certificate(text);

  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->values.size(), 4u);
}

TEST(CertificateReader, RejectsAFileThatContradictsThePlan) {
  const TemporaryFolder folder;
  const std::string instrument = "[[instrument]]\nname = \"black body\"\ndcc = \"bb.xml\"\n";
  const auto mistake = [&](const std::string& more, const std::string& dcc) {
    const auto loaded = plan_with(folder, more, dcc);
    return loaded ? std::string() : loaded.error().message;
  };

  EXPECT_THAT(mistake(instrument + "serial = \"BB-0001\"\n", black_body_dcc()),
              HasSubstr("plan.toml:8: key 'dcc' in [instrument]: the certificate is of serial number BB-17, but the "
                        "plan states BB-0001"));
  EXPECT_THAT(mistake(instrument + "certificate = \"C-1\"\n", black_body_dcc()), HasSubstr("plan states C-1"));
  EXPECT_THAT(mistake(instrument + "[[uncertainty.component]]\nname = \"black body calibration\"\nvalue = 0.01\n"
                                   "unit = \"K\"\n",
                      black_body_dcc()),
              HasSubstr("has a row for the calibration of the black body already"));
  EXPECT_THAT(mistake(instrument, "<a/>"), HasSubstr("not a digital calibration certificate"));
  EXPECT_THAT(mistake(instrument, "<!DOCTYPE a [<!ENTITY b \"b\">]><a>&b;</a>"),
              HasSubstr("document type declaration"));
  EXPECT_THAT(mistake("[[instrument]]\nname = \"b\"\ndcc = \"none.xml\"\n", ""), HasSubstr("none.xml"));
  EXPECT_THAT(mistake("[[instrument]]\nname = \"thermometer\"\ndcc = \"bb.xml\"\n", black_body_dcc()),
              HasSubstr("'thermometer' has no role"));
  EXPECT_THAT(mistake("[[instrument]]\nname = \"thermometer\"\nrole = \"other\"\ndcc = \"bb.xml\"\n"
                      "dcc_quantity = \"temperature difference\"\n",
                      black_body_dcc()),
              HasSubstr("dcc_quantity is for the role \"black body\" only"));
  EXPECT_THAT(mistake(instrument + "dcc_quantity = \"radiance\"\n", black_body_dcc()),
              HasSubstr("no temperature named 'radiance', but: temperature difference; temperature difference, list"));
  std::string camera = black_body_dcc();
  for (std::size_t at = camera.find("ohm"); at != std::string::npos; at = camera.find("ohm"))
    camera.replace(at, 3, "milli\\radian");
  EXPECT_THAT(mistake(instrument, camera),
              HasSubstr("states angles (sensor resistance): it is not that of a black body"))
      << "the certificate of a camera has temperatures, too: NETD, shading";
  std::string other = black_body_dcc();
  for (std::size_t at = other.find("kelvin"); at != std::string::npos; at = other.find("kelvin"))
    other.replace(at, 6, "metre");
  EXPECT_THAT(mistake(instrument, other), HasSubstr("no temperature of the certificate has an expanded uncertainty"));
}

TEST(CertificateReader, DoesNotReadAHugeFile) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file_atomically(folder.path() / "bb.xml", "<a>"));
  std::filesystem::resize_file(folder.path() / "bb.xml", std::uintmax_t{1} << 30);  // sparse
  const auto loaded =
      read_plan(Resource{"plan.toml", plan_text("[[instrument]]\nname = \"b\"\ndcc = \"bb.xml\"\n")}, folder.path());

  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().message, HasSubstr("larger than 8 MiB"));
}

TEST(OrderSection, HasTheKeysOfTheFileOfTheOrder) {
  const std::string order =
      "[order]\ncustomer = \"Ada\"\nreport_number = \"TB-1\"\nissued = \"2026-11-27\"\nroom_temperature_c = 23.5\n";

  const auto plan = parse_plan(Resource{"plan.toml", plan_text(order)}, "/");
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file_atomically(folder.path() / "order.toml", order));
  const auto file = load_order(folder.path() / "order.toml");

  ASSERT_TRUE(plan) << plan.error().message;
  ASSERT_TRUE(file);
  EXPECT_EQ(plan->order, *file);
  EXPECT_EQ(plan->order.customer, "Ada");
  EXPECT_EQ(*parse_plan(Resource{"again.toml", to_toml(*plan)}, "/"), *plan);
  const auto wrong = parse_plan(Resource{"plan.toml", plan_text("[order]\nissued = \"27.11.2026\"\n")}, "/");
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message, HasSubstr("plan.toml:7: key 'issued' in [order]: expected a date"));
}

}  // namespace
}  // namespace todbench
