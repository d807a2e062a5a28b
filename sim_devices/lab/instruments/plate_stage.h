// An emulated plate stage: a changer with named slots, a turning mount and an x/y table, controlled over SCPI/TCP.
//
//   ROUTe:PLATe "name"      ROUTe:PLATe?      ROUTe:PLATe:ACTual?      asked for / in the beam now
//   ROUTe:PLATe:CATalog?                                               -> "name","name",...
//   ROUTe:MOUNting IDENtity|ROTated|HMIRrored|VMIRrored   ROUTe:MOUNting?   ROUTe:MOUNting:ACTual?   answers in short
//   form [SOURce:]POSition <x>,<y>   [SOURce:]POSition?                     set-point in mm, rounded to the resolution
//   [SOURce:]POSition:LIMits?                                          -> x min,x max,y min,y max in mm
//   MEASure:POSition?                                                  encoders now, mm
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
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "sim_devices/lab/instruments/scpi_server.h"
#include "tod/plate/target_plate.h"

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
  /// Time base of all movements; called from any thread. Never runs backwards.
  std::function<std::chrono::steady_clock::time_point()> now = [] { return std::chrono::steady_clock::now(); };
};

/// The stage at one moment.
struct PlateStageState {
  std::string plate;                       ///< in the beam; the old one until the change is complete
  Mounting mounting = Mounting::identity;  ///< likewise
  cv::Point2d shift_mm{0, 0};
  bool is_moving = false;  ///< anything moves or is not yet at rest
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
  [[nodiscard]] PlateStageState state() const;
  /// "address:port". Any thread.
  [[nodiscard]] std::string endpoint() const { return server_->endpoint(); }

 private:
  [[nodiscard]] ScpiLanguage language();
  [[nodiscard]] std::vector<ScpiCommand> plate_commands();
  [[nodiscard]] std::vector<ScpiCommand> mounting_commands();
  [[nodiscard]] std::vector<ScpiCommand> position_commands();
  [[nodiscard]] Motion motion() const;
  void move_to(cv::Point2d position_mm);

  const PlateStageOptions options_;
  mutable std::mutex mutex_;
  Motion motion_;                       // under mutex_
  std::unique_ptr<ScpiServer> server_;  // last: its thread ends before what its commands use
};

}  // namespace todbench
