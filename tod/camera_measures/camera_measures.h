// Physical measures of a camera in front of the target of its TOD measurement: the same source, the same target.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/core/frame_source.h"
#include "tod/camera_measures/bars_measure.h"
#include "tod/camera_measures/drift_measure.h"
#include "tod/camera_measures/edge_measure.h"
#include "tod/camera_measures/pixel_measure.h"
#include "tod/camera_measures/plate_geometry.h"
#include "tod/camera_measures/response_measure.h"
#include "tod/camera_measures/triangle_strip.h"
#include "tod/measurement/measurement.h"
#include "tod/measures/signal_transfer.h"
#include "tod/measures/three_d_noise.h"

namespace todbench {

struct CameraMeasuresOptions {
  bool noise = false;                         ///< temporal noise, NETD and 3-D noise, at a contrast of 0
  int noise_frames = 64;                      ///< of the cube, at least 5
  std::optional<PixelOptions> pixels{};       ///< bad and substituted pixels in the cube of the noise; nothing: none
  std::optional<double> drift_s{};            ///< watched after a correction, at a contrast of 0; nothing: no drift
  std::optional<ResponseOptions> response{};  ///< time constant from steps of the first plate; nothing: none
  bool geometry = false;                      ///< IFOV and distortion, from the picture that shows where the plate is
  bool transfer = false;                      ///< signal transfer from the steps below
  std::vector<double> transfer_steps_k;       ///< contrasts that are shown, three or more
  std::vector<double> triangles_k{};          ///< contrasts at which the smallest triangles are shown; empty: none
  std::optional<TargetPlate> mtf_plate{};     ///< in identity mounting; nothing: no MTF
  double mtf_delta_t_k = 10;                  ///< at which it is shown
  int mtf_frames = 64;                        ///< averaged, at least 1
  double mtf_frequency_per_pitch = 0.25;      ///< at which the MTF is stated, up to 1
  std::optional<TargetPlate> ctf_plate{};     ///< in identity mounting; nothing: no CTF
  double ctf_delta_t_k = 10;                  ///< at which it is shown
  int ctf_frames = 64;                        ///< averaged, at least 1
  double ctf_frequency_per_pitch = 0.4;       ///< the group nearest to it is stated
  /// Plates, frames to average, corrections, timeouts and integrity are those of the TOD measurement; the first plate
  /// in identity mounting is shown.
  MeasurementOptions measurement;
};

/// Of a cube of frames of the plate at a contrast of 0, in kelvin of the camera's own scale.
struct NoiseMeasure {
  int frames = 0, rows = 0, columns = 0;  ///< of the part of the picture that the plate covers
  std::uint64_t first_frame = 0, last_frame = 0;
  std::optional<double> since_correction_s{};  ///< at the last frame; nothing: no correction is known
  double mean_k = 0;                           ///< temperature that the camera shows
  NoiseTable table;                            ///< without shading
  double shading_range_k = 0, shading_sd_k = 0;
  std::optional<double> lag1_correlation{};
  std::optional<double> noise_counts{};  ///< temporal, in steps of the camera's counts; nothing: not known
  cv::Rect field{};                      ///< of the frame
  cv::Mat1d pixel_sd_k{};                ///< temporal noise of each pixel, changes of whole frames left out
  cv::Mat1d pattern_k{};                 ///< mean frame without its mean and shading
};

/// One step of the signal transfer.
struct TransferStep {
  double set_delta_t_k = 0, said_delta_t_k = 0;  ///< what the target was told, and what it answered
  double seen_delta_t_k = 0, seen_u_k = 0;       ///< by the camera's scale; u from the scatter over triangles
};

struct TransferMeasure {
  int frames_each = 0;
  std::vector<TransferStep> steps;
  SignalTransfer line;  ///< seen over said: 1 where the camera's temperature scale is right
  /// Of the slope's 95 % interval, by Student's t of the steps.
  [[nodiscard]] double slope_half_width() const;
};

/// IFOV and distortion from the first plate.
struct GeometryMeasure {
  std::string plate;
  int frames = 0;
  double set_delta_t_k = 0;
  double distance_m = 0;        ///< to the plate
  double stated_ifov_mrad = 0;  ///< as the measurement has it
  cv::Size picture{0, 0};
  PlateGeometry geometry;
  std::optional<double> distance_relative_u{};                          ///< standard; nothing: none is stated
  std::optional<double> model_ifov_mrad{}, model_distortion_percent{};  ///< of a simulated sensor

  /// Along x or y, with the interval of the picture alone.
  [[nodiscard]] GeometryValue ifov_mrad(EdgeAxis axis) const;
};

struct MtfMeasure {
  std::string plate;
  int frames = 0;
  double set_delta_t_k = 0, said_delta_t_k = 0;
  double pitch_mrad = 0;           ///< IFOV of a pixel, as the measurement has it
  double frequency_per_pitch = 0;  ///< at which it is stated
  std::vector<EdgeMtf> edges;      ///< the most central rectangle first
};

struct CtfMeasure {
  std::string plate;
  int frames = 0;
  double set_delta_t_k = 0, said_delta_t_k = 0;
  double pitch_mrad = 0;           ///< IFOV of a pixel, as the measurement has it
  double frequency_per_pitch = 0;  ///< asked for
  PlateBarsCtf bars;

  /// The group on this axis whose frequency is nearest to the one that was asked for; null: none on this axis.
  [[nodiscard]] const BarsCtf* stated(EdgeAxis axis) const;
};

/// The first plate at the contrast that shows it best, as the mean of so many frames.
struct PlateView {
  int frames = 0;
  double set_delta_t_k = 0;
  Registration where;
  cv::Size picture{0, 0};
  cv::Rect field;               ///< of the picture: the plate without its rim
  cv::Mat1d kelvin;             ///< of the field
  double temporal_noise_k = 0;  ///< of a pixel in one frame; 0: not known
};

/// The same beside the picture that the sensor model makes of the plate at the same place.
struct PlatePicture {
  PlateView seen;
  cv::Mat1d expected_k;           ///< without noise, of the field; fitted by contrast, level and place
  std::vector<Polygon> outlines;  ///< of the triangles where they were found, in pixels of the picture
  double contrast_k = 0;          ///< that fits
  double moved_px = 0;            ///< by which the place that fits lies beside the one that was found
  double residual_k = 0;          ///< root mean square over the field
  /// Residual over the temporal noise that is left in the mean: near 1 where nothing but white noise is left.
  [[nodiscard]] std::optional<double> residual_over_noise() const;
};

/// What was measured. A measure that was asked for and is not there has its reason in `reasons`.
struct CameraMeasures {
  std::optional<NoiseMeasure> noise{};
  std::optional<PixelMeasure> pixels{};
  std::optional<TransferMeasure> transfer{};
  std::optional<GeometryMeasure> geometry{};
  std::optional<DriftMeasure> drift{};
  std::optional<ResponseMeasure> response{};
  std::optional<MtfMeasure> mtf{};
  std::optional<CtfMeasure> ctf{};
  std::vector<TriangleStrip> triangles{};     ///< by contrast
  std::optional<double> netd_model_k{};       ///< of a simulated sensor in closed form
  std::optional<double> response_model_ms{};  ///< time constant that a simulated sensor has
  std::optional<PlateView> view{};            ///< where the plate was found
  std::optional<PlatePicture> picture{};      ///< where a sensor model was compared with it
  std::vector<std::string> reasons{};         ///< sentences

  /// Temporal noise of a pixel in kelvin of the camera's scale, with its 95 % interval.
  [[nodiscard]] std::optional<ComponentEstimate> temporal_variance_k2() const;
  /// Temporal noise over the slope of the signal transfer; nothing without both, or where the noise is below half a
  /// count and cannot be measured.
  [[nodiscard]] std::optional<double> netd_k() const;
  /// Relative half-width of its 95 % interval: those of the noise and of the slope, as the root of the sum of squares.
  [[nodiscard]] std::optional<double> netd_relative_half_width() const;
};

/// Starts the source, measures and stops it. What cannot be measured is a reason and no failure; a run that is stopped
/// is `interrupted`. `host` is lent for the call.
[[nodiscard]] Result<CameraMeasures> measure_camera(FrameSource& source, Target& target,
                                                    const CameraMeasuresOptions& options, MeasurementHost& host,
                                                    std::stop_token stop);

}  // namespace todbench
