// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/scan_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "acquisition/base/try.h"
#include "acquisition/core/judged_picture.h"
#include "tod/registration/shift_fit.h"

namespace todbench {
namespace {

/// Least contrast of the triangles in its standard error for a place to be measured.
constexpr double least_scan_contrast = 3;

Result<void> check_scan(std::span<const ShiftSeen> places) {
  const auto moves = fit_stage(places);
  if (!moves) return {};
  if (moves_as_asked(*moves, most_scan_deviation)) return {};
  const cv::Matx22d& m = moves->seen_per_asked;
  return fail(ErrorCode::calibration,
              fmt::format("the frames do not follow the scan that super-resolution assumes: one pixel of the scan "
                          "along x moves the picture by ({:.2f}, {:.2f}) px, one pixel along y by ({:.2f}, {:.2f}) px",
                          m(0, 0), m(1, 0), m(0, 1), m(1, 1)));
}

}  // namespace

void ScanFrames::add(const Frame& frame, const cv::Mat1d& kelvin) {
  if (frame.judged == nullptr || !frame.judged->scan_px) return;
  const cv::Point2d scan = *frame.judged->scan_px;
  Place& place = places_[{scan.x, scan.y}];
  if (place.frames > 0) {
    const double difference = cv::norm(kelvin, place.last, cv::NORM_L2SQR);
    squares_ += difference / static_cast<double>(2 * kelvin.total());
    ++differences_;
    place.sum += kelvin;
  } else {
    place.sum = kelvin.clone();
  }
  place.last = kelvin;
  ++place.frames;
}

std::optional<double> ScanFrames::noise() const {
  return differences_ > 0 ? std::optional(std::sqrt(squares_ / differences_)) : std::nullopt;
}

Result<void> ScanWatch::look(const ScanFrames& frames, const TargetPlate& mounted_plate,
                             const Registration& registration, const RegistrationOptions& options) {
  if (frames.places().empty()) return {};
  const auto outlines = large_outlines(mounted_plate, registration, options.min_triangle_px);
  const auto noise = frames.noise();
  const std::size_t before = places_.size();
  for (const auto& [scan, place] : frames.places()) {
    const auto fit = fit_place(place.sum / place.frames, outlines, registration.blur_px, registration.pixel({0, 0}));
    if (!fit || std::abs(fit->amplitude) < least_scan_contrast * fit->amplitude_error) continue;
    // Residuals contain the fixed pattern, which all places of the scan have in common.
    const double own =
        noise && fit->residual_rms > 0 ? std::min(1.0, *noise / std::sqrt(place.frames) / fit->residual_rms) : 1;
    const cv::Point2d asked(scan[0], scan[1]);
    places_.push_back({.set_up = set_ups_,
                       .presentation = set_ups_,
                       .asked_px = asked,
                       .off_px = fit->shift - asked,
                       .standard_error_px = own * fit->standard_error});
  }
  ++set_ups_;
  // Of all set-ups, with small errors, and of this one, because lost frames displace the scan from there on.
  TODBENCH_TRY_VOID(check_scan(places_));
  return check_scan(std::span(places_).subspan(before));
}

}  // namespace todbench
