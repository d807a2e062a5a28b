// SPDX-License-Identifier: GPL-3.0-or-later
// Tables and sentences for terminals of any width.
#include "bench/text/terminal_lines.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace todbench::testing {
namespace {

using ::testing::ElementsAre;
using Lines = std::vector<std::string>;

const Lines header{"contrast set", "ratio", "reason"};
const std::vector<Lines> rows{{"16.9", "0.9977", "equivalent at every contrast, two tests"}, {"0.23", "–", "too few"}};

std::size_t widest(const Lines& lines) {
  std::size_t columns = 0;
  for (const std::string& line : lines) columns = std::max(columns, columns_of(line));
  return columns;
}

TEST(TerminalLines, CountsLettersNotBytes) {
  EXPECT_EQ(columns_of("dT ± 1 µK …"), 11u);
}

TEST(TerminalLines, BreaksAtBlanksAndKeepsTheIndent) {
  EXPECT_THAT(broken_line("  two   words", 20), ElementsAre("  two   words")) << "what fits stays as it is";
  EXPECT_THAT(broken_line("  one two three", 9), ElementsAre("  one two", "  three"));
  EXPECT_THAT(broken_line("  --one   what it is for", 22), ElementsAre("  --one   what it is", "          for"));
  EXPECT_THAT(broken_line("a 1234567890 b", 5), ElementsAre("a", "1234567890", "b")) << "a word stays whole";
  EXPECT_THAT(broken_line("", 5), ElementsAre(""));
  EXPECT_THAT(broken_line("aµ bµ", 2), ElementsAre("aµ", "bµ"));
}

TEST(TerminalLines, AlignsATableThatFits) {
  const Lines expected{"contrast set    ratio   reason",                                   //
                       "------------   ------   ---------------------------------------",  //
                       "16.9           0.9977   equivalent at every contrast, two tests",  //
                       "0.23                –   too few"};
  EXPECT_EQ(table_lines(header, rows), expected);
  EXPECT_EQ(table_lines(header, rows, 63), expected);
}

TEST(TerminalLines, BreaksHeadersThenTheLastColumnOfWords) {
  EXPECT_THAT(table_lines(header, rows, 62),
              ElementsAre("contrast",                                                     //
                          "set         ratio   reason",                                   //
                          "--------   ------   ---------------------------------------",  //
                          "16.9       0.9977   equivalent at every contrast, two tests",  //
                          "0.23            –   too few"));
  EXPECT_THAT(table_lines(header, rows, 46), ElementsAre("contrast",                                        //
                                                         "set         ratio   reason",                      //
                                                         "--------   ------   --------------------------",  //
                                                         "16.9       0.9977   equivalent at every",         //
                                                         "                    contrast, two tests",         //
                                                         "0.23            –   too few"));
}

TEST(TerminalLines, MakesAListOfEveryRowWhereColumnsDoNotFit) {
  EXPECT_THAT(table_lines(header, rows, 30), ElementsAre("contrast set: 16.9", "ratio: 0.9977",                 //
                                                         "reason: equivalent at every", "contrast, two tests",  //
                                                         "", "contrast set: 0.23", "ratio: –", "reason: too few"));
}

TEST(TerminalLines, LeavesNothingOutAndFitsAtEveryWidth) {
  for (std::size_t columns = 12; columns < 80; ++columns) {
    const Lines lines = table_lines(header, rows, columns);
    EXPECT_LE(widest(lines), columns);
    std::string all;
    for (const std::string& line : lines) all += line + " ";
    for (const char* word : {"16.9", "0.9977", "equivalent", "every", "contrast,", "tests", "0.23", "–", "few"})
      EXPECT_NE(all.find(word), std::string::npos) << columns << ": " << word;
  }
  EXPECT_THAT(table_lines({"a"}, {}, 40), ElementsAre("a", "-"));
}

}  // namespace
}  // namespace todbench::testing
