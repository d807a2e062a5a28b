// SPDX-License-Identifier: GPL-3.0-or-later
// The TOD curve as lines of text.
#include "bench/report/curve_lines.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace todbench {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::size_t letters(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

/// The letter before which so many letters stand, counted from the first bar of the frame.
std::size_t place_of(const std::string& line, const char* sign) {
  const auto begin = line.find('|'), at = line.find(sign);
  EXPECT_NE(at, std::string::npos) << line;
  return letters(line.substr(begin, at - begin)) - 1;
}

TodCurve curve_with(double delta_t_k, double acuity, double low, double high) {
  TodPoint point;
  point.set_delta_t_k = point.delta_t_k = delta_t_k;
  point.fit.threshold = 1 / acuity;
  point.fit.ci95 = {1 / high, 1 / low};
  TodCurve curve;
  curve.points = {point};
  return curve;
}

TEST(CurveLines, DrawsEverythingAtItsPlaceOnTheAxis) {
  const TodCurve measured = curve_with(2, 0.4, 0.2, 0.6), twin = curve_with(2, 0.45, 0.4, 0.5);

  const auto lines =
      curve_lines({.delta_t_k = {2, 0.5}, .measured = &measured, .twin = &twin, .limits = {{2, 0.15}}}, 100);

  ASSERT_EQ(lines.size(), 3u);
  // The axis ends at 0.6; 100 letters less the numbers leave 64, so that 0.6 is the last of them.
  EXPECT_THAT(lines[0], HasSubstr("0.6 1/mrad"));
  const auto expected = [](double acuity) { return static_cast<std::size_t>(std::lround(acuity / 0.6 * 63)); };
  EXPECT_EQ(place_of(lines[1], "●"), expected(0.4));
  EXPECT_EQ(place_of(lines[1], "○"), expected(0.45));
  EXPECT_EQ(place_of(lines[1], "├"), expected(0.2));
  EXPECT_EQ(place_of(lines[1], "┤"), expected(0.6));
  EXPECT_EQ(place_of(lines[1], "┆"), expected(0.15));
  EXPECT_THAT(lines[1], HasSubstr("0.400 [0.200, 0.600]"));
  EXPECT_THAT(lines[2], Not(HasSubstr("●"))) << "nothing is known of that contrast";
}

TEST(CurveLines, IsNeverWiderThanTheTerminal) {
  const TodCurve measured = curve_with(2, 0.4, 0.001, 1e6);

  for (const std::size_t columns : {40, 57, 80, 200}) {
    for (const std::string& line : curve_lines({.delta_t_k = {2, -0.125}, .measured = &measured}, columns))
      EXPECT_LE(letters(line), columns) << line;
  }
  EXPECT_EQ(curve_lines({.delta_t_k = {2}}, 3).size(), 2u);
}

TEST(CurveLines, SaysTheSameInOneLine) {
  const TodCurve measured = curve_with(2, 0.4, 0.2, 0.6);

  const std::string line = curve_in_one_line({.delta_t_k = {2, 0.5}, .measured = &measured});

  EXPECT_THAT(line, HasSubstr("2 K 0.400 [0.200, 0.600], 0.5 K –"));
  EXPECT_THAT(line, Not(HasSubstr("\n")));
}

}  // namespace
}  // namespace todbench
