// A bench with a differential black body and a plate stage that both speak SCPI over TCP.
//
// Black body                                   Plate stage
//   [SOURce:]TEMPerature:DIFFerence <K>          ROUTe:PLATe "name"          ROUTe:PLATe:ACTual?
//   [SOURce:]TEMPerature:DIFFerence? [MIN|MAX]   ROUTe:PLATe:CATalog?        -> "name","name",...
//   MEASure:TEMPerature:DIFFerence?  -> K        ROUTe:MOUNting IDENtity|ROTated|HMIRrored|VMIRrored, :ACTual?
//   MEASure:TEMPerature:PLATe?       -> K        [SOURce:]POSition <x mm>,<y mm>, POSition?, POSition:LIMits? ->
//   x0,x1,y0,y1 MEASure:TEMPerature:BBODy?       -> K        MEASure:POSition?           -> x,y
//   STATus:OPERation:CONDition?  bit 1 SETTling  STATus:OPERation:CONDition? bit 1 SETTling (moving or not yet at rest)
// and both *IDN?, *CLS, SYSTem:ERRor? (IEEE 488.2, SCPI-99 volume 1, 20.1).
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "tod/instruments/scpi_client.h"
#include "tod/presentation/target.h"
#include "tod/presentation/target_wait.h"

namespace todbench {

struct ScpiTargetOptions {
  std::string black_body;  ///< "host:port"
  std::string stage;       ///< "host:port"
  /// Measured minus asked that still counts as reached: twice the 1 mK resolution of the differential black-body class.
  double delta_t_tolerance_k = 0.002;
  double shift_tolerance_mm = 0.005;
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
/// put right. It returns when both instruments say they are settled *and* what they measure agrees with what was asked.
/// PresentedTarget::state is what was measured. A state beyond the instruments' limits is `invalid_input` before
/// anything moves. `timeout` names the instrument, what was asked and what was reached. When an instrument goes away,
/// refuses a command or states a temperature that nothing can have (below 0 K, above 5000 K): `disconnected`; the next
/// present() connects anew and insists on the same *IDN?.
[[nodiscard]] Result<std::unique_ptr<Target>> open_scpi_target(ScpiTargetOptions options, const std::stop_token& stop);

}  // namespace todbench
