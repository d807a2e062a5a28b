// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/pattern_screen.h"

#include <unistd.h>

#include <QApplication>
#include <QMetaObject>
#include <QScreen>
#include <QStringList>
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "acquisition/base/safe_text.h"
#include "bench/gui/views/pattern_window.h"
#include "bench/judgement/verdict.h"
#include "bench/report/pattern_truth.h"
#include "bench/text/files.h"
#include "sim_devices/module/npy_message.h"
#include "tod/pattern/test_picture.h"

namespace todbench {
namespace {

constexpr std::size_t most_values = std::size_t{1} << 28;

int refused(const Error& error) {
  std::fprintf(stderr, "todbench-gui: %s\n", one_line(error.message).c_str());
  return exit_code(error.code);
}

Result<QScreen*> screen_of(const QString& number) {
  const auto screens = QGuiApplication::screens();
  bool whole = true;
  const int index = number.isEmpty() ? 0 : number.toInt(&whole);
  if (!whole || index < 0 || index >= screens.size()) {
    return fail(ErrorCode::invalid_input, "--screen: expected a number from 0 to " +
                                              std::to_string(screens.size() - 1) + ", found '" + number.toStdString() +
                                              "'");
  }
  return screens[index];
}

bool write_all(std::string_view bytes) {
  while (!bytes.empty()) {
    const auto written = ::write(STDOUT_FILENO, bytes.data(), bytes.size());
    if (written <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

/// Reads pictures from standard input on its own thread; ends the application at the end of input or on an error.
void serve(PatternWindow& window, const std::string& copy) {
  const auto end = [](int code) {
    QMetaObject::invokeMethod(
        qApp, [code] { QCoreApplication::exit(code); }, Qt::QueuedConnection);
  };
  std::string stream;
  std::array<char, 1 << 16> buffer{};
  while (true) {
    auto read = read_message(stream, most_values);
    if (!read) return end(refused(read.error()));
    if (!read->message) {
      const auto count = ::read(STDIN_FILENO, buffer.data(), buffer.size());
      if (count <= 0) return end(0);
      stream.append(buffer.data(), static_cast<std::size_t>(count));
      continue;
    }
    stream.erase(0, read->bytes);
    const NpyMessage& message = *read->message;
    if (message.shape.size() != 2) continue;  // the header
    cv::Mat1d levels(static_cast<int>(message.shape[0]), static_cast<int>(message.shape[1]));
    std::copy(message.values.begin(), message.values.end(), levels.begin());
    Result<cv::Mat1f> shown = fail(ErrorCode::internal, "no picture was shown");
    QMetaObject::invokeMethod(
        &window,
        [&] {
          const auto fits = window.show_levels(levels);
          // Let the window system finish before the screen is read.
          QCoreApplication::processEvents();
          shown = fits ? window.on_screen() : tl::unexpected(fits.error());
        },
        Qt::BlockingQueuedConnection);
    if (!shown) return end(refused(shown.error()));
    const std::string answer = to_message(*shown);
    if (!copy.empty()) {
      if (auto copied = write_file_atomically(copy, answer); !copied) return end(refused(copied.error()));
    }
    if (!write_all(answer)) return end(0);
  }
}

}  // namespace

int show_patterns(const QString& kinds, const QString& screen, const QString& truth) {
  const auto where = screen_of(screen);
  if (!where) return refused(where.error());
  PatternWindow window(**where);
  std::vector<NamedPattern> patterns;
  for (const QString& kind : kinds.split(',')) {
    const std::string name = kind.trimmed().toStdString();
    const auto known = picture_kind_named(name);
    if (!known) return refused(with_context("--pattern", known.error()));
    const PictureRequest request{.size = window.screen_px(), .kind = *known};
    auto picture = drawn_picture(request);
    if (!picture) return refused(with_context("--pattern " + name, picture.error()));
    if (!truth.isEmpty()) {
      const std::filesystem::path file = std::filesystem::path(truth.toStdString()) / (name + ".toml");
      if (auto written = write_file_atomically(file, pattern_truth(request, *picture, "the screen")); !written)
        return refused(written.error());
    }
    patterns.push_back({name, std::move(picture->levels)});
  }
  QObject::connect(&window, &PatternWindow::ended, qApp, &QCoreApplication::quit);
  window.set_patterns(std::move(patterns));
  window.fill_screen();
  return QApplication::exec();
}

bool has_screen() {
  return qEnvironmentVariableIsSet("QT_QPA_PLATFORM") || !qEnvironmentVariableIsEmpty("DISPLAY") ||
         !qEnvironmentVariableIsEmpty("WAYLAND_DISPLAY");
}

int show_pictures_of_input(const QString& screen, const QString& copy) {
  const auto where = screen_of(screen);
  if (!where) return refused(where.error());
  PatternWindow window(**where);
  // Escape would end a measurement; the bench that started the display ends it.
  window.fill_screen();
  std::thread reader([&window, file = copy.toStdString()] { serve(window, file); });
  const int code = QApplication::exec();
  // If the window system ended the application, the reader still waits for input that is no longer needed.
  ::close(STDIN_FILENO);
  reader.detach();
  std::fflush(nullptr);
  ::_exit(code);
}

}  // namespace todbench
