// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/document_text.h"

#include <QByteArray>
#include <QFontMetricsF>
#include <QImage>
#include <QRegularExpression>
#include <QTextCursor>
#include <QTextTable>
#include <QUrl>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "acquisition/base/safe_text.h"

namespace todbench {
namespace {

// Sizes in CSS pixels.
constexpr int text_px = 10, subtitle_px = 10, heading_px = 19, section_px = 14, word_px = 18;
constexpr double after_paragraph = 6, before_section = 14, cell_padding = 3, between_tables_px = 4;
constexpr double room_to_sign_px = 40;
const QColor ink(32, 32, 32), soft(80, 80, 80), rule(208, 208, 208), header_ground(240, 240, 240);

QString qt(const std::string& text) {
  return QString::fromStdString(valid_text(text));
}

QColor colour_of(Mood mood) {
  return mood == Mood::good ? QColor(0, 102, 74) : mood == Mood::bad ? QColor(164, 38, 44) : QColor(122, 75, 0);
}

QTextCharFormat letters(int px, const QColor& colour = ink) {
  QTextCharFormat format;
  format.setProperty(QTextFormat::FontPixelSize, px);
  format.setForeground(colour);
  return format;
}

QTextCharFormat bold(QTextCharFormat format) {
  format.setFontWeight(QFont::Bold);
  return format;
}

QTextCharFormat format_of(Meaning meaning, const QTextCharFormat& base) {
  QTextCharFormat format = base;
  switch (meaning) {
    case Meaning::plain:
    case Meaning::unbroken:
      return format;
    case Meaning::strong:
      return bold(format);
    case Meaning::reason:
      format.setForeground(soft);
      return format;
    case Meaning::good:
      format.setForeground(colour_of(Mood::good));
      return bold(format);
    case Meaning::bad:
      format.setForeground(colour_of(Mood::bad));
      return bold(format);
    case Meaning::open:
      format.setForeground(colour_of(Mood::open));
      return bold(format);
  }
  return format;
}

void insert(QTextCursor& cursor, const RichText& text, const QTextCharFormat& base) {
  for (const Phrase& phrase : text.phrases) cursor.insertText(qt(phrase.text), format_of(phrase.meaning, base));
}

QTextBlockFormat spaced(double above, double below) {
  QTextBlockFormat format;
  format.setTopMargin(above);
  format.setBottomMargin(below);
  return format;
}

enum class CellKind { header, value };

QTextTableCellFormat cell_format(const QTextCharFormat& base, CellKind kind) {
  const bool header = kind == CellKind::header;
  QTextTableCellFormat format;
  format.merge(header ? bold(base) : base);
  format.setPadding(cell_padding);
  format.setBorder(1);
  format.setBorderStyle(QTextFrameFormat::BorderStyle_Solid);
  format.setBorderBrush(rule);
  if (header) format.setBackground(header_ground);
  return format;
}

/// Widths of a column: all of its texts on one line, and its longest word.
struct Need {
  double line_px = 0, word_px = 0;
};

Need need_of(const Table& table, std::size_t column, const QFontMetricsF& metrics) {
  static const QRegularExpression blanks("[ \\n\\t]+");
  constexpr double longest_px = 400, slack_px = 2, padding_px = 2 * (cell_padding + 1) + slack_px;
  Need need;
  const auto count = [&](const QString& text) {
    need.line_px = std::max(need.line_px, metrics.horizontalAdvance(text));
    for (const QString& word : text.split(blanks))
      need.word_px = std::max(need.word_px, metrics.horizontalAdvance(word));
  };
  count(qt(table.header[column]));
  for (const auto& row : table.rows) {
    QString text;
    if (column < row.size())
      for (const Phrase& phrase : row[column].phrases) text += qt(phrase.text);
    count(text);
  }
  return {std::min(std::ceil(need.line_px) + padding_px, longest_px),
          std::min(std::ceil(need.word_px) + padding_px, longest_px)};
}

/// Returns column widths in percent. Columns that fit into an even share get their own width, the narrowest first. The
/// others share the rest by the square roots of their lengths; none is narrower than its longest word if there is room.
/// Without this Qt breaks words of narrow columns. Empty if the whole table fits.
std::vector<double> widths_of(const Table& table) {
  constexpr double text_width_px = 673;
  QFont font("DejaVu Sans");
  font.setPixelSize(text_px);
  font.setBold(true);
  const QFontMetricsF metrics(font);
  std::vector<Need> needs;
  for (std::size_t column = 0; column < table.header.size(); ++column) needs.push_back(need_of(table, column, metrics));
  std::vector<std::size_t> order(needs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t x, std::size_t y) { return needs[x].line_px < needs[y].line_px; });
  std::vector<double> widths(needs.size(), 0);
  double left_px = text_width_px;
  while (!order.empty() && needs[order.front()].line_px <= left_px / static_cast<double>(order.size())) {
    left_px -= widths[order.front()] = needs[order.front()].line_px;
    order.erase(order.begin());
  }
  if (order.empty()) return {};
  while (true) {
    double roots = 0;
    for (const std::size_t i : order) roots += std::sqrt(needs[i].line_px);
    for (const std::size_t i : order) widths[i] = left_px * std::sqrt(needs[i].line_px) / roots;
    const auto tight = std::find_if(order.begin(), order.end(), [&](std::size_t i) {
      return order.size() > 1 && widths[i] < needs[i].word_px && needs[i].word_px < left_px;
    });
    if (tight == order.end()) break;
    left_px -= widths[*tight] = needs[*tight].word_px;
    order.erase(tight);
  }
  for (double& width : widths) width *= 100 / text_width_px;
  return widths;
}

/// Appends block after block. Starts a block of text unless an empty one waits: Qt leaves an empty block after a table,
/// and the next paragraph uses it.
class TextWriter {
 public:
  TextWriter(QTextDocument& text, DrawingTextObject& drawings) : drawings_(drawings), cursor_(&text) {}

  void line(const QString& text, const QTextCharFormat& format, const QTextBlockFormat& block) {
    begin_block(block);
    cursor_.insertText(text, format);
  }

  void heading(const QString& text, int level, int px, double above) {
    QTextBlockFormat block = spaced(above, after_paragraph);
    block.setHeadingLevel(level);
    line(text, bold(letters(px)), block);
  }

  void operator()(const Paragraph& paragraph) {
    begin_block(spaced(0, after_paragraph));
    insert(cursor_, paragraph.text, letters(text_px, paragraph.role == Paragraph::Role::note ? soft : ink));
  }

  void operator()(const List& list) {
    for (const RichText& item : list.items) {
      QTextBlockFormat block = spaced(0, 2);
      block.setLeftMargin(14);
      block.setTextIndent(-10);
      begin_block(block);
      cursor_.insertText("• ", letters(text_px));
      insert(cursor_, item, letters(text_px));
    }
  }

  void operator()(const Table& table) {
    caption(table.caption);
    QTextTableFormat format = ruled(widths_of(table));
    // Repeats the header on every page of the table.
    format.setHeaderRowCount(1);
    QTextTable* cells =
        begin_table(static_cast<int>(table.rows.size()) + 1, static_cast<int>(table.header.size()), format);
    for (std::size_t i = 0; i < table.header.size(); ++i)
      fill(cells->cellAt(0, static_cast<int>(i)), plain(table.header[i]), CellKind::header);
    for (std::size_t r = 0; r < table.rows.size(); ++r)
      for (std::size_t i = 0; i < table.rows[r].size(); ++i)
        fill(cells->cellAt(static_cast<int>(r) + 1, static_cast<int>(i)), table.rows[r][i],
             i == 0 ? CellKind::header : CellKind::value);
    end_table();
  }

  void operator()(const ValueTable& table) {
    if (table.values.empty()) return;
    caption(table.caption);
    QTextTable* cells = begin_table(static_cast<int>(table.values.size()), 2, ruled({38, 62}));
    for (std::size_t r = 0; r < table.values.size(); ++r) {
      fill(cells->cellAt(static_cast<int>(r), 0), plain(table.values[r].name), CellKind::header);
      fill(cells->cellAt(static_cast<int>(r), 1), table.values[r].value, CellKind::value);
    }
    end_table();
  }

  void operator()(const Figure& figure) {
    begin_block(spaced(0, 2));
    draw(figure);
    line(qt(figure.caption), letters(text_px, soft), spaced(0, after_paragraph));
  }

  void operator()(const FigurePairs& pairs) {
    // One table per row, so that a row can move to the next page as a whole.
    for (std::size_t i = 0; i < pairs.figures.size(); i += 2) {
      QTextTable* cells = begin_table(1, 2, borderless({50, 50}));
      for (std::size_t k = i; k < std::min(i + 2, pairs.figures.size()); ++k) {
        cursor_ = cells->cellAt(0, static_cast<int>(k - i)).firstCursorPosition();
        draw(pairs.figures[k]);
        cursor_.insertBlock(spaced(0, after_paragraph));
        cursor_.insertText(qt(pairs.figures[k].caption), letters(text_px, soft));
      }
      end_table();
    }
  }

  void operator()(const TablePairs& pairs) {
    for (const auto& table : pairs.tables) std::visit(*this, table);
  }

  void operator()(const VerdictBox& box) {
    QTextTableFormat frame = borderless();
    frame.setBorder(2);
    frame.setBorderStyle(QTextFrameFormat::BorderStyle_Solid);
    frame.setBorderBrush(colour_of(box.mood));
    QTextTable* cells = begin_table(1, 1, frame);
    QTextTableCell cell = cells->cellAt(0, 0);
    QTextTableCellFormat inside;
    inside.setPadding(8);
    cell.setFormat(inside);
    cursor_ = cell.firstCursorPosition();
    cursor_.insertText(qt(box.word), bold(letters(word_px, colour_of(box.mood))));
    for (const RichText& paragraph : box.paragraphs) {
      cursor_.insertBlock(spaced(3, 0));
      insert(cursor_, paragraph, letters(text_px));
    }
    end_table();
  }

  void operator()(const Signatures& signatures) {
    const int columns = static_cast<int>(signatures.signatories.size());
    if (columns == 0) return;
    QTextTable* cells =
        begin_table(4, columns, ruled(std::vector<double>(signatures.signatories.size(), 100.0 / columns)));
    for (int i = 0; i < columns; ++i) {
      const auto& [role, name] = signatures.signatories[static_cast<std::size_t>(i)];
      fill(cells->cellAt(0, i), plain(role), CellKind::header);
      fill(cells->cellAt(1, i), plain(name.empty() ? "Name:" : "Name: " + name), CellKind::value);
      fill(cells->cellAt(2, i), plain("Date:"), CellKind::value);
      fill(cells->cellAt(3, i), plain("Signature:"), CellKind::value);
      QTextTableCell place = cells->cellAt(3, i);
      QTextTableCellFormat room = place.format().toTableCellFormat();
      room.setBottomPadding(room_to_sign_px);
      place.setFormat(room);
    }
    end_table();
  }

  void operator()(const Imprint& imprint) {
    const bool logo = !imprint.png.empty();
    QTextTable* cells =
        begin_table(1, logo ? 2 : 1, borderless(logo ? std::vector<double>{30, 70} : std::vector<double>{}));
    if (logo) {
      const QImage image =
          QImage::fromData(QByteArray(imprint.png.data(), static_cast<qsizetype>(imprint.png.size())), "PNG");
      constexpr double px_per_mm = 96 / 25.4;
      QTextImageFormat format;
      cells->document()->addResource(QTextDocument::ImageResource, QUrl("letterhead.png"), image);
      format.setName("letterhead.png");
      const double height = imprint.height_mm * px_per_mm;
      format.setHeight(height);
      if (!image.isNull()) format.setWidth(height * image.width() / image.height());
      QTextCursor cursor = cells->cellAt(0, 0).firstCursorPosition();
      cursor.insertImage(format);
    }
    QTextCursor cursor = cells->cellAt(0, logo ? 1 : 0).firstCursorPosition();
    for (std::size_t i = 0; i < imprint.lines.size(); ++i)
      cursor.insertText((i == 0 ? "" : "\n") + qt(imprint.lines[i]), letters(text_px));
    end_table();
  }

 private:
  /// Widths of the columns in percent; empty: by their contents.
  static QTextTableFormat borderless(const std::vector<double>& widths_percent = {}) {
    QTextTableFormat format;
    QList<QTextLength> widths;
    for (const double width : widths_percent) widths << QTextLength(QTextLength::PercentageLength, width);
    format.setColumnWidthConstraints(widths);
    format.setBorder(0);
    format.setCellSpacing(0);
    format.setCellPadding(0);
    format.setTopMargin(4);
    format.setBottomMargin(8);
    format.setWidth(QTextLength(QTextLength::PercentageLength, 100));
    return format;
  }

  static QTextTableFormat ruled(const std::vector<double>& widths_percent = {}) {
    QTextTableFormat format = borderless(widths_percent);
    format.setBorder(1);
    format.setBorderStyle(QTextFrameFormat::BorderStyle_Solid);
    format.setBorderBrush(rule);
    format.setBorderCollapse(true);
    return format;
  }

  void begin_block(const QTextBlockFormat& format) {
    if (waiting_) {
      cursor_.setBlockFormat(format);
    } else {
      cursor_.insertBlock(format);
    }
    waiting_ = false;
  }

  /// Starts a table directly after another, or first in the document; the block between them exists and stays empty.
  QTextTable* begin_table(int rows, int columns, const QTextTableFormat& format = ruled()) {
    if (waiting_) {
      QTextBlockFormat empty;
      empty.setLineHeight(between_tables_px, QTextBlockFormat::FixedHeight);
      cursor_.setBlockFormat(empty);
      cursor_.setBlockCharFormat(letters(1));
    }
    return cursor_.insertTable(rows, columns, format);
  }

  void end_table() {
    cursor_.movePosition(QTextCursor::End);
    cursor_.setBlockCharFormat({});
    waiting_ = true;
  }

  void caption(const std::string& text) {
    if (!text.empty()) line(qt(text), bold(letters(text_px)), spaced(4, 0));
  }

  static void fill(QTextTableCell cell, const RichText& text, CellKind kind) {
    const QTextCharFormat base = letters(text_px);
    cell.setFormat(cell_format(base, kind));
    QTextCursor cursor = cell.firstCursorPosition();
    insert(cursor, text, kind == CellKind::header ? bold(base) : base);
  }

  void draw(const Figure& figure) {
    if (figure.drawing) {
      cursor_.insertText(QString(QChar::ObjectReplacementCharacter), drawings_.add(*figure.drawing));
    } else {
      insert(cursor_, missing("no figure: " + figure.drawing.error().message), letters(text_px));
    }
  }

  DrawingTextObject& drawings_;
  QTextCursor cursor_;
  bool waiting_ = true;  ///< the block at the cursor is empty and still unused
};

}  // namespace

void write_text(QTextDocument& text, DrawingTextObject& drawings, const Document& document) {
  TextWriter writer(text, drawings);
  for (const Block& block : document.before_heading) std::visit(writer, block);
  writer.heading(qt(document.heading), 1, heading_px, 0);
  writer.line(qt(document.subtitle), letters(subtitle_px, soft), spaced(0, after_paragraph));
  for (const Block& block : document.opening) std::visit(writer, block);
  for (const Section& section : document.sections) {
    writer.heading(qt(section.title), 2, section_px, before_section);
    for (const Block& block : section.blocks) std::visit(writer, block);
  }
}

}  // namespace todbench
