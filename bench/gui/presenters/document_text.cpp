// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/document_text.h"

#include <QByteArray>
#include <QImage>
#include <QTextCursor>
#include <QTextTable>
#include <QUrl>
#include <algorithm>
#include <numeric>
#include <vector>

#include "acquisition/base/safe_text.h"
#include "bench/gui/presenters/column_widths.h"

namespace todbench {
namespace {

// Sizes in CSS pixels.
constexpr int text_px = table_text_px, note_px = 9, subtitle_px = 10, heading_px = 19, section_px = 14, word_px = 18;
constexpr double after_paragraph = 6, before_section = 11, between_tables_px = 4;
/// Most height of pictures that stand beside others, and of other figures.
constexpr double picture_height_px = 150, figure_height_px = 270;
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

/// Caption under one of several figures.
QTextBlockFormat beside_others() {
  constexpr double gap_px = 8;
  QTextBlockFormat format = spaced(3, after_paragraph);
  format.setRightMargin(gap_px);
  return format;
}

enum class CellKind { header, value };

QTextTableCellFormat cell_format(const QTextCharFormat& base, CellKind kind) {
  const bool header = kind == CellKind::header;
  QTextTableCellFormat format;
  format.merge(header ? bold(base) : base);
  format.setPadding(cell_padding);
  format.setTopPadding(1);
  format.setBottomPadding(1);
  format.setBorder(1);
  format.setBorderStyle(QTextFrameFormat::BorderStyle_Solid);
  format.setBorderBrush(rule);
  if (header) format.setBackground(header_ground);
  return format;
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
    insert(cursor_, paragraph.text,
           paragraph.role == Paragraph::Role::note ? letters(note_px, soft) : letters(text_px));
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
    constexpr std::size_t long_list = 12;
    if (const std::size_t half = (table.values.size() + 1) / 2;
        table.values.size() > long_list && short_values(table)) {
      const auto middle = table.values.begin() + static_cast<std::ptrdiff_t>(half);
      beside(ValueTable{"", {table.values.begin(), middle}}, ValueTable{"", {middle, table.values.end()}});
      return;
    }
    QTextTable* cells = begin_table(static_cast<int>(table.values.size()), 2, ruled({38, 62}));
    for (std::size_t r = 0; r < table.values.size(); ++r) {
      fill(cells->cellAt(static_cast<int>(r), 0), plain(table.values[r].name), CellKind::header);
      fill(cells->cellAt(static_cast<int>(r), 1), table.values[r].value, CellKind::value);
    }
    end_table();
  }

  void operator()(const Figure& figure) {
    begin_block(spaced(0, 2));
    draw(figure, figure_height_px);
    line(qt(figure.caption), letters(note_px, soft), spaced(0, after_paragraph));
  }

  void operator()(const FigurePairs& pairs) {
    // One table per row, so that a row can move to the next page as a whole.
    std::size_t columns = 0;
    for (std::size_t i = 0; i < pairs.figures.size(); i += columns) {
      columns = figures_in_a_row(pairs, i);
      QTextTable* cells = begin_table(1, static_cast<int>(columns),
                                      borderless(std::vector<double>(columns, 100.0 / static_cast<double>(columns))));
      for (std::size_t k = i; k < std::min(i + columns, pairs.figures.size()); ++k) {
        cursor_ = cells->cellAt(0, static_cast<int>(k - i)).firstCursorPosition();
        draw(pairs.figures[k], paired_height_px(pairs.figures[k], columns));
        cursor_.insertBlock(beside_others());
        cursor_.insertText(qt(pairs.figures[k].caption), letters(note_px, soft));
      }
      end_table();
    }
  }

  void operator()(const TablePairs& pairs) {
    for (std::size_t i = 0; i < pairs.tables.size(); ++i) {
      const bool pair = i + 1 < pairs.tables.size() &&
                        std::visit([&](const auto& left, const auto& right) { return beside(left, right); },
                                   pairs.tables[i], pairs.tables[i + 1]);
      if (pair) {
        ++i;
      } else {
        std::visit(*this, pairs.tables[i]);
      }
    }
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
  /// Most height of one of `columns` figures side by side: the letters of a plot stay readable, a picture has none.
  static double paired_height_px(const Figure& figure, std::size_t columns) {
    constexpr double readable_in_pairs = 0.5, readable_in_threes = 0.45;
    if (!figure.drawing || figure.drawing->labels.empty()) return picture_height_px;
    return (columns == 2 ? readable_in_pairs : readable_in_threes) * figure.drawing->height;
  }

  /// Number of figures in the row that begins with `first`: four narrow ones, all of three, or two, so that those of
  /// camera and twin stay side by side.
  static std::size_t figures_in_a_row(const FigurePairs& pairs, std::size_t first) {
    constexpr double between = 1.03;
    const auto fit = [&](std::size_t columns) {
      const auto begin = pairs.figures.begin() + static_cast<std::ptrdiff_t>(first);
      return std::all_of(begin, begin + static_cast<std::ptrdiff_t>(columns), [&](const Figure& one) {
        return one.drawing &&
               DrawingTextObject::size_of(*one.drawing, paired_height_px(one, columns)).width() * between <=
                   text_width_px / static_cast<double>(columns);
      });
    };
    if (first + 4 <= pairs.figures.size() && fit(4)) return 4;
    return pairs.figures.size() == 3 && first == 0 && fit(3) ? 3 : 2;
  }

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

  /// Removes the lines above and below the cells of the empty column between two tables.
  static void clear_gap(QTextTable& cells, int column) {
    QTextTableCellFormat gap;
    gap.setBorder(0);
    gap.setPadding(0);
    for (int row = 0; row < cells.rows(); ++row) cells.cellAt(row, column).setFormat(gap);
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

  /// Whether every value fits into a quarter of the width.
  static bool short_values(const ValueTable& table) {
    Table values{"", {""}, {}};
    for (const NamedValue& one : table.values) values.rows.push_back({one.value});
    return narrowest_px(values).front() < text_width_px / 4;
  }

  /// Writes two tables of values as one with an empty column between them. Returns false if one is much longer.
  bool beside(const ValueTable& left, const ValueTable& right) {
    const std::size_t fewer = std::min(left.values.size(), right.values.size());
    const std::size_t more = std::max(left.values.size(), right.values.size());
    if (fewer == 0 || 2 * fewer < more) return false;
    const int captions = left.caption.empty() && right.caption.empty() ? 0 : 1;
    QTextTable* cells = begin_table(static_cast<int>(more) + captions, 5, ruled({21, 28, 2, 21, 28}));
    clear_gap(*cells, 2);
    int column = 0;
    for (const ValueTable* table : {&left, &right}) {
      if (captions > 0) {
        cells->mergeCells(0, column, 1, 2);
        fill(cells->cellAt(0, column), strong(table->caption), CellKind::header);
      }
      for (int r = 0; r < static_cast<int>(table->values.size()); ++r) {
        const NamedValue& one = table->values[static_cast<std::size_t>(r)];
        fill(cells->cellAt(r + captions, column), plain(one.name), CellKind::header);
        fill(cells->cellAt(r + captions, column + 1), one.value, CellKind::value);
      }
      column = 3;
    }
    end_table();
    return true;
  }

  /// Writes two tables as one with an empty column between them, if their columns fit. Returns whether it did.
  bool beside(const Table& left, const Table& right) {
    constexpr double gap_px = 12;
    std::vector<double> widths = narrowest_px(left);
    widths.push_back(gap_px);
    for (const double width : narrowest_px(right)) widths.push_back(width);
    const double sum_px = std::accumulate(widths.begin(), widths.end(), 0.0);
    if (sum_px > text_width_px) return false;
    for (double& width : widths) width *= 100 / sum_px;
    const int left_columns = static_cast<int>(left.header.size()), gap = left_columns;
    const int columns = gap + 1 + static_cast<int>(right.header.size());
    const int rows = static_cast<int>(std::max(left.rows.size(), right.rows.size())) + 2;
    QTextTableFormat format = ruled(widths);
    format.setHeaderRowCount(2);
    QTextTable* cells = begin_table(rows, columns, format);
    clear_gap(*cells, gap);
    for (const auto& [table, first] : {std::pair(&left, 0), std::pair(&right, gap + 1)}) {
      cells->mergeCells(0, first, 1, static_cast<int>(table->header.size()));
      fill(cells->cellAt(0, first), strong(table->caption), CellKind::header);
      for (int c = 0; c < static_cast<int>(table->header.size()); ++c) {
        fill(cells->cellAt(1, first + c), plain(table->header[static_cast<std::size_t>(c)]), CellKind::header);
        for (int r = 0; r < static_cast<int>(table->rows.size()); ++r)
          fill(cells->cellAt(r + 2, first + c), table->rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)],
               c == 0 ? CellKind::header : CellKind::value);
      }
    }
    end_table();
    return true;
  }
  template <typename Left, typename Right>
  bool beside(const Left& /*left*/, const Right& /*right*/) {
    return false;
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

  void draw(const Figure& figure, double most_height_px) {
    if (figure.drawing) {
      cursor_.insertText(QString(QChar::ObjectReplacementCharacter), drawings_.add(*figure.drawing, most_height_px));
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
