// todbench-gui
#include <QApplication>
#include <QCommandLineParser>
#include <QDir>
#include <algorithm>
#include <cstdio>
#include <string_view>

#include "acquisition/core/safe_text.h"
#include "bench/gui/presenters/session_presenter.h"
#include "bench/gui/screenshots.h"
#include "bench/gui/views/main_window.h"
#include "bench/judgement/verdict.h"
#include "bench/session/build_info.h"

namespace {

/// Report of a session as page and PDF, without a window. 0, or the error's exit code with its sentence on standard
/// error.
int write_reports(const QString& session) {
  const auto opened = todbench::read_opened_session(session.toStdString());
  const auto written = opened ? todbench::export_reports(*opened) : tl::unexpected(opened.error());
  if (!written) {
    std::fprintf(stderr, "%s\n", todbench::one_line(written.error().message).c_str());
    return todbench::exit_code(written.error().code);
  }
  std::printf("%s\n%s\n", qPrintable(written->html), qPrintable(written->pdf));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  // Writing a report needs fonts and no screen.
  const auto asks_for_report = [](const char* argument) { return std::string_view(argument).starts_with("--report"); };
  if (std::any_of(argv + 1, argv + argc, asks_for_report) && !qEnvironmentVariableIsSet("QT_QPA_PLATFORM"))
    qputenv("QT_QPA_PLATFORM", "offscreen");
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
  options.addOption({"report", "Writes report.html and report.pdf of a session and ends; needs no screen.", "SESSION"});
  options.process(application);
  if (options.isSet("report")) return write_reports(options.value("report"));

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
