#include "tod/measures/slanted_edge.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "tod/measures/edge_clipping.h"
#include "tod/measures/edge_line.h"
#include "tod/measures/edge_transfer.h"
#include "tod/measures/medians.h"

namespace todbench {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double steepest_slant_deg = 25;
constexpr double least_reach_pitch = 5;
constexpr double largest_gap_pitch = 0.3;  // between samples where the profile changes: three phases a pitch and more
constexpr double knots_pitch = 0.25;
constexpr double bent_pitch = 0.25;  // beyond it the profile is that of a curve
constexpr double noted_bend_pitch = 0.05;
constexpr double sure = 4;  // standard uncertainties

double mean_of(const cv::Mat1d& picture) {
  return cv::mean(picture)[0];
}

/// The axis along which neighbours differ more: an edge across it does so in every line, and noise alike along both.
EdgeAxis axis_across(const cv::Mat1d& p) {
  const cv::Mat1d x = p.colRange(2, p.cols) - p.colRange(0, p.cols - 2);
  const cv::Mat1d y = p.rowRange(2, p.rows) - p.rowRange(0, p.rows - 2);
  return mean_of(x.mul(x)) >= mean_of(y.mul(y)) ? EdgeAxis::x : EdgeAxis::y;
}

/// A picture whose edge is nearly vertical with the bright side right, in units of which nothing is kept.
struct Upright {
  cv::Mat1d picture;
  EdgeAxis axis = EdgeAxis::x;
  double count_step = 0;
};

Result<Upright> upright(const cv::Mat1d& picture, const SlantedEdgeOptions& options) {
  if (picture.rows < 10 || picture.cols < 10)
    return fail(ErrorCode::invalid_input, "the picture is smaller than 10 x 10 pixels");
  if (!cv::checkRange(picture)) return fail(ErrorCode::invalid_input, "the picture holds a value that is no number");
  Upright out;
  double low = 0, high = 0;
  cv::minMaxLoc(picture, &low, &high);
  if (!(high > low)) return fail(ErrorCode::invalid_input, "there is no edge: every pixel is the same");
  if (!std::isfinite(high - low))
    return fail(ErrorCode::invalid_input, "the pixels reach over more than a number holds");
  out.axis = options.axis.value_or(axis_across(picture));
  cv::Mat1d p = picture - low;
  if (out.axis == EdgeAxis::y) p = p.t();
  const bool falls = mean_of(p.colRange(p.cols / 2, p.cols)) < mean_of(p.colRange(0, p.cols / 2));
  out.picture = falls ? cv::Mat1d((high - low) - p) : p;
  const bool counts =
      std::all_of(picture.begin(), picture.end(), [](double value) { return value == std::round(value); });
  out.count_step = counts ? 1 : 0;
  return out;
}

/// The straight line, the profile along it and what is known of both.
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

/// Where the profile first passes a level on its way from the edge to one side. On a noisy profile that is too near
/// rather than far too far.
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
    return fail(ErrorCode::invalid_input, "the edge leaves the picture, a region may be given that holds it whole");
  if (std::min(left + 0.5, in.picture.cols - 0.5 - right) < least_reach_pitch) {
    return fail(ErrorCode::invalid_input,
                fmt::format("the edge comes closer than {} pixels to the border of the picture", least_reach_pitch));
  }
  if (std::abs(line.slope) * rows < 1) {
    return fail(
        ErrorCode::invalid_input,
        fmt::format("the edge is slanted by {:.2f} degrees only: over the {} lines of the picture it crosses less "
                    "than one pixel",
                    std::abs(slant), rows));
  }
  return {};
}

/// The samples where the profile changes lie close enough together.
Result<void> check_gaps(const std::vector<EdgeSample>& samples) {
  std::vector<double> places;
  for (const EdgeSample& sample : samples) {
    if (std::abs(sample.t) <= 2) places.push_back(sample.t);
  }
  std::sort(places.begin(), places.end());
  for (std::size_t i = 1; i < places.size(); ++i) {
    if (places[i] - places[i - 1] > largest_gap_pitch)
      return fail(ErrorCode::invalid_input,
                  "the slant leaves gaps between the samples of the edge: it repeats after too few lines");
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

/// Lets line and profile settle on each other.
Result<Found> settled(const Upright& in) {
  auto line = first_line(in.picture);
  if (!line) return tl::unexpected(line.error());
  Found found;
  found.line = *line;
  for (int round = 0; round < 8; ++round) {
    found.reach = reach_of(in.picture.size(), found.line);
    if (std::abs(found.line.slope) > 1 || found.reach < 2) break;
    found.samples = samples_near(in.picture, found.line, found.reach);
    const auto profile = profile_of(found.samples, found.reach);
    if (!profile) return fail(ErrorCode::invalid_input, "the picture has too few lines for its edge");
    found.trend = trend_of(row_offsets(found.samples, *profile, in.picture.rows));
    // A wrong line makes the profile wide and its first correction too small or too large, never one in the wrong
    // direction.
    found.line.middle += std::clamp(found.trend.mean, -1.0, 1.0) / found.line.cosine();
    found.line.slope += found.trend.slope / found.line.cosine();
    if (std::abs(found.trend.mean) + std::abs(found.trend.slope) * in.picture.rows < 1e-7) break;
  }
  if (auto checked = check_line(in, found.line); !checked) return tl::unexpected(checked.error());
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

/// A plane through the samples of one side beyond the profile: its slopes along the normal and along the lines.
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

/// Takes out of the picture what slopes on the two sides of the edge, each as far as the side goes; by how much of the
/// step they changed over the profile's reach.
double remove_shading(cv::Mat1d& picture, const Found& found, const Spline& profile) {
  const double step = found.levels.bright - found.levels.dark;
  const double from = 2 * found.levels.width_pitch + 2;
  // Less than a count is what rounding makes of a field that is flat.
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

/// As much of the profile as noise allows, and never less than the edge needs: faint far tails of the optics count too.
EdgeWindow window_for(const Found& found, int rows) {
  constexpr double allowed = 0.003;  // of the MTF at half a cycle per pitch, by noise
  const double step = found.levels.bright - found.levels.dark;
  const double needed = 4 * found.levels.width_pitch / 2.563 + 2, longest = 0.85 * found.reach;
  const double noise = std::numbers::pi / std::numbers::sqrt2 * found.residual_sd / step;
  const double affordable = noise > 0 ? 0.5 * rows * std::pow(allowed / noise, 2) : longest;
  const double flat = std::min(std::max(needed, affordable), longest);
  return {flat, std::min(1.5 * flat, found.reach)};
}

/// A flat field beyond the profile that is not one count alone: its level lies between two, and where it changes from
/// one to the other is chance.
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

/// What rounding may do to the profile, as a share of the step, where nothing spreads it: half a count of each tail is
/// cut off; a flat field that changes by a count adds that to the edge, and as much to the step. Noise takes the
/// systematic part out, as exp(-2 pi^2 sd^2) of it with the standard deviation in counts.
double rounding_of(const Found& found) {
  if (!(found.levels.count_step > 0)) return 0;
  const double sd = found.residual_sd / found.levels.count_step;
  const double variance = std::max(0.0, sd * sd - 1.0 / 12);
  const double counts = between_counts(found) ? 3 : 1;
  return counts * found.levels.count_step / (found.levels.bright - found.levels.dark) *
         std::exp(-2 * std::numbers::pi * std::numbers::pi * variance);
}

Result<void> check_profile(const Found& found) {
  const double step = found.levels.bright - found.levels.dark;
  if (!(step > 3 * found.residual_sd) || !(found.levels.width_pitch > 0) || !(found.levels.steepest > 0))
    return fail(ErrorCode::invalid_input, "no straight edge stands out of the noise and the rest of the picture");
  if (std::abs(found.trend.sag) > bent_pitch && std::abs(found.trend.sag) > sure * found.trend.sag_u) {
    return fail(ErrorCode::invalid_input,
                fmt::format("the edge is bent by {:.2f} pixels, expected a straight one", std::abs(found.trend.sag)));
  }
  if (auto gaps = check_gaps(found.samples); !gaps) return gaps;
  if (1.6 * found.levels.width_pitch + 2 > found.reach) {
    return fail(
        ErrorCode::invalid_input,
        fmt::format("the edge is {:.1f} pixels wide and has {:.1f} on each side, which is too narrow a surrounding",
                    found.levels.width_pitch, found.reach));
  }
  return {};
}

std::optional<double> mtf50_of(const SlantedEdge& edge) {
  for (std::size_t i = 1; i < edge.mtf.size(); ++i) {
    if (edge.mtf[i] > 0.5) continue;
    const double share = (edge.mtf[i - 1] - 0.5) / (edge.mtf[i - 1] - edge.mtf[i]);
    return edge.frequency_per_pitch[i - 1] + share * (edge.frequency_per_pitch[i] - edge.frequency_per_pitch[i - 1]);
  }
  return std::nullopt;
}

void add_notes(SlantedEdge& edge, const Found& found) {
  if (std::abs(found.trend.sag) > noted_bend_pitch && std::abs(found.trend.sag) > sure * found.trend.sag_u)
    edge.notes.push_back(fmt::format("the edge is bent by {:.2f} pixels", std::abs(found.trend.sag)));
  if (found.shading > 0.01)
    edge.notes.push_back(fmt::format("shading of {:.1f} % of the step was taken out", 100 * found.shading));
  if (std::any_of(edge.mtf.begin() + 1, edge.mtf.end(), [](double value) { return value > 1.02; }))
    edge.notes.emplace_back("the MTF exceeds 1: the camera sharpens its picture");
}

}  // namespace

std::string_view to_string(EdgeAxis axis) {
  return axis == EdgeAxis::x ? "x" : "y";
}

Result<SlantedEdge> slanted_edge(const cv::Mat1d& picture, const SlantedEdgeOptions& options) {
  auto in = upright(picture, options);
  if (!in) return tl::unexpected(in.error());
  auto found = settled(*in);
  if (!found) return tl::unexpected(found.error());
  if (const auto side = clipped_side(found->samples, found->levels))
    return fail(ErrorCode::invalid_input, fmt::format("the {} side of the edge is clipped", *side));
  double shading = 0;
  constexpr int rounds = 3;  // the line moves a little when its surroundings become flat
  for (int round = 0; round < rounds; ++round) {
    const double removed = remove_shading(in->picture, *found, found->profile);
    if (removed == 0) break;
    shading = std::max(shading, removed);
    found = settled(*in);
    if (!found) return tl::unexpected(found.error());
  }
  found->shading = shading;
  if (auto checked = check_profile(*found); !checked) return tl::unexpected(checked.error());
  SlantedEdge edge;
  edge.axis = in->axis;
  edge.angle_deg = -std::atan(found->line.slope) / degree;
  edge.edge_at_pitch = found->line.middle;
  edge.curvature_pitch = std::abs(found->trend.sag);
  edge.step = found->levels.bright - found->levels.dark;
  edge.noise_over_step = found->residual_sd / edge.step;
  edge.shading_percent = 100 * found->shading;
  edge.rows = in->picture.rows;
  const EdgeWindow window = window_for(*found, edge.rows);
  edge.window_pitch = 2 * window.flat;
  constexpr int frequencies = 100;
  for (int k = 0; k <= frequencies; ++k) edge.frequency_per_pitch.push_back(k / static_cast<double>(frequencies));
  EdgeTransfer transfer = edge_transfer(grouped(found->samples, found->profile.grid, edge.rows), window,
                                        edge.frequency_per_pitch, rounding_of(*found));
  if (transfer.mtf.empty()) return fail(ErrorCode::invalid_input, "the picture has too few lines for its edge");
  edge.mtf = std::move(transfer.mtf), edge.mtf_low = std::move(transfer.low), edge.mtf_high = std::move(transfer.high);
  edge.mtf50_per_pitch = mtf50_of(edge);
  add_notes(edge, *found);
  return edge;
}

}  // namespace todbench
