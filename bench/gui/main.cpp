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

#include "acquisition/core/safe_text.h"
#include "bench/gui/pattern_screen.h"
#include "bench/gui/presenters/session_presenter.h"
#include "bench/gui/screenshots.h"
#include "bench/gui/views/main_window.h"
#include "bench/gui/views/plain_numbers.h"
#include "bench/judgement/verdict.h"
#include "bench/session/build_info.h"
#include "bench/text/files.h"
#include "bench/text/manual_page.h"

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

/// A page for man(1) from what the options say about themselves, written to `file`. 0, or 7 with a sentence.
int write_manual(const QList<QCommandLineOption>& options, const QString& file) {
  todbench::ManualPage page{
      .name = "todbench-gui",
      .sentence = "the bench of todbench as a window",
      .date = qgetenv("TODBENCH_RELEASE_DATE").toStdString(),
      .version = "todbench " + std::string(todbench::build_info().version),
      .synopsis = {"todbench-gui [OPTIONS] [SESSION]"},
      .sections = {{.title = "Arguments",
                    .text = "",
                    .terms = {{"SESSION", "folder of a session, or its session.toml: shown at once"}}},
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

/// The folder of a session that is named by itself or by its session.toml.
std::filesystem::path session_folder(const QString& argument) {
  const std::filesystem::path path = std::filesystem::absolute(argument.toStdString()).lexically_normal();
  if (path.filename() == "session.toml" || path.filename().empty()) return path.parent_path();
  return path;
}

QList<QCommandLineOption> known_options() {
  QCommandLineOption manual("manual", "Writes the page for man(1) and ends.", "FILE");
  manual.setFlags(QCommandLineOption::HiddenFromHelp);
  return {
      {"sessions",
       "Where sessions are listed and written, made where it is not there; default: the current folder, or that of "
       "SESSION.",
       "FOLDER"},
      {"theme", "light or dark; default: as last time.", "NAME"},
      {"size", "Size of the window in pixels.", "WIDTHxHEIGHT"},
      {"screenshots", "Writes a picture of every view and ends; with SESSION of those that need no camera.", "FOLDER"},
      {"report", "Writes report.html and report.pdf of a session and ends; needs no screen.", "SESSION"},
      {"pattern",
       "Test pictures on the whole screen, stepped by the arrow keys until escape: kinds of 'todbench pattern', "
       "separated by commas; flat:0.25 for a level.",
       "KINDS"},
      {"truth", "Folder for the truth of every test picture.", "FOLDER"},
      {"pictures",
       "Shows the pictures that come on standard input and answers with what is on the screen: the display of a "
       "bench."},
      {"copy", "File for what is on the screen after every picture of --pictures, in the .npy format.", "FILE"},
      {"screen", "Number of the monitor for test pictures, from 0.", "NUMBER"},
      manual};
}

int refused(const std::string& sentence) {
  std::fprintf(stderr, "todbench-gui: %s\n", todbench::one_line(sentence).c_str());
  return todbench::exit_code(todbench::ErrorCode::invalid_input);
}

/// What a parser of Qt does not look at: the values. Empty when they can be taken.
std::string wrong_value(const QCommandLineParser& options) {
  const QString theme = options.value("theme"), size = options.value("size");
  if (options.isSet("theme") && theme != "light" && theme != "dark")
    return "--theme " + theme.toStdString() + ": expected light or dark";
  static const QRegularExpression width_by_height("^([1-9][0-9]{0,4})x([1-9][0-9]{0,4})$");
  if (options.isSet("size") && !width_by_height.match(size).hasMatch())
    return "--size " + size.toStdString() + ": expected WIDTHxHEIGHT in pixels, for instance 1366x768";
  if (options.positionalArguments().size() > 1) return "one session at most";
  return {};
}

/// The window, until it is closed, or its pictures.
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
    std::fprintf(stderr, "%s: no folder, and none can be made there\n", qPrintable(sessions));
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
  // Writing a report needs fonts and no screen; so does the manual. Without a screen the options are read all the same,
  // so that help and mistakes are told anywhere.
  const auto needs_no_screen = [](const char* argument) {
    return std::string_view(argument).starts_with("--report") || std::string_view(argument).starts_with("--manual");
  };
  const bool screen = todbench::has_screen();
  if (!screen || (std::any_of(argv + 1, argv + argc, needs_no_screen) && !qEnvironmentVariableIsSet("QT_QPA_PLATFORM")))
    qputenv("QT_QPA_PLATFORM", "offscreen");
  // A program behind the camera or on a display that has ended is an error in words.
  std::signal(SIGPIPE, SIG_IGN);
  const QApplication application(argc, argv);
  todbench::use_plain_numbers();
  QApplication::setApplicationName("todbench-gui");
  const auto version = todbench::build_info().version;
  QApplication::setApplicationVersion(QString::fromUtf8(version.data(), static_cast<qsizetype>(version.size())));
  QCommandLineParser options;
  options.setApplicationDescription("The bench of todbench as a window");
  const QCommandLineOption help = options.addHelpOption(), of_version = options.addVersionOption();
  const QList<QCommandLineOption> known = known_options();
  options.addOptions(known);
  options.addPositionalArgument("SESSION", "Folder of a session, or its session.toml: shown at once.", "[SESSION]");
  if (!options.parse(QApplication::arguments())) return refused(options.errorText().toStdString());
  if (options.isSet(of_version)) options.showVersion();
  if (options.isSet(help) || options.isSet("help-all")) options.showHelp();
  if (const std::string wrong = wrong_value(options); !wrong.empty()) return refused(wrong);
  if (options.isSet("manual")) return write_manual(known, options.value("manual"));
  if (options.isSet("report")) return write_reports(options.value("report"));

  if (!screen && !options.isSet("screenshots")) {
    std::fprintf(stderr, "todbench-gui: there is no screen: neither DISPLAY nor WAYLAND_DISPLAY is set\n");
    return todbench::exit_code(todbench::ErrorCode::not_found);
  }
  if (options.isSet("pattern"))
    return todbench::show_patterns(options.value("pattern"), options.value("screen"), options.value("truth"));
  if (options.isSet("pictures"))
    return todbench::show_pictures_of_input(options.value("screen"), options.value("copy"));
  return run_window(options);
}
