// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/answered_instruments.h"

#include <gmock/gmock.h>

namespace todbench {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::string_view lab =
    "black body (todbench Emulated (differential) black body, serial BB-0001); plate stage (todbench Emulated plate "
    "stage, serial PS-0001)";

TEST(AnsweredInstruments, AreReadFromTheDescriptionOfTheTarget) {
  EXPECT_THAT(answered_instruments(lab),
              ElementsAre(AnsweredInstrument{"black body", "BB-0001"}, AnsweredInstrument{"plate stage", "PS-0001"}));
  EXPECT_THAT(answered_instruments("black body (CI Systems SR-800); plate stage (fixed)"),
              ElementsAre(AnsweredInstrument{"black body", ""}, AnsweredInstrument{"plate stage", ""}));
  EXPECT_THAT(answered_instruments("operator"), IsEmpty());
}

TEST(AnsweredInstruments, ACertificateOfAnotherInstrumentIsNamed) {
  const std::vector<InstrumentPlan> other{{"Black body", "BB-17", "C-2026-117", ""}, {"ruler", "R-1", "", ""}};

  const auto sentences = contradicted_instruments(other, lab);

  ASSERT_EQ(sentences.size(), 1u);
  EXPECT_THAT(sentences[0], HasSubstr("the black body that answered has the serial number BB-0001"));
  EXPECT_THAT(sentences[0], HasSubstr("states BB-17, certificate C-2026-117"));
  EXPECT_THAT(contradicted_instruments(std::vector<InstrumentPlan>{{"black body", "BB-0001", "C-2", ""}}, lab),
              IsEmpty());
  EXPECT_THAT(contradicted_instruments(std::vector<InstrumentPlan>{{"black body", "", "C-2", ""}}, lab), IsEmpty())
      << "no serial number is stated";
  InstrumentPlan named{"Schwarzer Strahler", "BB-17", "C-2", ""};
  EXPECT_THAT(contradicted_instruments(std::vector{named}, lab), IsEmpty()) << "the name has no role";
  named.role = InstrumentRole::black_body;
  EXPECT_EQ(contradicted_instruments(std::vector{named}, lab).size(), 1u);
  named.name = "thermometer of the black body";
  named.role = InstrumentRole::other;
  EXPECT_THAT(contradicted_instruments(std::vector{named}, lab), IsEmpty());
  EXPECT_THAT(contradicted_instruments(other, "black body (CI Systems SR-800)"), IsEmpty())
      << "an instrument without a serial number";
}

}  // namespace
}  // namespace todbench
