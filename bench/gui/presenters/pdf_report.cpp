#include "bench/gui/presenters/pdf_report.h"

#include <QAbstractTextDocumentLayout>
#include <QBuffer>
#include <QPageLayout>
#include <QPainter>
#include <QPdfWriter>
#include <QRegularExpression>
#include <QTextBlock>
#include <QTextCursor>
#include <QTextDocument>
#include <QTextTable>
#include <algorithm>
#include <optional>

#include "bench/gui/presenters/plot_text_object.h"
#include "bench/text/files.h"

namespace todbench {
namespace {

// Layout in CSS pixels of 1/96 inch.
constexpr double px_per_mm = 96 / 25.4;
constexpr double page_width = 210 * px_per_mm, page_height = 297 * px_per_mm;
constexpr double margin = 16 * px_per_mm, foot = 8 * px_per_mm;
constexpr int writer_dpi = 1200;

const char* const style = R"(
  body { font-family: "DejaVu Sans"; font-size: 10px; color: #202020; }
  h1 { font-size: 19px; }
  h2 { font-size: 14px; margin-top: 14px; }
  h3 { font-size: 12px; }
  table { border-collapse: collapse; border: 1px solid #b8b8b8; margin-top: 4px; margin-bottom: 8px; }
  th { text-align: left; background-color: #f0f0f0; padding: 3px; border: 1px solid #d0d0d0; font-weight: bold; }
  td { padding: 3px; border: 1px solid #d0d0d0; }
  caption { font-size: 10px; }
  .note, .subtitle { color: #505050; }
  .word { font-size: 18px; font-weight: bold; }
  .figures, .figure { border: 0px; padding: 0px; }
  .badge { font-weight: bold; }
)";

int page_of(const QTextDocument& document, const QTextBlock& block) {
  const QRectF place = document.documentLayout()->blockBoundingRect(block);
  return static_cast<int>(place.bottom() / document.pageSize().height());
}

QTextTable* table_at(const QTextBlock& block) {
  return QTextCursor(block).currentTable();
}

/// The first block from here on that shows something: tables and figures stand behind empty ones.
QTextBlock content_after(QTextBlock block) {
  do block = block.next();
  while (block.isValid() && block.text().trimmed().isEmpty());
  return block;
}

/// The block that has to be on the page of a heading or of a caption: the first line of what is below, the end of a
/// table of a few rows.
QTextBlock belongs_to(const QTextBlock& block) {
  constexpr int few_rows = 6;
  QTextBlock content = content_after(block);
  if (!content.isValid()) return content;
  const QTextBlock below = content_after(content);
  const bool caption = table_at(content) == nullptr && below.isValid() && table_at(below) != nullptr;
  if (caption) content = below;
  if (const QTextTable* table = table_at(content); table != nullptr && table->rows() <= few_rows)
    return table->lastCursorPosition().block();
  return content;
}

/// A heading or caption at the foot of a page moves to the next one, with what it is about. Every move shifts what
/// follows, so the whole document is laid out again each time: Qt leaves blocks without lines where only the changed
/// one is.
void keep_headings_with_text(QTextDocument& document) {
  for (QTextBlock block = document.begin(); block.isValid(); block = block.next()) {
    if (table_at(block) != nullptr || block.text().trimmed().isEmpty()) continue;
    const QTextBlock next = content_after(block);
    const bool stands_over_a_table = next.isValid() && table_at(next) != nullptr;
    if (block.blockFormat().headingLevel() == 0 && !stands_over_a_table) continue;
    const QTextBlock content = belongs_to(block);
    if (!content.isValid() || page_of(document, content) == page_of(document, block)) continue;
    QTextBlockFormat format = block.blockFormat();
    format.setPageBreakPolicy(QTextFormat::PageBreak_AlwaysBefore);
    QTextCursor(block).setBlockFormat(format);
    document.markContentsDirty(0, document.characterCount());
  }
}

/// The text of the first block that the layout has left without a line: it would be missing on the page.
std::optional<QString> lost_text(const QTextDocument& document) {
  (void)document.documentLayout()->documentSize();  // finishes the layout
  for (QTextBlock block = document.begin(); block.isValid(); block = block.next())
    if (!block.text().isEmpty() && block.layout()->lineCount() == 0) return block.text();
  return std::nullopt;
}

/// Puts the plots where rich_text() left their numbers.
void insert_plots(QTextDocument& document, int count) {
  for (int i = 0; i < count; ++i) {
    QTextCursor cursor = document.find(QString("@@%1@@").arg(i));
    if (cursor.isNull()) continue;
    QTextCharFormat format;
    format.setObjectType(PlotTextObject::object_type);
    format.setProperty(PlotTextObject::index_property, i);
    cursor.insertText(QString(QChar::ObjectReplacementCharacter), format);
  }
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
    painter.translate(margin, margin);
    QFont font("DejaVu Sans");
    font.setPixelSize(9);
    font.setStyleStrategy(QFont::PreferNoShaping);
    painter.setFont(font);
    painter.setPen(QColor(80, 80, 80));
    const QRectF foot_line(0, body_height + foot / 4, document.pageSize().width(), foot);
    painter.drawText(foot_line, Qt::AlignLeft | Qt::AlignVCenter, label);
    painter.drawText(foot_line, Qt::AlignRight | Qt::AlignVCenter, QString("page %1 of %2").arg(page + 1).arg(pages));
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

namespace {

/// Figures of a group two in a row, in a table without lines. False: there was none.
bool put_figures_in_pairs(QString& html) {
  const QString opening = "<div class=\"pairs\"><figure>";
  const auto begin = html.indexOf(opening);
  if (begin < 0) return false;
  const auto end = html.indexOf("</div>", begin);
  const QStringList figures = html.mid(begin, end - begin).split("</figure>", Qt::SkipEmptyParts);
  QString rows;
  int number = 0;
  for (const QString& figure : figures) {
    const auto content = figure.indexOf("<figure>");
    if (content < 0) continue;
    if (number % 2 == 0) rows += number == 0 ? "<tr>" : "</tr><tr>";
    rows += "<td class=\"figure\">" + figure.mid(content + 8) + "</td>";
    ++number;
  }
  html.replace(begin, end - begin, "<div><table class=\"figures\">" + rows + "</tr></table>");
  return true;
}

/// Places to sign side by side, one column a person, with room to write.
void put_signatures_in_columns(QString& html) {
  const QString opening = "<div class=\"signatures\">";
  const auto begin = html.indexOf(opening);
  const auto end = html.indexOf("</section>", begin);
  if (begin < 0 || end < 0) return;
  static const QRegularExpression line("<div class=\"(?:role|line|line tall)\">(.*?)</div>");
  constexpr int lines_each = 4;  // role, name, date, signature
  QStringList rows(lines_each);
  auto lines = line.globalMatch(html.mid(begin, end - begin));
  for (int i = 0; lines.hasNext(); ++i) {
    const QString text = lines.next().captured(1);
    const int row = i % lines_each;
    const QString room = row == lines_each - 1 ? "<br/><br/><br/>" : "";
    rows[row] += row == 0 ? "<th width=\"33%\">" + text + "</th>" : "<td>" + text + room + "</td>";
  }
  html.replace(begin, end - begin, "<table><tr>" + rows.join("</tr><tr>") + "</tr></table>");
}

}  // namespace

QString rich_text(const std::string& report_html) {
  QString html = QString::fromStdString(report_html);
  static const QRegularExpression styles("<style.*?</style>", QRegularExpression::DotMatchesEverythingOption);
  static const QRegularExpression pictures("<svg.*?</svg>", QRegularExpression::DotMatchesEverythingOption);
  html.remove(styles);
  for (int number = 0;; ++number) {
    const auto found = pictures.match(html);
    if (!found.hasMatch()) break;
    html.replace(found.capturedStart(), found.capturedLength(), QString("<p>@@%1@@</p>").arg(number));
  }
  while (put_figures_in_pairs(html)) {
  }
  put_signatures_in_columns(html);
  html.replace("<figcaption>", "<p class=\"note\">").replace("</figcaption>", "</p>");
  html.replace("<table", "<table width=\"100%\" cellspacing=\"0\"");
  return html;
}

Result<void> write_pdf_report(const ReportData& data, const std::filesystem::path& file) {
  const double text_width = page_width - 2 * margin;
  const double text_height = page_height - 2 * margin - foot;
  std::vector<Plot> plots = report_plots(data);
  const int count = static_cast<int>(plots.size());
  PlotTextObject drawing(std::move(plots), text_width);
  QTextDocument document;
  document.setUndoRedoEnabled(false);
  document.setDocumentMargin(0);
  document.setUseDesignMetrics(true);
  // One glyph per character: a ligature is read back as another character, and words as other words.
  QFont font("DejaVu Sans");
  font.setPixelSize(10);
  font.setStyleStrategy(QFont::PreferNoShaping);
  document.setDefaultFont(font);
  document.documentLayout()->registerHandler(PlotTextObject::object_type, &drawing);
  document.setDefaultStyleSheet(style);
  document.setHtml(rich_text(render_report(data)));
  insert_plots(document, count);
  document.setPageSize({text_width, text_height});
  keep_headings_with_text(document);
  if (const auto lost = lost_text(document))
    return fail(ErrorCode::internal, "the PDF would leave out \"" + lost->toStdString() + "\"");

  QByteArray bytes;
  QBuffer buffer(&bytes);
  buffer.open(QIODevice::WriteOnly);
  {
    QPdfWriter writer(&buffer);
    writer.setResolution(writer_dpi);
    writer.setPageSize(QPageSize(QPageSize::A4));
    writer.setPageMargins(QMarginsF(0, 0, 0, 0));
    writer.setTitle(QString::fromStdString(data.title + (data.session.empty() ? "" : ", " + data.session)));
    writer.setCreator("todbench");
    QString label = QString::fromStdString(data.session.empty() ? data.title : data.session);
    if (data.camera && !data.camera->serial.empty())
      label += ", serial number " + QString::fromStdString(data.camera->serial);
    paint_pages(writer, document, label);
  }
  return write_file_atomically(file, std::string_view(bytes.constData(), static_cast<std::size_t>(bytes.size())));
}

}  // namespace todbench
