// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/grey_levels_csv.h"

#include <array>
#include <string_view>

#include "bench/session/csv_fields.h"
#include "bench/text/csv_table.h"
#include "bench/text/text.h"

namespace todbench {

std::string grey_levels_csv(const std::vector<GreyFrame>& frames) {
  constexpr std::array<std::string_view, 12> columns{"presentation",
                                                     "plate",
                                                     "mounting",
                                                     "set_delta_t_k",
                                                     "delta_t_k",
                                                     "frame",
                                                     "contrast_levels",
                                                     "contrast_u_levels",
                                                     "contrast_ci95_half_levels",
                                                     "triangles",
                                                     "levels_per_k",
                                                     "noise_steps"};
  std::string text = header_line(columns);
  for (const GreyFrame& frame : frames) {
    text += std::to_string(frame.presentation) + "," + csv_field(frame.plate) + "," +
            std::string(to_string(frame.mounting)) + "," + number_text(frame.set_delta_t_k) + "," +
            number_text(frame.delta_t_k) + "," + std::to_string(frame.frame) + "," +
            number_text(frame.contrast.levels) + "," + number_text(frame.contrast.standard_uncertainty) + "," +
            number_text(frame.contrast.half_width()) + "," + std::to_string(frame.contrast.triangles) + "," +
            number_text(frame.levels_per_k) + "," + number_text(frame.noise_steps) + "\n";
  }
  return text;
}

}  // namespace todbench
