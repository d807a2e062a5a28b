#include "bench/gui/views/plan_view.h"

#include <QComboBox>
#include <QFileDialog>
#include <QFontDatabase>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLineEdit>
#include <QPlainTextEdit>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QSlider>
#include <QTabWidget>
#include <cmath>

#include "bench/gui/presenters/plan_presenter.h"
#include "bench/gui/views/layout_pieces.h"
#include "bench/gui/views/plot_view.h"

namespace todbench {
namespace {

// The slider is logarithmic: 0.5 % to 20 %.
constexpr double least_tolerance = 0.5, largest_tolerance = 20;
constexpr int slider_steps = 100;

double tolerance_of(int position) {
  return least_tolerance * std::pow(largest_tolerance / least_tolerance, static_cast<double>(position) / slider_steps);
}
int position_of(double tolerance) {
  return static_cast<int>(std::lround(slider_steps * std::log(tolerance / least_tolerance) /
                                      std::log(largest_tolerance / least_tolerance)));
}

QString duration_text(double seconds) {
  const int whole = static_cast<int>(std::lround(seconds));
  if (whole < 120) return QString("%1 s").arg(whole);
  if (whole < 7200) return QString("%1 min").arg(whole / 60);
  return QString("%1 h %2 min").arg(whole / 3600).arg(whole % 3600 / 60);
}

QString text_of(std::string_view text) {
  return QString::fromUtf8(text.data(), static_cast<qsizetype>(text.size()));
}

/// Two significant digits, never as a power of ten.
QString change_text(double percent) {
  const double size = std::abs(percent);
  const int decimals = size >= 9.95 || size == 0 ? 0 : std::min(4, 1 - static_cast<int>(std::floor(std::log10(size))));
  return QString::number(percent, 'f', decimals) + " %";
}

}  // namespace

PlanView::PlanView(PlanPresenter& presenter, QWidget* parent) : QWidget(parent), presenter_(presenter) {
  auto* layout = new QHBoxLayout(this);
  auto* left = new QVBoxLayout;
  tabs_ = new QTabWidget;
  tabs_->setObjectName("planTabs");
  tabs_->addTab(form_page(), "Form");
  tabs_->addTab(toml_page(), "TOML");
  left->addWidget(tabs_, 1);
  problem_ = new QLabel;
  problem_->setObjectName("planProblem");
  problem_->setWordWrap(true);
  left->addWidget(problem_);
  auto* buttons = new QHBoxLayout;
  auto* open = plain_button("Open…", "openPlan");
  auto* save = plain_button("Save as…", "savePlan");
  auto* demo = plain_button("Demonstration plan", "demoPlan");
  for (QPushButton* button : {open, save, demo}) buttons->addWidget(button);
  buttons->addStretch();
  left->addLayout(buttons);
  layout->addLayout(left, 1);
  layout->addWidget(outlook_panel(), 1);
  connect(open, &QPushButton::clicked, this, [this] {
    const QString file = QFileDialog::getOpenFileName(this, "Open a plan", {}, "Plans (*.toml)");
    if (!file.isEmpty()) complain(presenter_.load(file));
  });
  connect(save, &QPushButton::clicked, this, [this] {
    const QString file = QFileDialog::getSaveFileName(this, "Save the plan", "plan.toml", "Plans (*.toml)");
    if (!file.isEmpty()) complain(presenter_.save(file));
  });
  connect(demo, &QPushButton::clicked, this, [this] { complain(presenter_.load("demo")); });
  connect(&presenter_, &PlanPresenter::updated, this, [this] {
    show_plan();
    show_outlook();
  });
  show_plan();
  show_outlook();
}

QWidget* PlanView::form_page() {
  auto* content = new QWidget;
  auto* form = new QFormLayout(content);
  form->setFieldGrowthPolicy(QFormLayout::AllNonFixedFieldsGrow);
  std::vector<PlanField> fields = plan_fields();
  for (PlanField& field : fields) {
    auto* edit = new QLineEdit;
    edit->setObjectName(field.object_name);
    edit->setToolTip(field.tool_tip);
    form->addRow(field.label, edit);
    connect(edit, &QLineEdit::editingFinished, this, [this, index = lines_.size()] { enter(lines_[index]); });
    lines_.push_back({edit, std::move(field)});
  }
  auto* scroll = new QScrollArea;
  scroll->setWidgetResizable(true);
  scroll->setFrameShape(QFrame::NoFrame);
  scroll->setWidget(content);
  return scroll;
}

QWidget* PlanView::toml_page() {
  auto* page = new QWidget;
  auto* layout = new QVBoxLayout(page);
  toml_ = new QPlainTextEdit;
  toml_->setObjectName("planToml");
  toml_->setFont(QFontDatabase::systemFont(QFontDatabase::FixedFont));
  toml_->setTabChangesFocus(true);
  layout->addWidget(toml_, 1);
  auto* apply = primary_button("Use this plan", "applyToml");
  layout->addWidget(apply, 0, Qt::AlignLeft);
  connect(apply, &QPushButton::clicked, this, [this] { complain(presenter_.apply_toml(toml_->toPlainText())); });
  return page;
}

QWidget* PlanView::outlook_panel() {
  auto* panel = new QWidget;
  auto* layout = new QVBoxLayout(panel);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(title_label("Accuracy against time"));
  auto* line = new QHBoxLayout;
  tolerance_ = new QSlider(Qt::Horizontal);
  tolerance_->setObjectName("toleranceSlider");
  tolerance_->setRange(0, slider_steps);
  tolerance_->setAccessibleName("Tolerance of the 75 % size");
  tolerance_->setToolTip(
      "Sets the number of phases so that the 95 % interval is this narrow, and what the simulation may "
      "be wrong by.");
  tolerance_text_ = new QLabel;
  tolerance_text_->setMinimumWidth(fontMetrics().horizontalAdvance("± 00.00 %"));
  line->addWidget(new QLabel("Tolerance"));
  line->addWidget(tolerance_, 1);
  line->addWidget(tolerance_text_);
  layout->addLayout(line);
  cost_ = new QLabel;
  cost_->setObjectName("planCost");
  cost_->setWordWrap(true);
  layout->addWidget(cost_);
  misfit_ = new QLabel;
  misfit_->setObjectName("planMisfit");
  misfit_->setWordWrap(true);
  layout->addWidget(misfit_);
  auto* seen = new QHBoxLayout;
  prices_ = new PlotView;
  prices_->setObjectName("accuracyPlot");
  prices_->setMinimumHeight(175);
  prices_->setMaximumHeight(230);
  seen->addWidget(prices_, 1);
  contrasts_ = plain_table({"ΔT (K)", "S75 (mrad)", "± camera (%)", "± twin (%)"}, "planOutlook");
  contrasts_->setToolTip("What the first tier lets expect, and half of the 95 % interval of S75");
  const std::vector<int> widths{46, 74, 90};
  for (std::size_t i = 0; i < widths.size(); ++i) contrasts_->setColumnWidth(static_cast<int>(i), widths[i]);
  contrasts_->setFixedWidth(300);
  contrasts_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  contrasts_->setMaximumHeight(230);
  seen->addWidget(contrasts_);
  layout->addLayout(seen);
  layout->addWidget(title_label("Effects of the simulated sensor"));
  layout->addWidget(effects_table(), 1);
  reason_ = hint_label();
  reason_->setObjectName("effectReason");
  layout->addWidget(reason_);
  connect(tolerance_, &QSlider::valueChanged, this,
          [this](int position) { complain(presenter_.set_tolerance_percent(tolerance_of(position))); });
  return panel;
}

QWidget* PlanView::effects_table() {
  effects_ = plain_table({"Effect", "Choice", "Decision", "Change if skipped", "Reason"}, "planEffects");
  const std::vector<int> widths{115, 104, 72, 118};
  for (std::size_t i = 0; i < widths.size(); ++i) effects_->setColumnWidth(static_cast<int>(i), widths[i]);
  effects_->setRowCount(static_cast<int>(all_effects.size()));
  int row = 0;
  for (const Effect effect : all_effects) {
    auto* box = new QComboBox;
    box->setObjectName(QString("choice_") + text_of(to_string(effect)));
    box->setAccessibleName("Choice for " + text_of(to_string(effect)).replace('_', ' '));
    box->addItems({"planner", "simulate", "skip"});
    box->setFocusPolicy(Qt::StrongFocus);
    connect(box, &QComboBox::activated, this, [this, effect](int index) {
      complain(presenter_.choose(effect, all_effect_choices.at(static_cast<std::size_t>(index))));
    });
    effects_->setCellWidget(row++, 1, box);
    choices_.push_back(box);
  }
  connect(effects_, &QTableWidget::itemSelectionChanged, this, &PlanView::show_reason);
  return effects_;
}

void PlanView::enter(const Line& line) {
  Plan plan = presenter_.plan();
  if (line.edit->text() == line.field.shown(plan)) return;
  const QString wrong = line.field.entered(plan, line.edit->text().trimmed());
  complain(wrong.isEmpty() ? presenter_.apply(plan) : wrong);
}

void PlanView::complain(const QString& sentence) {
  problem_->setText(sentence.isEmpty() ? QString() : "✗ " + sentence);
}

void PlanView::show_plan() {
  const Plan& plan = presenter_.plan();
  for (const auto& line : lines_) {
    if (!line.edit->hasFocus() || !line.edit->isModified()) line.edit->setText(line.field.shown(plan));
  }
  if (const QString text = presenter_.toml(); text != toml_->toPlainText()) toml_->setPlainText(text);
  const QSignalBlocker quiet(tolerance_);
  tolerance_->setValue(position_of(plan.simulation.tolerance_percent));
  tolerance_text_->setText(QString("± %1 %").arg(plan.simulation.tolerance_percent, 0, 'g', 3));
}

void PlanView::show_outlook() {
  const PlanOutlook& seen = presenter_.outlook();
  const auto uncertainty = seen.uncertainty_percent();
  const bool known = presenter_.forecast().has_value();
  cost_->setText(
      QString("%1 presentations, %2 answers. On the bench about %3, the simulated twin about %4 on one core. "
              "Uncertainty %5")
          .arg(seen.presentations)
          .arg(seen.trials)
          .arg(duration_text(seen.bench_s),
               seen.twin_s ? duration_text(*seen.twin_s)
               : known     ? "–"
                           : "…",
               uncertainty ? QString("± %1 %").arg(*uncertainty, 0, 'f', 1)
               : known     ? QString("not known: a contrast has no threshold")
                           : QString("is being computed …")));
  const QStringList warnings = presenter_.warnings();
  misfit_->setText(!presenter_.misfit().isEmpty() ? "✗ " + presenter_.misfit()
                   : !warnings.isEmpty()          ? "⚠ " + warnings.join("; ")
                                                  : QString());
  misfit_->setVisible(!misfit_->text().isEmpty());
  QList<QStringList> rows;
  const auto percent = [](const std::optional<double>& value) {
    return value ? QString::number(*value, 'f', 1) : QString("–");
  };
  for (const auto& c : seen.contrasts) {
    rows << QStringList{QString::number(c.delta_t_k, 'g', 8), c.s75_mrad ? QString::number(*c.s75_mrad, 'f', 3) : "–",
                        percent(c.camera_uncertainty_percent), percent(c.twin_uncertainty_percent)};
  }
  fill_table(*contrasts_, rows);
  if (Plot plot = accuracy_plot(presenter_.prices(), seen); !plot.series.empty()) prices_->show_plot(plot);
  show_effects();
}

void PlanView::show_effects() {
  QList<QStringList> rows;
  for (const Effect effect : all_effects) rows << QStringList{text_of(to_string(effect)).replace('_', ' ')};
  if (presenter_.forecast()) {
    for (const auto& d : presenter_.forecast()->effects.decisions) {
      rows[static_cast<qsizetype>(d.effect)]
          << QString() << (d.decision == Decision::simulate ? "simulated" : "skipped")
          << (d.predicted_change_percent ? change_text(*d.predicted_change_percent) : "–")
          << QString::fromStdString(d.reason);
    }
  }
  fill_table(*effects_, rows);
  for (std::size_t i = 0; i < choices_.size(); ++i)
    choices_[i]->setCurrentIndex(static_cast<int>(presenter_.choice(all_effects[i])));
  show_reason();
}

void PlanView::show_reason() {
  const auto selected = effects_->selectionModel()->selectedRows();
  const int row = selected.isEmpty() ? 0 : selected.front().row();
  const QTableWidgetItem *name = effects_->item(row, 0), *reason = effects_->item(row, 4);
  reason_->setText(name == nullptr || reason == nullptr ? QString() : name->text() + ": " + reason->text());
}

}  // namespace todbench
