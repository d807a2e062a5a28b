// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/instruments/vxi11_line.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include "acquisition/base/try.h"
#include "tod/instruments/onc_rpc.h"

namespace todbench {
namespace {

using std::chrono::milliseconds;
using TimePoint = InstrumentLine::TimePoint;

constexpr std::uint32_t most_read = 4096;
/// Time for an instrument to report its own timeout, after the time in which it should have answered.
constexpr milliseconds grace{500};

std::uint32_t milliseconds_until(TimePoint deadline) {
  const auto left = std::chrono::duration_cast<milliseconds>(deadline - std::chrono::steady_clock::now());
  return static_cast<std::uint32_t>(std::clamp<milliseconds::rep>(left.count(), 0, 3'600'000));
}

/// Device_ErrorCode (VXI-11, table B.2).
tl::unexpected<Error> device_error(std::optional<std::uint32_t> error) {
  if (!error) return fail(ErrorCode::disconnected, "the answer is not a reply of VXI-11");
  switch (*error) {
    case 3:
      return fail(ErrorCode::not_found, "the device is not accessible");
    case 9:
      return fail(ErrorCode::not_found, "the instrument has no free resources");
    case 11:
      return fail(ErrorCode::not_found, "the device is locked by another program");
    case vxi11::error_timeout:
      return fail(ErrorCode::timeout, "no answer within the time limit");
    default:
      return fail(ErrorCode::disconnected, "VXI-11 error " + std::to_string(*error));
  }
}

class Vxi11Line final : public InstrumentLine {
 public:
  explicit Vxi11Line(RpcClient client) : client_(std::move(client)) {}
  ~Vxi11Line() override {
    if (!linked_) return;
    XdrWriter arguments;
    arguments.number(link_);
    // An instrument has few links; one that does not answer keeps this one until it notices the loss.
    [[maybe_unused]] const auto closed =
        call(vxi11::destroy_link, arguments, std::chrono::steady_clock::now() + milliseconds(200), {});
  }
  Vxi11Line(const Vxi11Line&) = delete;
  Vxi11Line& operator=(const Vxi11Line&) = delete;

  Result<void> link(const std::string& device, TimePoint deadline, const std::stop_token& stop) {
    XdrWriter arguments;
    for (const std::uint32_t value : {1U, 0U, 0U}) arguments.number(value);  // client, no lock, no wait for one
    arguments.bytes(device);
    TODBENCH_TRY(auto results, call(vxi11::create_link, arguments, deadline, stop));
    XdrReader reader(results);
    const auto error = reader.number(), id = reader.number(), abort_port = reader.number(), most = reader.number();
    if (!error || *error != 0) return device_error(error);
    if (!id || !abort_port || !most || *most == 0) return device_error(std::nullopt);
    link_ = *id;
    most_written_ = std::min<std::size_t>(*most, 65536);
    linked_ = true;
    return {};
  }

  Result<void> send(std::string_view bytes, TimePoint deadline, const std::stop_token& stop) override {
    while (!bytes.empty()) {
      const auto part = bytes.substr(0, most_written_);
      XdrWriter arguments;
      arguments.number(link_);
      arguments.number(milliseconds_until(deadline));
      arguments.number(0);
      arguments.number(part.size() == bytes.size() ? vxi11::end_flag : 0);
      arguments.bytes(part);
      TODBENCH_TRY(auto results, call(vxi11::device_write, arguments, deadline + grace, stop));
      XdrReader reader(results);
      const auto error = reader.number(), taken = reader.number();
      if (!error || *error != 0) return device_error(error);
      if (!taken || *taken == 0 || *taken > part.size()) return device_error(std::nullopt);
      bytes.remove_prefix(*taken);
    }
    return {};
  }

  Result<std::string> receive(TimePoint deadline, const std::stop_token& stop) override {
    for (;;) {
      XdrWriter arguments;
      for (const std::uint32_t value : {link_, most_read, milliseconds_until(deadline), 0U, 0U, 0U})
        arguments.number(value);
      TODBENCH_TRY(auto results, call(vxi11::device_read, arguments, deadline + grace, stop));
      XdrReader reader(results);
      const auto error = reader.number(), reason = reader.number();
      auto data = reader.bytes();
      if (!error || *error != 0) return device_error(error);
      if (!reason || !data) return device_error(std::nullopt);
      if ((*reason & vxi11::end_reason) != 0 && !data->ends_with('\n')) *data += '\n';
      if (!data->empty()) return *data;
      if (std::chrono::steady_clock::now() >= deadline) return device_error(vxi11::error_timeout);
    }
  }

  [[nodiscard]] bool one_at_a_time() const override { return true; }

 private:
  Result<std::string> call(std::uint32_t procedure, const XdrWriter& arguments, TimePoint deadline,
                           const std::stop_token& stop) {
    return client_.call(vxi11::core, vxi11::core_version, procedure, arguments.data(), deadline, stop);
  }

  RpcClient client_;
  std::uint32_t link_ = 0;
  std::size_t most_written_ = 0;
  bool linked_ = false;
};

Result<std::uint16_t> port_of_core(const std::string& host, std::uint16_t port_mapper_port, TimePoint deadline,
                                   const std::stop_token& stop) {
  auto socket = connect_tcp(host, port_mapper_port, deadline, stop);
  if (!socket) return fail("asking the port mapper", socket.error());
  XdrWriter arguments;
  for (const std::uint32_t value : {vxi11::core, vxi11::core_version, vxi11::over_tcp, 0U}) arguments.number(value);
  const auto results =
      RpcClient(std::move(*socket))
          .call(vxi11::port_mapper, vxi11::port_mapper_version, vxi11::get_port, arguments.data(), deadline, stop);
  if (!results) return fail("asking the port mapper", results.error());
  const auto port = XdrReader(*results).number();
  if (!port || *port == 0 || *port > 65535)
    return fail(ErrorCode::not_found, "the port mapper has no entry for VXI-11");
  return static_cast<std::uint16_t>(*port);
}

}  // namespace

Result<std::unique_ptr<InstrumentLine>> open_vxi11_line(const InstrumentAddress& address, TimePoint deadline,
                                                        const std::stop_token& stop, std::uint16_t port_mapper_port) {
  std::uint16_t port = address.port;
  if (port == 0) {
    TODBENCH_TRY(port, port_of_core(address.host, port_mapper_port, deadline, stop));
  }
  TODBENCH_TRY(auto socket, connect_tcp(address.host, port, deadline, stop));
  auto line = std::make_unique<Vxi11Line>(RpcClient(std::move(socket)));
  if (auto linked = line->link(address.device, deadline, stop); !linked)
    return fail("opening a VXI-11 link to " + address.device, linked.error());
  return line;
}

}  // namespace todbench
