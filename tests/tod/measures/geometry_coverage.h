// SPDX-License-Identifier: GPL-3.0-or-later
// Plates in pictures of a lens whose scale, tilt and distortion are known, and how often their intervals hold them.
#pragma once

#include <array>

#include "tests/tod/registration/plate_picture.h"
#include "tod/camera_measures/plate_geometry.h"
#include "tod/plate/plate_outlines.h"

namespace todbench::testing {

/// A camera of 320 x 240 pixels before a plate.
struct LensCase {
  double distortion = 0;  ///< k of PlateGeometry, not percent
  double noise_k = 0.02;  ///< of the mean picture
  double contrast_k = 4;
  double mm_per_px = mm_per_pixel;
  double most_tilt_per_mm = 1e-4;
};

struct LensPicture {
  PictureSpec spec;
  cv::Mat1d picture;
  std::array<double, 4> truth;  ///< mm per pixel along x and y, rotation in degrees, distortion in percent
};

/// Place, rotation and tilt follow from the seed. Sides of triangles are bent by the lens.
inline LensPicture lens_picture(const TargetPlate& plate, const LensCase& lens, std::uint64_t seed) {
  RandomStream random(seed, "test.lens");
  std::uint64_t drawn = 0;
  const auto between = [&](double low, double high) { return low + (high - low) * random.uniform(drawn++); };
  LensPicture out;
  PictureSpec& spec = out.spec;
  spec.size = {320, 240};
  spec.contrast_k = lens.contrast_k;
  spec.scale = 1 / lens.mm_per_px;
  spec.rotation_deg = between(-3, 3);
  spec.centre_px = {159.5 + between(-8, 8), 119.5 + between(-8, 8)};
  spec.tilt_per_mm = {between(-1, 1) * lens.most_tilt_per_mm, between(-1, 1) * lens.most_tilt_per_mm};
  const cv::Matx33d h = true_mapping(spec);
  const cv::Point2d middle((spec.size.width - 1) / 2.0, (spec.size.height - 1) / 2.0);
  const double corner = 0.5 * std::hypot(spec.size.width, spec.size.height);
  out.picture = cv::Mat1d(spec.size, 300.0);
  for (const PlateTriangle& t : plate.triangles) {
    const auto corners = triangle(t.size_mm, t.apex, t.position_mm);
    std::vector<cv::Point2d> outline;
    constexpr int pieces = 6;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const cv::Point2d side = corners[(i + 1) % corners.size()] - corners[i];
      for (int k = 0; k < pieces; ++k) {
        const cv::Point2d p = mapped(h, corners[i] + side * (1.0 * k / pieces)) - middle;
        outline.push_back(middle + p * (1 + lens.distortion * p.dot(p) / (corner * corner)));
      }
    }
    add_triangle(out.picture, outline, spec.contrast_k, spec.gaussian_px);
  }
  add_noise(out.picture, lens.noise_k, seed);
  const cv::Matx22d mm = jacobian(h, {0, 0}).inv();
  out.truth = {std::hypot(mm(0, 0), mm(1, 0)), std::hypot(mm(0, 1), mm(1, 1)), spec.rotation_deg,
               100 * lens.distortion};
  return out;
}

inline Result<PlateGeometry> geometry_of(const TargetPlate& plate, const LensPicture& seen) {
  RegistrationOptions options;
  options.expected_scale_px_per_mm = seen.spec.scale;
  const auto where = register_plate(seen.picture, plate, options);
  if (!where) return tl::unexpected(where.error());
  return plate_geometry(seen.picture, plate, *where);
}

struct GeometryCoverage {
  int seeds = 0, refused = 0;
  std::array<double, 4> within{}, mean_error{}, half_width{};  ///< as the truth
  double residual_px = 0;                                      ///< mean
};

inline GeometryCoverage geometry_coverage(const TargetPlate& plate, const LensCase& lens, int seeds) {
  GeometryCoverage out;
  for (int seed = 1; seed <= seeds; ++seed) {
    const LensPicture seen = lens_picture(plate, lens, static_cast<std::uint64_t>(seed));
    const auto found = geometry_of(plate, seen);
    if (!found) {
      ++out.refused;
      continue;
    }
    ++out.seeds;
    const Estimate* values[] = {&found->mm_per_px_x, &found->mm_per_px_y, &found->rotation_deg,
                                &found->distortion_percent};
    for (std::size_t k = 0; k < out.within.size(); ++k) {
      out.within[k] += seen.truth[k] >= values[k]->low && seen.truth[k] <= values[k]->high ? 1 : 0;
      out.mean_error[k] += values[k]->value - seen.truth[k];
      out.half_width[k] += values[k]->high - values[k]->value;
    }
    out.residual_px += found->residual_px;
  }
  for (std::size_t k = 0; k < out.within.size(); ++k)
    out.within[k] /= out.seeds, out.mean_error[k] /= out.seeds, out.half_width[k] /= out.seeds;
  out.residual_px /= out.seeds;
  return out;
}

}  // namespace todbench::testing
