// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/studies/vision.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string_view>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/plan/descriptions.h"
#include "bench/studies/measured_eye.h"
#include "bench/studies/people_figures.h"
#include "bench/studies/vision_figures.h"
#include "bench/studies/vision_ratios.h"
#include "hvs/eye/compact_patterns.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

/// Luminance contrast of printed optotypes.
constexpr double printed_contrast = 0.95;

constexpr const char* castle_source =
    "castleCSF data (gfxdisp/castleCSF, MIT licence, (c) 2023 University of Cambridge), converted from cone contrast "
    "to luminance contrast";
constexpr const char* modelfest_source =
    "ModelFest (Carney et al. 1999): mean of 16 people, 30 cd/m2, 84 % of two-alternative forced choice";

VisionPoint grating_point(const MeasuredEye& eye, const people::Grating& grating) {
  const std::string_view study = grating.study;
  const bool four = study == "Wuerger 2020" || study == "Mantiuk 2011";
  return {fmt::format("{}: {:g} cd/m2, {:g} 1/deg, sigma {:.2g} deg", study, grating.luminance_cd_m2,
                      grating.frequency_per_degree, grating.sigma_deg),
          grating.sensitivity,
          eye.at(grating.luminance_cd_m2).gabor_d_prime(grating.frequency_per_degree, grating.sigma_deg) /
              (four ? four_alternatives : two_alternatives)};
}

VisionKind small_discs(const MeasuredEye& eye) {
  VisionKind kind{.name = "small_discs",
                  .title = "Small discs",
                  .quantity = "sensitivity (1 / contrast)",
                  .failure = {},
                  .source = std::string("Wuerger et al. 2020, ") + castle_source,
                  .remark =
                      "ModelFest's disc of 7.5 arcmin radius is described to 1.5 dB, so the two sets of figures "
                      "contradict each other by a factor of about 3. The reason is not known. Discs were not in "
                      "the fit.",
                  .points = {}};
  for (const auto& disc : people::discs) {
    kind.points.push_back({fmt::format("{:g} cd/m2, radius {:.3g} deg", disc.luminance_cd_m2, disc.radius_deg),
                           disc.sensitivity,
                           disc_d_prime(eye.at(disc.luminance_cd_m2), disc.radius_deg) / four_alternatives});
  }
  kind.failure = fmt::format("The model sees discs up to {:.0f} dB worse than these people, a factor of {:.1f}.",
                             -errors_of(kind).largest, std::pow(10, -errors_of(kind).largest / 20));
  return kind;
}

VisionKind other_laboratories(const MeasuredEye& eye) {
  VisionKind kind{.name = "other_laboratories",
                  .title = "Laboratories outside the fit",
                  .quantity = "sensitivity (1 / contrast)",
                  .failure = {},
                  .source = std::string("Snowden 1995, Virsu 1982, Wright 1983; ") + castle_source,
                  .remark =
                      "The 24 points were declared before the model was computed for them, and the model was "
                      "not fitted again.",
                  .points = {}};
  for (const auto& grating : people::other_laboratories) kind.points.push_back(grating_point(eye, grating));
  kind.failure = fmt::format("{:.1f} dB rms and {:+.1f} dB on average: laboratories differ more than the fit shows.",
                             errors_of(kind).rms, errors_of(kind).mean);
  return kind;
}

VisionKind reading(const MeasuredEye& eye) {
  VisionKind kind{.name = "reading",
                  .title = "Reading at low contrast",
                  .quantity = "acuity relative to full contrast",
                  .error = VisionError::log10,
                  .failure = {},
                  .source = "Reading acuity of 14 people (abstract, cir.nii.ac.jp 1522262179753702912)",
                  .remark =
                      "The model reads a Landolt ring. The luminance is not stated; 100 cd/m2 is assumed, and "
                      "the ratios hardly depend on it.",
                  .points = {}};
  const double full = eye.acuity(assumed_cd_m2, 1);
  for (const auto& [contrast, loss] : people::reading_losses)
    kind.points.push_back(
        {fmt::format("contrast {:g}", contrast), std::pow(10, -loss), eye.acuity(assumed_cd_m2, contrast) / full});
  kind.failure =
      fmt::format("Acuity falls too steeply with contrast, by up to {:.2f} log10.", -errors_of(kind).largest);
  return kind;
}

VisionKind light(const MeasuredEye& eye) {
  VisionKind kind{.name = "light",
                  .title = "Acuity and contrast threshold over luminance",
                  .quantity = "ratio",
                  .error = VisionError::log10,
                  .failure = {},
                  .source =
                      "Rabin 1994, Optom. Vis. Sci. 71; Sheedy, Bailey and Raasch 1984, Am. J. Optom. Physiol. "
                      "Opt. 61 (abstracts)",
                  .remark =
                      "Letters in the sources, a Landolt ring here. The size of Rabin's letters of low contrast "
                      "is assumed (gap 1.25 arcmin).",
                  .points = {}};
  constexpr double bright = 116, dark = 0.23, small_letter_arcmin = 1.25;
  kind.points.push_back({"acuity, 116 to 0.23 cd/m2 (Rabin)", 3,
                         eye.acuity(bright, printed_contrast) / eye.acuity(dark, printed_contrast)});
  kind.points.push_back(
      {"contrast of small letters, 116 to 0.23 cd/m2 (Rabin)", 17,
       eye.threshold_contrast(dark, small_letter_arcmin) / eye.threshold_contrast(bright, small_letter_arcmin)});
  // One letter of a row of five is 0.02 log10 for each doubling, over log2(600 / 40) of them.
  const double doublings = std::log2(600.0 / 40);
  kind.points.push_back({"acuity, 40 to 600 cd/m2 (Sheedy)", std::pow(10, 0.02 * doublings),
                         eye.acuity(600, printed_contrast) / eye.acuity(40, printed_contrast)});
  const double doubling = std::log10(kind.points.back().model) / doublings;
  kind.failure =
      fmt::format("Acuity rises too steeply with luminance: {:.3f} log10 for each doubling, people 0.02.", doubling);
  return kind;
}

VisionKind gratings(const MeasuredEye& eye) {
  VisionKind kind{.name = "contrast_sensitivity",
                  .title = "Contrast sensitivity",
                  .quantity = "sensitivity (1 / contrast)",
                  .role = VisionRole::fitted,
                  .failure = {},
                  .source = castle_source,
                  .remark =
                      "Every third of the figures of the fit, in the order of the collection. The d' at "
                      "threshold is assumed from the procedure: 1.68 for Wuerger and Mantiuk (four "
                      "alternatives), 1.41 for the others.",
                  .points = {}};
  for (const auto& grating : people::gratings) kind.points.push_back(grating_point(eye, grating));
  return kind;
}

VisionKind modelfest_gabors(const MeasuredEye& eye) {
  VisionKind kind{.name = "modelfest_gabors",
                  .title = "ModelFest, Gabor patterns",
                  .quantity = "sensitivity (1 / contrast)",
                  .role = VisionRole::fitted,
                  .failure = {},
                  .source = modelfest_source,
                  .remark = "A part of these patterns was in the fit.",
                  .points = {}};
  const EyeFilter filter = eye.at(30);
  for (const auto& pattern : people::modelfest_gabors) {
    kind.points.push_back({fmt::format("{:g} 1/deg, sigma {:g} deg", pattern.frequency_per_degree, pattern.sigma_deg),
                           std::pow(10, pattern.log10_sensitivity),
                           filter.gabor_d_prime(pattern.frequency_per_degree, pattern.sigma_deg) / two_alternatives});
  }
  return kind;
}

VisionKind modelfest_compact(const MeasuredEye& eye) {
  VisionKind kind{.name = "compact_patterns",
                  .title = "ModelFest, compact patterns",
                  .quantity = "sensitivity (1 / contrast)",
                  .failure = {},
                  .source = modelfest_source,
                  .remark =
                      "Predicted from the fit to gratings. All errors have one sign. The dipole is taken as two "
                      "adjacent stripes of 0.5 arcmin.",
                  .points = {}};
  const EyeFilter filter = eye.at(30);
  for (const auto& blob : people::modelfest_blobs) {
    kind.points.push_back({fmt::format("blob, sigma {:g} arcmin", blob.sigma_arcmin),
                           std::pow(10, blob.log10_sensitivity),
                           blob_d_prime(filter, blob.sigma_arcmin / 60) / two_alternatives});
  }
  constexpr double stripe_deg = 0.5 / 60, window_deg = 0.5, disc_deg = 0.125;
  kind.points.push_back({"line", std::pow(10, people::modelfest_line),
                         line_d_prime(filter, stripe_deg, window_deg, LineProfile::line) / two_alternatives});
  kind.points.push_back({"dipole", std::pow(10, people::modelfest_dipole),
                         line_d_prime(filter, stripe_deg, window_deg, LineProfile::dipole) / two_alternatives});
  kind.points.push_back({"disc, radius 0.125 deg", std::pow(10, people::modelfest_disc),
                         disc_d_prime(filter, disc_deg) / two_alternatives});
  return kind;
}

VisionKind landolt(const MeasuredEye& eye) {
  VisionKind kind{.name = "landolt",
                  .title = "Landolt ring over luminance and contrast",
                  .quantity = "acuity (1/arcmin)",
                  .error = VisionError::log10,
                  .role = VisionRole::chosen,
                  .failure = {},
                  .source =
                      "Formula of Ikeda, Noda and Yamaguchi (quoted by saecanet.com; people and criterion are not "
                      "stated)",
                  .remark =
                      "The shape of the surface is predicted. Its level was set by the number of channels of "
                      "uncertainty, which was chosen after these figures were seen. 62.5 % correct of four "
                      "directions.",
                  .points = {}};
  for (const double luminance : {1, 3, 10, 30, 100, 300, 1000, 3000}) {
    for (const double percent : {3, 5, 10, 20, 30, 50, 95})
      kind.points.push_back({fmt::format("{:g} cd/m2, {:g} %", luminance, percent),
                             landolt_acuity_of_people(luminance, percent), eye.acuity(luminance, percent / 100)});
  }
  return kind;
}

VisionKind acuity_of_130(const MeasuredEye& eye) {
  VisionKind kind{.name = "acuity_130_people",
                  .title = "Acuity of 130 people",
                  .quantity = "acuity (1/arcmin)",
                  .error = VisionError::log10,
                  .failure = {},
                  .source = "optikum.at, Landolt rings of four directions, both eyes; standard errors 0.03",
                  .remark = "The luminance is not stated; 100 cd/m2 and a contrast of 95 % are assumed.",
                  .points = {}};
  const double model = eye.acuity(assumed_cd_m2, printed_contrast);
  kind.points.push_back({"Landolt chart", 1.82, model});
  kind.points.push_back({"Freiburg test", 1.93, model});
  return kind;
}

/// The display of the comparison: 3 arcmin a sample, a background of 50 cd/m2, targets at a contrast of 0.5.
ViewedDisplay assumed_display() {
  constexpr double sample_arcmin = 3;
  return {.pixel_pitch_mm = 2000 * std::tan(sample_arcmin / 120 * std::numbers::pi / 180),
          .viewing_distance_m = 1,
          .luminance_white_cd_m2 = 100};
}

Result<VisionKind> microscan_gains_of_a_person(const TemplateObserverSpec& spec, const VisionOptions& options) {
  TODBENCH_TRY(auto sensor, load_sensor("sc2000"));
  TemplateObserverSpec viewing = spec;
  viewing.display = assumed_display();
  const std::vector<double> contrasts{16.9, 1.93, 0.23};
  std::array<std::vector<DirectPoint>, 2> found;
  for (const int samples : {1, 2}) {
    TemplateObserver observer(viewing, triangle_alternatives());
    TODBENCH_TRY(
        auto points,
        direct_estimate(
            sensor, full_plan(sensor, {}, {}), observer, contrasts,
            {.samples_per_pitch = samples, .accuracy = options.accuracy, .seed = options.seed, .stop = options.stop}));
    found[static_cast<std::size_t>(samples - 1)] = std::move(points);
  }
  VisionKind kind{.name = "microscan_gain",
                  .title = "Gain of microscan for a person",
                  .quantity = "gain in acuity (%)",
                  .error = VisionError::points,
                  .failure = {},
                  .source = "EO-VISTA (Bijl, Hogervorst and Vos), one person",
                  .remark =
                      "No test of the model: its open parameters and the viewing distance allow 37 to 81 %, and "
                      "the published gain is uncertain by about 10 points.",
                  .points = {}};
  for (std::size_t i = 0; i < contrasts.size(); ++i)
    kind.points.push_back({fmt::format("SC2000, {:g} K, 3 arcmin a sample", contrasts[i]), 60,
                           100 * (found[0][i].s75_pitch / found[1][i].s75_pitch - 1)});
  return kind;
}

std::vector<VisionOutside> not_comparable() {
  const std::string other_model =
      "Not comparable: another model. The paper compares a person with its own model, which is not available.";
  return {{"Person against the model of the paper, 16.9 K", "+18 %", other_model},
          {"Person against the model of the paper, 0.23 K", "-35 %", other_model},
          {"Bailey-Lovie letters, 130 people", "1.48 /arcmin",
           "Not comparable: letters in rows of five are another task than a single ring."},
          {"Landolt ring at full contrast and much light (VA-CAL 2022)", "-0.47 logMAR",
           "Not comparable: the luminance is not stated in the source."}};
}

}  // namespace

double landolt_acuity_of_people(double luminance_cd_m2, double contrast_percent) {
  const double root = 0.8034 * std::pow(contrast_percent, -0.1876) + std::pow(luminance_cd_m2, 0.25);
  return luminance_cd_m2 / (1.6293 * std::pow(contrast_percent, -0.3234) * std::pow(root, 4));
}

Result<VisionComparison> vision_comparison(const TemplateObserverSpec& observer, const VisionOptions& options) {
  const MeasuredEye eye(*observer.eye);
  // A file that cannot be read ends the work before it begins.
  std::vector<VisionKind> of_file;
  if (!options.figures.empty()) {
    TODBENCH_TRY(of_file, figures_of_people(options.figures, eye));
  }
  VisionComparison out{
      .observer = observer.name,
      .statement = observer.name +
                   " is not a validated model of people. Public data carry the detection of patterns and the shape of "
                   "acuity over luminance and contrast; they do not carry a TOD of people behind a sensor.",
      .kinds = {},
      .not_comparable = not_comparable(),
      .settings = {{"Observer", observer.name},
                   {"Display", "3 arcmin a displayed sample, background 50 cd/m2, luminance contrast of a target 0.5"},
                   {"Seed", std::to_string(options.seed)}}};
  for (const auto kind : {small_discs, other_laboratories, reading, light, gratings, modelfest_gabors,
                          modelfest_compact, landolt, acuity_of_130}) {
    if (options.stop.stop_requested()) return fail(ErrorCode::interrupted, "the comparison was interrupted");
    out.kinds.push_back(kind(eye));
  }
  std::ranges::move(vision_ratios(*observer.eye, eye.acuity(much_light_cd_m2, 1)), std::back_inserter(out.kinds));
  TODBENCH_TRY(auto gains, microscan_gains_of_a_person(observer, options));
  out.kinds.push_back(std::move(gains));
  if (!options.figures.empty()) {
    std::ranges::move(of_file, std::back_inserter(out.kinds));
    out.settings.emplace_back("Figures", options.figures.filename().string());
  }
  std::stable_partition(out.kinds.begin(), out.kinds.end(),
                        [](const VisionKind& kind) { return !kind.failure.empty(); });
  return out;
}

}  // namespace todbench
