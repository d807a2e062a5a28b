// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/look_view.h"

#include <QCheckBox>
#include <QComboBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLineEdit>
#include <QPainter>
#include <QSignalBlocker>
#include <QTreeWidget>

#include "bench/gui/presenters/look_presenter.h"
#include "bench/gui/presenters/text_of.h"
#include "bench/gui/views/histogram_view.h"
#include "bench/gui/views/layout_pieces.h"
#include "bench/gui/views/picture_view.h"
#include "bench/gui/views/plain_numbers.h"

namespace todbench {
namespace {

/// A fraction to six digits: cameras report 30.00030000300003 for 30 Hz.
QString setting_text(const std::string& value) {
  const QString text = QString::fromStdString(value);
  bool number = false;
  const double parsed = text.toDouble(&number);
  return number && text.contains('.') && text.size() > 7 ? QString::number(parsed, 'g', 6) : text;
}

QIcon badge(DeviceHealth health) {
  // Colour and shape: a disc is ready, a ring in use, a cross lost.
  QPixmap pixmap(16, 16);
  pixmap.fill(Qt::transparent);
  QPainter painter(&pixmap);
  painter.setRenderHint(QPainter::Antialiasing);
  switch (health) {
    case DeviceHealth::ready:
      painter.setPen(Qt::NoPen);
      painter.setBrush(QColor(0, 158, 115));
      painter.drawEllipse(3, 3, 10, 10);
      break;
    case DeviceHealth::in_use:
      painter.setPen(QPen(QColor(230, 159, 0), 3));
      painter.drawEllipse(4, 4, 8, 8);
      break;
    case DeviceHealth::lost:
      painter.setPen(QPen(QColor(213, 94, 0), 3));
      painter.drawLine(4, 4, 12, 12);
      painter.drawLine(12, 4, 4, 12);
      break;
  }
  return pixmap;
}

}  // namespace

LookView::LookView(Workbench& bench, LookPresenter& presenter, QWidget* parent)
    : QWidget(parent), bench_(bench), presenter_(presenter) {
  auto* layout = new QHBoxLayout(this);
  layout->addWidget(device_panel());
  auto* middle = new QVBoxLayout;
  picture_ = new PictureView;
  picture_->setObjectName("livePicture");
  picture_->set_placeholder("Choose a camera and start its live picture.");
  middle->addWidget(picture_, 1);
  auto* line = new QHBoxLayout;
  reading_ = new QLabel("Point at a pixel to read its value.");
  reading_->setObjectName("pixelReading");
  counters_ = new QLabel(presenter_.counters());
  counters_->setObjectName("frameCounters");
  line->addWidget(reading_);
  line->addStretch();
  line->addWidget(counters_);
  middle->addLayout(line);
  layout->addLayout(middle, 1);
  layout->addWidget(display_panel());
  connect(&bench_, &Workbench::devices_changed, this, &LookView::list_devices);
  // Queued, because the tree itself may have selected the device.
  connect(&bench_, &Workbench::device_selected, this, &LookView::list_devices, Qt::QueuedConnection);
  connect(&bench_, &Workbench::activity_changed, this, &LookView::show_activity);
  connect(&presenter_, &LookPresenter::updated, this, &LookView::show_frame);
  connect(&presenter_, &LookPresenter::controls_changed, this, &LookView::show_controls);
  connect(picture_, &PictureView::hovered, this, &LookView::show_reading);
  list_devices();
  show_controls();
  show_activity();
}

QWidget* LookView::device_panel() {
  auto* panel = new QWidget;
  panel->setFixedWidth(250);
  auto* layout = new QVBoxLayout(panel);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(title_label("Cameras"));
  devices_ = new QTreeWidget;
  devices_->setObjectName("deviceTree");
  devices_->setWordWrap(true);
  devices_->setHeaderHidden(true);
  devices_->setRootIsDecorated(false);
  devices_->setIndentation(10);
  devices_->setAccessibleName("Cameras");
  layout->addWidget(devices_, 1);
  camera_ = hint_label();
  layout->addWidget(camera_);
  layout->addWidget(controls_panel());
  start_ = primary_button("Start live picture", "startLooking");
  rescan_ = plain_button("Look for cameras", "rescan");
  layout->addWidget(start_);
  layout->addWidget(rescan_);
  connect(devices_, &QTreeWidget::currentItemChanged, this, [this](QTreeWidgetItem* item) {
    const QString id = item == nullptr ? QString() : item->data(0, Qt::UserRole).toString();
    if (id.isEmpty() || id == bench_.device()) return;
    if (auto selected = bench_.select_device(id); !selected)
      emit bench_.trouble(QString::fromStdString(selected.error().message), Remedy::none);
  });
  connect(start_, &QPushButton::clicked, this, [this] {
    if (bench_.activity() == Activity::looking) {
      presenter_.stop();
    } else {
      presenter_.start();
    }
  });
  connect(rescan_, &QPushButton::clicked, this, [this] { bench_.rescan(); });
  return panel;
}

QWidget* LookView::controls_panel() {
  auto* panel = new QWidget;
  auto* layout = new QVBoxLayout(panel);
  layout->setContentsMargins(0, 0, 0, 0);
  auto* form = new QFormLayout;
  form->setVerticalSpacing(3);
  for (const CameraControl control : all_camera_controls) {
    const QString name = text_of(to_string(control));
    auto* line = new QLineEdit;
    line->setObjectName("camera" + QString(name).remove(' '));
    line->setAccessibleName(name);
    form->addRow(name, line);
    const std::size_t row = controls_.size();
    controls_.push_back(line);
    connect(line, &QLineEdit::editingFinished, this, [this, line, row] {
      if (row >= presenter_.controls().size()) return;
      const ControlReading& reading = presenter_.controls()[row];
      if (line->text().trimmed() == setting_text(reading.value)) return;
      presenter_.change(reading.feature, line->text().trimmed().toStdString());
    });
  }
  layout->addLayout(form);
  auto* buttons = new QHBoxLayout;
  correct_ = plain_button("Correct", "correctNow");
  correct_->setToolTip("Commands a non-uniformity correction now");
  snapshot_ = plain_button("Snapshot", "takeSnapshot");
  snapshot_->setToolTip("Writes the latest frame as a TIFF of 16 bits beside the sessions");
  record_ = plain_button("Record", "recordFrames");
  record_->setToolTip("Records every frame beside the sessions; the recording can be measured like a camera");
  buttons->setSpacing(4);
  for (QPushButton* button : {correct_, snapshot_, record_}) buttons->addWidget(button);
  layout->addLayout(buttons);
  connect(correct_, &QPushButton::clicked, this, [this] { presenter_.correct(); });
  connect(snapshot_, &QPushButton::clicked, this, [this] {
    const auto file = presenter_.snapshot();
    if (file) {
      emit bench_.noted("Snapshot: " + QString::fromStdString(file->string()));
    } else {
      emit bench_.trouble(QString::fromStdString(file.error().message), Remedy::none);
    }
  });
  connect(record_, &QPushButton::clicked, this, [this] { presenter_.toggle_recording(); });
  return panel;
}

void LookView::show_controls() {
  const bool looking = !presenter_.controls().empty();
  for (std::size_t i = 0; i < controls_.size(); ++i) {
    QLineEdit& line = *controls_[i];
    const ControlReading reading = looking ? presenter_.controls()[i] : ControlReading{};
    line.setEnabled(!reading.feature.empty());
    line.setText(setting_text(reading.value));
    line.setToolTip(!looking ? QString("Start the live picture to read the settings of the camera.")
                    : reading.feature.empty()
                        ? QString("The camera has no feature with a known name for this. Set a feature by its name in "
                                  "the plan: [camera] settings.")
                        : "Feature " + QString::fromStdString(reading.feature) + " of the camera");
  }
  for (QPushButton* button : {correct_, snapshot_, record_}) button->setEnabled(looking);
  record_->setText(presenter_.recording() ? "End" : "Record");
}

QWidget* LookView::display_panel() {
  auto* panel = new QWidget;
  panel->setFixedWidth(220);
  auto* layout = new QVBoxLayout(panel);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(title_label("Display"));
  auto* form = new QFormLayout;
  colours_ = new QComboBox;
  colours_->setObjectName("colourMap");
  for (const auto map : all_colour_maps) colours_->addItem(name_of(map));
  mode_ = new QComboBox;
  mode_->setObjectName("levelMode");
  mode_->addItems({"Automatic", "Fixed"});
  colours_->setAccessibleName("Colours");
  mode_->setAccessibleName("Level");
  level_ = new PlainSpinBox;
  span_ = new PlainSpinBox;
  level_->setAccessibleName("Centre of the grey levels");
  span_->setAccessibleName("Span of the grey levels");
  for (QDoubleSpinBox* box : {level_, span_}) {
    box->setRange(0, 65535);
    box->setDecimals(0);
    box->setSuffix(" counts");
    box->setEnabled(false);
  }
  span_->setMinimum(1);
  marks_ = new QCheckBox("Saturated and dead pixels");
  marks_->setChecked(true);
  form->addRow("Colours", colours_);
  form->addRow("Level", mode_);
  form->addRow("Centre", level_);
  form->addRow("Span", span_);
  layout->addLayout(form);
  layout->addWidget(marks_);
  layout->addWidget(hint_label("Orange: full scale. Blue: zero. Ring: dead pixel."));
  layout->addWidget(title_label("Histogram"));
  histogram_ = new HistogramView;
  layout->addWidget(histogram_);
  auto* zoom = new QHBoxLayout;
  auto* fit = plain_button("Fit", "zoomFit");
  auto* pixels = plain_button("1 : 1", "zoomOne");
  auto* large = plain_button("8 : 1", "zoomPixels");
  for (QPushButton* button : {fit, pixels, large}) zoom->addWidget(button);
  layout->addWidget(title_label("Zoom"));
  layout->addLayout(zoom);
  layout->addStretch();
  connect(fit, &QPushButton::clicked, this, [this] { picture_->set_zoom(0); });
  connect(pixels, &QPushButton::clicked, this, [this] { picture_->set_zoom(1); });
  connect(large, &QPushButton::clicked, this, [this] { picture_->set_zoom(8); });
  connect(colours_, &QComboBox::currentIndexChanged, this,
          [this](int index) { presenter_.set_colour_map(all_colour_maps.at(static_cast<std::size_t>(index))); });
  connect(mode_, &QComboBox::currentIndexChanged, this, [this](int index) {
    for (QDoubleSpinBox* box : {level_, span_}) box->setEnabled(index == 1);
    presenter_.set_level_mode(index == 1 ? LevelMode::fixed : LevelMode::automatic);
  });
  for (QDoubleSpinBox* box : {level_, span_}) {
    connect(box, &QDoubleSpinBox::valueChanged, this,
            [this] { presenter_.set_level(level_->value(), span_->value()); });
  }
  connect(marks_, &QCheckBox::toggled, this, [this](bool on) { presenter_.set_marks(on); });
  return panel;
}

void LookView::list_devices() {
  const QSignalBlocker quiet(devices_);
  devices_->clear();
  QMap<QString, QTreeWidgetItem*> groups;
  for (const auto& device : bench_.devices()) {
    QTreeWidgetItem*& group = groups[device.group];
    if (group == nullptr) {
      group = new QTreeWidgetItem(devices_, {device.group});
      group->setFlags(Qt::ItemIsEnabled);
      group->setExpanded(true);
    }
    const QString health = name_of(device.health);
    auto* item = new QTreeWidgetItem(
        group, {device.label +
                (device.serial.isEmpty() ? "  –  " + health : "\nserial number " + device.serial + ", " + health)});
    item->setIcon(0, badge(device.health));
    item->setToolTip(0, device.detail);
    item->setData(0, Qt::UserRole, device.id);
    if (device.id == bench_.device()) devices_->setCurrentItem(item);
  }
}

void LookView::show_frame() {
  if (!isVisible()) return;
  picture_->set_image(presenter_.image());
  std::vector<QPoint> rings;
  for (const auto& pixel : presenter_.dead()) rings.emplace_back(pixel.x, pixel.y);
  picture_->set_rings(std::move(rings));
  counters_->setText(presenter_.counters());
  camera_->setText(presenter_.camera());
  const LevelSpan level = presenter_.level();
  if (presenter_.level_mode() == LevelMode::automatic) {
    const QSignalBlocker quiet_level(level_), quiet_span(span_);
    level_->setValue(level.level());
    span_->setValue(level.span());
  }
  const auto end = [&](double counts) {
    QString text = QString("%1 counts").arg(counts, 0, 'f', 0);
    const auto kelvin = presenter_.latest()->frame.scale->kelvin(counts);
    if (kelvin) text = QString("%1 K").arg(*kelvin, 0, 'f', 2);
    return text;
  };
  histogram_->show_bins(presenter_.histogram(), end(level.low), end(level.high));
  show_reading(cursor_.x(), cursor_.y());
}

void LookView::show_reading(int column, int row) {
  cursor_ = {column, row};
  const auto reading = presenter_.reading(column, row);
  if (!reading) {
    reading_->setText("–");
    return;
  }
  QString text = QString("column %1, row %2: %3 counts").arg(column).arg(row).arg(reading->counts);
  if (reading->kelvin) text += QString(", %1 K").arg(*reading->kelvin, 0, 'f', 2);
  reading_->setText(text);
}

void LookView::show_activity() {
  const bool looking = bench_.activity() == Activity::looking;
  start_->setText(looking ? "Stop live picture" : "Start live picture");
  start_->setEnabled(looking || bench_.activity() == Activity::idle);
  devices_->setEnabled(bench_.activity() == Activity::idle || looking);
}

}  // namespace todbench
