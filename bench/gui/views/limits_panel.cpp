// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/limits_panel.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <utility>

#include "bench/gui/presenters/plan_advice.h"
#include "bench/gui/presenters/workbench.h"
#include "bench/gui/views/layout_pieces.h"

namespace todbench {

LimitsPanel::LimitsPanel(Workbench& bench, QWidget* parent)
    : QWidget(parent),
      bench_(bench),
      advice_(new PlanAdvice(limits_advice, "What limits the acuity at each contrast is being calculated.", this)),
      text_(hint_label()),
      button_(plain_button("Stop", "stopLimits")) {
  text_->setObjectName("acuityLimits");
  text_->setTextFormat(Qt::RichText);
  button_->setFocusPolicy(Qt::TabFocus);
  auto* layout = new QHBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(text_, 1);
  layout->addWidget(button_, 0, Qt::AlignTop);
  connect(advice_, &PlanAdvice::updated, this, &LimitsPanel::show_advice);
  connect(button_, &QPushButton::clicked, this, [this] {
    stopped_ = advice_->busy();
    if (stopped_)
      advice_->stop();
    else
      ask();
  });
  connect(&bench_, &Workbench::plan_changed, this, &LimitsPanel::follow_plan);
}

void LimitsPanel::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  follow_plan();
}

void LimitsPanel::hideEvent(QHideEvent* event) {
  QWidget::hideEvent(event);
  if (!advice_->busy()) return;
  advice_->stop();
  asked_.reset();
}

void LimitsPanel::set_replayed_plan(std::optional<Plan> plan) {
  replayed_ = std::move(plan);
  follow_plan();
}

const Plan& LimitsPanel::plan() const {
  return replayed_ ? *replayed_ : bench_.plan();
}

void LimitsPanel::follow_plan() {
  if (isVisible() && asked_ != plan()) ask();
}

void LimitsPanel::ask() {
  asked_ = plan();
  stopped_ = false;
  advice_->ask(*asked_);
}

void LimitsPanel::show_advice() {
  text_->setText(advice_->words());
  button_->setText(advice_->busy() ? "Stop" : "Calculate");
  button_->setVisible(advice_->busy() || stopped_);
}

}  // namespace todbench
