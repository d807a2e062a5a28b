// SPDX-License-Identifier: GPL-3.0-or-later
// Faults of single detectors that a camera does not hide. A seed determines their position, kind and size.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string_view>
#include <vector>

#include "acquisition/base/rng.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Kind of a fault.
enum class PixelFaultKind {
  stuck,     ///< shows one level for every scene
  hot,       ///< a fixed offset
  noisy,     ///< more temporal noise than other detectors
  blinking,  ///< jumps between two levels
};
inline constexpr std::array pixel_fault_kinds{PixelFaultKind::stuck, PixelFaultKind::hot, PixelFaultKind::noisy,
                                              PixelFaultKind::blinking};
/// Returns the name of the kind.
[[nodiscard]] std::string_view to_string(PixelFaultKind kind);

/// Sizes of the faults over NETD: offset, largest stuck level, sd of the added noise, and jump.
inline constexpr double hot_offset_netd = 20, stuck_reach_netd = 10, noisy_added_netd = 6, blink_netd = 8;

/// Fault of one detector.
struct PixelFault {
  PixelFaultKind kind = PixelFaultKind::stuck;
  cv::Point detector;
  double level_k = 0;  ///< stuck: level above the surround; hot: offset; blinking: jump
  int dwell = 0;       ///< blinking: pictures on one level, 4 to 24
  int phase = 0;       ///< blinking: offset of the cycle in pictures
};

/// Returns the faulty detectors, `defective_pixel_share` of all detectors, a quarter of each kind on average. Positions
/// and kinds depend only on `defect_seed`; sizes also scale with the NETD.
[[nodiscard]] std::vector<PixelFault> pixel_faults(const SensorSpec& spec);

/// Adds the faults to picture `index`, in kelvin above the surround. All samples of a detector change by the same
/// amount, except for noise. `noise`: random numbers of this picture.
void show_faults(cv::Mat1f& picture, const std::vector<PixelFault>& faults, const SensorSpec& spec,
                 const RandomStream& noise, std::uint64_t index);

}  // namespace todbench
