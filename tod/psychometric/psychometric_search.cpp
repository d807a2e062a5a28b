// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/psychometric/psychometric_search.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "acquisition/base/multiversion.h"

namespace todbench {
namespace {

constexpr double first_u = -30;  // below it z < 2e-13
constexpr double last_u = 5.5;   // above it z > 60: exp(-z) is below rounding
constexpr double step_u = 1.0 / 16;

// Quintic through values, first and second derivatives at both ends of a cell.
std::array<double, 6> hermite(const LogTerm& a, const LogTerm& b) {
  const double d0 = a.w * step_u, d1 = b.w * step_u, c0 = a.ww * step_u * step_u / 2, c1 = b.ww * step_u * step_u / 2;
  const double rise = b.value - a.value;
  return {a.value,
          d0,
          c0,
          10 * rise - 6 * d0 - 4 * d1 - 3 * c0 + c1,
          -15 * rise + 8 * d0 + 7 * d1 + 3 * c0 - 2 * c1,
          6 * rise - 3 * (d0 + d1) - c0 + c1};
}

double quintic(const double* c, double s) {
  return c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * (c[4] + s * c[5]))));
}

constexpr std::size_t powers = 6;

// Adds to each sum the quintic of the cell that contains factor (ln_size - t) + shift.
TODBENCH_MULTIVERSION
void add_quintics(const double* c, double factor, double ln_size, double shift, const double* ts, std::size_t count,
                  double* __restrict sums) {
  for (std::size_t i = 0; i < count; ++i) {
    const double position = factor * (ln_size - ts[i]) + shift;
    const auto cell = static_cast<std::int32_t>(position);
    sums[i] += quintic(c + static_cast<std::int32_t>(powers) * cell, position - cell);
  }
}

// right * a + wrong * b, element by element.
TODBENCH_MULTIVERSION
void mix(double right, const double* a, double wrong, const double* b, std::size_t count, double* __restrict out) {
  for (std::size_t i = 0; i < count; ++i) out[i] = right * a[i] + wrong * b[i];
}

// Thresholds to try at one slope: around every level at fixed heights of the function, in the middle of every gap.
std::vector<double> thresholds(const PooledCounts& counts, double slope) {
  constexpr std::array offsets{-6.0, -2.5, -1.2, -0.4, 0.0, 0.4, 1.2, 2.5, 6.0};
  constexpr double spacing = 0.25;  // of u: a quarter of the width of the function
  std::vector<double> t;
  for (std::size_t i = 0; i < counts.levels.size(); ++i) {
    for (const double offset : offsets) t.push_back(counts.levels[i].ln_size + offset / slope);
    if (i > 0) t.push_back((counts.levels[i - 1].ln_size + counts.levels[i].ln_size) / 2);
  }
  std::sort(t.begin(), t.end());
  std::vector<double> thinned;
  for (const double x : t)
    if (thinned.empty() || x - thinned.back() >= spacing / slope) thinned.push_back(x);
  return thinned;
}

// Outside the ends the levels see only a tail of the function, and a flat ridge may peak anywhere along it.
std::vector<double> outer_thresholds(const PooledCounts& counts, double slope) {
  std::vector<double> t;
  for (const double offset : {1.8, 3.2, 4.0, 5.0, 7.0, 8.0}) {
    t.push_back(counts.first() - offset / slope);
    t.push_back(counts.last() + offset / slope);
  }
  return t;
}

// Indices of local maxima; the first one of a plateau.
std::vector<std::size_t> local_maxima(const std::vector<ScanNode>& nodes) {
  std::vector<std::size_t> peaks;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const bool left = i == 0 || nodes[i].value > nodes[i - 1].value;
    const bool right = i + 1 == nodes.size() || nodes[i].value >= nodes[i + 1].value;
    if (left && right) peaks.push_back(i);
  }
  return peaks;
}

// The one of `nodes` (increasing in t) nearest to a threshold.
const ScanNode& nearest(const std::vector<ScanNode>& nodes, double t) {
  const auto after = std::lower_bound(nodes.begin(), nodes.end(), t,
                                      [](const ScanNode& node, double x) { return node.place[place_t] < x; });
  if (after == nodes.begin()) return *after;
  const auto before = std::prev(after);
  if (after == nodes.end()) return *before;
  return t - before->place[place_t] <= after->place[place_t] - t ? *before : *after;
}

}  // namespace

LinkTable::LinkTable(const Link& link)
    : link_(link), low_(log_probabilities(link, first_u)), high_(log_probabilities(link, last_u)) {
  cells_ = static_cast<std::size_t>((last_u - first_u) / step_u);
  right_.reserve(powers * cells_);
  wrong_.reserve(powers * cells_);
  AnswerTerms here = answer_terms(link, first_u);
  for (std::size_t i = 0; i < cells_; ++i) {
    // ln z = ln kappa + u: derivatives in w are derivatives in u.
    const AnswerTerms next = answer_terms(link, first_u + static_cast<double>(i + 1) * step_u);
    const auto right = hermite(here.right, next.right), wrong = hermite(here.wrong, next.wrong);
    right_.insert(right_.end(), right.begin(), right.end());
    wrong_.insert(wrong_.end(), wrong.begin(), wrong.end());
    here = next;
  }
}

double LinkTable::log_likelihood(const PooledCounts& counts, double t, double slope) const {
  double sum = 0;
  const double factor = link_.sign * slope / step_u, shift = -first_u / step_u;
  const auto end = static_cast<double>(cells_);
  for (const PooledLevel& level : counts.levels) {
    const double position = factor * (level.ln_size - t) + shift;
    if (position >= 0 && position < end) {
      const auto index = static_cast<std::size_t>(position);
      const double s = position - static_cast<double>(index);
      const std::size_t at = powers * index;
      sum += level.right * quintic(&right_[at], s) + level.wrong * quintic(&wrong_[at], s);
    } else {
      sum += outside(level, (position - shift) * step_u);
    }
  }
  return sum;
}

CountsTable::CountsTable(const LinkTable& table, const PooledCounts& counts) : table_(table), counts_(counts) {
  const std::size_t count = powers * table.cells_;
  coefficients_ = std::make_unique_for_overwrite<double[]>(counts.levels.size() * count);
  double* out = coefficients_.get();
  for (const PooledLevel& level : counts.levels) {
    mix(level.right, table.right_.data(), level.wrong, table.wrong_.data(), count, out);
    out += count;
  }
}

std::vector<double> CountsTable::log_likelihoods(std::span<const double> ts, double slope) const {
  std::vector<double> sums(ts.size());
  const double factor = table_.link_.sign * slope / step_u, shift = -first_u / step_u;
  const double* coefficients = coefficients_.get();
  const auto end = static_cast<double>(table_.cells_);
  for (const PooledLevel& level : counts_.levels) {
    const auto position = [&](std::size_t i) { return factor * (level.ln_size - ts[i]) + shift; };
    const auto inside = [&](std::size_t i) { return position(i) >= 0 && position(i) < end; };
    const auto outside = [&](std::size_t i) { return table_.outside(level, (position(i) - shift) * step_u); };
    // Positions are monotonic in t: those inside the table are contiguous.
    std::size_t first = 0, last = ts.size();
    for (; first < last && !inside(first); ++first) sums[first] += outside(first);
    for (; last > first && !inside(last - 1); --last) sums[last - 1] += outside(last - 1);
    add_quintics(coefficients, factor, level.ln_size, shift, ts.data() + first, last - first, sums.data() + first);
    coefficients += powers * table_.cells_;
  }
  return sums;
}

// Constants on both sides, except for errors at lapse 0 near psi = 1, whose logarithm has no lower limit.
double LinkTable::outside(const PooledLevel& level, double u) const {
  const LogProbabilities& p = u < 0 ? low_ : high_;
  const bool near_one = (u > 0) == (link_.sign > 0);
  double sum = level.right * p.right;
  if (level.wrong > 0)
    sum += level.wrong * (link_.lapse == 0 && near_one ? log_probabilities(link_, u).wrong : p.wrong);
  return sum;
}

ParameterBox<3> search_box(std::optional<double> lapse) {
  constexpr double far = 2000;  // in ln threshold: beyond every number of type double
  return {{-far, std::log(min_slope), lapse.value_or(0.0)}, {far, std::log(max_slope), lapse.value_or(max_free_lapse)}};
}

ScanGrid scan_grid(PsychometricForm form, std::optional<double> lapse) {
  constexpr int slopes = 32;  // ratio 1.22
  ScanGrid grid;
  const double first = std::log(min_slope), last = std::log(max_slope);
  for (int i = 0; i < slopes; ++i) grid.q.push_back(i + 1 == slopes ? last : first + (last - first) * i / (slopes - 1));
  if (lapse) {
    grid.tables.emplace_back(make_link(form, *lapse));
  } else {
    for (const double l : {0.0, 1e-3, 0.01, 0.03, max_free_lapse}) grid.tables.emplace_back(make_link(form, l));
  }
  return grid;
}

LikelihoodScan scan_likelihood(const PooledCounts& counts, const ScanGrid& grid) {
  std::vector<std::vector<ScanNode>> rows;  // one for each slope, increasing in t
  LikelihoodScan scan;
  for (const double q : grid.q) {
    const double slope = std::exp(q);
    const auto node_at = [&](double t) {
      ScanNode node{{t, q, 0}, -std::numeric_limits<double>::infinity()};
      for (const LinkTable& table : grid.tables) {
        const double value = table.log_likelihood(counts, t, slope);
        if (value > node.value) node = {{t, q, table.link().lapse}, value};
      }
      return node;
    };
    std::vector<ScanNode> row;
    for (const double t : thresholds(counts, slope)) row.push_back(node_at(t));
    const auto by_value = [](const ScanNode& a, const ScanNode& b) { return a.value < b.value; };
    const ScanNode best = *std::max_element(row.begin(), row.end(), by_value);
    for (const double t : outer_thresholds(counts, slope)) row.push_back(node_at(t));
    std::sort(row.begin(), row.end(),
              [](const ScanNode& a, const ScanNode& b) { return a.place[place_t] < b.place[place_t]; });
    scan.nodes.push_back(best);
    rows.push_back(std::move(row));
  }
  // A maximum along t that neither neighbouring slope exceeds at its threshold. Each row has its own thresholds, so the
  // nearest one of a neighbour is used.
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const std::size_t k : local_maxima(rows[i])) {
      const ScanNode& node = rows[i][k];
      const bool below = i == 0 || nearest(rows[i - 1], node.place[place_t]).value <= node.value;
      const bool above = i + 1 == rows.size() || nearest(rows[i + 1], node.place[place_t]).value <= node.value;
      if (below && above) scan.peaks.push_back(node);
    }
  }
  return scan;
}

Maximum<3> global_maximum(const PooledCounts& counts, PsychometricForm form, const LikelihoodScan& scan,
                          std::optional<double> lapse) {
  const ParameterBox<3> box = search_box(lapse);
  const auto likelihood = [&](const PsychometricPlace& place) { return expand_likelihood(counts, form, place); };
  std::optional<Maximum<3>> best;
  const auto consider = [&best](const Maximum<3>& m) {
    if (!best || m.expansion.value > best->expansion.value) best = m;
  };
  for (const std::size_t i : local_maxima(scan.nodes)) consider(climb<3>(likelihood, scan.nodes[i].place, box));
  // On a ridge that rises ever more slowly towards a slope limit Newton steps end before it: the limits are climbed
  // separately.
  for (const bool upper : {false, true}) {
    ParameterBox<3> edge = box;
    edge.lower[place_q] = edge.upper[place_q] = upper ? box.upper[place_q] : box.lower[place_q];
    const ScanNode& start = upper ? scan.nodes.back() : scan.nodes.front();
    consider(climb<3>(likelihood, climb<3>(likelihood, start.place, edge).place, box));
  }
  // Other peaks, of the same slopes at other thresholds. `hope`: largest rise of a peak above its scanned value. Steps
  // between scanned slopes (a factor of 1.22) and thresholds (a quarter of the width) change the likelihood of
  // near-chance data by less than 1; in sharp peaks of many trials the highest scanned ones are nearest. A difference
  // below rounding is the same peak.
  constexpr double hope = 3;
  constexpr std::size_t most_climbs = 12;
  const double rounding = 1e-9 + 4e-16 * std::abs(best->expansion.value);
  std::vector<ScanNode> starts = scan.peaks;
  std::sort(starts.begin(), starts.end(), [](const ScanNode& a, const ScanNode& b) { return a.value > b.value; });
  for (std::size_t i = 0; i < std::min(starts.size(), most_climbs); ++i) {
    if (starts[i].value < starts.front().value - hope) break;
    const Maximum<3> hill = climb<3>(likelihood, starts[i].place, box);
    if (hill.expansion.value > best->expansion.value + rounding) best = hill;
  }
  return *best;
}

Maximum<3> profile_maximum(const PooledCounts& counts, PsychometricForm form, const ScanGrid& grid,
                           std::optional<double> lapse, double t) {
  ParameterBox<3> box = search_box(lapse);
  box.lower[place_t] = box.upper[place_t] = t;
  const auto likelihood = [&](const PsychometricPlace& place) { return expand_likelihood(counts, form, place); };
  std::vector<ScanNode> nodes;
  for (const double q : grid.q) {
    const double slope = std::exp(q);
    ScanNode node{{t, q, 0}, -std::numeric_limits<double>::infinity()};
    for (const LinkTable& table : grid.tables) {
      const double value = table.log_likelihood(counts, t, slope);
      if (value > node.value) node = {{t, q, table.link().lapse}, value};
    }
    nodes.push_back(node);
  }
  std::optional<Maximum<3>> best;
  for (const std::size_t i : local_maxima(nodes)) {
    const Maximum<3> m = climb<3>(likelihood, nodes[i].place, box);
    if (!best || m.expansion.value > best->expansion.value) best = m;
  }
  return *best;
}

}  // namespace todbench
