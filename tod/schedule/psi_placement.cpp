// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/schedule/psi_placement.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "tod/psychometric/psychometric_model.h"

namespace todbench {
namespace {

constexpr std::size_t t_nodes = 61, q_nodes = 9;
constexpr double prior_mean_q = 1.252762968495368;  // ln 3.5
constexpr double prior_sd_q = 0.6;
constexpr double reach_q = 2;             // standard deviations of the prior that the slopes cover
constexpr double reach_candidates = 1.3;  // ln sizes beyond the mean threshold: the probe at 2.5 thresholds is at 0.92
constexpr double lapse_probe = 2.5;       // thresholds
constexpr double slope_probe = 0.45;      // right answers
constexpr double edge_share = 0.02;       // of the posterior in the outer tenth of the grid: it leans on the edge

double x_ln_x(double x) {
  return x > 0 ? x * std::log(x) : 0;
}

}  // namespace

PsiPlacement::PsiPlacement(const PsiOptions& options, RandomStream stream) : options_(options), stream_(stream) {
  assert(options.first_size > 0 && options.last_size > options.first_size && options.size_step > 0);
  for (std::size_t j = 0; j < q_nodes; ++j)
    qs_.push_back(prior_mean_q +
                  prior_sd_q * reach_q * (2 * static_cast<double>(j) / static_cast<double>(q_nodes - 1) - 1));
  const double low = std::log(options.first_size), high = std::log(options.last_size);
  lay_grid((low + high) / 2, (high - low) / static_cast<double>(t_nodes - 1));
  summarise();
}

void PsiPlacement::lay_grid(double centre, double step) {
  step_ = step;
  ts_.clear();
  const double low = std::log(options_.first_size), high = std::log(options_.last_size);
  for (std::size_t i = 0; i < t_nodes; ++i)
    ts_.push_back(centre + step * (static_cast<double>(i) - static_cast<double>(t_nodes - 1) / 2));
  ln_posterior_.assign(t_nodes * q_nodes, 0);
  const double rounding = 1e-9 * (high - low);
  for (std::size_t j = 0; j < q_nodes; ++j) {
    const double x = (qs_[j] - prior_mean_q) / prior_sd_q;
    for (std::size_t i = 0; i < t_nodes; ++i) {
      const bool inside = ts_[i] >= low - rounding && ts_[i] <= high + rounding;
      ln_posterior_[j * t_nodes + i] = inside ? -x * x / 2 : -std::numeric_limits<double>::infinity();
    }
  }
  for (const Answers& answers : answers_) add(answers);
  // Candidates: from the lowest threshold of the grid to 3.7 times the highest, the range of informative sizes.
  first_candidate_ = options_.size_step * std::ceil((ts_.front() - 0.5) / options_.size_step);
  const double last = ts_.back() + reach_candidates;
  table_.clear();
  for (double x = first_candidate_; x <= last; x += options_.size_step) {
    const auto psi = probabilities(x);
    table_.insert(table_.end(), psi.begin(), psi.end());
  }
}

std::vector<double> PsiPlacement::probabilities(double ln_size) const {
  std::vector<double> psi;
  psi.reserve(t_nodes * q_nodes);
  const Link link = make_link(options_.form, options_.selection_lapse);
  for (std::size_t j = 0; j < q_nodes; ++j) {
    const double slope = std::exp(qs_[j]);
    for (std::size_t i = 0; i < t_nodes; ++i)
      psi.push_back(std::exp(log_probabilities(link, link.sign * slope * (ln_size - ts_[i])).right));
  }
  return psi;
}

void PsiPlacement::add(const Answers& answers) {
  const Link link = make_link(options_.form, options_.selection_lapse);
  const double ln_size = std::log(answers.size);
  for (std::size_t j = 0; j < q_nodes; ++j) {
    const double slope = std::exp(qs_[j]);
    for (std::size_t i = 0; i < t_nodes; ++i) {
      const LogProbabilities p = log_probabilities(link, link.sign * slope * (ln_size - ts_[i]));
      double& value = ln_posterior_[j * t_nodes + i];
      if (answers.correct > 0) value += answers.correct * p.right;
      if (answers.total > answers.correct) value += (answers.total - answers.correct) * p.wrong;
    }
  }
}

void PsiPlacement::summarise() {
  const double peak = *std::max_element(ln_posterior_.begin(), ln_posterior_.end());
  posterior_.resize(ln_posterior_.size());
  double sum = 0;
  for (std::size_t k = 0; k < posterior_.size(); ++k) sum += posterior_[k] = std::exp(ln_posterior_[k] - peak);
  marginal_.assign(t_nodes, 0);
  mean_ = sd_ = mean_q_ = entropy_ = 0;
  for (std::size_t j = 0; j < q_nodes; ++j) {
    double row = 0;
    for (std::size_t i = 0; i < t_nodes; ++i) {
      const double p = posterior_[j * t_nodes + i] /= sum;
      marginal_[i] += p;
      row += p;
    }
    mean_q_ += row * qs_[j];
  }
  for (std::size_t i = 0; i < t_nodes; ++i) {
    mean_ += marginal_[i] * ts_[i];
    entropy_ -= x_ln_x(marginal_[i]);
  }
  for (std::size_t i = 0; i < t_nodes; ++i) sd_ += marginal_[i] * (ts_[i] - mean_) * (ts_[i] - mean_);
  sd_ = std::sqrt(sd_);
}

void PsiPlacement::renew_where_needed() {
  const double low = std::log(options_.first_size), high = std::log(options_.last_size);
  for (int round = 0; round < 20; ++round) {
    constexpr std::size_t margin = t_nodes / 10;
    double below = 0, above = 0;
    for (std::size_t i = 0; i < margin; ++i) {
      below += marginal_[i];
      above += marginal_[t_nodes - 1 - i];
    }
    const bool leans = (below > edge_share && ts_.front() > low) || (above > edge_share && ts_.back() < high);
    if (leans) {
      const double widest = (high - low) / static_cast<double>(t_nodes - 1);
      // A grid that is already centred has to widen instead of moving.
      const bool centred = std::abs(mean_ - ts_[t_nodes / 2]) < step_;
      lay_grid(mean_, centred ? std::min(2 * step_, widest) : step_);
    } else if (sd_ < 2 * step_) {
      lay_grid(mean_, step_ / 2);
    } else {
      return;
    }
    summarise();
  }
}

void PsiPlacement::observe(double size, double correct, double total) {
  assert(size > 0 && correct >= 0 && correct <= total);
  if (total <= 0) return;
  const auto known = std::find_if(answers_.begin(), answers_.end(), [&](const Answers& a) { return a.size == size; });
  if (known == answers_.end()) {
    answers_.push_back({size, correct, total});
  } else {
    known->correct += correct;
    known->total += total;
  }
  ++asked_;
  add({size, correct, total});
  summarise();
  renew_where_needed();
}

/// Entropy of the marginal now minus its expected value after an answer.
double PsiPlacement::gain(const double* right) const {
  std::array<double, t_nodes> joint{};
  for (std::size_t j = 0; j < q_nodes; ++j) {
    const double* psi = right + j * t_nodes;
    const double* p = &posterior_[j * t_nodes];
    for (std::size_t i = 0; i < t_nodes; ++i) joint[i] += psi[i] * p[i];
  }
  double p_right = 0, left = 0;
  for (std::size_t i = 0; i < t_nodes; ++i) {
    p_right += joint[i];
    // Nodes without weight: below 1e-12 an entropy term is below 3e-11.
    if (marginal_[i] > 1e-12) left -= x_ln_x(joint[i]) + x_ln_x(std::max(0.0, marginal_[i] - joint[i]));
  }
  return entropy_ - (left + x_ln_x(p_right) + x_ln_x(1 - p_right));
}

double PsiPlacement::expected_gain(double size) const {
  assert(size > 0);
  return std::max(0.0, gain(probabilities(std::log(size)).data()));
}

double PsiPlacement::least_entropy_size() const {
  constexpr std::size_t block = t_nodes * q_nodes;
  double best = -1, best_x = first_candidate_;
  const auto at = [&](std::size_t c) { return first_candidate_ + options_.size_step * static_cast<double>(c); };
  for (std::size_t c = 0; c < table_.size() / block; ++c) {
    const double x = at(c);
    // Outside this range an answer carries almost no information on the threshold.
    if (x < mean_ - 3 * sd_ - 0.7 || x > mean_ + 3 * sd_ + 0.9) continue;
    // Ties, for example between equally uninformative sizes, are broken at random.
    const double value = gain(&table_[c * block]) * (1 + 1e-9 * stream_.sub(asked_).uniform(c + 1));
    if (value > best) {
      best = value;
      best_x = x;
    }
  }
  return std::exp(best_x);
}

double PsiPlacement::next() const {
  const double u = stream_.sub(asked_).uniform(0);
  if (u < options_.lapse_probe_share) return std::exp(mean_) * lapse_probe;
  if (u < options_.lapse_probe_share + options_.slope_probe_share) {
    // The size with psi = 0.45 at the mean slope: z = -ln(1 - H), H = 0.2 / 0.75, in units of the threshold's z.
    const Link link = make_link(options_.form, 0);
    const double h = (slope_probe - chance_level) / (1 - chance_level);
    const double z = options_.form == PsychometricForm::size ? -std::log1p(-h) : -std::log(h);
    return std::exp(mean_ + link.sign * (std::log(z) - link.ln_kappa) / std::exp(mean_q_));
  }
  return least_entropy_size();
}

}  // namespace todbench
