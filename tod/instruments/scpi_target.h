// SPDX-License-Identifier: GPL-3.0-or-later
// A bench with a differential black body and a plate stage, controlled by command tables. The emulated instruments
// understand the shipped tables scpi-black-body.toml and scpi-stage.toml.
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

/// Options of open_scpi_target().
struct ScpiTargetOptions {
  std::string black_body;  ///< address of the black body, as for instrument_address()
  std::string stage;       ///< address of the stage, as for instrument_address()
  InstrumentTable black_body_table;
  InstrumentTable stage_table;
  std::chrono::milliseconds settle_timeout{600'000};  ///< longest time for one present(), on the clock `now`
  std::chrono::milliseconds poll_interval{100};
  /// Time between calls of on_wait, and before the first call, on the clock `now`.
  std::chrono::milliseconds report_interval{500};
  OnTargetWait on_wait{};
  double settling_band = 0.1;  ///< largest relative deviation from the set contrast for ContrastWait::within_band
  /// Largest relative rate of the contrast for ContrastWait::within_band, 1/s. At the default rate, a lag of 0.1 s
  /// between the triangles of a plate changes the contrast by 0.6 %.
  double max_relative_rate_per_s = 0.06;
  /// States that a run will request. open_scpi_target() checks them against limits and plates of the instruments.
  std::vector<TargetState> requested{};
  /// Absolute temperatures that a run will request. open_scpi_target() checks them in the same way as `requested`.
  std::vector<double> temperatures_k{};
  ScpiClientOptions connection;
  /// Clock for settle_timeout and settling_s.
  std::function<std::chrono::steady_clock::time_point()> now = [] { return std::chrono::steady_clock::now(); };
};

/// Connects to both instruments, identifies them and reads their limits. Errors: those of ScpiClient::connect(), and
/// `invalid_input` for a requested state beyond the limits.
///
/// present() reads the set-points of each instrument and commands those that differ from the request. It therefore
/// corrects manual changes. An instrument without set-point queries is commanded each time. present() returns when two
/// conditions are met: both instruments report that they have settled, *and* the measured values have equalled the
/// requested values, within the tolerances, for the time that the tables require. PresentedTarget::state is the
/// measured state.
///
/// Errors of present(): `invalid_input` (state beyond the instruments' limits, reported before any motion), `timeout`
/// (the message contains the instrument, the requested and the reached value), `disconnected` (an instrument
/// disconnects, refuses a command or reports an impossible temperature: below 0 K or above 5000 K). After
/// `disconnected` the next present() reconnects and requires the same *IDN?.
[[nodiscard]] Result<std::unique_ptr<Target>> open_scpi_target(ScpiTargetOptions options, const std::stop_token& stop);

}  // namespace todbench
