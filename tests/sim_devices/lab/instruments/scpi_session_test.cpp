// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/instruments/scpi_session.h"
#include "tod/instruments/scpi_client.h"

#include <gmock/gmock.h>

#include <random>

namespace todbench {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

// An instrument with one number between -10 and 10 V and one text.
class SessionTest : public ::testing::Test {
 protected:
  double volts_ = 0;
  std::string text_;
  ScpiLanguage language_{
      "maker,model,42,1.0",
      {{"[SOURce:]VOLTage:LEVel",
        [this](std::span<const std::string> p) -> ScpiAnswer {
          if (auto count = scpi_count(p, 1); !count) return tl::unexpected(count.error());
          const auto value = scpi_number(p[0], -10, 10, "V");
          if (!value) return tl::unexpected(value.error());
          volts_ = *value;
          return "";
        }},
       {"[SOURce:]VOLTage:LEVel?",
        [this](std::span<const std::string>) -> ScpiAnswer { return scpi_decimal(volts_, 2); }},
       {"[SOURce:]VOLTage:RANGe?", [](std::span<const std::string>) -> ScpiAnswer { return "-10,10"; }},
       {"DISPlay:TEXT",
        [this](std::span<const std::string> p) -> ScpiAnswer {
          if (auto count = scpi_count(p, 1); !count) return tl::unexpected(count.error());
          text_ = p[0];
          return "";
        }},
       {"DISPlay:TEXT?", [this](std::span<const std::string>) -> ScpiAnswer { return scpi_quoted(text_); }}}};
  ScpiSession session_{language_};
};

TEST_F(SessionTest, ShortAndLongFormsInAnyCaseAndWithoutOptionalNodesMeanTheSame) {
  for (const std::string header :
       {"SOUR:VOLT:LEV", "source:voltage:level", "VOLT:LEV", ":Voltage:Lev", "SOURce:VOLT:LEVEL"}) {
    volts_ = 0;

    EXPECT_EQ(session_.execute(header + " 2.5"), "");
    EXPECT_EQ(session_.execute(header + "?"), "2.50") << header;
  }
  EXPECT_EQ(session_.execute("SYST:ERR?"), "0,\"No error\"");
}

TEST_F(SessionTest, FormsBetweenShortAndLongAreUnknown) {
  EXPECT_EQ(session_.execute("VOLTA:LEV 1"), "");
  EXPECT_EQ(session_.execute("VOLT:LEV:MORE 1"), "");
  EXPECT_EQ(session_.execute("VOLT: 1"), "");

  EXPECT_EQ(volts_, 0);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(session_.execute("SYSTem:ERRor:NEXT?"), "-113,\"Undefined header\"");
  EXPECT_EQ(session_.execute("SYST:ERR?"), "0,\"No error\"");
}

TEST_F(SessionTest, HeadersAfterASemicolonContinueThePath) {
  EXPECT_EQ(session_.execute("SOUR:VOLT:LEV 3; LEV?; RANG?; *IDN?; :SYST:ERR?"),
            "3.00;-10,10;maker,model,42,1.0;0,\"No error\"");
}

TEST_F(SessionTest, NumbersTakeTheirUnitAndLimitsAndNothingElse) {
  const std::vector<std::pair<std::string, std::string>> refused{
      {"LEV 11", "-222"},  {"LEV 1e999", "-222"}, {"LEV nan", "-104"}, {"LEV inf", "-104"}, {"LEV abc", "-104"},
      {"LEV 1 K", "-131"}, {"LEV", "-109"},       {"LEV 1,2", "-108"}, {"LEV 1x", "-131"},  {"LEV --1", "-104"}};
  for (const auto& [command, code] : refused) {
    EXPECT_EQ(session_.execute("VOLT:" + command), "");
    EXPECT_THAT(session_.execute("SYST:ERR?"), StartsWith(code)) << command;
  }
  EXPECT_EQ(volts_, 0);

  EXPECT_EQ(session_.execute("VOLT:LEV +1.5E0 v;LEV?"), "1.50");
  EXPECT_EQ(session_.execute("VOLT:LEV MIN;LEV?"), "-10.00");
  EXPECT_EQ(session_.execute("VOLT:LEV MAXimum;LEV?"), "10.00");
}

TEST_F(SessionTest, StringsKeepSeparatorsAndQuotes) {
  EXPECT_EQ(session_.execute(R"(DISP:TEXT "a;b, ""c""";TEXT?)"), R"("a;b, ""c""")");
  EXPECT_EQ(text_, R"(a;b, "c")");
  EXPECT_EQ(session_.execute("DISP:TEXT 'single'"), "");
  EXPECT_EQ(text_, "single");
  EXPECT_EQ(session_.execute("DISP:TEXT \"open"), "");
  EXPECT_THAT(session_.execute("SYST:ERR?"), StartsWith("-151"));
}

TEST_F(SessionTest, ACommandErrorDiscardsTheRestOfTheMessageAndAnExecutionErrorDoesNot) {
  EXPECT_EQ(session_.execute("VOLT:LEV 1;:NONSENSE;:VOLT:LEV 2"), "");
  EXPECT_EQ(volts_, 1);

  EXPECT_EQ(session_.execute("*CLS;:VOLT:LEV 99;LEV 2;LEV?"), "2.00");
  EXPECT_THAT(session_.execute("SYST:ERR?"), StartsWith("-222"));
}

TEST_F(SessionTest, TheErrorQueueHoldsSixteenAndSaysThatItOverflowed) {
  for (int i = 0; i < 100; ++i) EXPECT_EQ(session_.execute("NONSENSE"), "");

  for (int i = 0; i < 15; ++i) EXPECT_THAT(session_.execute("SYST:ERR?"), StartsWith("-113"));
  EXPECT_THAT(session_.execute("SYST:ERR?"), HasSubstr("Queue overflow"));
  EXPECT_EQ(session_.execute("SYST:ERR?"), "0,\"No error\"");
}

TEST_F(SessionTest, EachSessionHasItsOwnErrors) {
  ScpiSession other(language_);

  EXPECT_EQ(session_.execute("NONSENSE"), "");

  EXPECT_EQ(other.execute("SYST:ERR?"), "0,\"No error\"");
  EXPECT_THAT(session_.execute("SYST:ERR?"), StartsWith("-113"));
}

TEST_F(SessionTest, RandomMessagesNeverBreakIt) {
  // Half pieces of real messages, half any byte: deep enough to reach parameters, wide enough to miss them.
  const std::vector<std::string> pieces{"VOLT", ":",  "LEV", "?", " ",          "1", ",",
                                        ";",    "\"", "'",   "*", "DISP:TEXT ", "[", "]"};
  std::mt19937 random(1);
  for (int i = 0; i < 20000; ++i) {
    std::string message;
    for (unsigned n = random() % 12; n > 0; --n)
      message += random() % 2 == 0 ? pieces[random() % pieces.size()] : std::string(1, static_cast<char>(random()));

    const std::string answer = session_.execute(message);

    ASSERT_LT(answer.size(), 1000U);
    ASSERT_EQ(answer.find('\n'), std::string::npos);
    ASSERT_LE(std::abs(volts_), 10);
  }
  EXPECT_EQ(session_.execute("*CLS;*IDN?"), "maker,model,42,1.0");
}

}  // namespace
}  // namespace todbench
