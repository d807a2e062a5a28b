// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/camera_passages.h"

#include <gmock/gmock.h>

#include <cmath>
#include <future>
#include <thread>
#include <utility>

namespace todbench::testing_support {

using namespace std::chrono_literals;
using testing::HasSubstr;

/// More than a source keeps for a slow reader (a Seek: 128), so that what happens now comes through behind them.
constexpr int most_frames = 1000;

cv::Mat1w test_picture(std::uint64_t index, int width, int height, int bits) {
  const unsigned mask = (1U << static_cast<unsigned>(bits)) - 1;
  cv::Mat1w picture(height, width);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto value =
          257U * static_cast<unsigned>(index) + 7U * static_cast<unsigned>(x) + 1031U * static_cast<unsigned>(y);
      picture(y, x) = static_cast<ushort>(value & mask);
    }
  }
  return picture;
}

bool same_pixels(const cv::Mat1w& a, const cv::Mat1w& b) {
  return a.size() == b.size() && cv::countNonZero(a != b) == 0;
}

std::uint64_t exposure_of(const Frame& frame, double frame_rate_hz) {
  return static_cast<std::uint64_t>(std::llround(static_cast<double>(frame.device_time_ns) * 1e-9 * frame_rate_hz)) - 1;
}

std::unique_ptr<FrameSource> opened(OpenedSource source) {
  if (source) return std::move(*source);
  ADD_FAILURE() << source.error().message;
  return nullptr;
}

CameraEntry only_camera(CameraBackend& backend) {
  const auto cameras = backend.list();
  if (cameras && cameras->size() == 1) return cameras->front();
  ADD_FAILURE() << (cameras ? std::to_string(cameras->size()) + " cameras" : cameras.error().message);
  return {};
}

void expect_not_found(const OpenedSource& source, const std::string& told) {
  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().code, ErrorCode::not_found);
  EXPECT_THAT(source.error().message, HasSubstr(told));
}

namespace {

/// The exposures missing before the first frame with a gap after `last`, which it replaces, and that frame's numbering.
/// A gap of 0: none within a thousand frames.
std::pair<std::uint64_t, Numbering> next_gap(FrameSource& source, Frame& last) {
  for (int k = 0; k < most_frames; ++k) {
    const auto frame = source.next(patience);
    if (!frame) break;
    const std::uint64_t gap = frame->sequence - last.sequence - 1;
    last = *frame;
    if (gap > 0) return {gap, frame->numbering};
  }
  return {0, Numbering::counted};
}

}  // namespace

void expect_gap_of_lost_exposures(FrameSource& source, const std::function<void(unsigned)>& lose) {
  auto last = source.next(patience);
  ASSERT_TRUE(last);

  lose(3);

  EXPECT_EQ(next_gap(source, *last), std::pair(std::uint64_t{3}, Numbering::counted));
}

void expect_unread_behind_a_slow_reader(FrameSource& source, const std::function<std::uint64_t()>& exposures,
                                        std::uint64_t buffered, const std::function<void(unsigned)>& lose) {
  auto last = source.next(patience);
  ASSERT_TRUE(last);
  const std::uint64_t enough = exposures() + buffered + 20;
  while (exposures() < enough) std::this_thread::sleep_for(std::chrono::milliseconds(5));

  const auto [unread, numbering] = next_gap(source, *last);
  lose(3);
  auto lost = next_gap(source, *last);
  // On a busy machine the buffers fill again: such a gap comes before the lost exposures, or contains them.
  for (int again = 0; again < 20 && lost.second == Numbering::unread; ++again) {
    lost = next_gap(source, *last);
    if (lost.first == 0) {
      lose(3);
      lost = next_gap(source, *last);
    }
  }

  EXPECT_GT(unread, 0U);
  EXPECT_EQ(numbering, Numbering::unread);
  EXPECT_EQ(lost, std::pair(std::uint64_t{3}, Numbering::counted));
}

Result<Frame> next_damaged(FrameSource& source) {
  auto frame = source.next(patience);
  for (int k = 0; k < most_frames && frame && frame->status == FrameStatus::complete; ++k)
    frame = source.next(patience);
  return frame;
}

Result<Frame> end_of(FrameSource& source) {
  auto next = source.next(patience);
  for (int k = 0; k < most_frames && next; ++k) next = source.next(patience);
  return next;
}

void expect_to_take_a_stated_scale(FrameSource& source) {
  EXPECT_FALSE(source.info().scale.calibrated());

  ASSERT_TRUE(source.set("TemperatureLinearScale", "0.04"));
  ASSERT_TRUE(source.set("TemperatureLinearOffset", "-10"));

  ASSERT_TRUE(source.start());
  const auto frame = source.next(patience);
  ASSERT_TRUE(frame);
  EXPECT_EQ(*frame->scale, RadiometricScale::linear({.kelvin_per_count = 0.04, .offset_k = -10}).value());
  EXPECT_EQ(source.get("TemperatureLinearScale").value(), "0.04");
  EXPECT_EQ(source.set("TemperatureLinearScale", "0").error().code, ErrorCode::invalid_input);
  EXPECT_EQ(source.set("TemperatureLinearScale", "warm").error().code, ErrorCode::invalid_input);
  EXPECT_EQ(source.set("TemperatureLinearOffset", "warm").error().code, ErrorCode::invalid_input);
}

Result<Frame> woken_by_stop(FrameSource& source) {
  auto reader = std::async(std::launch::async, [&] {
    auto next = source.next(10min);
    while (next) next = source.next(10min);
    return next;
  });
  source.stop();
  return reader.get();
}

}  // namespace todbench::testing_support
