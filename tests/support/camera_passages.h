// SPDX-License-Identifier: GPL-3.0-or-later
// What tests of cameras repeat, whatever the interface: a picture with a known value everywhere, and passages that hold
// for every source.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "acquisition/base/result.h"
#include "acquisition/core/camera_registry.h"
#include "acquisition/core/frame_source.h"

namespace todbench::testing_support {

/// Far longer than any frame takes on a loaded machine; a test that waits this long has failed.
inline constexpr std::chrono::seconds patience{120};

/// Picture `index`: no two within 2^`bits` are alike, and no pixel has the value of its neighbours, so that a shifted,
/// torn, repeated or byte-swapped frame differs.
[[nodiscard]] cv::Mat1w test_picture(std::uint64_t index, int width, int height, int bits);

/// True when both have the same geometry and the same counts.
[[nodiscard]] bool same_pixels(const cv::Mat1w& a, const cv::Mat1w& b);

/// Exposure since power-up of a frame of an emulated camera, from the camera's clock.
[[nodiscard]] std::uint64_t exposure_of(const Frame& frame, double frame_rate_hz);

using OpenedSource = Result<std::unique_ptr<FrameSource>>;

/// The source; fails the test and is null when it could not be opened.
[[nodiscard]] std::unique_ptr<FrameSource> opened(OpenedSource source);

/// The one camera that a back end lists; fails the test when there are none or several.
[[nodiscard]] CameraEntry only_camera(CameraBackend& backend);

/// Opening has failed with `not_found`, and the sentence says `told`.
void expect_not_found(const OpenedSource& source, const std::string& told = "");

/// A started source shows as a gap of three what `lose` is told to lose.
void expect_gap_of_lost_exposures(FrameSource& source, const std::function<void(unsigned)>& lose);

/// Expects `unread` for the frame behind those that found the buffers full, and `counted` for a later loss.
/// `exposures` returns the number that the camera has made. `buffered`: the number of frames that the source keeps, or
/// more.
void expect_unread_behind_a_slow_reader(FrameSource& source, const std::function<std::uint64_t()>& exposures,
                                        std::uint64_t buffered, const std::function<void(unsigned)>& lose);

/// The next frame that is not complete, within a thousand.
[[nodiscard]] Result<Frame> next_damaged(FrameSource& source);

/// How a source whose device goes ends, within a thousand frames.
[[nodiscard]] Result<Frame> end_of(FrameSource& source);

/// An uncalibrated source takes the scale that was measured on the bench, and refuses one that is none.
void expect_to_take_a_stated_scale(FrameSource& source);

/// What a reader that waits in next() is told when stop() is called.
[[nodiscard]] Result<Frame> woken_by_stop(FrameSource& source);

}  // namespace todbench::testing_support
