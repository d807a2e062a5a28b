// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/text/manual_page.h"

#include <gmock/gmock.h>

namespace todbench {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(RoffText, IsPrintedAsItIs) {
  EXPECT_EQ(roff_text("a-b"), "a\\-b");
  EXPECT_EQ(roff_text("C:\\x"), "C:\\ex");
  EXPECT_EQ(roff_text("\"'`^~"), "\\(dq\\(aq\\(ga\\(ha\\(ti");
}

TEST(RoffText, IsNoRequestAtTheBeginningOfALine) {
  EXPECT_EQ(roff_text(".so /etc/passwd"), "\\&.so /etc/passwd");
  EXPECT_EQ(roff_text("a\n.so x\n'so x"), "a\n\\&.so x\n\\&\\(aqso x");
  EXPECT_EQ(roff_text("a.b"), "a.b");
}

TEST(Roff, HasEveryPartOfThePage) {
  const ManualPage page{.name = "todbench-fit",
                        .sentence = "fits",
                        .date = "2026-11-22",
                        .version = "todbench 0.1.0",
                        .synopsis = {"todbench fit [OPTIONS] FILE"},
                        .sections = {{.title = "Options", .text = "", .terms = {{"--lapse TEXT", "0 to 0.1"}}}},
                        .see_also = {"todbench", "todbench-plan"}};

  EXPECT_EQ(roff(page),
            ".TH TODBENCH\\-FIT 1 2026-11-22 \"todbench 0.1.0\"\n"
            ".SH NAME\ntodbench\\-fit \\- fits\n"
            ".SH SYNOPSIS\n.B todbench\nfit [OPTIONS] FILE\n"
            ".SH OPTIONS\n.TP\n.B \\-\\-lapse TEXT\n0 to 0.1\n"
            ".SH SEE ALSO\n.BR todbench (1),\n.BR todbench\\-plan (1)\n");
}

TEST(Roff, LeavesNoEmptyLines) {
  const ManualPage page{.name = "x",
                        .sentence = "y",
                        .date = "2026-11-22",
                        .version = "z",
                        .synopsis = {"x"},
                        .sections = {{.title = "Arguments", .text = "", .terms = {{"FILE", ""}}}},
                        .see_also = {}};

  EXPECT_THAT(roff(page), Not(HasSubstr("\n\n")));
}

}  // namespace
}  // namespace todbench
