// The V4L2 back end against an emulated camera: real open, ioctl, mmap and udev calls of this process.
#include <gmock/gmock.h>

#include <future>
#include <thread>

#include "acquisition/core/host_clock.h"
#include "tests/acquisition/v4l2/video_test_support.h"
#include "tests/support/parameter_names.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing_support::open_video;
using testing_support::start_video;
using testing_support::video_camera_id;
using testing_support::video_picture;

/// Far longer than any frame takes on a loaded machine; a test that waits this long has failed.
constexpr auto patience = 20s;

VideoCameraConfig small(VideoCameraKind kind) {
  VideoCameraConfig config;
  config.kind = kind;
  config.width = 160;
  config.height = 120;
  config.frame_rate_hz = 200;
  return config;
}

/// Exposure since power-up of a frame, from the camera's clock.
std::uint64_t exposure_of(const Frame& frame, double frame_rate_hz) {
  return static_cast<std::uint64_t>(std::llround(static_cast<double>(frame.device_time_ns) * 1e-9 * frame_rate_hz)) - 1;
}

bool same_pixels(const cv::Mat1w& a, const cv::Mat1w& b) {
  return a.size() == b.size() && cv::countNonZero(a != b) == 0;
}

class V4l2Pixels : public testing::TestWithParam<VideoCameraKind> {};

TEST_P(V4l2Pixels, AHundredFramesEqualTheirExposures) {
  const auto config = small(GetParam());
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source && source->start());

  for (int k = 0; k < 100; ++k) {
    const auto frame = source->next(patience);

    ASSERT_TRUE(frame) << frame.error().message;
    ASSERT_EQ(frame->status, FrameStatus::complete);
    ASSERT_TRUE(
        same_pixels(frame->counts, video_picture(exposure_of(*frame, 200), 160, 120, significant_bits(config.kind))));
  }
}

std::string name_of(const testing::TestParamInfo<VideoCameraKind>& kind) {
  return test::name_of(kind.param);
}

INSTANTIATE_TEST_SUITE_P(Every, V4l2Pixels,
                         testing::Values(VideoCameraKind::y16, VideoCameraKind::y14, VideoCameraKind::grey,
                                         VideoCameraKind::lepton, VideoCameraKind::temperature_rows),
                         name_of);

TEST(V4l2Cameras, AreListedByVendorModelAndSerial) {
  VideoCameraConfig config = small(VideoCameraKind::lepton);
  config.vendor = "GroupGets";
  config.model = "PureThermal (fw:v1.3.0)";
  config.serial = "8008001c";
  const auto bench = start_video(config);

  const auto cameras = v4l2_backend()->list();

  ASSERT_TRUE(cameras) << cameras.error().message;
  ASSERT_EQ(cameras->size(), 1U);
  EXPECT_EQ(cameras->front().id, "v4l2:GroupGets-PureThermal__fw_v1.3.0_-8008001c");
  EXPECT_EQ(cameras->front().serial, "8008001c");
  EXPECT_EQ(cameras->front().address, bench.camera->node());
}

TEST(V4l2Cameras, TwoOfAKindAreToldApartByTheirSerials) {
  auto first = small(VideoCameraKind::y16);
  auto second = first;
  first.serial = "A1";
  second.serial = "B2";
  second.width = 80;
  const auto bench = start_video(first);
  const auto other =
      EmulatedV4l2Camera::start(bench.system, second, [](std::uint64_t) { return cv::Mat1w::zeros(120, 80); });
  ASSERT_TRUE(other) << other.error().message;

  const auto opened = open_video(second);

  ASSERT_TRUE(opened);
  EXPECT_EQ(opened->info().width, 80);
  EXPECT_EQ(opened->info().serial, "B2");
}

TEST(V4l2Cameras, AnAbsentCameraIsNotFoundAndThoseSeenAreNamed) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config);

  const auto source = v4l2_backend()->open("v4l2:Nobody-Nothing-7");

  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().code, ErrorCode::not_found);
  EXPECT_THAT(source.error().message, HasSubstr(video_camera_id(config)));
}

TEST(V4l2Cameras, AFormatThatTheCameraDoesNotHaveIsRefusedWithThoseItHas) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config);

  const auto source = v4l2_backend({.pixel_format = "Mono14"})->open(video_camera_id(config));

  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().code, ErrorCode::not_found);
  EXPECT_THAT(source.error().message, HasSubstr("Y16  160x120"));
}

TEST(V4l2Cameras, ASecondProgramIsToldThatTheCameraIsBusy) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config);
  const auto first = open_video(config);
  ASSERT_TRUE(first && first->start());

  const auto second = v4l2_backend()->open(video_camera_id(config));

  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::not_found);
  EXPECT_THAT(second.error().message, HasSubstr("busy"));
}

TEST(V4l2Scale, OfALeptonIsWhatItsTelemetrySays) {
  const auto config = small(VideoCameraKind::lepton);
  const auto bench = start_video(config);

  const auto source = open_video(config);

  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().scale, RadiometricScale::linear({.kelvin_per_count = 0.01}).value());
  EXPECT_EQ(source->info().height, 120);
}

TEST(V4l2Scale, OfTemperatureRowsIsSixtyFourthsOfAKelvin) {
  const auto config = small(VideoCameraKind::temperature_rows);
  const auto bench = start_video(config);

  const auto source = open_video(config);

  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().scale, RadiometricScale::linear({.kelvin_per_count = 1.0 / 64}).value());
  EXPECT_EQ(source->info().pixel_format, "Mono16");
}

TEST(V4l2Scale, OfAPlainCameraIsWhatTheUserStates) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source);
  EXPECT_FALSE(source->info().scale.calibrated());

  ASSERT_TRUE(source->set("TemperatureLinearScale", "0.04"));
  ASSERT_TRUE(source->set("TemperatureLinearOffset", "-10"));

  ASSERT_TRUE(source->start());
  const auto frame = source->next(patience);
  ASSERT_TRUE(frame);
  EXPECT_EQ(*frame->scale, RadiometricScale::linear({.kelvin_per_count = 0.04, .offset_k = -10}).value());
  EXPECT_EQ(source->get("TemperatureLinearScale").value(), "0.04");
  EXPECT_EQ(source->set("TemperatureLinearScale", "0").error().code, ErrorCode::invalid_input);
  EXPECT_EQ(source->set("TemperatureLinearScale", "warm").error().code, ErrorCode::invalid_input);
}

TEST(V4l2Stream, AFrameRateThatIsSetIsReadBack) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source);

  ASSERT_TRUE(source->set("AcquisitionFrameRate", "25"));

  EXPECT_EQ(source->info().frame_rate_hz, 25);
}

TEST(V4l2Stream, LostExposuresAreAGapOfTheirNumber) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source && source->start());
  auto last = source->next(patience);
  ASSERT_TRUE(last);

  bench.camera->lose_exposures(3);

  std::uint64_t gap = 0;
  for (int k = 0; k < 100 && gap == 0; ++k) {
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame);
    gap = frame->sequence - last->sequence - 1;
    last = frame;
  }
  EXPECT_EQ(gap, 3U);
}

TEST(V4l2Stream, AFrameWithMissingBytesIsIncompleteAndTheNextIsGood) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source && source->start());
  ASSERT_TRUE(source->next(patience));

  bench.camera->truncate_next_frame(100);

  FrameStatus status = FrameStatus::complete;
  for (int k = 0; k < 100 && status == FrameStatus::complete; ++k) status = source->next(patience).value().status;
  EXPECT_EQ(status, FrameStatus::incomplete);
  EXPECT_EQ(source->next(patience).value().status, FrameStatus::complete);
}

TEST(V4l2Stream, ACameraThatIsUnpluggedIsDisconnectedAndStaysDead) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source && source->start());
  ASSERT_TRUE(source->next(patience));

  bench.camera->unplug();

  auto next = source->next(patience);
  while (next) next = source->next(patience);
  EXPECT_EQ(next.error().code, ErrorCode::disconnected);
  EXPECT_EQ(source->next(0ms).error().code, ErrorCode::disconnected);
  EXPECT_EQ(source->start().error().code, ErrorCode::disconnected);
  EXPECT_EQ(source->get("Width").error().code, ErrorCode::disconnected);
}

TEST(V4l2Stream, ACameraThatIsPluggedInAgainIsFoundBySerialAtAnotherNode) {
  const auto config = small(VideoCameraKind::y16);
  auto bench = start_video(config);
  const std::string first_node = bench.camera->node();
  bench.camera.reset();

  auto camera =
      EmulatedV4l2Camera::start(bench.system, config, [](std::uint64_t k) { return video_picture(k, 160, 120, 16); });

  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_NE((*camera)->node(), first_node);
  const auto source = open_video(config);
  ASSERT_TRUE(source && source->start());
  EXPECT_TRUE(source->next(patience));
}

TEST(V4l2Stream, StopWakesAReaderThatWaitsForASlowCamera) {
  auto config = small(VideoCameraKind::y16);
  config.frame_rate_hz = 0.1;
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source && source->start());
  const auto nothing = source->next(1ms);
  auto reader = std::async(std::launch::async, [&] {
    auto next = source->next(10min);
    while (next) next = source->next(10min);
    return next;
  });

  source->stop();
  const auto woken = reader.get();

  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().code, ErrorCode::timeout);
  EXPECT_EQ(woken.error().code, ErrorCode::interrupted);
}

TEST(V4l2Stream, TheHostTimeOfAFrameIsItsArrivalHoweverLateItIsRead) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source && source->start());
  // Exposure 20 has begun: the ones before it have been delivered to the driver and, with 8 buffers there, to the
  // receiving thread at least up to the eleventh.
  while (bench.camera->exposures() < 20) std::this_thread::yield();
  const auto scene_changes_ns = monotonic_ns();

  const auto first = source->next(patience);

  ASSERT_TRUE(first);
  EXPECT_LT(first->host_time_ns, scene_changes_ns);
}

TEST(V4l2Stream, FramesDuringACorrectionSaySoAndTellTheTimeAfterIt) {
  auto config = small(VideoCameraKind::lepton);
  config.nuc_freeze_frames = 5;
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source && source->start());
  EXPECT_EQ(source->next(patience)->since_correction_s, -1);

  ASSERT_TRUE(source->correct_nonuniformity());

  int running = 0;
  double since_s = -1;
  for (int k = 0; k < 100; ++k) {
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame);
    if (frame->correction == CorrectionState::running) ++running;
    if (frame->correction == CorrectionState::idle && running > 0) since_s = frame->since_correction_s;
  }
  EXPECT_EQ(running, 5);
  // 100 frames of 5 ms, some of which came before the correction.
  EXPECT_GT(since_s, 0);
  EXPECT_LE(since_s, 0.5);
}

TEST(V4l2Stream, ACorrectionIsCommandedByItsButton) {
  const auto config = small(VideoCameraKind::lepton);
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source);

  ASSERT_TRUE(source->correct_nonuniformity());

  EXPECT_EQ(bench.camera->nonuniformity_corrections(), 1U);
}

}  // namespace
}  // namespace todbench
