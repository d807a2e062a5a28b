// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/absolute_measure.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "acquisition/base/distributions.h"
#include "acquisition/base/normal.h"
#include "acquisition/base/try.h"
#include "tod/measures/separated_pattern.h"
#include "tod/measures/shading.h"
#include "tod/measures/signal_transfer.h"

namespace todbench {
namespace {

/// Share of pixels at an end of the counts from which a level is saturated.
constexpr double saturated_share = 1e-3;
constexpr std::size_t least_levels = 3;
constexpr std::size_t passes = 2;

cv::Mat1d without_shading(const cv::Mat1d& picture) {
  return picture - cv::mean(picture)[0] - shading_of(picture).surface;
}

/// One temperature of one pass.
struct Seen {
  double said_k = 0, expected_k = 0, mean_k = 0, noise_k = 0;
  std::optional<double> camera_c{};
  cv::Mat1d picture;
  bool saturated = false;
};

struct CountEnds {
  std::shared_ptr<const RadiometricScale> scale;
  int bits = 16;
  [[nodiscard]] double top() const { return std::exp2(bits) - 1; }
};

std::optional<double> mean_reading(const std::optional<double>& a, const std::optional<double>& b) {
  return a && b ? std::optional(0.5 * (*a + *b)) : std::nullopt;
}

class AbsoluteRun {
 public:
  AbsoluteRun(FrameTaker& taker, const ShowTemperature& show, const AbsoluteOptions& options,
              const std::stop_token& stop)
      : taker_(taker), show_(show), options_(options), stop_(stop) {}

  Result<AbsoluteMeasure> operator()() {
    const std::vector<double>& temperatures = options_.temperatures_k;
    std::vector<std::vector<Seen>> seen(temperatures.size());
    for (std::size_t pass = 0; pass < passes; ++pass) {
      for (std::size_t i = 0; i < temperatures.size(); ++i) {
        const std::size_t at = pass == 0 ? i : temperatures.size() - 1 - i;
        TODBENCH_TRY(Seen one, look(temperatures[at], {0, 0}));
        seen[at].push_back(std::move(one));
      }
    }
    for (std::size_t i = 0; i < seen.size(); ++i) add_level(temperatures[i], seen[i]);
    std::erase_if(seen, [](const std::vector<Seen>& level) { return level[0].saturated || level[1].saturated; });
    if (seen.size() < least_levels)
      return fail(ErrorCode::invalid_input, "fewer than three temperatures do not saturate the camera");
    add_repeatability(seen);
    TODBENCH_TRY_VOID(add_line());
    add_prnu(seen);
    const Seen& middle = seen[seen.size() / 2][0];
    add_range(middle.noise_k, static_cast<double>(middle.picture.total()));
    if (options_.shift_px > 0) {
      if (auto apart = tell_apart(); !apart) {
        if (apart.error().code != ErrorCode::invalid_input) return tl::unexpected(apart.error());
        out_.reasons.push_back("patterns of camera and source: " + apart.error().message);
      }
    }
    return std::move(out_);
  }

 private:
  Result<Seen> look(double temperature_k, cv::Point shift_px) {
    const cv::Point2d shift_mm(options_.pixel_mm * shift_px.x, options_.pixel_mm * options_.pixel_aspect * shift_px.y);
    TODBENCH_TRY(const PresentedTarget shown, show_(temperature_k, shift_mm));
    const double said_k = shown.black_body_temperature_k.value_or(temperature_k);
    TODBENCH_TRY(const AveragedPicture picture,
                 taker_.average(options_.frames, stop_, [&](const Frame& frame, const cv::Mat1d&) {
                   ends_ = {frame.scale, frame.significant_bits};
                 }));
    const int at_ends = cv::countNonZero(picture.lowest == 0) + cv::countNonZero(picture.highest >= ends_.top());
    return Seen{.said_k = said_k,
                .expected_k = options_.expected_k ? options_.expected_k(said_k) : said_k,
                .mean_k = cv::mean(picture.kelvin)[0],
                .noise_k = picture.temporal_noise_k,
                .camera_c = options_.camera_temperature_c ? options_.camera_temperature_c() : std::nullopt,
                .picture = picture.kelvin.clone(),
                .saturated = at_ends > saturated_share * static_cast<double>(picture.kelvin.total())};
  }

  void add_level(double set_k, const std::vector<Seen>& seen) {
    const Seen &up = seen[0], &down = seen[1];
    AbsoluteLevel level{.set_k = set_k,
                        .said_k = 0.5 * (up.said_k + down.said_k),
                        .expected_k = 0.5 * (up.expected_k + down.expected_k),
                        .seen_k = 0.5 * (up.mean_k + down.mean_k),
                        .difference_k = (down.mean_k - down.expected_k) - (up.mean_k - up.expected_k),
                        .saturated = up.saturated || down.saturated,
                        .camera_c = mean_reading(up.camera_c, down.camera_c)};
    if (!level.saturated) level.pattern_k = pattern_sd({without_shading(up.picture), without_shading(down.picture)});
    out_.levels.push_back(level);
  }

  /// Both passes at each of n temperatures: the variance of a reading from half of the squared differences. A reading
  /// is at least as uncertain as the mean of its pixels, although few differences may be smaller by chance.
  void add_repeatability(const std::vector<std::vector<Seen>>& seen) {
    double squares = 0, of_pixels = 0;
    for (const AbsoluteLevel& level : out_.levels) squares += level.saturated ? 0 : std::pow(level.difference_k, 2);
    for (const auto& level : seen) {
      for (const Seen& pass : level)
        of_pixels += pass.noise_k * pass.noise_k / (static_cast<double>(pass.picture.total()) * options_.frames);
    }
    const auto levels = static_cast<double>(seen.size());
    out_.repeatability_k = std::sqrt(0.5 * squares / levels);
    const double least_k = std::sqrt(of_pixels / (levels * static_cast<double>(passes)));
    out_.u_k = std::max(out_.repeatability_k, least_k) / std::sqrt(static_cast<double>(passes));
    out_.degrees_of_freedom = static_cast<int>(seen.size());
  }

  Result<void> add_line() {
    double middle_k = 0;
    std::vector<TemperatureStep> steps;
    for (const AbsoluteLevel& level : out_.levels) middle_k += level.saturated ? 0 : level.expected_k;
    middle_k /= out_.degrees_of_freedom;
    for (const AbsoluteLevel& level : out_.levels) {
      if (level.saturated) continue;
      steps.push_back({level.expected_k - middle_k, level.seen_k - middle_k,
                       out_.u_k > 0 ? std::optional(out_.u_k) : std::nullopt});
    }
    TODBENCH_TRY(const SignalTransfer line, signal_transfer(steps));
    const double t = quantile(distribution::StudentsT(out_.degrees_of_freedom), 0.975);
    const double slope_half = t * line.slope_u;
    const double offset_half =
        std::hypot(t * out_.u_k / std::sqrt(out_.degrees_of_freedom), normal_z95 * options_.source_u_k);
    out_.slope = {line.slope, line.slope - slope_half, line.slope + slope_half};
    out_.offset_k = {line.offset, line.offset - offset_half, line.offset + offset_half};
    out_.nonlinearity_percent = line.nonlinearity_percent;
    return {};
  }

  /// Responsivity of each pixel: slope of its temperature over the mean of the picture, in each pass.
  void add_prnu(const std::vector<std::vector<Seen>>& seen) {
    PatternPair pair;
    for (std::size_t pass = 0; pass < passes; ++pass) {
      double mean = 0, squares = 0;
      for (const auto& level : seen) mean += level[pass].mean_k / static_cast<double>(seen.size());
      cv::Mat1d slope = cv::Mat1d::zeros(seen.front()[pass].picture.size());
      for (const auto& level : seen) {
        const double off = level[pass].mean_k - mean;
        cv::scaleAdd(level[pass].picture, off, slope, slope);
        squares += off * off;
      }
      (pass == 0 ? pair.first : pair.second) = without_shading(100 * slope / squares);
    }
    out_.prnu_percent = pattern_sd(pair);
  }

  void add_range(double noise_k, double pixels) {
    if (!ends_.scale) return;
    out_.lowest_k = ends_.scale->kelvin(0);
    out_.highest_k = ends_.scale->kelvin(ends_.top());
    if (!out_.lowest_k || !out_.highest_k || !(noise_k > 0)) return;
    out_.dynamic_range_db = 20 * std::log10((*out_.highest_k - *out_.lowest_k) / noise_k);
    // Variance from successive differences: that of independent frames times 1.5.
    const double relative = normal_z95 * std::sqrt(0.75 / (pixels * std::max(1, options_.frames - 1)));
    out_.dynamic_range_half_db = 20 * std::log10(1 + relative);
  }

  /// Places of the source whose differences have no common divisor.
  [[nodiscard]] std::vector<cv::Point> places() const {
    const int far = options_.shift_px;
    int near = std::max(1, static_cast<int>(std::lround(0.6 * far)));
    while (std::gcd(near, far) != 1) --near;
    return {{0, 0}, {far, 0}, {0, far}, {-near, 0}, {0, -near}};
  }

  Result<void> tell_apart() {
    const double middle_k = options_.temperatures_k[options_.temperatures_k.size() / 2];
    std::vector<ShiftedPicture> halves[passes];
    for (auto& half : halves) {
      for (const cv::Point place : places()) {
        TODBENCH_TRY(Seen one, look(middle_k, place));
        half.push_back({place, std::move(one.picture)});
      }
    }
    TODBENCH_TRY(const SeparatedPattern first, separated_pattern(halves[0]));
    TODBENCH_TRY(const SeparatedPattern second, separated_pattern(halves[1]));
    out_.camera_pattern_k = pattern_sd({first.camera, second.camera});
    out_.source_pattern_k = pattern_sd({first.source, second.source});
    const cv::Point2d slope = 0.5 * (first.slope_per_px + second.slope_per_px);
    out_.undetermined_slope_k =
        std::abs(slope.x) * (first.camera.cols - 1) + std::abs(slope.y) * (first.camera.rows - 1);
    return {};
  }

  FrameTaker& taker_;
  const ShowTemperature& show_;
  const AbsoluteOptions& options_;
  const std::stop_token& stop_;
  AbsoluteMeasure out_{.plate = options_.plate, .frames = options_.frames, .source_u_k = options_.source_u_k};
  CountEnds ends_;
};

}  // namespace

Estimate pattern_sd(const PatternPair& pair) {
  const cv::Mat1d product = pair.first.mul(pair.second);
  cv::Scalar mean, sd;
  cv::meanStdDev(product, mean, sd);
  const double half = normal_z95 * sd[0] / std::sqrt(static_cast<double>(product.total()));
  const auto root = [](double variance) { return std::sqrt(std::max(0.0, variance)); };
  return {root(mean[0]), root(mean[0] - half), root(mean[0] + half)};
}

const AbsoluteLevel& AbsoluteMeasure::worst() const {
  const auto size = [](const AbsoluteLevel& level) {
    return level.saturated ? -1 : std::abs(level.seen_k - level.expected_k);
  };
  return *std::ranges::max_element(levels, {}, size);
}

Estimate AbsoluteMeasure::deviation_k(const AbsoluteLevel& level) const {
  const double t = degrees_of_freedom > 0 ? quantile(distribution::StudentsT(degrees_of_freedom), 0.975) : 0;
  const double value = level.seen_k - level.expected_k, half = std::hypot(t * u_k, normal_z95 * source_u_k);
  return {value, value - half, value + half};
}

Estimate AbsoluteMeasure::ietd_k() const {
  Estimate largest;
  for (const AbsoluteLevel& level : levels) {
    if (!level.saturated && level.pattern_k.value >= largest.value) largest = level.pattern_k;
  }
  return {largest.value / slope.value, largest.low / slope.value, largest.high / slope.value};
}

Result<AbsoluteMeasure> measure_absolute(FrameTaker& taker, const ShowTemperature& show, const AbsoluteOptions& options,
                                         const std::stop_token& stop) {
  return AbsoluteRun(taker, show, options, stop)();
}

}  // namespace todbench
