// SPDX-License-Identifier: GPL-3.0-or-later
// Document as a value: content of a page without its appearance. html.h writes it as HTML, and the window as PDF.
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/report/drawing.h"

namespace todbench {

/// Role of a phrase. Good, bad and open phrases also carry a sign, so they are readable in black and white.
enum class Meaning {
  plain,
  strong,
  reason,    ///< reason for an absent value, shown in brackets
  unbroken,  ///< kept on one line if there is room: a number with its interval
  good,
  bad,
  open,
};
/// Text with its role.
struct Phrase {
  std::string text;  ///< plain text from any source; writers of files escape it
  Meaning meaning = Meaning::plain;
};

/// Text of one paragraph or cell.
struct RichText {
  std::vector<Phrase> phrases;

  RichText& operator+=(const RichText& more);
  friend RichText operator+(RichText left, const RichText& right) { return left += right; }
};
/// Return text with the role of the same name.
[[nodiscard]] RichText plain(std::string_view text);
[[nodiscard]] RichText strong(std::string_view text);
[[nodiscard]] RichText unbroken(std::string_view text);
/// Returns a dash with the reason for the absent value.
[[nodiscard]] RichText missing(std::string_view reason);
/// Returns `text`, or missing(reason) if it is empty.
[[nodiscard]] RichText text_or_missing(std::string_view text, std::string_view reason);
/// Meaning of a verdict word for the reader.
enum class Mood { good, bad, open };
/// Returns a word with its sign and colour.
[[nodiscard]] RichText badge(std::string_view word, Mood mood);

/// Paragraph of text, or a note.
struct Paragraph {
  RichText text;
  enum class Role { text, note } role = Role::text;
};
/// Returns a paragraph in the style of a note.
[[nodiscard]] Paragraph note(const RichText& text);

/// List of items.
struct List {
  std::vector<RichText> items;
};

/// Table whose header contains the units. Rows have the length of the header; the first cell is the row header.
struct Table {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<RichText>> rows;
};

/// Row of a value table.
struct NamedValue {
  std::string name;
  RichText value;
};
/// Table with two columns, name and value.
struct ValueTable {
  std::string caption;
  std::vector<NamedValue> values;
};

/// Figure with its caption.
struct Figure {
  Result<Drawing> drawing;  ///< drawing, or the reason for its absence
  std::string caption;
};

/// Figures side by side, two in a row if there is room.
struct FigurePairs {
  std::vector<Figure> figures;
};
/// Tables side by side, two in a row if there is room.
struct TablePairs {
  std::vector<std::variant<Table, ValueTable>> tables;
};

/// Box with a verdict.
struct VerdictBox {
  std::string word;  ///< word with its sign: "✓ PASS"
  Mood mood = Mood::open;
  std::vector<RichText> paragraphs;
};

/// Signature fields side by side, each with lines for name, date and signature.
struct Signatures {
  struct Signatory {
    std::string role, name;  ///< empty name: a line to write on
  };
  std::vector<Signatory> signatories;
};

/// Owner of the report: a logo with lines of text next to it.
struct Imprint {
  std::string png;  ///< bytes of a PNG file; empty: no logo
  std::string png_text;
  double height_mm = 14;
  std::vector<std::string> lines;
};

using Block =
    std::variant<Paragraph, List, Table, ValueTable, Figure, FigurePairs, TablePairs, VerdictBox, Signatures, Imprint>;

/// Section of a document.
struct Section {
  std::string title;
  std::vector<Block> blocks;
};

/// Content of a document.
struct Document {
  std::string title;       ///< title of the file
  std::string heading;     ///< heading of the first page
  std::string subtitle;    ///< below the heading
  std::string page_label;  ///< footer of every printed page: report and unit
  std::vector<Block> opening;
  std::vector<Section> sections;
  std::vector<Block> before_heading{};
};

}  // namespace todbench
