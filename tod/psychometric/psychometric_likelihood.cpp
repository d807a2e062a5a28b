// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/psychometric/psychometric_likelihood.h"

#include <cmath>
#include <limits>
#include <string>

namespace todbench {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Neumaier's sum: a million or more trials lose no digits.
class Sum {
 public:
  void add(double x) {
    const double s = sum_ + x;
    carry_ += std::abs(sum_) >= std::abs(x) ? (sum_ - s) + x : (x - s) + sum_;
    sum_ = s;
  }
  [[nodiscard]] double value() const { return std::isfinite(sum_) ? sum_ + carry_ : sum_; }

 private:
  double sum_ = 0, carry_ = 0;
};

// count * ln(p) with 0 * ln(0) = 0.
double times_log(double count, double p) {
  return count > 0 ? (p > 0 ? count * std::log(p) : -infinity) : 0.0;
}

double binomial(double right, double wrong, double p) {
  return times_log(right, p) + (wrong > 0 ? wrong * std::log1p(-p) : 0.0);
}

double blank_likelihood(const PooledCounts& counts) {
  return binomial(counts.blank_right, counts.blank_wrong, chance_level);
}

double u_of(const Link& link, double slope, double ln_size, double t) {
  return link.sign * slope * (ln_size - t);
}

std::string row_error(std::size_t row, const char* what) {
  return "row " + std::to_string(row + 1) + ": " + what;
}

}  // namespace

double PooledCounts::trials() const {
  Sum sum;
  sum.add(blank_right + blank_wrong);
  for (const PooledLevel& level : levels) sum.add(level.total());
  return sum.value();
}

double PooledCounts::relative(double size) const {
  const double ratio = size / reference_size;
  // The quotient keeps all digits in any unit; a difference of logarithms would lose some.
  return std::isnormal(ratio) ? std::log(ratio) : std::log(size) - std::log(reference_size);
}

std::optional<double> PooledCounts::size_at(double ln_size) const {
  const double size = reference_size * std::exp(ln_size);
  if (!std::isnormal(size)) return std::nullopt;
  return size;
}

Result<void> validate(std::span<const Level> levels, Counts counts) {
  double trials = 0;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const Level& row = levels[i];
    if (!std::isfinite(row.size)) return fail(ErrorCode::invalid_input, row_error(i, "size is not finite"));
    if (row.size < 0) return fail(ErrorCode::invalid_input, row_error(i, "size is negative"));
    if (row.size > 0 && !std::isnormal(row.size))
      return fail(ErrorCode::invalid_input, row_error(i, "size is too small to be stored with full precision"));
    if (!std::isfinite(row.correct) || !std::isfinite(row.total))
      return fail(ErrorCode::invalid_input, row_error(i, "count is not finite"));
    if (row.correct < 0 || row.total < 0) return fail(ErrorCode::invalid_input, row_error(i, "count is negative"));
    if ((counts == Counts::whole && row.correct != std::floor(row.correct)) || row.total != std::floor(row.total))
      return fail(ErrorCode::invalid_input, row_error(i, "count is not a whole number"));
    if (row.correct > row.total)
      return fail(ErrorCode::invalid_input, row_error(i, "more correct answers than trials"));
    trials += row.total;
    if (trials > most_trials)
      return fail(
          ErrorCode::invalid_input,
          row_error(
              i, "more than 1e12 trials in total: the precision of the likelihood does not suffice for an interval"));
  }
  return {};
}

PooledCounts pool(std::span<const Level> levels) {
  constexpr double same = 1e-12;
  std::vector<Level> rows;
  PooledCounts counts;
  for (const Level& row : levels) {
    if (row.total <= 0) continue;
    if (row.size > 0) {
      rows.push_back(row);
    } else {
      counts.blank_right += row.correct;
      counts.blank_wrong += row.total - row.correct;
    }
  }
  std::sort(rows.begin(), rows.end(), [](const Level& a, const Level& b) { return a.size < b.size; });
  std::vector<Level> merged;
  for (const Level& row : rows) {
    if (merged.empty() || row.size - merged.back().size > same * row.size) {
      merged.push_back({row.size, 0, 0, -1});
    }
    merged.back().correct += row.correct;
    merged.back().total += row.total;
  }
  if (!merged.empty()) counts.reference_size = merged[merged.size() / 2].size;
  for (const Level& row : merged)
    counts.levels.push_back({counts.relative(row.size), row.correct, row.total - row.correct});
  return counts;
}

PooledCounts grouped(const PooledCounts& counts, std::size_t most_levels) {
  if (counts.levels.size() <= most_levels) return counts;
  const double span = (counts.last() - counts.first()) / static_cast<double>(most_levels - 1);
  PooledCounts coarse = counts;
  coarse.levels.clear();
  auto at = counts.levels.begin();
  while (at != counts.levels.end()) {
    const double first = at->ln_size;
    PooledLevel together;
    double moment = 0;
    for (; at != counts.levels.end() && at->ln_size < first + span; ++at) {
      together.right += at->right;
      together.wrong += at->wrong;
      moment += at->total() * (at->ln_size - first);
    }
    together.ln_size = first + moment / together.total();
    coarse.levels.push_back(together);
  }
  return coarse;
}

PooledCounts pool(const PooledCounts& a, const PooledCounts& b) {
  constexpr double same = 1e-12;
  PooledCounts both = a;
  both.blank_right += b.blank_right;
  both.blank_wrong += b.blank_wrong;
  const double shift = a.relative(b.reference_size);
  for (PooledLevel level : b.levels) {
    level.ln_size += shift;
    both.levels.push_back(level);
  }
  std::sort(both.levels.begin(), both.levels.end(),
            [](const PooledLevel& x, const PooledLevel& y) { return x.ln_size < y.ln_size; });
  std::vector<PooledLevel> merged;
  for (const PooledLevel& level : both.levels) {
    if (merged.empty() || level.ln_size - merged.back().ln_size > same) {
      merged.push_back(level);
    } else {
      merged.back().right += level.right;
      merged.back().wrong += level.wrong;
    }
  }
  both.levels = std::move(merged);
  return both;
}

double log_likelihood(const PooledCounts& counts, PsychometricForm form, const PsychometricPlace& place) {
  const Link link = make_link(form, place[place_lapse]);
  const double slope = std::exp(place[place_q]);
  Sum sum;
  sum.add(blank_likelihood(counts));
  for (const PooledLevel& level : counts.levels) {
    const LogProbabilities p = log_probabilities(link, u_of(link, slope, level.ln_size, place[place_t]));
    if (level.right > 0) sum.add(level.right * p.right);
    if (level.wrong > 0) sum.add(level.wrong * p.wrong);
  }
  return sum.value();
}

Expansion<3> expand_likelihood(const PooledCounts& counts, PsychometricForm form, const PsychometricPlace& place) {
  const Link link = make_link(form, place[place_lapse]);
  const double slope = std::exp(place[place_q]);
  Expansion<3> e;
  Sum sum;
  sum.add(blank_likelihood(counts));
  for (const PooledLevel& level : counts.levels) {
    const double u = u_of(link, slope, level.ln_size, place[place_t]);
    LogTerm f;
    const auto add = [&f, &sum](double count, const LogTerm& term) {
      sum.add(count * term.value);
      f.w += count * term.w;
      f.ww += count * term.ww;
      f.l += count * term.l;
      f.ll += count * term.ll;
      f.wl += count * term.wl;
    };
    const AnswerTerms terms = answer_terms(link, u);
    if (level.right > 0) add(level.right, terms.right);
    if (level.wrong > 0) add(level.wrong, terms.wrong);
    // w = ln kappa(l) + u with u = +-b (ln x - t): du/dt = -+b, du/dq = u, d2u/dtdq = -+b, d2u/dq2 = u.
    const double w_t = -link.sign * slope;
    const double c = link.d_ln_kappa;
    e.gradient[0] += f.w * w_t;
    e.gradient[1] += f.w * u;
    e.gradient[2] += f.l + f.w * c;
    e.hessian[0][0] += f.ww * w_t * w_t;
    e.hessian[1][0] += f.ww * w_t * u + f.w * w_t;
    e.hessian[1][1] += f.ww * u * u + f.w * u;
    e.hessian[2][0] += w_t * (f.wl + f.ww * c);
    e.hessian[2][1] += u * (f.wl + f.ww * c);
    e.hessian[2][2] += f.ll + 2 * f.wl * c + f.ww * c * c + f.w * link.d2_ln_kappa;
  }
  e.hessian[0][1] = e.hessian[1][0];
  e.hessian[0][2] = e.hessian[2][0];
  e.hessian[1][2] = e.hessian[2][1];
  e.value = sum.value();
  return e;
}

Scores scores_at(PsychometricForm form, const PsychometricPlace& place, double ln_size) {
  const Link link = make_link(form, place[place_lapse]);
  const double slope = std::exp(place[place_q]);
  const double u = u_of(link, slope, ln_size, place[place_t]);
  const auto gradient = [&](const LogTerm& term) {
    return std::array<double, 3>{-link.sign * slope * term.w, u * term.w, term.l + term.w * link.d_ln_kappa};
  };
  const AnswerTerms terms = answer_terms(link, u);
  return {gradient(terms.right), gradient(terms.wrong)};
}

double saturated(const PooledCounts& counts) {
  Sum sum;
  const auto add = [&sum](double right, double wrong) {
    if (right + wrong > 0)
      sum.add(times_log(right, right / (right + wrong)) + times_log(wrong, wrong / (right + wrong)));
  };
  add(counts.blank_right, counts.blank_wrong);
  for (const PooledLevel& level : counts.levels) add(level.right, level.wrong);
  return sum.value();
}

double deviance(const PooledCounts& counts, PsychometricForm form, const PsychometricPlace& place) {
  const Link link = make_link(form, place[place_lapse]);
  const double slope = std::exp(place[place_q]);
  Sum sum;
  const auto add = [&sum](double right, double wrong, const LogProbabilities& p) {
    const double n = right + wrong;
    if (right > 0) sum.add(right * (std::log(right / n) - p.right));
    if (wrong > 0) sum.add(wrong * (std::log(wrong / n) - p.wrong));
  };
  add(counts.blank_right, counts.blank_wrong, {std::log(chance_level), std::log1p(-chance_level)});
  for (const PooledLevel& level : counts.levels)
    add(level.right, level.wrong, log_probabilities(link, u_of(link, slope, level.ln_size, place[place_t])));
  return std::max(0.0, 2 * sum.value());
}

namespace {

// Best step at one lapse: levels below the step at chance, above at 1 - lapse, the level at the step at any value
// between.
double step_limit(const PooledCounts& counts, double lapse) {
  const std::size_t m = counts.levels.size();
  std::vector<double> above(m + 1, 0.0);  // of levels j..m-1
  for (std::size_t j = m; j-- > 0;)
    above[j] = above[j + 1] + times_log(counts.levels[j].right, 1 - lapse) + times_log(counts.levels[j].wrong, lapse);
  double below = blank_likelihood(counts), best = -infinity;
  for (std::size_t j = 0; j < m; ++j) {
    const PooledLevel& level = counts.levels[j];
    const double p = std::clamp(level.right / level.total(), chance_level, 1 - lapse);
    const double here = p < 1 ? binomial(level.right, level.wrong, p) : times_log(level.wrong, 0);
    best = std::max(best, below + here + above[j + 1]);
    below += binomial(level.right, level.wrong, chance_level);
  }
  return best;
}

// For a free lapse the levels above the step share it: their pooled share of errors, inside [0, 0.1]. A level at the
// step that fits better above it is covered by another step position.
double step_limit_free(const PooledCounts& counts) {
  double best = -infinity, wrong = 0, total = 0;
  const auto try_lapse = [&] {
    best = std::max(best, step_limit(counts, total > 0 ? std::min(wrong / total, max_free_lapse) : 0.0));
  };
  try_lapse();
  for (std::size_t j = counts.levels.size(); j-- > 0;) {
    wrong += counts.levels[j].wrong;
    total += counts.levels[j].total();
    try_lapse();
  }
  return best;
}

// ln likelihood of the levels from j on, all above the step, and their best lapse.
double above_step(const PooledCounts& counts, std::size_t j, std::optional<double> lapse) {
  double right = 0, wrong = 0;
  for (std::size_t i = j; i < counts.levels.size(); ++i) {
    right += counts.levels[i].right;
    wrong += counts.levels[i].wrong;
  }
  const double l = lapse.value_or(right + wrong > 0 ? std::min(wrong / (right + wrong), max_free_lapse) : 0.0);
  return times_log(right, 1 - l) + times_log(wrong, l);
}

}  // namespace

StepExtent step_extent(const PooledCounts& counts, std::optional<double> lapse, double least) {
  const std::vector<PooledLevel>& levels = counts.levels;
  StepExtent extent;
  bool open_low = false, open_high = false;
  double below = blank_likelihood(counts);
  for (std::size_t j = 0; j <= levels.size(); ++j) {
    // The step between level j - 1 and level j.
    if (below + above_step(counts, j, lapse) >= least) {
      extent.any = true;
      open_low = open_low || j == 0;
      open_high = open_high || j == levels.size();
      if (j > 0 && !extent.low) extent.low = levels[j - 1].ln_size;
      if (j < levels.size()) extent.high = levels[j].ln_size;
    }
    if (j < levels.size()) below += binomial(levels[j].right, levels[j].wrong, chance_level);
  }
  if (open_low) extent.low = std::nullopt;
  if (open_high) extent.high = std::nullopt;
  return extent;
}

LikelihoodLimits likelihood_limits(const PooledCounts& counts, std::optional<double> lapse) {
  LikelihoodLimits limits;
  const double blank = blank_likelihood(counts);
  limits.chance = blank;
  double right = 0, wrong = 0;
  for (const PooledLevel& level : counts.levels) {
    right += level.right;
    wrong += level.wrong;
    limits.chance += binomial(level.right, level.wrong, chance_level);
  }
  limits.ceiling_lapse = lapse ? *lapse : std::min(wrong / (right + wrong), max_free_lapse);
  limits.ceiling = blank + times_log(right, 1 - limits.ceiling_lapse) + times_log(wrong, limits.ceiling_lapse);
  limits.step = lapse ? step_limit(counts, *lapse) : step_limit_free(counts);
  return limits;
}

}  // namespace todbench
