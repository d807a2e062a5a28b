// A bench with a differential black body and a plate stage, each with the words of its table. The shipped tables
// scpi-black-body.toml and scpi-stage.toml are what the emulated instruments understand.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "tod/instruments/instrument_table.h"
#include "tod/instruments/scpi_client.h"
#include "tod/presentation/target.h"
#include "tod/presentation/target_wait.h"

namespace todbench {

struct ScpiTargetOptions {
  std::string black_body;  ///< instrument_address()
  std::string stage;       ///< the same
  InstrumentTable black_body_table;
  InstrumentTable stage_table;
  std::chrono::milliseconds settle_timeout{600'000};  ///< for one present(), by `now`
  std::chrono::milliseconds poll_interval{100};
  std::chrono::milliseconds report_interval{500};  ///< of on_wait, by `now`; the first after as long
  OnTargetWait on_wait{};
  ScpiClientOptions connection;
  /// Time base of settle_timeout and settling_s.
  std::function<std::chrono::steady_clock::time_point()> now = [] { return std::chrono::steady_clock::now(); };
};

/// Connects to both instruments, identifies them and reads their limits. Errors: as ScpiClient::connect.
///
/// present() asks each instrument for its set-points and commands only those that differ, so a knob turned by hand is
/// put right; one without set-points is commanded each time. It returns when both instruments say they are settled
/// *and* what they measure agrees with what was asked, for as long as their tables want.
/// PresentedTarget::state is what was measured. A state beyond the instruments' limits is `invalid_input` before
/// anything moves. `timeout` names the instrument, what was asked and what was reached. When an instrument goes away,
/// refuses a command or states a temperature that nothing can have (below 0 K, above 5000 K): `disconnected`; the next
/// present() connects anew and insists on the same *IDN?.
[[nodiscard]] Result<std::unique_ptr<Target>> open_scpi_target(ScpiTargetOptions options, const std::stop_token& stop);

}  // namespace todbench
