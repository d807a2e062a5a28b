// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/pdf_report.h"

#include <QAbstractTextDocumentLayout>
#include <QBuffer>
#include <QPageLayout>
#include <QPainter>
#include <QPdfWriter>
#include <QTextBlock>
#include <QTextCursor>
#include <QTextDocument>
#include <QTextTable>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "bench/gui/presenters/document_text.h"
#include "bench/text/files.h"

namespace todbench {
namespace {

// Layout in CSS pixels of 1/96 inch.
constexpr double px_per_mm = 96 / 25.4;
constexpr double page_width = 210 * px_per_mm, page_height = 297 * px_per_mm;
constexpr double margin = 16 * px_per_mm, margin_above = 13 * px_per_mm, margin_below = 20 * px_per_mm;
constexpr double foot = 8 * px_per_mm;  ///< height of the label below the text, inside the margin
constexpr int writer_dpi = 1200;
/// Without this room, the lower edge of the last line or its cell would move to the next page.
constexpr double room_below_px = 10;

/// Page of the last line of a block. A line in the room below the text is drawn on the next page.
int page_of(const QTextDocument& document, const QTextBlock& block) {
  constexpr double rounding_px = 1;
  const QRectF place = document.documentLayout()->blockBoundingRect(block);
  return static_cast<int>((place.bottom() + room_below_px - rounding_px) / document.pageSize().height());
}

QTextTable* table_at(const QTextBlock& block) {
  return QTextCursor(block).currentTable();
}

/// Returns the next block with content: empty blocks precede tables and figures.
QTextBlock content_after(QTextBlock block) {
  do block = block.next();
  while (block.isValid() && block.text().trimmed().isEmpty());
  return block;
}

/// Returns the block with content before this one.
QTextBlock content_before(QTextBlock block) {
  do block = block.previous();
  while (block.isValid() && block.text().trimmed().isEmpty());
  return block;
}

/// Returns the lowest block of a row, over all cells.
QTextBlock lowest_of(const QTextDocument& document, const QTextTable& table, int row) {
  QTextBlock lowest = table.cellAt(row, 0).lastCursorPosition().block();
  for (int column = 1; column < table.columns(); ++column) {
    const QTextBlock last = table.cellAt(row, column).lastCursorPosition().block();
    const auto bottom = [&](const QTextBlock& block) {
      return document.documentLayout()->blockBoundingRect(block).bottom();
    };
    if (bottom(last) > bottom(lowest)) lowest = last;
  }
  return lowest;
}

/// Returns the block that has to be on the same page as a heading or caption: the first line below, the end of a short
/// table, or the first row of a longer one.
QTextBlock belongs_to(const QTextDocument& document, const QTextBlock& block) {
  constexpr int few_rows = 5;
  QTextBlock content = content_after(block);
  if (!content.isValid()) return content;
  const QTextBlock below = content_after(content);
  const bool caption = table_at(content) == nullptr && below.isValid() && table_at(below) != nullptr;
  if (caption) content = below;
  if (const QTextTable* table = table_at(content); table != nullptr)
    return lowest_of(document, *table, table->rows() <= few_rows ? table->rows() - 1 : 1);
  return content;
}

/// A move shifts all following blocks. Qt leaves blocks without lines if only the changed one is laid out again.
void lay_out_from(QTextDocument& document, int position) {
  document.markContentsDirty(position, document.characterCount() - position);
}

/// Starts a new page before a table.
void break_before(QTextDocument& document, QTextTable& table) {
  QTextTableFormat format = table.format();
  format.setPageBreakPolicy(QTextFormat::PageBreak_AlwaysBefore);
  table.setFormat(format);
  lay_out_from(document, table.firstPosition());
}

void set_format(QTextDocument& document, const QTextBlock& block, const QTextBlockFormat& format) {
  QTextCursor(block).setBlockFormat(format);
  lay_out_from(document, block.position());
}

/// Starts a new page before a block outside of tables.
void break_before(QTextDocument& document, const QTextBlock& block) {
  QTextBlockFormat format = block.blockFormat();
  format.setPageBreakPolicy(QTextFormat::PageBreak_AlwaysBefore);
  set_format(document, block, format);
}

/// Moves a table of one row (figures side by side, or the verdict) to the next page if it would be split.
void keep_row_together(QTextDocument& document, QTextTable& table) {
  const QTextBlock first = table.firstCursorPosition().block();
  if (table.rows() > 1 || page_of(document, first) == page_of(document, lowest_of(document, table, 0))) return;
  break_before(document, table);
}

/// Top and bottom of the text of a row, in the height of all pages.
struct RowExtent {
  double top = 0, bottom = 0;
};

RowExtent extent_of(const QTextDocument& document, const QTextTable& table, int row) {
  const auto place = [&](const QTextBlock& block) { return document.documentLayout()->blockBoundingRect(block); };
  RowExtent out{.top = place(table.cellAt(row, 0).firstCursorPosition().block()).top(),
                .bottom = place(lowest_of(document, table, row)).bottom()};
  for (int column = 1; column < table.columns(); ++column)
    out.top = std::min(out.top, place(table.cellAt(row, column).firstCursorPosition().block()).top());
  return out;
}

/// Adds room below the text of a row. Lays the document out once, not after every cell.
void extend_row(QTextDocument& document, QTextTable& table, int row, double by_px) {
  QTextCursor edit(&document);
  edit.beginEditBlock();
  for (int column = 0; column < table.columns(); ++column) {
    QTextTableCell cell = table.cellAt(row, column);
    QTextTableCellFormat format = cell.format().toTableCellFormat();
    format.setBottomPadding(format.bottomPadding() + by_px);
    cell.setFormat(format);
  }
  edit.endEditBlock();
  lay_out_from(document, table.firstPosition());
}

/// Moves a row that would be split to the next page by extending the row before it, because Qt has no page break before
/// a row. A row that is extended too far moves itself or is split; the extension that leaves the row highest on the
/// next page is taken. Rows higher than half a page stay, and so does the first below the header, which moves with its
/// caption.
void keep_rows_whole(QTextDocument& document, QTextTable& table) {
  constexpr double step_px = 2, most_px = 2 * room_below_px + 12;
  const double height = document.pageSize().height();
  for (int row = 2; row < table.rows(); ++row) {
    const auto [top, bottom] = extent_of(document, table, row);
    const double page_end = height * std::floor(bottom / height);
    if (top >= page_end || bottom - top > height / 2) continue;
    double best_px = page_end - top, highest = std::numeric_limits<double>::infinity(), extended_px = 0;
    for (double less_px = 0; less_px <= most_px; less_px += step_px) {
      const double by_px = page_end - top - less_px;
      extend_row(document, table, row - 1, by_px - std::exchange(extended_px, by_px));
      const double before = extent_of(document, table, row - 1).top, moved = extent_of(document, table, row).top;
      if (before >= page_end || moved < page_end || moved >= highest) continue;
      best_px = by_px;
      highest = moved;
    }
    extend_row(document, table, row - 1, best_px - extended_px);
  }
}

/// Returns the first of the headings directly above a block; they move to the next page with it.
QTextBlock with_headings(const QTextBlock& block) {
  const QTextBlock above = content_before(block);
  const bool heading = above.isValid() && table_at(above) == nullptr && above.blockFormat().headingLevel() > 0;
  return heading ? with_headings(above) : block;
}

/// Whether a line of the block is split between two pages: Qt places some like this after a table.
bool is_cut(const QTextDocument& document, const QTextBlock& block) {
  const double top = document.documentLayout()->blockBoundingRect(block).top(), height = document.pageSize().height();
  constexpr double rounding = 0.5;
  for (int i = 0; i < block.layout()->lineCount(); ++i) {
    const QTextLine line = block.layout()->lineAt(i);
    const double begin = top + line.y() + rounding, end = top + line.y() + line.height() - rounding;
    if (std::floor(begin / height) != std::floor(end / height)) return true;
  }
  return false;
}

/// Starts a new page before a table, or before the headings above it.
void move_to_next_page(QTextDocument& document, QTextTable& table) {
  const QTextBlock first = table.firstCursorPosition().block(), heading = with_headings(first);
  if (heading == first)
    break_before(document, table);
  else
    break_before(document, heading);
}

void move_to_next_page(QTextDocument& document, const QTextBlock& block) {
  const QTextBlock moved = with_headings(block);
  const double height = document.pageSize().height();
  const auto top = [&] { return document.documentLayout()->blockBoundingRect(moved).top() / height; };
  const double before = top();
  const QTextBlockFormat old = moved.blockFormat();
  break_before(document, moved);
  // A block in the last millimetres of a page has been moved by Qt already: a break would leave an empty page.
  constexpr double rounding = 0.001;
  if (std::floor(top() + rounding) <= std::floor(before) + 1) return;
  QTextBlockFormat format = old;
  format.setTopMargin(old.topMargin() + (std::floor(before) + 1 - before) * height);
  set_format(document, moved, format);
  if (std::floor(top() + rounding) > std::floor(before)) return;
  // The margin below a table covers the margin above the block: the table moves with its headings.
  const QTextBlock above = content_before(moved);
  if (QTextTable* table = above.isValid() ? table_at(above) : nullptr; table != nullptr)
    move_to_next_page(document, *table);
}

/// Moves a heading, caption or figure at the bottom of a page to the next one, together with its content.
void keep_together(QTextDocument& document) {
  for (QTextBlock block = document.begin(); block.isValid(); block = block.next()) {
    if (QTextTable* table = table_at(block); table != nullptr) {
      if (table->firstCursorPosition().block() != block) continue;
      keep_row_together(document, *table);
      keep_rows_whole(document, *table);
      continue;
    }
    if (block.text().trimmed().isEmpty()) continue;
    if (is_cut(document, block)) {
      move_to_next_page(document, block);
      continue;
    }
    const QTextBlock next = content_after(block);
    const bool stands_over_a_table = next.isValid() && table_at(next) != nullptr;
    const bool figure = block.text().contains(QChar::ObjectReplacementCharacter);
    if (block.blockFormat().headingLevel() == 0 && !stands_over_a_table && !figure) continue;
    const QTextBlock content = belongs_to(document, block);
    if (!content.isValid() || page_of(document, content) == page_of(document, block)) continue;
    move_to_next_page(document, block);
  }
}

/// Returns the text of the first block without a line in the layout: it would be missing on the page.
std::optional<QString> lost_text(const QTextDocument& document) {
  (void)document.documentLayout()->documentSize();  // finishes the layout
  for (QTextBlock block = document.begin(); block.isValid(); block = block.next())
    if (!block.text().isEmpty() && block.layout()->lineCount() == 0) return block.text();
  return std::nullopt;
}

void paint_pages(QPdfWriter& writer, QTextDocument& document, const QString& label) {
  QPainter painter(&writer);
  const double scale = writer_dpi / 96.0;
  const int pages = document.pageCount();
  const double body_height = document.pageSize().height();
  for (int page = 0; page < pages; ++page) {
    if (page > 0) writer.newPage();
    painter.save();
    painter.scale(scale, scale);
    painter.translate(margin, margin_above);
    QFont font("DejaVu Sans");
    font.setPixelSize(9);
    font.setStyleStrategy(QFont::PreferNoShaping);
    painter.setFont(font);
    painter.setPen(QColor(80, 80, 80));
    const QRectF foot_line(0, body_height + foot / 4, document.pageSize().width(), 2 * foot);
    const QString number = QString("page %1 of %2").arg(page + 1).arg(pages);
    const QRectF place = foot_line.adjusted(0, 0, -painter.fontMetrics().horizontalAdvance("page 999 of 999"), 0);
    const int by_words = Qt::AlignLeft | Qt::AlignTop | Qt::TextWordWrap;
    const bool fits = painter.boundingRect(place, by_words, label).width() <= place.width();
    painter.drawText(place, fits ? by_words : Qt::AlignLeft | Qt::AlignTop | Qt::TextWrapAnywhere, label);
    painter.drawText(foot_line, Qt::AlignRight | Qt::AlignTop, number);
    painter.translate(0, -page * body_height);
    QAbstractTextDocumentLayout::PaintContext context;
    context.clip = QRectF(0, page * body_height, document.pageSize().width(), body_height);
    context.palette.setColor(QPalette::Text, QColor(32, 32, 32));
    painter.setClipRect(context.clip);
    document.documentLayout()->draw(&painter, context);
    painter.restore();
  }
}

}  // namespace

Result<void> write_pdf(const Document& document, const std::filesystem::path& file) {
  const double text_width = page_width - 2 * margin;
  const double text_height = page_height - margin_above - margin_below;
  DrawingTextObject drawings(text_width);
  QTextDocument text;
  text.setUndoRedoEnabled(false);
  text.setDocumentMargin(0);
  text.setUseDesignMetrics(true);
  // One glyph per character: a ligature would be read back as another character and change words.
  QFont font("DejaVu Sans");
  font.setPixelSize(10);
  font.setStyleStrategy(QFont::PreferNoShaping);
  text.setDefaultFont(font);
  text.documentLayout()->registerHandler(DrawingTextObject::object_type, &drawings);
  write_text(text, drawings, document);
  QTextFrameFormat page = text.rootFrame()->frameFormat();
  page.setBottomMargin(room_below_px);
  text.rootFrame()->setFrameFormat(page);
  text.setPageSize({text_width, text_height});
  keep_together(text);
  if (const auto lost = lost_text(text))
    return fail(ErrorCode::internal, "the PDF would omit the text \"" + lost->toStdString() + "\"");

  QByteArray bytes;
  QBuffer buffer(&bytes);
  buffer.open(QIODevice::WriteOnly);
  {
    QPdfWriter writer(&buffer);
    writer.setResolution(writer_dpi);
    writer.setPageSize(QPageSize(QPageSize::A4));
    writer.setPageMargins(QMarginsF(0, 0, 0, 0));
    writer.setTitle(QString::fromStdString(document.title));
    writer.setCreator("todbench");
    paint_pages(writer, text, QString::fromStdString(document.page_label));
  }
  return write_file_atomically(file, std::string_view(bytes.constData(), static_cast<std::size_t>(bytes.size())));
}

Result<void> write_pdf_report(const ReportData& data, const std::filesystem::path& file) {
  return write_pdf(report_document(data), file);
}

}  // namespace todbench
