// SPDX-License-Identifier: GPL-3.0-or-later
// Documents to pages, drawings to SVG.
#include "bench/report/document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/report/html.h"
#include "bench/report/svg.h"
#include "tests/bench/report/document_sample.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Document of_block(Block block) {
  return {
      .title = "t", .heading = "h", .subtitle = "s", .page_label = "p", .opening = {std::move(block)}, .sections = {}};
}

TEST(DocumentPage, ShowsEveryTextOfEveryKindOfBlock) {
  const Document document = testing::document_of_every_block();

  const std::string page = render_html(document);

  for (const std::string& text : testing::texts_of_every_block()) EXPECT_THAT(page, HasSubstr(text));
}

TEST(DocumentPage, EscapesTextWhereverItStands) {
  const std::string hostile = "</td><script>&";
  Document document = of_block(Paragraph{plain(hostile) + strong(hostile) + unbroken(hostile) + missing(hostile)});
  document.title = document.heading = document.subtitle = document.page_label = hostile;
  document.opening.emplace_back(Table{hostile, {hostile}, {{plain(hostile)}}});
  document.opening.emplace_back(ValueTable{hostile, {{hostile, badge(hostile, Mood::good)}}});
  document.opening.emplace_back(List{{plain(hostile)}});
  document.opening.emplace_back(VerdictBox{hostile, Mood::bad, {plain(hostile)}});
  document.opening.emplace_back(Signatures{{{hostile, hostile}}});
  document.sections.push_back({hostile, {}});

  const std::string page = render_html(document);

  EXPECT_THAT(page, Not(HasSubstr("<script>")));
  EXPECT_THAT(page, HasSubstr("&lt;/td&gt;&lt;script&gt;&amp;"));
}

TEST(DocumentPage, SaysWhyAFigureIsMissing) {
  const Figure figure{fail(ErrorCode::invalid_input, "the axis is empty"), "Caption"};

  const std::string page = render_html(of_block(figure));

  EXPECT_THAT(page, HasSubstr("(no figure: the axis is empty)"));
  EXPECT_THAT(page, HasSubstr("<figcaption>Caption</figcaption>"));
}

TEST(DocumentPage, KeepsShortTablesOnOnePage) {
  Table table{"", {"a"}, {}};
  table.rows.assign(14, {plain("1")});
  Table longer = table;
  longer.rows.push_back({plain("1")});

  EXPECT_THAT(render_html(of_block(table)), HasSubstr("<div class=\"wide short\">"));
  EXPECT_THAT(render_html(of_block(longer)), HasSubstr("<div class=\"wide\">"));
}

TEST(DrawingSvg, WritesEveryShapeWithItsPenAndTone) {
  Drawing drawing;
  drawing.id = "d";
  drawing.frame = {1, 2, 3, 4};
  drawing.inside = {{Polyline{{{{0, 0}, {1, 1}}, {{2, 2}, {3, 3}}}}, Pen::dashed, PlotTone::second}};
  drawing.marks = {{Segment{{1, 2}, {3, 4}}, Pen::axis}, {Disc{{5, 6}, 7}, Pen::marker, PlotTone::third}};
  drawing.labels = {{{8, 9}, "a < b", LabelRole::note}, {{1, 2}, "up", LabelRole::y_axis}};

  const std::string text = svg_element(drawing).text;

  EXPECT_THAT(text, HasSubstr(R"x(<rect class="frame" x="1.00" y="2.00" width="3.00" height="4.00"/>)x"));
  EXPECT_THAT(text,
              HasSubstr(R"x(<g clip-path="url(#d-clip)"><path class="dashed tone-b" d="M0.00 0.00L1.00 1.00M2.00 )x"
                        R"x(2.00L3.00 3.00"/>)x"));
  EXPECT_THAT(text, HasSubstr(R"x(<line class="axis" x1="1.00" y1="2.00" x2="3.00" y2="4.00"/>)x"));
  EXPECT_THAT(text, HasSubstr(R"x(<circle class="marker tone-c" cx="5.00" cy="6.00" r="7.00"/>)x"));
  EXPECT_THAT(text, HasSubstr(R"x(<text class="note" x="8.00" y="9.00">a &lt; b</text>)x"));
  EXPECT_THAT(text, HasSubstr(R"x(<text class="y-axis" transform="translate(1.00 2.00) rotate(-90)">up</text>)x"));
}

TEST(DrawingSvg, HasARuleForEveryPenAndLabel) {
  const std::string style = drawing_style();

  for (const Pen pen : all_pens) EXPECT_THAT(style, HasSubstr(".plot ." + std::string(style_of(pen).name) + "{"));
  for (const LabelRole role : all_label_roles)
    EXPECT_THAT(style, HasSubstr(".plot ." + std::string(style_of(role).name) + "{"));
}

}  // namespace
}  // namespace todbench
