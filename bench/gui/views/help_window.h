// SPDX-License-Identifier: GPL-3.0-or-later
// Window with the pages of the documentation, readable without a network.
#pragma once

#include <QDialog>

class QTextBrowser;

namespace todbench {

/// Window that shows one page at a time.
class HelpWindow final : public QDialog {
  Q_OBJECT

 public:
  explicit HelpWindow(QWidget* parent = nullptr);
  /// Shows a page of docs/, for example "guide/first-hour.md".
  void show_page(const QString& page);
  [[nodiscard]] const QTextBrowser& browser() const { return *browser_; }

 private:
  QTextBrowser* browser_;
};

}  // namespace todbench
