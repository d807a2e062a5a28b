#include "bench/gui/views/chain_view.h"

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QGridLayout>
#include <QHBoxLayout>
#include <cmath>

#include "bench/gui/presenters/chain_presenter.h"
#include "bench/gui/presenters/colour_map.h"
#include "bench/gui/views/layout_pieces.h"
#include "bench/gui/views/picture_view.h"
#include "bench/plan/resources.h"

namespace todbench {
namespace {

QString words(std::string_view name) {
  QString text = QString::fromUtf8(name.data(), static_cast<qsizetype>(name.size())).replace('_', ' ');
  text[0] = text[0].toUpper();
  return text;
}

}  // namespace

ChainView::ChainView(ChainPresenter& presenter, QWidget* parent) : QWidget(parent), presenter_(presenter) {
  auto* layout = new QHBoxLayout(this);
  auto* grid = new QGridLayout;
  int place = 0;
  for (const Stage stage : all_stages) {
    auto* column = new QVBoxLayout;
    column->addWidget(title_label(QString("%1  %2").arg(place + 1).arg(name_of(stage))));
    auto* picture = new PictureView;
    picture->setObjectName(QString("stage%1").arg(place));
    picture->setAccessibleName(name_of(stage));
    pictures_.push_back(picture);
    column->addWidget(picture, 1);
    QLabel* note = hint_label();
    notes_.push_back(note);
    column->addWidget(note);
    grid->addLayout(column, place / 4, place % 4);
    ++place;
  }
  for (int i = 0; i < 4; ++i) grid->setColumnStretch(i, 1);
  layout->addLayout(grid, 1);
  layout->addWidget(options_panel());
  connect(&presenter_, &ChainPresenter::updated, this, &ChainView::show_pictures);
}

QWidget* ChainView::options_panel() {
  auto* panel = new QWidget;
  panel->setFixedWidth(230);
  auto* layout = new QVBoxLayout(panel);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(title_label("Triangle and sensor"));
  auto* form = new QFormLayout;
  sensor_ = new QComboBox;
  sensor_->setObjectName("chainSensor");
  for (const auto& name : resource_names(ResourceKind::sensor)) sensor_->addItem(QString::fromStdString(name));
  apex_ = new QComboBox;
  for (const Apex apex : all_apexes) apex_->addItem(words(to_string(apex)));
  size_ = new QDoubleSpinBox;
  size_->setObjectName("chainSize");
  size_->setRange(0.3, 20);
  size_->setSingleStep(0.1);
  size_->setSuffix(" pitch");
  contrast_ = new QDoubleSpinBox;
  contrast_->setObjectName("chainContrast");
  contrast_->setRange(-100, 100);
  contrast_->setDecimals(3);
  contrast_->setSingleStep(0.1);
  contrast_->setSuffix(" K");
  index_ = new QSpinBox;
  index_->setRange(0, 1000000);
  size_->setValue(presenter_.options().size_pitch);
  contrast_->setValue(presenter_.options().delta_t_k);
  form->addRow("Sensor", sensor_);
  form->addRow("Size S", size_);
  form->addRow("Contrast ΔT", contrast_);
  form->addRow("Apex", apex_);
  form->addRow("Exposure", index_);
  layout->addLayout(form);
  layout->addWidget(title_label("Simulate"));
  for (const Effect effect : all_effects) {
    auto* box = new QCheckBox(words(to_string(effect)));
    box->setObjectName(QString("effect_") + QString::fromUtf8(to_string(effect).data()));
    box->setChecked(true);
    effects_.emplace_back(effect, box);
    layout->addWidget(box);
    connect(box, &QCheckBox::toggled, this, &ChainView::request);
  }
  problem_ = hint_label();
  layout->addWidget(problem_);
  layout->addWidget(hint_label("White is hot. All pictures show the same square at the same grey levels."));
  layout->addStretch();
  connect(sensor_, &QComboBox::currentIndexChanged, this, &ChainView::request);
  connect(apex_, &QComboBox::currentIndexChanged, this, &ChainView::request);
  connect(size_, &QDoubleSpinBox::valueChanged, this, &ChainView::request);
  connect(contrast_, &QDoubleSpinBox::valueChanged, this, &ChainView::request);
  connect(index_, &QSpinBox::valueChanged, this, &ChainView::request);
  return panel;
}

void ChainView::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  if (presenter_.pictures().empty()) request();
}

void ChainView::request() {
  ChainOptions options;
  options.sensor = sensor_->currentText().toStdString();
  options.size_pitch = size_->value();
  options.delta_t_k = contrast_->value();
  options.apex = all_apexes.at(static_cast<std::size_t>(apex_->currentIndex()));
  options.index = static_cast<std::uint64_t>(index_->value());
  for (const auto& [effect, box] : effects_) {
    if (!box->isChecked()) options.skip.push_back(effect);
  }
  presenter_.set_options(options);
}

void ChainView::show_pictures() {
  problem_->setText(presenter_.problem());
  const double contrast = presenter_.options().delta_t_k;
  const double reach = std::max(std::abs(contrast), 0.05);
  const LevelSpan level = contrast >= 0 ? LevelSpan{-0.5 * reach, 1.2 * reach} : LevelSpan{-1.2 * reach, 0.5 * reach};
  const auto& pictures = presenter_.pictures();
  for (std::size_t i = 0; i < pictures.size() && i < pictures_.size(); ++i) {
    pictures_[i]->set_image(to_image(pictures[i].kelvin, level, ColourMap::white_hot));
    notes_[i]->setText(pictures[i].note);
  }
}

}  // namespace todbench
