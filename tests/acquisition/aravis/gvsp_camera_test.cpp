// The Aravis back end and the GigE Vision camera on plain sockets: set-up of real families, resend, chunks, faults.
#include <arv.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <ostream>
#include <tuple>
#include <utility>

#include "acquisition/aravis/glib_ptr.h"
#include "acquisition/core/integrity_gate.h"
#include "tests/support/gvsp_test_support.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using namespace testing_support;
using testing::HasSubstr;

/// What came of a number of frames.
struct Received {
  int complete = 0, incomplete = 0, wrong_size = 0, false_pixels = 0, gaps = 0;
};

/// Takes frames; complete ones are compared with the exposure that they say they are.
Received receive(FrameSource& source, const GvspCameraConfig& config, int frames) {
  Received out;
  std::optional<std::uint64_t> last;
  for (int k = 0; k < frames; ++k) {
    const auto frame = source.next(patience);
    EXPECT_TRUE(frame) << frame.error().message;
    if (!frame) return out;
    if (last && frame->sequence > *last + 1) out.gaps += static_cast<int>(frame->sequence - *last - 1);
    last = frame->sequence;
    if (frame->status == FrameStatus::incomplete) ++out.incomplete;
    if (frame->status == FrameStatus::wrong_size) ++out.wrong_size;
    if (frame->status != FrameStatus::complete) continue;
    ++out.complete;
    const auto index = exposure_index(*frame, config.frame_rate_hz);
    const auto truth = test_picture(index, config.width, config.height, config.significant_bits);
    if (!same_pixels(frame->counts, truth)) ++out.false_pixels;
  }
  return out;
}

/// With the counts of the model: the A series sends hundredths of a kelvin in 16 bits.
GvspCameraConfig quick(CameraModel model = CameraModel::ax5) {
  GvspCameraConfig config;
  config.model = model;
  if (model == CameraModel::a_series || model == CameraModel::legacy_science) {
    config.significant_bits = 16;
    config.kelvin_per_count = 0.01;
  }
  config.width = 160;
  config.height = 128;
  config.frame_rate_hz = 100;
  return config;
}

std::unique_ptr<FrameSource> open_started(const AravisOptions& options = {}) {
  auto source = open_camera(options);
  const bool started = source && source->start().has_value();
  EXPECT_TRUE(started);
  return source;
}

TEST(GvspCamera, IsFoundByDiscovery) {
  const auto camera = start_gvsp_camera({});

  const auto cameras = aravis_backend()->list();

  ASSERT_TRUE(cameras && cameras->size() == 1);
  EXPECT_EQ(cameras->front().id, "gige:FLIR-TB0002");
  EXPECT_EQ(cameras->front().model, "AX5");
}

TEST(GvspCamera, SendsItsExposuresByteForByte) {
  const auto config = quick();
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source);

  // 200 frames pass the wrap of the 16-bit block id.
  const Received got = receive(*source, config, 200);

  EXPECT_EQ(got.complete, 200);
  EXPECT_EQ(got.false_pixels, 0);
  EXPECT_EQ(got.gaps, 0);
}

TEST(Ax5, IsSetUpForMeasuring) {
  const auto camera = start_gvsp_camera({});

  const auto source = open_camera();

  ASSERT_TRUE(source);
  const SourceInfo& info = source->info();
  EXPECT_EQ(info.pixel_format, "Mono14");
  EXPECT_EQ(info.significant_bits, 14);
  EXPECT_EQ(info.frame_rate_hz, 50);
  ASSERT_TRUE(info.scale.calibrated());
  EXPECT_NEAR(*info.scale.kelvin(7500), 300, 1e-9);  // 0.04 K per count
  EXPECT_EQ(info.settings.at("CameraFamily"), "FLIR Ax5");
  EXPECT_EQ(info.settings.at("CMOSBitDepth"), "bit14bit");
  EXPECT_EQ(info.settings.at("DigitalOutput"), "bit14bit");
  EXPECT_EQ(info.settings.at("TemperatureLinearMode"), "On");
  EXPECT_EQ(info.settings.at("TemperatureLinearResolution"), "High");
  EXPECT_EQ(info.settings.at("SensorDDEMode"), "Off");
  EXPECT_THAT(info.warnings, testing::Not(testing::Contains(HasSubstr("order of bytes"))));
  EXPECT_EQ(*source->get("IRTestPattern"), "Off");
}

TEST(Ax5, TellsWhatItTakesTheSceneFor) {
  const auto camera = start_gvsp_camera({});
  const auto source = open_camera();
  ASSERT_TRUE(source);
  EXPECT_THAT(source->info().warnings, testing::Not(testing::Contains(HasSubstr("computes its temperatures"))));
  for (const char* feature : {"ObjectEmissivity", "WindowTransmission", "AtmosphericTransmission"}) {
    ASSERT_TRUE(source->info().settings.contains(feature)) << feature;
    EXPECT_NEAR(std::stod(source->info().settings.at(feature)), 1, 1e-6) << feature;
  }
  for (const char* feature : {"ReflectedTemperature", "WindowTemperature", "AtmosphericTemperature"}) {
    ASSERT_TRUE(source->info().settings.contains(feature)) << feature;
    EXPECT_NEAR(std::stod(source->info().settings.at(feature)), 293, 1e-6) << feature;
  }

  ASSERT_TRUE(source->set("WindowTransmission", "0.8"));
  ASSERT_TRUE(source->set("WindowTemperature", "300"));

  // Steps of 1/8192.
  EXPECT_NEAR(std::stod(source->info().settings.at("WindowTransmission")), 0.8, 1.3e-4);
  EXPECT_NEAR(std::stod(source->info().settings.at("WindowTemperature")), 300, 0.01);
  EXPECT_THAT(source->info().warnings, testing::Contains(HasSubstr("for WindowTransmission = 0.79")));
  ASSERT_TRUE(source->set("WindowTransmission", "1"));
  EXPECT_THAT(source->info().warnings, testing::Not(testing::Contains(HasSubstr("computes its temperatures"))));
}

TEST(Ax5, WhoseBytesArriveSwappedIsFoundOutByItsTestRampAndReadRight) {
  const auto config = quick();
  const auto camera = start_gvsp_camera(config);
  camera->set_faults({.swapped_bytes = 1});

  const auto source = open_started();

  ASSERT_TRUE(source);
  EXPECT_THAT(source->info().warnings, testing::Contains(HasSubstr("bytes swapped")));
  EXPECT_EQ(receive(*source, config, 10).false_pixels, 0);
}

TEST(Ax5, CorrectsOnlyWhenCommandedOnceTheFirstCommandWasGiven) {
  const auto camera = start_gvsp_camera({});
  const auto source = open_camera();
  ASSERT_TRUE(source);
  ASSERT_EQ(*source->get("NUCMode"), "Automatic");

  const auto done = source->correct_nonuniformity();

  ASSERT_TRUE(done) << done.error().message;
  EXPECT_EQ(*source->get("NUCMode"), "Manual");
  EXPECT_EQ(camera->counts().corrections, 1U);
  EXPECT_EQ(source->info().settings.at("NUCMode"), "Manual");
}

TEST(Ax5, RepeatsItsLastPictureDuringACorrection) {
  auto config = quick();
  config.nuc_freeze_frames = 10;
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source);
  auto last = source->next(patience);
  ASSERT_TRUE(last && source->correct_nonuniformity());

  int repeats = 0;
  for (int k = 0; k < 60; ++k) {
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame);
    if (same_pixels(frame->counts, last->counts)) ++repeats;
    last = frame;
  }

  EXPECT_EQ(repeats, 10);
}

TEST(Ax5, RefusesToChangeItsFormatWhileItStreams) {
  const auto camera = start_gvsp_camera({});
  const auto source = open_started();
  ASSERT_TRUE(source);

  EXPECT_FALSE(source->set("PixelFormat", "Mono8"));

  source->stop();
  EXPECT_TRUE(source->set("CMOSBitDepth", "bit14bit"));
}

TEST(Ax5, TakesItsRateFromTheVideoStandard) {
  const auto camera = start_gvsp_camera({});
  const auto source = open_camera();
  ASSERT_TRUE(source);

  ASSERT_TRUE(source->set("SensorVideoStandard", "NTSC30HZ"));

  EXPECT_EQ(source->info().frame_rate_hz, 30);
}

TEST(Families, ALegacyScienceCameraSendsTheHighByteFirstAndIsReadRight) {
  const auto config = quick(CameraModel::legacy_science);
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source);

  const Received got = receive(*source, config, 20);

  EXPECT_EQ(got.complete, 20);
  EXPECT_EQ(got.false_pixels, 0);
}

TEST(Families, AnASeriesCameraDeliversHundredthsOfAKelvinWithoutNoiseReduction) {
  const auto config = quick(CameraModel::a_series);
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source);

  const Received got = receive(*source, config, 20);

  EXPECT_EQ(got.false_pixels, 0);
  EXPECT_NEAR(*source->info().scale.kelvin(30000), 300, 1e-9);
  EXPECT_EQ(source->info().settings.at("NoiseReduction"), "Off");
  ASSERT_TRUE(source->correct_nonuniformity());
  EXPECT_EQ(*source->get("NUCMode"), "Off");
}

TEST(Families, ACameraNobodyKnowsWorksInCountsAndItsShutterIsFoundByName) {
  const auto config = quick(CameraModel::unlisted);
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source);

  const Received got = receive(*source, config, 20);

  EXPECT_EQ(got.false_pixels, 0);
  EXPECT_FALSE(source->info().scale.calibrated());
  EXPECT_EQ(source->info().settings.at("CameraFamily"), "unlisted");
  ASSERT_TRUE(source->correct_nonuniformity());
  EXPECT_EQ(camera->counts().corrections, 1U);
  EXPECT_EQ(*source->get("FlagMode"), "Manual");
}

TEST(Families, ACameraNobodyKnowsTakesAScaleThatWasMeasuredOnTheBench) {
  const auto config = quick(CameraModel::unlisted);
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source);

  ASSERT_TRUE(source->set("TemperatureLinearOffset", "250"));
  EXPECT_FALSE(source->info().scale.calibrated());
  ASSERT_TRUE(source->set("TemperatureLinearScale", "0.01"));

  EXPECT_EQ(*source->get("TemperatureLinearScale"), "0.01");
  EXPECT_EQ(source->info().settings.at("TemperatureLinearOffset"), "250");
  EXPECT_DOUBLE_EQ(*source->info().scale.kelvin(5000), 300);
  EXPECT_EQ(source->set("TemperatureLinearScale", "0").error().code, ErrorCode::invalid_input);
  EXPECT_EQ(source->set("TemperatureLinearOffset", "warm").error().code, ErrorCode::invalid_input);
}

TEST(GvspFaults, LostPacketsAreSentAgainAndNoFrameIsLost) {
  auto config = quick();
  config.frame_rate_hz = 50;
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started({.packet_size_bytes = 1400});
  ASSERT_TRUE(source && source->next(patience));
  camera->set_faults({.packet_loss = 0.01});

  const Received got = receive(*source, config, 150);

  EXPECT_EQ(got.complete, 150);
  EXPECT_EQ(got.false_pixels, 0);
  EXPECT_EQ(got.gaps, 0);
  // 32 packets per frame: 150 frames lose 48 of them on average, and 20 is four standard deviations below.
  EXPECT_GT(camera->counts().faults.packets_lost, 20U);
  EXPECT_GT(camera->counts().packets_resent, 20U);
}

TEST(GvspFaults, FramesWithHolesAreMarkedWhereTheCameraDoesNotSendAgain) {
  for (const auto policy : {ResendPolicy::ignore, ResendPolicy::unavailable}) {
    auto config = quick();
    config.resend = policy;
    const auto camera = start_gvsp_camera(config);
    const auto source = open_started({.packet_size_bytes = 1400});
    ASSERT_TRUE(source && source->next(patience));
    camera->set_faults({.packet_loss = 0.01});

    const Received got = receive(*source, config, 100);

    // 1 - 0.99^32 = 28 % of the frames have a hole.
    EXPECT_GT(got.incomplete, 5);
    EXPECT_GT(got.complete, 30);
    EXPECT_EQ(got.false_pixels, 0);
  }
}

TEST(GvspFaults, RepeatedReorderedAndLatePacketsChangeNothing) {
  const auto config = quick();
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started({.packet_size_bytes = 1400});
  ASSERT_TRUE(source && source->next(patience));
  camera->set_faults({.duplicate = 0.05, .reorder = 0.05});

  const Received got = receive(*source, config, 100);

  EXPECT_EQ(got.complete, 100);
  EXPECT_EQ(got.false_pixels, 0);
  EXPECT_GT(camera->counts().faults.packets_duplicated, 50U);
  EXPECT_GT(camera->counts().faults.packets_reordered, 50U);
}

TEST(GvspFaults, AFrameWhoseLeaderComesLateIsNeverTakenForAnother) {
  const auto config = quick();
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source && source->next(patience));
  camera->set_faults({.late_leader = 0.2});

  const Received got = receive(*source, config, 100);

  EXPECT_EQ(got.false_pixels, 0);
  EXPECT_GT(got.complete, 50);
  EXPECT_GT(camera->counts().faults.late_leaders, 5U);
}

TEST(GvspFaults, LostAndWrongSizedFramesAreToldApart) {
  const auto config = quick();
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source && source->next(patience));
  camera->set_faults({.lost_frame = 0.1, .wrong_size = 0.1});

  const Received got = receive(*source, config, 100);

  const auto faults = camera->counts().faults;
  EXPECT_EQ(got.false_pixels, 0);
  EXPECT_GT(got.wrong_size, 0);
  EXPECT_LE(got.wrong_size, static_cast<int>(faults.frames_wrong_size));
  EXPECT_GT(got.gaps, 0);
  EXPECT_LE(got.gaps, static_cast<int>(faults.frames_lost));
  EXPECT_EQ(got.incomplete, 0);
}

/// Bytes behind every row and behind the last one.
class StatedPadding : public testing::TestWithParam<std::pair<int, int>> {};

TEST_P(StatedPadding, IsTakenOutOfThePicture) {
  auto config = quick();
  std::tie(config.row_padding_bytes, config.image_padding_bytes) = GetParam();
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source);

  const Received got = receive(*source, config, 30);

  EXPECT_EQ(got.complete, 30);
  EXPECT_EQ(got.false_pixels, 0);
}

TEST_P(StatedPadding, IsTakenOutOfAPictureWithChunksBehindIt) {
  auto config = quick();
  std::tie(config.row_padding_bytes, config.image_padding_bytes) = GetParam();
  const auto camera = start_gvsp_camera(config);
  const auto source = open_camera();
  ASSERT_TRUE(source && source->set("ChunkModeActive", "On") && source->start());

  const Received got = receive(*source, config, 30);

  EXPECT_EQ(got.complete, 30);
  EXPECT_EQ(got.false_pixels, 0);
}

TEST_P(StatedPadding, ThatIsNotStatedMakesEveryFrameOneOfAWrongSize) {
  auto config = quick();
  config.states_padding = false;
  std::tie(config.row_padding_bytes, config.image_padding_bytes) = GetParam();
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source);

  const Received got = receive(*source, config, 30);

  EXPECT_EQ(got.wrong_size, 30);
  EXPECT_EQ(got.complete, 0);
}

INSTANTIATE_TEST_SUITE_P(Gvsp, StatedPadding,
                         testing::Values(std::pair(8, 0), std::pair(1, 0), std::pair(320, 0), std::pair(0, 16),
                                         std::pair(6, 100)));

TEST(GvspFaults, FramesThatAreLargerThanStatedAreOfAWrongSize) {
  for (const int packet_bytes : {8000, 1436}) {
    auto config = quick();
    // With packets of 1436 bytes, 1400 of data, the payload of 160 x 140 pixels fills its 32 packets to the last byte.
    config.height = packet_bytes == 1436 ? 140 : 128;
    const auto camera = start_gvsp_camera(config);
    AravisOptions options;
    options.packet_size_bytes = packet_bytes;
    const auto source = open_started(options);
    ASSERT_TRUE(source && source->next(patience));
    camera->set_faults({.too_long = 0.5});

    const Received got = receive(*source, config, 100);

    const auto faults = camera->counts().faults;
    EXPECT_EQ(got.false_pixels, 0);
    // Binomial, n = 100, p = 0.5: outside 20 ... 80 with probability below 1e-8.
    EXPECT_GT(got.wrong_size, 20);
    EXPECT_GT(got.complete, 20);
    EXPECT_LE(got.wrong_size + got.incomplete, static_cast<int>(faults.frames_too_long));
    EXPECT_EQ(got.complete + got.wrong_size + got.incomplete, 100);
  }
}

/// The ids of the frames before and after they begin anew, and what the camera's clock does.
struct Renumbering {
  std::uint16_t first = 1;
  int frames = 0;
  std::uint16_t anew = 1;
  ClockRestart clock = ClockRestart::goes_on;
};
void PrintTo(const Renumbering& r, std::ostream* out) {
  *out << r.first << " + " << r.frames << " -> " << r.anew << (r.clock == ClockRestart::goes_on ? "" : " with clock");
}

class FrameIds : public testing::TestWithParam<Renumbering> {};

TEST_P(FrameIds, ThatBeginAnewHideNoLossAndInventNone) {
  const Renumbering& renumbering = GetParam();
  auto config = quick();
  config.first_block_id = renumbering.first;
  const auto camera = start_gvsp_camera(config);
  const auto source = open_camera();
  // The stream that looks at the test ramp has used some ids.
  camera->restart_numbers(renumbering.first, ClockRestart::goes_on);
  ASSERT_TRUE(source && source->start());
  IntegrityGate gate({.width = config.width, .height = config.height});
  const auto began = camera->counts().exposures;
  for (int k = 0; k < renumbering.frames; ++k) {
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame) << frame.error().message;
    static_cast<void>(gate.judge(*frame));
  }
  ASSERT_EQ(gate.lost(), 0U);
  camera->restart_numbers(renumbering.anew, renumbering.clock);

  // Aravis drops up to a hundred frames; what comes after them counts.
  std::uint64_t seen = static_cast<std::uint64_t>(renumbering.frames);
  std::int64_t last_exposure = 0;
  for (int k = 0; k < 50; ++k) {
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame) << frame.error().message;
    static_cast<void>(gate.judge(*frame));
    ++seen;
    last_exposure = static_cast<std::int64_t>(camera->counts().exposures);
  }

  const auto exposed = static_cast<double>(last_exposure) - static_cast<double>(began);
  const auto accounted = static_cast<double>(seen + gate.lost());
  // Frames are on their way while the last one is read, and where only the host's clock knows, it knows by its jitter.
  EXPECT_NEAR(accounted, exposed, 6 + 0.1 * exposed);
  EXPECT_EQ(gate.numbering().restarts + gate.numbering().silent_gaps, 1U);
  EXPECT_THAT(describe(gate.numbering()), HasSubstr("estimated from time"));
}

INSTANTIATE_TEST_SUITE_P(
    Gvsp, FrameIds,
    testing::Values(Renumbering{1, 40, 1, ClockRestart::goes_on}, Renumbering{1, 60, 1, ClockRestart::goes_on},
                    Renumbering{1, 60, 1, ClockRestart::begins_anew}, Renumbering{1, 130, 1, ClockRestart::goes_on},
                    Renumbering{1, 130, 1, ClockRestart::begins_anew}, Renumbering{59970, 30, 1, ClockRestart::goes_on},
                    Renumbering{59970, 30, 1, ClockRestart::begins_anew},
                    Renumbering{65500, 30, 1, ClockRestart::begins_anew},
                    Renumbering{30000, 30, 20000, ClockRestart::goes_on},
                    Renumbering{500, 60, 510, ClockRestart::goes_on}));

TEST(GvspFaults, ASilentControllerLosesControlAndTheStreamEnds) {
  auto config = quick();
  config.heartbeat_timeout = 600ms;
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source && source->next(patience));

  camera->lose_control_messages(20s);

  Result<Frame> frame = source->next(300ms);
  while (frame || frame.error().code == ErrorCode::timeout) frame = source->next(300ms);
  EXPECT_EQ(frame.error().code, ErrorCode::disconnected);
  EXPECT_EQ(camera->counts().controls_lost, 1U);
  EXPECT_FALSE(camera->controlled());
}

TEST(GvspFaults, ACameraThatAnotherClientHasIsBusy) {
  const auto camera = start_gvsp_camera({});
  camera->deny_access();

  const auto source = aravis_backend()->open("gige:127.0.0.1");

  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().code, ErrorCode::not_found);
  EXPECT_THAT(source.error().message, HasSubstr("busy"));
  camera->permit_access();
  EXPECT_TRUE(open_camera());
}

TEST(GvspFaults, AResetInMidStreamIsALostCameraThatCanBeOpenedAgain) {
  const auto config = quick();
  const auto camera = start_gvsp_camera(config);
  auto source = open_started();
  ASSERT_TRUE(source && source->next(patience));

  camera->reset(200ms);

  Result<Frame> frame = source->next(300ms);
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while ((frame || frame.error().code == ErrorCode::timeout) && std::chrono::steady_clock::now() < deadline) {
    frame = source->next(300ms);
  }
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().code, ErrorCode::disconnected);
  source.reset();
  const auto again = open_started();
  ASSERT_TRUE(again);
  EXPECT_EQ(receive(*again, config, 10).false_pixels, 0);
}

TEST(GvspCamera, SendsChunksThatAravisUnderstands) {
  const auto camera = start_gvsp_camera(quick());
  GErrorSlot error;
  const GObjectPtr<ArvCamera> client(arv_camera_new("127.0.0.1", error.out()));
  ASSERT_TRUE(client) << error.message();
  arv_camera_gv_set_stream_options(client.get(), ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  arv_camera_set_string(client.get(), "PixelFormat", "Mono14", nullptr);
  arv_camera_set_string(client.get(), "ChunkModeActive", "On", error.out());
  ASSERT_FALSE(error) << error.message();
  const GObjectPtr<ArvStream> stream(arv_camera_create_stream(client.get(), nullptr, nullptr, error.out()));
  ASSERT_TRUE(stream) << error.message();
  const auto payload = arv_camera_get_payload(client.get(), nullptr);
  for (int i = 0; i < 4; ++i) arv_stream_push_buffer(stream.get(), arv_buffer_new_allocate(payload));
  const GObjectPtr<ArvChunkParser> parser(arv_camera_create_chunk_parser(client.get()));
  arv_camera_start_acquisition(client.get(), nullptr);

  const GObjectPtr<ArvBuffer> buffer(arv_stream_timeout_pop_buffer(stream.get(), 20000000));

  ASSERT_TRUE(buffer);
  ASSERT_EQ(arv_buffer_get_status(buffer.get()), ARV_BUFFER_STATUS_SUCCESS);
  ASSERT_TRUE(arv_buffer_has_chunks(buffer.get()));
  EXPECT_EQ(arv_chunk_parser_get_integer_value(parser.get(), buffer.get(), "ChunkExposureIndex", error.out()), 0);
  EXPECT_FALSE(error) << error.message();
  EXPECT_NEAR(arv_chunk_parser_get_float_value(parser.get(), buffer.get(), "ChunkSensorTemperature", error.out()), 31.2,
              1e-6);
  EXPECT_FALSE(error) << error.message();
}

TEST(GvspCamera, RefusesAnAddressThatAnotherCameraHas) {
  const auto first = start_gvsp_camera({});
  GvspCameraConfig config;
  config.serial = "TB0003";

  const auto second = GvspCamera::start(config, gvsp_test_exposures(config));

  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("busy"));
}

}  // namespace
}  // namespace todbench
