// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/psychometric/psychometric_model.h"

#include <algorithm>
#include <cmath>

namespace todbench {
namespace {

constexpr double g = chance_level;
constexpr double largest_exponent = 700;  // exp(700) = 1e304 is finite
constexpr double branch_z = 0.7;          // below it 1 - exp(-z), above it exp(-z) is the smaller of the two

// exp(-z) and 1 - exp(-z), each without cancellation.
struct Exponentials {
  double z, e, em;
};
Exponentials exponentials(const Link& link, double u) {
  const double z = link.kappa * std::exp(std::min(u, largest_exponent));
  if (z < branch_z) {
    const double em = -std::expm1(-z);
    return {z, 1 - em, em};
  }
  const double e = std::exp(-z);
  return {z, e, 1 - e};
}

double psi_of(const Link& link, const Exponentials& x) {
  if (link.form == PsychometricForm::size)
    return x.z < branch_z ? g + link.amplitude * x.em : 1 - (link.lapse + link.amplitude * x.e);
  return x.z < branch_z ? 1 - (link.lapse + link.amplitude * x.em) : g + link.amplitude * x.e;
}

// 1 - psi; at lapse 0 and large z of the size form it underflows, which the callers avoid.
double complement_of(const Link& link, const Exponentials& x) {
  if (link.form == PsychometricForm::size)
    return x.z < branch_z ? 1 - (g + link.amplitude * x.em) : link.lapse + link.amplitude * x.e;
  return x.z < branch_z ? link.lapse + link.amplitude * x.em : 1 - (g + link.amplitude * x.e);
}

double log_right(const Link& link, const Exponentials& x) {
  const bool size = link.form == PsychometricForm::size;
  if (x.z < branch_z)
    return size ? std::log(g + link.amplitude * x.em) : std::log1p(-(link.lapse + link.amplitude * x.em));
  return size ? std::log1p(-(link.lapse + link.amplitude * x.e)) : std::log(g + link.amplitude * x.e);
}

double log_wrong(const Link& link, const Exponentials& x, double u) {
  static const double ln_1mg = std::log(1 - g);
  if (link.form == PsychometricForm::size) {
    if (link.lapse == 0) return ln_1mg - x.z;
    return x.z < branch_z ? std::log1p(-(g + link.amplitude * x.em)) : std::log(link.lapse + link.amplitude * x.e);
  }
  if (x.z >= branch_z) return std::log1p(-(g + link.amplitude * x.e));
  // 1 - exp(-z) = z to double precision below u = -40, and z itself underflows far below.
  if (link.lapse == 0) return ln_1mg + (u < -40 ? link.ln_kappa + u : std::log(x.em));
  return std::log(link.lapse + link.amplitude * x.em);
}

// H, dH/dw and d2H/dw2 with w = ln z.
struct Shape {
  double h, h1, h2;
};
Shape shape_of(const Link& link, const Exponentials& x) {
  const double ez = x.e > 0 ? x.e * x.z : 0;
  const double ezz = x.e > 0 ? ez * (1 - x.z) : 0;
  if (link.form == PsychometricForm::size) return {x.em, ez, ezz};
  return {x.e, -ez, -ezz};
}

}  // namespace

Link make_link(PsychometricForm form, double lapse) {
  Link link;
  link.form = form;
  link.lapse = lapse;
  const double a = 1 - g - lapse;
  link.amplitude = a;
  const bool size = form == PsychometricForm::size;
  // psi(x75) = 0.75: exp(-kappa) = (0.25 - l) / A in the size form, 0.5 / A in the acuity form.
  const double rest = size ? 0.25 - lapse : 0.5;
  link.kappa = std::log(a / rest);
  link.ln_kappa = std::log(link.kappa);
  const double d1 = -1 / a + (size ? 1 / rest : 0);
  const double d2 = -1 / (a * a) + (size ? 1 / (rest * rest) : 0);
  link.d_ln_kappa = d1 / link.kappa;
  link.d2_ln_kappa = d2 / link.kappa - link.d_ln_kappa * link.d_ln_kappa;
  link.sign = size ? 1 : -1;
  return link;
}

LogProbabilities log_probabilities(const Link& link, double u) {
  const Exponentials x = exponentials(link, u);
  return {log_right(link, x), log_wrong(link, x, u)};
}

AnswerTerms answer_terms(const Link& link, double far_u) {
  // z = 1e130 is equivalent to z = 1e304, and its square times any count and slope is finite.
  const double u = std::min(far_u, 300.0);
  const Exponentials x = exponentials(link, u);
  const Shape s = shape_of(link, x);
  const double a = link.amplitude;
  const double psi = psi_of(link, x);
  AnswerTerms terms;
  LogTerm& right = terms.right;
  right.value = log_right(link, x);
  right.w = a * s.h1 / psi;
  right.ww = a * s.h2 / psi - right.w * right.w;
  right.l = -s.h / psi;
  right.ll = -right.l * right.l;
  right.wl = -s.h1 / psi * (1 - s.h * a / psi);

  LogTerm& wrong = terms.wrong;
  wrong.value = log_wrong(link, x, u);
  // The floor keeps derivatives with respect to the lapse finite at lapse 0, where they grow as exp(z); squares must
  // not overflow.
  const double q = std::max(complement_of(link, x), 1e-140);
  if (link.lapse == 0 && link.form == PsychometricForm::size) {
    wrong.w = wrong.ww = -x.z;  // ln(1 - psi) = ln(1 - g) - z exactly
  } else if (link.lapse == 0 && x.z < 1e-8) {
    wrong.w = 1 - x.z / 2;  // z exp(-z) / (1 - exp(-z)) to second order
    wrong.ww = -x.z / 2;
  } else {
    wrong.w = -a * s.h1 / q;
    wrong.ww = -a * s.h2 / q - wrong.w * wrong.w;
  }
  wrong.l = s.h / q;
  wrong.ll = -wrong.l * wrong.l;
  wrong.wl = s.h1 / q * (1 + s.h * a / q);
  return terms;
}

double psychometric(PsychometricForm form, double size, double threshold, double slope, double lapse) {
  if (size <= 0) return g;
  const Link link = make_link(form, lapse);
  const double u = link.sign * slope * (std::log(size) - std::log(threshold));
  return psi_of(link, exponentials(link, u));
}

}  // namespace todbench
