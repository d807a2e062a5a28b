// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/v4l2/boson_serial.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <span>
#include <system_error>

#include "acquisition/base/safe_file.h"
#include "acquisition/base/system_reason.h"
#include "acquisition/base/try.h"

namespace todbench {
namespace {

constexpr char start_byte = '\x8e', escape_byte = '\x9e', end_byte = '\xae';
/// The three bytes and what follows the escape byte in their place.
constexpr std::array escapes{std::pair{start_byte, '\x81'}, std::pair{escape_byte, '\x91'},
                             std::pair{end_byte, '\xa1'}};
constexpr std::size_t reply_header_bytes = 13;  ///< channel, sequence, function, status
constexpr std::size_t most_reply_bytes = 4096;

/// CRC-16 of CCITT, polynomial 0x1021, begun with 0x1D0F.
std::uint16_t boson_crc(std::string_view bytes) {
  unsigned crc = 0x1D0F;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned>(static_cast<unsigned char>(byte)) << 8;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 0x8000U) != 0 ? crc << 1 ^ 0x1021U : crc << 1;
    crc &= 0xFFFFU;
  }
  return static_cast<std::uint16_t>(crc);
}

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 255U);
  return bytes;
}

std::uint32_t number_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
  return value;
}

/// The bytes between the framing, without escapes.
Result<std::string> unescaped(std::string_view body) {
  std::string bytes;
  for (std::size_t i = 0; i < body.size(); ++i) {
    if (body[i] != escape_byte) {
      bytes += body[i];
      continue;
    }
    const char next = ++i < body.size() ? body[i] : '\0';
    const auto known =
        std::find_if(escapes.begin(), escapes.end(), [&](const auto& pair) { return pair.second == next; });
    if (known == escapes.end()) return fail(ErrorCode::invalid_input, "the answer of the Boson has an unknown escape");
    bytes += known->first;
  }
  return bytes;
}

std::string_view name_of(std::span<const std::string_view> names, std::uint32_t number) {
  return number < names.size() ? names[number] : std::string_view();
}

}  // namespace

std::string boson_request(std::uint32_t sequence, BosonFunction function, std::string_view payload) {
  std::string body(1, '\0');
  body += big_endian(sequence) + big_endian(static_cast<std::uint32_t>(function)) + big_endian(0xFFFFFFFFU);
  body += payload;
  const unsigned crc = boson_crc(body);
  body += {static_cast<char>(crc >> 8), static_cast<char>(crc & 255U)};
  std::string frame(1, start_byte);
  for (const char byte : body) {
    const auto special =
        std::find_if(escapes.begin(), escapes.end(), [&](const auto& pair) { return pair.first == byte; });
    if (special == escapes.end()) {
      frame += byte;
    } else {
      frame += {escape_byte, special->second};
    }
  }
  return frame + end_byte;
}

Result<BosonReply> boson_reply(std::string_view frame) {
  if (frame.size() < 2 || frame.front() != start_byte || frame.back() != end_byte)
    return fail(ErrorCode::invalid_input, "the answer of the Boson is no frame");
  TODBENCH_TRY(const std::string body, unescaped(frame.substr(1, frame.size() - 2)));
  if (body.size() < reply_header_bytes + 2)
    return fail(ErrorCode::invalid_input, "the answer of the Boson is too short");
  const std::string_view content = std::string_view(body).substr(0, body.size() - 2);
  const unsigned stated =
      static_cast<unsigned char>(body[body.size() - 2]) << 8 | static_cast<unsigned char>(body.back());
  if (boson_crc(content) != stated)
    return fail(ErrorCode::invalid_input, "the answer of the Boson has a wrong checksum");
  if (content.front() != 0) return fail(ErrorCode::invalid_input, "the answer of the Boson is for another channel");
  return BosonReply{number_at(content, 1), number_at(content, 5), number_at(content, 9),
                    std::string(content.substr(reply_header_bytes))};
}

std::string_view boson_gain_mode(std::uint32_t number) {
  static constexpr std::array<std::string_view, 5> names{"High", "Low", "Auto", "Dual", "Manual"};
  return name_of(names, number);
}

std::string_view boson_correction_mode(std::uint32_t number) {
  static constexpr std::array<std::string_view, 3> names{"Manual", "Auto", "External"};
  return name_of(names, number);
}

Result<BosonPort> BosonPort::open(const std::filesystem::path& node) {
  Descriptor port(::open(node.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!port.is_open()) return fail(ErrorCode::io, node.string() + ": " + system_reason());
  termios state{};
  if (::tcgetattr(port.get(), &state) != 0) return fail(ErrorCode::io, node.string() + ": " + system_reason());
  ::cfmakeraw(&state);
  ::cfsetspeed(&state, B921600);
  state.c_cflag |= CLOCAL | CREAD;
  if (::tcsetattr(port.get(), TCSANOW, &state) != 0) return fail(ErrorCode::io, node.string() + ": " + system_reason());
  ::tcflush(port.get(), TCIOFLUSH);
  return BosonPort(std::move(port));
}

Result<std::string> BosonPort::call(BosonFunction function, std::string_view payload,
                                    std::chrono::milliseconds patience) {
  const std::uint32_t sequence = sequence_++;
  if (const int problem = write_all(port_.get(), boson_request(sequence, function, payload)); problem != 0)
    return fail(ErrorCode::io, "serial port of the Boson: " + std::generic_category().message(problem));
  const auto deadline = std::chrono::steady_clock::now() + patience;
  std::string received;
  while (wait_on(port_.get(), WaitFor::reading, deadline, {}) == Waited::ready) {
    char byte = 0;
    const ssize_t got = ::read(port_.get(), &byte, 1);
    if (got < 0 && errno == EAGAIN) continue;
    if (got <= 0) return fail(ErrorCode::io, "serial port of the Boson: it is closed");
    // Bytes before the start byte are the end of an older answer.
    if (byte == start_byte) received.clear();
    if (received.size() < most_reply_bytes) received += byte;
    if (byte != end_byte || received.front() != start_byte) continue;
    TODBENCH_TRY(auto reply, boson_reply(received));
    received.clear();
    if (reply.sequence != sequence || reply.function != static_cast<std::uint32_t>(function)) continue;
    if (reply.status != 0)
      return fail(ErrorCode::invalid_input,
                  fmt::format("the Boson refuses function {:#010x} with status {}", reply.function, reply.status));
    return std::move(reply.payload);
  }
  return fail(ErrorCode::timeout, "the Boson does not answer on its serial port");
}

Result<std::uint32_t> BosonPort::mode(BosonFunction function) {
  TODBENCH_TRY(const std::string payload, call(function));
  if (payload.size() != 4) return fail(ErrorCode::invalid_input, "the Boson answers with a mode of another length");
  return number_at(payload, 0);
}

Result<void> BosonPort::set_mode(BosonFunction function, std::uint32_t number) {
  TODBENCH_TRY_VOID(call(function, big_endian(number)));
  return {};
}

std::optional<std::filesystem::path> serial_port_of(const std::filesystem::path& usb_device) {
  std::error_code problem;
  for (const auto& interface : std::filesystem::directory_iterator(usb_device, problem)) {
    for (const auto& port : std::filesystem::directory_iterator(interface.path() / "tty", problem))
      return std::filesystem::path("/dev") / port.path().filename();
  }
  return std::nullopt;
}

}  // namespace todbench
