// SPDX-License-Identifier: GPL-3.0-or-later
// Language part of an emulated SCPI instrument, without sockets: it converts program messages to response messages.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

namespace todbench {

/// One entry of the error queue, e.g. {-222, "Data out of range"} (SCPI-99 volume 2, chapter 21).
struct ScpiError {
  int code = 0;
  std::string message;
};

/// Response data of one command, or its error; the data are empty for a command that is not a query.
using ScpiAnswer = tl::expected<std::string, ScpiError>;

/// One command. `header` is written as in manuals: "[SOURce:]TEMPerature:DIFFerence?". Upper case is the short form,
/// brackets contain optional nodes, a query ends with '?'. `run` receives the parameters without quotes and returns the
/// response; it is called on the thread that executes the message.
struct ScpiCommand {
  std::string header;
  std::function<ScpiAnswer(std::span<const std::string> parameters)> run;
};

/// Returns whether `text` is the short or long form of a mnemonic like "DIFFerence", in upper or lower case.
[[nodiscard]] bool scpi_keyword(std::string_view text, std::string_view mnemonic);

/// Parses a number in [min, max], or the words MINimum and MAXimum. An optional suffix must be `unit`. Errors: -131
/// (suffix), -104 (not a number), -222 (out of range).
[[nodiscard]] tl::expected<double, ScpiError> scpi_number(std::string_view text, double min, double max,
                                                          std::string_view unit);
/// Succeeds if there are exactly `count` parameters. Errors: -109 (too few), -108 (too many).
[[nodiscard]] tl::expected<void, ScpiError> scpi_count(std::span<const std::string> parameters, std::size_t count);
/// Returns a number with this many decimals; "9.91E37" for a number that is not finite.
[[nodiscard]] std::string scpi_decimal(double value, int decimals);

/// Commands of an instrument. Immutable, shared by its sessions.
class ScpiLanguage {
 public:
  /// Creates the language. `identity` is the response to *IDN?. The commands *IDN?, *CLS, *OPC?, SYSTem:ERRor[:NEXT]?
  /// and SYSTem:VERSion? are built in.
  ScpiLanguage(std::string identity, std::vector<ScpiCommand> commands);
  [[nodiscard]] const std::string& identity() const { return identity_; }
  /// Returns the command with this header in short or long form; null if there is none.
  [[nodiscard]] const ScpiCommand* find(std::string_view header) const;

 private:
  std::string identity_;
  std::vector<ScpiCommand> commands_;
};

/// One connection to an instrument, with its own error queue: at most 16 entries, and on overflow the last entry
/// becomes -350. One thread at a time.
class ScpiSession {
 public:
  explicit ScpiSession(const ScpiLanguage& language) : language_(&language) {}  ///< `language` must outlive the session
  /// Executes one program message without its line end. Returns the responses to its queries, separated by ';', or an
  /// empty string without queries. A command error (-1xx) discards the rest of the message (IEEE 488.2). Headers after
  /// ';' continue the path of the previous header (SCPI-99 6.2.4).
  [[nodiscard]] std::string execute(std::string_view message);
  /// Adds an error to the queue.
  void report(ScpiError error);

 private:
  [[nodiscard]] ScpiAnswer run(const std::string& header, std::span<const std::string> parameters);
  [[nodiscard]] std::string next_error();

  const ScpiLanguage* language_;
  std::deque<ScpiError> errors_;
};

}  // namespace todbench
