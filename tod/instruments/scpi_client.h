// SPDX-License-Identifier: GPL-3.0-or-later
// A client of one instrument with a line-based protocol. By default the protocol is SCPI over a raw TCP socket
// ("SCPI-RAW" of LXI instruments, usually port 5025). The instrument's table may state a different protocol.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/instruments/instrument_line.h"
#include "tod/instruments/instrument_table.h"

namespace todbench {

/// Limits of a connection.
struct ScpiClientOptions {
  std::chrono::milliseconds connect_timeout{3000};
  /// Longest time from the start of a command to the last character of the answer.
  std::chrono::milliseconds answer_timeout{1000};
  /// Maximum number of characters of an answer. If a peer sends more characters without a line end, the connection is
  /// closed.
  std::size_t longest_answer = 8192;
};

/// The four fields of the answer to *IDN? (IEEE 488.2, 10.14). If an instrument answers in a different form, only
/// `model` is set.
struct ScpiIdentity {
  std::string vendor, model, serial, firmware;
  bool operator==(const ScpiIdentity&) const = default;
};
/// Returns "vendor model, serial S".
[[nodiscard]] std::string to_text(const ScpiIdentity& identity);

/// A connection. One thread at a time. SYST:ERR? (or the error query of the table) is sent after each exchange, so a
/// refused command is reported as an error immediately. After `disconnected`, `timeout` or `interrupted` the connection
/// is closed, because a late answer could be mistaken for the answer to the next query. Connect again after these
/// errors.
class ScpiClient {
 public:
  /// Connects to an instrument. `endpoint`: as for instrument_address(). Clears the instrument's error queue and sends
  /// *IDN?, or the replacements stated by `speech`. Errors: `invalid_input` (endpoint), `not_found` (no connection, or
  /// not the expected instrument), `interrupted`.
  [[nodiscard]] static Result<ScpiClient> connect(const std::string& endpoint, const ScpiClientOptions& options,
                                                  const std::stop_token& stop, const InstrumentSpeech& speech = {});

  [[nodiscard]] const ScpiIdentity& identity() const { return identity_; }
  [[nodiscard]] bool is_open() const { return line_ != nullptr; }

  /// Sends a command that has no answer. Error: `invalid_input` with the instrument's message if it refuses the
  /// command.
  [[nodiscard]] Result<void> command(std::string_view text, const std::stop_token& stop);
  /// Sends a query and returns its answer without the line end. Error: `invalid_input` if the instrument refuses the
  /// query.
  [[nodiscard]] Result<std::string> query(std::string_view text, const std::stop_token& stop);
  /// Returns the finite numbers of an answer of the form `form` (numbers_in()). For any other answer the error is
  /// `disconnected`, because later answers cannot be trusted.
  [[nodiscard]] Result<std::vector<double>> query_form(std::string_view text, std::string_view form,
                                                       const std::stop_token& stop);

 private:
  using TimePoint = InstrumentLine::TimePoint;
  ScpiClient(std::unique_ptr<InstrumentLine> line, ScpiClientOptions options, InstrumentSpeech speech);
  [[nodiscard]] Result<TimePoint> begin(const std::stop_token& stop);
  [[nodiscard]] bool reports_with_command() const;
  [[nodiscard]] Result<void> send(std::string_view text, TimePoint deadline, const std::stop_token& stop);
  [[nodiscard]] Result<std::string> receive_line(TimePoint deadline, const std::stop_token& stop);
  [[nodiscard]] Result<void> identify(const std::stop_token& stop);
  [[nodiscard]] Result<std::string> query_with_report(std::string_view text, const std::stop_token& stop);
  [[nodiscard]] Result<std::string> query_before_report(std::string_view text, const std::stop_token& stop);
  [[nodiscard]] Result<void> check_report(std::string_view text, const std::string& report);
  [[nodiscard]] Result<void> ask_for_errors(std::string_view text, const std::stop_token& stop);
  [[nodiscard]] tl::unexpected<Error> give_up(Error error);

  std::unique_ptr<InstrumentLine> line_;  ///< null once closed
  ScpiClientOptions options_;
  InstrumentSpeech speech_;
  ScpiIdentity identity_;
  std::string received_;
  TimePoint last_exchange_{};
};

/// Splits an answer at commas outside quotes, removes quotes, and replaces doubled inner quotes by single quotes.
[[nodiscard]] std::vector<std::string> scpi_fields(std::string_view answer);
/// Returns a text as SCPI string data: in quotes, with inner quotes doubled.
[[nodiscard]] std::string scpi_quoted(std::string_view text);

}  // namespace todbench
