// SPDX-License-Identifier: GPL-3.0-or-later
// The emulated GigE Vision camera without its sockets: control messages, packets, faults, pictures.
#include <gmock/gmock.h>

#include "acquisition/aravis/gev_registers.h"
#include "sim_devices/lab/genicam/picture_encoder.h"
#include "sim_devices/lab/gige/camera_models.h"
#include "sim_devices/lab/gige/gvcp_device.h"
#include "sim_devices/lab/gige/gvsp_faults.h"
#include "sim_devices/lab/gige/gvsp_packets.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using Clock = GvcpDevice::Clock;

constexpr GvcpEndpoint alice{0x7F000001, 5000}, bob{0x7F000001, 5001};
constexpr std::uint32_t nuc_mode = 0xE984;

Bytes message(GvcpCommand command, std::initializer_list<std::uint32_t> words, std::uint16_t id = 7) {
  Bytes out{0x42, 0x01};
  append_big_endian(out, static_cast<std::uint16_t>(command), 2);
  append_big_endian(out, 4 * words.size(), 2);
  append_big_endian(out, id, 2);
  for (const auto word : words) append_big_endian(out, word, 4);
  return out;
}

class GvcpDeviceTest : public testing::Test {
 protected:
  GvcpDeviceTest()
      : description_(
            describe_camera(CameraModel::ax5,
                            {.vendor = {}, .model = {}, .serial = "TB1", .firmware = "1", .width = 80, .height = 64})),
        registers_(description_.genicam, genicam_xml(description_.genicam)),
        device_(registers_, {.on_write = [this](auto address, auto) { writes_.push_back(address); },
                             .on_resend = [this](const ResendRequest& r) { resends_.push_back(r.block_id); },
                             .on_control_lost = [this] { ++controls_lost_; }}) {
    registers_.set(gev::heartbeat_timeout, 3000);
  }

  /// Status of the answer; nothing when there is none.
  std::optional<std::uint16_t> status(const Bytes& datagram, const GvcpEndpoint& from) {
    const auto answer = device_.answer(datagram, from, now_);
    if (!answer) return std::nullopt;
    return static_cast<std::uint16_t>(big_endian_at(*answer, 0, 2));
  }
  std::optional<std::uint16_t> write(std::uint32_t address, std::uint32_t value, const GvcpEndpoint& from) {
    return status(message(GvcpCommand::write_register, {address, value}), from);
  }

  ModelDescription description_;
  RegisterMap registers_;
  GvcpDevice device_;
  Clock::time_point now_{};
  std::vector<std::uint32_t> writes_;
  std::vector<std::uint16_t> resends_;
  int controls_lost_ = 0;
};

TEST_F(GvcpDeviceTest, AnswersAReadWithTheIdOfTheRequestAndTheCommandPlusOne) {
  const auto answer = device_.answer(message(GvcpCommand::read_register, {0xD300}, 0x1234), alice, now_);

  ASSERT_TRUE(answer);
  EXPECT_THAT(*answer, ElementsAre(0, 0, 0x00, 0x81, 0, 4, 0x12, 0x34, 0, 0, 0, 80));
}

TEST_F(GvcpDeviceTest, DoesNotAnswerWhatIsNoMessage) {
  Bytes wrong_key = message(GvcpCommand::read_register, {0xD300});
  wrong_key[0] = 0x43;
  Bytes short_one = message(GvcpCommand::read_register, {0xD300});
  short_one.pop_back();

  EXPECT_FALSE(device_.answer(wrong_key, alice, now_));
  EXPECT_FALSE(device_.answer(short_one, alice, now_));
  EXPECT_FALSE(device_.answer(message(GvcpCommand::read_register, {0xD300}, 0), alice, now_));
  EXPECT_FALSE(device_.answer({}, alice, now_));
}

TEST_F(GvcpDeviceTest, LetsOnlyTheControllerWrite) {
  EXPECT_EQ(write(nuc_mode, 0, alice), 0x8006);
  EXPECT_EQ(write(gev::control_privilege, gev::control_access, alice), 0);
  EXPECT_EQ(write(nuc_mode, 0, alice), 0);
  EXPECT_EQ(write(nuc_mode, 1, bob), 0x8006);
  EXPECT_EQ(write(gev::control_privilege, gev::control_access, bob), 0x8006);
  EXPECT_EQ(registers_.get(nuc_mode), 0U);
}

TEST_F(GvcpDeviceTest, EndsTheControlOfAClientThatIsSilentForTheHeartbeatTimeout) {
  ASSERT_EQ(write(gev::control_privilege, gev::control_access, alice), 0);
  now_ += 2900ms;
  device_.check_heartbeat(now_);
  ASSERT_TRUE(device_.controlled());
  static_cast<void>(device_.answer(message(GvcpCommand::read_register, {0xD300}), alice, now_));

  now_ += 2900ms;
  device_.check_heartbeat(now_);
  EXPECT_TRUE(device_.controlled());
  now_ += 200ms;
  device_.check_heartbeat(now_);

  EXPECT_FALSE(device_.controlled());
  EXPECT_EQ(controls_lost_, 1);
  EXPECT_EQ(write(gev::control_privilege, gev::control_access, bob), 0);
}

TEST_F(GvcpDeviceTest, NamesWhatIsWrongWithAnAddress) {
  ASSERT_EQ(write(gev::control_privilege, gev::control_access, alice), 0);

  EXPECT_EQ(write(0xD301, 0, alice), 0x8005);
  EXPECT_EQ(write(0x9000, 0, alice), 0x8003);
  EXPECT_EQ(write(0xD30C, 0, alice), 0x8004);  // PayloadSize
  registers_.lock_transport();
  EXPECT_EQ(write(0xD308, 0x01100025, alice), 0x8007);  // PixelFormat
  EXPECT_EQ(status(message(GvcpCommand::read_memory, {0x00100000, 540}), alice), 0x8002);
  EXPECT_EQ(status(message(GvcpCommand::read_memory, {0x00FFFFFC, 536}), alice), 0x8003);
  EXPECT_EQ(status(message(static_cast<GvcpCommand>(0x00C0), {1}), alice), 0x8001);
}

TEST_F(GvcpDeviceTest, SendsPacketsAgainOnlyToTheHostThatControlsIt) {
  constexpr GvcpEndpoint elsewhere{0x0A000001, 5000};
  const Bytes request = message(GvcpCommand::packet_resend, {0x00000009, 1, 2});
  ASSERT_EQ(write(gev::control_privilege, gev::control_access, alice), 0);

  static_cast<void>(device_.answer(request, bob, now_));
  static_cast<void>(device_.answer(request, elsewhere, now_));

  EXPECT_THAT(resends_, ElementsAre(9));
}

TEST_F(GvcpDeviceTest, ServesItsDescriptionInWholeWords) {
  const std::string xml = genicam_xml(description_.genicam);
  std::string read;
  for (std::uint32_t at = 0; at < xml.size(); at += 512) {
    const auto bytes = static_cast<std::uint32_t>(std::min<std::size_t>(512, (xml.size() - at + 3) / 4 * 4));
    const auto answer =
        device_.answer(message(GvcpCommand::read_memory, {RegisterMap::xml_address + at, bytes}), bob, now_);
    ASSERT_TRUE(answer && big_endian_at(*answer, 0, 2) == 0);
    read.append(answer->begin() + 12, answer->end());
  }

  EXPECT_EQ(read.substr(0, xml.size()), xml);
}

TEST(GvspPackets, OfAFrameCarryItsDataInOrderBetweenLeaderAndTrailer) {
  GvspFrame frame;
  frame.block_id = 0x1234;
  frame.timestamp_ns = 0x0102030405060708;
  frame.pixel_format = pfnc_code(PixelFormat::mono14);
  frame.width = 5;
  frame.height = 2;
  frame.bytes_per_packet = 8;
  for (std::uint8_t i = 0; i < 20; ++i) frame.data.push_back(i);

  ASSERT_EQ(frame.packets(), 5U);
  const auto leader = gvsp_packet(frame, 0, gvsp_status_success);
  const auto last = gvsp_packet(frame, 3, gvsp_status_resent);
  const auto trailer = gvsp_packet(frame, 4, gvsp_status_success);

  const auto head = [](const GvspPacket& p) {
    return Bytes(p.head.begin(), p.head.begin() + static_cast<long>(p.head_bytes));
  };
  EXPECT_THAT(head(leader), ElementsAre(0, 0, 0x12, 0x34, 1, 0, 0, 0,                    //
                                        0, 0, 0, 1, 1, 2, 3, 4, 5, 6, 7, 8,              //
                                        0x01, 0x10, 0x00, 0x25, 0, 0, 0, 5, 0, 0, 0, 2,  //
                                        0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0));
  EXPECT_THAT(head(last), ElementsAre(1, 0, 0x12, 0x34, 3, 0, 0, 3));
  EXPECT_THAT(last.data, ElementsAre(16, 17, 18, 19));
  EXPECT_THAT(head(trailer), ElementsAre(0, 0, 0x12, 0x34, 2, 0, 0, 4, 0, 0, 0, 1, 0, 0, 0, 2));
}

TEST(GvspFaults, AreTheSameForTheSameSeedAndAsFrequentAsAskedFor) {
  const RandomStream random(3, "gvsp.faults");
  const GvspFaults faults{.packet_loss = 0.05, .duplicate = 0.05, .reorder = 0.05};
  std::uint64_t lost = 0, duplicated = 0, reordered = 0;
  constexpr std::uint64_t frames = 200, packets = 100;

  for (std::uint64_t k = 0; k < frames; ++k) {
    const auto plan = schedule_packets(packets, {}, faults, random, k);
    EXPECT_EQ(plan.ids, schedule_packets(packets, {}, faults, random, k).ids);
    EXPECT_EQ(plan.ids.size(), packets - plan.lost + plan.duplicated);
    lost += plan.lost;
    duplicated += plan.duplicated;
    reordered += plan.reordered;
  }

  // 20000 draws of 0.05: 1000 +- 31; five standard deviations. Lost packets are not repeated, and one that changed
  // places does not change them again: 5 % fewer.
  EXPECT_NEAR(static_cast<double>(lost), 1000, 155);
  EXPECT_NEAR(static_cast<double>(duplicated), 950, 155);
  EXPECT_NEAR(static_cast<double>(reordered), 950, 155);
}

TEST(GvspFaults, WithoutProbabilityChangeNothing) {
  const auto plan = schedule_packets(4, {}, {}, RandomStream(1, "x"), 0);

  EXPECT_THAT(plan.ids, ElementsAre(0, 1, 2, 3));
  EXPECT_FALSE(draw_frame_faults({}, RandomStream(1, "x"), 5).lost);
}

TEST(GvspFaults, ALateLeaderComesAfterTheTrailer) {
  EXPECT_THAT(schedule_packets(4, {.late_leader = true}, {}, RandomStream(1, "x"), 0).ids, ElementsAre(1, 2, 3, 0));
}

TEST(PictureEncoder, TurnsKelvinIntoTheSignalOfEveryScale) {
  PictureEncoder encoder(0.01, 0, {366545, 1428, 1, 342});
  const cv::Mat1w picture(1, 1, ushort{30000});  // 300 K
  const auto signal = [&](const EncoderSettings& settings) {
    const Bytes data = encoder.encode(picture, settings);
    return data[0] + 256 * data[1];
  };

  EXPECT_EQ(signal({.signal = SignalKind::linear, .kelvin_per_signal = 0.04}), 7500);
  EXPECT_EQ(signal({.signal = SignalKind::linear, .kelvin_per_signal = 0.4}), 750);
  // R / (exp(B / T) - F) + O = 366545 / (exp(1428 / 300) - 1) + 342 = 3508.8
  EXPECT_EQ(signal({.signal = SignalKind::radiometric}), 3509);
  EXPECT_EQ(signal({.signal = SignalKind::as_exposed, .significant_bits = 16}), 30000);
  EXPECT_EQ(signal({.signal = SignalKind::as_exposed, .significant_bits = 14}), 16383);
  EXPECT_EQ(signal({.signal = SignalKind::as_exposed, .significant_bits = 16, .big_endian = true}), 0x3075);
}

TEST(PictureEncoder, SendsARampInsteadOfThePictureAndTheHighestEightBits) {
  PictureEncoder encoder(0.01, 0, {366545, 1428, 1, 342});

  const Bytes ramp = encoder.encode(cv::Mat1w::zeros(1, 4), {.test_ramp = true});
  const Bytes eight =
      encoder.encode(cv::Mat1w(1, 1, ushort{0x3F12}), {.significant_bits = 14, .format = PixelFormat::mono8});

  EXPECT_THAT(ramp, ElementsAre(0, 0, 1, 0, 2, 0, 3, 0));
  EXPECT_THAT(eight, ElementsAre(0xFC));
}

}  // namespace
}  // namespace todbench
