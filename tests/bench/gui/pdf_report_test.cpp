// SPDX-License-Identifier: GPL-3.0-or-later
// The PDF, read back by other programs.
#include "bench/gui/presenters/pdf_report.h"

#include <QImage>
#include <QProcess>
#include <QRegularExpression>
#include <QTemporaryDir>
#include <QTextDocument>

#include "tests/bench/gui/gui_test_support.h"
#include "tests/bench/report/document_sample.h"
#include "tests/support/patience.h"

namespace todbench::testing {
namespace {

/// Words without white space: lines break elsewhere on a page.
QString squeezed(QString text) {
  static const QRegularExpression blanks("[\\s\\x{00ad}\\x{2060}]+");
  return text.replace(QChar(0xa0), ' ').remove(blanks);
}

QString output_of(const QString& program, const QStringList& arguments) {
  QProcess process;
  process.start(program, arguments);
  EXPECT_TRUE(process.waitForStarted()) << program.toStdString() << " of poppler-utils is needed";
  EXPECT_TRUE(process.waitForFinished(static_cast<int>(testing_support::patience(std::chrono::minutes(1)).count())));
  EXPECT_EQ(process.exitCode(), 0) << process.readAllStandardError().toStdString();
  return QString::fromUtf8(process.readAllStandardOutput());
}

/// Cells, headings, captions, paragraphs and items of lists of the page, as plain text.
QStringList texts_of(const std::string& html) {
  static const QRegularExpression cell("<(td|th|h1|h2|h3|caption|figcaption|p|li)(?: [^>]*)?>(.*?)</\\1>",
                                       QRegularExpression::DotMatchesEverythingOption);
  QStringList out;
  auto found = cell.globalMatch(QString::fromStdString(html));
  while (found.hasNext()) {
    QTextDocument text;
    text.setHtml(found.next().captured(2));
    out << text.toPlainText();
  }
  return out;
}

/// Dark pixels at 100 dpi in the last millimetre above the foot of the pages, where only edges of tables may be: a line
/// there would be on two pages.
int dark_above_the_foot(const std::filesystem::path& pdf, const std::filesystem::path& stem) {
  (void)output_of("pdftoppm", {"-r", "100", "-gray", "-x", "0", "-y", "1085", "-W", "827", "-H", "5",
                               QString::fromStdString(pdf.string()), QString::fromStdString(stem.string())});
  int dark = 0;
  for (const auto& entry : std::filesystem::directory_iterator(stem.parent_path())) {
    if (entry.path().extension() != ".pgm" || !entry.path().filename().string().starts_with(stem.filename().string()))
      continue;
    const QImage strip(QString::fromStdString(entry.path().string()));
    EXPECT_EQ(strip.height(), 5);
    for (int y = 0; y < strip.height(); ++y) {
      for (int x = 0; x < strip.width(); ++x) dark += qGray(strip.pixel(x, y)) < 128 ? 1 : 0;
    }
    std::filesystem::remove(entry.path());
  }
  return dark;
}

/// The report of one measurement, which no test changes, and its PDF.
class PdfReport : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    window_ = std::make_unique<ShownWindow>("sim:sc2000", 3);
    Plan plan = window()->bench().plan();
    plan.fit.estimator = EstimatorChoice::automatic;
    window()->bench().set_plan(plan);
    window_->measure();
    auto opened = read_opened_session(window()->measure().folder());
    ASSERT_TRUE(opened) << opened.error().message;
    report_ = opened->report;
    // A simulated camera has a serial number like any other.
    ASSERT_TRUE(report_.camera && !report_.camera->serial.empty());
    report_.camera->serial = "TB-0815";
    const auto written = write_pdf_report(report_, file());
    ASSERT_TRUE(written) << written.error().message;
  }
  static void TearDownTestSuite() { window_.reset(); }

  static ShownWindow& window() { return *window_; }
  static const ReportData& report() { return report_; }
  static std::filesystem::path file() { return window_->sessions() / "report.pdf"; }

 private:
  static inline std::unique_ptr<ShownWindow> window_;
  static inline ReportData report_;
};

TEST_F(PdfReport, HoldsSerialNumberVerdictAndEveryTextOfThePage) {
  const QString text = squeezed(output_of("pdftotext", {"-layout", QString::fromStdString(file().string()), "-"}));
  // In reading order cells of a row that break into lines stay together.
  const QString raw = squeezed(output_of("pdftotext", {"-raw", QString::fromStdString(file().string()), "-"}));

  EXPECT_TRUE(text.contains("TB-0815"));
  const QString verdict = report_verdict(report()) == ReportVerdict::pass   ? "PASS"
                          : report_verdict(report()) == ReportVerdict::fail ? "FAIL"
                                                                            : "INCONCLUSIVE";
  EXPECT_TRUE(raw.contains(verdict)) << verdict.toStdString();
  const QStringList texts = texts_of(render_report(report()));
  EXPECT_GT(texts.size(), 150);
  for (const QString& expected : texts)
    EXPECT_TRUE(raw.contains(squeezed(expected)) || text.contains(squeezed(expected))) << expected.toStdString();
}

TEST_F(PdfReport, LosesNoHeadingWhereverItsPagesBreak) {
  static const QRegularExpression heading("<h2[^>]*>(.*?)</h2>");
  ReportData report = PdfReport::report();
  const std::filesystem::path file = window().sessions() / "moved.pdf";
  report.human = report.measured;
  CostFrontier cost;
  for (const char* knob : {"tolerance", "draws", "wavelengths", "phases"})
    cost.points.push_back({.knob = knob, .setting = "1", .wall_s = 0.1, .error_percent = 0.5});
  report.cost = cost;
  // Rows of a table before everything else: headings come to the foot of a page one after the other. A document takes
  // some seconds; the four have 18 page breaks.
  for (int rows = 0; rows < 44; rows += 11) {
    report.conditions.assign(static_cast<std::size_t>(rows), {"Room temperature (K)", "295"});
    ASSERT_TRUE(write_pdf_report(report, file));

    const QString pages = output_of("pdftotext", {"-raw", QString::fromStdString(file.string()), "-"});
    // Without the margin at the foot, in points: a page also holds what its clip leaves out.
    const QStringList above_the_foot = output_of("pdftotext", {"-raw", "-r", "72", "-x", "0", "-y", "0", "-W", "595",
                                                               "-H", "785", QString::fromStdString(file.string()), "-"})
                                           .split('\f');
    for (const QString& page : pages.split('\f'))
      EXPECT_EQ(page.contains("Tested by"), page.contains("Signature:")) << rows << " rows: signatures on two pages";
    const QString raw = squeezed(pages);
    auto headings = heading.globalMatch(QString::fromStdString(render_report(report)));
    while (headings.hasNext()) {
      const QString text = headings.next().captured(1);
      EXPECT_TRUE(raw.contains(squeezed(text))) << rows << " rows: " << text.toStdString();
      for (const QString& page : above_the_foot)
        EXPECT_FALSE(page.trimmed().endsWith(text)) << rows << " rows: " << text.toStdString() << " ends a page";
    }
    EXPECT_TRUE(raw.contains(squeezed("p different: likelihood-ratio test"))) << rows << " rows";
    EXPECT_EQ(dark_above_the_foot(file, window().sessions() / "strip"), 0) << rows << " rows: a line on two pages";
    EXPECT_FALSE(raw.contains("@@")) << "a figure is missing";
  }
}

TEST(PdfDocument, CutsNoCaptionAndRepeatsHeadersWhereverItsPagesBreak) {
  const QTemporaryDir folder;
  const std::filesystem::path file = folder.filePath("document.pdf").toStdString();
  const auto words = [](const std::string& begin, const std::string& end, int between) {
    std::string text = begin;
    for (int i = 0; i < between; ++i) text += " measured";
    return text + " " + end;
  };
  Table table{"", {"HeaderOne", "HeaderTwo"}, {}};
  for (int row = 10; row < 30; ++row) {
    const std::string number = std::to_string(row);
    table.rows.push_back({plain(number), plain(words("Begin" + number, "End" + number, row % 3 == 0 ? 40 : 1))});
  }
  const FigurePairs figures{{{sample_drawing("one", "DrawnLeft"), words("LeftBegin", "LeftEnd", 24)},
                             {sample_drawing("two", "DrawnRight"), "RightCaption"}}};
  const Figure figure{sample_drawing("three", "DrawnAlone"), words("AloneBegin", "AloneEnd", 40)};
  // Lines before everything else: rows, figures and captions come to the foot of a page one after the other.
  int broken_tables = 0;
  for (int lines = 0; lines < 60; lines += 5) {
    List filler;
    for (int i = 0; i < lines; ++i) filler.items.push_back(plain("line"));
    const Document document{.title = "Title",
                            .heading = "Heading",
                            .subtitle = "Subtitle",
                            .page_label = "PageLabel",
                            .opening = {filler, table, figures, figure},
                            .sections = {}};
    ASSERT_TRUE(write_pdf(document, file));

    // Without the margin at the foot, in points: a page also holds what its clip leaves out.
    const QStringList pages = output_of("pdftotext", {"-raw", "-r", "72", "-x", "0", "-y", "0", "-W", "595", "-H",
                                                      "770", QString::fromStdString(file.string()), "-"})
                                  .split('\f');
    const auto page_of = [&](const QString& word) {
      qsizetype page = 0;
      while (page < pages.size() && !pages[page].contains(word)) ++page;
      return page;
    };
    static const QRegularExpression of_the_table("(Begin|End)[12]\\d");
    int pages_with_rows = 0;
    for (const QString& page : pages) {
      const bool has_rows = page.contains(of_the_table);
      pages_with_rows += has_rows ? 1 : 0;
      EXPECT_EQ(page.count("HeaderOne"), has_rows ? 1 : 0) << lines << " lines";
    }
    broken_tables += pages_with_rows > 1 ? 1 : 0;
    for (int row = 10; row < 30; ++row) {
      const QString number = QString::number(row);
      EXPECT_EQ(page_of("Begin" + number), page_of("End" + number)) << lines << " lines: row " << row;
    }
    for (const char* word : {"DrawnLeft", "LeftBegin", "RightCaption"})
      EXPECT_EQ(page_of(word), page_of("LeftEnd")) << lines << " lines: " << word;
    for (const char* word : {"DrawnAlone", "AloneBegin"})
      EXPECT_EQ(page_of(word), page_of("AloneEnd")) << lines << " lines: " << word;
  }
  EXPECT_GE(broken_tables, 3);
}

TEST_F(PdfReport, ReadsBackWithoutLigatures) {
  const QString text = output_of("pdftotext", {"-raw", QString::fromStdString(file().string()), "-"});

  // Alphabetic presentation forms: ff, fi, fl, ffi, ffl as one character; private use; what could not be mapped.
  static const QRegularExpression garbled("[\\x{FB00}-\\x{FB06}\\x{E000}-\\x{F8FF}\\x{FFFD}]");
  const auto found = garbled.match(text);
  EXPECT_FALSE(found.hasMatch()) << text.mid(found.capturedStart() - 20, 40).toStdString();
  EXPECT_TRUE(text.contains("Effective"));
}

TEST(PdfDocument, ShowsEveryTextOfEveryKindOfBlock) {
  const QTemporaryDir folder;
  const std::filesystem::path file = folder.filePath("document.pdf").toStdString();

  const auto written = write_pdf(document_of_every_block(), file);

  ASSERT_TRUE(written) << written.error().message;
  const QString text = output_of("pdftotext", {"-raw", QString::fromStdString(file.string()), "-"});
  for (const std::string& expected : texts_of_every_block())
    EXPECT_TRUE(text.contains(QString::fromStdString(expected))) << expected;
  EXPECT_TRUE(text.contains("PageLabel"));
}

TEST_F(PdfReport, HasItsFiguresAsLinesAndNoPictures) {
  const QString images = output_of("pdfimages", {"-list", QString::fromStdString(file().string())});

  // Two lines of heading and nothing below.
  EXPECT_EQ(images.trimmed().split('\n').size(), 2) << images.toStdString();
  const QString text = output_of("pdftotext", {"-raw", QString::fromStdString(file().string()), "-"});
  for (const char* label : {"Acuity 1/S", "Size S (mrad)", "25 % (chance)", "measured", "simulated"})
    EXPECT_TRUE(text.contains(label)) << label;
}

TEST_F(PdfReport, KeepsEverythingInsideTheMarginsOfEveryPage) {
  const QString stem = QString::fromStdString((window().sessions() / "page").string());
  (void)output_of("pdftoppm", {"-r", "50", "-png", QString::fromStdString(file().string()), stem});

  int pages = 0;
  for (const auto& entry : std::filesystem::directory_iterator(window().sessions())) {
    if (entry.path().extension() != ".png") continue;
    ++pages;
    const QImage page(QString::fromStdString(entry.path().string()));
    ASSERT_FALSE(page.isNull());
    // 8 mm of the 16 mm margin at 50 dpi.
    const int margin = 15;
    for (int y = 0; y < page.height(); ++y) {
      for (int x = 0; x < page.width(); ++x) {
        const bool inside = x >= margin && y >= margin && x < page.width() - margin && y < page.height() - margin;
        if (inside) continue;
        ASSERT_GT(qGray(page.pixel(x, y)), 250) << entry.path() << " at " << x << ", " << y;
      }
    }
  }
  EXPECT_GE(pages, 3);
}

}  // namespace
}  // namespace todbench::testing
