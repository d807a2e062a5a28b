// An emulated plate stage: a changer with named slots, a turning mount and an x/y table, controlled over SCPI/TCP.
//
//   ROUTe:PLATe "name"      ROUTe:PLATe?      ROUTe:PLATe:ACTual?      asked for / in the beam now
//   ROUTe:PLATe:CATalog?                                               -> "name","name",...
//   ROUTe:MOUNting IDENtity|ROTated|HMIRrored|VMIRrored   ROUTe:MOUNting?   ROUTe:MOUNting:ACTual?   answers in short
//   form [SOURce:]POSition <x>,<y>   [SOURce:]POSition?                     set-point in mm, rounded to the resolution
//   [SOURce:]POSition:LIMits?                                          -> x min,x max,y min,y max in mm
//   MEASure:POSition?                                                  encoders now, mm
//   [SOURce:]SCAN <x>,<speed>                                          run along x at constant speed, mm and mm/s
//   [SOURce:]SCAN:LIMits?                                              -> lowest,highest speed
//   MEASure:SCAN?                                                      -> from,to,speed,start: of the last run; when it
//   began in s of the clock that stamps the camera's frames, 9.91E37 without a trigger
//   STATus:OPERation:CONDition?                                        bit 1 (value 2, SETTling): moving, or not yet at
//   rest *RST                                                               position 0,0; plate and mounting stay
// beside *IDN?, *CLS, *OPC?, SYSTem:ERRor?, SYSTem:VERSion?. x is to the right and y down, as the camera sees the
// plate.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <opencv2/core/types.hpp>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "sim_devices/lab/instruments/scpi_server.h"
#include "tod/plate/target_plate.h"
#include "tod/presentation/moving_target.h"

namespace todbench {

struct PlateStageOptions {
  ScpiServerOptions server;
  std::string serial = "PS-0001";
  std::vector<std::string> plates;  ///< names of the slots, distinct; the first is in the beam at the start
  double travel_mm = 5;             ///< either side of the middle, on both axes
  double speed_mm_per_s = 10;
  double settle_s = 0.2;         ///< from arrival to rest
  double resolution_mm = 0.001;  ///< of the set-point
  double plate_change_s = 5;
  double mounting_change_s = 3;
  double slowest_run_mm_per_s = 0.01;  ///< the fastest has the speed of the table
  double run_jitter_mm = 0;            ///< standard deviation of the place in a run, anew every millisecond
  std::uint64_t seed = 1;              ///< of the jitter
  /// Time base of runs, seconds: the clock that stamps the camera's frames, now. Called from any thread. Empty: `now`.
  std::function<double()> camera_clock_s = {};
  bool has_trigger = true;  ///< whether MEASure:SCAN? tells when a run began in the camera's clock
  /// Time base of all movements; called from any thread. Never runs backwards.
  std::function<std::chrono::steady_clock::time_point()> now = [] { return std::chrono::steady_clock::now(); };
};

/// The stage at one moment.
struct PlateStageState {
  std::string plate;                       ///< in the beam; the old one until the change is complete
  Mounting mounting = Mounting::identity;  ///< likewise
  cv::Point2d shift_mm{0, 0};
  double speed_mm_per_s = 0;  ///< of a run, along x with its sign; 0: none, however the table moves
  bool is_moving = false;     ///< anything moves or is not yet at rest
};

/// Serves from creation to destruction. The table runs to a new position in a straight line at constant speed, from
/// wherever it is.
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
    Change<cv::Point2d> position;  ///< duration of the run, without the time to come to rest
    std::optional<PlateRun> run;   ///< the last one, over or not, until the table is sent elsewhere
  };

 public:
  /// Errors: `invalid_input` (options), `not_found` (address in use).
  [[nodiscard]] static Result<std::unique_ptr<PlateStage>> start(PlateStageOptions options);
  /// For start() only.
  PlateStage(PlateStageOptions options, Motion motion);
  PlateStage(const PlateStage&) = delete;
  PlateStage& operator=(const PlateStage&) = delete;
  ~PlateStage() = default;

  /// The state now. Any thread; this is how an emulated camera sees the plate move.
  [[nodiscard]] PlateStageState state() const { return state_at(camera_time_s()); }
  /// The same with runs where they are at another time of the camera's clock.
  [[nodiscard]] PlateStageState state_at(double camera_time_s) const;
  /// "address:port". Any thread.
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
  std::unique_ptr<ScpiServer> server_;  // last: its thread ends before what its commands use
};

}  // namespace todbench
