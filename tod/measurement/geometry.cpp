// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/geometry.h"

#include <fmt/format.h>

#include <algorithm>

#include "acquisition/base/try.h"
#include "tod/measurement/prepared_plate.h"

namespace todbench {
namespace {

std::string words(const PlateBeyondPicture& misfit) {
  return fmt::format(
      "plate {}: its {:.0f} x {:.0f} mm cover {:.0f} x {:.0f} pixels at {:.2f} m, but the picture has {} x {} pixels",
      misfit.plate, misfit.size_mm.width, misfit.size_mm.height, misfit.size_px.width, misfit.size_px.height,
      misfit.distance_m, misfit.picture.width, misfit.picture.height);
}

std::string words(const TrianglesTooNear& misfit) {
  return "plate " + misfit.plate + ", " + sentence(misfit.window);
}

}  // namespace

Result<std::vector<Misfit>> find_misfits(const MeasurementOptions& options, Observer& observer, cv::Size picture) {
  if (!(options.distance_m > 0) || !(options.ifov_mrad > 0))
    return fail(ErrorCode::invalid_input, "distance and IFOV must be positive");
  RegistrationOptions registration = options.registration;
  const double scale = registration.expected_scale_px_per_mm = 1 / (options.distance_m * options.ifov_mrad);
  std::vector<Misfit> out;
  for (const auto& plate : options.plates) {
    PreparedPlate prepared{plate, {}, {}};
    TODBENCH_TRY_VOID(prepare(prepared, observer, scale, options.samples_per_pitch));
    const double search = prepared.observers.empty() ? 0 : prepared.observers.front()->search_samples();
    for (auto& window : touching_windows(plate, registration, prepared.sides(), search))
      out.emplace_back(TrianglesTooNear{plate.name, std::move(window)});
    const cv::Size2d size_px(plate.width_mm * scale, plate.height_mm * scale / registration.pixel_aspect);
    if (size_px.width > picture.width || size_px.height > picture.height)
      out.emplace_back(
          PlateBeyondPicture{plate.name, {plate.width_mm, plate.height_mm}, size_px, options.distance_m, picture});
  }
  std::stable_partition(out.begin(), out.end(),
                        [](const Misfit& misfit) { return std::holds_alternative<PlateBeyondPicture>(misfit); });
  return out;
}

std::string sentence(const Misfit& misfit) {
  return std::visit([](const auto& one) { return words(one); }, misfit);
}

std::string sentences(const std::vector<Misfit>& misfits, std::size_t most) {
  std::string text;
  for (std::size_t i = 0; i < std::min(most, misfits.size()); ++i) text += (i == 0 ? "" : "; ") + sentence(misfits[i]);
  if (misfits.size() > most) text += "; and " + std::to_string(misfits.size() - most) + " more";
  return text;
}

}  // namespace todbench
