// SPDX-License-Identifier: GPL-3.0-or-later
// A document with one block of every kind.
#pragma once

#include <string>
#include <vector>

#include "bench/report/document.h"

namespace todbench::testing {

[[nodiscard]] inline Drawing sample_drawing(const std::string& id, const std::string& label) {
  Drawing drawing;
  drawing.id = id;
  drawing.width = 400;
  drawing.height = 200;
  drawing.frame = {40, 10, 340, 150};
  drawing.inside = {{Segment{{0, 0}, {400, 200}}, Pen::curve, PlotTone::first}};
  drawing.labels = {{{60, 100}, label, LabelRole::legend}};
  return drawing;
}

[[nodiscard]] inline Document document_of_every_block() {
  const Table table{"TableCaption", {"HeaderOne", "HeaderTwo"}, {{plain("RowName"), unbroken("1.0 [0.9, 1.1]")}}};
  const ValueTable values{"ValuesCaption", {{"ValueName", missing("NoValue")}}};
  return {.title = "Title",
          .heading = "Heading",
          .subtitle = "Subtitle",
          .page_label = "PageLabel",
          .opening = {VerdictBox{"✓ PASS", Mood::good, {strong("RuleName:") + plain(" RuleText")}}},
          .sections = {{"SectionOne",
                        {Paragraph{plain("ParagraphText ") + badge("BadWord", Mood::bad)}, note(plain("NoteText")),
                         List{{plain("ItemOne"), plain("ItemTwo")}}, table, values}},
                       {"SectionTwo",
                        {Figure{sample_drawing("one", "InDrawingOne"), "FigureCaption"},
                         FigurePairs{{{sample_drawing("two", "InDrawingTwo"), "LeftCaption"},
                                      {sample_drawing("three", "InDrawingThree"), "RightCaption"}}},
                         TablePairs{{Table{"PairedTable", {"PairedHeader"}, {{plain("PairedCell")}}},
                                     ValueTable{"PairedValues", {{"PairedName", plain("PairedValue")}}}}},
                         Signatures{{{"RoleOne", "NameOne"}, {"RoleTwo", ""}}}}}}};
}

/// What a reader of document_of_every_block() sees.
[[nodiscard]] inline std::vector<std::string> texts_of_every_block() {
  return {"Heading",       "Subtitle",     "PASS",         "RuleName:",      "RuleText",      "SectionOne",
          "ParagraphText", "BadWord",      "NoteText",     "ItemOne",        "ItemTwo",       "TableCaption",
          "HeaderOne",     "HeaderTwo",    "RowName",      "1.0 [0.9, 1.1]", "ValuesCaption", "ValueName",
          "(NoValue)",     "SectionTwo",   "InDrawingOne", "FigureCaption",  "InDrawingTwo",  "InDrawingThree",
          "LeftCaption",   "RightCaption", "PairedTable",  "PairedHeader",   "PairedCell",    "PairedValues",
          "PairedName",    "PairedValue",  "RoleOne",      "NameOne",        "RoleTwo",       "Name:",
          "Date:",         "Signature:"};
}

}  // namespace todbench::testing
