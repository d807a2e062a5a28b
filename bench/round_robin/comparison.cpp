// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/round_robin/comparison.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "acquisition/base/distributions.h"

namespace todbench {
namespace {

/// Share of outlying_significance for laboratories over all their items. A bias of a laboratory is less conspicuous
/// than a mistake in one result.
constexpr double laboratory_share = 0.8;

/// By item: whether each result is kept for the reference value.
using Kept = std::vector<std::vector<bool>>;

std::vector<LaboratoryValue> kept_results(const ComparedItem& item, const std::vector<bool>& kept) {
  std::vector<LaboratoryValue> out;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (kept[i]) out.push_back(item.results[i]);
  }
  return out;
}

/// Deviation of one kept result from the weighted mean of the other kept ones, in standard uncertainties. It equals
/// the deviation from the mean of all over sqrt(u^2 - u_ref^2).
double zeta_of(const ComparedItem& item, std::vector<bool> kept, std::size_t which) {
  kept[which] = false;
  const Consensus others = weighted_mean(kept_results(item, kept));
  const LaboratoryValue& own = item.results[which];
  return (own.value - others.value) / std::hypot(own.u, others.u);
}

double two_sided(double z) {
  return std::min(1.0, 2 * distribution::tail_above(std::abs(z), std::nullopt));
}

/// Probability that the smallest of n independent p is so small (Sidak 1967); stable for small p.
double of_any(double p, std::size_t n) {
  return -std::expm1(static_cast<double>(n) * std::log1p(-std::min(p, 1 - 1e-16)));
}

struct LaboratoryZeta {
  double sum = 0;
  int items = 0;
  [[nodiscard]] double combined() const { return sum / std::sqrt(static_cast<double>(items)); }
};

/// Deviations of the kept results.
struct Deviations {
  std::map<std::string, LaboratoryZeta> laboratories;
  std::vector<std::vector<double>> zeta;  ///< by item and result; 0 where not kept
  std::size_t results = 0;
};

Deviations deviations(const std::vector<ComparedItem>& items, const Kept& kept) {
  Deviations out;
  for (std::size_t j = 0; j < items.size(); ++j) {
    out.zeta.emplace_back(items[j].results.size(), 0.0);
    for (std::size_t i = 0; i < items[j].results.size(); ++i) {
      if (!kept[j][i]) continue;
      const double zeta = out.zeta[j][i] = zeta_of(items[j], kept[j], i);
      LaboratoryZeta& laboratory = out.laboratories[items[j].results[i].laboratory];
      laboratory.sum += zeta;
      ++laboratory.items;
      ++out.results;
    }
  }
  return out;
}

/// Whether more than half of the laboratories of every item remain without this laboratory, or without its result of
/// the item `only`.
bool may_be_set_aside(const std::vector<ComparedItem>& items, const Kept& kept, const std::string& laboratory,
                      std::optional<std::size_t> only) {
  for (std::size_t j = 0; j < items.size(); ++j) {
    if (only && *only != j) continue;
    std::size_t rest = 0;
    for (std::size_t i = 0; i < kept[j].size(); ++i)
      rest += kept[j][i] && items[j].results[i].laboratory != laboratory ? 1 : 0;
    if (rest < 2 || 2 * rest <= items[j].results.size()) return false;
  }
  return true;
}

/// The most improbable laboratory or result, if its probability is below its share of the significance.
std::optional<std::pair<OutlyingResult, std::optional<std::size_t>>> most_improbable(
    const std::vector<ComparedItem>& items, const Kept& kept) {
  const Deviations found = deviations(items, kept);
  // With one item a laboratory is its result.
  const double laboratories = items.size() == 1 ? 0 : laboratory_share, results = 1 - laboratories;
  std::optional<std::pair<OutlyingResult, std::optional<std::size_t>>> worst;
  const auto offer = [&](OutlyingResult candidate, std::optional<std::size_t> only) {
    if (candidate.p >= outlying_significance || (worst && candidate.p >= worst->first.p)) return;
    worst = {std::move(candidate), only};
  };
  for (const auto& [name, laboratory] : found.laboratories) {
    if (items.size() == 1 || laboratory.items < 2) continue;
    const double zeta = laboratory.combined();
    offer({name, "", "", zeta, of_any(two_sided(zeta), found.laboratories.size()) / laboratories}, std::nullopt);
  }
  for (std::size_t j = 0; j < items.size(); ++j) {
    for (std::size_t i = 0; i < items[j].results.size(); ++i) {
      if (!kept[j][i]) continue;
      const double zeta = found.zeta[j][i];
      offer({items[j].results[i].laboratory, items[j].item, items[j].quantity, zeta,
             of_any(two_sided(zeta), found.results) / results},
            j);
    }
  }
  return worst;
}

/// Whether results of several laboratories were set aside.
bool several(const std::vector<OutlyingResult>& outlying) {
  return std::ranges::any_of(outlying, [&](const auto& one) { return one.laboratory != outlying.front().laboratory; });
}

ReferenceValue reference_of(const std::vector<LaboratoryValue>& kept, const ItemComparison& item, bool selection,
                            const MedianConsensus& median) {
  if (!selection && item.kept.consistent())
    return {ReferenceMethod::weighted_mean, item.weighted, 2, 2 * item.weighted.u};
  if (!selection && 4 * largest_consistent_subset(kept).size() >= 3 * kept.size())
    return {ReferenceMethod::median, median.median, 2, (*median.ci95.high - *median.ci95.low) / 2};
  const double t = distribution::quantile(distribution::StudentsT(static_cast<double>(kept.size() - 1)), 0.975);
  const double u = item.paule_mandel.hartung_knapp;
  return {ReferenceMethod::paule_mandel, {item.paule_mandel.mean.value, u}, t, t * u};
}

/// Difference of a result from the reference value, without saying whether it is outlying, with its expanded
/// uncertainty, k = 2. A kept result is correlated with a mean that contains it: u^2(d) = u^2 - u_ref^2 (Cox 2002,
/// equation 5). From the mean of the other results this is u^2 / sqrt(u^2 + u_others^2), which does not cancel if one
/// laboratory has nearly all the weight.
DegreeOfEquivalence degree_of(const ItemComparison& item, const std::vector<bool>& kept, std::size_t which,
                              double half95) {
  const LaboratoryValue& own = item.item.results[which];
  DegreeOfEquivalence out{.result = own, .in_reference = kept[which]};
  out.difference = own.value - item.reference.value.value;
  std::vector<bool> others = kept;
  others[which] = false;
  if (!kept[which]) {
    out.expanded_u = 2 * std::hypot(own.u, item.reference.value.u);
  } else if (item.reference.method == ReferenceMethod::median) {
    out.expanded_u = half95;
  } else {
    const double between = item.reference.method == ReferenceMethod::weighted_mean ? 0 : item.paule_mandel_sd;
    const Consensus rest = random_effects(kept_results(item.item, others), between * between).mean;
    const double u = std::hypot(own.u, between), sum = std::hypot(u, rest.u);
    out.expanded_u = 2 * u * (u / sum);
    out.difference = (own.value - rest.value) * (u / sum) * (u / sum);
  }
  // A result that is the median in nearly every draw differs from it by nothing.
  out.e_n = out.expanded_u > 0 ? out.difference / out.expanded_u : 0;
  out.zeta = 2 * out.e_n;
  return out;
}

ItemComparison compared(ComparedItem&& from, const std::vector<bool>& kept, bool selection, std::uint64_t seed) {
  ItemComparison out;
  out.item = std::move(from);
  const std::vector<bool> used = selection ? std::vector<bool>(kept.size(), true) : kept;
  const auto values = kept_results(out.item, used);
  out.all = consistency(out.item.results);
  out.kept = consistency(kept_results(out.item, kept));
  out.weighted = weighted_mean(values);
  MedianConsensus median = monte_carlo_median(values, seed, MedianDetail::median);
  out.median = median.median;
  const double dersimonian_laird = dersimonian_laird_variance(values), paule_mandel = paule_mandel_variance(values);
  out.dersimonian_laird = random_effects(values, dersimonian_laird);
  out.paule_mandel = random_effects(values, paule_mandel);
  out.dersimonian_laird_sd = std::sqrt(dersimonian_laird);
  out.paule_mandel_sd = std::sqrt(paule_mandel);
  std::vector<LaboratoryValue> subset;
  for (const std::size_t i : largest_consistent_subset(out.item.results)) subset.push_back(out.item.results[i]);
  for (const auto& member : subset) out.consistent_laboratories.push_back(member.laboratory);
  out.consistent_subset = weighted_mean(subset);
  out.reference = reference_of(values, out, selection, median);
  if (out.reference.method == ReferenceMethod::median)
    median = monte_carlo_median(values, seed, MedianDetail::differences);
  std::size_t next = 0;
  for (std::size_t i = 0; i < out.item.results.size(); ++i) {
    const bool from_draws = used[i] && !median.difference_half95.empty();
    out.degrees.push_back(degree_of(out, used, i, from_draws ? median.difference_half95[next] : 0));
    out.degrees.back().outlying = !kept[i];
    next += used[i] ? 1 : 0;
  }
  return out;
}

/// Deviations of every laboratory from the kept results of the others.
std::vector<LaboratorySummary> summaries(const std::vector<ComparedItem>& items, const Kept& kept,
                                         const std::vector<OutlyingResult>& outlying) {
  std::map<std::string, LaboratoryZeta> found;
  for (std::size_t j = 0; j < items.size(); ++j) {
    for (std::size_t i = 0; i < items[j].results.size(); ++i) {
      LaboratoryZeta& laboratory = found[items[j].results[i].laboratory];
      laboratory.sum += zeta_of(items[j], kept[j], i);
      ++laboratory.items;
    }
  }
  std::vector<LaboratorySummary> out;
  for (const auto& entry : found) {
    const LaboratoryZeta& laboratory = entry.second;
    const double zeta = laboratory.combined();
    const bool named = std::ranges::any_of(outlying, [&](const auto& o) { return o.laboratory == entry.first; });
    out.push_back({entry.first, laboratory.items, zeta, two_sided(zeta), named});
  }
  return out;
}

}  // namespace

std::string_view to_string(ReferenceMethod method) {
  switch (method) {
    case ReferenceMethod::weighted_mean:
      return "weighted_mean";
    case ReferenceMethod::median:
      return "median";
    case ReferenceMethod::paule_mandel:
      return "paule_mandel";
  }
  return "";
}

bool RoundRobin::consistent() const {
  return outlying.empty() && std::ranges::all_of(items, [](const auto& item) { return item.kept.consistent(); });
}

Result<RoundRobin> evaluated(std::vector<ComparedItem> items, std::uint64_t seed) {
  if (items.empty()) return fail(ErrorCode::invalid_input, "a comparison needs at least one item");
  Kept kept;
  for (const ComparedItem& item : items) {
    if (item.results.size() < 2) {
      return fail(ErrorCode::invalid_input, "item '" + item.item + "', quantity '" + item.quantity +
                                                "': expected results of at least two laboratories, found " +
                                                std::to_string(item.results.size()));
    }
    kept.emplace_back(item.results.size(), true);
  }
  RoundRobin out;
  const Kept all = kept;
  while (auto worst = most_improbable(items, kept)) {
    if (!may_be_set_aside(items, kept, worst->first.laboratory, worst->second)) {
      // No majority agrees: the results scatter, and none can be called the wrong one.
      kept = all;
      out.outlying.clear();
      break;
    }
    for (std::size_t j = 0; j < items.size(); ++j) {
      for (std::size_t i = 0; i < items[j].results.size(); ++i) {
        if (items[j].results[i].laboratory == worst->first.laboratory && (!worst->second || *worst->second == j))
          kept[j][i] = false;
      }
    }
    out.outlying.push_back(std::move(worst->first));
  }
  out.laboratories = summaries(items, kept, out.outlying);
  out.reference_from_all = several(out.outlying);
  for (std::size_t j = 0; j < items.size(); ++j)
    out.items.push_back(compared(std::move(items[j]), kept[j], out.reference_from_all, seed + j));
  return out;
}

}  // namespace todbench
