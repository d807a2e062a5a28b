// SPDX-License-Identifier: GPL-3.0-or-later
// Who controls the emulated camera while it is slow to listen.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "tests/support/gvsp_test_support.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

/// A client of the control protocol that does nothing by itself.
class BareClient {
 public:
  BareClient() : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons(3956);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  }
  ~BareClient() { ::close(socket_); }
  BareClient(const BareClient&) = delete;
  BareClient& operator=(const BareClient&) = delete;

  void ask(std::uint16_t command, const Bytes& payload) {
    Bytes message{0x42,
                  0x01,
                  static_cast<std::uint8_t>(command >> 8U),
                  static_cast<std::uint8_t>(command),
                  0,
                  static_cast<std::uint8_t>(payload.size()),
                  0,
                  1};
    message.insert(message.end(), payload.begin(), payload.end());
    EXPECT_EQ(::send(socket_, message.data(), message.size(), 0), static_cast<ssize_t>(message.size()));
  }
  /// Waits for it.
  [[nodiscard]] Bytes answer() const {
    std::array<std::uint8_t, 1024> bytes{};
    const ssize_t size = ::recv(socket_, bytes.data(), bytes.size(), 0);
    return {bytes.begin(), bytes.begin() + std::max<ssize_t>(size, 0)};
  }

 private:
  int socket_;
};

constexpr std::uint16_t read_register = 0x80, write_register = 0x82, read_memory = 0x84;
const Bytes control_privilege{0, 0, 0x0A, 0};

TEST(GvspHeartbeat, ThatWaitedWhileTheCameraWasBusyCameInTime) {
  GvspCameraConfig config;
  config.heartbeat_timeout = 300ms;
  config.memory_delay = 500ms;
  const auto camera = testing_support::start_gvsp_camera(config);
  ASSERT_TRUE(camera);
  BareClient owner, other;
  owner.ask(write_register, {0, 0, 0x0A, 0, 0, 0, 0, 2});
  ASSERT_EQ(owner.answer().size(), 12u);

  // The camera is busy with the other's question beyond the heartbeat's time; the owner's heartbeat waits behind it.
  other.ask(read_memory, {0, 0, 0, 0, 0, 0, 0, 4});
  owner.ask(read_register, control_privilege);

  ASSERT_EQ(other.answer().size(), 16u);
  const Bytes privilege = owner.answer();
  ASSERT_EQ(privilege.size(), 12u);
  EXPECT_EQ(privilege.back(), 2) << "the camera gave its owner up";
}

}  // namespace
}  // namespace todbench
