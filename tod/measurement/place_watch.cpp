// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/place_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "acquisition/base/try.h"
#include "tod/measurement/frame_taker.h"
#include "tod/registration/shift_fit.h"

namespace todbench {
namespace {

constexpr double certain = 6;               ///< standard errors; both axes: exp(-18) in noise alone
constexpr double negligible_px = 0.05;      ///< costs less than 0.1 % of acuity
constexpr double well_known_px = 0.03;      ///< standard error below which further presentations are not averaged
constexpr double visible = 3;               ///< least contrast of the triangles in its standard error
constexpr double noted_scale_error = 0.03;  ///< of the movement of the stage, beyond four standard errors
constexpr double search_px = 6;             ///< search range
constexpr std::size_t looks_for_cause = 5;  ///< further presentations to distinguish the stage from a knock
constexpr std::size_t most_told = 400;

/// The mean of the frames inside `windows`; 0 elsewhere.
Result<cv::Mat1d> mean_in(std::span<const Frame> frames, const std::vector<cv::Rect>& windows) {
  cv::Mat1d mean = cv::Mat1d::zeros(frames.front().counts.size());
  const cv::Rect picture({0, 0}, mean.size());
  for (const cv::Rect& window : windows) {
    const cv::Rect inside = window & picture;
    if (inside.area() == 0) continue;
    cv::Mat1d sum = cv::Mat1d::zeros(inside.size());
    for (const Frame& frame : frames) {
      TODBENCH_TRY(const auto kelvin, window_kelvin(frame, inside));
      sum += kelvin;
    }
    sum /= static_cast<double>(frames.size());
    sum.copyTo(mean(inside));
  }
  return mean;
}

double significance(cv::Point2d off, cv::Point2d error) {
  return std::hypot(off.x / error.x, off.y / error.y);
}

/// The plate in a picture, and its distance from the place of `asked`.
struct Found {
  PlaceFit fit;
  cv::Point2d off_px;
};

/// Gauss-Newton from the requested place: one step, further ones only if the plate is certainly elsewhere.
Result<std::optional<Found>> find(std::span<const Frame> frames, const TargetPlate& plate, const Registration& asked,
                                  cv::Point2d start_px, const PlaceWatchOptions& options, double contrast) {
  cv::Point2d off = start_px;
  std::optional<Found> found;
  for (int step = 0; step < 8; ++step) {
    const Registration at = asked.moved(off);
    const auto outlines = large_outlines(plate, at, options.registration.min_triangle_px);
    if (outlines.empty()) return std::optional<Found>();
    std::vector<cv::Rect> windows;
    for (const Polygon& outline : outlines) windows.push_back(place_window(outline));
    TODBENCH_TRY(const auto picture, mean_in(frames, windows));
    const auto fit = fit_place(picture, outlines, asked.blur_px, at.pixel({0, 0}));
    if (!fit || fit->amplitude * contrast <= 0 || std::abs(fit->amplitude) < visible * fit->amplitude_error) break;
    found = Found{*fit, off + fit->shift};
    const double length = cv::norm(fit->shift);
    if (length < negligible_px || significance(fit->shift, fit->standard_error) < certain) return found;
    off += fit->shift * std::min(1.0, 0.7 / length);
    if (cv::norm(off) > search_px) break;
    if (step == 7) return std::optional<Found>();
  }
  return found && cv::norm(found->off_px - off) < 2 ? found : std::optional<Found>();
}

/// Searches for a plate that the contrast should show and that is not near the requested place.
Result<std::optional<Found>> search(std::span<const Frame> frames, const TargetPlate& plate, const Registration& asked,
                                    const PlaceWatchOptions& options, double contrast) {
  const auto picture = mean_in(frames, {cv::Rect({0, 0}, frames.front().counts.size())});
  if (!picture) return tl::unexpected(picture.error());
  const auto moved = measure_shift(*picture, plate, asked, options.registration, search_px);
  if (!moved) return std::optional<Found>();
  return find(frames, plate, asked, *moved, options, contrast);
}

}  // namespace

double PlaceWatch::Mean::significance() const {
  return todbench::significance(off_px, standard_error_px);
}

void PlaceWatch::set_up_located() {
  for (const Look& look : looks_) {
    if (earlier_.size() < most_told) earlier_.push_back(look.place);
  }
  looks_.clear();
  used_off_px_ = {0, 0};
  ++set_up_;
}

PlaceWatch::Mean PlaceWatch::mean_of_last(std::size_t count) const {
  const auto axis = [&](auto of) {
    double weights = 0, sum = 0, independent = 0, shared = 0;
    for (std::size_t i = looks_.size() - count; i < looks_.size(); ++i) {
      const double error = of(looks_[i].place.standard_error_px);
      const double w = 1 / (error * error);
      weights += w;
      sum += w * of(looks_[i].place.off_px);
      independent += w * (1 - looks_[i].shared);
      shared += w * error * std::sqrt(looks_[i].shared);
    }
    return std::pair(sum / weights, std::sqrt(independent + shared * shared) / weights);
  };
  const auto [x, x_error] = axis([](cv::Point2d p) { return p.x; });
  const auto [y, y_error] = axis([](cv::Point2d p) { return p.y; });
  return {{x, y}, {x_error, y_error}};
}

Result<void> PlaceWatch::judge() {
  std::optional<Mean> best;
  for (std::size_t count = 1; count <= looks_.size(); count *= 2) {
    const Mean mean = mean_of_last(count);
    const double off = cv::norm(mean.off_px);
    const double error = std::max(mean.standard_error_px.x, mean.standard_error_px.y);
    if (mean.significance() > certain && off - 4 * error > options_.max_shift_error_px && !wrong_since_) {
      wrong_since_ = looks_.size();
      wrong_by_px_ = off, wrong_error_px_ = error;
    }
    if (!best || std::max(best->standard_error_px.x, best->standard_error_px.y) > well_known_px) best = mean;
  }
  const bool known = cv::norm(best->off_px) > negligible_px && best->significance() > certain;
  used_off_px_ = known ? best->off_px : cv::Point2d(0, 0);
  if (cv::norm(used_off_px_) > cv::norm(farthest_px_)) {
    farthest_px_ = used_off_px_;
    farthest_presentation_ = looks_.back().place.presentation;
  }
  if (wrong_since_ && looks_.size() >= *wrong_since_ + looks_for_cause) return tl::unexpected(refused());
  const auto places = told();
  const auto stage = wrong_since_ ? std::nullopt : fit_stage(places);
  // Four degrees of freedom: noise exceeds 60 with a probability of 3e-12.
  if (stage && stage->chi2 > 60 &&
      stage->largest_off_px - 4 * stage->largest_off_error_px > options_.max_shift_error_px) {
    wrong_since_ = looks_.size();
    wrong_by_px_ = stage->largest_off_px, wrong_error_px_ = stage->largest_off_error_px;
    return tl::unexpected(refused());
  }
  return {};
}

std::vector<ShiftSeen> PlaceWatch::told() const {
  std::vector<ShiftSeen> places = earlier_;
  const std::size_t first = looks_.size() > most_told ? looks_.size() - most_told : 0;
  for (std::size_t i = first; i < looks_.size(); ++i) places.push_back(looks_[i].place);
  return places;
}

Error PlaceWatch::refused() const {
  return {ErrorCode::calibration,
          fmt::format("the plate is not at the requested place: it is off by {:.2f} +- {:.2f} px, at most {:.2f} px "
                      "are allowed ([target] max_shift_error_px); likely cause: {}",
                      wrong_by_px_, wrong_error_px_, options_.max_shift_error_px, likely_cause(told()))};
}

Result<PlateSeen> PlaceWatch::look(std::span<const Frame> frames, const TargetPlate& mounted_plate,
                                   const Registration& base, const Registration& asked, const ExpectedPicture& expected,
                                   std::int64_t presentation) {
  PlateSeen seen{.asked_px = asked.pixel({0, 0}), .seen_px = {}, .standard_error_px = {}, .used_off_px = used_off_px_};
  auto found = find(frames, mounted_plate, asked, used_off_px_, options_, expected.contrast);
  if (!found) return tl::unexpected(found.error());
  // In a wrong place the plate shows less than half of its contrast.
  const bool weak = *found && std::abs((*found)->fit.amplitude) + certain * (*found)->fit.amplitude_error <
                                  0.5 * std::abs(expected.contrast);
  const bool ought_to_be_seen = expected.noise > 0 && std::abs(expected.contrast) > 4 * expected.noise;
  if (weak || (!*found && ought_to_be_seen)) {
    auto elsewhere = search(frames, mounted_plate, asked, options_, expected.contrast);
    if (!elsewhere) return tl::unexpected(elsewhere.error());
    if (*elsewhere)
      found = elsewhere;
    else if (ought_to_be_seen)
      return fail(ErrorCode::calibration, fmt::format("the plate is not at the requested place: in presentation {} its "
                                                      "large triangles were not found within {:.0f} px of it",
                                                      presentation, search_px));
  }
  if (!*found) {
    ++not_seen_;
    return seen;
  }
  ++seen_;
  const PlaceFit& fit = (*found)->fit;
  const double noise = expected.noise / std::sqrt(static_cast<double>(frames.size()));
  const double own = expected.noise > 0 ? std::min(1.0, noise * noise / (fit.residual_rms * fit.residual_rms)) : 0;
  looks_.push_back({.place = {.set_up = set_up_,
                              .presentation = presentation,
                              .asked_px = seen.asked_px - base.pixel({0, 0}),
                              .off_px = (*found)->off_px,
                              .standard_error_px = fit.standard_error},
                    .shared = 1 - own});
  seen.seen_px = seen.asked_px + (*found)->off_px;
  seen.standard_error_px = fit.standard_error;
  seen.amplitude = fit.amplitude, seen.amplitude_error = fit.amplitude_error, seen.shared = 1 - own;
  double reach_px = 0;
  for (const PlateTriangle& t : mounted_plate.triangles)
    reach_px = std::max(reach_px, cv::norm(asked.pixel(t.position_mm) - seen.asked_px));
  const double turned_px = std::abs(fit.turn_rad) * reach_px, turn_error_px = fit.turn_error_rad * reach_px;
  if (turned_px > certain * turn_error_px) {
    largest_turn_px_ = std::max(largest_turn_px_, turned_px);
    if (turned_px - 4 * turn_error_px > options_.max_shift_error_px) {
      return fail(
          ErrorCode::calibration,
          fmt::format("the plate is not at the requested place: since its registration it has turned by {1:.2f} deg in "
                      "presentation {0}, that is {2:.2f} +- {3:.2f} px at its edge; at most {4:.2f} px are allowed "
                      "([target] max_shift_error_px)",
                      presentation, fit.turn_rad * 180 / CV_PI, turned_px, turn_error_px, options_.max_shift_error_px));
    }
  }
  TODBENCH_TRY_VOID(judge());
  seen.used_off_px = used_off_px_;
  return seen;
}

Result<void> PlaceWatch::finish() const {
  if (wrong_since_) return tl::unexpected(refused());
  return {};
}

std::vector<std::string> PlaceWatch::notes() const {
  std::vector<std::string> notes;
  if (cv::norm(farthest_px_) > 0) {
    const auto stage = fit_stage(told());
    const std::string cause = stage && !moves_as_asked(*stage, noted_scale_error)
                                  ? motion_clause(*stage) + ", and the observed places were used"
                                  : "a drift of the picture was followed";
    notes.push_back(fmt::format("{}: in presentation {} the plate was ({:+.2f}, {:+.2f}) px from the requested place",
                                cause, farthest_presentation_, farthest_px_.x, farthest_px_.y));
  }
  if (largest_turn_px_ > negligible_px)
    notes.push_back(
        fmt::format("the plate turned relative to the picture by up to {:.2f} px at its edge", largest_turn_px_));
  if (seen_ == 0 && not_seen_ > 0)
    notes.push_back(
        "the plate could not be located in the frames of the presentations: the requested places were used");
  return notes;
}

}  // namespace todbench
