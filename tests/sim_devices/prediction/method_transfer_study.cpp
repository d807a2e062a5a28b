// SPDX-License-Identifier: GPL-3.0-or-later
// Transfer between TOD and four bars over ten imagers and six edge filters, and rankings of the imagers by four
// observers. Prints the tables of docs/validation/ranges.md. TODBENCH_STUDY_SEED: seed (1).
#include <cstdio>
#include <cstdlib>

#include "hvs/eye/contrast_sensitivity.h"
#include "tests/sim_devices/prediction/observer_ranking.h"
#include "tests/sim_devices/prediction/transfer_fit.h"
#include "tests/support/rank_correlation.h"

namespace todbench::testing {
namespace {

MethodDesign design() {
  const char* seed = std::getenv("TODBENCH_STUDY_SEED");
  return {.seed = seed != nullptr ? std::strtoull(seed, nullptr, 10) : 1};
}

/// Points of an imager, printed with their residuals to a transfer.
std::vector<MethodPoint> printed(const SensorSpec& sensor, const TemplateObserverSpec& observer,
                                 const TodTransfer& transfer, const MethodDesign& design) {
  std::printf("| %s | transfer at Nyquist %.3f | bars end at %.3f |\n", sensor.name.c_str(),
              transfer_at_nyquist(sensor), end_of_bars(sensor));
  const auto points = method_points(sensor, observer, design);
  for (const MethodPoint& p : points) {
    std::printf("| %s | %g | A / N %.4f | A / A0 %.4f | f / N %.4f | %s | f / A %.4f | residual %+.3f |\n",
                p.imager.c_str(), p.over_netd, p.acuity_over_nyquist, p.acuity_share, p.bars_over_nyquist,
                p.at_end ? "end" : "", p.factor(), residual(transfer, p));
  }
  std::fflush(stdout);
  return points;
}

void add(std::vector<MethodPoint>& all, const std::vector<MethodPoint>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

/// Prints rms and largest residual and the share within the interval.
double share_within(const char* name, const TodTransfer& transfer, const std::vector<MethodPoint>& points) {
  double largest = 0, within = 0;
  std::vector<double> residuals;
  for (const MethodPoint& point : points) {
    residuals.push_back(residual(transfer, point));
    if (std::abs(residuals.back()) > std::abs(largest)) largest = residuals.back();
    within += std::abs(residuals.back()) <= transfer.half_width_ln ? 1 : 0;
  }
  within /= static_cast<double>(points.size());
  std::printf("# %s: %zu points, rms %.3f, largest %+.3f, within the interval %.2f\n", name, points.size(),
              rms(residuals), largest, within);
  return within;
}

TEST(MethodTransfer, OfTenImagersIsThePublishedOne) {
  const TodTransfer published = tod_transfers().front();
  std::vector<MethodPoint> points;
  for (const SensorSpec& sensor : studied_imagers()) add(points, printed(sensor, {}, published, design()));
  const TodTransfer found = studied_transfer(points);
  std::printf("# low %.4f high %.4f centre %.4f width %.4f from %.4f half-width %.4f rms left out %.4f\n", found.ln_low,
              found.ln_high, found.ln_centre, found.ln_width, found.least, found.half_width_ln,
              rms(left_out_residuals(points)));
  EXPECT_GE(share_within("ten imagers", published, points), 0.95);
  for (double place = found.least; place <= 1; place *= 1.1)
    EXPECT_NEAR(std::log(transfer_factor(found, place) / transfer_factor(published, place)), 0,
                0.25 * published.half_width_ln)
        << place;
}

TEST(MethodTransfer, HoldsForWeakEdgeFilters) {
  std::vector<MethodPoint> weak;
  for (const SensorSpec& sensor : filtered_imagers()) {
    const auto points = printed(sensor, {}, tod_transfers().front(), design());
    share_within(sensor.name.c_str(), tod_transfers().front(), points);
    if (sensor.edge_boost <= TodTransfer::highest_edge_boost) add(weak, points);
  }
  EXPECT_GE(share_within("weak filters", tod_transfers().front(), weak), 0.95);
}

TEST(MethodTransfer, ElsewhereIsReported) {
  const SensorSpec plain = studied_imagers()[3];
  SensorSpec scanned = plain, pattern = plain, bilinear = plain;
  scanned.microscan = 2;
  scanned.name += ", microscan 2";
  pattern.fixed_pattern_k = plain.netd_k;
  pattern.name += ", fixed pattern = NETD";
  bilinear.display = DisplayReconstruction::bilinear;
  bilinear.name += ", bilinear display";
  TemplateObserverSpec human_like;
  human_like.name = "human-like-1";
  human_like.blur_sigma_samples = 0.5;
  human_like.internal_noise = 0.025;
  human_like.sensor_noise_factor = 1.75;
  for (const SensorSpec& sensor : {scanned, pattern, bilinear})
    share_within(sensor.name.c_str(), tod_transfers().front(), printed(sensor, {}, tod_transfers().front(), design()));
  MethodDesign dim = design();
  dim.over_netd = {0.7, 200};
  std::vector<MethodPoint> dark;
  for (const SensorSpec& sensor : studied_imagers())
    dark.push_back(printed(sensor, {}, tod_transfers().front(), dim).front());
  share_within("0.7 times the noise, ten imagers", tod_transfers().front(), dark);
  std::vector<MethodPoint> points;
  for (const std::size_t i : {1U, 4U, 8U})
    add(points, printed(studied_imagers()[i], human_like, tod_transfers().front(), design()));
  share_within("human-like-1, three imagers", tod_transfers().front(), points);
}

/// hvs-2 at a display whose samples are 3 arcmin.
TemplateObserverSpec viewer() {
  return {.name = "hvs-2",
          .internal_noise = 0,
          .sensor_noise_factor = 1.75,
          .eye = EyeParameters{},
          .window_margin_arcmin = 6,
          .display = ViewedDisplay{.pixel_pitch_mm = 1000 * 2 * std::tan(3.0 / 120 * std::numbers::pi / 180),
                                   .viewing_distance_m = 1,
                                   .luminance_white_cd_m2 = 100}};
}

double direct_s75_pitch(const SensorSpec& sensor, const TemplateObserverSpec& spec, double delta_t_k) {
  TemplateObserver observer(spec, triangle_alternatives());
  const auto found = direct_estimate(sensor, full_plan(sensor, {}, {}), observer, {delta_t_k},
                                     {.accuracy = design().accuracy, .seed = design().seed});
  EXPECT_TRUE(found) << sensor.name << " " << spec.name << ": " << found.error().message;
  return found ? found->front().s75_pitch : 0;
}

TEST(ObserverRankings, OfTenImagersWithOneAngleOfAPixel) {
  ModulePlan matched_filter;
  matched_filter.place = ModulePlace::observer;
  matched_filter.command = "/usr/bin/python3 " + source_file("docs/examples/modules/observer.py");
  for (const double delta_t_k : {0.2, 1.0}) {
    Rankings rankings;
    for (const SensorSpec& sensor : studied_imagers()) {
      const ShownTriangles shown(sensor);
      rankings["hvs-1"].push_back(direct_s75_pitch(sensor, {}, delta_t_k));
      rankings["hvs-2"].push_back(direct_s75_pitch(sensor, viewer(), delta_t_k));
      rankings["ideal"].push_back(ideal_s75_pitch(shown, delta_t_k));
      rankings["matched filter"].push_back(program_s75_pitch(shown, delta_t_k, matched_filter, 6, design().seed));
      std::printf("| %g K | %s | hvs-1 %.3f | hvs-2 %.3f | ideal %.3f | matched filter %.3f |\n", delta_t_k,
                  sensor.name.c_str(), rankings["hvs-1"].back(), rankings["hvs-2"].back(), rankings["ideal"].back(),
                  rankings["matched filter"].back());
      std::fflush(stdout);
    }
    for (auto a = rankings.begin(); a != rankings.end(); ++a) {
      for (auto b = std::next(a); b != rankings.end(); ++b) {
        const auto found = rank_correlation(a->second, b->second);
        ASSERT_TRUE(found) << found.error().message;
        std::printf("# %g K | %s | %s | rho %.3f | %.3f to %.3f | p %.4f |\n", delta_t_k, a->first.c_str(),
                    b->first.c_str(), found->rho, *found->ci95.low, *found->ci95.high, found->p);
      }
    }
  }
}

}  // namespace
}  // namespace todbench::testing
