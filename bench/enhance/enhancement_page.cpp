// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/enhance/enhancement_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "bench/enhance/decidable.h"
#include "bench/enhance/package_spread.h"
#include "bench/report/number_format.h"
#include "bench/report/report_pieces.h"
#include "bench/report/tod_figures.h"
#include "bench/session/build_info.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

RichText spread_cell(double low, double high) {
  return plain(significant(low, 3) + " to " + significant(high, 3));
}

Section ratios_section(const Enhancement& enhancement) {
  Table table{.caption = "Acuity with each package and its ratio to the acuity without package, paired 95 % intervals",
              .header = {"Package", "Set contrast (K)", "Acuity (1/mrad), 95 %", "Ratio, 95 %"},
              .rows = {}};
  const bool with_spread = any_spread(enhancement);
  if (with_spread) {
    table.caption +=
        ". The last two columns are ranges over the open parameters of the observer and no confidence "
        "intervals: no probability belongs to them";
    table.header.insert(table.header.end(), {"Acuity, open parameters", "Ratio, open parameters"});
  }
  for (const auto& result : enhancement.results) {
    for (const auto& point : result.curve.points) {
      const auto ratio = std::find_if(result.ratios.begin(), result.ratios.end(), [&](const auto& r) {
        return same_contrast(r.set_delta_t_k, point.set_delta_t_k);
      });
      const bool any = ratio != result.ratios.end() && ratio->ratio;
      table.rows.push_back(
          {plain(result.name), plain(stated(point.set_delta_t_k)),
           interval_or_missing(identified_acuity_per_mrad(point), acuity_interval(point.fit.ci95), "no threshold"),
           any ? interval_or_missing(ratio->ratio, ratio->ci95, "no threshold")
               : (result.ratios.empty()
                      ? missing("reference")
                      : missing(ratio != result.ratios.end() && !ratio->withheld.empty() ? ratio->withheld
                                                                                         : "a threshold is missing"))});
      if (!with_spread) continue;
      const auto acuity = acuity_spread_per_mrad(point.s75_spread_mrad);
      table.rows.back().push_back(acuity ? spread_cell(*acuity->low, *acuity->high) : missing("no spread"));
      table.rows.back().push_back(any && ratio->spread ? spread_cell(ratio->spread->first, ratio->spread->second)
                                                       : missing(result.ratios.empty() ? "reference" : "no spread"));
    }
  }
  return {"Acuity and ratio", {std::move(table)}};
}

Section curves_section(const Enhancement& enhancement) {
  FigurePairs figures;
  const auto& none = enhancement.results.front();
  for (std::size_t i = 1; i < enhancement.results.size(); ++i) {
    const auto& result = enhancement.results[i];
    if (result.curve.points.empty()) continue;
    Plot plot = tod_figure({none.name, &none.curve}, {result.name, &result.curve}, {});
    plot.id = fmt::format("curve-{}", i);
    plot.width = 430;
    figures.figures.push_back({drawn(plot), "none and " + result.name});
  }
  return {"TOD curves", {std::move(figures)}};
}

Section cost_section(const Enhancement& enhancement, double frame_rate_hz) {
  Table table{.caption = "Time cost of the packages",
              .header = {"Package", "Frames", "Bench time at the camera's rate (s)", "Stages, median (ms per frame)",
                         "Clipped pixels", "Ended by"},
              .rows = {}};
  for (const auto& result : enhancement.results) {
    table.rows.push_back({plain(result.name), plain(std::to_string(result.frames)),
                          frame_rate_hz > 0 ? plain(significant(static_cast<double>(result.frames) / frame_rate_hz, 3))
                                            : missing("no frame rate"),
                          plain(significant(result.frame_ms, 3)), plain(std::to_string(result.clipped_pixels)),
                          result.error ? badge(result.error->message, Mood::bad) : plain("end of the run")});
  }
  return {"Time", {std::move(table)}};
}

Section record_section(const LoadedPlan& loaded, const std::vector<EnhancementPackage>& packages,
                       const Enhancement& enhancement) {
  ValueTable values{.caption = "Origin of the numbers", .values = {}};
  values.values = {{"Program", plain("todbench " + std::string(build_info().version) + " (" +
                                     std::string(build_info().commit) + ")")},
                   {"Plan", plain(loaded.plan().name)},
                   {"Camera", plain(enhancement.camera)},
                   {"Observer", plain(loaded.observer().name)},
                   {"Seed", plain(std::to_string(loaded.plan().seed))},
                   {"Exposures discarded after a change", plain(std::to_string(enhancement.settle_frames))}};
  for (const auto& package : packages) {
    values.values.push_back({package.name, plain((package.description.empty() ? "" : package.description + "; ") +
                                                 "file SHA-256 " + package.sha256)});
    for (const auto& record : package.provenance) values.values.push_back({package.name, plain(record)});
  }
  for (const PackageResult& result : enhancement.results) {
    for (const TodPoint& point : result.curve.points) {
      if (const auto judged = judged_point(result, point.set_delta_t_k))
        values.values.push_back(
            {result.name,
             plain(fmt::format(
                 "{:g} K: the package multiplies the contrast by {:.4g}; the noise given to the observer is "
                 "{:.4f} K at the input of the package",
                 point.set_delta_t_k, judged->gain, judged->noise_k))});
    }
    if (result.samples_per_pixel > 1)
      values.values.push_back(
          {result.name, plain(fmt::format("judged with {0} x {0} samples per pixel", result.samples_per_pixel))});
  }
  if (enhancement.dither > 1)
    values.values.push_back(
        {"Dither", plain(fmt::format("{0} x {0} positions within a pixel in turn", enhancement.dither))});
  return {"Record", {std::move(values)}};
}

/// Returns the value below which this share of the pixels lies.
double quantile(const cv::Mat1w& picture, double share) {
  std::vector<std::uint16_t> values(picture.begin(), picture.end());
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

}  // namespace

Document enhancement_page(const LoadedPlan& loaded, const std::vector<EnhancementPackage>& packages,
                          const Enhancement& enhancement) {
  Document document{.title = "Enhancement " + loaded.plan().name,
                    .heading = "Enhancement under test",
                    .subtitle = fmt::format("{} packages after {}, judged by {}", packages.size(), enhancement.camera,
                                            loaded.observer().name),
                    .page_label = loaded.plan().name,
                    .opening = {},
                    .sections = {}};
  document.opening.emplace_back(Paragraph{
      plain("Every package received the same frames. One picture of each is in pictures.png, in the order of the "
            "tables. The position of the plate and its contrast were measured in the pictures of the camera, before "
            "the packages.")});
  if (!enhancement.warnings.empty()) document.opening.emplace_back(list_of(enhancement.warnings));
  document.sections = {ratios_section(enhancement), curves_section(enhancement),
                       cost_section(enhancement, enhancement.frame_rate_hz),
                       record_section(loaded, packages, enhancement)};
  return document;
}

cv::Mat1b side_by_side(const Enhancement& enhancement) {
  constexpr int gap = 8;
  std::vector<cv::Mat1w> pictures;
  for (const auto& result : enhancement.results) {
    if (!result.picture.empty()) pictures.push_back(result.picture);
  }
  if (pictures.empty()) return {};
  const int rows = pictures.front().rows, columns = pictures.front().cols, count = static_cast<int>(pictures.size());
  cv::Mat1b strip(rows, count * columns + (count - 1) * gap, std::uint8_t{255});
  for (int i = 0; i < count; ++i) {
    // Finer pictures are shown in the size of the others.
    cv::Mat1w picture = pictures[static_cast<std::size_t>(i)];
    if (picture.size() != pictures.front().size())
      cv::resize(picture.clone(), picture, pictures.front().size(), 0, 0, cv::INTER_AREA);
    const double low = quantile(picture, 0.001), high = std::max(quantile(picture, 0.999), low + 1);
    cv::Mat1b shown;
    picture.convertTo(shown, CV_8U, 255 / (high - low), -low * 255 / (high - low));
    shown.copyTo(strip(cv::Rect(i * (columns + gap), 0, columns, rows)));
  }
  return strip;
}

}  // namespace todbench
