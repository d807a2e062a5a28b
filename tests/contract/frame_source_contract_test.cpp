// SPDX-License-Identifier: GPL-3.0-or-later
// What every FrameSource promises, whatever is behind it: the same tests run on a simulation, on recordings, on an
// emulated camera behind the real protocol, and on a real camera when TODBENCH_CONTRACT_CAMERA names one
// ("gige:VENDOR-SERIAL", "u3v:...").
#include <gmock/gmock.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <future>
#include <ostream>

#include "acquisition/recording/flir_seq.h"
#include "acquisition/recording/raw_recording.h"
#include "sim_devices/sensor/simulated_camera.h"
#include "tests/support/source_file.h"
#ifdef TODBENCH_CONTRACT_WITH_ARAVIS
#include "tests/support/gvsp_test_support.h"
#endif
#ifdef TODBENCH_CONTRACT_WITH_V4L2
#include "tests/support/video_test_support.h"
#endif

#ifdef TODBENCH_CONTRACT_WITH_USB
#include "acquisition/aravis/aravis_backend.h"
#include "acquisition/usb/usb_backend.h"
#include "sim_devices/lab/usb_laboratory.h"
#include "tests/support/usb_test_support.h"
#include "tests/support/video_test_support.h"
#endif

namespace todbench {
namespace {

using namespace std::chrono_literals;

/// Far longer than any frame takes on a loaded machine; a test that waits this long has failed.
constexpr auto patience = 120s;
/// The shortest recording has two frames.
constexpr int least_frames = 2;

/// Whether a source goes on for ever or comes to its end.
enum class Ending { never, after_last_frame };

/// A source and whatever has to exist behind it, destroyed in the right order.
struct Bench {
  std::shared_ptr<void> device;
  std::unique_ptr<FrameSource> source;
};

struct SourceCase {
  std::string name;
  Ending ending = Ending::never;
  std::function<Bench()> open;
};

void PrintTo(const SourceCase& source, std::ostream* out) {
  *out << source.name;
}

#if !defined(TODBENCH_CONTRACT_WITH_V4L2) && !defined(TODBENCH_CONTRACT_WITH_USB)
Bench simulated() {
  SensorSpec spec;
  spec.name = "contract";
  spec.width = 32;
  spec.height = 24;
  auto model = std::make_shared<const SensorModel>(spec, full_plan(spec, {}, {}), Accuracy::draft(), 1);
  auto scene = std::make_shared<SceneHolder>(PlateScene{});
  return {nullptr, simulated_source(std::move(model), std::move(scene), "1")};
}

Bench recorded(Result<Recording> recording) {
  EXPECT_TRUE(recording) << recording.error().message;
  return {nullptr, recorded_source(std::move(*recording))};
}

std::filesystem::path golden(const std::string& name) {
  return std::filesystem::path(source_file("tests/golden/real")) / name;
}

Bench lepton() {
  return recorded(open_raw_recording(golden("lepton_a_160x120_u16le.raw"), {.width = 160, .height = 120}));
}

Bench sc660() {
  return recorded(open_flir_seq(golden("flir_sc660.seq")));
}
#endif

#ifdef TODBENCH_CONTRACT_WITH_ARAVIS
Bench emulated_gige() {
  std::shared_ptr<void> camera = testing_support::start_camera({});
  return {std::move(camera), testing_support::open_camera()};
}

Bench emulated_ax5() {
  std::shared_ptr<void> camera = testing_support::start_gvsp_camera({});
  return {std::move(camera), testing_support::open_camera()};
}

Bench real_camera() {
  CameraRegistry cameras;
  cameras.add(aravis_backend());
  cameras.add(aravis_backend({.transport = AravisTransport::usb3_vision}));
  auto source = cameras.open(std::getenv("TODBENCH_CONTRACT_CAMERA"));
  EXPECT_TRUE(source) << source.error().message;
  return {nullptr, std::move(*source)};
}
#endif

#ifdef TODBENCH_CONTRACT_WITH_USB
/// A camera on the emulated bus, opened by its identity.
Bench plugged(const ConnectCamera& connect, CameraBackend& backend, int width, int height) {
  SensorSpec sensor;
  sensor.width = width;
  sensor.height = height;
  sensor.frame_rate_hz = 200;
  auto camera =
      connect(sensor, [=](std::uint64_t index) { return testing_support::test_picture(index, width, height, 14); });
  EXPECT_TRUE(camera) << camera.error().message;
  auto source = backend.open((*camera)->id());
  EXPECT_TRUE(source) << source.error().message;
  return {std::shared_ptr<LaboratoryCamera>(std::move(*camera)), source ? std::move(*source) : nullptr};
}

Bench plugged_seek(SeekModel model) {
  SeekCameraConfig config;
  config.model = model;
  const cv::Size size = geometry(model).picture.size();
  return plugged(connect_seek(testing_support::shared_system(), config), *usb_backend(), size.width, size.height);
}

Bench plugged_u3v() {
  const auto backend = aravis_backend({.transport = AravisTransport::usb3_vision});
  return plugged(connect_u3v(testing_support::shared_system(), {}), *backend, 160, 120);
}

/// A program of its own, because it runs under umockdev's preload library.
std::vector<SourceCase> sources() {
  return {{"SeekCompact", Ending::never, [] { return plugged_seek(SeekModel::compact); }},
          {"SeekCompactPro", Ending::never, [] { return plugged_seek(SeekModel::compact_pro); }},
          {"EmulatedU3v", Ending::never, plugged_u3v}};
}
#elif defined(TODBENCH_CONTRACT_WITH_V4L2)
Bench emulated_video(VideoCameraKind kind) {
  VideoCameraConfig config;
  config.kind = kind;
  config.width = 160;
  config.height = 120;
  auto bench = std::make_shared<testing_support::VideoBench>(testing_support::start_video(config));
  return {std::move(bench), testing_support::open_video(config)};
}

Bench real_video_camera() {
  auto source = v4l2_backend()->open(std::getenv("TODBENCH_CONTRACT_CAMERA"));
  EXPECT_TRUE(source) << source.error().message;
  return {nullptr, std::move(*source)};
}

/// A program of its own, because it runs under umockdev's preload library.
std::vector<SourceCase> sources() {
  std::vector<SourceCase> all;
  const auto add = [&](const std::string& name, VideoCameraKind kind) {
    all.push_back({name, Ending::never, [kind] { return emulated_video(kind); }});
  };
  add("V4l2Y16", VideoCameraKind::y16);
  add("V4l2Y14", VideoCameraKind::y14);
  add("V4l2Grey", VideoCameraKind::grey);
  add("V4l2Lepton", VideoCameraKind::lepton);
  add("V4l2TemperatureRows", VideoCameraKind::temperature_rows);
  const char* real = std::getenv("TODBENCH_CONTRACT_CAMERA");
  if (real != nullptr && std::string_view(real).starts_with("v4l2:")) {
    all.push_back({"RealCamera", Ending::never, real_video_camera});
  }
  return all;
}
#else
std::vector<SourceCase> sources() {
  std::vector<SourceCase> all{{"Simulated", Ending::never, simulated},
                              {"RecordedRaw", Ending::after_last_frame, lepton},
                              {"RecordedFlirSeq", Ending::after_last_frame, sc660}};
#ifdef TODBENCH_CONTRACT_WITH_ARAVIS
  all.push_back({"EmulatedGige", Ending::never, emulated_gige});
  all.push_back({"EmulatedAx5", Ending::never, emulated_ax5});
  if (std::getenv("TODBENCH_CONTRACT_CAMERA") != nullptr) all.push_back({"RealCamera", Ending::never, real_camera});
#endif
  return all;
}
#endif

class FrameSourceContract : public testing::TestWithParam<SourceCase> {
 protected:
  void SetUp() override {
    bench_ = GetParam().open();
    ASSERT_TRUE(bench_.source);
  }
  [[nodiscard]] FrameSource& source() const { return *bench_.source; }
  /// The next frame, or a failure of the test and an empty one.
  [[nodiscard]] Frame frame() const {
    auto next = source().next(patience);
    EXPECT_TRUE(next) << next.error().message;
    return next ? std::move(*next) : Frame{};
  }

  Bench bench_;
};

TEST_P(FrameSourceContract, TellsWhoItIsAndWhatItSends) {
  const SourceInfo& info = source().info();

  EXPECT_THAT(info.id, testing::ContainsRegex("^[a-z0-9]+:.+"));
  EXPECT_FALSE(info.model.empty());
  EXPECT_FALSE(info.transport.empty());
  EXPECT_GT(info.width, 0);
  EXPECT_GT(info.height, 0);
  EXPECT_THAT(info.pixel_format, testing::StartsWith("Mono"));
  EXPECT_GE(info.significant_bits, 8);
  EXPECT_LE(info.significant_bits, 16);
  EXPECT_GE(info.frame_rate_hz, 0);
}

TEST_P(FrameSourceContract, SendsCompleteFramesOfTheGeometryItTells) {
  ASSERT_TRUE(source().start());

  const Frame first = frame();

  const SourceInfo& info = source().info();
  EXPECT_EQ(first.status, FrameStatus::complete);
  EXPECT_EQ(first.counts.cols, info.width);
  EXPECT_EQ(first.counts.rows, info.height);
  EXPECT_EQ(first.significant_bits, info.significant_bits);
  ASSERT_TRUE(first.scale);
  EXPECT_EQ(*first.scale, info.scale);
  double largest = 0;
  cv::minMaxLoc(first.counts, nullptr, &largest);
  EXPECT_LE(largest, (1 << info.significant_bits) - 1);
}

TEST_P(FrameSourceContract, CountsExposuresWithoutGapsAndHostTimeForwards) {
  ASSERT_TRUE(source().start());
  Frame last = frame();

  const int frames = GetParam().ending == Ending::never ? 50 : least_frames;
  for (int k = 1; k < frames; ++k) {
    const Frame next = frame();

    ASSERT_EQ(next.sequence, last.sequence + 1);
    ASSERT_GE(next.host_time_ns, last.host_time_ns);
    ASSERT_GE(next.device_time_ns, last.device_time_ns);
    last = next;
  }
}

TEST_P(FrameSourceContract, BeginsTheSequenceAtZero) {
  ASSERT_TRUE(source().start());

  EXPECT_EQ(frame().sequence, 0U);
}

TEST_P(FrameSourceContract, StartingTwiceIsHarmless) {
  ASSERT_TRUE(source().start());
  const Frame first = frame();

  ASSERT_TRUE(source().start());

  EXPECT_EQ(frame().sequence, first.sequence + 1);
}

TEST_P(FrameSourceContract, IsCreatedStopped) {
  const auto next = source().next(0ms);

  ASSERT_FALSE(next);
  EXPECT_EQ(next.error().code, ErrorCode::interrupted);
}

TEST_P(FrameSourceContract, SaysInterruptedAfterStopAndStoppingTwiceIsHarmless) {
  ASSERT_TRUE(source().start());
  static_cast<void>(frame());
  source().stop();
  source().stop();

  const auto next = source().next(patience);

  ASSERT_FALSE(next);
  EXPECT_EQ(next.error().code, ErrorCode::interrupted);
}

TEST_P(FrameSourceContract, StopFromAnotherThreadEndsAReadersLoop) {
  ASSERT_TRUE(source().start());
  std::promise<void> reading;
  auto reader = std::async(std::launch::async, [&] {
    for (bool first = true;; first = false) {
      const auto next = source().next(patience);
      if (first) reading.set_value();
      if (!next) return next.error().code;
    }
  });
  reading.get_future().wait();

  source().stop();

  // A recording may have come to its end before it was stopped.
  EXPECT_THAT(reader.get(),
              testing::AnyOf(ErrorCode::interrupted,
                             GetParam().ending == Ending::never ? ErrorCode::interrupted : ErrorCode::disconnected));
}

TEST_P(FrameSourceContract, StartsAgainAfterStop) {
  ASSERT_TRUE(source().start());
  static_cast<void>(frame());
  source().stop();

  const auto again = source().start();

  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(frame().status, FrameStatus::complete);
}

TEST_P(FrameSourceContract, AFrameNeverChangesAfterItWasHandedOut) {
  ASSERT_TRUE(source().start());
  const Frame first = frame();
  const cv::Mat1w copy = first.counts.clone();

  // Sources that recycle buffers have fewer than 150.
  const int later = GetParam().ending == Ending::never ? 150 : least_frames - 1;
  for (int k = 0; k < later; ++k) static_cast<void>(frame());

  EXPECT_EQ(cv::countNonZero(first.counts != copy), 0);
}

TEST_P(FrameSourceContract, FramesOutliveTheirSource) {
  ASSERT_TRUE(source().start());
  const Frame first = frame();
  const cv::Mat1w copy = first.counts.clone();

  bench_.source.reset();
  bench_.device.reset();

  EXPECT_EQ(cv::countNonZero(first.counts != copy), 0);
  EXPECT_EQ(first.scale->describe().empty(), false);
}

TEST_P(FrameSourceContract, RefusesAFeatureThatDoesNotExist) {
  EXPECT_EQ(source().get("NoSuchFeature").error().code, ErrorCode::invalid_input);
  EXPECT_EQ(source().set("NoSuchFeature", "1").error().code, ErrorCode::invalid_input);
}

TEST_P(FrameSourceContract, CorrectsItsNonuniformityOrSaysThatItCannot) {
  const auto corrected = source().correct_nonuniformity();

  EXPECT_TRUE(corrected || corrected.error().code == ErrorCode::invalid_input);
}

#if !defined(TODBENCH_CONTRACT_WITH_V4L2) && !defined(TODBENCH_CONTRACT_WITH_USB)
class EndingFrameSourceContract : public FrameSourceContract {};

TEST_P(EndingFrameSourceContract, EndsAsDisconnectedAndStaysDead) {
  ASSERT_TRUE(source().start());
  ErrorCode code = ErrorCode::internal;

  for (int k = 0; k < 1000 && code != ErrorCode::disconnected; ++k) {
    const auto next = source().next(patience);
    if (!next) code = next.error().code;
  }

  EXPECT_EQ(code, ErrorCode::disconnected);
  EXPECT_EQ(source().next(0ms).error().code, ErrorCode::disconnected);
  EXPECT_EQ(source().start().error().code, ErrorCode::disconnected);
}

std::vector<SourceCase> ending_sources() {
  auto ending = sources();
  std::erase_if(ending, [](const SourceCase& source) { return source.ending == Ending::never; });
  return ending;
}

#endif

std::string name_of(const testing::TestParamInfo<SourceCase>& test_case) {
  return test_case.param.name;
}

INSTANTIATE_TEST_SUITE_P(Every, FrameSourceContract, testing::ValuesIn(sources()), name_of);
#if !defined(TODBENCH_CONTRACT_WITH_V4L2) && !defined(TODBENCH_CONTRACT_WITH_USB)
INSTANTIATE_TEST_SUITE_P(Every, EndingFrameSourceContract, testing::ValuesIn(ending_sources()), name_of);
#endif

#ifdef TODBENCH_CONTRACT_WITH_ARAVIS
TEST(FrameSourceWaiting, SaysTimeoutWhenNothingCameAndIsWokenByStop) {
  EmulatedGigeCameraConfig config;
  config.frame_rate_hz = 0.1;
  const auto camera = testing_support::start_camera(config);
  const auto source = testing_support::open_camera();
  ASSERT_TRUE(source && source->start());
  // After a first frame nothing comes before the wall clock reaches a multiple of 10 s; a frame at just that moment is
  // passed over.
  static_cast<void>(source->next(patience));
  auto nothing = source->next(1ms);
  while (nothing) nothing = source->next(1ms);

  const auto woken = testing_support::woken_by_stop(*source);

  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().code, ErrorCode::timeout);
  ASSERT_FALSE(woken);
  EXPECT_EQ(woken.error().code, ErrorCode::interrupted);
}
#endif

}  // namespace
}  // namespace todbench
