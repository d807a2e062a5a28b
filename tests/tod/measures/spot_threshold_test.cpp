// SPDX-License-Identifier: GPL-3.0-or-later
// MDTD of an observer that knows the place, against the closed form of a matched filter.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "acquisition/base/rng.h"
#include "tod/camera_measures/bars_judge.h"
#include "tod/registration/patch_windows.h"

namespace todbench {
namespace {

constexpr double pixel_mm = 2.6, noise_k = 0.07;
const cv::Size camera_px{96, 96};

/// Covered part of pixel `i` by a line from `low` to `high`.
double covered(int i, double low, double high) {
  return std::max(0.0, std::min(high, i + 0.5) - std::max(low, i - 0.5));
}

/// A square of unit contrast, by exact areas.
cv::Mat1d drawn_square(cv::Point2d middle, double side) {
  cv::Mat1d out(camera_px);
  for (int y = 0; y < out.rows; ++y) {
    for (int x = 0; x < out.cols; ++x)
      out(y, x) =
          covered(x, middle.x - side / 2, middle.x + side / 2) * covered(y, middle.y - side / 2, middle.y + side / 2);
  }
  return out;
}

/// The same behind a normal blur, at the middles of the pixels.
cv::Mat1d blurred_square(const cv::Rect& pixels, cv::Point2d middle, double side, double sigma) {
  const auto profile = [&](double off) {
    const double root = sigma * std::numbers::sqrt2;
    return 0.5 * (std::erf((off + side / 2) / root) - std::erf((off - side / 2) / root));
  };
  cv::Mat1d out(pixels.size());
  for (int y = 0; y < out.rows; ++y) {
    for (int x = 0; x < out.cols; ++x) out(y, x) = profile(pixels.x + x - middle.x) * profile(pixels.y + y - middle.y);
  }
  return out;
}

TEST(SpotThreshold, IsThatOfAMatchedFilterAtAKnownPlace) {
  constexpr double spot_px = 3;
  MrtdOptions options;
  options.plate.name = "spot", options.plate.width_mm = 200, options.plate.height_mm = 200;
  options.plate.rectangles.push_back({"spot", {1.3, -0.8}, {spot_px * pixel_mm, spot_px * pixel_mm}});
  options.observer.search_range_samples = 0;
  options.observer.internal_noise = 0;
  options.set_ups = 5, options.frames = 60;
  Registration where;
  const double scale = 1 / pixel_mm;
  where.plate_to_pixel = {scale, 0, 47.5, 0, scale, 47.5, 0, 0, 1};
  where.scale_px_per_mm = scale;
  const cv::Point2d middle = where.pixel(options.plate.rectangles[0].position_mm);
  const cv::Mat1d spot = drawn_square(middle, spot_px);
  // The template: the ideal spot behind the blur of 0.6 samples, in the middle of the window, without its mean. The
  // distance of the scores is contrast <template, spot> / (noise |template|), and 75 % of two-interval decisions are
  // right at a distance of sqrt(2) 0.6745 = 0.9539.
  const cv::Rect pixels = patch_window(middle, 12).pixels;
  const cv::Point2d centre(pixels.x + 5.5, pixels.y + 5.5);
  cv::Mat1d matched = blurred_square(pixels, centre, spot_px, options.observer.blur_sigma_samples);
  matched -= cv::mean(matched)[0];
  const double truth_k = 0.9539 * noise_k * cv::norm(matched) / matched.dot(spot(pixels));
  for (const double factor : {0.4, 0.6, 0.9, 1.3, 2.0}) options.contrasts_k.push_back(factor * truth_k);
  options.contrasts_k.erase(options.contrasts_k.begin(), options.contrasts_k.end() - 5);
  auto judge = BarsJudge::create(options, where);
  ASSERT_TRUE(judge) << judge.error().message;
  const RandomStream random(3, "spot threshold");
  std::uint64_t frame = 0;
  for (int set_up = 0; set_up < options.set_ups; ++set_up) {
    for (std::size_t level = 0; level < options.contrasts_k.size(); ++level) {
      for (const double sign : {1.0, -1.0}) {
        const double said_k = sign * options.contrasts_k[level];
        for (int k = 0; k < options.frames; ++k) {
          cv::Mat1f noise(camera_px);
          random.sub(frame++).fill_normal({noise.ptr<float>(), noise.total()});
          cv::Mat1d kelvin;
          noise.convertTo(kelvin, CV_64F, noise_k);
          judge->add(kelvin + said_k * spot, {set_up, level, said_k, Mounting::identity, where});
        }
      }
    }
  }

  const MrtdMeasure found = judge->result();

  ASSERT_EQ(found.spots.size(), 1u);
  const MrtdPoint& point = found.spots.front();
  ASSERT_TRUE(point.threshold_k && point.ci95.low && point.ci95.high) << point.reason;
  std::printf("MDTD %.5f K [%.5f, %.5f], matched filter %.5f K\n", *point.threshold_k, *point.ci95.low,
              *point.ci95.high, truth_k);
  // 300 intervals of each kind give a share a standard error of 0.02, the fit over five contrasts of two polarities a
  // threshold one of 2.5 %. The template of the observer is that of a display, not of a pure blur: below 1 %.
  EXPECT_NEAR(*point.threshold_k / truth_k, 1, 0.1);
  EXPECT_LT(*point.ci95.low, truth_k * 1.05);
  EXPECT_GT(*point.ci95.high, truth_k * 0.95);
}

}  // namespace
}  // namespace todbench
