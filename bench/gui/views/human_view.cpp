#include "bench/gui/views/human_view.h"

#include <QCheckBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QKeyEvent>
#include <QSpinBox>

#include "bench/gui/presenters/human_presenter.h"
#include "bench/gui/presenters/measure_presenter.h"
#include "bench/gui/views/layout_pieces.h"
#include "bench/gui/views/picture_view.h"
#include "bench/report/number_format.h"
#include "bench/report/tod_figures.h"

namespace todbench {

HumanView::HumanView(Workbench& bench, HumanPresenter& presenter, MeasurePresenter& measured, QWidget* parent)
    : QWidget(parent), bench_(bench), presenter_(presenter), measured_(measured) {
  setFocusPolicy(Qt::StrongFocus);
  auto* layout = new QHBoxLayout(this);
  picture_ = new PictureView;
  picture_->setObjectName("humanPicture");
  picture_->setFocusPolicy(Qt::NoFocus);
  // The grey of the surround of every patch: the eye adapts to one luminance.
  picture_->set_surround(QColor(128, 128, 128));
  picture_->setToolTip({});
  layout->addWidget(picture_, 1);
  auto* panel = new QWidget;
  panel->setFixedWidth(290);
  auto* side = new QVBoxLayout(panel);
  side->setContentsMargins(0, 0, 0, 0);
  side->addWidget(title_label("Which way does it point?"));
  side->addWidget(
      hint_label("Answer with the arrow keys. There is no feedback; guess when you do not see it. You judge "
                 "the camera's own frames, and do not see what the model answered."));
  auto* form = new QFormLayout;
  per_size_ = new QSpinBox;
  per_size_->setObjectName("humanPerSize");
  per_size_->setRange(1, 200);
  per_size_->setValue(8);
  limited_ = new QCheckBox("Limited time");
  shown_ms_ = new QSpinBox;
  shown_ms_->setRange(50, 10000);
  shown_ms_->setValue(1000);
  shown_ms_->setSuffix(" ms");
  shown_ms_->setAccessibleName("Time that a patch is shown");
  shown_ms_->setEnabled(false);
  form->addRow("Patches per size", per_size_);
  form->addRow(limited_, shown_ms_);
  side->addLayout(form);
  begin_ = primary_button("Begin", "beginHuman");
  abort_ = plain_button("End now", "endHuman");
  for (QPushButton* button : {begin_, abort_}) {
    button->setFocusPolicy(Qt::TabFocus);
    side->addWidget(button);
  }
  progress_ = new QLabel;
  progress_->setObjectName("humanProgress");
  progress_->setWordWrap(true);
  side->addWidget(progress_);
  result_ = new QLabel;
  result_->setObjectName("humanResult");
  result_->setWordWrap(true);
  result_->setTextFormat(Qt::RichText);
  side->addWidget(result_);
  side->addStretch();
  layout->addWidget(panel);
  connect(limited_, &QCheckBox::toggled, shown_ms_, &QWidget::setEnabled);
  connect(begin_, &QPushButton::clicked, this, &HumanView::begin);
  connect(abort_, &QPushButton::clicked, &presenter_, &HumanPresenter::abort);
  connect(&presenter_, &HumanPresenter::updated, this, &HumanView::show_state);
  connect(&measured_, &MeasurePresenter::state_changed, this, &HumanView::show_state);
  show_state();
}

void HumanView::begin() {
  HumanOptions options;
  options.per_size = per_size_->value();
  if (limited_->isChecked()) options.shown_ms = shown_ms_->value();
  options.seed = bench_.plan().seed;
  const QString problem = presenter_.begin(measured_.trials(), bench_.plan(), measured_.folder(), options);
  if (!problem.isEmpty()) emit bench_.trouble(problem);
  setFocus();
}

void HumanView::keyPressEvent(QKeyEvent* event) {
  switch (event->key()) {
    case Qt::Key_Up:
      presenter_.answer(Apex::up);
      return;
    case Qt::Key_Right:
      presenter_.answer(Apex::right);
      return;
    case Qt::Key_Down:
      presenter_.answer(Apex::down);
      return;
    case Qt::Key_Left:
      presenter_.answer(Apex::left);
      return;
    default:
      QWidget::keyPressEvent(event);
  }
}

void HumanView::show_state() {
  const HumanState state = presenter_.state();
  const bool running = state == HumanState::showing || state == HumanState::hidden;
  const bool ready = measured_.state() == RunState::idle && measured_.outcome() && !measured_.trials().empty();
  begin_->setEnabled(ready && !running);
  abort_->setEnabled(running);
  picture_->set_placeholder(state == HumanState::hidden ? "Which way did it point?"
                            : running                   ? ""
                            : ready                     ? "Begin when you sit well."
                                                        : "Measure first: a person judges the frames of that run.");
  // A fixed number of screen pixels per sample: nothing about the size of the window changes what is seen.
  picture_->set_image(state == HumanState::showing ? presenter_.picture() : QImage());
  picture_->set_zoom(1);
  progress_->setText(running ? QString("%1 of %2").arg(presenter_.done()).arg(presenter_.planned()) : QString());
  if (!presenter_.record() || running) {
    result_->setText(presenter_.problem());
    return;
  }
  QString rows;
  for (const auto& point : presenter_.record()->curve.points) {
    const TodPoint* model = measured_.measured() ? point_at(*measured_.measured(), point.set_delta_t_k) : nullptr;
    rows += QString("<tr><td>%1 K&nbsp;</td><td>%2&nbsp;</td><td>%3</td></tr>")
                .arg(point.set_delta_t_k)
                .arg(QString::fromStdString(with_interval(point.fit.threshold, point.fit.ci95)))
                .arg(model == nullptr ? QString("–")
                                      : QString::fromStdString(with_interval(model->fit.threshold, model->fit.ci95)));
  }
  result_->setText("<p>" + presenter_.problem() +
                   "</p><table cellspacing=4><tr><th>ΔT</th><th>S75 human (mrad)</th><th>model (mrad)</th></tr>" +
                   rows + "</table>");
}

}  // namespace todbench
