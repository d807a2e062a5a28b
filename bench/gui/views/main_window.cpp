// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/main_window.h"

#include <QActionGroup>
#include <QApplication>
#include <QCloseEvent>
#include <QComboBox>
#include <QDragEnterEvent>
#include <QDropEvent>
#include <QFileDialog>
#include <QFrame>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLineEdit>
#include <QListWidget>
#include <QMenuBar>
#include <QMessageBox>
#include <QMimeData>
#include <QPlainTextEdit>
#include <QScrollArea>
#include <QSettings>
#include <QShortcut>
#include <QSplitter>
#include <QStackedWidget>
#include <QStatusBar>
#include <QStyleFactory>
#include <QTableWidget>
#include <algorithm>

#include "bench/gui/views/align_view.h"
#include "bench/gui/views/chain_view.h"
#include "bench/gui/views/help_window.h"
#include "bench/gui/views/history_view.h"
#include "bench/gui/views/human_view.h"
#include "bench/gui/views/layout_pieces.h"
#include "bench/gui/views/look_view.h"
#include "bench/gui/views/measure_view.h"
#include "bench/gui/views/plan_view.h"
#include "bench/gui/views/report_view.h"
#include "bench/gui/views/start_view.h"

namespace todbench {

QString name_of(View view) {
  switch (view) {
    case View::look:
      return "Camera";
    case View::align:
      return "Align";
    case View::plan:
      return "Plan";
    case View::measure:
      return "Measure";
    case View::human:
      return "Human observer";
    case View::chain:
      return "Imaging chain";
    case View::report:
      return "Compare and report";
    case View::history:
      return "History";
    case View::start:
      return "Start page";
  }
  return {};
}

namespace {

/// Stored column widths apply to a table with the same number of columns.
QString columns_key(const QTableWidget& table) {
  return QString("columns/%1-%2").arg(table.objectName()).arg(table.columnCount());
}

bool ask_in_a_box(QWidget* parent, const QString& question, const QString& action) {
  QMessageBox box(QMessageBox::Question, "todbench", question, QMessageBox::NoButton, parent);
  QPushButton* yes = box.addButton(action, QMessageBox::DestructiveRole);
  box.setDefaultButton(box.addButton("Go on", QMessageBox::RejectRole));
  box.exec();
  return box.clickedButton() == yes;
}

}  // namespace

MainWindow::MainWindow(const std::filesystem::path& sessions, Memory memory, QWidget* parent)
    : QMainWindow(parent),
      memory_(memory),
      bench_(sessions),
      look_(bench_),
      align_(bench_),
      plan_(bench_),
      measure_(bench_),
      chain_(bench_),
      sessions_(bench_),
      history_(memory == Memory::remember ? default_history_file() : sessions / "history.sqlite") {
  setWindowTitle("todbench");
  confirm_ = [this](const QString& question, const QString& action) { return ask_in_a_box(this, question, action); };
  theme_ = desktop_theme();
  make_views();
  make_menu();
  connect_parts();
  resize(1280, 700);
  if (memory_ == Memory::remember) recall();
  set_theme(theme_);
  setAcceptDrops(true);
  // A dropped file is opened by the window, not inserted as text into the field under the mouse.
  for (QLineEdit* edit : findChildren<QLineEdit*>()) edit->setAcceptDrops(false);
  for (QPlainTextEdit* edit : findChildren<QPlainTextEdit*>()) edit->setAcceptDrops(false);
  show_view(first_start_ ? View::start : View::look);
  show_state();
}

MainWindow::~MainWindow() {
  // Jobs use presenters: end them before the presenters are destroyed.
  bench_.shut_down();
}

void MainWindow::make_views() {
  auto* central = new QWidget;
  auto* layout = new QHBoxLayout(central);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  navigation_ = new QListWidget;
  navigation_->setObjectName("navigation");
  navigation_->setFixedWidth(165);
  navigation_->setAccessibleName("Views");
  views_ = new QStackedWidget;
  int number = 0;
  for (const View view : all_views) {
    auto* item = new QListWidgetItem(name_of(view), navigation_);
    item->setToolTip(QString("Ctrl+%1").arg(++number));
    auto* shortcut = new QShortcut(QKeySequence(QString("Ctrl+%1").arg(number)), this);
    connect(shortcut, &QShortcut::activated, this, [this, view] { show_view(view); });
  }
  // The start page is not a step of the work: the list contains it but hides it.
  (new QListWidgetItem(name_of(View::start), navigation_))->setHidden(true);
  views_->addWidget(new LookView(bench_, look_));
  views_->addWidget(new AlignView(bench_, align_, look_));
  plan_view_ = new PlanView(plan_);
  views_->addWidget(plan_view_);
  auto* measure = new MeasureView(bench_, measure_, look_);
  connect(measure, &MeasureView::start_wanted, this, &MainWindow::start_run);
  connect(measure, &MeasureView::abort_wanted, this, &MainWindow::abort_run);
  connect(measure, &MeasureView::report_wanted, this, [this] { show_view(View::report); });
  views_->addWidget(measure);
  views_->addWidget(new HumanView(bench_, human_, person_, measure_));
  views_->addWidget(new ChainView(chain_));
  auto* report = new ReportView(sessions_);
  connect(report, &ReportView::again, this, [this] { show_view(View::measure); });
  connect(report, &ReportView::replay, this, [this] {
    if (!sessions_.current()) return;
    show_view(View::measure);
    measure_.replay(sessions_.current()->folder, sessions_.current()->session.plan);
  });
  connect(report, &ReportView::go_on, this, [this] {
    if (!sessions_.current()) return;
    show_view(View::measure);
    measure_.resume_run(sessions_.current()->folder, sessions_.current()->session.plan);
  });
  views_->addWidget(report);
  views_->addWidget(new HistoryView(history_, bench_.sessions_folder()));
  views_->addWidget(start_page());

  message_ = new QFrame;
  message_->setObjectName("messageBar");
  auto* line = new QHBoxLayout(message_);
  message_text_ = new QLabel;
  message_text_->setObjectName("messageText");
  message_text_->setAccessibleName("Message");
  message_text_->setWordWrap(true);
  message_text_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  retry_ = primary_button("Try again", "retry");
  auto* close = plain_button("Close", "closeMessage");
  abandon_ = primary_button("Abort the run", "abandonRun");
  other_camera_ = plain_button("Choose another camera", "otherCamera");
  line->addWidget(message_text_, 1);
  for (QPushButton* button : {retry_, abandon_, other_camera_}) line->addWidget(button);
  line->addWidget(close);
  connect(close, &QPushButton::clicked, message_, &QWidget::hide);
  message_->hide();

  auto* right = new QVBoxLayout;
  right->addWidget(message_);
  // A screen narrower than a page scrolls it. Only the shown page counts: the others may be wider.
  auto* room = new QScrollArea;
  room->setObjectName("pageRoom");
  room->setFrameShape(QFrame::NoFrame);
  room->setFocusPolicy(Qt::NoFocus);
  room->setWidgetResizable(true);
  // A scroll area gives a page with wrapped texts its preferred height for the width. A splitter asks for the least
  // one.
  auto* least = new QSplitter;
  least->setChildrenCollapsible(false);
  least->addWidget(views_);
  room->setWidget(least);
  const auto fit_shown = [this](int shown) {
    for (int page = 0; page < views_->count(); ++page) {
      const auto policy = page == shown ? QSizePolicy::Preferred : QSizePolicy::Ignored;
      views_->widget(page)->setSizePolicy(policy, policy);
    }
  };
  connect(views_, &QStackedWidget::currentChanged, this, fit_shown);
  fit_shown(views_->currentIndex());
  right->addWidget(room, 1);
  layout->addWidget(navigation_);
  layout->addLayout(right, 1);
  setCentralWidget(central);
  state_ = new QLabel;
  state_->setObjectName("benchState");
  statusBar()->addPermanentWidget(state_);
  connect(navigation_, &QListWidget::currentRowChanged, this, [this](int row) {
    if (row < 0) return;
    views_->setCurrentIndex(row);
  });
}

QWidget* MainWindow::start_page() {
  auto* page = new StartView;
  connect(page, &StartView::try_without_hardware, this, [this] {
    if (!may_end("Abort the run")) return;
    if (auto selected = bench_.select_device(bench_.devices().front().id); !selected)
      show_trouble(QString::fromStdString(selected.error().message), Remedy::none);
    show_view(View::measure);
  });
  connect(page, &StartView::connect_camera, this, [this] {
    show_view(View::look);
    bench_.rescan();
  });
  connect(page, &StartView::open_session, this, &MainWindow::choose_session);
  return page;
}

void MainWindow::choose_session() {
  const QString folder = QFileDialog::getExistingDirectory(this, "Open a session",
                                                           QString::fromStdString(bench_.sessions_folder().string()));
  if (!folder.isEmpty()) open_path(folder.toStdString());
}

void MainWindow::open_path(const std::filesystem::path& path) {
  std::error_code none;
  if (std::filesystem::is_directory(path, none) || path.filename() == "session.toml") {
    show_view(View::report);
    sessions_.open(path.filename() == "session.toml" ? path.parent_path() : path);
    return;
  }
  show_view(View::plan);
  plan_view_->open_plan(QString::fromStdString(path.string()));
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
  const QList<QUrl> urls = event->mimeData()->urls();
  if (urls.size() == 1 && urls.front().isLocalFile()) event->acceptProposedAction();
}

void MainWindow::dropEvent(QDropEvent* event) {
  const QList<QUrl> urls = event->mimeData()->urls();
  if (urls.size() != 1 || !urls.front().isLocalFile()) return;
  event->acceptProposedAction();
  open_path(urls.front().toLocalFile().toStdString());
}

void MainWindow::make_menu() {
  QMenu* bench = menuBar()->addMenu("&Bench");
  connect(bench->addAction("&Look for cameras"), &QAction::triggered, this, [this] { bench_.rescan(); });
  connect(bench->addAction("&Stop"), &QAction::triggered, this, [this] {
    if (may_end("Abort the run")) bench_.stop();
  });
  connect(bench->addAction("&Open a session…"), &QAction::triggered, this, &MainWindow::choose_session);
  connect(bench->addAction("S&tart page"), &QAction::triggered, this, [this] { show_view(View::start); });
  QAction* cable = bench->addAction("&Disconnect the emulated camera");
  cable->setToolTip("Switches the emulated camera off, to show how the bench handles a lost camera");
  connect(cable, &QAction::triggered, this, [this] { bench_.switch_emulated_camera_off(); });
  bench->addSeparator();
  QAction* quit = bench->addAction("&Quit");
  quit->setShortcut(QKeySequence::Quit);
  connect(quit, &QAction::triggered, this, &QWidget::close);
  QMenu* view = menuBar()->addMenu("&View");
  QMenu* help = menuBar()->addMenu("&Help");
  const auto page = [this, help](const QString& title, const QString& file, const QKeySequence& key) {
    QAction* action = help->addAction(title);
    if (!key.isEmpty()) action->setShortcut(key);
    connect(action, &QAction::triggered, this, [this, file] { show_help(file); });
  };
  page("The &window", "guide/window.md", QKeySequence::HelpContents);
  page("The first &hour", "guide/first-hour.md", {});
  page("&Connect a camera", "guide/connect-a-camera.md", {});
  page("&Write a plan", "guide/write-a-plan.md", {});
  page("&Read a report", "guide/read-a-report.md", {});
  page("&Troubleshooting", "guide/troubleshooting.md", {});
  page("&Glossary", "glossary.md", {});
  page("All &pages", "index.md", {});
  help->addSeparator();
  connect(help->addAction("&About todbench"), &QAction::triggered, this, [this] {
    QMessageBox::about(this, "About todbench",
                       QString("<p><b>todbench %1</b></p><p>Measures the TOD curve of thermal cameras with a model "
                               "observer and compares it with a simulated sensor.</p><p>Licence: GPL, version 3 or "
                               "later.</p><p>Sessions: %2</p>")
                           .arg(QApplication::applicationVersion(),
                                QString::fromStdString(bench_.sessions_folder().string()).toHtmlEscaped()));
  });
  auto* themes = new QActionGroup(this);
  for (const auto& [theme, name] : {std::pair{Theme::light, "&Light"}, std::pair{Theme::dark, "&Dark"}}) {
    QAction* action = view->addAction(name);
    action->setCheckable(true);
    action->setData(static_cast<int>(theme));
    themes->addAction(action);
    connect(action, &QAction::triggered, this, [this, chosen = theme] { set_theme(chosen); });
  }
}

void MainWindow::connect_parts() {
  connect(&bench_, &Workbench::trouble, this, &MainWindow::show_trouble);
  connect(&sessions_, &SessionPresenter::problem, this,
          [this](const QString& sentence) { show_trouble(sentence, Remedy::none); });
  connect(&bench_, &Workbench::noted, this, [this](const QString& text) { statusBar()->showMessage(text, 8000); });
  connect(&bench_, &Workbench::activity_changed, this, [this] {
    statusBar()->clearMessage();  // the message belongs to the ended activity
    if (bench_.activity() != Activity::idle) {
      last_activity_ = bench_.activity();
      message_->hide();
    }
    show_state();
  });
  // A message without a remedy asks for another value; it may have been stated now.
  connect(&bench_, &Workbench::plan_changed, this, [this] {
    if (!away_ && retry_->isHidden()) message_->hide();
  });
  connect(&bench_, &Workbench::device_selected, this, &MainWindow::show_state);
  connect(&bench_, &Workbench::devices_changed, this, &MainWindow::show_state);
  connect(retry_, &QPushButton::clicked, this, [this] {
    message_->hide();
    if (last_activity_ == Activity::measuring || last_activity_ == Activity::replaying) measure_.again();
    if (last_activity_ == Activity::aligning) align_.start();
    if (last_activity_ == Activity::looking || last_activity_ == Activity::idle) look_.start();
  });
  connect(abandon_, &QPushButton::clicked, this, &MainWindow::abort_run);
  connect(other_camera_, &QPushButton::clicked, this, [this] {
    if (!may_end("Abort the run")) return;
    measure_.abort();
    message_->hide();
    show_view(View::look);
  });
  connect(&measure_, &MeasurePresenter::updated, this, &MainWindow::show_camera_away);
  connect(&plan_, &PlanPresenter::updated, this, [this] {
    measure_.set_predicted(plan_.expected_known() ? std::optional(as_curve(plan_.expected())) : std::nullopt);
  });
  // Show the finished measurement next.
  connect(&measure_, &MeasurePresenter::finished, this, [this](const QString& folder) {
    sessions_.refresh();
    sessions_.open(folder.toStdString());
  });
  // A user who operates the bench by hand looks at the plate, not at the screen.
  connect(&measure_, &MeasurePresenter::operator_needed, this, [this] {
    QApplication::beep();
    QApplication::alert(this);
  });
  connect(&human_, &HumanPresenter::finished, this, [this](const QString& folder) {
    if (human_.problem().isEmpty()) {
      sessions_.open_and_export(folder.toStdString());
    } else {
      sessions_.open(folder.toStdString());
    }
  });
}

void MainWindow::show_trouble(const QString& sentence, Remedy remedy) {
  message_text_->setText(sentence);
  message_->setProperty("error", true);
  retry_->setVisible(remedy == Remedy::try_again);
  abandon_->hide();
  other_camera_->setVisible(remedy == Remedy::try_again && last_activity_ != Activity::replaying);
  away_ = false;
  message_->show();
}

void MainWindow::show_camera_away() {
  const QString sentence = measure_.camera_away();
  const bool stopping = measure_.state() == RunState::stopping;
  if (!sentence.isEmpty() && !stopping) {
    message_text_->setText(sentence);
    message_->setProperty("error", true);
    retry_->hide();
    abandon_->show();
    other_camera_->show();
    message_->show();
  } else if (away_) {
    message_->hide();
  }
  away_ = !sentence.isEmpty() && !stopping;
}

void MainWindow::show_state() {
  QString device = bench_.device();
  for (const auto& entry : bench_.devices()) {
    if (entry.id == bench_.device()) device = entry.label + ", " + name_of(entry.health);
  }
  state_->setText(device + "  |  " + name_of(bench_.activity()));
}

void MainWindow::show_view(View view) {
  navigation_->setCurrentRow(static_cast<int>(view));
  if (QWidget* shown = views_->currentWidget(); view == View::human && shown != nullptr) shown->setFocus();
}

View MainWindow::view() const {
  return static_cast<View>(views_->currentIndex());
}

void MainWindow::set_theme(Theme theme) {
  theme_ = theme;
  QApplication::setStyle(QStyleFactory::create("Fusion"));
  QApplication::setPalette(palette_of(theme));
  QApplication::setPalette(box_palette_of(theme), "QCheckBox");
  setStyleSheet(style_sheet(theme));
  for (QAction* action : findChildren<QAction*>()) {
    if (action->isCheckable() && action->actionGroup() != nullptr)
      action->setChecked(action->data().toInt() == static_cast<int>(theme));
  }
}

void MainWindow::recall() {
  const QSettings settings("todbench", "todbench-gui");
  first_start_ = !settings.contains("geometry");
  for (const QTableWidget* table : findChildren<QTableWidget*>()) {
    const QByteArray columns = settings.value(columns_key(*table)).toByteArray();
    if (!columns.isEmpty()) table->horizontalHeader()->restoreState(columns);
  }
  restoreGeometry(settings.value("geometry").toByteArray());
  if (settings.contains("theme")) theme_ = settings.value("theme").toInt() == 1 ? Theme::dark : Theme::light;
  const QString device = settings.value("device", emulated_laboratory).toString();
  // If the stored device no longer exists, the default one stays.
  if (!device.isEmpty() && device != bench_.device()) (void)bench_.select_device(device);
  // If this version cannot read the stored plan, the shipped one stays.
  if (const QString plan = settings.value("plan").toString(); !plan.isEmpty()) (void)plan_.apply_toml(plan);
  if (auto* colours = findChild<QComboBox*>("colourMap"))
    colours->setCurrentIndex(std::clamp(settings.value("colourMap", 0).toInt(), 0, colours->count() - 1));
}

void MainWindow::remember() {
  QSettings settings("todbench", "todbench-gui");
  settings.setValue("geometry", saveGeometry());
  for (const QTableWidget* table : findChildren<QTableWidget*>())
    settings.setValue(columns_key(*table), table->horizontalHeader()->saveState());
  settings.setValue("theme", theme_ == Theme::dark ? 1 : 0);
  settings.setValue("device", bench_.device());
  settings.setValue("plan", plan_.toml());
  if (const auto* colours = findChild<QComboBox*>("colourMap")) settings.setValue("colourMap", colours->currentIndex());
}

bool MainWindow::may_end(const QString& action) {
  QString lost = measure_.under_way();
  if (!lost.isEmpty()) {
    lost += ". Its results so far stay in the session. If the frames are recorded, the run can go on later.";
  } else if (human_.state() == HumanState::showing || human_.state() == HumanState::hidden ||
             person_.state() == HumanState::showing || person_.state() == HumanState::hidden) {
    lost = "A person is answering. The answers so far are lost; \"End now\" keeps them.";
  }
  return lost.isEmpty() || confirm_(lost, action);
}

void MainWindow::start_run() {
  const QString unused = plan_view_->unused_entry();
  if (!unused.isEmpty() && !confirm_("The plan has an entry that is not valid and not in use: " + unused,
                                     "Measure with the last valid plan"))
    return;
  measure_.start();
}

void MainWindow::abort_run() {
  if (may_end("Abort the run")) measure_.abort();
}

void MainWindow::show_help(const QString& page) {
  if (help_ == nullptr) help_ = new HelpWindow(this);
  help_->show_page(page);
}

void MainWindow::closeEvent(QCloseEvent* event) {
  if (!may_end("Quit")) {
    event->ignore();
    return;
  }
  if (memory_ == Memory::remember) remember();
  event->accept();
}

}  // namespace todbench
