// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/registration/homography.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

namespace todbench {
namespace {

/// Moves the mean to the origin and makes the mean distance from it sqrt(2).
Eigen::Matrix3d normaliser(std::span<const cv::Point2d> places) {
  const auto n = static_cast<double>(places.size());
  cv::Point2d mean{0, 0};
  for (const cv::Point2d& p : places) mean += p / n;
  double distance = 0;
  for (const cv::Point2d& p : places) distance += cv::norm(p - mean) / n;
  const double scale = distance > 0 ? std::sqrt(2) / distance : 1;
  Eigen::Matrix3d out;
  out << scale, 0, -scale * mean.x, 0, scale, -scale * mean.y, 0, 0, 1;
  return out;
}

struct Pair {
  Eigen::Vector3d from;  ///< homogeneous
  Eigen::Vector2d to;
};

/// Elements of the homography row by row, without the last one.
using Elements = Eigen::Matrix<double, 8, 1>;

Eigen::Matrix3d matrix_of(const Elements& h) {
  Eigen::Matrix3d out;
  out << h(0), h(1), h(2), h(3), h(4), h(5), h(6), h(7), 1;
  return out;
}

/// The linear solution: the unit vector with the smallest residual of the equations to x H from = 0.
std::optional<Elements> linear_solution(const std::vector<Pair>& pairs) {
  Eigen::MatrixXd equations(2 * static_cast<Eigen::Index>(pairs.size()), 9);
  Eigen::Index row = 0;
  for (const Pair& pair : pairs) {
    equations.row(row++) << pair.from.transpose(), Eigen::RowVector3d::Zero(), -pair.to.x() * pair.from.transpose();
    equations.row(row++) << Eigen::RowVector3d::Zero(), pair.from.transpose(), -pair.to.y() * pair.from.transpose();
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(equations, Eigen::ComputeFullV);
  // Rank 8, otherwise more than one homography fits.
  if (!(svd.singularValues()(7) > 1e-9 * svd.singularValues()(0))) return std::nullopt;
  const Eigen::VectorXd h = svd.matrixV().col(8);
  if (!(std::abs(h(8)) > 1e-9)) return std::nullopt;
  return h.head<8>() / h(8);
}

/// Sum of squares of the residuals at `h`, gradient and products of derivatives.
struct Normal {
  double sum = 0;
  Elements gradient = Elements::Zero();
  Eigen::Matrix<double, 8, 8> products = Eigen::Matrix<double, 8, 8>::Zero();
};

/// Empty if a place is mapped to infinity or beyond.
std::optional<Normal> normal_at(const Elements& h, const std::vector<Pair>& pairs) {
  Normal out;
  const Eigen::Matrix3d matrix = matrix_of(h);
  for (const Pair& pair : pairs) {
    const Eigen::Vector3d mapped = matrix * pair.from;
    if (!(mapped.z() > 1e-9)) return std::nullopt;
    const Eigen::Vector2d at = mapped.head<2>() / mapped.z();
    const Eigen::Vector2d residual = pair.to - at;
    const Eigen::Vector3d part = pair.from / mapped.z();
    Eigen::Matrix<double, 2, 8> derivative = Eigen::Matrix<double, 2, 8>::Zero();
    derivative.block<1, 3>(0, 0) = part.transpose();
    derivative.block<1, 3>(1, 3) = part.transpose();
    derivative.block<2, 2>(0, 6) = -at * part.head<2>().transpose();
    out.sum += residual.squaredNorm();
    out.gradient += derivative.transpose() * residual;
    out.products += derivative.transpose() * derivative;
  }
  return out;
}

}  // namespace

std::optional<cv::Matx33d> fit_homography(std::span<const cv::Point2d> from, std::span<const cv::Point2d> to) {
  CV_Assert(from.size() == to.size());
  if (from.size() < 4) return std::nullopt;
  const Eigen::Matrix3d before = normaliser(from), after = normaliser(to);
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < from.size(); ++i)
    pairs.push_back(
        {before * Eigen::Vector3d(from[i].x, from[i].y, 1), (after * Eigen::Vector3d(to[i].x, to[i].y, 1)).head<2>()});
  const auto linear = linear_solution(pairs);
  if (!linear) return std::nullopt;
  Elements h = *linear;
  auto at = normal_at(h, pairs);
  if (!at) return std::nullopt;
  double damping = 1e-3;
  for (int iteration = 0; iteration < 100; ++iteration) {
    Eigen::Matrix<double, 8, 8> damped = at->products;
    damped.diagonal() *= 1 + damping;
    const Elements step = damped.ldlt().solve(at->gradient);
    if (!step.allFinite()) break;
    const auto next = normal_at(h + step, pairs);
    const bool better = next && next->sum <= at->sum;
    if (better) {
      h += step;
      at = next;
    }
    damping = std::clamp(damping * (better ? 0.1 : 10), 1e-15, 1e9);
    if (better && step.cwiseAbs().maxCoeff() < 1e-13) break;
    if (!better && damping >= 1e9) break;
  }
  const Eigen::Matrix3d mapping = after.inverse() * matrix_of(h) * before;
  if (!(std::abs(mapping(2, 2)) > 0) || !mapping.allFinite()) return std::nullopt;
  cv::Matx33d out;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) out(row, column) = mapping(row, column) / mapping(2, 2);
  return out;
}

}  // namespace todbench
