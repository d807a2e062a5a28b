#include "sim_devices/sensor/sensor_spec.h"

#include <cmath>

namespace todbench {

std::string_view to_string(DisplayReconstruction reconstruction) {
  return reconstruction == DisplayReconstruction::bilinear ? "bilinear" : "sample_and_hold";
}

namespace {

/// The parameters of the stages behind the detector.
std::string impossible_stage(const SensorSpec& spec) {
  const auto not_negative = [](double value) { return std::isfinite(value) && value >= 0; };
  if (!not_negative(spec.time_constant_ms) || spec.time_constant_ms > 1000)
    return "time_constant_ms must be in [0, 1000]";
  if (!not_negative(spec.row_noise_k)) return "row_noise_k must not be negative";
  if (!not_negative(spec.column_noise_k)) return "column_noise_k must not be negative";
  if (!(spec.dead_pixel_share >= 0 && spec.dead_pixel_share <= 0.1)) return "dead_pixel_share must be in [0, 0.1]";
  if (spec.frames_averaged < 1 || spec.frames_averaged > 1024) return "frames_averaged must be 1 to 1024";
  if (spec.super_resolution_frames < 0 || spec.super_resolution_frames > 1024 || spec.super_resolution_frames % 4 != 0)
    return "super_resolution_frames must be 0 or a multiple of 4 up to 1024";
  if (spec.super_resolution_frames > 0 && spec.microscan > 1)
    return "super_resolution_frames and microscan exclude each other";
  if (!(spec.display_blur_samples >= 0 && spec.display_blur_samples <= 3))
    return "display_blur_samples must be in [0, 3]";
  return "";
}

}  // namespace

Result<void> validate(const SensorSpec& spec) {
  const auto refuse = [&](const std::string& what) {
    return fail(ErrorCode::invalid_input,
                "sensor " + (spec.name.empty() ? std::string("without a name") : spec.name) + ": " + what);
  };
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  const auto not_negative = [](double value) { return std::isfinite(value) && value >= 0; };
  if (spec.name.empty()) return refuse("name is missing");
  if (spec.width < 16 || spec.height < 16 || spec.width > 16384 || spec.height > 16384) {
    return refuse("width and height must be 16 to 16384 detectors");
  }
  if (!positive(spec.pitch_um)) return refuse("pitch_um must be positive");
  if (!positive(spec.detector_um)) return refuse("detector_um must be positive");
  if (spec.detector_um > spec.pitch_um) return refuse("detector_um is larger than pitch_um: detectors cannot overlap");
  if (!positive(spec.focal_length_mm)) return refuse("focal_length_mm must be positive");
  if (!positive(spec.f_number)) return refuse("f_number must be positive");
  if (!positive(spec.wavelength_min_um) || !(spec.wavelength_max_um > spec.wavelength_min_um) ||
      !std::isfinite(spec.wavelength_max_um)) {
    return refuse("wavelength_min_um must be positive and below wavelength_max_um");
  }
  if (!(spec.optics_transmission > 0 && spec.optics_transmission <= 1))
    return refuse("optics_transmission must be in (0, 1]");
  if (!(not_negative(spec.aberration_sigma_pitch) && spec.aberration_sigma_pitch <= 10)) {
    return refuse("aberration_sigma_pitch must be in [0, 10]");
  }
  if (!not_negative(spec.netd_k)) return refuse("netd_k must not be negative");
  if (!not_negative(spec.fixed_pattern_k)) return refuse("fixed_pattern_k must not be negative");
  if (const std::string problem = impossible_stage(spec); !problem.empty()) return refuse(problem);
  if (spec.microscan < 1 || spec.microscan > 4) return refuse("microscan must be 1 to 4");
  if (spec.bits < 8 || spec.bits > 16) return refuse("bits must be 8 to 16");
  if (!positive(spec.kelvin_per_count)) return refuse("kelvin_per_count must be positive");
  if (!std::isfinite(spec.offset_k)) return refuse("offset_k must be a number");
  if (!positive(spec.frame_rate_hz)) return refuse("frame_rate_hz must be positive");
  if (!(spec.scene_temperature_k >= 50 && spec.scene_temperature_k <= 5000))
    return refuse("scene_temperature_k must be 50 to 5000");
  return {};
}

}  // namespace todbench
