// todbench-gui
#include <QApplication>
#include <QCommandLineParser>
#include <QDir>
#include <cstdio>

#include "bench/gui/main_window.h"
#include "bench/gui/screenshots.h"
#include "bench/session/build_info.h"

int main(int argc, char** argv) {
  const QApplication application(argc, argv);
  QApplication::setApplicationName("todbench-gui");
  const auto version = todbench::build_info().version;
  QApplication::setApplicationVersion(QString::fromUtf8(version.data(), static_cast<qsizetype>(version.size())));
  QCommandLineParser options;
  options.setApplicationDescription("The bench of todbench as a window");
  options.addHelpOption();
  options.addVersionOption();
  options.addOption({"sessions",
                     "Where sessions are listed and written, made where it is not there; default: the current folder.",
                     "FOLDER", "."});
  options.addOption({"theme", "light or dark; default: as last time.", "NAME"});
  options.addOption({"size", "Size of the window in pixels.", "WIDTHxHEIGHT"});
  options.addOption({"screenshots", "Writes a picture of every view and ends.", "FOLDER"});
  options.process(application);

  const QString sessions = options.value("sessions");
  if (!QDir().mkpath(sessions)) {
    std::fprintf(stderr, "%s: no folder, and none can be made there\n", qPrintable(sessions));
    return 2;
  }
  const bool pictures = options.isSet("screenshots");
  todbench::MainWindow window(sessions.toStdString(), pictures ? todbench::Memory::forget : todbench::Memory::remember);
  if (options.isSet("theme"))
    window.set_theme(options.value("theme") == "dark" ? todbench::Theme::dark : todbench::Theme::light);
  if (const QStringList size = options.value("size").split('x'); size.size() == 2)
    window.resize(size[0].toInt(), size[1].toInt());
  if (pictures) return todbench::take_screenshots(window, options.value("screenshots").toStdString());
  window.show();
  window.bench().rescan();
  return QApplication::exec();
}
