// SPDX-License-Identifier: GPL-3.0-or-later
// Fits a psychometric function to a CSV file with the columns size,correct,total: fit_csv FILE
#include <fmt/core.h>

#include <fstream>
#include <string>

#include "tod/psychometric/psychometric_fit.h"

using namespace todbench;

int main(int argc, char** argv) {
  std::ifstream file(argc > 1 ? argv[1] : "trials.csv");
  std::string header;
  std::getline(file, header);
  if (header != "size,correct,total") return fmt::print(stderr, "expected the columns size,correct,total\n"), 2;
  std::vector<Level> levels;
  char comma = ',';
  for (Level level; file >> level.size >> comma >> level.correct >> comma >> level.total;) levels.push_back(level);
  const auto fit = fit_psychometric(levels, {});
  if (!fit) return fmt::print(stderr, "{}\n", fit.error().message), 2;
  // A fit without a threshold says why; an open side of the interval has no value.
  fmt::print("verdict {}\n", to_string(fit->verdict));
  if (!fit->usable()) return 3;
  fmt::print("S75 {:.4f}, 95 % {:.4f} to {:.4f}\n", *fit->threshold, *fit->ci95.low, *fit->ci95.high);
}
