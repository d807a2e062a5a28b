// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/aravis/gvcp_client.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <vector>
#include "acquisition/base/descriptor.h"
#include "acquisition/base/try.h"

namespace todbench {
namespace {

constexpr std::uint16_t read_register_command = 0x0080;
constexpr std::uint16_t read_memory_command = 0x0084;
constexpr auto repeat_after = std::chrono::milliseconds(50);
/// Largest READMEM that every device answers; time limit of an answer; time until the request is repeated. A slow
/// device answers every repetition, each as slowly.
constexpr std::uint32_t block_bytes = 512;
constexpr auto block_patience = std::chrono::milliseconds(2000);
constexpr auto repeat_block_after = std::chrono::milliseconds(250);

using Bytes = std::vector<std::uint8_t>;

void append(Bytes& out, std::uint32_t value, int bytes) {
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) out.push_back(static_cast<std::uint8_t>(value >> shift));
}

Bytes request_of(std::uint16_t command, std::uint16_t request_id, const Bytes& payload) {
  Bytes out{0x42, 0x01};  // key; acknowledge required
  append(out, command, 2);
  append(out, static_cast<std::uint32_t>(payload.size()), 2);
  append(out, request_id, 2);
  out.insert(out.end(), payload.begin(), payload.end());
  return out;
}

std::uint16_t big_endian_16(const std::uint8_t* bytes) {
  return static_cast<std::uint16_t>(bytes[0] << 8 | bytes[1]);
}

std::uint32_t big_endian_32(const std::uint8_t* bytes) {
  return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 | std::uint32_t{bytes[2]} << 8 | bytes[3];
}

/// Repeats a request until its acknowledge arrives. Returns the payload of the acknowledge.
Result<Bytes> exchange(const std::string& ipv4, std::uint16_t command, const Bytes& payload,
                       std::chrono::milliseconds patience, std::chrono::milliseconds repeat = repeat_after) {
  using Clock = std::chrono::steady_clock;
  sockaddr_in device{};
  device.sin_family = AF_INET;
  device.sin_port = htons(gvcp_port);
  if (inet_pton(AF_INET, ipv4.c_str(), &device.sin_addr) != 1) {
    return fail(ErrorCode::not_found, "'" + ipv4 + "' is not an IPv4 address");
  }
  const Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (socket.get() < 0 || ::connect(socket.get(), reinterpret_cast<const sockaddr*>(&device), sizeof device) != 0) {
    return fail(ErrorCode::not_found, "no route to " + ipv4 + ": " + std::strerror(errno));
  }
  const auto deadline = Clock::now() + patience;
  for (std::uint16_t request_id = 1;; ++request_id) {
    const auto request = request_of(command, request_id, payload);
    // A refused send (no listener yet) is handled like a lost packet: wait and repeat.
    [[maybe_unused]] const auto sent = ::send(socket.get(), request.data(), request.size(), 0);
    const auto repeat_at = std::min(deadline, Clock::now() + repeat);
    for (;;) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(repeat_at - Clock::now());
      pollfd readable{socket.get(), POLLIN, 0};
      if (left.count() <= 0 || ::poll(&readable, 1, static_cast<int>(left.count())) <= 0) break;
      std::array<std::uint8_t, 1024> reply{};
      const auto size = ::recv(socket.get(), reply.data(), reply.size(), MSG_DONTWAIT);
      if (size < 8) {
        // "Connection refused" wakes poll() at once; without this pause the loop would spin until the deadline.
        if (size < 0) ::poll(nullptr, 0, static_cast<int>(std::min<std::int64_t>(left.count(), 10)));
        continue;
      }
      const bool ours = big_endian_16(&reply[2]) == command + 1 && big_endian_16(&reply[6]) <= request_id;
      if (!ours) continue;
      if (big_endian_16(&reply[0]) != 0) return fail(ErrorCode::not_found, ipv4 + " rejects the read request");
      return Bytes(reply.begin() + 8, reply.begin() + size);
    }
    if (Clock::now() >= deadline) return fail(ErrorCode::timeout, "no GigE Vision device answers at " + ipv4);
  }
}

}  // namespace

Result<std::uint32_t> gvcp_read_register(const std::string& ipv4, std::uint32_t address,
                                         std::chrono::milliseconds patience) {
  Bytes payload;
  append(payload, address, 4);
  TODBENCH_TRY(const auto answer, exchange(ipv4, read_register_command, payload, patience));
  if (answer.size() < 4) return fail(ErrorCode::not_found, ipv4 + " answers with too few bytes");
  return big_endian_32(answer.data());
}

Result<std::string> gvcp_read_text(const std::string& ipv4, std::uint32_t address, std::uint16_t bytes,
                                   std::chrono::milliseconds patience) {
  Bytes payload;
  append(payload, address, 4);
  append(payload, bytes, 4);
  TODBENCH_TRY(const auto answer, exchange(ipv4, read_memory_command, payload, patience));
  if (answer.size() < 4) return fail(ErrorCode::not_found, ipv4 + " answers with too few bytes");
  const auto end = std::find(answer.begin() + 4, answer.end(), std::uint8_t{0});
  return std::string(answer.begin() + 4, end);
}

Result<std::string> gvcp_read_memory(const std::string& ipv4, std::uint32_t address, std::uint32_t bytes,
                                     const GvcpReading& reading) {
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + reading.patience;
  std::string content;
  content.reserve(bytes);
  while (content.size() < bytes) {
    if (reading.stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
    if (Clock::now() >= deadline) {
      return fail(ErrorCode::not_found, ipv4 + " sent only " + std::to_string(content.size()) + " of " +
                                            std::to_string(bytes) + " bytes in " +
                                            std::to_string(reading.patience.count() / 1000) + " s");
    }
    const auto at = static_cast<std::uint32_t>(content.size());
    // Reads are whole words.
    const std::uint32_t wanted = std::min(block_bytes, (bytes - at + 3) / 4 * 4);
    Bytes payload;
    append(payload, address + at, 4);
    append(payload, wanted, 4);
    TODBENCH_TRY(const auto answer, exchange(ipv4, read_memory_command, payload, block_patience, repeat_block_after));
    if (answer.size() != 4 + wanted || big_endian_32(answer.data()) != address + at) {
      return fail(ErrorCode::not_found, ipv4 + " answers with bytes other than those requested");
    }
    content.append(answer.begin() + 4, answer.end());
    if (reading.on_bytes) reading.on_bytes(std::min<std::uint64_t>(content.size(), bytes));
  }
  content.resize(bytes);
  return content;
}

}  // namespace todbench
