// A document as a value: what a page says, without how it looks. html.h writes it as a page, the window as PDF.
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/report/drawing.h"

namespace todbench {

/// How a stretch of text is meant. What is good, bad or open also carries a sign, so that it reads in black and white.
enum class Meaning {
  plain,
  strong,
  reason,    ///< in brackets: why there is no value
  unbroken,  ///< not broken over two lines where there is room: a number with its interval
  good,
  bad,
  open,
};
struct Phrase {
  std::string text;  ///< plain, from anywhere: who writes a file escapes it
  Meaning meaning = Meaning::plain;
};

/// Text of one paragraph or cell.
struct RichText {
  std::vector<Phrase> phrases;

  RichText& operator+=(const RichText& more);
  friend RichText operator+(RichText left, const RichText& right) { return left += right; }
};
[[nodiscard]] RichText plain(std::string_view text);
[[nodiscard]] RichText strong(std::string_view text);
[[nodiscard]] RichText unbroken(std::string_view text);
/// A dash with the reason why there is no value.
[[nodiscard]] RichText missing(std::string_view reason);
/// `text`, or missing(reason) when it is empty.
[[nodiscard]] RichText text_or_missing(std::string_view text, std::string_view reason);
enum class Mood { good, bad, open };
/// A word with its sign and colour.
[[nodiscard]] RichText badge(std::string_view word, Mood mood);

struct Paragraph {
  RichText text;
  enum class Role { text, note } role = Role::text;
};
[[nodiscard]] Paragraph note(const RichText& text);

struct List {
  std::vector<RichText> items;
};

/// The header names units. Rows are as long as the header; the first cell is the row's header.
struct Table {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<RichText>> rows;
};

struct NamedValue {
  std::string name;
  RichText value;
};
/// Two columns, name and value.
struct ValueTable {
  std::string caption;
  std::vector<NamedValue> values;
};

struct Figure {
  Result<Drawing> drawing;  ///< or why there is none
  std::string caption;
};

/// The same kind of things side by side, two in a row where there is room.
struct FigurePairs {
  std::vector<Figure> figures;
};
struct TablePairs {
  std::vector<std::variant<Table, ValueTable>> tables;
};

struct VerdictBox {
  std::string word;  ///< with its sign: "✓ PASS"
  Mood mood = Mood::open;
  std::vector<RichText> paragraphs;
};

/// Who signs, side by side, each with lines for name, date and signature.
struct Signatures {
  struct Signatory {
    std::string role, name;  ///< no name: a line to write on
  };
  std::vector<Signatory> signatories;
};

/// Whose report it is: a logo and lines beside it.
struct Imprint {
  std::string png;  ///< bytes of a PNG file; empty: no logo
  std::string png_text;
  double height_mm = 14;
  std::vector<std::string> lines;
};

using Block =
    std::variant<Paragraph, List, Table, ValueTable, Figure, FigurePairs, TablePairs, VerdictBox, Signatures, Imprint>;

struct Section {
  std::string title;
  std::vector<Block> blocks;
};

struct Document {
  std::string title;       ///< of the file
  std::string heading;     ///< over the first page
  std::string subtitle;    ///< below it
  std::string page_label;  ///< at the foot of every printed page: the report and the item
  std::vector<Block> opening;
  std::vector<Section> sections;
  std::vector<Block> before_heading{};
};

}  // namespace todbench
