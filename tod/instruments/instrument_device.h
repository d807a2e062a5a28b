// SPDX-License-Identifier: GPL-3.0-or-later
// A black body and a plate stage, controlled by command tables. Numbers are in K and mm; plates are identified by name.
#pragma once

#include <array>
#include <opencv2/core/types.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/instruments/instrument_table.h"
#include "tod/instruments/scpi_client.h"
#include "tod/presentation/target.h"

namespace todbench {

/// An instrument. After a lost connection the object reconnects and requires the same identity. Error messages contain
/// the name of the instrument. If the instrument refuses a command or query of its table, the error is `disconnected`.
/// One thread at a time.
class InstrumentDevice {
 public:
  InstrumentDevice(std::string role, std::string endpoint, ScpiClientOptions options, InstrumentTable table);

  [[nodiscard]] Result<void> ensure_connected(const std::stop_token& stop);
  /// Returns "black body (vendor model, serial S)".
  [[nodiscard]] std::string name() const;
  [[nodiscard]] const InstrumentTable& table() const { return table_; }
  [[nodiscard]] const std::optional<ScpiClient>& client() const { return client_; }

  [[nodiscard]] Result<void> send(const std::string& text, const std::stop_token& stop);
  [[nodiscard]] Result<std::string> ask(const std::string& text, const std::stop_token& stop);
  /// Returns the numbers in the answer to a query, not converted. Error: `disconnected` (not `count` numbers).
  [[nodiscard]] Result<std::vector<double>> numbers(const NumberQuestion& question, std::size_t count,
                                                    const std::stop_token& stop);
  /// Returns whether the instrument has settled. Also true if the table has no query for it.
  [[nodiscard]] Result<bool> is_settled(const std::stop_token& stop);

 private:
  std::string role_, endpoint_;
  ScpiClientOptions options_;
  InstrumentTable table_;
  std::optional<ScpiClient> client_;  ///< kept after the connection is closed, because the client stores the identity
};

/// Values reported by a black body.
struct BlackBodyReading {
  double delta_t_k = 0;
  std::optional<double> plate_k, radiator_k;
};

/// A black body. Differences and temperatures are in K.
class BlackBodyDevice : public InstrumentDevice {
 public:
  using InstrumentDevice::InstrumentDevice;
  /// Returns the lowest and the highest difference, in K.
  [[nodiscard]] Result<std::array<double, 2>> limits(const std::stop_token& stop);
  [[nodiscard]] Result<double> set_point(const std::stop_token& stop);
  /// Commands a temperature difference. Sends no command if this difference is already the set-point.
  [[nodiscard]] Result<void> command(double delta_t_k, const std::stop_token& stop);
  [[nodiscard]] Result<BlackBodyReading> read(const std::stop_token& stop);
  [[nodiscard]] Result<double> measured(const std::stop_token& stop);
  /// Reads a temperature. Errors: `disconnected` for an impossible temperature (below 0 K, above 5000 K).
  [[nodiscard]] Result<double> temperature(const NumberQuestion& question, const std::stop_token& stop);

  [[nodiscard]] std::string set_command(double delta_t_k) const;

  /// Returns the lowest and the highest absolute set-point, in K. Precondition, also of command_absolute(): the table
  /// has an absolute set-point.
  [[nodiscard]] Result<std::array<double, 2>> absolute_limits(const std::stop_token& stop);
  [[nodiscard]] Result<void> command_absolute(double temperature_k, const std::stop_token& stop);
  /// Reads the temperature of the radiator. Errors: those of temperature(), and `invalid_input` if the value is far
  /// below the coldest set-point, because its unit is then degrees Celsius.
  [[nodiscard]] Result<double> radiator(double coldest_k, const std::stop_token& stop);

 private:
  [[nodiscard]] const BlackBodyWords& words() const { return table().black_body; }
  [[nodiscard]] Result<double> difference(const NumberQuestion& question, const std::stop_token& stop);
};

/// Positions and plates that a stage can present.
struct StageLimits {
  cv::Point2d min_mm, max_mm;
  std::vector<std::string> plates;
};

/// A plate stage. Positions are in mm.
class StageDevice : public InstrumentDevice {
 public:
  using InstrumentDevice::InstrumentDevice;
  [[nodiscard]] Result<StageLimits> limits(const std::stop_token& stop);
  [[nodiscard]] bool holds(Mounting mounting) const;
  /// Commands plate, mounting and position, if they differ from the set-points.
  [[nodiscard]] Result<void> command(const TargetState& state, const std::stop_token& stop);
  /// Reads plate, mounting and position. Values that the stage does not report are copied from `asked`.
  [[nodiscard]] Result<TargetState> read(const TargetState& asked, const std::stop_token& stop);

  [[nodiscard]] Result<std::string> plate(const std::string& query, const std::stop_token& stop);
  [[nodiscard]] Result<Mounting> mounting(const std::string& query, const std::stop_token& stop);
  /// Returns the lowest and the highest speed of a run, in mm/s. Precondition, also of run_along_x(): the stage has
  /// runs.
  [[nodiscard]] Result<std::array<double, 2>> run_speeds(const std::stop_token& stop);
  /// Commands a run along x and returns the run that the stage reports.
  [[nodiscard]] Result<PlateRun> run_along_x(double to_mm, double speed_mm_s, const std::stop_token& stop);
  /// Reads a position. Precondition: the stage has positions.
  [[nodiscard]] Result<cv::Point2d> position(const NumberQuestion& question, const std::stop_token& stop);
  [[nodiscard]] Result<std::vector<double>> travel(const std::stop_token& stop);
  [[nodiscard]] Result<std::vector<std::string>> plate_names(const std::stop_token& stop);

  [[nodiscard]] std::string plate_command(const std::string& plate) const;
  [[nodiscard]] std::string mounting_command(Mounting mounting) const;
  [[nodiscard]] std::vector<std::string> position_commands(cv::Point2d place_mm) const;

 private:
  [[nodiscard]] const StageWords& words() const { return table().stage; }
  [[nodiscard]] Result<void> command_plate(const TargetState& state, const std::stop_token& stop);
  [[nodiscard]] Result<void> command_mounting(const TargetState& state, const std::stop_token& stop);
  [[nodiscard]] Result<void> command_position(const TargetState& state, const std::stop_token& stop);
};

}  // namespace todbench
