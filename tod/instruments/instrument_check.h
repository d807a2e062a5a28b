// What an instrument answers to each word of its table, one after the other.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "tod/instruments/instrument_table.h"
#include "tod/instruments/scpi_client.h"

namespace todbench {

enum class StepOutcome {
  answered,   ///< as the table says
  failed,     ///< not, or not so
  not_tried,  ///< the instrument was not reached, or the table has no such words
};

/// One step of the talk.
struct InstrumentStep {
  std::string name;  ///< "measured difference"
  std::string sent;  ///< the words, several with "; "
  StepOutcome outcome = StepOutcome::not_tried;
  std::string said;  ///< what was understood, in the units of this program, or what went wrong, in a sentence
};

struct InstrumentCheck {
  ScpiIdentity identity;  ///< empty when it was not reached
  bool reached = false;   ///< connected and identified
  std::vector<InstrumentStep> steps;
  /// True when nothing failed and the instrument was reached.
  [[nodiscard]] bool passed() const;
};

enum class InstrumentCommands {
  none,      ///< questions only: nothing moves
  in_place,  ///< each command too, with the value that the instrument has
};

/// Talks to an instrument. A step that fails ends nothing: the next one connects anew where that is needed. Errors:
/// `invalid_input` (address), `interrupted`.
[[nodiscard]] Result<InstrumentCheck> check_instrument(const InstrumentTable& table, const std::string& address,
                                                       InstrumentCommands commands, const ScpiClientOptions& options,
                                                       const std::stop_token& stop);

}  // namespace todbench
