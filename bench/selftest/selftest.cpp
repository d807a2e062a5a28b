// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/selftest/selftest.h"

#include <cmath>

#include "acquisition/base/try.h"
#include "bench/selftest/selftest_cases.h"

namespace todbench {

bool SelftestCase::ok() const {
  return std::abs(value - expected) <= tolerance;
}

std::vector<SelftestGroup> selftest_groups() {
  return {{"closed form", "formulas of textbooks"},
          {"50 digits", "arithmetic with 50 digits"},
          {"hard case", "a verdict, a refusal or a finite number is required"},
          {"every part", "numbers of another compiler and processor"},
          {"same bits", "two threads, and the same work done twice"},
          {"reference set", "the published threshold of the first case"}};
}

Result<std::vector<SelftestCase>> selftest(std::stop_token stop) {
  SelftestCases cases;
  for (void (*add)(SelftestCases&) :
       {add_closed_forms, add_fifty_digits, add_hard_cases, add_every_part, add_same_bits}) {
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "interrupted");
    add(cases);
  }
  TODBENCH_TRY_VOID(add_reference_case(cases, std::move(stop)));
  return cases;
}

}  // namespace todbench
