// SPDX-License-Identifier: GPL-3.0-or-later
// Start page: three ways to begin.
#pragma once

#include <QWidget>

namespace todbench {

/// Page with a button for each of the three ways.
class StartView final : public QWidget {
  Q_OBJECT

 public:
  explicit StartView(QWidget* parent = nullptr);

 signals:
  void try_without_hardware();
  void connect_camera();
  void open_session();
};

}  // namespace todbench
