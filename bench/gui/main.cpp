// SPDX-License-Identifier: GPL-3.0-or-later
// todbench-gui
#include <QApplication>
#include <QCommandLineParser>
#include <QDir>
#include <QRegularExpression>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

#include "acquisition/base/safe_text.h"
#include "bench/gui/pattern_screen.h"
#include "bench/gui/presenters/session_presenter.h"
#include "bench/gui/presenters/text_of.h"
#include "bench/gui/screenshots.h"
#include "bench/gui/views/main_window.h"
#include "bench/gui/views/plain_numbers.h"
#include "bench/judgement/verdict.h"
#include "bench/session/build_info.h"
#include "bench/text/files.h"
#include "bench/text/manual_page.h"

namespace {

/// Writes the report of a session as page and PDF, without a window. Returns 0, or the error's exit code with its
/// sentence on standard error.
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

/// Writes a page for man(1) from the descriptions of the options to `file`. Returns 0, or 7 with a sentence.
int write_manual(const QList<QCommandLineOption>& options, const QString& file) {
  todbench::ManualPage page{
      .name = "todbench-gui",
      .sentence = "the todbench lab bench with a graphical interface",
      .date = qgetenv("TODBENCH_RELEASE_DATE").toStdString(),
      .version = "todbench " + std::string(todbench::build_info().version),
      .synopsis = {"todbench-gui [OPTIONS] [SESSION]"},
      .sections = {{.title = "Arguments",
                    .text = "",
                    .terms = {{"SESSION", "Folder of a session or its session.toml. The window opens the session."}}},
                   {.title = "Options", .text = "", .terms = {}}},
      .see_also = {"todbench"}};
  for (const QCommandLineOption& option : options) {
    if (option.flags().testFlag(QCommandLineOption::HiddenFromHelp)) continue;
    const QString value = option.valueName().isEmpty() ? QString() : " " + option.valueName();
    page.sections.back().terms.push_back(
        {("--" + option.names().constFirst() + value).toStdString(), option.description().toStdString()});
  }
  const auto written = todbench::write_file_atomically(file.toStdString(), todbench::roff(page));
  if (written) return 0;
  std::fprintf(stderr, "%s\n", todbench::one_line(written.error().message).c_str());
  return todbench::exit_code(written.error().code);
}

/// Returns the folder of a session, given as the folder or its session.toml.
std::filesystem::path session_folder(const QString& argument) {
  const std::filesystem::path path = std::filesystem::absolute(argument.toStdString()).lexically_normal();
  if (path.filename() == "session.toml" || path.filename().empty()) return path.parent_path();
  return path;
}

QList<QCommandLineOption> known_options() {
  QCommandLineOption manual("manual", "Writes the page for man(1) and exits.", "FILE");
  manual.setFlags(QCommandLineOption::HiddenFromHelp);
  return {
      {"sessions",
       "Folder in which sessions are listed and written. It is created if it does not exist. By default the current "
       "folder, or the folder that contains SESSION.",
       "FOLDER"},
      {"theme", "Colours of the window: light or dark. By default those of the last start.", "NAME"},
      {"size", "Size of the window in pixels.", "WIDTHxHEIGHT"},
      {"screenshots",
       "Writes a picture of every view and exits. With SESSION, writes only the views that need no camera.", "FOLDER"},
      {"report", "Writes report.html and report.pdf of a session and exits. Needs no screen.", "SESSION"},
      {"pattern",
       "Shows test pictures on the whole screen. The arrow keys show the next or the previous picture, Escape ends. "
       "KINDS are kinds of 'todbench pattern', separated by commas; flat:0.25 sets a level.",
       "KINDS"},
      {"truth", "Folder for the truth file of every test picture of --pattern.", "FOLDER"},
      {"pictures",
       "Shows the pictures from standard input and answers with the pictures that are then on the screen. A target of "
       "kind display runs it."},
      {"copy", "File (.npy) for the picture on the screen after every picture of --pictures.", "FILE"},
      {"screen", "Number of the monitor for --pattern and --pictures, from 0. By default 0.", "NUMBER"},
      manual};
}

int refused(const std::string& sentence) {
  std::fprintf(stderr, "todbench-gui: %s\n", todbench::one_line(sentence).c_str());
  return todbench::exit_code(todbench::ErrorCode::invalid_input);
}

/// Checks the values of the options, which Qt's parser does not. Returns an empty text if they are valid.
std::string wrong_value(const QCommandLineParser& options) {
  const QString theme = options.value("theme"), size = options.value("size");
  if (options.isSet("theme") && theme != "light" && theme != "dark")
    return "--theme " + theme.toStdString() + ": expected light or dark";
  static const QRegularExpression width_by_height("^([1-9][0-9]{0,4})x([1-9][0-9]{0,4})$");
  if (options.isSet("size") && !width_by_height.match(size).hasMatch())
    return "--size " + size.toStdString() + ": expected WIDTHxHEIGHT in pixels, for example 1366x768";
  if (options.positionalArguments().size() > 1) return "expected at most one session";
  return {};
}

/// Runs the window until it is closed, or takes its pictures.
int run_window(const QCommandLineParser& options) {
  const QStringList arguments = options.positionalArguments();
  const auto shown = arguments.isEmpty() ? std::filesystem::path() : session_folder(arguments.constFirst());
  if (!shown.empty() && !std::filesystem::exists(shown / "session.toml")) {
    std::fprintf(stderr, "%s: not a session folder (there is no session.toml)\n",
                 todbench::one_line(shown.string()).c_str());
    return 2;
  }
  const QString beside = arguments.isEmpty() ? "." : QString::fromStdString(shown.parent_path().string());
  const QString sessions = options.isSet("sessions") ? options.value("sessions") : beside;
  if (!QDir().mkpath(sessions)) {
    std::fprintf(stderr, "%s: is not a folder and cannot be created\n", qPrintable(sessions));
    return 2;
  }
  const bool pictures = options.isSet("screenshots");
  todbench::MainWindow window(sessions.toStdString(), pictures ? todbench::Memory::forget : todbench::Memory::remember);
  if (options.isSet("theme"))
    window.set_theme(options.value("theme") == "dark" ? todbench::Theme::dark : todbench::Theme::light);
  if (const QStringList size = options.value("size").split('x'); size.size() == 2)
    window.resize(size[0].toInt(), size[1].toInt());
  if (pictures) {
    const std::filesystem::path folder = options.value("screenshots").toStdString();
    return shown.empty() ? todbench::take_screenshots(window, folder)
                         : todbench::take_session_screenshots(window, folder, shown);
  }
  window.show();
  window.bench().rescan();
  if (!shown.empty()) window.open_path(shown);
  return QApplication::exec();
}

}  // namespace

int main(int argc, char** argv) {
  // Reports and the manual need fonts but no screen. Without a screen the options are still parsed, so that help and
  // errors are always reported.
  const auto needs_no_screen = [](const char* argument) {
    return std::string_view(argument).starts_with("--report") || std::string_view(argument).starts_with("--manual");
  };
  const bool screen = todbench::has_screen();
  if (!screen || (std::any_of(argv + 1, argv + argc, needs_no_screen) && !qEnvironmentVariableIsSet("QT_QPA_PLATFORM")))
    qputenv("QT_QPA_PLATFORM", "offscreen");
  // A write to a program that has ended (module, display) becomes an error message instead of a signal.
  std::signal(SIGPIPE, SIG_IGN);
  const QApplication application(argc, argv);
  todbench::use_plain_numbers();
  QApplication::setApplicationName("todbench-gui");
  QApplication::setApplicationVersion(todbench::text_of(todbench::build_info().version));
  QCommandLineParser options;
  options.setApplicationDescription("The todbench lab bench with a graphical interface.");
  const QCommandLineOption help = options.addHelpOption(), of_version = options.addVersionOption();
  const QList<QCommandLineOption> known = known_options();
  options.addOptions(known);
  options.addPositionalArgument("SESSION", "Folder of a session or its session.toml. The window opens the session.",
                                "[SESSION]");
  if (!options.parse(QApplication::arguments())) return refused(options.errorText().toStdString());
  if (options.isSet(of_version)) options.showVersion();
  if (options.isSet(help) || options.isSet("help-all")) options.showHelp();
  if (const std::string wrong = wrong_value(options); !wrong.empty()) return refused(wrong);
  if (options.isSet("manual")) return write_manual(known, options.value("manual"));
  if (options.isSet("report")) return write_reports(options.value("report"));

  if (!screen && !options.isSet("screenshots")) {
    std::fprintf(stderr, "todbench-gui: there is no screen, because neither DISPLAY nor WAYLAND_DISPLAY is set\n");
    return todbench::exit_code(todbench::ErrorCode::not_found);
  }
  if (options.isSet("pattern"))
    return todbench::show_patterns(options.value("pattern"), options.value("screen"), options.value("truth"));
  if (options.isSet("pictures"))
    return todbench::show_pictures_of_input(options.value("screen"), options.value("copy"));
  return run_window(options);
}
