// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/report_view.h"

#include <QCheckBox>
#include <QDesktopServices>
#include <QFileDialog>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLineEdit>
#include <QPixmap>
#include <QScrollArea>
#include <QSplitter>
#include <QUrl>
#include <algorithm>

#include "bench/gui/presenters/bill_rows.h"
#include "bench/gui/presenters/text_of.h"
#include "bench/gui/views/layout_pieces.h"
#include "bench/gui/views/plot_view.h"
#include "bench/judgement/demand_kinds.h"
#include "bench/report/number_format.h"
#include "tod/comparison/comparison.h"

namespace todbench {
namespace {

constexpr int most_ratios = 5;  // visible at once
constexpr int least_plot_px = 190;
constexpr int logo_px = 40;
constexpr const char* write_reports = "Write HTML and PDF";

QString verdict_text(ReportVerdict verdict) {
  switch (verdict) {
    case ReportVerdict::pass:
      return "✓ PASS: every limit is met";
    case ReportVerdict::fail:
      return "✗ FAIL: a limit is not met";
    case ReportVerdict::inconclusive:
      return "? INCONCLUSIVE: the data do not decide a limit";
    case ReportVerdict::interrupted:
      return "? INTERRUPTED: the run ended early";
    case ReportVerdict::changed:
      return "✗ FILES CHANGED: no verdict";
    case ReportVerdict::not_judged:
      return "Not judged: the plan has no limits";
  }
  return {};
}

/// Adds a sign, because some users cannot distinguish the colours.
QString in_a_list(const QString& verdict) {
  if (verdict == "not judged") return verdict;
  return (verdict == "pass" ? "✓ " : verdict == "fail" ? "✗ " : "? ") + verdict;
}

/// Cells of a session in the list.
QStringList cells_of(const SessionEntry& session) {
  return {session.when, session.verdict.isEmpty() ? session.state : in_a_list(session.verdict),
          session.serial.isEmpty() ? session.unit : session.unit + ", " + session.serial, session.name};
}

/// Rows of the ratios that decide the comparison.
QList<QStringList> ratio_rows(const Comparison& comparison) {
  const Comparison decided = as_decided(comparison);
  QList<QStringList> rows;
  for (const auto& p : decided.points) {
    rows << QStringList{QString::number(p.set_delta_t_k),
                        QString::fromStdString(with_interval(p.ratio, p.ratio_ci95)),
                        QString::fromStdString(with_interval(p.ratio, p.ratio_ci90)),
                        p.p_difference ? QString::fromStdString(probability(*p.p_difference)) : "–",
                        p.p_equivalence ? QString::fromStdString(probability(*p.p_equivalence)) : "–",
                        text_of(to_string(p.verdict))};
  }
  return rows;
}

}  // namespace

ReportView::ReportView(SessionPresenter& presenter, QWidget* parent) : QWidget(parent), presenter_(presenter) {
  auto* layout = new QVBoxLayout(this);
  auto* splitter = new QSplitter(Qt::Horizontal);
  splitter->addWidget(browser());
  splitter->addWidget(session_panel());
  splitter->setStretchFactor(0, 2);
  splitter->setStretchFactor(1, 5);
  splitter->setSizes({430, 740});
  layout->addWidget(splitter);
  connect(&presenter_, &SessionPresenter::listed, this, &ReportView::list_sessions);
  connect(&presenter_, &SessionPresenter::opened, this, &ReportView::show_session);
  connect(&presenter_, &SessionPresenter::compared, this, &ReportView::show_comparison);
  connect(&presenter_, &SessionPresenter::exported, this, [this](const QString& html, const QString& pdf) {
    show_writing(false);
    files_->setText("Written: " + html + " and " + pdf);
    page_->setEnabled(true);
  });
  connect(&presenter_, &SessionPresenter::problem, this, [this] { show_writing(false); });
}

QWidget* ReportView::browser() {
  auto* panel = new QWidget;
  auto* layout = new QVBoxLayout(panel);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(title_label("Sessions"));
  filter_ = new QLineEdit;
  filter_->setObjectName("sessionFilter");
  filter_->setPlaceholderText("Serial number, unit, date or verdict");
  filter_->setToolTip("Lists the sessions that contain all of these words");
  filter_->setAccessibleName("Filter for sessions");
  filter_->setClearButtonEnabled(true);
  layout->addWidget(filter_);
  connect(filter_, &QLineEdit::textChanged, this, &ReportView::list_sessions);
  sessions_ = plain_table({"Started (UTC)", "Verdict", "Unit, serial number", "Session"}, "sessionTable");
  sessions_->setMinimumWidth(
      column_widths(*sessions_, {"Started (UTC)  __", "? inconclusive", "Emulated sc2000", "Session"}));
  wrap_words(*sessions_);
  QHeaderView& heads = *sessions_->horizontalHeader();
  heads.setSectionsClickable(true);
  heads.setSortIndicatorShown(true);
  heads.setSortIndicator(0, Qt::DescendingOrder);
  connect(&heads, &QHeaderView::sortIndicatorChanged, this, &ReportView::list_sessions);
  layout->addWidget(sessions_, 1);
  auto* buttons = new QHBoxLayout;
  auto* open = primary_button("Open", "openSession");
  compare_ = plain_button("Compare with open session", "compareSessions");
  buttons->addWidget(open);
  buttons->addWidget(compare_);
  buttons->addStretch();
  layout->addLayout(buttons);
  const auto open_chosen = [this] {
    if (const auto folder = chosen()) presenter_.open(*folder);
  };
  connect(open, &QPushButton::clicked, this, open_chosen);
  connect(sessions_, &QTableWidget::cellActivated, this, open_chosen);
  connect(compare_, &QPushButton::clicked, this, [this] {
    if (const auto folder = chosen()) presenter_.compare_with(*folder);
  });
  return panel;
}

/// Curves and tables have their full height: a plan with many limits scrolls them together.
QWidget* ReportView::results() {
  plot_ = new PlotView;
  plot_->setObjectName("comparePlot");
  plot_->setMinimumHeight(least_plot_px);
  log_log_ = new QCheckBox("Logarithmic acuity");
  auto* content = new QWidget;
  auto* layout = new QVBoxLayout(content);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(plot_, 1);
  for (QWidget* part : std::initializer_list<QWidget*>{log_log_, ratios_, limits_, bill_}) layout->addWidget(part);
  auto* scroll = new QScrollArea;
  scroll->setObjectName("sessionResults");
  scroll->setFrameShape(QFrame::NoFrame);
  scroll->setFocusPolicy(Qt::NoFocus);
  scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  scroll->setWidgetResizable(true);
  scroll->setWidget(content);
  return scroll;
}

QWidget* ReportView::session_panel() {
  auto* panel = new QWidget;
  auto* layout = new QVBoxLayout(panel);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(letterhead_line());
  title_ = title_label("No session is open");
  title_->setObjectName("sessionTitle");
  title_->setWordWrap(true);
  title_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  layout->addWidget(title_);
  verdict_ = new QLabel;
  verdict_->setObjectName("sessionVerdict");
  verdict_->setProperty("role", "verdict");
  verdict_->setWordWrap(true);
  layout->addWidget(verdict_);
  ratios_ = plain_table(
      {"Set ΔT (K)", "Acuity ratio [95 %]", "Acuity ratio [90 %]", "p different", "p equivalent", "Verdict"},
      "ratioTable");
  limits_ = plain_table({"Limit", "Result [95 %]", "Verdict", "Reason"}, "limitTable");
  column_widths(*ratios_, {"", "0.9770 [0.8890, 1.0740]", "0.9770 [0.8890, 1.0740]", "", "", ""});
  column_widths(*limits_, {"Acuity at 16.9 K at least", "0.510 [0.468, 0.556] 1/mrad", "? inconclusive"});
  bill_ = plain_table({"Part of the run", "Time (s)", "Forecast (s)", "Result"}, "billTable");
  bill_->setToolTip("Time of the run and the accuracy that it bought");
  column_widths(*bill_, {"Location of the plate, contrasts", "not separate", "Forecast (s)"});
  bill_->hide();
  fit_height(*ratios_, most_ratios);
  for (QTableWidget* table : {limits_, bill_}) {
    wrap_words(*table);
    fit_rows(*table, 100, QWIDGETSIZE_MAX);
  }
  layout->addWidget(results(), 1);
  auto* buttons = new QHBoxLayout;
  export_ = primary_button(write_reports, "exportReports");
  page_ = plain_button("Show the PDF", "showPdf");
  replay_ = plain_button("Replay", "replaySession");
  replay_->setToolTip("Judges the recorded frames of the session again and reports whether all answers are the same.");
  again_ = plain_button("Measure this plan again", "measureAgain");
  again_->setToolTip("Loads the plan of this session for a new measurement with the selected camera.");
  go_on_ = plain_button("Go on", "resumeSession");
  go_on_->setToolTip(
      "Measures the rest of a run that ended early, with the same plan and camera, into a new session. Its frames must "
      "have been recorded.");
  order_ = plain_button("Order…", "orderOfSession");
  order_->setToolTip(
      "Puts the order of a file with a section [order] on the first page of both reports: customer, report number, "
      "item, "
      "dates. The session keeps a copy.");
  for (QPushButton* button : {export_, order_, page_, replay_, again_, go_on_}) {
    button->setEnabled(false);
    buttons->addWidget(button);
  }
  compare_->setEnabled(false);
  buttons->addStretch();
  layout->addLayout(buttons);
  frames_ = hint_label();
  frames_->setObjectName("sessionFrames");
  layout->addWidget(frames_);
  files_ = hint_label();
  files_->setObjectName("exportedFiles");
  layout->addWidget(files_);
  connect(log_log_, &QCheckBox::toggled, this, &ReportView::show_plot);
  connect(export_, &QPushButton::clicked, this, [this] {
    show_writing(true);
    presenter_.export_reports();
  });
  connect(page_, &QPushButton::clicked, this, &ReportView::show_pdf);
  connect(replay_, &QPushButton::clicked, this, &ReportView::replay);
  connect(order_, &QPushButton::clicked, this, [this] {
    const QString file = QFileDialog::getOpenFileName(this, "Order", {}, "Orders (*.toml)");
    if (file.isEmpty()) return;
    show_writing(true);
    presenter_.export_with_order(file.toStdString());
  });
  connect(go_on_, &QPushButton::clicked, this, &ReportView::go_on);
  connect(again_, &QPushButton::clicked, this, [this] {
    presenter_.use_plan_again();
    emit again();
  });
  return panel;
}

void ReportView::show_writing(bool writing) {
  export_->setText(writing ? "Writing …" : write_reports);
  for (QPushButton* button : {export_, order_}) button->setEnabled(!writing && presenter_.current().has_value());
}

void ReportView::show_pdf() {
  if (!presenter_.current()) return;
  // A relative file name would become an address of the host "report.pdf".
  const auto file = std::filesystem::absolute(presenter_.current()->folder / "report.pdf");
  const QString name = QString::fromStdString(file.string());
  std::error_code none;
  if (!std::filesystem::exists(file, none)) {
    emit presenter_.problem(name + " does not exist. Press \"Write HTML and PDF\".");
  } else if (!QDesktopServices::openUrl(QUrl::fromLocalFile(name))) {
    emit presenter_.problem("No program of this desktop opens PDF files. The report is " + name);
  }
}

QWidget* ReportView::letterhead_line() {
  letterhead_ = new QWidget;
  letterhead_->setObjectName("sessionLetterhead");
  auto* line = new QHBoxLayout(letterhead_);
  line->setContentsMargins(0, 0, 0, 0);
  logo_ = new QLabel;
  laboratory_ = new QLabel;
  laboratory_->setObjectName("sessionLaboratory");
  laboratory_->setTextFormat(Qt::PlainText);
  laboratory_->setWordWrap(true);
  line->addWidget(logo_);
  line->addWidget(laboratory_, 1);
  letterhead_->hide();
  return letterhead_;
}

void ReportView::show_letterhead(const std::optional<Letterhead>& letterhead) {
  letterhead_->setVisible(letterhead.has_value());
  if (!letterhead) return;
  QPixmap logo;
  if (logo.loadFromData(reinterpret_cast<const uchar*>(letterhead->logo_png.data()),
                        static_cast<uint>(letterhead->logo_png.size())))
    logo_->setPixmap(logo.scaledToHeight(logo_px, Qt::SmoothTransformation));
  else
    logo_->clear();
  logo_->setVisible(!logo.isNull());
  logo_->setAccessibleName(QString::fromStdString(letterhead->logo_text));
  QStringList lines;
  for (const std::string& line : letterhead->lines) lines << QString::fromStdString(line);
  QStringList words{QString::fromStdString(letterhead->title), lines.join(" · ")};
  words.removeAll(QString());
  laboratory_->setText(words.join('\n'));
}

void ReportView::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  presenter_.refresh();
}

std::optional<std::filesystem::path> ReportView::chosen() const {
  const int row = sessions_->currentRow();
  if (row < 0 || row >= static_cast<int>(listed_.size())) return std::nullopt;
  return listed_[static_cast<std::size_t>(row)].folder;
}

void ReportView::list_sessions() {
  listed_ = matching(presenter_.sessions(), filter_->text());
  const int column = sessions_->horizontalHeader()->sortIndicatorSection();
  const bool rising = sessions_->horizontalHeader()->sortIndicatorOrder() == Qt::AscendingOrder;
  std::stable_sort(listed_.begin(), listed_.end(), [&](const SessionEntry& a, const SessionEntry& b) {
    const QString of_a = cells_of(a).value(column), of_b = cells_of(b).value(column);
    return rising ? of_a < of_b : of_b < of_a;
  });
  QList<QStringList> rows;
  for (const auto& s : listed_) rows << cells_of(s);
  fill_table(*sessions_, rows);
  if (sessions_->currentRow() < 0 && !rows.isEmpty()) sessions_->selectRow(0);
}

void ReportView::show_session() {
  const OpenedSession& opened = *presenter_.current();
  show_letterhead(opened.report.letterhead);
  title_->setText(opened.name + (opened.report.camera
                                     ? ", serial number " + QString::fromStdString(opened.report.camera->serial)
                                     : QString()));
  const Verdict& verdict = *opened.report.verdict;
  verdict_->setText(verdict_text(report_verdict(opened.report)) +
                    (verdict.judged == JudgedWhen::afterwards ? ". " + text_of(remark_on(verdict.judged)) : QString()));
  show_ratios(opened.session.comparison);
  QList<QStringList> rows;
  for (const Demand& demand : verdict.demands) {
    const QString percent = demand.interval_percent == 95 ? "" : QString(" (%1 %)").arg(demand.interval_percent);
    rows << QStringList{QString::fromStdString(title(demand)),
                        QString::fromStdString(with_interval(demand.result, demand.interval)) + " " +
                            text_of(row_of(demand.kind).unit) + percent,
                        demand.decision == VerdictKind::pass   ? "✓ pass"
                        : demand.decision == VerdictKind::fail ? "✗ fail"
                                                               : "? inconclusive",
                        QString::fromStdString(demand.reason)};
  }
  fill_table(*limits_, rows);
  if (opened.bill) fill_table(*bill_, bill_rows(*opened.bill));
  bill_->setVisible(opened.bill.has_value());
  files_->clear();
  show_writing(false);
  for (QPushButton* button : {again_, compare_}) button->setEnabled(true);
  replay_->setEnabled(opened.recorded);
  go_on_->setEnabled(opened.recorded && opened.session.provenance.state != SessionState::complete);
  frames_->setText(opened.recorded
                       ? "The session contains its frames. Replay judges them again."
                       : "No frames were recorded in this session. It cannot be replayed, only measured again. "
                         "To record frames, select \"Keep frames for replay\" in the plan.");
  std::error_code none;
  page_->setEnabled(std::filesystem::exists(opened.folder / "report.pdf", none));
  show_plot();
}

void ReportView::show_comparison() {
  const ComparedSessions& compared = *presenter_.compared_sessions();
  const std::string reasons = reasons_unfit(compared.comparison.adequacy.value_or(Adequacy{}));
  show_letterhead(std::nullopt);
  title_->setText(compared.a + " against " + compared.b);
  verdict_->setText("Acuity ratio " + compared.a + " / " + compared.b + ": " +
                    text_of(to_string(compared.comparison.verdict)) +
                    (reasons.empty() ? QString() : ": " + QString::fromStdString(reasons)));
  show_ratios(compared.comparison);
  fill_table(*limits_, {});
  bill_->hide();
  show_plot();
}

void ReportView::show_ratios(const std::optional<Comparison>& comparison) {
  fill_table(*ratios_, comparison ? ratio_rows(*comparison) : QList<QStringList>());
  const QString kind = comparison && decided_by_pairs(*comparison) ? "Paired ratio" : "Acuity ratio";
  ratios_->horizontalHeaderItem(1)->setText(kind + " [95 %]");
  ratios_->horizontalHeaderItem(2)->setText(kind + " [90 %]");
  fit_height(*ratios_, most_ratios);
}

void ReportView::show_plot() {
  if (!presenter_.current()) return;
  plot_->show_plot(presenter_.tod_figure(log_log_->isChecked() ? AxisScale::logarithmic : AxisScale::linear));
}

}  // namespace todbench
