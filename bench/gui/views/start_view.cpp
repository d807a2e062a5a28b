// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/start_view.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QVBoxLayout>
#include <array>

#include "bench/gui/views/layout_pieces.h"

namespace todbench {
namespace {

struct StartChoice {
  const char* object_name;
  const char* title;
  const char* sentence;
  void (StartView::*chosen)();
};

constexpr std::array choices{
    StartChoice{
        "startDemo", "Try without hardware",
        "The emulated laboratory is a camera, a black body and a plate stage on this computer. A whole measurement "
        "takes about 40 s, from the plan to the report.",
        &StartView::try_without_hardware},
    StartChoice{
        "startCamera", "Connect a camera",
        "Looks for cameras on the network, on USB and through the drivers of the kernel. Shows the live picture of the "
        "camera that you choose.",
        &StartView::connect_camera},
    StartChoice{
        "startSession", "Open a session",
        "Shows the curves, the ratios and the verdict of a measurement on disk. You can also drop a session or a plan "
        "onto this window.",
        &StartView::open_session},
};

}  // namespace

StartView::StartView(QWidget* parent) : QWidget(parent) {
  auto* layout = new QVBoxLayout(this);
  layout->addStretch(1);
  auto* line = new QHBoxLayout;
  auto* lines = new QVBoxLayout;
  auto* title = new QLabel("What would you like to do?");
  title->setProperty("role", "step");
  lines->addWidget(title);
  for (const StartChoice& choice : choices) {
    QPushButton* button = primary_button(choice.title, choice.object_name);
    button->setMinimumHeight(44);
    button->setAccessibleDescription(choice.sentence);
    lines->addSpacing(14);
    lines->addWidget(button);
    lines->addWidget(hint_label(choice.sentence));
    connect(button, &QPushButton::clicked, this, choice.chosen);
  }
  line->addStretch(1);
  line->addLayout(lines, 3);
  line->addStretch(1);
  layout->addLayout(line);
  layout->addStretch(2);
}

}  // namespace todbench
