// SPDX-License-Identifier: GPL-3.0-or-later
// Emulated plate stage: a changer with named slots, a turning mount and an x/y table, controlled over SCPI/TCP.
//
//   ROUTe:PLATe "name"                                    selects a plate
//   ROUTe:PLATe?  ROUTe:PLATe:ACTual?                     -> selected plate; plate in the beam now
//   ROUTe:PLATe:CATalog?                                  -> "name","name",...
//   ROUTe:MOUNting IDENtity|ROTated|HMIRrored|VMIRrored   selects a mounting
//   ROUTe:MOUNting?  ROUTe:MOUNting:ACTual?               -> selected mounting; present mounting; in short form
//   [SOURce:]POSition <x>,<y>  [SOURce:]POSition?         set-point in mm, rounded to the resolution
//   [SOURce:]POSition:LIMits?                             -> x min,x max,y min,y max in mm
//   MEASure:POSition?                                     -> encoders now, mm
//   [SOURce:]SCAN <x>,<speed>                             runs along x at constant speed, mm and mm/s
//   [SOURce:]SCAN:LIMits?                                 -> lowest,highest speed
//   MEASure:SCAN?                                         -> from,to,speed,start of the last run
//   STATus:OPERation:CONDition?                           -> bit 1 (value 2, SETTling): moving, or not yet at rest
//   *RST                                                  position 0,0; plate and mounting stay
// and *IDN?, *CLS, *OPC?, SYSTem:ERRor?, SYSTem:VERSion?. The start of a run is in s of the clock that stamps the
// camera's frames, 9.91E37 without a trigger. x is to the right and y down in the picture of the camera.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <opencv2/core/types.hpp>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "sim_devices/lab/instruments/scpi_server.h"
#include "tod/plate/target_plate.h"
#include "tod/presentation/moving_target.h"

namespace todbench {

/// Options of the instrument.
struct PlateStageOptions {
  ScpiServerOptions server;
  std::string serial = "PS-0001";
  std::vector<std::string> plates;     ///< names of the slots, distinct; the first is in the beam at the start
  double travel_mm = 5;                ///< travel to either side of the middle, on both axes
  double speed_mm_per_s = 10;          ///< speed of the table
  double settle_s = 0.2;               ///< time from arrival to rest
  double resolution_mm = 0.001;        ///< resolution of the set-point
  double plate_change_s = 5;           ///< duration of a change of the plate
  double mounting_change_s = 3;        ///< duration of a change of the mounting
  double slowest_run_mm_per_s = 0.01;  ///< the fastest run has the speed of the table
  double run_jitter_mm = 0;            ///< sd of the position during a run, with a new random value every millisecond
  std::uint64_t seed = 1;              ///< seed of the jitter
  /// Error of the stage: returns the real position of the plate for the indicated position `indicated_mm`. The result
  /// must be finite. Called from any thread. Empty: no error. The owner of the scene applies this error; the encoders
  /// do not include it.
  std::function<cv::Point2d(cv::Point2d indicated_mm)> real_place_mm{};
  /// Time base of runs in seconds: returns the present time of the clock that stamps the camera's frames. Called from
  /// any thread. Empty: runs use `now`.
  std::function<double()> camera_clock_s = {};
  bool has_trigger = true;  ///< MEASure:SCAN? states the start of a run in the camera's clock
  /// Time base of all movements. Called from any thread. Never runs backwards.
  std::function<std::chrono::steady_clock::time_point()> now = [] { return std::chrono::steady_clock::now(); };
};

/// State of the stage at one moment.
struct PlateStageState {
  std::string plate;                       ///< plate in the beam; the old plate until the change is complete
  Mounting mounting = Mounting::identity;  ///< present mounting; the old mounting until the change is complete
  cv::Point2d shift_mm{0, 0};              ///< indicated position of the table; 0, 0: middle of the travel
  double speed_mm_per_s = 0;               ///< speed of a run along x, with sign; 0 for other movements of the table
  bool is_moving = false;                  ///< true if the table, the plate or the mounting moves or is not yet at rest
};

/// Instrument that serves clients from creation to destruction. The table moves to a new position in a straight line at
/// constant speed, starting from its present position.
class PlateStage {
  template <typename T>
  struct Change {  ///< `from` until `since` + `duration_s`, then `to`
    T from, to;
    std::chrono::steady_clock::time_point since;
    double duration_s = 0;
  };
  struct Motion {
    Change<std::string> plate;
    Change<Mounting> mounting;
    Change<cv::Point2d> position;  ///< travel only, without the time to come to rest
    std::optional<PlateRun> run;   ///< the last run, finished or not, until the table moves elsewhere
  };

 public:
  /// Starts the instrument. Errors: `invalid_input` (options), `not_found` (address in use).
  [[nodiscard]] static Result<std::unique_ptr<PlateStage>> start(PlateStageOptions options);
  /// For start() only.
  PlateStage(PlateStageOptions options, Motion motion);
  PlateStage(const PlateStage&) = delete;
  PlateStage& operator=(const PlateStage&) = delete;
  ~PlateStage() = default;

  /// Returns the present state, for an emulated camera that observes the movement. Any thread.
  [[nodiscard]] PlateStageState state() const { return state_at(camera_time_s()); }
  /// Returns the state at a given time of the camera's clock, because runs depend on this clock.
  [[nodiscard]] PlateStageState state_at(double camera_time_s) const;
  /// Returns "address:port". Any thread.
  [[nodiscard]] std::string endpoint() const { return server_->endpoint(); }

 private:
  [[nodiscard]] ScpiLanguage language();
  [[nodiscard]] std::vector<ScpiCommand> plate_commands();
  [[nodiscard]] std::vector<ScpiCommand> mounting_commands();
  [[nodiscard]] std::vector<ScpiCommand> position_commands();
  [[nodiscard]] Motion motion() const;
  [[nodiscard]] std::vector<ScpiCommand> run_commands();
  void move_to(cv::Point2d position_mm);
  [[nodiscard]] double camera_time_s() const;
  [[nodiscard]] cv::Point2d place_in(const Motion& motion, double camera_time_s) const;

  const PlateStageOptions options_;
  mutable std::mutex mutex_;
  Motion motion_;                       // under mutex_
  std::unique_ptr<ScpiServer> server_;  // last: its thread ends before the members that its commands use
};

}  // namespace todbench
