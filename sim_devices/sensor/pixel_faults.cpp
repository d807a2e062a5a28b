// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/pixel_faults.h"

#include <cmath>

namespace todbench {

std::string_view to_string(PixelFaultKind kind) {
  constexpr std::array<std::string_view, pixel_fault_kinds.size()> names{"stuck", "hot", "noisy", "blinking"};
  return names[static_cast<std::size_t>(kind)];
}

std::vector<PixelFault> pixel_faults(const SensorSpec& spec) {
  std::vector<PixelFault> faults;
  if (spec.defective_pixel_share <= 0) return faults;
  const RandomStream places(static_cast<std::uint64_t>(spec.defect_seed), "sensor.faults");
  for (int row = 0; row < spec.height; ++row) {
    for (int column = 0; column < spec.width; ++column) {
      const auto index =
          static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(spec.width) + static_cast<std::uint64_t>(column);
      if (places.uniform(index) >= spec.defective_pixel_share) continue;
      const RandomStream own = places.sub(index);
      PixelFault fault{.kind = pixel_fault_kinds[own.below(pixel_fault_kinds.size(), 0)], .detector = {column, row}};
      const double sign = own.below(2, 1) == 0 ? -1 : 1;
      if (fault.kind == PixelFaultKind::stuck)
        fault.level_k = stuck_reach_netd * spec.netd_k * (2 * own.uniform(2) - 1);
      if (fault.kind == PixelFaultKind::hot) fault.level_k = sign * hot_offset_netd * spec.netd_k;
      if (fault.kind == PixelFaultKind::blinking) {
        fault.level_k = sign * blink_netd * spec.netd_k;
        fault.dwell = 4 + static_cast<int>(own.below(21, 3));
        fault.phase = static_cast<int>(own.below(2 * static_cast<std::uint64_t>(fault.dwell), 4));
      }
      faults.push_back(fault);
    }
  }
  return faults;
}

void show_faults(cv::Mat1f& picture, const std::vector<PixelFault>& faults, const SensorSpec& spec,
                 const RandomStream& noise, std::uint64_t index) {
  const int n = spec.samples_per_pitch();
  const double added_k = noisy_added_netd * spec.netd_k / std::sqrt(static_cast<double>(spec.exposures_per_sample()));
  for (const PixelFault& fault : faults) {
    const bool on =
        fault.kind == PixelFaultKind::blinking &&
        ((index + static_cast<std::uint64_t>(fault.phase)) / static_cast<std::uint64_t>(fault.dwell)) % 2 == 1;
    for (int sample = 0; sample < n * n; ++sample) {
      const int y = fault.detector.y * n + sample / n, x = fault.detector.x * n + sample % n;
      float& pixel = picture(y, x);
      switch (fault.kind) {
        case PixelFaultKind::stuck:
          pixel = static_cast<float>(fault.level_k);
          break;
        case PixelFaultKind::hot:
          pixel += static_cast<float>(fault.level_k);
          break;
        case PixelFaultKind::noisy:
          pixel += static_cast<float>(added_k) *
                   noise.normal(static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(picture.cols) +
                                static_cast<std::uint64_t>(x));
          break;
        case PixelFaultKind::blinking:
          if (on) pixel += static_cast<float>(fault.level_k);
          break;
      }
    }
  }
}

}  // namespace todbench
