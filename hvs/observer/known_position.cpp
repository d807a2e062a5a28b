// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/observer/known_position.h"

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <numbers>

#include "acquisition/base/normal.h"

namespace todbench {
namespace {

double normal_quantile(double p) {
  // Kept inside the open interval: at its ends the weight of the point is zero anyway.
  const double inside = std::clamp(p, 1e-300, 1 - 1e-16);
  // In double precision: extended precision takes four times as long and changes nothing above 1e-15.
  using Plain = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
  return -std::numbers::sqrt2 * boost::math::erfc_inv(2 * inside, Plain());
}

/// Lower Cholesky factor of a 3x3 covariance; a vanishing pivot (templates that differ by the same vector) becomes 0.
struct Factor {
  double l[3][3] = {};
  explicit Factor(const double (&c)[3][3]) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) {
        double sum = c[i][j];
        for (int k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
        if (i == j) {
          l[i][i] = sum > 1e-14 * c[i][i] ? std::sqrt(sum) : 0;
        } else {
          l[i][j] = l[j][j] > 0 ? sum / l[j][j] : 0;
        }
      }
    }
  }
};

/// P(bound + scale z > 0) with scale >= 0. If scale is 0, the sign of the bound decides; a tie gives one half.
double upper(double bound, double scale) {
  if (scale > 0) return normal_probability(bound / scale);
  return bound > 0 ? 1.0 : (bound < 0 ? 0.0 : 0.5);
}

double certain(const std::array<double, 4>& mean) {
  const double best = *std::max_element(mean.begin(), mean.end());
  if (mean[0] < best) return 0;
  return 1.0 / static_cast<double>(std::count(mean.begin(), mean.end(), best));
}

}  // namespace

double probability_correct(const KnownPositionTask& task, int nodes) {
  return probability_correct(task, gauss_legendre(nodes));
}

double probability_correct(const KnownPositionTask& task, std::span<const QuadratureNode> rule) {
  if (task.noise == 0) return certain(task.mean);
  double b[3];
  double c[3][3];
  for (int i = 0; i < 3; ++i) {
    const auto p = static_cast<std::size_t>(i) + 1;
    b[i] = (task.mean[0] - task.mean[p]) / task.noise;
    for (int j = 0; j < 3; ++j) {
      const auto q = static_cast<std::size_t>(j) + 1;
      c[i][j] = task.gram[0][0] - task.gram[0][q] - task.gram[p][0] + task.gram[p][q];
    }
  }
  const Factor f(c);
  // x_i = b_i + sum_j l_ij z_j > 0 for all i; z_0 and z_1 are conditioned and integrated, z_2 is in closed form.
  const double p0 = upper(b[0], f.l[0][0]);
  double sum = 0;
  for (const auto& [s, ws] : rule) {
    const double z0 = f.l[0][0] > 0 ? -normal_quantile((0.5 + 0.5 * s) * p0) : 0;
    const double p1 = upper(b[1] + f.l[1][0] * z0, f.l[1][1]);
    double inner = 0;
    for (const auto& [t, wt] : rule) {
      const double z1 = f.l[1][1] > 0 ? -normal_quantile((0.5 + 0.5 * t) * p1) : 0;
      inner += 0.5 * wt * upper(b[2] + f.l[2][0] * z0 + f.l[2][1] * z1, f.l[2][2]);
    }
    sum += 0.5 * ws * p1 * inner;
  }
  return p0 * sum;
}

}  // namespace todbench
