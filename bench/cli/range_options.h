// SPDX-License-Identifier: GPL-3.0-or-later
// Options of `todbench range` other than the TOD curve: air, other models and their curves, figures.
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

/// Options of `todbench range`.
struct RangeOptions {
  std::string atmosphere,   ///< name or file of the air path (load_atmosphere())
      haze = "rural-23km",  ///< aerosol of the built-in atmospheres
      band,                 ///< spectral band LOW-HIGH in um; empty: band of the sensor
      sensor,               ///< name or file of the sensor of the formula models; empty: sensor of the session
      mrtd_file,            ///< CSV file that replaces the MRTD formula; empty: none
      mtdp_file,            ///< CSV file that replaces the formula of the MTDP-like curve; empty: none
      ctf_file,             ///< CSV file that replaces the CTF formula; empty: none
      svg,                  ///< output file of the figure; empty: none
      page;                 ///< output file of the page; empty: none
  /// Transfer that converts the TOD thresholds to the MTDP-like curve; empty: the curve comes from the formula or a
  /// file.
  std::optional<TodTransfer> transfer{};
  /// Models to evaluate.
  std::vector<RangeModel> models{RangeModel::tod};
  std::optional<double> background_k,  ///< background temperature; if stated, radiances determine the contrast
      air_k,                           ///< air temperature; empty: temperature of the model atmosphere
      surround_k,                      ///< temperature of the reflected surround; empty: background temperature
      target_contrast;                 ///< luminance contrast of the target for TTP; empty: |dT| / (2 scene contrast)
  /// Emissivity of target and background.
  double emissivity = 1;
  /// Contrast of the target in K, as stated on the command line.
  double asked_delta_t_k = 0;
  /// Source of the criteria M75 (RangeTask::m75) and V50 (value of the TTP metric for a probability of 50 %).
  CriterionSource criterion_source = CriterionSource::published;
  /// Observer of the TOD curve of the session; empty: no session.
  std::string curve_observer{};
  /// Phrase for the result that describes the M75 of --m75-of and names the observers who identified the targets, the
  /// set of targets, and the observer of the TOD curve.
  std::string m75_observer{};
  double n50 = 6,                ///< cycles on the target for a probability of 50 % in ACQUIRE
      mtdp_n50 = 6,              ///< cycles on the target for a probability of 50 % in the MTDP-like model
      extinction_u_percent = 0,  ///< relative standard uncertainty of the extinction; widens the intervals
      curve_u_percent = 0;  ///< relative standard uncertainty of MRTD, MTDP-like and CTF thresholds; widens intervals
  /// Relative standard uncertainty of M75 in percent, which widens the interval of the TOD model.
  double m75_u_percent = 0;
  double cn2 = 0,             ///< structure parameter of the turbulence along the path, m^(-2/3); 0: no turbulence
      tolerance_percent = 1;  ///< change of the acuity below which the TOD model skips turbulence
  /// Grid of targets. Without sizes no grid is computed.
  RangeGridAxes grid{};
  /// Parameters of the formula models.
  FormulaConditions formula{};

  /// Adds the options. This object must outlive the parser.
  void add_to(CLI::App& command);

  /// Returns whether a model is requested.
  [[nodiscard]] bool asks(RangeModel model) const;
  /// Returns whether the air path is a tabulated atmosphere and not a single extinction coefficient.
  [[nodiscard]] bool has_table() const;
  /// Returns the sensor that --sensor names. Without this option, returns the sensor of the session, with the microscan
  /// of the session's plan; empty if there is no session. Errors: those of load_sensor().
  [[nodiscard]] Result<std::optional<SensorSpec>> sensor_of(const std::optional<Session>& session) const;
  /// Returns the air path that --atmosphere and --haze select. Without --band, the band of the sensor applies.
  /// `extinction_per_km`: coefficient of the default atmosphere "beer-lambert". Errors: band_of(), load_atmosphere().
  [[nodiscard]] Result<Atmosphere> air(const std::optional<SensorSpec>& sensor, double extinction_per_km) const;
  /// Converts the radiances of target and background to a contrast in kelvin on the NETD scale. Returns `delta_t_k`
  /// unchanged if no background is given.
  [[nodiscard]] Result<double> equivalent_contrast_k(double delta_t_k, const std::optional<SensorSpec>& sensor,
                                                     const Atmosphere& air) const;
  /// Returns the inputs that all models share.
  [[nodiscard]] RangeQuestion question(const RangeTask& task, std::optional<double> v50, const Atmosphere& air) const;
  /// Returns the curves and the sensor that the models use.
  [[nodiscard]] Result<RangeSources> sources(std::vector<TodThreshold> thresholds,
                                             const std::optional<SensorSpec>& sensor) const;
  /// Writes the figure of --svg and the page of --page, if requested. `said`: sentences about the results, which are
  /// printed on the page. Errors: those of the figure; `io`.
  [[nodiscard]] Result<void> write(const std::vector<ModelRange>& models, const RangeQuestion& question,
                                   const std::vector<std::string>& said, const Json& grids) const;

  /// Returns the requested grid as JSON; null if none is requested.
  [[nodiscard]] Result<Json> grid_json(const RangeSources& sources, const RangeQuestion& question,
                                       const std::optional<SensorSpec>& sensor) const;

  /// Returns the band of the options; if absent, the band of the sensor. Errors: `invalid_input` for an invalid band.
  [[nodiscard]] Result<SpectralBand> band_of(const std::optional<SensorSpec>& sensor) const;
  /// Returns the radiative scene. Precondition: a background is given.
  [[nodiscard]] RadiativeScene scene(double delta_t_k, const Atmosphere& air) const;
};

/// Returns the value of the key "atmosphere": name, source, and effect at the 75 % range of the TOD model.
[[nodiscard]] Json atmosphere_json(const Atmosphere& air, const RangeTask& task, std::optional<double> r75_m,
                                   const RangeOptions& options, const std::optional<SensorSpec>& sensor);
/// Returns the value of the key "models": the results by name.
[[nodiscard]] Json models_json(const std::vector<ModelRange>& models, const RangeSources& sources,
                               const RangeQuestion& question, std::optional<double> twin_r75_m);
/// Prints a table of R75 for every model of a grid.
void print_grid(Console& console, const Json& grid);
/// Prints the results of the models as a table.
void print_models(Console& console, const std::vector<ModelRange>& models);

}  // namespace todbench
