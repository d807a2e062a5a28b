// Faults of single detectors that a camera does not hide: which, where and how large, from a seed of the array.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string_view>
#include <vector>

#include "acquisition/core/rng.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

enum class PixelFaultKind {
  stuck,     ///< shows one level whatever it sees
  hot,       ///< a fixed offset
  noisy,     ///< more temporal noise than the others
  blinking,  ///< jumps between two levels
};
inline constexpr std::array pixel_fault_kinds{PixelFaultKind::stuck, PixelFaultKind::hot, PixelFaultKind::noisy,
                                              PixelFaultKind::blinking};
[[nodiscard]] std::string_view to_string(PixelFaultKind kind);

/// In units of the sensor's NETD.
inline constexpr double hot_offset_netd = 20, stuck_reach_netd = 10, noisy_added_netd = 6, blink_netd = 8;

struct PixelFault {
  PixelFaultKind kind = PixelFaultKind::stuck;
  cv::Point detector;
  double level_k = 0;  ///< of stuck and hot: above the surround; of blinking: between the two levels
  int dwell = 0;       ///< of blinking: pictures on one level, 4 to 24
  int phase = 0;       ///< of blinking: pictures by which it is ahead
};

/// `defective_pixel_share` of the detectors, a quarter of each kind on average, at places and with sizes that follow
/// from `defect_seed` alone.
[[nodiscard]] std::vector<PixelFault> pixel_faults(const SensorSpec& spec);

/// Puts them into picture `index`, in kelvin above the surround; all samples of a detector alike, but for noise.
/// `noise`: random numbers of this picture.
void show_faults(cv::Mat1f& picture, const std::vector<PixelFault>& faults, const SensorSpec& spec,
                 const RandomStream& noise, std::uint64_t index);

}  // namespace todbench
