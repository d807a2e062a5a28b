// SPDX-License-Identifier: GPL-3.0-or-later
// False alarms and power of every statistical finding, with enough replicates to see half a per cent. Long form of
// adequacy_test.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <map>
#include <utility>

#include "tests/tod/adequacy/adequacy_support.h"

namespace todbench {
namespace {

using testing::AdequacyDesign;
using testing::finding_shares;
using testing::FindingShares;
using testing::point_by_twin;

void print(const AdequacyDesign& design, const FindingShares& shares) {
  std::cout << design.name << ": unfit " << shares.unfit << ", no threshold " << shares.not_identified;
  for (const auto& [kind, share] : shares.found) std::cout << ", " << to_string(kind) << ' ' << share;
  std::cout << std::endl;
}

TEST(AdequacyStudy, RightModelsGiveNoMoreThanOnePerCentOfEachFinding) {
  constexpr int replicates = 2000;
  for (const AdequacyDesign& design : testing::right_designs()) {
    const FindingShares shares = finding_shares(design, replicates, 11);

    print(design, shares);
    // Three standard errors of a share of 1 %.
    for (const auto& [kind, share] : shares.found)
      EXPECT_LE(share, 0.01 + 3 * std::sqrt(0.01 * 0.99 / replicates)) << design.name << ": " << to_string(kind);
  }
}

TEST(AdequacyStudy, WrongModelsAreFoundAsOftenAsTheDocumentSays) {
  struct Row {
    AdequacyDesign design;
    FindingKind kind;
    double at_least;
  };
  const auto acuity = PsychometricForm::acuity;
  const std::vector<Row> rows{
      {{.name = "5 % lapses, 160", .trials_per_size = 20, .lapse = 0.05}, FindingKind::lapse, 0},
      {{.name = "5 % lapses, 640", .lapse = 0.05}, FindingKind::lapse, 0.7},
      {{.name = "2 % lapses, 640", .lapse = 0.02}, FindingKind::lapse, 0},
      {{.name = "2 % lapses, 6400", .trials_per_size = 800, .lapse = 0.02}, FindingKind::lapse, 0.9},
      {{.name = "acuity as size, slope 2, 640", .slope = 2, .truth = acuity}, FindingKind::deviance, 0},
      {{.name = "acuity as size, slope 2, 6400", .trials_per_size = 800, .slope = 2, .truth = acuity},
       FindingKind::deviance,
       0.9},
      {{.name = "acuity as size, slope 3.5, 640", .truth = acuity}, FindingKind::deviance, 0},
      {{.name = "acuity as size, slope 3.5, 6400", .trials_per_size = 800, .truth = acuity},
       FindingKind::deviance,
       0.9},
      {{.name = "size as acuity, slope 3.5, 640", .fitted = acuity}, FindingKind::deviance, 0},
      {{.name = "size as acuity, slope 3.5, 6400", .trials_per_size = 800, .fitted = acuity},
       FindingKind::deviance,
       0.9},
      {{.name = "variance x 2, 8 x 80", .overdispersion = 2}, FindingKind::overdispersion, 0},
      {{.name = "variance x 2, 20 x 96", .sizes = 20, .trials_per_size = 96, .overdispersion = 2},
       FindingKind::overdispersion,
       0},
      {{.name = "variance x 2, 8 x 10 rows of 16", .trials_per_size = 16, .overdispersion = 2, .rows = 10},
       FindingKind::overdispersion,
       0.8},
      {{.name = "variance x 4, 8 x 80", .overdispersion = 4}, FindingKind::overdispersion, 0},
  };
  constexpr int replicates = 500;
  for (const Row& row : rows) {
    const FindingShares shares = finding_shares(row.design, replicates, 13);

    print(row.design, shares);
    const auto found = shares.found.find(row.kind);
    EXPECT_GE(found == shares.found.end() ? 0 : found->second, row.at_least) << row.design.name;
  }
}

TEST(AdequacyStudy, OfAFitByTheFunctionOfTheTwin) {
  constexpr int runs = 2000;
  std::printf("| lapse | twist | deviance | lapse | overdispersion | underdispersion | unfit |\n");
  for (const auto& [lapse, twist] : {std::pair(0.0, 0.0), std::pair(0.05, 0.0), std::pair(0.0, 1.0)}) {
    std::map<FindingKind, int> found;
    int unfit = 0;
    for (int run = 1; run <= runs; ++run) {
      const Adequacy result = adequacy(point_by_twin(static_cast<std::uint64_t>(run), lapse, twist), {});
      for (const AdequacyFinding& finding : result.findings) ++found[finding.kind];
      unfit += result.adequate() ? 0 : 1;
    }
    std::printf("| %g | %g |", lapse, twist);
    for (const FindingKind kind :
         {FindingKind::deviance, FindingKind::lapse, FindingKind::overdispersion, FindingKind::underdispersion})
      std::printf(" %.2f %% |", 100.0 * found[kind] / runs);
    std::printf(" %.2f %% |\n", 100.0 * unfit / runs);
    if (lapse == 0 && twist == 0) {
      EXPECT_LT(unfit, 0.018 * runs + 3 * std::sqrt(0.018 * runs));
    }
  }
}

}  // namespace
}  // namespace todbench
