// SPDX-License-Identifier: GPL-3.0-or-later
// Maxima of likelihoods and spectra of shapes with answers from 50-digit arithmetic. The tests of this room compute
// the answers again.
#include <algorithm>
#include <cmath>

#include "bench/selftest/selftest_cases.h"
#include "hvs/shape/polygon_spectrum.h"
#include "tod/plate/test_pattern.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {
namespace {

/// Counts nearest to expectation: the maximum lies at the truth within rounding.
std::vector<Level> expected_counts(const std::vector<double>& sizes, double trials, double threshold, double slope,
                                   double lapse) {
  std::vector<Level> levels;
  for (const double size : sizes) {
    const double psi = psychometric(PsychometricForm::size, size, threshold, slope, lapse);
    levels.push_back({size, std::round(trials * psi), trials, -1});
  }
  return levels;
}

std::vector<Level> in_units(std::vector<Level> levels, double unit) {
  for (Level& level : levels) level.size *= unit;
  return levels;
}

}  // namespace

std::vector<HardFit> hard_fits() {
  const std::vector<double> five{0.5, 0.8, 1.1, 1.5, 2.2};
  const std::vector<Level> plain = expected_counts(five, 40, 1, 3, 0.01);
  const std::vector<Level> far_error{
      {0.5, 8, 20, -1}, {0.8, 11, 20, -1}, {1.2, 17, 20, -1}, {2, 20, 20, -1}, {1000, 19, 20, -1}};
  return {
      {"two levels", {{0.7, 9, 20, -1}, {1.6, 18, 20, -1}}, 0, 0.20205515358849196, 0.81694833532470823},
      {"10^6 trials a level", expected_counts(five, 1e6, 1.234567, 3.3, 0), 0, 0.210721157750003, 1.1939112530265892},
      {"2 x 10^9 trials a level", expected_counts(five, 2e9, 1.234567, 3.3, 0), 0, 0.21072030120246787,
       1.1939224721857047},
      {"six decades of sizes", expected_counts({1e-3, 1e-2, 0.1, 1, 10, 100, 1000}, 400, 0.6, 0.7, 0), 0,
       -0.52065476141656353, -0.34509794567362273},
      {"sizes in units of 1e-250", in_units(plain, 1e-250), 0.01, -575.64864689400065, 1.1014233666050004},
      {"sizes in units of 1e200", in_units(plain, 1e200), 0.01, 460.51464495331987, 1.1014233666050006},
      {"an error at 1000 thresholds", far_error, 0, 1.0171112028697296, -1.6683947067883733},
      {"an error at 1000 thresholds, lapse 0.01", far_error, 0.01, 0.032450844891914458, 0.96162238667893618},
      {"a lapse of 5 % that the fit does not know",
       expected_counts({0.4, 0.6, 0.8, 1, 1.3, 1.7, 2.5, 4, 6}, 1000, 1, 3.5, 0.05), 0, 0.26201776225046447,
       -0.021603214391319046},
  };
}

std::vector<HardSpectrum> hard_spectra() {
  const Polygon left = triangle(1.7, Apex::left, {0.3, -0.4});
  const cv::Point2d edge = left[1] - left[0];
  const double length = std::hypot(edge.x, edge.y);
  const auto across = [&](double frequency, double beside) {
    return cv::Point2d(frequency * (-edge.y + beside * edge.x) / length,
                       frequency * (edge.x + beside * edge.y) / length);
  };
  std::vector<HardSpectrum> out;
  const auto add = [&](std::string name, const Polygon& shape, cv::Point2d wave, std::complex<double> exact) {
    out.push_back({std::move(name), shape, wave.x, wave.y, exact});
  };
  add("wave across an edge", left, across(5, 0), {-0.07889576251264907, 0.019029329780618793});
  add("wave 1e-12 beside an edge", left, across(5, 1e-12), {-0.078895762512374165, 0.019029329781758576});
  add("wave 1e-5 beside an edge", left, across(40, 1e-5), {-0.0095034156571148515, 0.0039155182768000497});
  add("wave of 1e-12 cycles", left, across(1e-12, 1e-8), {2.8899999999999997, 3.5664952810081818e-12});
  add("triangle of 0.01 pitches", triangle(0.01, Apex::right, {0.123, -0.456}), {3.7, 1.1},
      {9.5490706047448814e-05, 2.8723974455727246e-05});
  add("triangle of 500 pitches", triangle(500, Apex::right, {0.123, -0.456}), {0.4, 0.02},
      {3.708940742545598, -1.0522378304388955});
  return out;
}

void add_fifty_digits(SelftestCases& cases) {
  const auto add = [&](const std::string& name, double value, double expected, double tolerance) {
    cases.push_back({"50 digits", name, value, expected, tolerance});
  };
  for (const HardFit& hard : hard_fits()) {
    const auto fit = fit_psychometric(hard.levels, {.fixed_lapse = hard.lapse, .with_posterior = false});
    const bool found = fit && fit->threshold && fit->slope;
    // Convergence: a gradient of 1e-8 of the information.
    add("ln threshold: " + hard.name, found ? std::log(*fit->threshold) : NAN, hard.ln_threshold, 2e-9);
    add("ln slope: " + hard.name, found ? std::log(*fit->slope) : NAN, hard.ln_slope, 2e-8);
  }
  for (const HardSpectrum& hard : hard_spectra()) {
    const std::complex<double> found = polygon_spectrum(hard.shape, hard.u, hard.w);
    const cv::Point2d centre = centroid(hard.shape);
    const double reach = std::sqrt(area(hard.shape)) + std::hypot(centre.x, centre.y);
    const double turns = std::hypot(hard.u, hard.w) * reach;
    // Vertices are stated relative to the origin, so a small shape at a distance loses digits.
    const double off_centre = 1 + std::hypot(centre.x, centre.y) / std::sqrt(area(hard.shape));
    const double tolerance = 4e-15 * area(hard.shape) * off_centre * (1 + 4 * turns);
    add("spectrum, real: " + hard.name, found.real(), hard.spectrum.real(), tolerance);
    add("spectrum, imaginary: " + hard.name, found.imag(), hard.spectrum.imag(), tolerance);
  }
}

}  // namespace todbench
