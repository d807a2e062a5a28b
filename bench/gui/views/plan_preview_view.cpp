// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/plan_preview_view.h"

#include <QCheckBox>
#include <QComboBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QSignalBlocker>
#include <QSlider>
#include <QTabWidget>
#include <QTableWidget>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "bench/gui/presenters/bill_rows.h"
#include "bench/gui/presenters/plan_presenter.h"
#include "bench/gui/presenters/text_of.h"
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

/// Two significant digits, never in exponential notation.
QString change_text(double percent) {
  const double size = std::abs(percent);
  const int decimals = size >= 9.95 || size == 0 ? 0 : std::min(4, 1 - static_cast<int>(std::floor(std::log10(size))));
  return QString::number(percent, 'f', decimals) + " %";
}

}  // namespace

PlanPreviewView::PlanPreviewView(PlanPresenter& presenter, QWidget* parent) : QWidget(parent), presenter_(presenter) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(title_label("Accuracy against time"));
  auto* line = new QHBoxLayout;
  tolerance_ = new QSlider(Qt::Horizontal);
  tolerance_->setObjectName("toleranceSlider");
  tolerance_->setRange(0, slider_steps);
  tolerance_->setAccessibleName("Tolerance of S75");
  tolerance_->setToolTip(
      "Half-width of the 95 % interval of S75. It sets the number of phases, and the largest error that the "
      "simulation may have.");
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
  prices_->setMinimumSize(250, 160);
  prices_->setMaximumHeight(200);
  seen->addWidget(prices_, 1);
  contrasts_ = plain_table({"ΔT (K)", "S75 (mrad)", "± camera (%)", "± twin (%)"}, "planOutlook");
  contrasts_->setToolTip("Predicted S75, and the predicted half-width of its 95 % interval");
  contrasts_->setFixedWidth(column_widths(*contrasts_, {"-16.9", "S75 (mrad)", "± camera (%)", "± twin (%)"}));
  contrasts_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  contrasts_->setMaximumHeight(200);
  seen->addWidget(contrasts_);
  layout->addLayout(seen);
  auto* effects = new QWidget;
  auto* effects_layout = new QVBoxLayout(effects);
  effects_layout->setContentsMargins(0, 0, 0, 0);
  effects_layout->addWidget(effects_table(), 1);
  neutral_ = new QCheckBox;
  neutral_->setObjectName("neutralEffects");
  neutral_->setToolTip("A neutral effect does not change the picture with the parameters of this sensor.");
  connect(neutral_, &QCheckBox::toggled, this, &PlanPreviewView::fold_effects);
  effects_layout->addWidget(neutral_);
  bill_ = plain_table({"Part of the run", "Time (s)", "Result"}, "planBill");
  bill_->setToolTip("Predicted time of the run on the bench and the accuracy that it buys");
  column_widths(*bill_, {"Location of the plate, contrasts", "00000.0"});
  wrap_words(*bill_);
  auto* tabs = new QTabWidget;
  tabs->setObjectName("planPreviewTabs");
  tabs->setDocumentMode(true);
  tabs->addTab(effects, "Effects of the simulated sensor");
  tabs->addTab(bill_, "Bill of the run");
  layout->addWidget(tabs, 1);
  connect(tolerance_, &QSlider::valueChanged, this,
          [this](int position) { emit problem(presenter_.set_tolerance_percent(tolerance_of(position))); });
  connect(&presenter_, &PlanPresenter::updated, this, &PlanPreviewView::show_outlook);
  show_outlook();
}

QWidget* PlanPreviewView::effects_table() {
  effects_ = plain_table({"Effect", "Choice", "Decision", "If skipped", "Reason"}, "planEffects");
  column_widths(*effects_, {"temporal noise", "simulate mm", "simulated", "If skipped"});
  wrap_words(*effects_);
  effects_->setRowCount(static_cast<int>(all_effects.size()));
  int row = 0;
  for (const Effect effect : all_effects) {
    auto* box = new QComboBox;
    box->setObjectName(QString("choice_") + text_of(to_string(effect)));
    box->setAccessibleName("Choice for " + text_of(to_string(effect)).replace('_', ' '));
    box->addItems({"planner", "simulate", "skip"});
    box->setFocusPolicy(Qt::StrongFocus);
    connect(box, &QComboBox::activated, this, [this, effect](int index) {
      emit problem(presenter_.choose(effect, all_effect_choices.at(static_cast<std::size_t>(index))));
    });
    // The box keeps its height in a row with several lines of reasons.
    auto* cell = new QWidget;
    auto* middle = new QVBoxLayout(cell);
    middle->setContentsMargins(0, 0, 0, 0);
    middle->addWidget(box, 0, Qt::AlignVCenter);
    effects_->setCellWidget(row++, 1, cell);
    choices_.push_back(box);
  }
  return effects_;
}

void PlanPreviewView::show_outlook() {
  const double tolerance_percent = presenter_.plan().simulation.tolerance_percent;
  {
    const QSignalBlocker quiet(tolerance_);
    tolerance_->setValue(position_of(tolerance_percent));
  }
  tolerance_text_->setText(QString("± %1 %").arg(tolerance_percent, 0, 'g', 3));
  const PlanPreview& seen = presenter_.outlook();
  const auto uncertainty = seen.uncertainty_percent();
  const bool known = presenter_.forecast().has_value();
  cost_->setText(
      seen.contrasts.empty()
          ? QString()
          : QString("%1 presentations, %2 answers. Time on the bench: about %3. Simulated twin: about %4 on one core. "
                    "Uncertainty: %5")
                .arg(seen.presentations)
                .arg(seen.trials)
                .arg(duration_text(seen.bench_s),
                     seen.twin_s ? duration_text(*seen.twin_s)
                     : known     ? "–"
                                 : "…",
                     uncertainty ? QString("± %1 %").arg(*uncertainty, 0, 'f', 1)
                     : known     ? QString("not known, because a contrast has no threshold")
                                 : QString("being computed …")));
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
  if (Plot plot = accuracy_plot(presenter_.prices(), seen); !plot.series.empty() || seen.contrasts.empty())
    prices_->show_plot(plot);
  show_effects();
  show_bill();
}

void PlanPreviewView::show_bill() {
  fill_table(*bill_, presenter_.forecast() ? bill_rows(*presenter_.forecast()) : QList<QStringList>());
}

void PlanPreviewView::show_effects() {
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
  fold_effects();
}

/// Hides the rows of neutral effects, unless they are asked for or chosen by hand.
void PlanPreviewView::fold_effects() {
  int neutral = 0;
  for (const Effect effect : all_effects) effects_->setRowHidden(static_cast<int>(effect), false);
  if (presenter_.forecast()) {
    for (const auto& d : presenter_.forecast()->effects.decisions) {
      if (!d.changes_nothing() || presenter_.choice(d.effect) != EffectChoice::planner) continue;
      ++neutral;
      effects_->setRowHidden(static_cast<int>(d.effect), !neutral_->isChecked());
    }
  }
  neutral_->setText(neutral == 1 ? QString("Show the effect that is neutral in this sensor")
                                 : QString("Show the %1 effects that are neutral in this sensor").arg(neutral));
  neutral_->setVisible(neutral > 0);
}

}  // namespace todbench
