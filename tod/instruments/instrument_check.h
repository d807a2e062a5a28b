// SPDX-License-Identifier: GPL-3.0-or-later
// Checks whether an instrument agrees with its table. Commands and queries are sent one at a time.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/instruments/instrument_table.h"
#include "tod/instruments/scpi_client.h"

namespace todbench {

/// Outcome of a step.
enum class StepOutcome {
  answered,   ///< the answer agrees with the table
  failed,     ///< no answer, or an answer that differs from the table
  not_tried,  ///< the instrument was not reached, or the table has no such command or query
};

/// One step of the check.
struct InstrumentStep {
  std::string name;  ///< "measured difference"
  std::string sent;  ///< commands as sent, joined by "; "
  StepOutcome outcome = StepOutcome::not_tried;
  std::string said;  ///< answer in the units of this program, or an error message
};

/// Result of check_instrument().
struct InstrumentCheck {
  ScpiIdentity identity;  ///< empty if the instrument was not reached
  bool reached = false;   ///< connected and identified
  std::vector<InstrumentStep> steps;
  /// Returns true if the instrument was reached and no step failed.
  [[nodiscard]] bool passed() const;
};

/// Commands that a check sends.
enum class InstrumentCommands {
  none,      ///< queries only: no motion
  in_place,  ///< queries and commands; each command sets the present value of the instrument
};

/// Checks an instrument. Continues after a failed step and reconnects if needed. Errors: `invalid_input` (address),
/// `interrupted`.
[[nodiscard]] Result<InstrumentCheck> check_instrument(const InstrumentTable& table, const std::string& address,
                                                       InstrumentCommands commands, const ScpiClientOptions& options,
                                                       const std::stop_token& stop);

}  // namespace todbench
