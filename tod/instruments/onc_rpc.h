// SPDX-License-Identifier: GPL-3.0-or-later
// Remote procedure calls for VXI-11: ONC RPC version 2 over TCP (RFC 5531) with XDR data (RFC 4506).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "acquisition/base/result.h"
#include "tod/instruments/instrument_line.h"

namespace todbench {

/// Writes XDR data: big endian, in units of four bytes.
class XdrWriter {
 public:
  void number(std::uint32_t value);
  /// Appends opaque data or a string: length, bytes, zeros up to the next unit.
  void bytes(std::string_view value);
  [[nodiscard]] const std::string& data() const { return data_; }

 private:
  std::string data_;
};

/// Reads XDR data. If the data end before a value is complete, this result and all later results are empty.
class XdrReader {
 public:
  explicit XdrReader(std::string_view data) : data_(data) {}
  [[nodiscard]] std::optional<std::uint32_t> number();
  [[nodiscard]] std::optional<std::string> bytes();

 private:
  std::string_view data_;
};

/// Returns a message as one fragment with its record mark (RFC 5531, section 11).
[[nodiscard]] std::string rpc_record(std::string_view message);
/// Removes and returns the first whole record of `received`; empty while the record is incomplete. Error:
/// `disconnected` (more than 1 MiB).
[[nodiscard]] Result<std::optional<std::string>> take_rpc_record(std::string& received);

/// A connection to the programs of one server. One thread at a time.
class RpcClient {
 public:
  explicit RpcClient(Descriptor socket) : socket_(std::move(socket)) {}
  /// Calls a procedure and returns its results. Errors: `disconnected` (the reply does not match the call), `not_found`
  /// (the server has no such program or procedure), `timeout`, `interrupted`.
  [[nodiscard]] Result<std::string> call(std::uint32_t program, std::uint32_t version, std::uint32_t procedure,
                                         std::string_view arguments, InstrumentLine::TimePoint deadline,
                                         const std::stop_token& stop);

 private:
  Descriptor socket_;
  std::string received_;
  std::uint32_t last_id_ = 0;
};

}  // namespace todbench
