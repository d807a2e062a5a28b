// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/bars_judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <utility>

#include "acquisition/base/distributions.h"
#include "acquisition/base/rng.h"
#include "acquisition/base/try.h"
#include "hvs/observer/open_parameters.h"
#include "hvs/shape/painted_shapes.h"
#include "tod/camera_measures/plate_offset.h"
#include "tod/measures/forced_choice.h"
#include "tod/registration/patch_windows.h"

namespace todbench {
namespace {

constexpr std::size_t own_draws = 4;          ///< of the observer's own noise, for each frame and interval
constexpr std::size_t most_frame_parts = 16;  ///< of the jackknife over the frames
/// Pictures of the observer's own noise, for each place. All set-ups use them, so the jackknife over set-ups does not
/// contain their sampling error. With 256 pictures that of an eye was 2.7 %; the noise of hvs-1 is small.
constexpr std::size_t own_pool = 256, own_pool_of_an_eye = 2048;
constexpr double blur_margin_px = 1.5;  ///< distance of a window from other cut-outs

/// A cut-out in the picture, round the middle of its target.
Polygon in_picture(const PlateRectangle& cut_out, cv::Point2d middle_mm, const Registration& where) {
  Polygon outline = outline_mm(cut_out);
  for (cv::Point2d& corner : outline) corner = where.pixel(corner) - where.pixel(middle_mm);
  return outline;
}

std::vector<StepEdge> edges_of(const std::vector<PlateRectangle>& cut_outs, cv::Point2d middle_mm,
                               const Registration& where) {
  std::vector<PaintedPolygon> painted;
  for (const PlateRectangle& one : cut_outs) painted.push_back({in_picture(one, middle_mm, where), 1});
  return visible_edges(painted);
}

std::vector<PlateRectangle> bars_of(const PlateBars& group) {
  TargetPlate alone;
  alone.bars = {group};
  return straight_cut_outs(alone);
}

bool lies_across_x(const PlateBars& group) {
  return std::abs(std::cos(group.angle_deg * std::numbers::pi / 180)) > std::numbers::sqrt2 / 2;
}

double bars_per_pitch(const PlateBars& group, const Registration& where) {
  const double angle = group.angle_deg * std::numbers::pi / 180;
  const cv::Point2d bar = cv::Point2d(std::cos(angle), std::sin(angle)) * group.bar_mm;
  return 1 / (2 * cv::norm(where.pixel(group.position_mm + 0.5 * bar) - where.pixel(group.position_mm - 0.5 * bar)));
}

/// Name of a cut-out of the plate in a window round this place, other than `own`; empty: none.
std::string neighbour_in(const TargetPlate& plate, const Registration& where, cv::Point2d middle_mm, int window,
                         const std::string& own) {
  const double half = 0.5 * window + blur_margin_px;
  const cv::Point2d middle = where.pixel(middle_mm);
  const cv::Rect2d area(middle.x - half, middle.y - half, 2 * half, 2 * half);
  for (const PlateRectangle& one : straight_cut_outs(plate)) {
    if (!own.empty() && (one.name == own || one.name.starts_with(own + ", bar "))) continue;
    Polygon outline = outline_mm(one);
    for (cv::Point2d& corner : outline) corner = where.pixel(corner);
    if ((box_of(outline) & area).area() > 0) return one.name;
  }
  return {};
}

/// Middle of an empty part of the plate near a spot, for windows of this size; empty: there is none.
std::optional<cv::Point2d> empty_place(const TargetPlate& plate, const Registration& where, cv::Point2d spot_mm,
                                       int window) {
  const double step_mm = 2 / where.scale_px_per_mm, half_mm = 0.5 * window / where.scale_px_per_mm;
  constexpr int most_steps = 60, directions = 16;
  for (int ring = 1; ring <= most_steps; ++ring) {
    for (int k = 0; k < directions; ++k) {
      const double angle = 2 * std::numbers::pi * k / directions;
      const cv::Point2d at = spot_mm + cv::Point2d(std::cos(angle), std::sin(angle)) * (ring * step_mm);
      if (std::abs(at.x) + half_mm > plate.width_mm / 2 || std::abs(at.y) + half_mm > plate.height_mm / 2) continue;
      if (neighbour_in(plate, where, at, window, "").empty()) return at;
    }
  }
  return std::nullopt;
}

double squares_about_mean(const std::vector<double>& values) {
  double mean = 0, squares = 0;
  for (const double one : values) mean += one / static_cast<double>(values.size());
  for (const double one : values) squares += (one - mean) * (one - mean);
  return squares;
}

}  // namespace

/// Thresholds of one place from some of its set-ups.
struct BarsJudge::Thresholds {
  std::vector<double> contrast_k, positive_share, negative_share;
  std::optional<double> positive_k, negative_k, half_k, best_k;
  double best_phase = 0;
  /// Variance of ln half_k over sets of set-ups that have other phases.
  double phase_variance = 0;
};

BarsJudge::BarsJudge(const MrtdOptions& options)
    : options_(options), observers_{options.observer}, keeper_(options.kept_frames) {
  std::ranges::move(open_ends(options.observer), std::back_inserter(observers_));
}

Result<void> BarsJudge::add_place(const PlateRectangle& target, const PlateRectangle& other, Place place,
                                  const std::vector<AlternativeAspects>& alternatives) {
  TODBENCH_TRY(IdentificationBank bank, IdentificationBank::build(options_.observer, alternatives, 1));
  const int side = bank.window_samples();
  const auto drawn = [&](const char* stream, int points) {
    std::vector<cv::Mat1f> pictures;
    const RandomStream noise = RandomStream(options_.seed, stream).sub(places_.size());
    for (std::size_t i = 0; i < (options_.observer.eye ? own_pool_of_an_eye : own_pool); ++i) {
      pictures.emplace_back(points, points);
      noise.sub(i).fill_normal({pictures.back().ptr<float>(), pictures.back().total()});
    }
    return pictures;
  };
  std::vector<cv::Mat1f> white = drawn("mrtd.own", side);
  if (options_.observer.eye) {
    place.eye_noise = bank.project_eye(drawn("mrtd.eye", bank.eye_points()));
  } else {
    for (cv::Mat1f& picture : white) picture -= cv::mean(picture)[0];
  }
  place.own_noise = bank.project_all(white);
  place.bank = std::move(bank);
  const std::size_t levels = options_.contrasts_k.size();
  const IntervalScores none(static_cast<std::size_t>(options_.set_ups));
  const Scores empty{std::vector(levels, none), std::vector(levels, none)};
  place.answers.assign(observers_.size(), {empty, empty});
  place.phase.resize(static_cast<std::size_t>(options_.set_ups));
  positions_.rectangles.push_back(target);
  positions_.rectangles.push_back(other);
  places_.push_back(std::move(place));
  return {};
}

Result<BarsJudge> BarsJudge::create(const MrtdOptions& options, const Registration& where) {
  BarsJudge judge(options);
  judge.said_sum_k_.assign(options.contrasts_k.size(), 0.0);
  judge.said_count_.assign(options.contrasts_k.size(), 0);
  const TargetPlate& plate = options.plate;
  const auto window_of = [&](const std::vector<AlternativeAspects>& alternatives) {
    return identification_window_samples(options.observer, alternatives, 1);
  };
  for (const BarPair& pair : bar_pairs(plate)) {
    const PlateBars& four = pair.four;
    const std::vector<AlternativeAspects> alternatives{{edges_of(bars_of(four), four.position_mm, where)},
                                                       {edges_of(pair.five_bars, pair.five_mm, where)}};
    const int window = window_of(alternatives);
    const PlateRectangle square{four.name, four.position_mm, {7 * four.bar_mm, four.length_mm}, four.angle_deg};
    const PlateRectangle other{pair.five, pair.five_mm, square.size_mm, square.angle_deg};
    std::string crowded;
    for (const PlateRectangle* group : {&square, &other}) {
      const std::string name = neighbour_in(plate, where, group->position_mm, window, group->name);
      if (!name.empty()) crowded = fmt::format("{}: {} lies in its window of {} px", group->name, name, window);
    }
    if (!crowded.empty()) {
      judge.reasons_.push_back(crowded);
      continue;
    }
    if (auto added = judge.add_place(square, other,
                                     {.name = four.name,
                                      .axis = lies_across_x(four) ? EdgeAxis::x : EdgeAxis::y,
                                      .frequency_per_pitch = bars_per_pitch(four, where)},
                                     alternatives);
        !added)
      return tl::unexpected(added.error());
  }
  for (const PlateRectangle& spot : spots_of(plate)) {
    const AlternativeAspects shape{edges_of({spot}, spot.position_mm, where)};
    const std::vector<AlternativeAspects> alternatives{shape, shape};
    const int window = window_of(alternatives);
    const auto empty = empty_place(plate, where, spot.position_mm, window);
    const std::string name = neighbour_in(plate, where, spot.position_mm, window, spot.name);
    if (!name.empty() || !empty) {
      judge.reasons_.push_back(name.empty()
                                   ? spot.name + ": there is no empty part of the plate near it"
                                   : fmt::format("{}: {} lies in its window of {} px", spot.name, name, window));
      continue;
    }
    PlateRectangle nothing = spot;
    nothing.position_mm = *empty;
    const double side_mm = std::sqrt(spot.size_mm.width * spot.size_mm.height);
    if (auto added = judge.add_place(
            spot, nothing, {.name = spot.name, .size_px = side_mm * where.scale_at(spot.position_mm)}, alternatives);
        !added)
      return tl::unexpected(added.error());
  }
  if (judge.places_.empty()) {
    return fail(ErrorCode::invalid_input, "no bars of plate '" + plate.name + "' can be judged" +
                                              (judge.reasons_.empty() ? std::string() : ": " + judge.reasons_.front()));
  }
  return judge;
}

void BarsJudge::add(const cv::Mat1d& kelvin, const ShownBars& shown) {
  const std::vector<PlateRectangle> at = mounted(positions_, shown.mounting).rectangles;
  const auto set_up = static_cast<std::size_t>(shown.set_up);
  said_sum_k_[shown.level] += std::abs(shown.said_k), ++said_count_[shown.level];
  for (std::size_t p = 0; p < places_.size(); ++p) {
    Place& place = places_[p];
    if (place.left_out) continue;
    std::vector<cv::Mat1f> patches, windows;
    for (std::size_t which = 0; which < 2; ++which) {
      const PatchWindow window =
          patch_window(shown.where.pixel(at[2 * p + which].position_mm), place.bank->window_samples());
      if ((window.pixels & cv::Rect({0, 0}, kelvin.size())) != window.pixels) {
        place.left_out = true;
        reasons_.push_back(place.name + ": its window leaves the picture");
        break;
      }
      if (which == 0) place.phase[set_up] = place.axis == EdgeAxis::x ? window.phase.x : window.phase.y;
      cv::Mat1f patch;
      cv::Mat1d(kelvin(window.pixels) - cv::mean(kelvin(window.pixels))[0]).convertTo(patch, CV_32F);
      windows.push_back(patch);
      patches.push_back(options_.observer.eye ? without_background(options_.observer, patch) : patch);
    }
    if (place.left_out) continue;
    keep(p, shown, windows[0], windows[1]);
    const auto scores = place.bank->project_all(patches);
    for (std::size_t which = 0; which < 2; ++which) decide(place, which == 0, scores[which], shown);
  }
}

void BarsJudge::keep(std::size_t place, const ShownBars& shown, const cv::Mat1f& target, const cv::Mat1f& other) {
  if (!keeper_.keeps() || places_[place].frequency_per_pitch > mrtd_cut_per_pitch) return;
  keeper_.add({place, shown.set_up, shown.said_k, target, other});
}

KeptBars BarsJudge::kept() const {
  std::vector<KeptPlace> places;
  for (const Place& place : places_) {
    const bool judged = !place.left_out && place.frequency_per_pitch <= mrtd_cut_per_pitch;
    places.push_back({judged ? place.name : std::string(), place.axis, place.frequency_per_pitch, place.size_px,
                      place.bank->window_samples()});
  }
  return keeper_.of(places);
}

void BarsJudge::decide(Place& place, bool target, const std::vector<float>& pattern, const ShownBars& shown) {
  const double contrast_k = shown.said_k * options_.response, magnitude_k = std::abs(contrast_k);
  const RandomStream pick(options_.seed, "mrtd.pick");
  const std::vector<float> nothing(place.bank->scores(), 0.0F);
  const std::uint64_t first = draws_;
  draws_ += own_draws;
  for (std::size_t o = 0; o < observers_.size(); ++o) {
    const TemplateObserverSpec& observer = observers_[o];
    const double enlarged = observer.sensor_noise_factor * observer.sensor_noise_factor - 1;
    const auto white =
        static_cast<float>(std::hypot(observer.internal_noise, std::sqrt(enlarged) * shown.noise_k / magnitude_k));
    const auto eye =
        static_cast<float>(observer.eye ? place.bank->eye_noise_k(observer, 0, 0, magnitude_k, 1) / magnitude_k : 0);
    Scores& to = shown.said_k > 0 ? place.answers[o].positive : place.answers[o].negative;
    auto& row = (target ? to.target : to.other)[shown.level][static_cast<std::size_t>(shown.set_up)];
    for (std::size_t k = 0; k < own_draws; ++k) {
      const std::size_t number = pick.below(place.own_noise.size(), first + k);
      std::vector<float> mixed;
      if (observer.eye) {
        mixed = place.own_noise[number];
        for (std::size_t i = 0; i < mixed.size(); ++i) mixed[i] = white * mixed[i] + eye * place.eye_noise[number][i];
      }
      float largest[2];
      place.bank->largest_of_each(nothing, pattern, static_cast<float>(1 / contrast_k),
                                  observer.eye ? mixed : place.own_noise[number], observer.eye ? 1.0F : white, largest);
      row.push_back(place.size_px > 0 ? largest[0] : largest[0] - largest[1]);
    }
  }
}

/// Variance of ln of a threshold by jackknife; empty if one of the thresholds does not exist.
std::optional<double> BarsJudge::jackknife_variance(const std::vector<Thresholds>& left_out,
                                                    std::optional<double> Thresholds::*of) {
  std::map<int, double> without;
  for (const Thresholds& one : left_out) {
    if (!(one.*of) || !(*(one.*of) > 0)) return std::nullopt;
    without[static_cast<int>(without.size())] = *(one.*of);
  }
  return jackknife_variance_of_ln(without);
}

std::vector<float> BarsJudge::LeftOut::rest(const std::vector<float>& row, std::size_t draws) const {
  const std::size_t frames = (draws + own_draws - 1) / own_draws, parts = std::min(most_frame_parts, frames);
  std::vector<float> some;
  for (std::size_t d = 0; d < draws; ++d) {
    if (d / own_draws * parts / frames != frame_part) some.push_back(row[d]);
  }
  return some;
}

BarsJudge::Thresholds BarsJudge::thresholds(const Place& place, std::size_t observer, const LeftOut& left_out) const {
  const Answers& answers = place.answers[observer];
  Thresholds out;
  std::vector<std::size_t> levels;
  for (std::size_t i = 0; i < options_.contrasts_k.size(); ++i) {
    if (said_count_[i] > 0) levels.push_back(i);
  }
  const auto said = [&](std::size_t level) { return said_sum_k_[level] / said_count_[level]; };
  std::ranges::sort(levels, {}, said);
  for (const std::size_t level : levels) out.contrast_k.push_back(said(level));
  const auto remaining = [&](const IntervalScores& all) {
    IntervalScores some;
    std::size_t draws = all.front().size();
    for (const auto& row : all) draws = std::min(draws, row.size());
    for (std::size_t s = 0; s < all.size(); ++s) {
      if (s != left_out.set_up) some.push_back(left_out.rest(all[s], draws));
    }
    return some;
  };
  const auto threshold = [&](const Scores& scores, std::vector<double>& told) -> std::optional<double> {
    std::vector<ShareOfPairs> shares;
    std::vector<ContrastShare> points;
    for (std::size_t i = 0; i < levels.size(); ++i) {
      shares.push_back(share_of_pairs(remaining(scores.target[levels[i]]), remaining(scores.other[levels[i]])));
      points.push_back({out.contrast_k[i], shares.back().mean});
      told.push_back(shares.back().mean);
    }
    const auto passed = passed_contrast(out.contrast_k, shares).contrast_k;
    if (!passed) return std::nullopt;
    const auto fitted = fit_contrast(points, *passed);
    return fitted ? fitted->level_k : *passed;
  };
  out.positive_k = threshold(answers.positive, out.positive_share);
  out.negative_k = threshold(answers.negative, out.negative_share);
  if (!out.positive_k || !out.negative_k) return out;
  out.half_k = 0.5 * (*out.positive_k + *out.negative_k);
  if (place.size_px > 0) return out;
  find_best_phase(answers, place.phase, left_out, levels, out);
  return out;
}

void BarsJudge::find_best_phase(const Answers& answers, const std::vector<double>& phases, const LeftOut& left_out,
                                const std::vector<std::size_t>& levels, Thresholds& out) {
  // Every set-up has one phase; contrasts without the offset of the target.
  const double offset = 0.5 * (*out.positive_k - *out.negative_k);
  std::vector<ContrastShare> points;
  for (std::size_t s = 0; s < phases.size(); ++s) {
    if (s == left_out.set_up) continue;
    for (std::size_t i = 0; i < levels.size(); ++i) {
      for (const auto& [scores, sign] : {std::pair(&answers.positive, 1.0), std::pair(&answers.negative, -1.0)}) {
        const double contrast_k = out.contrast_k[i] - sign * offset;
        const auto& target = scores->target[levels[i]][s];
        const auto& other = scores->other[levels[i]][s];
        if (target.size() < 2 || target.size() != other.size() || !(contrast_k > 0)) continue;
        const std::size_t draws = target.size();
        points.push_back({contrast_k,
                          share_of_pairs({left_out.rest(target, draws)}, {left_out.rest(other, draws)}).mean,
                          phases[s]});
      }
    }
  }
  if (const auto fitted = fit_contrast(points, *out.half_k, PhaseFit::swing)) {
    out.best_phase = fitted->best_phase();
    out.best_k = fitted->level_k * std::exp(fitted->ln_ratio_at(out.best_phase));
    std::vector<double> ln_ratios;
    for (const double phase : phases) ln_ratios.push_back(fitted->ln_ratio_at(phase));
    const auto n = static_cast<double>(ln_ratios.size());
    out.phase_variance = squares_about_mean(ln_ratios) / (n * (n - 1));
  }
}

MrtdPoint BarsJudge::point(const Place& place) const {
  const Thresholds all = thresholds(place, 0, {});
  MrtdPoint out{.place = place.name,
                .axis = place.axis,
                .frequency_per_pitch = place.frequency_per_pitch,
                .size_px = place.size_px,
                .positive_k = all.positive_k,
                .positive_share = all.positive_share,
                .negative_share = all.negative_share};
  if (all.negative_k) out.negative_k = -*all.negative_k;
  if (place.frequency_per_pitch > mrtd_cut_per_pitch) {
    out.reason = "beyond Nyquist: the MRTD is cut there, because the observer discriminates alias patterns";
    return out;
  }
  if (!all.half_k) {
    const auto& shares = all.positive_k ? all.negative_share : all.positive_share;
    out.reason = shares.empty() ? "no contrast was shown"
                 : shares.back() < threshold_share
                     ? fmt::format("no contrast up to {:.3g} K reaches 75 % correct ({:.0f} % at that contrast)",
                                   all.contrast_k.back(), 100 * shares.back())
                     : fmt::format("the smallest contrast, {:.3g} K, is above the threshold", all.contrast_k.front());
    return out;
  }
  out.threshold_k = all.half_k;
  if (observers_.size() == 3)
    out.spread_k = spread_of({thresholds(place, 1, {}).half_k, thresholds(place, 2, {}).half_k});
  out.best_phase_k = all.best_k, out.best_phase = std::abs(all.best_phase);
  std::vector<Thresholds> by_set_up, by_frames;
  for (int s = 0; s < options_.set_ups; ++s)
    by_set_up.push_back(thresholds(place, 0, {.set_up = static_cast<std::size_t>(s)}));
  const auto interval = [&](double value, double variance) -> Interval {
    const double reach = quantile(distribution::StudentsT(options_.set_ups - 1.0), 0.975) * std::sqrt(variance);
    return {value * std::exp(-reach), value * std::exp(reach)};
  };
  const auto set_up_variance = jackknife_variance(by_set_up, &Thresholds::half_k);
  if (set_up_variance) out.ci95 = interval(*all.half_k, *set_up_variance);
  if (!all.best_k || !set_up_variance) return out;
  // Set-ups differ by noise, phase and fixed pattern. The function contains the phase; noise is known from the frames.
  const std::size_t parts = std::min(most_frame_parts, static_cast<std::size_t>(options_.frames));
  for (std::size_t part = 0; part < parts; ++part) by_frames.push_back(thresholds(place, 0, {.frame_part = part}));
  const auto noise = jackknife_variance(by_frames, &Thresholds::half_k);
  const auto best_noise = jackknife_variance(by_frames, &Thresholds::best_k);
  if (!noise || !best_noise) return out;
  const double pattern = std::max(0.0, *set_up_variance - *noise - all.phase_variance);
  out.best_phase_ci95 = interval(*all.best_k, *best_noise + pattern);
  return out;
}

MrtdMeasure BarsJudge::result() const {
  MrtdMeasure out;
  out.plate = options_.plate.name, out.observer = options_.observer.name;
  out.frames = options_.frames, out.set_ups = options_.set_ups;
  out.mountings =
      static_cast<int>(std::min<std::size_t>(options_.mountings.size(), static_cast<std::size_t>(options_.set_ups)));
  out.pitch_mrad = options_.pitch_mrad;
  out.frequency_per_pitch = options_.frequency_per_pitch, out.spot_px = options_.spot_px;
  out.reasons = reasons_;
  if (keeper_.keeps()) out.kept = kept();
  for (std::size_t i = 0; i < said_sum_k_.size(); ++i) {
    if (said_count_[i] > 0) out.contrast_k.push_back(said_sum_k_[i] / said_count_[i]);
  }
  std::ranges::sort(out.contrast_k);
  for (const Place& place : places_) {
    if (!place.left_out) (place.size_px > 0 ? out.spots : out.bars).push_back(point(place));
  }
  std::ranges::stable_sort(out.bars, [](const MrtdPoint& a, const MrtdPoint& b) {
    return std::pair(a.axis, a.frequency_per_pitch) < std::pair(b.axis, b.frequency_per_pitch);
  });
  std::ranges::stable_sort(out.spots, {}, &MrtdPoint::size_px);
  return out;
}

}  // namespace todbench
