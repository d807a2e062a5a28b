// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/scene/target_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace todbench {
namespace {

/// Corner of a prism: forward, to port, up.
struct SolidPlace {
  double forward = 0, port = 0, up = 0;
};

struct Face {
  SceneRegion region;
  double nearness_m = 0;  ///< of its middle to the viewer
};

/// Direction of the viewer.
struct Viewer {
  double c, s;
  explicit Viewer(double azimuth_deg)
      : c(std::cos(azimuth_deg * std::numbers::pi / 180)), s(std::sin(azimuth_deg * std::numbers::pi / 180)) {}
  [[nodiscard]] cv::Point2d seen(const SolidPlace& p) const { return {p.forward * s + p.port * c, -p.up}; }
  [[nodiscard]] double nearness(const SolidPlace& p) const { return p.forward * c - p.port * s; }
};

/// Faces that are viewed edge on have negligible area.
constexpr double thinnest_m2 = 1e-9;

void add_face(std::vector<Face>& faces, const TargetPart& part, const Viewer& viewer,
              const std::vector<SolidPlace>& corners) {
  Face face;
  for (const auto& corner : corners) {
    face.region.outline_m.push_back(viewer.seen(corner));
    face.nearness_m += viewer.nearness(corner) / static_cast<double>(corners.size());
  }
  if (area(face.region.outline_m) < thinnest_m2) return;
  face.region.name = part.name;
  face.region.temperature_k = part.temperature_k;
  face.region.emissivity = part.emissivity;
  face.region.target = true;
  faces.push_back(std::move(face));
}

/// Vertices in the order that gives a positive area with y up.
Polygon upright(const Polygon& profile) {
  double sum = 0;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const auto &a = profile[i], &b = profile[(i + 1) % profile.size()];
    sum += a.x * b.y - b.x * a.y;
  }
  return sum >= 0 ? profile : Polygon(profile.rbegin(), profile.rend());
}

}  // namespace

Result<void> validate(const TargetModel& model) {
  if (model.parts.empty()) return fail(ErrorCode::invalid_input, "the target has no part");
  FieldScene profiles;
  for (const auto& part : model.parts) {
    if (!(part.width_m > 0 && part.width_m < 1e4 && std::abs(part.side_m) < 1e4))
      return fail(ErrorCode::invalid_input,
                  "part '" + part.name + "': the width must be above 0, and width and position below 10 km");
    profiles.regions.push_back({part.name, part.profile_m, part.temperature_k, part.emissivity, true});
  }
  return validate(profiles);
}

std::vector<SceneRegion> view_of(const TargetModel& model, double azimuth_deg) {
  const Viewer viewer(azimuth_deg);
  std::vector<Face> faces;
  for (const auto& part : model.parts) {
    const Polygon profile = upright(part.profile_m);
    const double port = part.side_m + part.width_m / 2, starboard = part.side_m - part.width_m / 2;
    // Cap on the viewer's side.
    std::vector<SolidPlace> cap;
    for (const auto& v : profile) cap.push_back({v.x, viewer.s >= 0 ? starboard : port, v.y});
    add_face(faces, part, viewer, cap);
    for (std::size_t i = 0; i < profile.size(); ++i) {
      const auto &a = profile[i], &b = profile[(i + 1) % profile.size()];
      if ((b.y - a.y) * viewer.c <= 0) continue;  // turned away: the outward normal is (dy, -dx)
      add_face(faces, part, viewer, {{a.x, starboard, a.y}, {b.x, starboard, b.y}, {b.x, port, b.y}, {a.x, port, a.y}});
    }
  }
  std::stable_sort(faces.begin(), faces.end(),
                   [](const Face& a, const Face& b) { return a.nearness_m < b.nearness_m; });
  std::vector<SceneRegion> regions;
  for (auto& face : faces) regions.push_back(std::move(face.region));
  return regions;
}

}  // namespace todbench
