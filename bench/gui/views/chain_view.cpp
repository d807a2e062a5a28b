// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/chain_view.h"

#include <QCheckBox>
#include <QComboBox>
#include <QFormLayout>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QSlider>
#include <cmath>
#include <initializer_list>

#include "bench/gui/presenters/chain_presenter.h"
#include "bench/gui/presenters/colour_map.h"
#include "bench/gui/presenters/text_of.h"
#include "bench/gui/views/layout_pieces.h"
#include "bench/gui/views/picture_view.h"
#include "bench/gui/views/plain_numbers.h"
#include "bench/plan/atmospheres.h"
#include "bench/plan/resources.h"

namespace todbench {
namespace {

QString words(std::string_view name) {
  QString text = text_of(name).replace('_', ' ');
  text[0] = text[0].toUpper();
  return text;
}

/// Range of the slider, in steps of 0.5 %.
constexpr double nearest_m = 50, farthest_m = 8000;
constexpr int range_steps = 1000;

}  // namespace

ChainView::ChainView(ChainPresenter& presenter, QWidget* parent) : QWidget(parent), presenter_(presenter) {
  auto* layout = new QHBoxLayout(this);
  auto* grid = new QGridLayout;
  int place = 0;
  for (const Stage stage : all_stages) {
    // Title, picture and note have separate rows: a note of three lines then shrinks all four pictures equally.
    const int row = 3 * (place / 4), column = place % 4;
    grid->addWidget(title_label(QString("%1  %2").arg(place + 1).arg(name_of(stage))), row, column);
    auto* picture = new PictureView;
    picture->setObjectName(QString("stage%1").arg(place));
    picture->setAccessibleName(name_of(stage));
    pictures_.push_back(picture);
    grid->addWidget(picture, row + 1, column);
    grid->setRowStretch(row + 1, 1);
    QLabel* note = hint_label();
    notes_.push_back(note);
    grid->addWidget(note, row + 2, column, Qt::AlignTop);
    ++place;
  }
  for (int i = 0; i < 4; ++i) grid->setColumnStretch(i, 1);
  layout->addLayout(grid, 1);
  layout->addWidget(options_panel());
  connect(&presenter_, &ChainPresenter::updated, this, &ChainView::show_pictures);
}

QWidget* ChainView::options_panel() {
  auto* panel = new QWidget;
  panel->setFixedWidth(300);
  auto* layout = new QVBoxLayout(panel);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(title_label("Scene and sensor"));
  auto* form = form_ = new QFormLayout;
  what_ = new QComboBox;
  what_->setObjectName("chainScene");
  what_->addItem("Triangle");
  for (const auto& name : resource_names(ResourceKind::scene)) what_->addItem(QString::fromStdString(name));
  sensor_ = new QComboBox;
  sensor_->setObjectName("chainSensor");
  for (const auto& name : resource_names(ResourceKind::sensor)) sensor_->addItem(QString::fromStdString(name));
  apex_ = new QComboBox;
  for (const Apex apex : all_apexes) apex_->addItem(words(to_string(apex)));
  size_ = new PlainSpinBox;
  size_->setObjectName("chainSize");
  size_->setRange(0.3, 20);
  size_->setSingleStep(0.1);
  size_->setSuffix(" pitch");
  contrast_ = new PlainSpinBox;
  contrast_->setObjectName("chainContrast");
  contrast_->setRange(-100, 100);
  contrast_->setDecimals(3);
  contrast_->setSingleStep(0.1);
  contrast_->setSuffix(" K");
  index_ = new QSpinBox;
  index_->setRange(0, 1000000);
  size_->setValue(presenter_.options().size_pitch);
  contrast_->setValue(presenter_.options().delta_t_k);
  form->addRow("Show", what_);
  form->addRow("Sensor", sensor_);
  form->addRow("Size S", size_);
  form->addRow("Contrast ΔT", contrast_);
  form->addRow("Apex", apex_);
  form->addRow("Exposure", index_);
  add_scene_rows(*form);
  layout->addLayout(form);
  layout->addWidget(title_label("Simulated effects"));
  auto* boxes = new QGridLayout;
  boxes->setHorizontalSpacing(4);
  boxes->setVerticalSpacing(4);
  const int rows = (static_cast<int>(all_effects.size()) + 1) / 2;
  int number = 0;
  for (const Effect effect : all_effects) {
    auto* box = new QCheckBox(words(to_string(effect)));
    box->setObjectName(QString("effect_") + text_of(to_string(effect)));
    box->setChecked(true);
    effects_.emplace_back(effect, box);
    boxes->addWidget(box, number % rows, number / rows);
    ++number;
    connect(box, &QCheckBox::toggled, this, &ChainView::request);
  }
  layout->addLayout(boxes);
  problem_ = hint_label();
  layout->addWidget(problem_);
  layout->addWidget(hint_label("White is hot. All pictures show the same field with the same grey levels."));
  layout->addStretch();
  connect(what_, &QComboBox::currentIndexChanged, this, [this] {
    show_rows();
    request();
  });
  show_rows();
  connect(sensor_, &QComboBox::currentIndexChanged, this, &ChainView::request);
  connect(apex_, &QComboBox::currentIndexChanged, this, &ChainView::request);
  connect(size_, &QDoubleSpinBox::valueChanged, this, &ChainView::request);
  connect(contrast_, &QDoubleSpinBox::valueChanged, this, &ChainView::request);
  connect(index_, &QSpinBox::valueChanged, this, &ChainView::request);
  return panel;
}

void ChainView::add_scene_rows(QFormLayout& form) {
  range_ = new QSlider(Qt::Horizontal);
  range_->setObjectName("chainRange");
  range_->setAccessibleName("Range");
  range_->setRange(0, range_steps);
  range_->setValue(
      static_cast<int>(std::lround(range_steps * std::log(400 / nearest_m) / std::log(farthest_m / nearest_m))));
  range_text_ = new QLabel;
  air_ = new QComboBox;
  air_->setObjectName("chainAir");
  for (const auto& name : atmosphere_names()) {
    if (name != "beer-lambert") air_->addItem(QString::fromStdString(name));
  }
  form.addRow("Range", range_);
  form.addRow("", range_text_);
  form.addRow("Atmosphere", air_);
  connect(range_, &QSlider::valueChanged, this, &ChainView::request);
  connect(air_, &QComboBox::currentIndexChanged, this, &ChainView::request);
}

double ChainView::range_m() const {
  return nearest_m * std::pow(farthest_m / nearest_m, static_cast<double>(range_->value()) / range_steps);
}

void ChainView::show_rows() {
  const bool scene = what_->currentIndex() > 0;
  for (QWidget* of_triangle : std::initializer_list<QWidget*>{size_, contrast_, apex_, index_})
    form_->setRowVisible(of_triangle, !scene);
  for (QWidget* of_scene : std::initializer_list<QWidget*>{range_, range_text_, air_})
    form_->setRowVisible(of_scene, scene);
}

void ChainView::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  if (presenter_.pictures().empty()) request();
}

void ChainView::request() {
  ChainSettings options;
  options.sensor = sensor_->currentText().toStdString();
  options.size_pitch = size_->value();
  options.delta_t_k = contrast_->value();
  options.apex = all_apexes.at(static_cast<std::size_t>(apex_->currentIndex()));
  options.index = static_cast<std::uint64_t>(index_->value());
  for (const auto& [effect, box] : effects_) {
    if (!box->isChecked()) options.skip.push_back(effect);
  }
  if (what_->currentIndex() > 0) options.scene = what_->currentText().toStdString();
  options.atmosphere = air_->currentText().toStdString();
  options.range_m = range_m();
  range_text_->setText(QString("%1 m").arg(options.range_m, 0, 'f', 0));
  presenter_.set_options(options);
}

void ChainView::show_pictures() {
  problem_->setText(presenter_.problem());
  const double contrast = presenter_.options().delta_t_k;
  const double reach = std::max(std::abs(contrast), 0.05);
  LevelSpan level = contrast >= 0 ? LevelSpan{-0.5 * reach, 1.2 * reach} : LevelSpan{-1.2 * reach, 0.5 * reach};
  const auto& pictures = presenter_.pictures();
  if (!pictures.empty() && pictures.front().grey_k)
    level = {pictures.front().grey_k->first, pictures.front().grey_k->second};
  for (std::size_t i = 0; i < pictures_.size(); ++i) {
    const bool there = i < pictures.size();
    pictures_[i]->set_image(there ? to_image(pictures[i].kelvin, level, ColourMap::white_hot) : QImage());
    notes_[i]->setText(there ? pictures[i].note : QString());
  }
}

}  // namespace todbench
