// SPDX-License-Identifier: GPL-3.0-or-later
// VXI-11: older network instruments and GPIB gateways (VXI-11 TCP/IP Instrument Protocol Specification 1.0, 1995).
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>

#include "acquisition/base/result.h"
#include "tod/instruments/instrument_line.h"

namespace todbench {

/// The core channel (VXI-11, table B.1), for a client and for an emulated instrument.
namespace vxi11 {
inline constexpr std::uint32_t port_mapper = 100000, port_mapper_version = 2, get_port = 3, over_tcp = 6;
inline constexpr std::uint16_t port_mapper_port = 111;
inline constexpr std::uint32_t core = 395183, core_version = 1;
inline constexpr std::uint32_t create_link = 10, device_write = 11, device_read = 12, destroy_link = 23;
inline constexpr std::uint32_t end_flag = 8;    ///< of device_write: the last byte ends the message
inline constexpr std::uint32_t end_reason = 4;  ///< of device_read: the last byte ends the message
inline constexpr std::uint32_t error_timeout = 15;
}  // namespace vxi11

/// Opens a link to the device in the address. Queries the port mapper of the host unless the address states a port. The
/// end of an instrument's message is returned as a line end. Errors as open_line().
[[nodiscard]] Result<std::unique_ptr<InstrumentLine>> open_vxi11_line(
    const InstrumentAddress& address, InstrumentLine::TimePoint deadline, const std::stop_token& stop,
    std::uint16_t port_mapper_port = vxi11::port_mapper_port);

}  // namespace todbench
