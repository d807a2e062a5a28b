// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/instruments/scpi_client.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <system_error>
#include <utility>

#include "acquisition/base/try.h"
#include "tod/instruments/open_line.h"

namespace todbench {
namespace {

using Clock = std::chrono::steady_clock;

std::string in_seconds(std::chrono::milliseconds time) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), static_cast<double>(time.count()) / 1000.0);
  return std::string(text.data(), end.ptr) + " s";
}

// Text of a peer for messages: short, without characters that move the cursor of a terminal.
std::string printable(std::string_view text) {
  std::string shown(text.substr(0, 80));
  std::replace_if(
      shown.begin(), shown.end(), [](unsigned char c) { return c < 0x20 || c > 0x7e; }, '?');
  return "'" + shown + "'";
}

// The error code of a SYST:ERR? answer such as -222,"Data out of range"; empty if the line is not one.
std::optional<int> error_report(std::string_view line) {
  if (!line.empty() && line.front() == '+') line.remove_prefix(1);
  int code = 0;
  const auto parsed = std::from_chars(line.data(), line.data() + line.size(), code);
  const std::string_view rest(parsed.ptr, static_cast<std::size_t>(line.data() + line.size() - parsed.ptr));
  if (parsed.ec != std::errc{} || rest.size() < 3 || !rest.starts_with(",\"") || rest.back() != '"') return {};
  return code;
}

bool any_begins(std::string_view answer, const std::vector<std::string>& beginnings) {
  return std::any_of(beginnings.begin(), beginnings.end(),
                     [&](const std::string& beginning) { return answer.starts_with(beginning); });
}

std::string refusal(std::string_view text, std::string_view answer) {
  return std::string(text) + ": rejected by the instrument: " + printable(answer);
}

}  // namespace

std::string to_text(const ScpiIdentity& identity) {
  std::string text = identity.vendor;
  if (!identity.model.empty()) text += (text.empty() ? "" : " ") + identity.model;
  return identity.serial.empty() ? text : text + ", serial " + identity.serial;
}

std::vector<std::string> scpi_fields(std::string_view answer) {
  std::vector<std::string> fields(1);
  char quote = 0;
  bool closed_just_now = false;  // a second quote directly after the first stands for one quote
  for (const char c : answer) {
    if (quote != 0 && c == quote) {
      quote = 0;
      closed_just_now = true;
      continue;
    }
    if (quote == 0 && (c == '"' || c == '\'')) {
      if (closed_just_now) fields.back() += c;
      quote = c;
    } else if (quote == 0 && c == ',') {
      fields.emplace_back();
    } else if (quote != 0 || c != ' ' || !fields.back().empty()) {
      fields.back() += c;
    }
    closed_just_now = false;
  }
  return fields;
}

std::string scpi_quoted(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + "\"";
}

ScpiClient::ScpiClient(std::unique_ptr<InstrumentLine> line, ScpiClientOptions options, InstrumentSpeech speech)
    : line_(std::move(line)), options_(options), speech_(std::move(speech)) {
  if (speech_.answer_timeout_s)
    options_.answer_timeout = std::chrono::milliseconds(std::llround(*speech_.answer_timeout_s * 1000));
}

Result<ScpiClient> ScpiClient::connect(const std::string& endpoint, const ScpiClientOptions& options,
                                       const std::stop_token& stop, const InstrumentSpeech& speech) {
  TODBENCH_TRY(const auto address, instrument_address(endpoint, speech.port));
  auto line = open_line(address, speech.serial, Clock::now() + options.connect_timeout, stop);
  if (!line) {
    Error error = line.error();
    if (error.code != ErrorCode::interrupted) error.code = ErrorCode::not_found;
    return fail("connecting to " + endpoint, error);
  }
  ScpiClient client(std::move(*line), options, speech);
  if (auto identified = client.identify(stop); !identified) {
    Error error = identified.error();
    if (error.code != ErrorCode::interrupted) error.code = ErrorCode::not_found;
    return fail("identifying the instrument at " + endpoint, error);
  }
  return client;
}

Result<ScpiClient::TimePoint> ScpiClient::begin(const std::stop_token& stop) {
  if (!line_) return fail(ErrorCode::disconnected, "the connection is closed");
  const auto until = last_exchange_ + std::chrono::milliseconds(std::llround(speech_.pause_s * 1000));
  // No descriptor: only a stop request ends the wait early.
  if (Clock::now() < until && wait_on(-1, WaitFor::reading, until, stop) == Waited::stopped)
    return give_up({ErrorCode::interrupted, "stopped on request"});
  return Clock::now() + options_.answer_timeout;
}

bool ScpiClient::reports_with_command() const {
  return !speech_.error_query.empty() && speech_.errors_asked == InstrumentSpeech::ErrorsAsked::with_command && line_ &&
         !line_->one_at_a_time();
}

Result<void> ScpiClient::identify(const std::stop_token& stop) {
  TODBENCH_TRY(const auto deadline, begin(stop));
  // Removes errors that earlier connections left in the queue.
  const std::string clear = speech_.clear.empty() ? "" : speech_.clear + speech_.ending;
  const std::string ask = speech_.identity_query.empty() ? "" : speech_.identity_query + speech_.ending;
  if (clear.empty() && ask.empty()) return {};
  if (line_->one_at_a_time() && !clear.empty()) {
    TODBENCH_TRY_VOID(send(clear, deadline, stop));
    if (ask.empty()) return {};
    TODBENCH_TRY_VOID(send(ask, deadline, stop));
  } else if (auto sent = send(clear + ask, deadline, stop); !sent) {
    return sent;
  }
  if (ask.empty()) return {};
  auto line = receive_line(deadline, stop);
  if (!line) return give_up(with_context(speech_.identity_query, line.error()));
  last_exchange_ = Clock::now();
  const auto wrong = [&](const std::string& expected) {
    return give_up({ErrorCode::not_found, speech_.identity_query + " answered " + printable(*line) + ", " + expected});
  };
  if (line->find(speech_.identity_contains) == std::string::npos)
    return wrong("expected an answer that contains '" + speech_.identity_contains + "'");
  if (!speech_.identity_of_four) {
    identity_.model = printable(*line);
    return {};
  }
  auto fields = scpi_fields(*line);
  if (fields.size() != 4 || fields[1].empty() || fields[2].empty())
    return wrong("expected vendor,model,serial,firmware");
  identity_ = {fields[0], fields[1], fields[2], fields[3]};
  return {};
}

Result<void> ScpiClient::command(std::string_view text, const std::stop_token& stop) {
  TODBENCH_TRY(const auto deadline, begin(stop));
  // Two lines in one packet: after a syntax error the rest of the same line would be discarded (IEEE 488.2).
  const bool together = reports_with_command();
  const std::string report_ask = together ? speech_.error_query + speech_.ending : "";
  TODBENCH_TRY_VOID(send(std::string(text) + speech_.ending + report_ask, deadline, stop));
  if (!speech_.acknowledgement.empty()) {
    auto answer = receive_line(deadline, stop);
    if (!answer) return give_up(with_context(text, answer.error()));
    if (*answer != speech_.acknowledgement) return fail(ErrorCode::invalid_input, refusal(text, *answer));
  }
  if (!together) {
    last_exchange_ = Clock::now();
    return ask_for_errors(text, stop);
  }
  auto report = receive_line(deadline, stop);
  if (!report) return give_up(with_context(text, report.error()));
  return check_report(text, *report);
}

Result<std::string> ScpiClient::query(std::string_view text, const std::stop_token& stop) {
  return reports_with_command() ? query_with_report(text, stop) : query_before_report(text, stop);
}

Result<std::string> ScpiClient::query_with_report(std::string_view text, const std::stop_token& stop) {
  TODBENCH_TRY(const auto deadline, begin(stop));
  const std::string both = std::string(text) + speech_.ending + speech_.error_query + speech_.ending;
  TODBENCH_TRY_VOID(send(both, deadline, stop));
  auto answer = receive_line(deadline, stop);
  if (!answer) return give_up(with_context(text, answer.error()));
  // A refused query has no answer of its own: the first line already is the error report.
  if (error_report(*answer)) return fail(ErrorCode::invalid_input, refusal(text, *answer));
  auto report = receive_line(deadline, stop);
  if (!report) return give_up(with_context(text, report.error()));
  TODBENCH_TRY_VOID(check_report(text, *report));
  return answer;
}

Result<std::string> ScpiClient::query_before_report(std::string_view text, const std::stop_token& stop) {
  TODBENCH_TRY(const auto deadline, begin(stop));
  TODBENCH_TRY_VOID(send(std::string(text) + speech_.ending, deadline, stop));
  auto answer = receive_line(deadline, stop);
  last_exchange_ = Clock::now();
  if (!answer) {
    // An instrument that refuses a query does not answer it, but may report the error when queried.
    if (answer.error().code == ErrorCode::timeout && line_) {
      const auto report = ask_for_errors(text, stop);
      if (!report && report.error().code == ErrorCode::invalid_input) return tl::unexpected(report.error());
    }
    return give_up(with_context(text, answer.error()));
  }
  if (any_begins(*answer, speech_.refusals)) return fail(ErrorCode::invalid_input, refusal(text, *answer));
  TODBENCH_TRY_VOID(ask_for_errors(text, stop));
  return answer;
}

Result<void> ScpiClient::ask_for_errors(std::string_view text, const std::stop_token& stop) {
  if (speech_.error_query.empty()) return {};
  TODBENCH_TRY(const auto deadline, begin(stop));
  TODBENCH_TRY_VOID(send(speech_.error_query + speech_.ending, deadline, stop));
  auto report = receive_line(deadline, stop);
  if (!report) return give_up(with_context(text, report.error()));
  return check_report(text, *report);
}

Result<void> ScpiClient::check_report(std::string_view text, const std::string& report) {
  last_exchange_ = Clock::now();
  if (!speech_.no_error.empty()) {
    if (std::find(speech_.no_error.begin(), speech_.no_error.end(), report) != speech_.no_error.end()) return {};
    return fail(ErrorCode::invalid_input, refusal(text, report));
  }
  const auto code = error_report(report);
  if (!code)
    return give_up(
        {ErrorCode::disconnected, std::string(text) + ": " + speech_.error_query + " answered " + printable(report)});
  if (*code != 0) return fail(ErrorCode::invalid_input, refusal(text, report));
  return {};
}

Result<std::vector<double>> ScpiClient::query_form(std::string_view text, std::string_view form,
                                                   const std::stop_token& stop) {
  TODBENCH_TRY(auto answer, query(text, stop));
  auto numbers = numbers_in(answer, form);
  if (!numbers)
    return give_up({ErrorCode::disconnected, std::string(text) + ": the instrument answered " + printable(answer) +
                                                 ", expected '" + std::string(form) + "' with a number for each {}"});
  return *numbers;
}

Result<void> ScpiClient::send(std::string_view text, TimePoint deadline, const std::stop_token& stop) {
  received_.clear();  // late bytes belong to no future command
  auto sent = line_->send(text, deadline, stop);
  if (sent) return sent;
  if (sent.error().code == ErrorCode::timeout)
    return give_up(
        {ErrorCode::timeout, "the instrument accepted no command within " + in_seconds(options_.answer_timeout)});
  return give_up(sent.error());
}

Result<std::string> ScpiClient::receive_line(TimePoint deadline, const std::stop_token& stop) {
  for (;;) {
    if (const auto end = received_.find(speech_.answer_ending); end != std::string::npos) {
      std::string line = received_.substr(0, end);
      received_.erase(0, end + 1);
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (!line.empty() && line.front() == '\n' && speech_.answer_ending == '\r') line.erase(0, 1);
      return line;
    }
    if (received_.size() > options_.longest_answer)
      return give_up({ErrorCode::disconnected, "connection closed: the instrument sent more than " +
                                                   std::to_string(options_.longest_answer) +
                                                   " characters without an end of line"});
    auto some = line_->receive(deadline, stop);
    if (!some && some.error().code == ErrorCode::timeout)
      return fail(ErrorCode::timeout, "no answer within " + in_seconds(options_.answer_timeout));
    if (!some) return give_up(some.error());
    received_ += *some;
  }
}

tl::unexpected<Error> ScpiClient::give_up(Error error) {
  line_.reset();
  received_.clear();
  return tl::unexpected(std::move(error));
}

}  // namespace todbench
