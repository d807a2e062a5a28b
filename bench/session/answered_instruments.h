// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the instruments of a plan with the instruments that answered.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/plan/plan.h"

namespace todbench {

/// An instrument that is named in the description of a target.
struct AnsweredInstrument {
  std::string role;    ///< "black body"
  std::string serial;  ///< empty: the instrument does not state one
  bool operator==(const AnsweredInstrument&) const = default;
};

/// Returns the instruments of a description "ROLE (VENDOR MODEL, serial S); ROLE (...)".
[[nodiscard]] std::vector<AnsweredInstrument> answered_instruments(std::string_view target);

/// Returns a sentence for each row that does not belong to the instrument on the bench. Such a row states a serial
/// number, but the instrument of its role answered with a serial number that no row states.
[[nodiscard]] std::vector<std::string> contradicted_instruments(std::span<const InstrumentPlan> rows,
                                                                std::string_view target);

}  // namespace todbench
