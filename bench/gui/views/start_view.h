// The page of a first start: three ways to begin.
#pragma once

#include <QWidget>

namespace todbench {

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
