// SPDX-License-Identifier: GPL-3.0-or-later
// The device's side of USB/IP, driven by the commands that the kernel's vhci-hcd sends.
#include "tests/support/usbip_server.h"

#include <gmock/gmock.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "tests/support/uvc_camera.h"

namespace todbench {
namespace {

using testing::ElementsAre;

constexpr std::uint32_t submit = 1, unlink_command = 2, ret_submit = 3, ret_unlink = 4;

/// A host at the other end of a socket pair.
class Host {
 public:
  explicit Host(std::shared_ptr<UsbDevice> device) {
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) ADD_FAILURE() << "no sockets";
    socket_ = ends[1];
    server_ = std::move(*UsbIpServer::serve(std::move(device), ends[0]));
  }
  ~Host() { ::close(socket_); }
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  struct Reply {
    std::uint32_t command = 0, sequence = 0;
    int status = 0;
    UsbBytes data;
  };

  void send(const std::array<std::uint32_t, 10>& words, std::uint64_t setup = 0, const UsbBytes& data = {}) const {
    UsbBytes bytes;
    for (const auto word : words) {
      for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(word >> shift));
    }
    for (int shift = 56; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(setup >> shift));
    bytes.insert(bytes.end(), data.begin(), data.end());
    ASSERT_EQ(::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
  }
  /// Control IN with the setup packet as eight bytes, first byte highest.
  void control_in(std::uint32_t sequence, std::uint64_t setup, std::uint32_t length) const {
    send({submit, sequence, 0x10002, 1, 0, 0, length, 0, 0, 0}, setup);
  }
  void bulk_in(std::uint32_t sequence, std::uint32_t length) const {
    send({submit, sequence, 0x10002, 1, 1, 0, length, 0, 0, 0});
  }
  void unlink(std::uint32_t sequence, std::uint32_t victim) const {
    send({unlink_command, sequence, 0x10002, 0, 0, victim, 0, 0, 0, 0});
  }

  /// To a transfer to the device: no bytes follow.
  [[nodiscard]] Reply acknowledgement() const { return parsed(receive(48)); }
  [[nodiscard]] Reply reply() const {
    const UsbBytes header = receive(48);
    Reply reply = parsed(header);
    const std::size_t length = std::size_t{header[26]} << 8U | header[27];
    if (reply.command == ret_submit) reply.data = receive(length);
    return reply;
  }
  /// True when the device closes the connection, which may take a moment.
  [[nodiscard]] bool ends() const {
    pollfd ready{.fd = socket_, .events = POLLIN, .revents = 0};
    std::uint8_t byte = 0;
    return ::poll(&ready, 1, 20000) == 1 && ::recv(socket_, &byte, 1, MSG_DONTWAIT) == 0;
  }
  void unplug() { server_.reset(); }

 private:
  [[nodiscard]] static Reply parsed(const UsbBytes& header) {
    const auto word = [&](std::size_t k) {
      return static_cast<std::uint32_t>(header[4 * k]) << 24U | static_cast<std::uint32_t>(header[4 * k + 1]) << 16U |
             static_cast<std::uint32_t>(header[4 * k + 2]) << 8U | header[4 * k + 3];
    };
    return {.command = word(0), .sequence = word(1), .status = static_cast<int>(word(5)), .data = {}};
  }
  [[nodiscard]] UsbBytes receive(std::size_t size) const {
    UsbBytes bytes(size);
    if (size > 0 && ::recv(socket_, bytes.data(), size, MSG_WAITALL) != static_cast<ssize_t>(size)) {
      ADD_FAILURE() << "the connection ended";
    }
    return bytes;
  }

  int socket_ = -1;
  std::unique_ptr<UsbIpServer> server_;
};

std::shared_ptr<UvcCamera> camera() {
  VideoCameraConfig config;
  config.kind = VideoCameraKind::y16;
  config.width = 16;
  config.height = 8;
  return std::move(
      *UvcCamera::create(config, [](std::uint64_t k) { return cv::Mat1w(8, 16, static_cast<ushort>(k)); }));
}

/// GET_DESCRIPTOR device, 18 bytes; SET_CUR commit with 26 bytes; GET_CUR of a control that does not exist.
constexpr std::uint64_t get_device_descriptor = 0x8006000100001200, set_commit = 0x2101000201001A00,
                        get_nothing = 0xA181000901001A00;

TEST(UsbIp, AnswersWithTheDescriptorsOfTheDevice) {
  const auto device = camera();
  const Host host(device);

  host.control_in(7, get_device_descriptor, 18);
  const auto reply = host.reply();

  EXPECT_EQ(reply.command, ret_submit);
  EXPECT_EQ(reply.sequence, 7U);
  EXPECT_EQ(reply.status, 0);
  EXPECT_EQ(reply.data, device->descriptors().device);
}

TEST(UsbIp, StallsWhatTheDeviceDoesNotKnow) {
  const Host host(camera());

  host.control_in(8, get_nothing, 26);
  const auto reply = host.reply();

  EXPECT_EQ(reply.status, -EPIPE);
  EXPECT_TRUE(reply.data.empty());
}

TEST(UsbIp, CarriesAFrameAfterTheCommitment) {
  const Host host(camera());
  UsbBytes parameters(26);
  parameters[2] = parameters[3] = 1;  // format and frame
  host.send({submit, 1, 0x10002, 0, 0, 0, 26, 0, 0, 0}, set_commit, parameters);
  ASSERT_EQ(host.acknowledgement().status, 0);

  host.bulk_in(2, 16384);
  const auto frame = host.reply();
  host.bulk_in(3, 16384);
  const auto next = host.reply();

  // Two bytes of header (end of frame, alternating frame id), then the picture.
  ASSERT_EQ(frame.data.size(), 2U + 2 * 16 * 8);
  EXPECT_THAT(UsbBytes(frame.data.begin(), frame.data.begin() + 4), ElementsAre(2, 0x82, 0, 0));
  EXPECT_THAT(UsbBytes(next.data.begin(), next.data.begin() + 4), ElementsAre(2, 0x83, 1, 0));
}

TEST(UsbIp, CancelsATransferThatWaits) {
  const Host host(camera());
  host.bulk_in(5, 16384);
  host.bulk_in(6, 16384);

  host.unlink(7, 6);
  host.unlink(8, 5);

  const auto waiting = host.reply();
  const auto active = host.reply();
  EXPECT_EQ(waiting.command, ret_unlink);
  EXPECT_EQ(waiting.sequence, 7U);
  EXPECT_EQ(waiting.status, -ECONNRESET);
  EXPECT_EQ(active.sequence, 8U);
  EXPECT_EQ(active.status, -ECONNRESET);
}

TEST(UsbIp, SaysThatAFinishedTransferCannotBeCancelled) {
  const Host host(camera());
  host.control_in(7, get_device_descriptor, 18);
  static_cast<void>(host.reply());

  host.unlink(9, 7);
  const auto reply = host.reply();

  EXPECT_EQ(reply.command, ret_unlink);
  EXPECT_EQ(reply.status, 0);
}

TEST(UsbIp, EndsTheConnectionOnNonsense) {
  const Host host(camera());

  host.send({99, 1, 0, 0, 0, 0, 0, 0, 0, 0});

  EXPECT_TRUE(host.ends());
}

TEST(UsbIp, EndsTheConnectionOnATransferBeyondReason) {
  const Host host(camera());

  host.bulk_in(1, 0xFFFFFFFF);

  EXPECT_TRUE(host.ends());
}

TEST(UsbIp, UnpluggingEndsWithATransferWaiting) {
  Host host(camera());
  host.bulk_in(1, 16384);

  host.unplug();

  EXPECT_TRUE(host.ends());
}

}  // namespace
}  // namespace todbench
