// One instrument that speaks in lines: SCPI over a raw TCP socket (the "SCPI-RAW" of LXI instruments, port 5025 by
// custom) unless its table says otherwise.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "tod/instruments/instrument_line.h"
#include "tod/instruments/instrument_table.h"

namespace todbench {

struct ScpiClientOptions {
  std::chrono::milliseconds connect_timeout{3000};
  std::chrono::milliseconds answer_timeout{1000};  ///< from sending a command to the last character of its answer
  std::size_t longest_answer = 8192;               ///< characters; a peer that sends more without a line end is dropped
};

/// The four fields of *IDN? (IEEE 488.2, 10.14). An instrument that has no such answer has a model only.
struct ScpiIdentity {
  std::string vendor, model, serial, firmware;
  bool operator==(const ScpiIdentity&) const = default;
};
/// "vendor model, serial S"
[[nodiscard]] std::string to_text(const ScpiIdentity& identity);

/// A connection. One thread at a time. Each exchange is followed by SYST:ERR? (or the error query of the table), so
/// that a refused command is an error here and not a surprise later. After `disconnected`, `timeout` or `interrupted`
/// the connection is closed, because an answer may still be on its way and would be taken for the next one: connect
/// anew.
class ScpiClient {
 public:
  /// `endpoint` is an instrument_address(). Clears the instrument's error queue and asks for *IDN?, or what `speech`
  /// has in their place. Errors: `invalid_input` (endpoint), `not_found` (no connection, or no such instrument behind
  /// it), `interrupted`.
  [[nodiscard]] static Result<ScpiClient> connect(const std::string& endpoint, const ScpiClientOptions& options,
                                                  const std::stop_token& stop, const InstrumentSpeech& speech = {});

  [[nodiscard]] const ScpiIdentity& identity() const { return identity_; }
  [[nodiscard]] bool is_open() const { return line_ != nullptr; }

  /// Sends a command that has no answer. `invalid_input` with the instrument's own words when it refuses.
  [[nodiscard]] Result<void> command(std::string_view text, const std::stop_token& stop);
  /// Sends a query and returns its answer without the line end. `invalid_input` when the instrument refuses.
  [[nodiscard]] Result<std::string> query(std::string_view text, const std::stop_token& stop);
  /// A query whose answer is `count` finite numbers separated by commas. Anything else is `disconnected`: what follows
  /// cannot be trusted.
  [[nodiscard]] Result<std::vector<double>> query_numbers(std::string_view text, std::size_t count,
                                                          const std::stop_token& stop);
  /// A query whose answer looks like `form` (numbers_in()). The same.
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

  std::unique_ptr<InstrumentLine> line_;  ///< none once it was closed
  ScpiClientOptions options_;
  InstrumentSpeech speech_;
  ScpiIdentity identity_;
  std::string received_;
  TimePoint last_exchange_{};
};

/// Splits an answer at commas outside quotes; quotes are removed and doubled quotes inside them become one.
[[nodiscard]] std::vector<std::string> scpi_fields(std::string_view answer);
/// A text as SCPI string data: "in quotes", quotes inside doubled.
[[nodiscard]] std::string scpi_quoted(std::string_view text);

}  // namespace todbench
