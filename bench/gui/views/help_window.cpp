// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/help_window.h"

#include <QHBoxLayout>
#include <QPushButton>
#include <QTextBrowser>
#include <QVBoxLayout>

#include "bench/gui/views/layout_pieces.h"

/// A resource of a static library is linked only if it is named. Outside of every namespace, as the macro requires.
static void name_help_pages() {
  Q_INIT_RESOURCE(help);
}

namespace todbench {

HelpWindow::HelpWindow(QWidget* parent) : QDialog(parent) {
  name_help_pages();
  setWindowTitle("todbench: help");
  resize(860, 640);
  auto* layout = new QVBoxLayout(this);
  auto* line = new QHBoxLayout;
  auto* back = plain_button("Back", "helpBack");
  auto* contents = plain_button("Contents", "helpContents");
  line->addWidget(back);
  line->addWidget(contents);
  line->addStretch();
  layout->addLayout(line);
  browser_ = new QTextBrowser;
  browser_->setObjectName("helpPage");
  browser_->setAccessibleName("Page of the documentation");
  browser_->setOpenExternalLinks(true);
  layout->addWidget(browser_, 1);
  back->setEnabled(false);
  connect(back, &QPushButton::clicked, browser_, &QTextBrowser::backward);
  connect(browser_, &QTextBrowser::backwardAvailable, back, &QWidget::setEnabled);
  connect(contents, &QPushButton::clicked, this, [this] { show_page("index.md"); });
}

void HelpWindow::show_page(const QString& page) {
  browser_->setSource(QUrl("qrc:/docs/" + page));
  show();
  raise();
  activateWindow();
}

}  // namespace todbench
