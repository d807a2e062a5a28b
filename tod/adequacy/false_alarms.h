// SPDX-License-Identifier: GPL-3.0-or-later
// Permitted probabilities of a false alarm of the model tests.
#pragma once

namespace todbench {

/// Probabilities with which a test exceeds its limit by chance.
struct FalseAlarms {
  double departure = 0, lapse = 0;
  double scatter = 0;  ///< for each of two tests: too much scatter, too little scatter
};

}  // namespace todbench
