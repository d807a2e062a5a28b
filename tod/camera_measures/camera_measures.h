// SPDX-License-Identifier: GPL-3.0-or-later
// Physical measures of a camera with the source and the target of its TOD measurement.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/core/frame_source.h"
#include "tod/camera_measures/absolute_measure.h"
#include "tod/camera_measures/bars_measure.h"
#include "tod/camera_measures/drift_measure.h"
#include "tod/camera_measures/edge_measure.h"
#include "tod/camera_measures/gain_control.h"
#include "tod/camera_measures/mrtd_measure.h"
#include "tod/camera_measures/noise_measure.h"
#include "tod/camera_measures/pixel_measure.h"
#include "tod/camera_measures/plate_geometry.h"
#include "tod/camera_measures/response_measure.h"
#include "tod/camera_measures/source_size.h"
#include "tod/camera_measures/timing_measure.h"
#include "tod/camera_measures/triangle_strip.h"
#include "tod/measurement/measurement.h"
#include "tod/measures/signal_transfer.h"
#include "tod/measures/three_d_noise.h"

namespace todbench {

/// Options of measure_camera().
struct CameraMeasuresOptions {
  bool noise = false;                         ///< temporal noise, NETD and 3-D noise, at a contrast of 0
  int noise_frames = 64;                      ///< of the noise cube, at least 5
  std::optional<PixelOptions> pixels{};       ///< bad and substituted pixels in the noise cube; empty: not measured
  std::optional<double> drift_s{};            ///< duration after a correction, at a contrast of 0; empty: not measured
  std::optional<ResponseOptions> response{};  ///< time constant from steps of the first plate; empty: not measured
  bool geometry = false;                      ///< IFOV and distortion, from the picture in which the plate is located
  bool transfer = false;                      ///< signal transfer from the steps below
  std::vector<double> transfer_steps_k;       ///< contrasts to show, at least three
  std::vector<double> triangles_k{};          ///< contrasts at which the smallest triangles are shown; empty: none
  std::optional<TargetPlate> mtf_plate{};     ///< plate in identity mounting; empty: no MTF
  double mtf_delta_t_k = 10;                  ///< contrast at which it is shown
  int mtf_frames = 64;                        ///< averaged, at least 1
  double mtf_frequency_per_pitch = 0.25;      ///< frequency at which the MTF is stated, up to 1
  std::optional<TargetPlate> ctf_plate{};     ///< plate in identity mounting; empty: no CTF
  double ctf_delta_t_k = 10;                  ///< contrast at which it is shown
  int ctf_frames = 64;                        ///< averaged, at least 1
  double ctf_frequency_per_pitch = 0.4;       ///< the group with the nearest frequency is stated
  std::optional<TargetPlate> source_plate{};  ///< plate in identity mounting; empty: no size-of-source effect
  double source_delta_t_k = 10;               ///< contrast at which it is shown
  int source_frames = 64;                     ///< averaged, at least 1; without contrast twice as many
  double source_size_px = 10;                 ///< side of the square source whose loss is stated
  std::optional<AbsoluteOptions> absolute{};  ///< absolute temperatures; empty: not measured
  int timing_frames = 0;                      ///< frames whose times are examined; 0: not measured
  std::optional<LatencyOptions> latency{};    ///< runs of the stage; empty: not measured
  std::optional<MrtdOptions> mrtd{};  ///< response, IFOV and frames to locate the plate are filled in later; empty: no
                                      ///< MRTD
  /// Options of the automatic gain, measured with contrast steps of the first plate; empty: not measured.
  std::optional<ResponseOptions> gain_control{};
  /// Options of the TOD measurement: plates, frames to average, corrections, timeouts and integrity. The first plate is
  /// shown in identity mounting.
  MeasurementOptions measurement;
};

/// One step of the signal transfer.
struct TransferStep {
  double set_delta_t_k = 0, said_delta_t_k = 0;  ///< set-point, and value reported by the target
  double seen_delta_t_k = 0, seen_u_k = 0;       ///< contrast on the camera's scale; u from the scatter over triangles
};

/// Signal transfer from contrast steps.
struct TransferMeasure {
  int frames_each = 0;
  std::vector<TransferStep> steps;
  SignalTransfer line;  ///< observed over reported contrast: slope 1 if the camera's temperature scale is correct
  /// Returns the half-width of the slope's 95 % interval, by Student's t with the degrees of freedom of the steps.
  [[nodiscard]] double slope_half_width() const;
};

/// IFOV and distortion from the first plate.
struct GeometryMeasure {
  std::string plate;
  int frames = 0;
  double set_delta_t_k = 0;
  double distance_m = 0;        ///< to the plate
  double stated_ifov_mrad = 0;  ///< of the measurement
  double pixel_aspect = 1;      ///< of the measurement: height of a pixel over its width
  cv::Size picture{0, 0};
  PlateGeometry geometry;
  std::optional<double> distance_relative_u{};                          ///< standard uncertainty; empty: not stated
  std::optional<double> model_ifov_mrad{}, model_distortion_percent{};  ///< of a simulated sensor

  /// Returns the IFOV along x or y; the interval includes only the errors of the picture.
  [[nodiscard]] Estimate ifov_mrad(EdgeAxis axis) const;
  /// Returns the field of view between the outer borders of the first and the last pixel, through the middle of the
  /// picture. It uses the IFOV and the fitted distortion, extrapolated beyond the plate. The interval includes only the
  /// errors of the picture.
  [[nodiscard]] Estimate field_of_view_deg(EdgeAxis axis) const;
  /// Returns the IFOV along x divided by the IFOV along y. The distance cancels.
  [[nodiscard]] Estimate aspect_ratio() const;
};

/// MTF from a plate with rectangles.
struct MtfMeasure {
  std::string plate;
  int frames = 0;
  double set_delta_t_k = 0, said_delta_t_k = 0;
  double pitch_mrad = 0;           ///< IFOV of a pixel, from the measurement
  double frequency_per_pitch = 0;  ///< frequency at which the MTF is stated
  std::vector<EdgeMtf> edges;      ///< the most central rectangle first
};

/// CTF from a plate with bars.
struct CtfMeasure {
  std::string plate;
  int frames = 0;
  double set_delta_t_k = 0, said_delta_t_k = 0;
  double pitch_mrad = 0;           ///< IFOV of a pixel, from the measurement
  double frequency_per_pitch = 0;  ///< requested frequency
  PlateBarsCtf bars;

  /// Returns the group on this axis with the frequency nearest to the requested one; null if this axis has no group.
  [[nodiscard]] const BarsCtf* stated(EdgeAxis axis) const;
};

/// Size-of-source effect from a plate with square apertures.
struct SourceSizeMeasure {
  std::string plate;
  int frames = 0;
  double set_delta_t_k = 0;
  double said_delta_t_k = 0;  ///< reported by the target, minus its report without contrast
  double stated_px = 0;       ///< side of the square source whose loss is stated
  SourceSize effect;
  std::optional<double> model_loss{};  ///< at `stated_px`, of a simulated sensor

  /// Returns the signal of the reference aperture divided by the contrast that the target reports: the slope of the
  /// signal transfer for an extended source. The interval includes only the noise.
  [[nodiscard]] Estimate slope() const;
};

/// Mean picture of the first plate at the contrast that shows it best.
struct PlateView {
  int frames = 0;
  double set_delta_t_k = 0;
  Registration where;
  cv::Size picture{0, 0};
  cv::Rect field;               ///< area of the plate without its rim, in the picture
  cv::Mat1d kelvin;             ///< temperatures of the field
  double temporal_noise_k = 0;  ///< of a pixel in one frame; 0: not known
};

/// The view of the camera, and the sensor model's picture of the plate at the same place.
struct PlatePicture {
  PlateView seen;
  cv::Mat1d expected_k;           ///< model picture of the field, without noise; contrast, level and place are fitted
  std::vector<Polygon> outlines;  ///< of the triangles as located, in pixels of the picture
  double contrast_k = 0;          ///< fitted
  double moved_px = 0;            ///< distance between fitted and located place
  double residual_k = 0;          ///< root mean square over the field
  /// Returns the residual divided by the temporal noise of the mean picture: near 1 if only white noise remains.
  [[nodiscard]] std::optional<double> residual_over_noise() const;
};

/// Results. If a requested measure is absent, `reasons` contains the reason.
struct CameraMeasures {
  std::optional<NoiseMeasure> noise{};
  std::optional<PixelMeasure> pixels{};
  std::optional<TransferMeasure> transfer{};
  std::optional<GeometryMeasure> geometry{};
  std::optional<DriftMeasure> drift{};
  std::optional<ResponseMeasure> response{};
  std::optional<GainControlMeasure> gain_control{};
  std::optional<MtfMeasure> mtf{};
  std::optional<CtfMeasure> ctf{};
  std::optional<SourceSizeMeasure> source{};
  std::optional<AbsoluteMeasure> absolute{};
  std::optional<TimingMeasure> timing{};
  std::optional<LatencyMeasure> latency{};
  std::optional<MrtdMeasure> mrtd{};
  std::vector<TriangleStrip> triangles{};     ///< by contrast
  std::optional<double> netd_model_k{};       ///< closed form, of a simulated sensor
  std::optional<double> response_model_ms{};  ///< time constant of a simulated sensor
  std::optional<PlateView> view{};            ///< if the plate was located
  std::optional<PlatePicture> picture{};      ///< if a sensor model was compared with the view
  std::vector<std::string> reasons{};         ///< sentences about absent measures

  /// Returns the variance of the temporal noise of a pixel in K^2 on the camera's scale, with its 95 % interval.
  [[nodiscard]] std::optional<ComponentEstimate> temporal_variance_k2() const;
  /// Returns the temporal noise divided by the slope of the signal transfer. Empty if one of them is absent, or if the
  /// noise is below half a count and cannot be measured.
  [[nodiscard]] std::optional<double> netd_k() const;
  /// Same with the slope for an extended source, SourceSizeMeasure::slope(), with its 95 % interval.
  [[nodiscard]] std::optional<Estimate> netd_extended_k() const;
  /// Returns the relative half-width of the 95 % interval of netd_k(): the root of the sum of squares of the relative
  /// half-widths of noise and slope.
  [[nodiscard]] std::optional<double> netd_relative_half_width() const;
};

/// Starts the source, measures and stops it. A measure that fails adds a reason and is not an error. Errors:
/// `interrupted` (stop requested). `host` is used only during the call.
[[nodiscard]] Result<CameraMeasures> measure_camera(FrameSource& source, Target& target,
                                                    const CameraMeasuresOptions& options, RunController& host,
                                                    std::stop_token stop);

}  // namespace todbench
