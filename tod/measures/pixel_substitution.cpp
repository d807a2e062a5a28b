// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/pixel_substitution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "acquisition/base/distributions.h"
#include "acquisition/base/median.h"

namespace todbench {
namespace {

/// Relative to the median pixel's variance: live pixels differ in their noise.
constexpr double quietest_live = 0.3;

using Sources = std::vector<cv::Point>;

/// Possible substitutes of a pixel: the mean of some of the four nearest, a diagonal one, the mean of eight.
std::vector<Sources> candidates() {
  const std::array<cv::Point, 4> nearest{cv::Point(-1, 0), cv::Point(0, -1), cv::Point(1, 0), cv::Point(0, 1)};
  const std::array<cv::Point, 4> diagonal{cv::Point(-1, -1), cv::Point(1, -1), cv::Point(-1, 1), cv::Point(1, 1)};
  std::vector<Sources> all;
  for (unsigned set = 1; set < 16; ++set) {
    Sources sources;
    for (unsigned i = 0; i < 4; ++i)
      if ((set >> i & 1U) != 0) sources.push_back(nearest[i]);
    all.push_back(std::move(sources));
  }
  Sources eight;
  for (const cv::Point one : diagonal) all.push_back({one}), eight.push_back(one);
  eight.insert(eight.end(), nearest.begin(), nearest.end());
  all.push_back(std::move(eight));
  return all;
}

enum class Power { first, second };

void add(cv::Mat1d& sum, const cv::Mat1f& values, Power power) {
  cv::Mat1d precise;
  values.convertTo(precise, CV_64F);
  sum += power == Power::second ? cv::Mat1d(precise.mul(precise)) : precise;
}

/// Variance over frames of the difference from the mean of the sources, and of its successive changes. Pixels without
/// one of the sources have -1.
struct Differences {
  cv::Mat1d variance, successive;
};
Differences differences(std::span<const cv::Mat1f> frames, const Sources& sources) {
  const cv::Size size = frames[0].size();
  const cv::Rect whole({0, 0}, size);
  cv::Rect inside = whole;
  for (const cv::Point source : sources) inside &= whole - source;
  cv::Mat1d sum = cv::Mat1d::zeros(inside.size()), squares = sum.clone(), steps = sum.clone();
  cv::Mat1f first, last;
  for (const cv::Mat1f& frame : frames) {
    cv::Mat1f mean = frame(inside + sources[0]).clone();
    for (std::size_t i = 1; i < sources.size(); ++i) mean += frame(inside + sources[i]);
    cv::Mat1f difference = frame(inside) - mean / static_cast<double>(sources.size());
    if (first.empty()) first = difference.clone();
    difference -= first;
    add(sum, difference, Power::first);
    add(squares, difference, Power::second);
    if (!last.empty()) add(steps, difference - last, Power::second);
    last = difference;
  }
  const auto n = static_cast<double>(frames.size());
  Differences out{cv::Mat1d(size, -1.0), cv::Mat1d(size, -1.0)};
  cv::Mat1d variance = (squares - sum.mul(sum) / n) / (n - 1);
  cv::max(variance, 0.0, variance);
  variance.copyTo(out.variance(inside));
  cv::Mat1d(steps / (2 * (n - 1))).copyTo(out.successive(inside));
  return out;
}

double median_of_live(const cv::Mat1d& values, const cv::Mat1b& constant) {
  std::vector<double> live;
  for (int y = 0; y < values.rows; ++y)
    for (int x = 0; x < values.cols; ++x)
      if (values(y, x) >= 0 && constant(y, x) == 0) live.push_back(values(y, x));
  return live.empty() ? 0 : median(live);
}

/// Degrees of freedom of a variance from so many frames whose noise has first-order memory (Box and Jenkins 1970).
double effective_freedom(std::size_t frames, double correlation) {
  const double rho2 = std::min(correlation * correlation, 0.98);
  return (static_cast<double>(frames) - 1) * (1 - rho2) / (1 + rho2);
}

struct Equal {
  double ratio = 0;
  cv::Point pixel;
  const Sources* sources = nullptr;
};

}  // namespace

SubstitutedPixels substituted_pixels(std::span<const cv::Mat1f> frames, const cv::Mat1b& constant,
                                     const SubstitutionRules& rules) {
  const std::vector<Sources> all = candidates();
  SubstitutedPixels out{cv::Mat1b::zeros(frames[0].size())};
  std::vector<Equal> equal;
  for (const Sources& sources : all) {
    const Differences found = differences(frames, sources);
    const double live = median_of_live(found.variance, constant);
    if (!(live > 0)) continue;
    const double correlation = std::clamp(1 - median_of_live(found.successive, constant) / live, 0.0, 1.0);
    const double freedom = effective_freedom(frames.size(), correlation);
    if (freedom < 2) continue;
    const double p = rules.chance / (static_cast<double>(constant.total()) * static_cast<double>(all.size()));
    const double limit = std::min(quantile(distribution::ChiSquared(freedom), p) / freedom, quietest_live);
    // A copy differs by the rounding of pixel and sources only; half of that is added for its scatter.
    const double rounding =
        rules.unit_per_count * rules.unit_per_count / 12 * (1 + 1.0 / static_cast<double>(sources.size()));
    if (!(1.5 * rounding < limit * live) || !(limit > 1e-3)) continue;
    out.tested = true;
    for (int y = 0; y < constant.rows; ++y) {
      for (int x = 0; x < constant.cols; ++x) {
        if (constant(y, x) != 0 || found.variance(y, x) < 0 || found.variance(y, x) >= limit * live) continue;
        // Relative to pixels that never change only its own noise remains, half of the expected noise of two.
        const bool dead_sources = std::all_of(
            sources.begin(), sources.end(), [&](cv::Point source) { return constant(cv::Point(x, y) + source) != 0; });
        if (dead_sources) continue;
        equal.push_back({found.variance(y, x) / live, {x, y}, &sources});
      }
    }
  }
  // The surest first: a live neighbour of a substituted pixel resembles it, but less than the pixel resembles its
  // sources. Of two equal ones the later one in reading order is the copy.
  std::stable_sort(equal.begin(), equal.end(), [](const Equal& a, const Equal& b) {
    if (a.ratio != b.ratio) return a.ratio < b.ratio;
    return a.pixel.y != b.pixel.y ? a.pixel.y > b.pixel.y : a.pixel.x > b.pixel.x;
  });
  for (const Equal& one : equal) {
    const bool circular = std::any_of(one.sources->begin(), one.sources->end(),
                                      [&](cv::Point source) { return out.found(one.pixel + source) != 0; });
    if (!circular) out.found(one.pixel) = 255;
  }
  return out;
}

}  // namespace todbench
