// An emulated differential black body: a plate of temperature T and a radiator behind it at T + difference, controlled
// over SCPI/TCP.
//
//   [SOURce:]TEMPerature:DIFFerence <K>|MIN|MAX      set-point of radiator minus plate; rounded to the resolution
//   [SOURce:]TEMPerature:DIFFerence? [MIN|MAX]       the set-point, or its limits
//   [SOURce:]TEMPerature:STABility:WINDow <K>, ?     how near the set-point counts as stable
//   MEASure:TEMPerature:DIFFerence?                  what the sensors say now, K
//   MEASure:TEMPerature:PLATe?  MEASure:TEMPerature:BBODy?   absolute temperatures, K
//   STATus:OPERation:CONDition?                      bit 1 (value 2, SETTling): not yet stable
//   *RST                                             set-point 0
// beside *IDN?, *CLS, *OPC?, SYSTem:ERRor?, SYSTem:VERSion?. Bench black bodies (CI Systems, SBIR, HGH) offer the same
// quantities under their own words.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>

#include "acquisition/core/result.h"
#include "sim_devices/lab/instruments/scpi_server.h"

namespace todbench {

struct BlackBodyOptions {
  ScpiServerOptions server;
  std::string serial = "BB-0001";
  double time_constant_s = 4;      ///< of the first-order approach to a set-point; > 0
  double stable_window_k = 0.001;  ///< |sensor - set-point| below which it counts as stable ...
  double stable_dwell_s = 0.5;     ///< ... once it has lasted this long
  double min_delta_t_k = -25, max_delta_t_k = 25;
  double resolution_k = 0.001;  ///< of the set-point
  double ambient_k = 295;       ///< of the plate when the difference is zero
  /// The radiator heats the plate before it: plate = ambient + coupling * difference.
  double plate_coupling = 0.02;
  /// A sensor that is not exact: the real difference where it says `indicated_k`, K. Called from any thread; finite.
  /// Empty: a perfectly calibrated instrument.
  std::function<double(double indicated_k)> real_delta_t_k{};
  /// Time base of the settling; called from any thread. Never runs backwards.
  std::function<std::chrono::steady_clock::time_point()> now = [] { return std::chrono::steady_clock::now(); };
};

/// The instrument at one moment.
struct BlackBodyState {
  double delta_t_k = 0;            ///< real temperature difference: what a camera sees
  double indicated_delta_t_k = 0;  ///< what the sensors say
  double set_point_k = 0;
  double plate_temperature_k = 0, black_body_temperature_k = 0;  ///< real
  bool is_stable = true;
};

/// Serves from creation to destruction; starts stable at a difference of 0. The difference follows a set-point s set at
/// time 0 as d(t) = s + (d(0) - s) exp(-t/tau), so it never overshoots, and what is still to come once it is stable is
/// below the window.
class BlackBody {
  struct Settling {
    double start_k = 0, set_point_k = 0;  ///< as the sensors say
    std::chrono::steady_clock::time_point since;
    double window_k = 0;
  };

 public:
  /// Errors: `invalid_input` (options), `not_found` (address in use).
  [[nodiscard]] static Result<std::unique_ptr<BlackBody>> start(BlackBodyOptions options);
  /// For start() only.
  BlackBody(BlackBodyOptions options, Settling settling);
  BlackBody(const BlackBody&) = delete;
  BlackBody& operator=(const BlackBody&) = delete;
  ~BlackBody() = default;

  /// The state now. Any thread; this is how an emulated camera sees the temperature drift while it settles.
  [[nodiscard]] BlackBodyState state() const;
  /// "address:port". Any thread.
  [[nodiscard]] std::string endpoint() const { return server_->endpoint(); }

 private:
  [[nodiscard]] ScpiLanguage language();
  [[nodiscard]] double indicated(const Settling& settling, std::chrono::steady_clock::time_point time) const;
  [[nodiscard]] Settling settling() const;
  void set_point(double delta_t_k);

  const BlackBodyOptions options_;
  mutable std::mutex mutex_;
  Settling settling_;                   // under mutex_
  std::unique_ptr<ScpiServer> server_;  // last: its thread ends before what its commands use
};

}  // namespace todbench
