// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/psychometric/clustered_variance.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

namespace todbench {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_parameters, most_parameters>;
using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_parameters, 1>;

/// Largest leverage for the correction: above it a cluster alone determines a direction.
constexpr double most_leverage = 0.9;

/// Least variance over set-ups, relative to that of single answers: evenly spread phases leave a tenth; much less is
/// chance.
constexpr double least_share = 0.01;

struct Cluster {
  Vector score;
  Matrix information;
};

Vector direction_of(const AnswerScore& answer, Eigen::Index parameters) {
  Vector out(parameters);
  for (Eigen::Index k = 0; k < parameters; ++k) out(k) = answer.direction[static_cast<std::size_t>(k)];
  return out;
}

/// Sums over one kind of clusters.
struct Sums {
  double variance = 0;
  double clusters = 0;
  double concentration = 0;  ///< sum of squared shares of the information: 1 / clusters for equal ones
};

/// The root of the inverse information, and its row for the parameter.
struct Root {
  Matrix root;
  Vector row;
  double variance = 0;
};

std::optional<Root> root_of(const Matrix& information, Eigen::Index which) {
  const Eigen::LLT<Matrix> factor(information);
  if (factor.info() != Eigen::Success) return std::nullopt;
  const Matrix lower = factor.matrixL();
  for (Eigen::Index k = 0; k < lower.rows(); ++k)
    if (!(lower(k, k) * lower(k, k) > 1e-12 * information(k, k))) return std::nullopt;
  Root out;
  out.root = lower.transpose().triangularView<Eigen::Upper>().solve(Matrix::Identity(lower.rows(), lower.cols()));
  out.row = out.root.row(which).transpose();
  out.variance = out.row.squaredNorm();
  return out;
}

/// CR2: the score of a cluster times (1 - H)^(-1/2), in coordinates in which the information is the identity.
double corrected(const Cluster& cluster, const Root& root) {
  const Matrix leverage = root.root.transpose() * cluster.information * root.root;
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(leverage);
  Vector score = eigen.eigenvectors().transpose() * (root.root.transpose() * cluster.score);
  for (Eigen::Index k = 0; k < score.size(); ++k)
    score(k) /= std::sqrt(1 - std::clamp(eigen.eigenvalues()(k), 0.0, most_leverage));
  return root.row.dot(eigen.eigenvectors() * score);
}

template <typename Key>
Sums sums_over(std::span<const AnswerScore> answers, const Root& root, const Key& key_of) {
  const Eigen::Index parameters = root.row.size();
  std::map<decltype(key_of(answers.front())), Cluster> clusters;
  for (const AnswerScore& answer : answers) {
    auto [slot, is_new] =
        clusters.try_emplace(key_of(answer), Cluster{Vector::Zero(parameters), Matrix::Zero(parameters, parameters)});
    const Vector direction = direction_of(answer, parameters);
    slot->second.score += answer.residual * direction;
    slot->second.information += direction * direction.transpose();
  }
  Sums out;
  for (const auto& [key, cluster] : clusters) {
    out.variance += std::pow(corrected(cluster, root), 2);
    const Vector row = root.root * root.row;
    out.concentration += std::pow(row.dot(cluster.information * row) / root.variance, 2);
  }
  out.clusters = static_cast<double>(clusters.size());
  return out;
}

}  // namespace

ClusteredVariance clustered_variance(std::span<const AnswerScore> answers, std::size_t parameters, std::size_t which,
                                     AnswerScatter scatter) {
  ClusteredVariance out;
  out.variance = std::numeric_limits<double>::infinity();
  const auto size = static_cast<Eigen::Index>(parameters);
  Matrix information = Matrix::Zero(size, size);
  double squares = 0;
  for (const AnswerScore& answer : answers) {
    const Vector direction = direction_of(answer, size);
    information += direction * direction.transpose();
    squares += answer.residual * answer.residual;
  }
  const auto root = root_of(information, static_cast<Eigen::Index>(which));
  if (!root) return out;
  out.independent = root->variance;
  out.dispersion = squares / std::max(1.0, static_cast<double>(answers.size()) - static_cast<double>(parameters));
  const auto freedom = [](const Sums& sums) { return std::max(1.0, 1 / sums.concentration - 1); };
  const Sums set_ups = sums_over(answers, *root, [](const AnswerScore& a) { return a.set_up; });
  int number = 0;
  const Sums single = sums_over(answers, *root, [&number](const AnswerScore&) { return number++; });
  const bool binomial = scatter == AnswerScatter::binomial;
  const Sums triangles = sums_over(answers, *root, [](const AnswerScore& a) { return std::pair(a.set_up, a.place); });
  const Sums detectors = sums_over(answers, *root, [](const AnswerScore& a) { return a.place; });
  if (!binomial && 1 / set_ups.concentration >= least_set_ups) {
    out.kind = IntervalKind::set_ups;
    const double shared = std::max(0.0, detectors.variance - triangles.variance);
    out.variance = std::max(set_ups.variance, least_share * single.variance) + shared;
    out.degrees_of_freedom = freedom(set_ups);
    return out;
  }
  const Sums presentations = sums_over(answers, *root, [](const AnswerScore& a) { return a.presentation; });
  const Sums& places = binomial ? triangles : detectors;
  if (binomial && (presentations.clusters < 2) != (places.clusters < 2)) {
    const Sums& several = presentations.clusters < 2 ? places : presentations;
    out.variance = std::max(several.variance, root->variance);
    out.degrees_of_freedom = freedom(several);
    return out;
  }
  if (presentations.clusters < 2 || places.clusters < 2) return out;
  out.variance =
      std::max({presentations.variance + places.variance - single.variance, presentations.variance, places.variance});
  if (binomial) out.variance = std::max(out.variance, root->variance);
  out.degrees_of_freedom = std::min(freedom(presentations), freedom(places));
  return out;
}

}  // namespace todbench
