// SPDX-License-Identifier: GPL-3.0-or-later
// Emulated differential black body: a plate of temperature T and a radiator behind it at T + difference, controlled
// over SCPI/TCP.
//
//   [SOURce:]TEMPerature:DIFFerence <K>|MIN|MAX      set-point of radiator minus plate; rounded to the resolution
//   [SOURce:]TEMPerature:DIFFerence? [MIN|MAX]       the set-point, or its limits
//   [SOURce:]TEMPerature:STABility:WINDow <K>, ?     largest distance from the set-point that counts as stable
//   [SOURce:]TEMPerature:ABSolute <K>|MIN|MAX        set-point of the radiator
//   [SOURce:]TEMPerature:ABSolute? [MIN|MAX]         the set-point, or its limits
//   MEASure:TEMPerature:DIFFerence?                  reading of the sensors, K
//   MEASure:TEMPerature:PLATe?  MEASure:TEMPerature:BBODy?   absolute temperatures, K
//   STATus:OPERation:CONDition?                      bit 1 (value 2, SETTling): not yet stable
//   *RST                                             set-point 0
// and *IDN?, *CLS, *OPC?, SYSTem:ERRor?, SYSTem:VERSion?. Bench black bodies (CI Systems, SBIR, HGH) offer the same
// quantities with their own commands.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>

#include "acquisition/base/result.h"
#include "sim_devices/lab/instruments/scpi_server.h"

namespace todbench {

/// Options of the instrument.
struct BlackBodyOptions {
  ScpiServerOptions server;
  std::string serial = "BB-0001";
  double time_constant_s = 4;                      ///< time constant of the first-order approach to a set-point; > 0
  double stable_window_k = 0.001;                  ///< stable if |sensor - set-point| stays below this ...
  double stable_dwell_s = 0.5;                     ///< ... for this time
  double min_delta_t_k = -25, max_delta_t_k = 25;  ///< limits of the set-point
  double resolution_k = 0.001;                     ///< resolution of the set-point
  double ambient_k = 295;                          ///< temperature of the plate at a difference of zero
  /// The radiator heats the plate in front of it: plate = ambient + coupling * difference.
  double plate_coupling = 0.02;
  /// Reports absolute temperatures in degrees Celsius, contrary to the table of the instrument.
  bool celsius = false;
  /// Error of the sensor: returns the real difference in K for the indicated difference `indicated_k`. The result must
  /// be finite. Called from any thread. Empty: a perfectly calibrated instrument.
  std::function<double(double indicated_k)> real_delta_t_k{};
  /// Time base of the settling. Called from any thread. Never runs backwards.
  std::function<std::chrono::steady_clock::time_point()> now = [] { return std::chrono::steady_clock::now(); };
};

/// State of the instrument at one moment.
struct BlackBodyState {
  double delta_t_k = 0;            ///< real temperature difference, which a camera observes
  double indicated_delta_t_k = 0;  ///< reading of the sensors
  double set_point_k = 0;
  double plate_temperature_k = 0, black_body_temperature_k = 0;  ///< real
  bool is_stable = true;
};

/// Instrument that serves clients from creation to destruction. The instrument starts stable at a difference of 0.
/// After a set-point s at time 0 the difference is d(t) = s + (d(0) - s) exp(-t / tau), tau: time_constant_s, without
/// overshoot. When the difference is stable, the remaining change is below the window.
class BlackBody {
  struct Settling {
    double start_k = 0, set_point_k = 0;  ///< as indicated
    std::chrono::steady_clock::time_point since;
    double window_k = 0;
  };

 public:
  /// Starts the instrument. Errors: `invalid_input` (options), `not_found` (address in use).
  [[nodiscard]] static Result<std::unique_ptr<BlackBody>> start(BlackBodyOptions options);
  /// For start() only.
  BlackBody(BlackBodyOptions options, Settling settling);
  BlackBody(const BlackBody&) = delete;
  BlackBody& operator=(const BlackBody&) = delete;
  ~BlackBody() = default;

  /// Returns the present state, for an emulated camera that observes the settling. Any thread.
  [[nodiscard]] BlackBodyState state() const;
  /// Returns "address:port". Any thread.
  [[nodiscard]] std::string endpoint() const { return server_->endpoint(); }

 private:
  [[nodiscard]] ScpiLanguage language();
  [[nodiscard]] double indicated(const Settling& settling, std::chrono::steady_clock::time_point time) const;
  [[nodiscard]] Settling settling() const;
  void set_point(double delta_t_k);
  /// Return the temperature of the radiator at an indicated difference, and the inverse.
  [[nodiscard]] double radiator_k(double delta_t_k) const;
  [[nodiscard]] double difference_k(double radiator_k) const;

  const BlackBodyOptions options_;
  mutable std::mutex mutex_;
  Settling settling_;                   // under mutex_
  std::unique_ptr<ScpiServer> server_;  // last: its thread ends before the members that its commands use
};

}  // namespace todbench
