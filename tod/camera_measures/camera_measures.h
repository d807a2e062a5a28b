// SPDX-License-Identifier: GPL-3.0-or-later
// Physical measures of a camera, measured with the frame source and the target of the TOD measurement.
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
  /// Measures temporal noise, NETD and 3-D noise at a contrast of 0.
  bool noise = false;
  /// Number of frames of the noise cube, at least 5.
  int noise_frames = 64;
  /// Options for bad and substituted pixels in the noise cube. Empty: not measured.
  std::optional<PixelOptions> pixels{};
  /// Duration of the drift measurement after a correction, at a contrast of 0. Empty: not measured.
  std::optional<double> drift_s{};
  /// Options of the time constant, measured with contrast steps of the first plate. Empty: not measured.
  std::optional<ResponseOptions> response{};
  /// Measures IFOV and distortion in the picture in which the plate is located.
  bool geometry = false;
  /// Measures the signal transfer with `transfer_steps_k`.
  bool transfer = false;
  /// Contrasts of the signal transfer, at least three. The first plate is located at the largest contrast.
  std::vector<double> transfer_steps_k;
  /// Contrasts at which pictures of the smallest triangles are taken. Empty: none.
  std::vector<double> triangles_k{};
  /// Plate for the MTF, in identity mounting. Empty: not measured.
  std::optional<TargetPlate> mtf_plate{};
  /// Contrast at which this plate is shown.
  double mtf_delta_t_k = 10;
  /// Number of averaged frames, at least 1.
  int mtf_frames = 64;
  /// Frequency at which the MTF is stated, at most 1.
  double mtf_frequency_per_pitch = 0.25;
  /// Plate for the CTF, in identity mounting. Empty: not measured.
  std::optional<TargetPlate> ctf_plate{};
  /// Contrast at which this plate is shown.
  double ctf_delta_t_k = 10;
  /// Number of averaged frames, at least 1.
  int ctf_frames = 64;
  /// Frequency at which the CTF is stated: the group with the nearest frequency is used.
  double ctf_frequency_per_pitch = 0.4;
  /// Plate for the size-of-source effect, in identity mounting. Empty: not measured.
  std::optional<TargetPlate> source_plate{};
  /// Contrast at which this plate is shown.
  double source_delta_t_k = 10;
  /// Number of frames averaged at `source_delta_t_k`, at least 1. The same number is averaged without contrast before
  /// and after.
  int source_frames = 64;
  /// Side of the square source whose loss is stated.
  double source_size_px = 10;
  /// Options of the measurement at absolute temperatures. Empty: not measured.
  std::optional<AbsoluteOptions> absolute{};
  /// Number of frames whose times are evaluated. 0: not measured.
  int timing_frames = 0;
  /// Options of the latency, measured with runs of the stage. Empty: not measured.
  std::optional<LatencyOptions> latency{};
  /// Options of the MRTD. measure_camera() sets the response, the IFOV and the number of frames for locating the plate.
  /// Empty: not measured.
  std::optional<MrtdOptions> mrtd{};
  /// Options of the automatic gain, measured with contrast steps of the first plate. Empty: not measured.
  std::optional<ResponseOptions> gain_control{};
  /// Options of the TOD measurement. Plates, numbers of averaged frames, corrections, timeouts and integrity limits are
  /// taken from these options. The first plate is shown in identity mounting.
  MeasurementOptions measurement;
};

/// One step of the signal transfer.
struct TransferStep {
  /// Set-point, and contrast reported by the target.
  double set_delta_t_k = 0, said_delta_t_k = 0;
  /// Contrast on the camera's scale, and its standard uncertainty from the scatter over the triangles.
  double seen_delta_t_k = 0, seen_u_k = 0;
};

/// Signal transfer, measured with contrast steps.
struct TransferMeasure {
  /// Number of averaged frames at each step.
  int frames_each = 0;
  /// One element for each contrast.
  std::vector<TransferStep> steps;
  /// Straight line of the observed contrast as a function of the reported contrast. The slope is 1 if the temperature
  /// scale of the camera is correct.
  SignalTransfer line;
  /// Returns the half-width of the 95 % interval of the slope. The half-width contains Student's t with the degrees of
  /// freedom of the fit.
  [[nodiscard]] double slope_half_width() const;
};

/// IFOV and distortion from the first plate.
struct GeometryMeasure {
  /// Name of the plate.
  std::string plate;
  /// Number of averaged frames.
  int frames = 0;
  /// Set contrast.
  double set_delta_t_k = 0;
  /// Distance to the plate.
  double distance_m = 0;
  /// IFOV that the plan states.
  double stated_ifov_mrad = 0;
  /// Height of a pixel divided by its width, as the plan states.
  double pixel_aspect = 1;
  /// Size of the picture in pixels.
  cv::Size picture{0, 0};
  /// Result of plate_geometry().
  PlateGeometry geometry;
  /// Relative standard uncertainty of the distance. Empty: not stated.
  std::optional<double> distance_relative_u{};
  /// IFOV and distortion of a simulated sensor. Empty for a real camera.
  std::optional<double> model_ifov_mrad{}, model_distortion_percent{};

  /// Returns the IFOV along x or y. The interval includes only the errors of the triangle positions in the picture.
  [[nodiscard]] Estimate ifov_mrad(EdgeAxis axis) const;
  /// Returns the field of view through the middle of the picture, between the outer borders of the first and the last
  /// pixel. It is computed from the IFOV and the fitted distortion, which is extrapolated beyond the plate. The
  /// interval includes only the errors of the triangle positions in the picture.
  [[nodiscard]] Estimate field_of_view_deg(EdgeAxis axis) const;
  /// Returns the IFOV along x divided by the IFOV along y. The distance has no effect on this ratio.
  [[nodiscard]] Estimate aspect_ratio() const;
};

/// MTF from a plate with rectangles.
struct MtfMeasure {
  /// Name of the plate.
  std::string plate;
  /// Number of averaged frames.
  int frames = 0;
  /// Set contrast, and contrast reported by the target.
  double set_delta_t_k = 0, said_delta_t_k = 0;
  /// IFOV of a pixel, as the plan states.
  double pitch_mrad = 0;
  /// Frequency at which the MTF is stated.
  double frequency_per_pitch = 0;
  /// MTF of each rectangle and axis. The rectangle nearest to the centre of the picture is first.
  std::vector<EdgeMtf> edges;
};

/// CTF from a plate with bars.
struct CtfMeasure {
  /// Name of the plate.
  std::string plate;
  /// Number of averaged frames.
  int frames = 0;
  /// Set contrast, and contrast reported by the target.
  double set_delta_t_k = 0, said_delta_t_k = 0;
  /// IFOV of a pixel, as the plan states.
  double pitch_mrad = 0;
  /// Requested frequency.
  double frequency_per_pitch = 0;
  /// Result of plate_bars_ctf().
  PlateBarsCtf bars;

  /// Returns the group on this axis with the frequency nearest to the requested frequency; null if this axis has no
  /// group.
  [[nodiscard]] const BarsCtf* stated(EdgeAxis axis) const;
};

/// Size-of-source effect from a plate with square apertures.
struct SourceSizeMeasure {
  /// Name of the plate.
  std::string plate;
  /// Number of averaged frames of each picture.
  int frames = 0;
  /// Set contrast.
  double set_delta_t_k = 0;
  /// Contrast reported by the target at the set contrast, minus the contrast that it reports at a set-point of 0.
  double said_delta_t_k = 0;
  /// Side of the square source whose loss is stated.
  double stated_px = 0;
  /// Result of source_size().
  SourceSize effect;
  /// Loss of a simulated sensor at `stated_px`. Empty for a real camera.
  std::optional<double> model_loss{};

  /// Returns the signal of the reference aperture divided by the contrast that the target reports: the slope of the
  /// signal transfer for an extended source. The interval includes only the noise.
  [[nodiscard]] Estimate slope() const;
};

/// Mean picture of the first plate, at the contrast with the largest magnitude.
struct PlateView {
  /// Number of averaged frames.
  int frames = 0;
  /// Set contrast.
  double set_delta_t_k = 0;
  /// Registration of the plate in this picture.
  Registration where;
  /// Size of the picture in pixels.
  cv::Size picture{0, 0};
  /// Area of the plate without its rim, in the picture.
  cv::Rect field;
  /// Temperatures of the field.
  cv::Mat1d kelvin;
  /// Temporal noise of a pixel in one frame. 0: not known.
  double temporal_noise_k = 0;
};

/// Pictures of the plate: from the camera, and from the sensor model with the plate at the same position.
struct PlatePicture {
  /// Picture by the camera.
  PlateView seen;
  /// Model picture of the field, without noise. Contrast, level and position are fitted to the camera's picture.
  cv::Mat1d expected_k;
  /// Outlines of the located triangles, in pixels of the picture.
  std::vector<Polygon> outlines;
  /// Fitted contrast.
  double contrast_k = 0;
  /// Distance between the fitted and the located position.
  double moved_px = 0;
  /// Root mean square difference of the two pictures over the field.
  double residual_k = 0;
  /// Returns the residual divided by the temporal noise of the mean picture. The ratio is near 1 if the residual is
  /// only white noise.
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
  /// Pictures of the smallest triangles, one element for each contrast.
  std::vector<TriangleStrip> triangles{};
  /// NETD of a simulated sensor, in closed form. Empty for a real camera.
  std::optional<double> netd_model_k{};
  /// Time constant of a simulated sensor. Empty for a real camera.
  std::optional<double> response_model_ms{};
  /// Picture of the first plate. Empty: the plate was not located.
  std::optional<PlateView> view{};
  /// Comparison with a sensor model. Empty: not compared.
  std::optional<PlatePicture> picture{};
  /// One sentence for each absent measure.
  std::vector<std::string> reasons{};

  /// Returns the variance of the temporal noise of a pixel, in K^2 on the camera's scale, with the 95 % interval.
  [[nodiscard]] std::optional<ComponentEstimate> temporal_variance_k2() const;
  /// Returns the temporal noise divided by the slope of the signal transfer. Empty if noise or slope is absent, or if
  /// the noise is below half a count and cannot be measured.
  [[nodiscard]] std::optional<double> netd_k() const;
  /// Returns the temporal noise divided by the slope for an extended source (SourceSizeMeasure::slope()), with its 95 %
  /// interval.
  [[nodiscard]] std::optional<Estimate> netd_extended_k() const;
  /// Returns the relative half-width of the 95 % interval of netd_k(): the root sum of squares of the relative
  /// half-widths of noise and slope.
  [[nodiscard]] std::optional<double> netd_relative_half_width() const;
};

/// Starts the source, takes all requested measures and stops the source. If a measure fails, `reasons` states the
/// cause, and the next measures are taken. Errors: `interrupted` (stop requested). `host` is used only during the call.
[[nodiscard]] Result<CameraMeasures> measure_camera(FrameSource& source, Target& target,
                                                    const CameraMeasuresOptions& options, RunController& host,
                                                    std::stop_token stop);

}  // namespace todbench
