// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/stage_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

namespace todbench {
namespace {

double weight(double standard_error) {
  return 1 / (standard_error * standard_error);
}

/// Subtracts the weighted mean of its set-up from each value of one axis.
std::vector<double> centred(std::span<const ShiftSeen> places, const std::vector<double>& values,
                            const std::vector<double>& weights) {
  std::map<int, std::pair<double, double>> sums;
  for (std::size_t i = 0; i < places.size(); ++i) {
    auto& [sum, total] = sums[places[i].set_up];
    sum += weights[i] * values[i], total += weights[i];
  }
  std::vector<double> out;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto& [sum, total] = sums[places[i].set_up];
    out.push_back(values[i] - sum / total);
  }
  return out;
}

double weighted_squares(const std::vector<double>& values, const std::vector<double>& weights) {
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i) sum += weights[i] * values[i] * values[i];
  return sum;
}

template <typename Of>
std::vector<double> each(std::span<const ShiftSeen> places, Of of) {
  std::vector<double> out;
  for (const ShiftSeen& place : places) out.push_back(of(place));
  return out;
}

/// One axis of the observed places without the origins of its set-ups.
struct Axis {
  std::vector<double> off, weights;
  double squares = 0;
};

Axis axis_of(std::span<const ShiftSeen> places, bool is_x) {
  Axis axis;
  axis.weights =
      each(places, [&](const ShiftSeen& p) { return weight(is_x ? p.standard_error_px.x : p.standard_error_px.y); });
  axis.off =
      centred(places, each(places, [&](const ShiftSeen& p) { return is_x ? p.off_px.x : p.off_px.y; }), axis.weights);
  axis.squares = weighted_squares(axis.off, axis.weights);
  return axis;
}

/// Weighted squares that one column explains, and its factor.
struct Explained {
  double squares = 0, factor = 0;
};

Explained explain(const Axis& axis, const std::vector<double>& column) {
  double xx = 0, xy = 0;
  for (std::size_t i = 0; i < column.size(); ++i) {
    xx += axis.weights[i] * column[i] * column[i];
    xy += axis.weights[i] * column[i] * axis.off[i];
  }
  return xx > 0 ? Explained{xy * xy / xx, xy / xx} : Explained{};
}

struct NamedMotion {
  cv::Matx22d seen_per_asked;
  const char* clause;
};

const std::array named_motions{
    NamedMotion{{-1, 0, 0, 1}, "the stage moves along x with the wrong sign"},
    NamedMotion{{1, 0, 0, -1}, "the stage moves along y with the wrong sign"},
    NamedMotion{{-1, 0, 0, -1}, "the stage moves along x and y with the wrong sign"},
    NamedMotion{{0, 1, 1, 0}, "the axes of the stage are exchanged"},
    NamedMotion{{0, 1, -1, 0}, "the axes of the stage are exchanged, and one has the wrong sign"},
    NamedMotion{{0, -1, 1, 0}, "the axes of the stage are exchanged, and one has the wrong sign"},
    NamedMotion{{0, -1, -1, 0}, "the axes of the stage are exchanged, and both have the wrong sign"},
    NamedMotion{{0, 0, 0, 0}, "the stage does not move"},
    NamedMotion{{0, 0, 0, 1}, "the stage does not move along x"},
    NamedMotion{{1, 0, 0, 0}, "the stage does not move along y"}};

/// A movement matches a named one within this and four standard errors.
constexpr double like = 0.15;

struct Step {
  double squares = 0;  ///< weighted, explained
  cv::Point2d by_px;
  std::size_t first = 0;  ///< of the moved places
};

/// The single movement of the picture within the last set-up that explains most.
Step best_step(std::span<const ShiftSeen> places, const Axis& x, const Axis& y) {
  Step best;
  for (std::size_t n = 1; n < places.size(); ++n) {
    if (places[n].set_up != places.back().set_up || places[n - 1].set_up != places.back().set_up) continue;
    std::vector<double> after;
    for (std::size_t i = 0; i < places.size(); ++i) after.push_back(i >= n ? 1 : 0);
    const Explained along_x = explain(x, centred(places, after, x.weights));
    const Explained along_y = explain(y, centred(places, after, y.weights));
    if (along_x.squares + along_y.squares > best.squares)
      best = {along_x.squares + along_y.squares, {along_x.factor, along_y.factor}, n};
  }
  return best;
}

/// Weighted squares explained by play of the stage: places depend on the direction of approach.
struct Play {
  double squares = 0;
  cv::Point2d px;
};

Play play_of(std::span<const ShiftSeen> places, const Axis& x, const Axis& y) {
  const auto directions = [&](bool is_x) {
    std::vector<double> column(places.size(), 0.0);
    for (std::size_t i = 1; i < places.size(); ++i) {
      const cv::Point2d by = places[i].asked_px - places[i - 1].asked_px;
      const double move = is_x ? by.x : by.y;
      column[i] = std::abs(move) < 1e-9 || places[i].set_up != places[i - 1].set_up ? column[i - 1]
                  : move > 0                                                        ? 0.5
                                                                                    : -0.5;
    }
    return column;
  };
  const Explained along_x = explain(x, centred(places, directions(true), x.weights));
  const Explained along_y = explain(y, centred(places, directions(false), y.weights));
  return {along_x.squares + along_y.squares, {std::abs(along_x.factor), std::abs(along_y.factor)}};
}

/// Weighted squares explained by pictures of the previous place.
double late_squares(std::span<const ShiftSeen> places, const Axis& x, const Axis& y) {
  std::vector<double> along_x(places.size(), 0.0), along_y(places.size(), 0.0);
  for (std::size_t i = 1; i < places.size(); ++i) {
    if (places[i].set_up != places[i - 1].set_up) continue;
    const cv::Point2d back = places[i - 1].asked_px - places[i].asked_px;
    along_x[i] = back.x, along_y[i] = back.y;
  }
  return explain(x, centred(places, along_x, x.weights)).squares +
         explain(y, centred(places, along_y, y.weights)).squares;
}

}  // namespace

std::optional<StageFit> fit_stage(std::span<const ShiftSeen> places) {
  if (places.size() < 4) return std::nullopt;
  StageFit fit;
  double before = 0, taken = 0;
  for (int row = 0; row < 2; ++row) {
    const Axis axis = axis_of(places, row == 0);
    const auto a = centred(places, each(places, [](const ShiftSeen& p) { return p.asked_px.x; }), axis.weights);
    const auto b = centred(places, each(places, [](const ShiftSeen& p) { return p.asked_px.y; }), axis.weights);
    cv::Matx22d normal = cv::Matx22d::zeros();
    cv::Vec2d gradient(0, 0);
    double total = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const cv::Vec2d column(a[i], b[i]);
      normal += axis.weights[i] * column * column.t();
      gradient += axis.weights[i] * axis.off[i] * column;
      total += axis.weights[i];
    }
    // Shifts that differ by less than 0.05 px rms do not determine a stage.
    if (!(std::min(normal(0, 0), normal(1, 1)) > 0.0025 * total) ||
        !(cv::determinant(normal) > 0.01 * normal(0, 0) * normal(1, 1)))
      return std::nullopt;
    const cv::Matx22d inverse = normal.inv();
    const cv::Vec2d found = inverse * gradient;
    for (int k = 0; k < 2; ++k) {
      fit.seen_per_asked(row, k) += found[k];
      fit.standard_error(row, k) = std::sqrt(inverse(k, k));
    }
    fit.chi2 += found.dot(gradient);
    before += axis.squares, taken += found.dot(gradient);
    if (row == 0) continue;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const cv::Vec2d column(a[i], b[i]);
      const double off = cv::norm(fit.seen_per_asked * column - column);
      if (off <= fit.largest_off_px) continue;
      fit.largest_off_px = off;
      fit.largest_off_error_px = std::sqrt(column.dot(inverse * column));
    }
  }
  fit.explained = before > 0 ? taken / before : 0;
  return fit;
}

std::string motion_clause(const StageFit& fit) {
  const cv::Matx22d& m = fit.seen_per_asked;
  const auto near = [&](const cv::Matx22d& to) {
    for (int k = 0; k < 4; ++k) {
      if (std::abs(m.val[k] - to.val[k]) > like + 4 * fit.standard_error.val[k]) return false;
    }
    return true;
  };
  for (const NamedMotion& motion : named_motions) {
    if (near(motion.seen_per_asked)) return motion.clause;
  }
  if (near({m(0, 0), 0, 0, m(1, 1)}))
    return fmt::format("the stage moves by {:.2f} times the requested shift along x and by {:.2f} times along y",
                       m(0, 0), m(1, 1));
  return fmt::format(
      "a requested pixel along x moves the picture by ({:.2f}, {:.2f}) px, one along y by ({:.2f}, {:.2f}) px", m(0, 0),
      m(1, 0), m(0, 1), m(1, 1));
}

bool moves_as_asked(const StageFit& fit, double most_deviation) {
  const cv::Matx22d off = fit.seen_per_asked - cv::Matx22d::eye();
  for (int k = 0; k < 4; ++k)
    if (std::abs(off.val[k]) > most_deviation + 4 * fit.standard_error.val[k]) return false;
  return true;
}

std::string likely_cause(std::span<const ShiftSeen> places) {
  const ShiftSeen& last = places.back();
  const Axis x = axis_of(places, true), y = axis_of(places, false);
  const double before = x.squares + y.squares;
  const auto stage = fit_stage(places);
  const Step step = best_step(places, x, y);
  const Play play = play_of(places, x, y);
  const double late = places.size() >= 6 ? late_squares(places, x, y) : 0;
  // Each has its own number of parameters: four, three, two, two.
  const double by_stage = stage && places.size() >= 6 ? stage->explained * before : 0;
  constexpr double most_of_it = 0.8;
  if (by_stage > most_of_it * before && by_stage >= 0.95 * std::max({step.squares, play.squares, late}))
    return motion_clause(*stage);
  if (late > most_of_it * before && late > std::max(step.squares, play.squares))
    return "frames show the previous place, because pictures arrive later than [measurement] frames_after_change "
           "allows for";
  if (places.size() >= 6 && play.squares > most_of_it * before && play.squares > step.squares)
    return fmt::format("the stage has play: {:.2f} px along x, {:.2f} px along y", play.px.x, play.px.y);
  if (step.squares > most_of_it * before && places.size() >= 3)
    return fmt::format("the picture moved by ({:+.2f}, {:+.2f}) px between presentations {} and {}", step.by_px.x,
                       step.by_px.y, places[step.first - 1].presentation, places[step.first].presentation);
  return fmt::format("in presentation {} the plate is ({:+.2f}, {:+.2f}) px from the requested place",
                     last.presentation, last.off_px.x, last.off_px.y);
}

}  // namespace todbench
