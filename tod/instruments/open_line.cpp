// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/instruments/open_line.h"

#include <utility>

#include "tod/instruments/serial_port.h"
#include "tod/instruments/vxi11_line.h"

namespace todbench {
namespace {

using TimePoint = InstrumentLine::TimePoint;

/// A line without a protocol of its own: TCP or serial.
class ByteLine final : public InstrumentLine {
 public:
  explicit ByteLine(Descriptor descriptor) : descriptor_(std::move(descriptor)) {}
  Result<void> send(std::string_view bytes, TimePoint deadline, const std::stop_token& stop) override {
    return send_all(descriptor_.get(), bytes, deadline, stop);
  }
  Result<std::string> receive(TimePoint deadline, const std::stop_token& stop) override {
    return receive_some(descriptor_.get(), deadline, stop);
  }

 private:
  Descriptor descriptor_;
};

Result<std::unique_ptr<InstrumentLine>> byte_line(Result<Descriptor> opened) {
  if (!opened) return tl::unexpected(opened.error());
  return std::make_unique<ByteLine>(std::move(*opened));
}

}  // namespace

Result<std::unique_ptr<InstrumentLine>> open_line(const InstrumentAddress& address, const SerialSettings& serial,
                                                  TimePoint deadline, const std::stop_token& stop) {
  switch (address.kind) {
    case InstrumentAddress::Kind::tcp:
      return byte_line(connect_tcp(address.host, address.port, deadline, stop));
    case InstrumentAddress::Kind::serial:
      return byte_line(open_serial_port(address.device, serial));
    case InstrumentAddress::Kind::vxi11:
      return open_vxi11_line(address, deadline, stop);
  }
  return fail(ErrorCode::invalid_input, "the kind of the address is unknown");
}

}  // namespace todbench
