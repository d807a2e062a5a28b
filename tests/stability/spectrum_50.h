// SPDX-License-Identifier: GPL-3.0-or-later
// The spectrum of a polygon in 50-digit arithmetic.
#pragma once

#include <boost/math/constants/constants.hpp>

#include "hvs/shape/polygon.h"
#include "tests/stability/fifty_digits.h"

namespace todbench::testing {

struct Complex50 {
  Digits re = 0, im = 0;
};

/// Integral of exp(-2 pi i (u x + w y)) over the polygon by the divergence theorem with the field k exp(-i k.r):
/// F = (i / k^2) sum over edges of (k x d) exp(-i k.m) sinc(k.d / 2), m the middle of the edge, d along it. The sum
/// cancels to k^2 of itself: 50 digits leave 30 down to k = 1e-10.
inline Complex50 spectrum_50(const Polygon& polygon, double u, double w) {
  const Digits two_pi = 2 * boost::math::constants::pi<Digits>();
  const Digits kx = two_pi * Digits(u), ky = two_pi * Digits(w);
  Digits twice_area = 0, re = 0, im = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto& a = polygon[i];
    const auto& b = polygon[(i + 1) % polygon.size()];
    const Digits ax(a.x), ay(a.y), bx(b.x), by(b.y);
    twice_area += ax * by - bx * ay;
    const Digits dx = bx - ax, dy = by - ay, half = (kx * dx + ky * dy) / 2;
    const Digits sinc = half == 0 ? Digits(1) : Digits(sin(half) / half);
    const Digits angle = kx * (ax + bx) / 2 + ky * (ay + by) / 2, flux = (kx * dy - ky * dx) * sinc;
    re += flux * sin(angle);  // i exp(-i angle) = sin + i cos
    im += flux * cos(angle);
  }
  const Digits sign = twice_area < 0 ? -1 : 1, square = kx * kx + ky * ky;
  if (square == 0) return {sign * twice_area / 2, Digits(0)};
  return {sign * re / square, sign * im / square};
}

}  // namespace todbench::testing
