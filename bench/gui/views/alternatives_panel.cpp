// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/alternatives_panel.h"

#include <QGridLayout>
#include <QIcon>
#include <QPixmap>
#include <QToolButton>
#include <algorithm>

#include "bench/gui/presenters/person_presenter.h"

namespace todbench {
namespace {

constexpr int most_columns = 8;
/// Width for the icons in the smallest window, 1280 points: the list of views and the side panel stand beside them.
constexpr int panel_width_px = 780;

/// Key shown before the name: "1" to "9", then "a", "b", ...
QString key_of_alternative(int alternative) {
  return alternative < 9 ? QString::number(alternative + 1) : QString(QChar('a' + alternative - 9));
}

}  // namespace

AlternativesPanel::AlternativesPanel(QWidget* parent) : QWidget(parent), grid_(new QGridLayout(this)) {
  setObjectName("alternatives");
  grid_->setContentsMargins(0, 0, 0, 0);
  grid_->setSpacing(4);
}

void AlternativesPanel::set_alternatives(const PersonExperiment& experiment) {
  clear();
  const auto count = static_cast<int>(experiment.alternatives().size());
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    auto* button = new QToolButton;
    button->setObjectName("alternative" + QString::number(i));
    const QImage icon = icon_image(experiment.icons()[at]);
    button->setIcon(QIcon(QPixmap::fromImage(icon)));
    button->setIconSize(count > 16 ? icon.size() * 3 / 4 : icon.size());
    const QString name = QString::fromStdString(experiment.alternatives()[at]);
    button->setText(count == 2 ? name : key_of_alternative(i) + "  " + name);
    button->setToolTip(name);
    button->setToolButtonStyle(Qt::ToolButtonTextUnderIcon);
    button->setFocusPolicy(Qt::NoFocus);  // the page handles the keys
    connect(button, &QToolButton::clicked, this, [this, i] { emit chosen(i); });
    buttons_.push_back(button);
  }
  int widest = 1;
  for (const QToolButton* button : buttons_) widest = std::max(widest, button->sizeHint().width());
  const int columns = std::clamp(panel_width_px / (widest + grid_->spacing()), 1, most_columns);
  for (int i = 0; i < count; ++i)
    grid_->addWidget(buttons_[static_cast<std::size_t>(i)], i / columns, i % columns, Qt::AlignCenter);
}

void AlternativesPanel::clear() {
  for (QToolButton* button : buttons_) {
    grid_->removeWidget(button);
    button->hide();
    button->deleteLater();  // the button may be the sender of the current click
  }
  buttons_.clear();
}

int AlternativesPanel::of_key(int key) const {
  const auto count = static_cast<int>(buttons_.size());
  int alternative = -1;
  if (count == 2 && (key == Qt::Key_Left || key == Qt::Key_Right)) alternative = key == Qt::Key_Left ? 0 : 1;
  if (key >= Qt::Key_1 && key <= Qt::Key_9) alternative = key - Qt::Key_1;
  if (key >= Qt::Key_A && key <= Qt::Key_Z) alternative = 9 + key - Qt::Key_A;
  return alternative < count ? alternative : -1;
}

}  // namespace todbench
