// SPDX-License-Identifier: GPL-3.0-or-later
// What is said to a FLIR Boson on its serial port, and a pseudo terminal in its place.
#include "acquisition/v4l2/boson_serial.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>
#include <thread>

#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;

std::string bytes_of_hex(std::string_view text) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 3)
    bytes += static_cast<char>(std::stoi(std::string(text.substr(i, 2)), nullptr, 16));
  return bytes;
}

// Frames that a user of a Boson published (thurberdog/ghostCommand, README).
TEST(BosonSerial, RequestOfACorrectionIsThePublishedOne) {
  EXPECT_EQ(boson_request(1, BosonFunction::run_correction),
            bytes_of_hex("8E 00 00 00 00 01 00 05 00 07 FF FF FF FF 22 5C AE"));
}

TEST(BosonSerial, PublishedAnswersAreUnderstood) {
  const auto done = boson_reply(bytes_of_hex("8E 00 00 00 00 01 00 05 00 07 00 00 00 00 BB 93 AE"));
  const auto serial = boson_reply(bytes_of_hex("8E 00 00 00 00 01 00 05 00 02 00 00 00 00 00 01 6D 94 30 10 AE"));

  ASSERT_TRUE(done) << done.error().message;
  EXPECT_EQ(done->function, 0x00050007u);
  EXPECT_EQ(done->status, 0u);
  ASSERT_TRUE(serial) << serial.error().message;
  EXPECT_EQ(serial->sequence, 1u);
  EXPECT_EQ(serial->payload, std::string("\x00\x01\x6d\x94", 4));
}

TEST(BosonSerial, FramingBytesInsideAFrameAreEscaped) {
  const std::string special = "\x8e\x9e\xae";
  const std::string request = boson_request(0x8e, BosonFunction::set_gain_mode, special);

  EXPECT_EQ(std::count(request.begin(), request.end(), '\x8e'), 1);
  EXPECT_EQ(std::count(request.begin(), request.end(), '\xae'), 1);
  EXPECT_THAT(request, HasSubstr("\x9e\x81\x9e\x91\x9e\xa1"));
  // A request has the form of an answer with the status FFFFFFFF.
  const auto read = boson_reply(request);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->sequence, 0x8eu);
  EXPECT_EQ(read->status, 0xFFFFFFFFu);
  EXPECT_EQ(read->payload, special);
}

TEST(BosonSerial, DamagedAnswersAreRefused) {
  const std::string good = bytes_of_hex("8E 00 00 00 00 01 00 05 00 02 00 00 00 00 00 01 6D 94 30 10 AE");
  for (std::size_t at = 0; at < good.size(); ++at) {
    std::string damaged = good;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    EXPECT_FALSE(boson_reply(damaged)) << at;
    EXPECT_FALSE(boson_reply(good.substr(0, at))) << at;
  }
  EXPECT_THAT(boson_reply("\x8e\x9e\x33\xae").error().message, HasSubstr("unknown escape"));
}

/// A pseudo terminal whose other end answers as a Boson would.
class PretendedBoson {
 public:
  PretendedBoson() : master_(::posix_openpt(O_RDWR | O_NOCTTY)) {
    if (::grantpt(master_) != 0 || ::unlockpt(master_) != 0) throw std::runtime_error("no pseudo terminal");
    node_ = ::ptsname(master_);
    // Keeps the terminal alive while nobody has it open.
    keeper_ = ::open(node_.c_str(), O_RDWR | O_NOCTTY);
  }
  ~PretendedBoson() {
    ::close(keeper_);
    ::close(master_);
  }
  PretendedBoson(const PretendedBoson&) = delete;
  PretendedBoson& operator=(const PretendedBoson&) = delete;

  [[nodiscard]] const std::string& node() const { return node_; }
  /// Reads one request and sends `before` and then an answer with this status and payload.
  void answer(std::uint32_t status, const std::string& payload, const std::string& before = {}) const {
    std::string request;
    for (char byte = 0; byte != '\xae' && ::read(master_, &byte, 1) == 1;) request += byte;
    const auto asked = boson_reply(request).value();
    // The same framing with the status in place of FFFFFFFF: built from a request by its pieces.
    std::string body(1, '\0');
    for (const std::uint32_t value : {asked.sequence, asked.function, status}) {
      for (int shift = 24; shift >= 0; shift -= 8) body += static_cast<char>(value >> shift & 255U);
    }
    body += payload;
    unsigned crc = 0x1D0F;
    for (const char byte : body) {
      crc ^= static_cast<unsigned>(static_cast<unsigned char>(byte)) << 8;
      for (int bit = 0; bit < 8; ++bit) crc = ((crc & 0x8000U) != 0 ? crc << 1 ^ 0x1021U : crc << 1) & 0xFFFFU;
    }
    body += {static_cast<char>(crc >> 8), static_cast<char>(crc & 255U)};
    std::string frame = before + '\x8e';
    for (const char byte : body) {
      const auto escaped = byte == '\x8e'   ? "\x9e\x81"
                           : byte == '\x9e' ? "\x9e\x91"
                           : byte == '\xae' ? "\x9e\xa1"
                                            : nullptr;
      frame += escaped != nullptr ? std::string(escaped) : std::string(1, byte);
    }
    frame += '\xae';
    ASSERT_EQ(::write(master_, frame.data(), frame.size()), static_cast<ssize_t>(frame.size()));
  }

 private:
  int master_ = -1, keeper_ = -1;
  std::string node_;
};

TEST(BosonSerial, PortReadsAndSetsModesAndPassesOverOlderAnswers) {
  const PretendedBoson camera;
  auto port = BosonPort::open(camera.node());
  ASSERT_TRUE(port) << port.error().message;
  // The end of an answer that began before the port was opened.
  const std::string older = "\x11\x22\xae";

  std::jthread first([&] { camera.answer(0, std::string("\0\0\0\1", 4), older); });
  EXPECT_EQ(port->mode(BosonFunction::get_gain_mode).value(), 1u);
  first.join();
  std::jthread second([&] { camera.answer(0, ""); });
  EXPECT_TRUE(port->set_mode(BosonFunction::set_correction_mode, 0));
  second.join();
  std::jthread third([&] { camera.answer(5, ""); });
  EXPECT_THAT(port->call(BosonFunction::run_correction).error().message,
              HasSubstr("refuses function 0x00050007 with status 5"));
  third.join();
  EXPECT_EQ(port->call(BosonFunction::run_correction, {}, std::chrono::milliseconds(1)).error().code,
            ErrorCode::timeout);
}

TEST(BosonSerial, PortIsFoundBesideTheVideoDeviceInSysfs) {
  const testing::TemporaryFolder folder;
  EXPECT_FALSE(serial_port_of(folder.path()));

  folder.write("1-2:1.2/tty/ttyACM3/dev", "166:3");
  folder.write("idVendor", "09cb");

  EXPECT_EQ(serial_port_of(folder.path()), std::filesystem::path("/dev/ttyACM3"));
}

TEST(BosonSerial, ModesHaveTheNamesOfTheDevelopmentKit) {
  EXPECT_EQ(boson_gain_mode(0), "High");
  EXPECT_EQ(boson_gain_mode(1), "Low");
  EXPECT_EQ(boson_gain_mode(5), "");
  EXPECT_EQ(boson_correction_mode(0), "Manual");
  EXPECT_EQ(boson_correction_mode(1), "Auto");
}

}  // namespace
}  // namespace todbench
