// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/adequacy/orientation.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "acquisition/base/distributions.h"
#include "tod/adequacy/adequacy.h"
#include "tod/psychometric/twin_shape.h"

namespace todbench {
namespace {

constexpr std::size_t least_set_ups = 3;
constexpr double false_alarm = 0.003;

/// Sum of influences and information of one direction.
struct Sum {
  double influence = 0, information = 0;
};
using ByDirection = std::array<Sum, all_apexes.size()>;

Sum sum_of(const ByDirection& sums, std::initializer_list<Apex> directions) {
  Sum sum;
  for (const Apex apex : directions) {
    const Sum& one = sums[static_cast<std::size_t>(apex)];
    sum.influence += one.influence, sum.information += one.information;
  }
  return sum;
}

}  // namespace

std::optional<Orientations> orientations(std::span<const Trial> trials, const ProportionTable& table) {
  const std::vector<GradedAnswer> answers = graded_answers(trials);
  const auto estimate = twin_shape_estimate(answers, table, false);
  if (!estimate) return std::nullopt;
  std::map<int, ByDirection> set_ups;
  ByDirection whole;
  double information = 0;
  Orientations out;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const auto direction = static_cast<std::size_t>(trials[i].truth);
    const double share = estimate->direction[i] * estimate->direction[i];
    for (Sum* sum : {&set_ups[answers[i].set_up][direction], &whole[direction]})
      sum->influence += estimate->influence[i], sum->information += share;
    information += share;
    out.directions[direction].trials += 1;
    out.directions[direction].correct += answers[i].probability_correct;
  }
  const auto shift = [&](const Sum& sum) { return sum.influence * information / sum.information; };
  for (std::size_t k = 0; k < whole.size(); ++k) {
    if (!(whole[k].information > 0)) return std::nullopt;
    out.directions[k].percent = 100 * shift(whole[k]);
  }
  double sum = 0, squares = 0;
  for (const auto& [number, sums] : set_ups) {
    const Sum upright = sum_of(sums, {Apex::up, Apex::down}), level = sum_of(sums, {Apex::left, Apex::right});
    if (!(upright.information > 0) || !(level.information > 0)) return std::nullopt;
    const double difference = shift(upright) - shift(level);
    sum += difference, squares += difference * difference;
  }
  if (set_ups.size() < least_set_ups) return std::nullopt;
  const auto count = static_cast<double>(set_ups.size());
  const double mean = sum / count, error = std::sqrt((squares - sum * mean) / (count - 1) / count);
  out.axes_percent = 100 * mean, out.axes_se_percent = 100 * error;
  out.set_ups = static_cast<int>(set_ups.size());
  out.p = error > 0 ? 2 * cdf(distribution::StudentsT(count - 1), -std::abs(mean / error)) : 1;
  return out;
}

std::optional<AdequacyFinding> orientation_finding(const Orientations& found) {
  if (found.p >= false_alarm || std::abs(found.axes_percent) <= 100 * immaterial_shift) return std::nullopt;
  return AdequacyFinding{
      .kind = FindingKind::orientation,
      .value = found.axes_percent,
      .limit = 100 * immaterial_shift,
      .sentence = fmt::format("the threshold of triangles that point up or down is {:.1f} +- {:.1f} % {} than that of "
                              "triangles that point left or right: the camera differs along its axes",
                              std::abs(found.axes_percent), found.axes_se_percent,
                              found.axes_percent > 0 ? "larger" : "smaller"),
      .unfit = false};
}

}  // namespace todbench
