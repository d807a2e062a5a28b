// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/align_view.h"

#include <QHBoxLayout>
#include <algorithm>

#include "bench/gui/presenters/align_presenter.h"
#include "bench/gui/presenters/look_presenter.h"
#include "bench/gui/views/layout_pieces.h"
#include "bench/gui/views/picture_view.h"

namespace todbench {
namespace {

QPolygonF polygon_of(const Polygon& points) {
  QPolygonF out;
  for (const auto& p : points) out << QPointF(p.x, p.y);
  return out;
}

/// Bounding rectangle of the outlines with a margin of a twentieth; empty without outlines.
QRectF with_margin(const std::vector<PictureOutline>& outlines) {
  QRectF all;
  for (const auto& outline : outlines) all |= outline.points.boundingRect();
  const double margin = std::max(all.width(), all.height()) / 20;
  return all.isEmpty() ? QRectF() : all.adjusted(-margin, -margin, margin, margin);
}

}  // namespace

AlignView::AlignView(Workbench& bench, AlignPresenter& presenter, LookPresenter& live, QWidget* parent)
    : QWidget(parent), bench_(bench), presenter_(presenter) {
  auto* layout = new QHBoxLayout(this);
  picture_ = new PictureView;
  picture_->setObjectName("alignPicture");
  picture_->set_placeholder(
      "Start the alignment. It shows the first plate of the plan at its highest contrast and locates it.");
  picture_->setAccessibleName("Plate");
  layout->addWidget(picture_, 1);
  auto* panel = new QWidget;
  panel->setFixedWidth(300);
  auto* side = new QVBoxLayout(panel);
  side->setContentsMargins(0, 0, 0, 0);
  side->addWidget(title_label("Whole picture"));
  whole_ = new PictureView;
  whole_->setObjectName("wholePicture");
  whole_->setAccessibleName("Whole picture");
  whole_->set_placeholder("The whole picture of the camera");
  whole_->setFixedHeight(200);
  side->addWidget(whole_);
  side->addWidget(title_label("Registration"));
  verdict_ = new QLabel("Not aligned yet");
  verdict_->setObjectName("alignVerdict");
  verdict_->setProperty("role", "verdict");
  verdict_->setWordWrap(true);
  side->addWidget(verdict_);
  figures_ = plain_table({"Quantity", "Value"}, "alignFigures");
  figures_->setColumnWidth(0, 150);
  side->addWidget(figures_, 1);
  side->addWidget(title_label("Corrections"));
  hints_ = hint_label("Not known yet.");
  hints_->setObjectName("alignHints");
  side->addWidget(hints_);
  side->addWidget(
      hint_label("Blue: triangles at their nominal places. Orange: windows that the observer judges. "
                 "Green: edge of the plate."));
  start_ = primary_button("Start alignment", "startAligning");
  side->addWidget(start_);
  layout->addWidget(panel);
  connect(start_, &QPushButton::clicked, this, [this] {
    if (bench_.activity() == Activity::aligning) {
      presenter_.stop();
    } else {
      presenter_.start();
    }
  });
  connect(&live, &LookPresenter::updated, this, [this, &live] {
    if (!isVisible()) return;
    picture_->set_image(live.image());
    whole_->set_image(live.image());
  });
  connect(&presenter_, &AlignPresenter::updated, this, &AlignView::show_alignment);
  connect(&bench_, &Workbench::activity_changed, this, &AlignView::show_activity);
  show_activity();
}

void AlignView::show_alignment() {
  QList<QStringList> rows;
  for (const auto& [name, value] : presenter_.figures()) rows << QStringList{name, value};
  fill_table(*figures_, rows);
  const QStringList hints = presenter_.hints();
  hints_->setText(!presenter_.alignment() ? "Not known yet." : hints.isEmpty() ? "None." : "• " + hints.join("\n• "));
  const auto& alignment = presenter_.alignment();
  if (!alignment) {
    verdict_->setText("Not aligned yet");
    picture_->set_outlines({});
    whole_->set_outlines({});
    picture_->set_region({});
    return;
  }
  verdict_->setText(alignment->remarks.empty() ? "✓ Ready to measure" : "✗ Not ready");
  std::vector<PictureOutline> outlines;
  outlines.push_back({polygon_of(alignment->plate_px), QColor(0, 158, 115)});
  for (const auto& t : alignment->triangles) {
    outlines.push_back({polygon_of(t.outline_px), QColor(86, 180, 233)});
    const QRectF window(t.window.x - 0.5, t.window.y - 0.5, t.window.width, t.window.height);
    outlines.push_back({QPolygonF(window), QColor(230, 159, 0), Qt::DotLine});
  }
  // The plate may cover a tenth of the picture: this view is enlarged, the other shows its place.
  whole_->set_outlines({outlines.front()});
  picture_->set_region(with_margin(outlines));
  picture_->set_outlines(std::move(outlines));
}

void AlignView::show_activity() {
  const bool aligning = bench_.activity() == Activity::aligning;
  start_->setText(aligning ? "Stop alignment" : "Start alignment");
  start_->setEnabled(bench_.activity() != Activity::measuring && bench_.activity() != Activity::replaying);
}

}  // namespace todbench
