// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/pattern/test_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "acquisition/base/rng.h"
#include "acquisition/base/try.h"
#include "hvs/shape/polygon_coverage.h"

namespace todbench {
namespace {

/// Space for a triangle of size 1 round its centroid, in every orientation, with a gap to its neighbours.
constexpr double cell_per_size = 2.4;
constexpr double smallest_size_px = 1;
constexpr double step_of_sizes = 1.205;

void add_polygon(cv::Mat1d& cover, const Polygon& polygon) {
  double left = polygon.front().x, right = left, top = polygon.front().y, bottom = top;
  for (const auto& p : polygon) {
    left = std::min(left, p.x);
    right = std::max(right, p.x);
    top = std::min(top, p.y);
    bottom = std::max(bottom, p.y);
  }
  const auto clamped = [](double value, int high) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(high)));
  };
  const int x0 = clamped(std::floor(left), cover.cols), x1 = clamped(std::ceil(right), cover.cols);
  const int y0 = clamped(std::floor(top), cover.rows), y1 = clamped(std::ceil(bottom), cover.rows);
  if (x1 <= x0 || y1 <= y0) return;
  const cv::Rect window(x0, y0, x1 - x0, y1 - y0);
  cv::Mat1d part = cover(window);
  part += pixel_coverage(placed(polygon, 1, {-static_cast<double>(x0), -static_cast<double>(y0)}), window.size());
}

/// Sizes that decrease by the step from the largest that leaves room for five rows, as many as fit.
std::vector<double> sizes_that_fit(cv::Size size) {
  std::vector<double> sizes;
  double next = std::min(size.width / 4.0, size.height / 5.0) / cell_per_size;
  double used = 0;
  while (next >= smallest_size_px && used + next * cell_per_size <= size.height) {
    sizes.push_back(next);
    used += next * cell_per_size;
    next /= step_of_sizes;
  }
  return sizes;
}

/// The four orientations in a random order from the seed (Fisher and Yates).
std::array<Apex, 4> shuffled(std::uint64_t seed, std::size_t row) {
  std::array<Apex, 4> order = all_apexes;
  const RandomStream stream = RandomStream(seed, "pattern.tod").sub(row);
  for (std::size_t i = order.size() - 1; i > 0; --i) {
    std::swap(order[i], order[stream.below(i + 1, i)]);
  }
  return order;
}

Result<TargetPlate> plate_of(const TodPicture& kind, cv::Size size) {
  TargetPlate plate;
  plate.name = "pattern-tod";
  plate.width_mm = size.width;
  plate.height_mm = size.height;
  const auto sizes = kind.sizes_px.empty() ? sizes_that_fit(size) : kind.sizes_px;
  double height = 0;
  for (const double s : sizes) height += s * cell_per_size;
  if (sizes.empty() || height > size.height) {
    return fail(ErrorCode::invalid_input,
                fmt::format("{} x {} pixels are too few for the rows of triangles, which need {:.0f} rows of pixels",
                            size.width, size.height, std::max(height, 5 * cell_per_size)));
  }
  // The rows share the remaining height.
  const double gap = (size.height - height) / static_cast<double>(sizes.size());
  double y = -size.height / 2.0;
  for (std::size_t row = 0; row < sizes.size(); ++row) {
    const double cell = sizes[row] * cell_per_size + gap;
    const auto order = shuffled(kind.seed, row);
    for (int i = 0; i < 4; ++i) {
      // Golden steps spread the phases of all triangles over the pixel.
      const double count = static_cast<double>(4 * row) + i;
      const double phase_x = std::fmod(count * 0.7548776662466927, 1.0),
                   phase_y = std::fmod(count * 0.5698402909980532, 1.0);
      PlateTriangle triangle;
      triangle.name = fmt::format("row {}, triangle {}", row + 1, i + 1);
      triangle.size_mm = sizes[row];
      triangle.apex = order[static_cast<std::size_t>(i)];
      triangle.position_mm = {std::floor((i - 1.5) * size.width / 4) + phase_x - 0.5,
                              std::floor(y + cell / 2) + phase_y - 0.5};
      plate.triangles.push_back(std::move(triangle));
    }
    y += cell;
  }
  if (auto valid = validate(plate); !valid) return fail("the picture is too small for its triangles", valid.error());
  return plate;
}

/// Pairs of groups, upright and lying, in rows from the upper left.
Result<std::vector<BarGroup>> groups_of(const MrtdPicture& kind, cv::Size size) {
  std::vector<BarGroup> groups;
  double x = 0, y = 0, row_height = 0;
  for (const double f : kind.frequencies_per_px) {
    if (!(f > 0 && f <= 0.5))
      return fail(ErrorCode::invalid_input,
                  fmt::format("a frequency must be above 0 and at most 0.5 cycles per pixel (Nyquist: a bar of one "
                              "pixel), found {:g}",
                              f));
    const double side = 3.5 / f, cell = side + std::max(2.0, 1 / f);
    if (cell > size.width || cell > size.height)
      return fail(
          ErrorCode::invalid_input,
          fmt::format(
              "{} x {} pixels are too few for a group of bars of {:g} cycles per pixel, which is {:.0f} pixels wide",
              size.width, size.height, f, cell));
    for (const bool upright : {true, false}) {
      if (x + cell > size.width) {
        x = 0;
        y += row_height;
        row_height = 0;
      }
      if (y + cell > size.height)
        return fail(ErrorCode::invalid_input,
                    fmt::format("{} x {} pixels are too few for all groups of bars", size.width, size.height));
      groups.push_back({f, std::floor(x + cell / 2), std::floor(y + cell / 2), upright});
      x += cell;
      row_height = std::max(row_height, cell);
    }
  }
  if (groups.empty()) return fail(ErrorCode::invalid_input, "no frequency is given");
  return groups;
}

/// Everything to the right of a line through the middle, far beyond the picture.
Polygon right_of_edge(double angle_deg, cv::Size size) {
  const double angle = angle_deg * std::numbers::pi / 180;
  const double far = 4.0 * (size.width + size.height);
  const cv::Point2d middle(size.width / 2.0, size.height / 2.0);
  const cv::Point2d along(std::sin(angle), -std::cos(angle)), right(std::cos(angle), std::sin(angle));
  return {middle + far * along, middle + far * along + far * right, middle - far * along + far * right,
          middle - far * along};
}

Result<void> draw(const TodPicture& kind, const PictureRequest& request, TestPicture& picture) {
  TODBENCH_TRY(picture.plate, plate_of(kind, request.size));
  for (const auto& triangle : picture.plate.triangles) add_polygon(picture.levels, outline_px(triangle, request.size));
  return {};
}

Result<void> draw(const MrtdPicture& kind, const PictureRequest& request, TestPicture& picture) {
  TODBENCH_TRY(picture.bars, groups_of(kind, request.size));
  for (const auto& group : picture.bars) {
    for (const auto& bar : outlines_px(group)) add_polygon(picture.levels, bar);
  }
  return {};
}

Result<void> draw(const EdgePicture& kind, const PictureRequest& request, TestPicture& picture) {
  if (!std::isfinite(kind.angle_deg))
    return fail(ErrorCode::invalid_input, "the angle of the edge must be a finite number");
  add_polygon(picture.levels, right_of_edge(kind.angle_deg, request.size));
  return {};
}

Result<void> draw(const RampPicture&, const PictureRequest& request, TestPicture& picture) {
  for (int j = 0; j < request.size.height; ++j) {
    for (int i = 0; i < request.size.width; ++i) picture.levels(j, i) = (i + 0.5) / request.size.width;
  }
  return {};
}

Result<void> draw(const SiemensPicture& kind, const PictureRequest& request, TestPicture& picture) {
  if (kind.spokes < 2) return fail(ErrorCode::invalid_input, "a star needs at least two spokes");
  if (finest_radius_px(kind) >= std::min(request.size.width, request.size.height) / 2.0)
    return fail(
        ErrorCode::invalid_input,
        fmt::format("a star of {} spokes is finer than half a cycle per pixel within {:.4g} pixels of its "
                    "middle, and this picture ends {:.4g} pixels from it: at most {:.0f} spokes can be shown",
                    kind.spokes, finest_radius_px(kind), std::min(request.size.width, request.size.height) / 2.0,
                    std::ceil(std::numbers::pi * std::min(request.size.width, request.size.height) / 2.0) - 1));
  const cv::Point2d middle(request.size.width / 2.0, request.size.height / 2.0);
  const double radius = std::min(middle.x, middle.y);
  for (int i = 0; i < kind.spokes; ++i) {
    const auto at = [&](double turn) {
      const double angle = 2 * std::numbers::pi * turn / kind.spokes;
      return middle + radius * cv::Point2d(std::cos(angle), std::sin(angle));
    };
    add_polygon(picture.levels, {middle, at(i), at(i + 0.5)});
  }
  return {};
}

Result<void> draw(const FlatPicture& kind, const PictureRequest&, TestPicture& picture) {
  if (!(kind.level >= 0 && kind.level <= 1)) return fail(ErrorCode::invalid_input, "the level must be from 0 to 1");
  picture.levels = kind.level;
  return {};
}

}  // namespace

double finest_radius_px(const SiemensPicture& star) {
  return star.spokes / std::numbers::pi;
}

Polygon outline_px(const PlateTriangle& triangle_of_plate, cv::Size size) {
  return triangle(triangle_of_plate.size_mm, triangle_of_plate.apex,
                  triangle_of_plate.position_mm + cv::Point2d(size.width / 2.0, size.height / 2.0));
}

std::vector<Polygon> outlines_px(const BarGroup& group) {
  const double width = 1 / (2 * group.frequency_per_px), half_length = 3.5 * width;
  std::vector<Polygon> bars;
  for (int i = 0; i < 4; ++i) {
    const double left = (2 * i - 3.5) * width;
    Polygon bar{{left, -half_length}, {left + width, -half_length}, {left + width, half_length}, {left, half_length}};
    for (auto& p : bar) {
      if (!group.upright) std::swap(p.x, p.y);
      p += cv::Point2d(group.x_px, group.y_px);
    }
    bars.push_back(std::move(bar));
  }
  return bars;
}

Result<TestPicture> drawn_picture(const PictureRequest& request) {
  constexpr int most = 16384, most_pixels = 1 << 26;
  if (request.size.width < 1 || request.size.height < 1 || request.size.width > most || request.size.height > most ||
      request.size.width > most_pixels / request.size.height) {
    return fail(ErrorCode::invalid_input,
                fmt::format("a picture must have from 1 to {} pixels on each side and at most {} pixels in total", most,
                            most_pixels));
  }
  const auto level = [](double value) { return value >= 0 && value <= 1; };
  if (!level(request.low) || !level(request.high))
    return fail(ErrorCode::invalid_input, "the levels must be from 0 to 1");
  if (request.low == request.high && !std::holds_alternative<FlatPicture>(request.kind))
    return fail(ErrorCode::invalid_input,
                fmt::format("background and pattern both have the level {:g}, so the picture shows no pattern: low and "
                            "high must differ (the pattern without contrast is 'flat')",
                            request.low));
  TestPicture picture;
  picture.levels = cv::Mat1d::zeros(request.size);
  const auto done = std::visit([&](const auto& kind) { return draw(kind, request, picture); }, request.kind);
  if (!done) return tl::unexpected(done.error());
  if (std::holds_alternative<FlatPicture>(request.kind)) return picture;
  for (double& value : picture.levels) value = request.low + (request.high - request.low) * std::clamp(value, 0.0, 1.0);
  return picture;
}

}  // namespace todbench
