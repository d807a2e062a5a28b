// SPDX-License-Identifier: GPL-3.0-or-later
// Options of `todbench range` besides the TOD curve: air, other models, their curves, figures.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/cli/console.h"
#include "bench/range/range_models.h"
#include "bench/session/session_folder.h"
#include "sim_devices/atmosphere/radiative_path.h"

namespace todbench {

struct RangeOptions {
  std::string atmosphere, haze = "rural-23km", band, sensor, mrtd_file, mtdp_file, ctf_file, svg, page;
  std::optional<TodTransfer> transfer{};
  std::vector<RangeModel> models{RangeModel::tod};
  std::optional<double> background_k, air_k, surround_k, target_contrast;
  double emissivity = 1;
  double asked_delta_t_k = 0;  ///< as on the command line
  CriterionSource criterion_source = CriterionSource::published;
  std::string curve_observer{};  ///< of the session; empty: none
  std::string m75_observer{};    ///< of the file of --m75-of
  double n50 = 6, mtdp_n50 = 6, extinction_u_percent = 0, curve_u_percent = 0;
  double m75_u_percent = 0;
  double cn2 = 0, tolerance_percent = 1;
  RangeGridAxes grid{};  ///< no sizes: no grid is requested
  FormulaConditions formula{};

  /// Adds the options; `this` outlives the parser.
  void add_to(CLI::App& command);

  [[nodiscard]] bool asks(RangeModel model) const;
  /// Whether the air is more than one coefficient.
  [[nodiscard]] bool has_table() const;
  /// Returns the sensor of --sensor, or that of the session with its microscan.
  [[nodiscard]] Result<std::optional<SensorSpec>> sensor_of(const std::optional<Session>& session) const;
  [[nodiscard]] Result<Atmosphere> air(const std::optional<SensorSpec>& sensor, double extinction_per_km) const;
  /// Returns the contrast of the target in kelvin at the scale of the NETD, converted once from the radiance of target
  /// and background; `delta_t_k` itself if no background is given.
  [[nodiscard]] Result<double> equivalent_contrast_k(double delta_t_k, const std::optional<SensorSpec>& sensor,
                                                     const Atmosphere& air) const;
  [[nodiscard]] RangeQuestion question(const RangeTask& task, std::optional<double> v50, const Atmosphere& air) const;
  [[nodiscard]] Result<RangeSources> sources(std::vector<TodThreshold> thresholds,
                                             const std::optional<SensorSpec>& sensor) const;
  /// Writes the requested figure and page; `said`: sentences about the results, for the page.
  [[nodiscard]] Result<void> write(const std::vector<ModelRange>& models, const RangeQuestion& question,
                                   const std::vector<std::string>& said, const Json& grids) const;

  /// Returns the requested grid as JSON; null if none is requested.
  [[nodiscard]] Result<Json> grid_json(const RangeSources& sources, const RangeQuestion& question,
                                       const std::optional<SensorSpec>& sensor) const;

  [[nodiscard]] Result<SpectralBand> band_of(const std::optional<SensorSpec>& sensor) const;
  /// Precondition: a background is given.
  [[nodiscard]] RadiativeScene scene(double delta_t_k, const Atmosphere& air) const;
};

/// "atmosphere": name, source, and effect at the 75 % range of the TOD model.
[[nodiscard]] Json atmosphere_json(const Atmosphere& air, const RangeTask& task, std::optional<double> r75_m,
                                   const RangeOptions& options, const std::optional<SensorSpec>& sensor);
/// "models": the results by name.
[[nodiscard]] Json models_json(const std::vector<ModelRange>& models, const RangeSources& sources,
                               const RangeQuestion& question, std::optional<double> twin_r75_m);
/// Prints a table of R75 for every model of a grid.
void print_grid(Console& console, const Json& grid);
void print_models(Console& console, const std::vector<ModelRange>& models);

}  // namespace todbench
