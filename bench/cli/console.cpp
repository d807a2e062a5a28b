// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/console.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "acquisition/base/process.h"
#include "acquisition/base/safe_file.h"
#include "bench/text/terminal_lines.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

/// Maximum characters of a cell: names come from cameras and files.
constexpr std::size_t longest_cell = 300;

TableRow shown(const TableRow& row) {
  TableRow cells;
  for (const std::string& cell : row) cells.push_back(one_line(cell, longest_cell));
  return cells;
}

/// Returns the columns of a terminal; empty if it is none or does not report them.
std::optional<std::size_t> columns_of_terminal(int descriptor) {
  winsize size{};
  if (isatty(descriptor) != 1 || ioctl(descriptor, TIOCGWINSZ, &size) != 0 || size.ws_col <= 1) return std::nullopt;
  return size.ws_col;
}

std::string duration(double seconds) {
  const int whole = static_cast<int>(std::lround(std::max(0.0, seconds)));
  return whole < 120 ? fmt::format("{} s", whole) : fmt::format("{}:{:02} min", whole / 60, whole % 60);
}

/// Shows a text longer than the terminal in the pager. Returns false if the caller has to print it: no terminal, enough
/// room, or no pager.
bool paged(const std::vector<std::string>& lines) {
  constexpr int not_found = 127;  // sh
  winsize size{};
  if (isatty(STDIN_FILENO) != 1 || isatty(STDOUT_FILENO) != 1) return false;
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_row == 0 || lines.size() < size.ws_row) return false;
  const char* asked = std::getenv("PAGER");
  const std::string command = asked != nullptr && *asked != '\0' ? asked : "less -FRX 2>/dev/null";
  auto pipe = make_pipe();
  if (!pipe) return false;
  const auto pager = start_program({"/bin/sh", "-c", command}, {.input = pipe->read.get()});
  pipe->read.close();
  if (!pager) return false;
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  // A reader may close the pager early; that is not an error.
  (void)write_all(pipe->write.get(), text);
  pipe->write.close();
  const auto code = wait_for_program(*pager);
  return code && *code != not_found;
}

}  // namespace

std::string broken_for(int descriptor, std::string_view text) {
  const auto columns = columns_of_terminal(descriptor);
  if (!columns) return std::string(text) + "\n";
  std::string out;
  while (true) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    for (const std::string& line : broken_line(text.substr(0, end), *columns)) out += line + "\n";
    if (end == text.size()) return out;
    text.remove_prefix(end + 1);
  }
}

Console::Console(ConsoleOptions options) : options_(options) {
  terminal_ = isatty(STDERR_FILENO) == 1;
  const char* no_colour = std::getenv("NO_COLOR");
  colour_ = terminal_ && (no_colour == nullptr || *no_colour == '\0');
}

void Console::object(const Json& json) const {
  std::fputs((to_line(json) + "\n").c_str(), stdout);
  std::fflush(stdout);
}

void Console::text(std::string_view line) const {
  if (options_.json) return;
  std::fputs(broken_for(STDOUT_FILENO, valid_text(line)).c_str(), stdout);
  std::fflush(stdout);
}

void Console::table(const TableRow& header, const std::vector<TableRow>& given) const {
  std::vector<TableRow> rows;
  for (const TableRow& row : given) rows.push_back(shown(row));
  TableRow heads;
  for (const std::string& cell : header) heads.push_back(valid_text(cell));
  const std::vector<std::string> lines = table_lines(heads, rows, columns_of_terminal(STDOUT_FILENO));
  if (options_.json || paged(lines)) return;
  for (const auto& one : lines) std::fputs((one + "\n").c_str(), stdout);
  std::fflush(stdout);
}

void Console::waiting(std::string_view sentence) {
  constexpr auto waiting_line_period = std::chrono::seconds(10);
  if (options_.quiet) return;
  const auto now = std::chrono::steady_clock::now();
  if (!terminal_) {
    if (last_waiting_.time_since_epoch().count() != 0 && now - last_waiting_ < waiting_line_period) return;
    last_waiting_ = now;
    std::fputs((one_line(sentence) + "\n").c_str(), stderr);
    return;
  }
  const std::size_t room = columns() - 1;
  std::fputs(("\r\033[K" + one_line(sentence, room)).c_str(), stderr);
  std::fflush(stderr);
  bar_shown_ = true;
}

void Console::picture(const std::vector<std::string>& lines) {
  if (audience() != Audience::terminal) return;
  std::string text = "\r\033[K";
  if (picture_lines_ > 0) text += fmt::format("\033[{}A", picture_lines_);
  for (const std::string& line : lines) text += "\033[K" + valid_text(line) + "\n";
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
  picture_lines_ = lines.size();
  bar_shown_ = false;
  last_draw_ = {};  // the bar was there
}

Console::Audience Console::audience() const {
  if (options_.quiet) return Audience::nobody;
  return terminal_ ? Audience::terminal : Audience::lines;
}

std::size_t Console::columns() const {
  winsize size{};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return known ? size.ws_col : 80;
}

void Console::note(std::string_view sentence) {
  if (options_.quiet) return;
  end_progress();
  picture_lines_ = 0;
  std::fputs(broken_for(STDERR_FILENO, one_line(sentence)).c_str(), stderr);
}

void Console::warning(std::string_view sentence) {
  end_progress();
  picture_lines_ = 0;
  std::fputs(broken_for(STDERR_FILENO, one_line(sentence)).c_str(), stderr);
}

void Console::error(std::string_view sentence) {
  end_progress();
  picture_lines_ = 0;
  const std::string text = broken_for(STDERR_FILENO, "todbench: " + one_line(sentence));
  std::fputs((colour_ ? "\033[31m" + text + "\033[0m" : text).c_str(), stderr);
}

void Console::phase(std::string_view name) {
  end_progress();
  picture_lines_ = 0;
  phase_ = one_line(name);
  time_left_.begin(std::chrono::steady_clock::now());
  last_draw_ = {};
  if (options_.quiet) return;
  if (!terminal_) {
    std::fputs((phase_ + "\n").c_str(), stderr);
    return;
  }
  // The first step may take seconds; the name alone shows that the program is at work.
  std::fputs(one_line(phase_ + " ...", columns() - 1).c_str(), stderr);
  std::fflush(stderr);
  bar_shown_ = true;
}

void Console::progress(std::size_t done, std::size_t planned) {
  const auto now = std::chrono::steady_clock::now();
  if (options_.quiet || planned == 0) return;
  const double share = static_cast<double>(done) / static_cast<double>(planned);
  const auto left_s = time_left_.progress(now, share);
  const std::string left = left_s ? duration(*left_s) + " left" : "";
  if (!terminal_) {
    if (time_left_.line_is_due(now))
      std::fputs(fmt::format("{}: {:.0f} %, {}\n", phase_, 100 * share, left).c_str(), stderr);
    return;
  }
  if (now - last_draw_ < std::chrono::milliseconds(100) && done < planned) return;
  last_draw_ = now;
  // A line longer than the terminal could not be drawn over: the bar is shortened first, then the name.
  constexpr std::size_t longest_bar = 30, shortest_bar = 5;
  const std::string figures = fmt::format(" {:3.0f} %  {}", 100 * share, left);
  const std::size_t room = columns() - 1;
  const std::size_t others = columns_of(phase_) + 2 + columns_of(figures);
  const std::size_t length = others + shortest_bar <= room ? std::min(longest_bar, room - others) : 0;
  const auto filled = static_cast<std::size_t>(share * static_cast<double>(length));
  std::string bar;
  for (std::size_t i = 0; i < length; ++i) bar += i < filled ? "█" : "░";
  const std::string text =
      length > 0 ? phase_ + "  " + bar + figures : one_line(figures.substr(1) + "  " + phase_, room);
  std::fputs(("\r\033[K" + text).c_str(), stderr);
  std::fflush(stderr);
  bar_shown_ = true;
}

void Console::stands_still() {
  time_left_.stand_still(std::chrono::steady_clock::now());
}

void Console::end_progress() {
  if (!bar_shown_) return;
  std::fputs("\r\033[K", stderr);
  bar_shown_ = false;
}

Result<void> finish_output() {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return {};
  return fail(ErrorCode::io, "standard output cannot be written: it is full or closed");
}

std::string fixed(const std::optional<double>& value, int decimals) {
  if (!value || !std::isfinite(*value)) return "–";
  // Ends of intervals may be orders of magnitude away: neither zeros nor long figures would help.
  const bool shows = *value == 0 || (std::abs(*value) < 1e5 && std::abs(*value) * std::pow(10, decimals) >= 0.5);
  return shows ? fmt::format("{:.{}f}", *value, decimals) : fmt::format("{:.3g}", *value);
}

std::string range(const Interval& interval, int decimals) {
  return fixed(interval.low, decimals) + " … " + fixed(interval.high, decimals);
}

}  // namespace todbench
