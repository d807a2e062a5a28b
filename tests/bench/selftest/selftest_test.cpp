// SPDX-License-Identifier: GPL-3.0-or-later
// The answers of the self-test, computed again by 50-digit arithmetic, and the verdict of its cases.
#include "bench/selftest/selftest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <set>

#include "bench/selftest/selftest_cases.h"
#include "tests/stability/fifty_digits.h"
#include "tests/stability/spectrum_50.h"

namespace todbench {
namespace {

bool writes_answers() {
  return std::getenv("TODBENCH_WRITE_GOLDEN") != nullptr;
}

TEST(SelftestAnswers, OfFitsAreTheMaximaIn50Digits) {
  for (const HardFit& hard : hard_fits()) {
    const auto fit = fit_psychometric(hard.levels, {.fixed_lapse = hard.lapse, .with_posterior = false});
    ASSERT_TRUE(fit && fit->threshold && fit->slope) << hard.name;

    const auto exact = testing::maximum_50(hard.levels, std::log(*fit->threshold), std::log(*fit->slope), hard.lapse);

    ASSERT_TRUE(exact.converged) << hard.name;
    if (writes_answers()) {
      std::printf("%s: %.17g, %.17g\n", hard.name.c_str(), static_cast<double>(exact.t), static_cast<double>(exact.q));
      continue;
    }
    EXPECT_DOUBLE_EQ(hard.ln_threshold, static_cast<double>(exact.t)) << hard.name;
    EXPECT_DOUBLE_EQ(hard.ln_slope, static_cast<double>(exact.q)) << hard.name;
  }
}

TEST(SelftestAnswers, OfSpectraAreTheSumsIn50Digits) {
  for (const HardSpectrum& hard : hard_spectra()) {
    const testing::Complex50 exact = testing::spectrum_50(hard.shape, hard.u, hard.w);
    const auto re = static_cast<double>(exact.re), im = static_cast<double>(exact.im);
    if (writes_answers()) {
      std::printf("%s: {%.17g, %.17g}\n", hard.name.c_str(), re, im);
      continue;
    }
    EXPECT_DOUBLE_EQ(hard.spectrum.real(), re) << hard.name;
    EXPECT_DOUBLE_EQ(hard.spectrum.imag(), im) << hard.name;
  }
}

TEST(SelftestAnswers, OfEveryPartHaveTheNamesThatAreComputed) {
  for (const auto& [name, value] : numbers_of_every_part()) {
    if (writes_answers()) std::printf("{\"%s\", %.17g},\n", name.c_str(), value);
    EXPECT_TRUE(golden_numbers().contains(name)) << name;
  }
  EXPECT_EQ(golden_numbers().size(), numbers_of_every_part().size());
}

TEST(Selftest, PassesOnThisMachine) {
  const auto cases = selftest({});

  ASSERT_TRUE(cases) << cases.error().message;
  std::set<std::string> names;
  std::map<std::string_view, int> groups;
  for (const SelftestCase& one : *cases) {
    EXPECT_TRUE(one.ok()) << one.group << ", " << one.name << ": " << one.value << ", expected " << one.expected
                          << " +- " << one.tolerance;
    EXPECT_TRUE(names.insert(std::string(one.group) + one.name).second) << one.name;
    ++groups[one.group];
  }
  for (const SelftestGroup& group : selftest_groups()) EXPECT_GE(groups[group.name], 2) << group.name;
  EXPECT_EQ(groups.size(), selftest_groups().size());
}

TEST(Selftest, ACaseFailsBeyondItsToleranceAndForAnythingThatIsNoNumber) {
  const auto ok = [](double value, double expected) {
    return SelftestCase{"closed form", "x", value, expected, 1e-3}.ok();
  };
  EXPECT_TRUE(ok(1.0009, 1));
  EXPECT_FALSE(ok(1.0011, 1));
  EXPECT_FALSE(ok(NAN, 1));
  EXPECT_FALSE(ok(1, NAN));
  EXPECT_FALSE(ok(INFINITY, INFINITY));
}

TEST(Selftest, EndsOnRequest) {
  std::stop_source stop;
  stop.request_stop();
  const auto cases = selftest(stop.get_token());
  ASSERT_FALSE(cases);
  EXPECT_EQ(cases.error().code, ErrorCode::interrupted);
}

}  // namespace
}  // namespace todbench
