// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/slanted_edge.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <utility>

#include "acquisition/base/try.h"
#include "tod/measures/edge_clipping.h"
#include "tod/measures/edge_line.h"
#include "tod/measures/edge_transfer.h"
#include "tod/measures/medians.h"
#include "tod/measures/mtf50.h"

namespace todbench {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double steepest_slant_deg = 46;  // beyond 45 degrees the edge runs across the other axis
constexpr double steepest_line = 1.2;      // slope at which the search for the line ends
constexpr double least_reach_pitch = 5;
constexpr double largest_gap_pitch = 0.3;  // between samples on the slope of the profile: at least three phases a pitch
constexpr double knots_pitch = 0.25;
constexpr double bent_pitch = 0.25;  // with more curvature the profile is that of a curve
constexpr double noted_bend_pitch = 0.05;
constexpr double least_displacement = 0.003;  // pitches: knots and rounding
constexpr double most_displacement = 0.3;
constexpr double noted_displacement = 0.02;
constexpr double sure = 4;             // standard uncertainties
constexpr double widest_share = 0.25;  // of the picture: wider halos are a loss of contrast of the whole picture

double mean_of(const cv::Mat1d& picture) {
  return cv::mean(picture)[0];
}

/// The axis along which neighbours differ more: an edge across it contributes in every line, noise equally along both.
EdgeAxis axis_across(const cv::Mat1d& p) {
  const cv::Mat1d x = p.colRange(2, p.cols) - p.colRange(0, p.cols - 2);
  const cv::Mat1d y = p.rowRange(2, p.rows) - p.rowRange(0, p.rows - 2);
  return mean_of(x.mul(x)) >= mean_of(y.mul(y)) ? EdgeAxis::x : EdgeAxis::y;
}

/// A picture whose edge is nearly vertical with the bright side right; its unit is arbitrary.
struct Upright {
  cv::Mat1d picture;
  EdgeAxis axis = EdgeAxis::x;
  double count_step = 0;
};

/// Returns the step of a picture of integer counts: their greatest common divisor above the lowest one. It is 1 if the
/// picture has fewer than 32 such steps, because a synthetic edge may have two levels only. Returns 0 for other
/// pictures.
double count_step_of(const cv::Mat1d& picture, double low, double high) {
  std::int64_t step = 0;
  for (const double value : picture) {
    if (value != std::round(value) || std::abs(value) > 1e15) return 0;
    if (step != 1) step = std::gcd(step, static_cast<std::int64_t>(value - low));
  }
  return high - low >= 32 * static_cast<double>(step) ? static_cast<double>(step) : 1;
}

Result<Upright> upright(const cv::Mat1d& picture, const SlantedEdgeOptions& options) {
  if (picture.rows < 10 || picture.cols < 10)
    return fail(ErrorCode::invalid_input, "the picture is smaller than 10 x 10 pixels");
  if (!cv::checkRange(picture))
    return fail(ErrorCode::invalid_input, "the picture contains a value that is not finite");
  Upright out;
  double low = 0, high = 0;
  cv::minMaxLoc(picture, &low, &high);
  if (!(high > low)) return fail(ErrorCode::invalid_input, "there is no edge: all pixels have the same value");
  if (!std::isfinite(high - low))
    return fail(ErrorCode::invalid_input, "the values of the pixels exceed the range of numbers");
  out.axis = options.axis.value_or(axis_across(picture));
  cv::Mat1d p = picture - low;
  if (out.axis == EdgeAxis::y) p = p.t();
  const bool falls = mean_of(p.colRange(p.cols / 2, p.cols)) < mean_of(p.colRange(0, p.cols / 2));
  out.picture = falls ? cv::Mat1d((high - low) - p) : p;
  out.count_step = count_step_of(picture, low, high);
  return out;
}

/// The straight line, the profile along it and their properties.
struct Found {
  EdgeLine line;
  std::vector<EdgeSample> samples;
  double reach = 0;
  Spline profile;
  EdgeLevels levels;
  RowTrend trend;
  double residual_sd = 0;
  double shading = 0;  ///< of the step
};

SplineGrid grid_over(double reach) {
  const int cells = 2 * static_cast<int>(std::floor(reach / knots_pitch));
  return {-0.5 * cells * knots_pitch, knots_pitch, cells};
}

std::optional<Spline> profile_of(const std::vector<EdgeSample>& samples, double reach) {
  SplineSums sums(grid_over(reach));
  for (const EdgeSample& sample : samples) sums.add(sample.t, sample.value);
  return sums.solve();
}

/// First place at which the profile passes a level on the way from the edge to one side; on a noisy profile rather too
/// near than far too far.
double crossing(const Spline& profile, double level, double direction) {
  constexpr double fine = 0.02;
  double t = 0;
  while (t > profile.grid.start && t < profile.grid.end() && direction * (profile.value(t) - level) < 0)
    t += direction * fine;
  return t;
}

EdgeLevels levels_of(const std::vector<EdgeSample>& samples, const Spline& profile, double reach) {
  std::array<double, 2> sums{}, counts{};
  for (const EdgeSample& sample : samples) {
    if (std::abs(sample.t) < 0.7 * reach) continue;
    sums[sample.t > 0 ? 1 : 0] += sample.value, counts[sample.t > 0 ? 1 : 0] += 1;
  }
  EdgeLevels levels;
  levels.dark = sums[0] / std::max(1.0, counts[0]), levels.bright = sums[1] / std::max(1.0, counts[1]);
  const double step = levels.bright - levels.dark;
  levels.width_pitch = crossing(profile, levels.dark + 0.9 * step, 1) - crossing(profile, levels.dark + 0.1 * step, -1);
  for (double t = profile.grid.start; t < profile.grid.end(); t += knots_pitch / 2)
    levels.steepest = std::max(levels.steepest, profile.slope(t));
  return levels;
}

Result<void> check_line(const Upright& in, const EdgeLine& line) {
  const double slant = std::atan(line.slope) / degree;
  const int rows = in.picture.rows;
  if (std::abs(slant) > steepest_slant_deg) {
    return fail(ErrorCode::invalid_input, fmt::format("the edge is slanted by {:.1f} degrees, expected at most {}",
                                                      std::abs(slant), steepest_slant_deg));
  }
  const double left = std::min(line.at(0), line.at(rows - 1)), right = std::max(line.at(0), line.at(rows - 1));
  if (left < -0.5 || right > in.picture.cols - 0.5)
    return fail(ErrorCode::invalid_input, "the edge leaves the picture: choose a region that contains all of it");
  if (std::min(left + 0.5, in.picture.cols - 0.5 - right) < least_reach_pitch) {
    return fail(ErrorCode::invalid_input,
                fmt::format("the edge comes closer than {} pixels to the border of the picture", least_reach_pitch));
  }
  if (std::abs(line.slope) * rows < 1) {
    return fail(ErrorCode::invalid_input, fmt::format("the edge is slanted by only {:.2f} degrees: over the {} lines "
                                                      "of the picture it crosses less than one pixel",
                                                      std::abs(slant), rows));
  }
  return {};
}

/// Checks that samples on the slope of the profile are close enough together.
Result<void> check_gaps(const std::vector<EdgeSample>& samples) {
  std::vector<double> places;
  for (const EdgeSample& sample : samples) {
    if (std::abs(sample.t) <= 2) places.push_back(sample.t);
  }
  std::sort(places.begin(), places.end());
  for (std::size_t i = 1; i < places.size(); ++i) {
    if (places[i] - places[i - 1] > largest_gap_pitch)
      return fail(ErrorCode::invalid_input,
                  "the samples across the edge have gaps, because its slant repeats after too few lines");
  }
  return {};
}

double residual_sd(const std::vector<EdgeSample>& samples, const Spline& profile) {
  double sum = 0, count = 0;
  for (const EdgeSample& sample : samples) {
    if (!(sample.t >= profile.grid.start && sample.t <= profile.grid.end())) continue;
    sum += std::pow(sample.value - profile.value(sample.t), 2), count += 1;
  }
  return std::sqrt(sum / std::max(1.0, count - static_cast<double>(profile.coefficients.size())));
}

/// Iterates line and profile until they agree.
Result<Found> settled(const Upright& in) {
  auto line = first_line(in.picture);
  if (!line) return tl::unexpected(line.error());
  Found found;
  found.line = *line;
  for (int round = 0; round < 8; ++round) {
    found.reach = reach_of(in.picture.size(), found.line);
    if (std::abs(found.line.slope) > steepest_line || found.reach < 2) break;
    found.samples = samples_near(in.picture, found.line, found.reach);
    const auto profile = profile_of(found.samples, found.reach);
    if (!profile) return fail(ErrorCode::invalid_input, "the picture has too few lines for its edge");
    found.trend = trend_of(row_offsets(found.samples, *profile, in.picture.rows));
    // A wrong line makes the profile wide and its first correction too small or too large, never of the wrong sign.
    found.line.middle += std::clamp(found.trend.mean, -1.0, 1.0) / found.line.cosine();
    found.line.slope += found.trend.slope / found.line.cosine();
    if (std::abs(found.trend.mean) + std::abs(found.trend.slope) * in.picture.rows < 1e-7) break;
  }
  TODBENCH_TRY_VOID(check_line(in, found.line));
  found.reach = reach_of(in.picture.size(), found.line);
  found.samples = samples_near(in.picture, found.line, found.reach);
  auto profile = profile_of(found.samples, found.reach);
  if (!profile) return fail(ErrorCode::invalid_input, "the picture has too few lines for its edge");
  found.profile = *std::move(profile);
  found.levels = levels_of(found.samples, found.profile, found.reach);
  found.levels.count_step = in.count_step;
  found.residual_sd = residual_sd(found.samples, found.profile);
  return found;
}

/// A plane through the samples of one side outside the profile: its slopes along the normal and along the lines.
struct SidePlane {
  double along = 0, across = 0;
};

SidePlane side_plane(const std::vector<EdgeSample>& samples, double from, double sign, double least_change) {
  std::vector<const EdgeSample*> used;
  for (const EdgeSample& sample : samples) {
    if (sign * sample.t >= from) used.push_back(&sample);
  }
  if (used.size() < 50) return {};
  cv::Vec3d mean(0, 0, 0);
  for (const EdgeSample* sample : used)
    mean += cv::Vec3d(sample->t, sample->row, sample->value) / static_cast<double>(used.size());
  double tt = 0, tr = 0, rr = 0, tv = 0, rv = 0, vv = 0;
  for (const EdgeSample* sample : used) {
    const double t = sample->t - mean[0], row = sample->row - mean[1], value = sample->value - mean[2];
    tt += t * t, tr += t * row, rr += row * row, tv += t * value, rv += row * value, vv += value * value;
  }
  const double determinant = tt * rr - tr * tr;
  if (!(determinant > 1e-6 * tt * rr)) return {};
  SidePlane plane{(rr * tv - tr * rv) / determinant, (tt * rv - tr * tv) / determinant};
  const double variance =
      std::max(0.0, vv - plane.along * tv - plane.across * rv) / (static_cast<double>(used.size()) - 3);
  const double t_range = std::sqrt(12 * tt / static_cast<double>(used.size()));
  const double row_range = std::sqrt(12 * rr / static_cast<double>(used.size()));
  const auto there = [&](double slope, double other_square, double reach) {
    return std::abs(slope) > sure * std::sqrt(variance * other_square / determinant) &&
           std::abs(slope) * reach > least_change;
  };
  return {there(plane.along, rr, t_range) ? plane.along : 0, there(plane.across, tt, row_range) ? plane.across : 0};
}

/// Removes the slope of each side of the edge from the picture; returns their change over the profile's reach relative
/// to the step.
double remove_shading(cv::Mat1d& picture, const Found& found, const Spline& profile) {
  const double step = found.levels.bright - found.levels.dark;
  const double from = 2 * found.levels.width_pitch + 2;
  // A slope of less than a count may be rounding of a flat field.
  const double least = std::max(1e-4 * step, found.levels.count_step);
  const SidePlane dark = side_plane(found.samples, from, -1, least);
  const SidePlane bright = side_plane(found.samples, from, 1, least);
  if (dark.along == 0 && dark.across == 0 && bright.along == 0 && bright.across == 0) return 0;
  for (int row = 0; row < picture.rows; ++row) {
    for (int x = 0; x < picture.cols; ++x) {
      const double t = (x - found.line.at(row)) * found.line.cosine(), y = row - found.line.middle_row;
      const double at = std::clamp(t, profile.grid.start, profile.grid.end());
      const double lit = std::clamp((profile.value(at) - found.levels.dark) / step, 0.0, 1.0);
      picture(row, x) -= (t * dark.along + y * dark.across) * (1 - lit) + (t * bright.along + y * bright.across) * lit;
    }
  }
  const auto change = [&](const SidePlane& plane) {
    return std::abs(plane.along) * found.reach + std::abs(plane.across) * picture.rows;
  };
  return std::max(change(dark), change(bright)) / step;
}

/// Largest part of the profile that noise permits, at least the part that the edge needs: faint far tails of the optics
/// count too.
EdgeWindow window_for(const Found& found, int rows) {
  constexpr double allowed = 0.003;  // of the MTF at half a cycle per pitch, by noise
  const double step = found.levels.bright - found.levels.dark;
  const double needed = 4 * found.levels.width_pitch / 2.563 + 2, longest = 0.85 * found.reach;
  const double noise = std::numbers::pi / std::numbers::sqrt2 * found.residual_sd / step;
  const double affordable = noise > 0 ? 0.5 * rows * std::pow(allowed / noise, 2) : longest;
  const double flat = std::min(std::max(needed, affordable), longest);
  return {flat, std::min(1.5 * flat, found.reach)};
}

/// Whether a flat field outside the profile has more than one count: its level lies between two, and the place of the
/// change is random.
bool between_counts(const Found& found) {
  const double from = 2 * found.levels.width_pitch + 1;
  std::array<std::pair<double, double>, 2> ends{std::pair(HUGE_VAL, -HUGE_VAL), std::pair(HUGE_VAL, -HUGE_VAL)};
  for (const EdgeSample& sample : found.samples) {
    if (std::abs(sample.t) < from) continue;
    auto& [low, high] = ends[sample.t > 0 ? 1 : 0];
    low = std::min(low, sample.value), high = std::max(high, sample.value);
  }
  return std::any_of(ends.begin(), ends.end(), [](const auto& end) { return end.second > end.first; });
}

/// Systematic error of a level by rounding, as a share of the step: half a count. Noise removes it, by exp(-2 pi^2
/// sd^2) with the standard deviation in counts.
double half_count_of(const Found& found) {
  if (!(found.levels.count_step > 0)) return 0;
  const double sd = found.residual_sd / found.levels.count_step;
  const double variance = std::max(0.0, sd * sd - 1.0 / 12);
  return 0.5 * found.levels.count_step / (found.levels.bright - found.levels.dark) *
         std::exp(-2 * std::numbers::pi * std::numbers::pi * variance);
}

/// Effect of rounding on the profile, as a share of the step, without spreading noise: half a count of each tail is cut
/// off, and each level may be half a count from the true one: up to two counts, and up to 1.5 were seen. A flat field
/// that changes by a count adds a third.
double rounding_of(const Found& found) {
  const double counts = between_counts(found) ? 3 : 2;
  return 2 * counts * half_count_of(found);
}

Result<void> check_profile(const Found& found) {
  const double step = found.levels.bright - found.levels.dark;
  if (!(step > 3 * found.residual_sd) || !(found.levels.width_pitch > 0) || !(found.levels.steepest > 0))
    return fail(ErrorCode::invalid_input, "no straight edge stands out from the noise and the rest of the picture");
  if (std::abs(found.trend.sag) > bent_pitch && std::abs(found.trend.sag) > sure * found.trend.sag_u) {
    return fail(ErrorCode::invalid_input,
                fmt::format("the edge is bent by {:.2f} pixels, expected a straight one", std::abs(found.trend.sag)));
  }
  TODBENCH_TRY_VOID(check_gaps(found.samples));
  if (1.6 * found.levels.width_pitch + 2 > found.reach) {
    return fail(
        ErrorCode::invalid_input,
        fmt::format(
            "the surround of the edge is too narrow: the edge is {:.1f} pixels wide and has {:.1f} pixels on each side",
            found.levels.width_pitch, found.reach));
  }
  return {};
}

/// Profiles of the model's columns at the samples of the edge.
template <typename Columns>
std::optional<std::vector<Spline>> column_profiles(const Found& found, std::size_t count, const Columns& columns_at) {
  std::vector<SplineSums> sums(count, SplineSums(found.profile.grid));
  std::vector<double> columns(count);
  for (const EdgeSample& sample : found.samples) {
    columns_at(sample, columns);
    for (std::size_t i = 0; i < count; ++i) sums[i].add(sample.t, columns[i]);
  }
  std::vector<Spline> profiles;
  for (const SplineSums& sum : sums) {
    auto profile = sum.solve();
    if (!profile) return std::nullopt;
    profiles.push_back(*std::move(profile));
  }
  return profiles;
}

std::optional<EdgeTails> plate_tails(const Upright& in, const Found& found, const PlateTails& plate) {
  const double cosine = found.line.cosine();
  auto profiles = column_profiles(found, plate.fit.unknowns(), [&](const EdgeSample& sample, auto& columns) {
    const double x = sample.t / cosine + found.line.at(sample.row);
    plate.columns(in.axis == EdgeAxis::x ? cv::Point2d(x, sample.row) : cv::Point2d(sample.row, x), columns);
  });
  if (!profiles) return std::nullopt;
  const Spline& narrow = (*profiles)[edge_tails::step];
  const double orientation = narrow.value(narrow.grid.end()) < narrow.value(narrow.grid.start) ? -1 : 1;
  return EdgeTails{plate.fit, *std::move(profiles), std::abs(plate.step), orientation};
}

/// Tails, level, step and a slope of each side along the normal and along the lines, from the picture itself.
std::optional<EdgeTails> own_tails(const Upright& in, const Found& found, const cv::Mat1d& seen,
                                   const SlantedEdgeOptions& options) {
  constexpr std::size_t slopes = 4, unknowns = edge_tails::first_shading + slopes;
  constexpr double unit = 10;  // pitches
  const double sigma = std::max(found.levels.width_pitch / 2.563, 0.1);
  double middle = 0;  // of the step along the normal
  {
    const double half = 0.5 * (found.levels.dark + found.levels.bright);
    middle = crossing(found.profile, half, 1);
    if (middle == 0) middle = crossing(found.profile, half, -1);
  }
  const auto columns_at = [&](const EdgeSample& sample, std::vector<double>& columns) {
    const double t = sample.t - middle, row = (sample.row - found.line.middle_row) / unit;
    set_tail_columns(t, columns);
    const double lit = 0.5 * std::erfc(-t / sigma / std::numbers::sqrt2);
    const std::size_t at = edge_tails::first_shading;
    columns[at] = lit * t / unit, columns[at + 1] = (1 - lit) * t / unit;
    columns[at + 2] = lit * row, columns[at + 3] = (1 - lit) * row;
  };
  const double core = std::max(1.2 * found.levels.width_pitch + 1.2, 3.0);
  const double step = found.levels.bright - found.levels.dark;
  TailSamples tails(slopes);
  std::vector<double> columns(unknowns);
  constexpr int block = 8;
  const int across = in.picture.cols / block + 1;
  for (const EdgeSample& sample : samples_near(seen, found.line, in.picture.cols)) {
    if (std::abs(sample.t - middle) < core) continue;
    columns_at(sample, columns);
    const int x = static_cast<int>(std::lround(sample.t / found.line.cosine() + found.line.at(sample.row)));
    tails.add(columns, (sample.value - found.levels.dark) / step, 1,
              static_cast<std::size_t>(sample.row / block * across + x / block));
  }
  TailBounds bounds = options.tails;
  bounds.widest_pitch = std::min(bounds.widest_pitch, widest_share * in.picture.cols * found.line.cosine());
  auto fit = tails.fit(bounds, half_count_of(found));
  if (!fit) return std::nullopt;
  auto profiles = column_profiles(found, unknowns, columns_at);
  if (!profiles) return std::nullopt;
  return EdgeTails{*std::move(fit), *std::move(profiles), step, 1};
}

/// Variance of the lines' places about the straight edge in excess of noise: interlaced fields, a bend, vibration. 0 if
/// not significant at 1 %, else its upper 95 % limit.
Result<double> line_displacement(const Found& found) {
  const int rows = found.samples.back().row + 1;
  std::vector<double> squares(static_cast<std::size_t>(rows));
  for (const EdgeSample& sample : found.samples)
    if (sample.t >= found.profile.grid.start && sample.t <= found.profile.grid.end())
      squares[static_cast<std::size_t>(sample.row)] += std::pow(found.profile.slope(sample.t), 2);
  const std::vector<double> offsets = row_offsets(found.samples, found.profile, rows);
  // Noise outside the core: that inside contains the displacement.
  double noise = 0, count = 0;
  const double from = std::min(1.2 * found.levels.width_pitch + 1.2, 0.6 * found.reach);
  for (const EdgeSample& sample : found.samples) {
    if (std::abs(sample.t) < from || std::abs(sample.t) > found.reach - 0.01) continue;
    noise += std::pow(
        sample.value - found.profile.value(std::clamp(sample.t, found.profile.grid.start, found.profile.grid.end())),
        2);
    count += 1;
  }
  // Knots reduce the number of independent samples.
  const double knots = std::max(0.0, 2 * (found.reach - from) / knots_pitch);
  noise /= std::max(1.0, count - knots);
  const double freedom = rows - 2.0;
  double sum = 0, expected = 0;
  for (std::size_t row = 0; row < offsets.size(); ++row) {
    if (!(squares[row] > 0)) continue;
    sum += offsets[row] * offsets[row];
    expected += noise / squares[row] + least_displacement * least_displacement;
  }
  const double ratio = expected > 0 ? sum / expected : 0;
  // The square of a normal sum by Wilson and Hilferty (1931).
  const double limit = std::pow(1 - 2 / (9 * freedom) + 2.326 * std::sqrt(2 / (9 * freedom)), 3);
  if (!(ratio > limit)) return 0.0;
  const double variance = (sum * (1 + 1.645 * std::sqrt(2 / freedom)) - expected) / freedom;
  if (std::sqrt(variance) > most_displacement) {
    return fail(ErrorCode::invalid_input,
                fmt::format("the lines of the picture are displaced by {:.2f} pixels (standard deviation), expected "
                            "one straight edge: if the picture is interlaced, use one field",
                            std::sqrt(variance)));
  }
  return std::max(0.0, variance);
}

void add_notes(SlantedEdge& edge, const Found& found) {
  if (std::abs(found.trend.sag) > noted_bend_pitch && std::abs(found.trend.sag) > sure * found.trend.sag_u)
    edge.notes.push_back(fmt::format("the edge is bent by {:.2f} pixels", std::abs(found.trend.sag)));
  if (edge.displacement_pitch > noted_displacement) {
    edge.notes.push_back(
        fmt::format("lines are displaced by up to {:.2f} pixels (standard deviation): the true MTF may be higher; the "
                    "interval allows for it",
                    edge.displacement_pitch));
  }
  if (found.shading > 0.01)
    edge.notes.push_back(
        fmt::format("the fields beside the edge are uneven by {:.1f} % of the step; the fit of the tails tells shading "
                    "from halos",
                    100 * found.shading));
  if (edge.sharpened)
    edge.notes.emplace_back(
        "the levels beside the edge overshoot: the camera sharpens its picture or removes slow changes. The intervals "
        "allow for such a filter; a larger picture makes them shorter");
  if (edge.wide_halo_most > least_wide_share)
    edge.notes.push_back(
        fmt::format("{:.1f} to {:.1f} % of the step are in halos wider than {:.1f} pitches, which a larger picture "
                    "would tell from shading: the lower ends of the intervals allow for them",
                    100 * edge.wide_halo_least, 100 * edge.wide_halo_most, edge.widest_halo_pitch));
  if (!edge.sharpened && std::any_of(edge.mtf.begin() + 1, edge.mtf.end(), [](double value) { return value > 1.02; }))
    edge.notes.emplace_back("the MTF exceeds 1: the camera sharpens its picture");
}

}  // namespace

std::string_view to_string(EdgeAxis axis) {
  return axis == EdgeAxis::x ? "x" : "y";
}

Result<SlantedEdge> slanted_edge(const cv::Mat1d& picture, const SlantedEdgeOptions& options) {
  TODBENCH_TRY(auto in, upright(picture, options));
  auto found = settled(in);
  if (!found) return tl::unexpected(found.error());
  if (const auto side = clipped_side(found->samples, found->levels))
    return fail(ErrorCode::invalid_input, fmt::format("the {} side of the edge is clipped", *side));
  const cv::Mat1d seen = in.picture.clone();
  double shading = 0;
  constexpr int rounds = 3;  // the line moves a little when its surroundings become flat
  for (int round = 0; round < rounds; ++round) {
    const double removed = remove_shading(in.picture, *found, found->profile);
    if (removed == 0) break;
    shading = std::max(shading, removed);
    found = settled(in);
    if (!found) return tl::unexpected(found.error());
  }
  found->shading = shading;
  TODBENCH_TRY_VOID(check_profile(*found));
  SlantedEdge edge;
  edge.axis = in.axis;
  edge.angle_deg = -std::atan(found->line.slope) / degree;
  edge.edge_at_pitch = found->line.middle;
  edge.curvature_pitch = std::abs(found->trend.sag);
  edge.step = found->levels.bright - found->levels.dark;
  edge.noise_over_step = found->residual_sd / edge.step;
  edge.shading_percent = 100 * found->shading;
  edge.rows = in.picture.rows;
  const EdgeWindow window = window_for(*found, edge.rows);
  edge.window_pitch = 2 * window.flat;
  constexpr int frequencies = 100;
  for (int k = 0; k <= frequencies; ++k) edge.frequency_per_pitch.push_back(k / static_cast<double>(frequencies));
  const auto tails = options.plate ? plate_tails(in, *found, *options.plate) : own_tails(in, *found, seen, options);
  if (!tails) return fail(ErrorCode::invalid_input, "the edge has too few pixels beyond its profile");
  // Shading is an unknown of the tails: use the original picture.
  const std::vector<EdgeSample> samples = samples_near(seen, found->line, found->reach);
  TODBENCH_TRY(const auto displacement, line_displacement(*found));
  edge.displacement_pitch = std::sqrt(displacement);
  EdgeTransfer transfer = edge_transfer(grouped(samples, found->profile.grid, edge.rows), window,
                                        edge.frequency_per_pitch, *tails, rounding_of(*found), displacement);
  if (transfer.mtf.empty()) return fail(ErrorCode::invalid_input, "the picture has too few lines for its edge");
  edge.low_known = std::move(transfer.low_known);
  edge.widest_halo_pitch = tails->fit.bounds().widest_pitch;
  edge.halo_allowance = tails->fit.halo_allowance();
  // The bounds of the fit have a tolerance.
  const double most_wide = tails->fit.bounds().most_wide;
  edge.wide_halo_least = std::min(tails->fit.least_wide_share(), most_wide);
  edge.wide_halo_most = std::min(tails->fit.most_wide_share(), most_wide);
  edge.mtf = std::move(transfer.mtf), edge.mtf_low = std::move(transfer.low), edge.mtf_high = std::move(transfer.high);
  edge.mtf_low_in_picture = edge.mtf_low;
  if (edge.wide_halo_most > least_wide_share)
    std::for_each(edge.mtf_low.begin() + 1, edge.mtf_low.end(), [&](double& low) { low *= 1 - edge.wide_halo_most; });
  edge.mtf50_per_pitch = first_half(edge.frequency_per_pitch, edge.mtf);
  edge.sharpened = tails->fit.sharpened();
  add_notes(edge, *found);
  return edge;
}

}  // namespace todbench
