// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/instruments/onc_rpc.h"

#include <utility>

#include "acquisition/base/try.h"

namespace todbench {
namespace {

constexpr std::size_t xdr_unit = 4;
constexpr std::size_t longest_record = std::size_t{1} << 20;
constexpr std::uint32_t last_fragment = 0x80000000;

std::uint32_t big_endian(std::string_view four) {
  std::uint32_t value = 0;
  for (const char c : four.substr(0, xdr_unit)) value = value << 8 | static_cast<unsigned char>(c);
  return value;
}

std::size_t padded(std::size_t size) {
  return (size + xdr_unit - 1) / xdr_unit * xdr_unit;
}

/// The results in a reply to call `id`; RFC 5531, section 9.
Result<std::string> results_of(std::string_view record, std::uint32_t id) {
  const auto nonsense = fail(ErrorCode::disconnected, "the answer is not a reply of ONC RPC");
  XdrReader reader(record);
  if (reader.number() != id || reader.number() != 1U) return nonsense;
  const auto accepted = reader.number();
  if (!accepted || *accepted > 1) return nonsense;
  if (*accepted == 1) return fail(ErrorCode::not_found, "the server denied the call");
  const auto flavour = reader.number();
  const auto verifier = reader.bytes();
  const auto status = reader.number();
  if (!flavour || !verifier || !status) return nonsense;
  if (*status == 1 || *status == 2 || *status == 3)
    return fail(ErrorCode::not_found, "the server has no such program, version or procedure");
  if (*status != 0) return fail(ErrorCode::disconnected, "the server could not execute the call");
  const std::size_t head = 5 * xdr_unit + padded(verifier->size()) + xdr_unit;
  return std::string(record.substr(head));
}

}  // namespace

void XdrWriter::number(std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) data_ += static_cast<char>(value >> shift & 0xff);
}

void XdrWriter::bytes(std::string_view value) {
  number(static_cast<std::uint32_t>(value.size()));
  data_ += value;
  data_.append(padded(value.size()) - value.size(), '\0');
}

std::optional<std::uint32_t> XdrReader::number() {
  if (data_.size() < xdr_unit) {
    data_ = {};
    return {};
  }
  const std::uint32_t value = big_endian(data_);
  data_.remove_prefix(xdr_unit);
  return value;
}

std::optional<std::string> XdrReader::bytes() {
  const auto size = number();
  if (!size || data_.size() < padded(*size)) {
    data_ = {};
    return {};
  }
  std::string value(data_.substr(0, *size));
  data_.remove_prefix(padded(*size));
  return value;
}

std::string rpc_record(std::string_view message) {
  XdrWriter mark;
  mark.number(last_fragment | static_cast<std::uint32_t>(message.size()));
  return mark.data() + std::string(message);
}

Result<std::optional<std::string>> take_rpc_record(std::string& received) {
  std::string record;
  std::size_t place = 0;
  for (;;) {
    if (received.size() < place + xdr_unit) return std::nullopt;
    const std::uint32_t mark = big_endian(std::string_view(received).substr(place));
    const std::size_t size = mark & ~last_fragment;
    if (record.size() + size > longest_record || (size == 0 && (mark & last_fragment) == 0))
      return fail(ErrorCode::disconnected, "the record does not conform to ONC RPC");
    if (received.size() < place + xdr_unit + size) return std::nullopt;
    record += received.substr(place + xdr_unit, size);
    place += xdr_unit + size;
    if ((mark & last_fragment) == 0) continue;
    received.erase(0, place);
    return record;
  }
}

Result<std::string> RpcClient::call(std::uint32_t program, std::uint32_t version, std::uint32_t procedure,
                                    std::string_view arguments, InstrumentLine::TimePoint deadline,
                                    const std::stop_token& stop) {
  const std::uint32_t id = ++last_id_;
  XdrWriter message;
  for (const std::uint32_t value : {id, 0U, 2U, program, version, procedure, 0U, 0U, 0U, 0U}) message.number(value);
  TODBENCH_TRY_VOID(send_all(socket_.get(), rpc_record(message.data() + std::string(arguments)), deadline, stop));
  for (;;) {
    TODBENCH_TRY(auto record, take_rpc_record(received_));
    if (record) return results_of(*record, id);
    TODBENCH_TRY(auto some, receive_some(socket_.get(), deadline, stop));
    received_ += some;
  }
}

}  // namespace todbench
