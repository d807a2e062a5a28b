// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/range/range_prediction.h"
#include "acquisition/base/try.h"
#include "tod/psychometric/acuity.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "hvs/observer/open_parameters.h"

namespace todbench {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Ratio V75 / V50 of the target transfer probability function: the x at which x^E = 3, E = 1.51 + 0.24 x.
constexpr double v75_over_v50 = 1.7650293160712442;
constexpr int pieces = 256;  ///< number of parts in the search for a crossing before bisection

/// ln acuity at a contrast with the distance to both sides of its 95 % interval; infinite for an open side.
struct LogAcuity {
  double value = 0, below = 0, above = 0;
};

struct Node {
  double ln_contrast = 0;
  LogAcuity acuity;
};

Node node_of(const TodThreshold& threshold) {
  const double value = -std::log(threshold.s75_mrad);
  const auto& [low, high] = threshold.s75_ci95_mrad;
  return {std::log(threshold.delta_t_k),
          {value, high ? std::max(0.0, std::log(*high) + value) : infinity,
           low && *low > 0 ? std::max(0.0, -value - std::log(*low)) : infinity}};
}

/// Weighted sum of two independent errors; a weight of 0 excludes an open side.
double joined(double weight_a, double a, double weight_b, double b) {
  return std::hypot(weight_a > 0 ? weight_a * a : 0, weight_b > 0 ? weight_b * b : 0);
}

std::optional<LogAcuity> at(const std::vector<Node>& nodes, double ln_contrast) {
  if (ln_contrast < nodes.front().ln_contrast) return std::nullopt;
  if (ln_contrast >= nodes.back().ln_contrast) return nodes.back().acuity;
  const auto above = std::upper_bound(nodes.begin(), nodes.end(), ln_contrast,
                                      [](double x, const Node& node) { return x < node.ln_contrast; });
  const Node& b = *above;
  const Node& a = *std::prev(above);
  const double w = (ln_contrast - a.ln_contrast) / (b.ln_contrast - a.ln_contrast);
  return LogAcuity{a.acuity.value + w * (b.acuity.value - a.acuity.value),
                   joined(1 - w, a.acuity.below, w, b.acuity.below), joined(1 - w, a.acuity.above, w, b.acuity.above)};
}

std::vector<Node> nodes_of(std::span<const TodThreshold> sorted) {
  std::vector<Node> nodes;
  for (const auto& threshold : sorted) nodes.push_back(node_of(threshold));
  return nodes;
}

/// Which of the three curves: the estimate, or a side of its band.
enum class Side { estimate, low, high };

double side_of(const LogAcuity& acuity, Side side) {
  if (side == Side::low) return acuity.value - acuity.below;
  if (side == Side::high) return acuity.value + acuity.above;
  return acuity.value;
}

/// The target line against one TOD curve, in natural logarithms of metres, 1/mrad and kelvin.
class TargetLine {
 public:
  TargetLine(const std::vector<Node>& nodes, const RangeTask& task) : nodes_(nodes), task_(task) {}

  /// Minus infinity beyond the end of a table.
  [[nodiscard]] double ln_contrast(double range_m) const {
    const double at_target = std::log(std::abs(task_.delta_t_k));
    if (task_.air) return at_target - task_.air->optical_depth(range_m).value_or(infinity);
    return at_target - task_.extinction_per_km * range_m / 1000;
  }
  /// ln(M / M75): the angle in mrad is 1000 size / range.
  [[nodiscard]] std::optional<double> ln_m_over_m75(double range_m, Side side) const {
    const auto acuity = at(nodes_, ln_contrast(range_m));
    if (!acuity) return std::nullopt;
    return std::log(1000 * task_.size_m / task_.m75) - std::log(range_m) + side_of(*acuity, side);
  }
  /// Range at which the apparent contrast leaves the TOD curve at its low end, or the table of the air ends; infinite
  /// without extinction, negative if the target's contrast lies below the curve.
  [[nodiscard]] double end_m() const;
  [[nodiscard]] bool ends_with_the_table() const { return task_.air && end_m() >= task_.air->end_m(); }
  /// The range at which a TOD curve of constant acuity would be met.
  [[nodiscard]] double range_of(double ln_acuity) const {
    return 1000 * task_.size_m / task_.m75 * std::exp(ln_acuity);
  }
  /// The smallest range at which M falls to M75; empty if the curve ends before.
  [[nodiscard]] std::optional<double> crossing(Side side) const;

 private:
  [[nodiscard]] double bisected(double inside, double outside, Side side) const;
  const std::vector<Node>& nodes_;
  RangeTask task_;
};

double TargetLine::end_m() const {
  const double depth = std::log(std::abs(task_.delta_t_k)) - nodes_.front().ln_contrast;
  const auto rounded = [](double end_m) { return std::abs(end_m) < nearest_range_m ? 0 : end_m; };
  if (!task_.air) return task_.extinction_per_km > 0 ? rounded(1000 * depth / task_.extinction_per_km) : infinity;
  if (depth < 0) return -1;
  const auto seen = [&](double range_m) { return task_.air->optical_depth(range_m).value_or(infinity) <= depth; };
  double outside = std::min(task_.air->end_m(), std::numeric_limits<double>::max());
  if (seen(outside)) return task_.air->end_m();
  double inside = 0;
  for (int i = 0; i < 2200; ++i) {
    const double middle = inside + (outside - inside) / 2;
    if (!(middle > inside && middle < outside)) break;
    (seen(middle) ? inside : outside) = middle;
  }
  return rounded(inside);
}

double TargetLine::bisected(double inside, double outside, Side side) const {
  for (int i = 0; i < 200 && inside < outside; ++i) {
    const double middle = std::sqrt(inside) * std::sqrt(outside);
    if (!(middle > inside && middle < outside)) break;
    const auto m = ln_m_over_m75(middle, side);
    (m && *m > 0 ? inside : outside) = middle;
  }
  return std::sqrt(inside) * std::sqrt(outside);
}

std::optional<double> TargetLine::crossing(Side side) const {
  double lowest = infinity, highest = -infinity;
  for (const auto& node : nodes_) {
    // With an open side the crossing is unknown, unless other points decide it.
    if (std::isfinite(side_of(node.acuity, side))) {
      lowest = std::min(lowest, side_of(node.acuity, side));
      highest = std::max(highest, side_of(node.acuity, side));
    }
  }
  if (!(lowest <= highest)) return std::nullopt;
  // A band is always inside the outermost ends of its points, because joined errors are smaller than single ones.
  const double first = range_of(lowest) * 0.99;
  const double last = std::min(end_m(), range_of(highest) * 1.01);
  double inside = std::min(first, last);
  if (inside <= 0) return std::nullopt;
  const auto start = ln_m_over_m75(inside, side);
  if (!start || !std::isfinite(*start)) return std::nullopt;
  if (*start <= 0) return bisected(inside * 1e-3, inside, side);
  const double step = std::pow(last / inside, 1.0 / pieces);
  for (int i = 0; i < pieces && last > inside; ++i) {
    const double next = i + 1 == pieces ? last : inside * step;
    const auto m = ln_m_over_m75(next, side);
    if (!m || std::isinf(*m)) return std::nullopt;
    if (*m <= 0) return bisected(inside, next, side);
    inside = next;
  }
  return std::nullopt;
}

std::vector<TodThreshold> sorted_by_contrast(std::span<const TodThreshold> thresholds) {
  std::vector<TodThreshold> sorted(thresholds.begin(), thresholds.end());
  std::sort(sorted.begin(), sorted.end(),
            [](const TodThreshold& a, const TodThreshold& b) { return a.delta_t_k < b.delta_t_k; });
  return sorted;
}

Result<void> check(std::span<const TodThreshold> thresholds, const RangeTask& task) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  if (!positive(task.size_m)) return fail(ErrorCode::invalid_input, "the target's size must be above 0 m");
  if (!positive(std::abs(task.delta_t_k))) return fail(ErrorCode::invalid_input, "the target has no contrast");
  if (!positive(task.m75)) return fail(ErrorCode::invalid_input, "M75 must be above 0");
  if (!std::isfinite(task.extinction_per_km) || task.extinction_per_km < 0)
    return fail(ErrorCode::invalid_input, "the extinction must be 0 or more per km");
  if (task.air && task.extinction_per_km > 0)
    return fail(ErrorCode::invalid_input,
                "the air model contains the extinction: remove the separate extinction coefficient");
  if (thresholds.empty()) return fail(ErrorCode::invalid_input, "the TOD curve has no threshold");
  for (std::size_t i = 0; i < thresholds.size(); ++i) {
    const auto& t = thresholds[i];
    if (!positive(t.delta_t_k) || !positive(t.s75_mrad))
      return fail(ErrorCode::invalid_input, "a point of the TOD curve is not positive");
    if (i > 0 && !(t.delta_t_k > thresholds[i - 1].delta_t_k))
      return fail(ErrorCode::invalid_input, fmt::format("the TOD curve has two points at {:g} K", t.delta_t_k));
  }
  return {};
}

std::optional<double> probability(std::optional<double> ln_m) {
  if (!ln_m || !std::isfinite(*ln_m)) return std::nullopt;
  return identification_probability(std::exp(*ln_m));
}

RangePoint point_of(const TargetLine& line, double range_m) {
  RangePoint point;
  point.range_m = range_m;
  point.apparent_delta_t_k = std::exp(line.ln_contrast(range_m));
  point.probability = probability(line.ln_m_over_m75(range_m, Side::estimate));
  point.probability_ci95 = {probability(line.ln_m_over_m75(range_m, Side::low)),
                            probability(line.ln_m_over_m75(range_m, Side::high))};
  return point;
}

std::vector<RangePoint> probabilities(const TargetLine& line, double up_to_m) {
  const double step = round_step(up_to_m / 60);
  std::vector<RangePoint> curve;
  for (int i = 1; i * step <= up_to_m * (1 + 1e-12); ++i) {
    if (std::isinf(line.ln_contrast(i * step))) break;  // end of the air's table
    curve.push_back(point_of(line, i * step));
  }
  return curve;
}

std::string why_not(const TargetLine& line, const RangeTask& task, double lowest_k) {
  if (line.end_m() < 0 || line.ln_contrast(0) < std::log(lowest_k)) {
    return fmt::format("the target's contrast of {:g} K lies below the lowest contrast of the TOD curve, {:g} K",
                       std::abs(task.delta_t_k), lowest_k);
  }
  if (line.end_m() == 0) {
    return fmt::format(
        "the target has the lowest contrast of the TOD curve, {:g} K, and the air reduces it below this contrast at "
        "every distance",
        lowest_k);
  }
  if (line.ends_with_the_table()) {
    return fmt::format(
        "M is still above M75 = {1:g} at {0:g} m, the end of the table of transmittances: the range is at least {0:g} "
        "m",
        line.end_m(), task.m75);
  }
  return fmt::format(
      "the target line does not cross the TOD curve: M is still above M75 = {2:g} at {1:.4g} m, beyond which the "
      "apparent contrast lies below the lowest contrast of the curve, {0:g} K; the range is at least {1:.4g} m",
      lowest_k, line.end_m(), task.m75);
}

/// Findings of the points that determine the curve's value anywhere between two contrasts: the neighbours of values
/// between two points, the highest above it.
std::optional<Adequacy> findings_between(std::span<const TodThreshold> sorted, double low_k, double high_k) {
  std::optional<Adequacy> found;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const bool too_low = i + 1 < sorted.size() && low_k >= sorted[i + 1].delta_t_k;
    const bool too_high = i > 0 && high_k <= sorted[i - 1].delta_t_k;
    const auto& adequacy = sorted[i].adequacy;
    if (!adequacy || too_low || too_high) continue;
    if (!found) found.emplace();
    for (AdequacyFinding finding : adequacy->findings) {
      finding.sentence = fmt::format("at {:g} K: {}", sorted[i].delta_t_k, finding.sentence);
      found->findings.push_back(std::move(finding));
    }
  }
  return found;
}

/// From the apparent contrast at the far end of the interval to that at its near end; an open end extends as far as the
/// target and the curve do.
std::optional<Adequacy> findings_of(const RangePrediction& prediction, const TargetLine& line,
                                    std::span<const TodThreshold> sorted) {
  const auto& [low, high] = prediction.r75_ci95_m;
  const double near_k = std::exp(line.ln_contrast(low.value_or(0)));
  const double far_k = high ? std::exp(line.ln_contrast(*high)) : 0;
  return findings_between(sorted, far_k, near_k);
}

/// Adds R75 at both ends of the open parameters, or the reason why it is missing.
void add_spread(std::span<const TodThreshold> sorted, const RangeTask& task, RangePrediction& prediction) {
  const auto has_spread = [](const TodThreshold& threshold) { return threshold.s75_spread_mrad.has_value(); };
  if (!prediction.r75_m || std::ranges::none_of(sorted, has_spread)) return;
  const std::string head = "no spread of the range over the open parameters of the observer: ";
  if (const auto without = std::ranges::find_if_not(sorted, has_spread); without != sorted.end()) {
    prediction.notes.push_back(head + fmt::format("the threshold at {:g} K has no spread", without->delta_t_k));
    return;
  }
  const auto r75_at = [&](double std::pair<double, double>::*end) {
    std::vector<TodThreshold> thresholds(sorted.begin(), sorted.end());
    for (TodThreshold& threshold : thresholds) threshold.s75_mrad = (*threshold.s75_spread_mrad).*end;
    const std::vector<Node> nodes = nodes_of(thresholds);
    return TargetLine(nodes, task).crossing(Side::estimate);
  };
  prediction.r75_spread_m = spread_of(
      {r75_at(&std::pair<double, double>::first), prediction.r75_m, r75_at(&std::pair<double, double>::second)});
  if (!prediction.r75_spread_m)
    prediction.notes.push_back(head + "at one end the target line does not meet the TOD curve");
}

}  // namespace

double round_step(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * power <= value * (1 + 1e-12)) return factor * power;
  }
  return power;
}

double m75_from_v50(double v50) {
  return 0.6 * v50;
}

double identification_probability(double m_over_m75) {
  const double x = v75_over_v50 * m_over_m75;
  const double exponent = 1.51 + 0.24 * x;
  // 1 / (1 + x^-E): exact at both ends.
  return 1 / (1 + std::exp(-exponent * std::log(x)));
}

ThresholdSelection thresholds_of(const TodCurve& curve, double target_delta_t_k) {
  ThresholdSelection selection;
  const auto same_sign = [&](const TodPoint& p) { return std::signbit(p.delta_t_k) == std::signbit(target_delta_t_k); };
  const bool any = std::any_of(curve.points.begin(), curve.points.end(), same_sign);
  if (!any && !curve.points.empty())
    selection.notes.emplace_back(
        "the TOD curve was measured at the opposite polarity: the acuity is assumed to be the same for both");
  for (const auto& point : curve.points) {
    if (any && !same_sign(point)) continue;
    if (!stated_threshold(point.fit) || point.fit.verdict == FitVerdict::flat_or_decreasing ||
        point.fit.verdict == FitVerdict::underdetermined) {
      selection.notes.push_back(fmt::format("the point at {:g} K was left out: it has no threshold", point.delta_t_k));
      continue;
    }
    selection.thresholds.push_back({std::abs(point.delta_t_k), *point.fit.threshold, point.fit.ci95,
                                    std::abs(point.set_delta_t_k), point.adequacy, point.s75_spread_mrad});
  }
  return selection;
}

double contrast_on_curve(std::span<const TodThreshold> thresholds, double delta_t_k) {
  const double asked = std::abs(delta_t_k);
  const auto nearest = [&](auto contrast_of) -> const TodThreshold* {
    const TodThreshold* found = nullptr;
    for (const TodThreshold& threshold : thresholds) {
      if (!(threshold.set_delta_t_k > 0) || !same_contrast(contrast_of(threshold), asked)) continue;
      if (found == nullptr || std::abs(contrast_of(threshold) - asked) < std::abs(contrast_of(*found) - asked))
        found = &threshold;
    }
    return found;
  };
  const TodThreshold* point = nearest([](const TodThreshold& t) { return t.set_delta_t_k; });
  if (point == nullptr) point = nearest([](const TodThreshold& t) { return t.delta_t_k; });
  return point != nullptr ? point->delta_t_k : asked;
}

std::optional<double> interpolated_acuity_per_mrad(std::span<const TodThreshold> sorted, double delta_t_k) {
  const auto found = at(nodes_of(sorted), std::log(delta_t_k));
  if (!found) return std::nullopt;
  return std::exp(found->value);
}

Result<RangePoint> range_point(std::span<const TodThreshold> thresholds, const RangeTask& asked, double range_m) {
  RangeTask task = asked;
  task.delta_t_k = contrast_on_curve(thresholds, asked.delta_t_k);
  const std::vector<TodThreshold> sorted = sorted_by_contrast(thresholds);
  TODBENCH_TRY_VOID(check(sorted, task));
  if (!(std::isfinite(range_m) && range_m > 0)) return fail(ErrorCode::invalid_input, "a range must be above 0 m");
  const std::vector<Node> nodes = nodes_of(sorted);
  return point_of(TargetLine(nodes, task), range_m);
}

Result<RangePrediction> predict_range(std::span<const TodThreshold> thresholds, const RangeTask& asked) {
  RangeTask task = asked;
  task.delta_t_k = contrast_on_curve(thresholds, asked.delta_t_k);
  const std::vector<TodThreshold> sorted = sorted_by_contrast(thresholds);
  TODBENCH_TRY_VOID(check(sorted, task));
  const std::vector<Node> nodes = nodes_of(sorted);
  const TargetLine line(nodes, task);
  RangePrediction prediction;
  if (!same_contrast(task.delta_t_k, std::abs(asked.delta_t_k))) {
    prediction.notes.push_back(
        fmt::format("the target has the set contrast of a point of the TOD curve, {:g} K: the effective contrast of "
                    "that point, {:g} K, is used",
                    std::abs(asked.delta_t_k), task.delta_t_k));
  }
  prediction.r75_m = line.crossing(Side::estimate);
  if (prediction.r75_m) {
    prediction.r75_ci95_m = {line.crossing(Side::low), line.crossing(Side::high)};
  } else {
    prediction.reason = why_not(line, task, sorted.front().delta_t_k);
    // The curve bounds the range from below: by its lower side if that is met, else by its end.
    if (line.end_m() > 0 && std::isfinite(line.end_m())) {
      const auto low = line.crossing(Side::low);
      prediction.r75_ci95_m.low = low ? low : std::optional(line.end_m());
      if (std::isinf(nodes.front().acuity.below)) prediction.r75_ci95_m.low.reset();
    }
  }
  if (std::abs(task.delta_t_k) > sorted.back().delta_t_k) {
    prediction.notes.push_back(
        fmt::format("the target's contrast lies above the highest contrast of the TOD curve, {:g} K: the acuity is "
                    "assumed to be constant there",
                    sorted.back().delta_t_k));
  }
  add_spread(sorted, task, prediction);
  prediction.adequacy = findings_of(prediction, line, sorted);
  double farthest = 0;
  for (const auto& node : nodes) farthest = std::max(farthest, line.range_of(node.acuity.value));
  prediction.curve = probabilities(line, 2 * prediction.r75_m.value_or(farthest));
  return prediction;
}

}  // namespace todbench
