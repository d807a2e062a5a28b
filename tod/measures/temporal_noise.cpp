// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/temporal_noise.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "acquisition/base/distributions.h"
#include "tod/measures/medians.h"

namespace todbench {
namespace {

using Pair = std::pair<std::size_t, std::size_t>;

constexpr std::size_t most_pairs = 128;    // of a lag: with a few pairs 76800 pixels give the variance to 0.05 %
constexpr std::size_t pairs_of_mask = 10;  // for a pixel's own variance: white noise exceeds the limit in 5 of 10^5
constexpr int correlation_lag = 8;

/// Pairs of pictures at this lag, evenly thinned.
std::vector<Pair> pairs_at(std::span<const TimedPicture> pictures, int lag) {
  std::vector<Pair> all;
  std::size_t later = 0;
  for (std::size_t first = 0; first < pictures.size(); ++first) {
    const std::uint64_t wanted = pictures[first].sequence + static_cast<std::uint64_t>(lag);
    while (later < pictures.size() && pictures[later].sequence < wanted) ++later;
    if (later == pictures.size()) break;
    if (pictures[later].sequence == wanted && pictures[later].segment == pictures[first].segment)
      all.emplace_back(first, later);
  }
  if (all.size() <= most_pairs) return all;
  std::vector<Pair> some;
  for (std::size_t k = 0; k < most_pairs; ++k) some.push_back(all[k * all.size() / most_pairs]);
  return some;
}

/// Half the mean square of the difference, per pixel.
cv::Mat1d half_squares(std::span<const TimedPicture> pictures, const std::vector<Pair>& pairs) {
  cv::Mat1d sum(pictures[0].picture.size(), 0.0);
  for (const auto& [first, later] : pairs) {
    cv::Mat1d difference;
    cv::Mat1f(pictures[later].picture - pictures[first].picture).convertTo(difference, CV_64F);
    sum += difference.mul(difference);
  }
  return sum / (2.0 * static_cast<double>(pairs.size()));
}

/// Half mean squares at one lag, over usable pixels.
struct AtLag {
  double all = 0;     ///< with all changes
  double pixels = 0;  ///< without the change of the whole frame
};

/// The same of each pair.
std::vector<AtLag> of_pairs(std::span<const TimedPicture> pictures, const std::vector<Pair>& pairs,
                            const cv::Mat1b& usable) {
  std::vector<AtLag> out;
  for (const auto& [first, later] : pairs) {
    const cv::Mat1f difference = pictures[later].picture - pictures[first].picture;
    cv::Scalar mean, sd;
    cv::meanStdDev(difference, mean, sd, usable);
    out.push_back({(mean[0] * mean[0] + sd[0] * sd[0]) / 2, sd[0] * sd[0] / 2});
  }
  return out;
}

AtLag mean_of(const std::vector<AtLag>& pairs) {
  AtLag sum;
  for (const AtLag& pair : pairs) {
    sum.all += pair.all;
    sum.pixels += pair.pixels;
  }
  const auto count = static_cast<double>(pairs.size());
  return {sum.all / count, sum.pixels / count};
}

/// Mean over pairs of frames and its squared standard error from the scatter between them.
struct OverPairs {
  double mean = 0, squared_error = 0;
};

OverPairs over_pairs(std::span<const double> of_pair) {
  const auto count = static_cast<double>(of_pair.size());
  const double mean = std::accumulate(of_pair.begin(), of_pair.end(), 0.0) / count;
  double squares = 0;
  for (const double one : of_pair) squares += (one - mean) * (one - mean);
  return {mean, squares / (count - 1) / count};
}

/// Whether the mean squares of the shortest lag differ between the first and the second half of the pairs. A line of
/// the picture is one sample.
bool halves_differ(const std::vector<AtLag>& pairs, cv::Size picture) {
  constexpr std::size_t least_pairs = 8;
  constexpr double standard_errors = 5;
  if (pairs.size() < least_pairs) return false;
  std::vector<double> squares;
  for (const AtLag& pair : pairs) squares.push_back(pair.pixels);
  const std::size_t half = squares.size() / 2;
  const OverPairs before = over_pairs(std::span(squares).first(half)),
                  after = over_pairs(std::span(squares).last(half));
  const double error = std::sqrt(before.squared_error + after.squared_error);
  const double lines = std::max(1, std::min(picture.height, picture.width) - 1);
  return std::abs(after.mean - before.mean) > standard_errors * error &&
         mean_squares_differ(before.mean, after.mean, lines * static_cast<double>(half));
}

/// Pixels whose noise is above twice the median pixel's at a short or at a longer lag show a moving scene; one that
/// never changes is dead.
cv::Mat1b usable_pixels(std::span<const TimedPicture> pictures, const std::map<int, std::vector<Pair>>& pairs) {
  const int base = pairs.begin()->first;
  cv::Mat1b usable(pictures[0].picture.size(), 255);
  for (const auto& [lag, of_lag] : pairs) {
    const bool longer = lag == correlation_lag * base;
    // Overlapping pairs are not independent.
    if (lag != base && !longer) continue;
    if (of_lag.size() < pairs_of_mask * (longer ? 4 : 1)) continue;
    const cv::Mat1d own = half_squares(pictures, of_lag);
    const double median = median_of(own);
    if (!(median > 0)) continue;
    usable &= own <= 4 * median;
    if (lag == base) usable &= own > 0;
  }
  return usable;
}

}  // namespace

bool level_stays_changed(std::span<const double> before, std::span<const double> behind) {
  constexpr std::size_t least = 5;
  constexpr double standard_errors = 6;
  if (before.empty() || behind.empty() || before.size() + behind.size() < least) return true;
  const auto mean_of = [](std::span<const double> levels) {
    return std::accumulate(levels.begin(), levels.end(), 0.0) / static_cast<double>(levels.size());
  };
  const double low = mean_of(before), high = mean_of(behind);
  double squares = 0;
  for (const double level : before) squares += (level - low) * (level - low);
  for (const double level : behind) squares += (level - high) * (level - high);
  const auto n = static_cast<double>(before.size()), m = static_cast<double>(behind.size());
  return std::abs(high - low) > standard_errors * std::sqrt(squares / (n + m - 2) * (1 / n + 1 / m));
}

bool mean_squares_differ(double before, double after, double samples) {
  constexpr double least_ratio = 1.15, by_chance = 1e-9;
  if (!(before > 0 && after > 0)) return before != after;
  // The correlation of differences that share a frame raises the variance of their mean square by 3/2.
  const double freedom = samples / 1.5;
  const double ratio = std::max(before, after) / std::min(before, after);
  return ratio > least_ratio &&
         cdf(distribution::complement(distribution::FisherF(freedom, freedom), ratio)) < by_chance;
}

double first_order_correlation(double ratio, int lag) {
  const auto sum = [&](double rho) {
    double total = 0, power = 1;
    for (int j = 0; j < lag; ++j, power *= rho) total += power;
    return total;
  };
  double low = -1, high = 1;  // for an even lag the sum rises from 0, for an odd one from 1
  if (ratio >= sum(high)) return high;
  if (lag % 2 == 1) {
    // It falls below 1 between -1 and 0, and rises after its minimum.
    for (double rho = -1; rho < 0; rho += 1e-3) {
      if (sum(rho) < sum(low)) low = rho;
    }
  }
  if (ratio <= sum(low)) return low;
  while (high - low > 1e-12) {
    const double middle = 0.5 * (low + high);
    (sum(middle) < ratio ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

Result<TemporalNoise> temporal_noise(std::span<const TimedPicture> pictures) {
  for (const TimedPicture& picture : pictures) {
    if (picture.picture.size() != pictures[0].picture.size())
      return fail(ErrorCode::invalid_input, "the frames have different sizes");
  }
  std::map<int, std::vector<Pair>> pairs;
  for (int lag = 1; lag <= longest_lag; ++lag) {
    if (auto found = pairs_at(pictures, lag); !found.empty()) pairs[lag] = std::move(found);
  }
  if (pairs.empty())
    return fail(ErrorCode::invalid_input, "temporal noise needs two frames without a correction between them");
  TemporalNoise noise;
  noise.usable = usable_pixels(pictures, pairs);
  noise.usable_share = cv::countNonZero(noise.usable) / static_cast<double>(noise.usable.total());
  const int base = pairs.begin()->first;
  std::map<int, AtLag> at;
  for (const auto& [lag, of_lag] : pairs) {
    const std::vector<AtLag> each = of_pairs(pictures, of_lag, noise.usable);
    if (lag == base) noise.changes = halves_differ(each, noise.usable.size());
    at[lag] = mean_of(each);
    noise.lags.push_back(lag);
    noise.structure.push_back(std::sqrt(at[lag].all));
  }
  noise.successive = noise.structure.front();
  if (!(noise.successive > 0))
    return fail(ErrorCode::invalid_input, "there is no noise: successive frames are identical");
  if (at[base].pixels > 0) {
    // The longest lag with at least a third of the pairs of the shortest one.
    int longest = base;
    for (const auto& [lag, of_lag] : pairs) {
      if (3 * of_lag.size() >= std::min(pairs.at(base).size(), most_pairs)) longest = lag;
    }
    noise.whole_to_successive = std::sqrt(at[longest].pixels / at[base].pixels);
    for (int steps = correlation_lag; steps >= 2 && !noise.lag1_correlation; --steps) {
      const auto found = pairs.find(steps * base);
      if (found == pairs.end() || 3 * found->second.size() < 2 * pairs.at(base).size()) continue;
      const double of_base = first_order_correlation(at[steps * base].pixels / at[base].pixels, steps);
      // Of pixels: a drift of whole frames would look like memory, a bounce like the opposite. If only every n-th
      // exposure is present, theirs is the n-th power.
      noise.lag1_correlation = base == 1 || of_base < 0 ? of_base : std::pow(of_base, 1.0 / base);
    }
  }
  return noise;
}

}  // namespace todbench
