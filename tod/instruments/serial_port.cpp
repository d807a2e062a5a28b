// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/instruments/serial_port.h"

#include <fcntl.h>
#include <sys/file.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <iterator>
#include <system_error>

namespace todbench {
namespace {

constexpr std::array<speed_t, serial_bauds.size()> serial_speeds{B1200,  B2400,  B4800,   B9600,  B19200,
                                                                 B38400, B57600, B115200, B230400};

tl::unexpected<Error> port_error(const std::string& path, int error) {
  std::string why = std::generic_category().message(error);
  if (error == EACCES) why += " (join the group dialout to open it: sudo adduser $USER dialout)";
  if (error == ENOTTY) why = "not a serial port";
  if (error == EBUSY) why = "in use by another program";
  return fail(ErrorCode::not_found, path + ": " + why);
}

tcflag_t control_flags(const SerialSettings& settings) {
  tcflag_t flags = CREAD | CLOCAL;
  flags |= settings.data_bits == 7 ? CS7 : CS8;
  if (settings.stop_bits == 2) flags |= CSTOPB;
  if (settings.parity != SerialSettings::Parity::none) flags |= PARENB;
  if (settings.parity == SerialSettings::Parity::odd) flags |= PARODD;
  if (settings.flow == SerialSettings::Flow::hardware) flags |= CRTSCTS;
  return flags;
}

}  // namespace

Result<Descriptor> open_serial_port(const std::string& path, const SerialSettings& settings) {
  // Does not wait for a carrier, and never becomes this program's controlling terminal.
  Descriptor port(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!port.is_open()) return port_error(path, errno);
  termios asked{};
  if (::tcgetattr(port.get(), &asked) != 0) return port_error(path, ENOTTY);
  if (::flock(port.get(), LOCK_EX | LOCK_NB) != 0) return port_error(path, errno == EWOULDBLOCK ? EBUSY : errno);
  ::cfmakeraw(&asked);
  asked.c_cflag = control_flags(settings);
  if (settings.flow == SerialSettings::Flow::software) asked.c_iflag |= IXON | IXOFF;
  if (settings.parity != SerialSettings::Parity::none) asked.c_iflag |= INPCK | IGNPAR;
  asked.c_cc[VMIN] = 1;
  asked.c_cc[VTIME] = 0;
  const auto* found = std::find(serial_bauds.begin(), serial_bauds.end(), settings.baud);
  if (found == serial_bauds.end())
    return fail(ErrorCode::not_found, path + ": " + std::to_string(settings.baud) + " baud is not a supported rate");
  const speed_t speed = serial_speeds[static_cast<std::size_t>(std::distance(serial_bauds.begin(), found))];
  ::cfsetispeed(&asked, speed);
  ::cfsetospeed(&asked, speed);
  if (::tcsetattr(port.get(), TCSANOW, &asked) != 0) return port_error(path, errno);
  // The system reports success even if it applied only some settings: read them back.
  termios taken{};
  if (::tcgetattr(port.get(), &taken) != 0 || ::cfgetospeed(&taken) != speed)
    return fail(ErrorCode::not_found, path + ": the port did not accept " + std::to_string(settings.baud) + " baud");
  ::tcflush(port.get(), TCIOFLUSH);
  return port;
}

}  // namespace todbench
