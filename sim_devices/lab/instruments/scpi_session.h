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

/// Response data of one command; empty for a command that is not a query.
using ScpiAnswer = tl::expected<std::string, ScpiError>;

/// One command. `header` is written as in manuals: "[SOURce:]TEMPerature:DIFFerence?". Upper case is the short form,
/// brackets are optional nodes, a query ends with '?'. `run` receives the parameters without quotes, on the thread that
/// executes the message.
struct ScpiCommand {
  std::string header;
  std::function<ScpiAnswer(std::span<const std::string> parameters)> run;
};

/// Returns whether `text` is the short or long form of a mnemonic such as "DIFFerence", in any case.
[[nodiscard]] bool scpi_keyword(std::string_view text, std::string_view mnemonic);

/// Parses a number in [min, max], or MINimum/MAXimum; an optional suffix must be `unit`. Errors: -131 (suffix), -104
/// (no number), -222 (range).
[[nodiscard]] tl::expected<double, ScpiError> scpi_number(std::string_view text, double min, double max,
                                                          std::string_view unit);
/// Succeeds if there are exactly `count` parameters. Errors: -109 (too few), -108 (too many).
[[nodiscard]] tl::expected<void, ScpiError> scpi_count(std::span<const std::string> parameters, std::size_t count);
/// Returns a number with this many decimals.
[[nodiscard]] std::string scpi_decimal(double value, int decimals);

/// Commands of an instrument. Immutable, shared by its sessions.
class ScpiLanguage {
 public:
  /// Creates the language. `identity` is the response to *IDN?. The commands *IDN?, *CLS, *OPC?, SYSTem:ERRor[:NEXT]?
  /// and SYSTem:VERSion? are built in.
  ScpiLanguage(std::string identity, std::vector<ScpiCommand> commands);
  [[nodiscard]] const std::string& identity() const { return identity_; }
  /// Returns nullptr if no command has this header.
  [[nodiscard]] const ScpiCommand* find(std::string_view header) const;

 private:
  std::string identity_;
  std::vector<ScpiCommand> commands_;
};

/// One connection to an instrument, with its own error queue (at most 16 entries, the last becomes -350). One thread at
/// a time.
class ScpiSession {
 public:
  explicit ScpiSession(const ScpiLanguage& language) : language_(&language) {}  ///< `language` must outlive the session
  /// Executes one program message without its line end. Responses to several queries are separated by ';'; the result
  /// is empty if there is no response. A command error (-1xx) discards the rest of the message (IEEE 488.2). Headers
  /// after ';' continue the previous path (SCPI-99 6.2.4).
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
