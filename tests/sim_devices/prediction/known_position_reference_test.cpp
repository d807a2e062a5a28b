// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cmath>

#include "hvs/observer/known_position.h"
#include "hvs/shape/polygon_image.h"
#include "sim_devices/sensor/image_chain.h"
#include "sim_devices/sensor/transfer_functions.h"
#include "tests/sim_devices/reference.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

/// Template of the recommended observer at the window centre, in double precision: triangle through Gauss(0.6) and
/// box(1).
cv::Mat1d viewed_template(double size, Apex apex, int window) {
  const FilterTable filter({.period = 2 * window, .band = 5 * window}, [](double u, double w) -> std::complex<double> {
    const auto sinc = [](double x) { return x == 0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x); };
    return sinc(u) * sinc(w) * std::exp(-2 * std::pow(0.6 * std::numbers::pi, 2) * (u * u + w * w));
  });
  const double first = -window / 2.0 + 0.5;
  cv::Mat1d t = PolygonImage(triangle(size, apex), filter).sample({first, first}, 1, {window, window});
  t -= cv::mean(t)[0];
  return t / cv::norm(t);
}

TEST(KnownPositionReference, ProportionsCorrectGramRowAndMeanResponsesEqualTheReference) {
  const SensorSpec spec = test::sc2000();
  const FilterTable sensor({.period = 32, .band = 203}, sensor_transfer(spec, full_plan(spec, {}, {}), 16));
  const auto document = test::reference();
  for (const auto& item : document.at("known_position_analytic").at("cases")) {
    const double size = item.at("S");
    const int window = item.at("n_samples");
    std::array<cv::Mat1d, 4> templates;
    for (const Apex apex : all_apexes) templates[static_cast<std::size_t>(apex)] = viewed_template(size, apex, window);
    KnownPositionTask task;
    task.noise = item.at("q");
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 4; ++j) task.gram[i][j] = templates[i].dot(templates[j]);
      EXPECT_NEAR(task.gram[0][i], item["gram_row0"][i].get<double>(), 1e-12);
    }
    const PolygonImage image(triangle(size, Apex::up), sensor);
    const int phases = item.at("nphi");
    double mean = 0;
    for (int j = 0; j < phases; ++j) {
      for (int i = 0; i < phases; ++i) {
        const double x = -window / 2.0 + 0.5 - 0.5 + (i + 0.5) / phases;
        const double y = -window / 2.0 + 0.5 - 0.5 + (j + 0.5) / phases;
        const cv::Mat1d patch = image.sample({x, y}, 1, {window, window});
        for (std::size_t o = 0; o < 4; ++o) {
          task.mean[o] = patch.dot(templates[o]);
          // The reference wraps at another period; what wraps is nearly constant over the window.
          if (i == 0 && j == 0) {
            EXPECT_NEAR(task.mean[o], item["mu_phase0"][o].get<double>(), 1e-6);
          }
        }
        const double p = probability_correct(task, 192);
        const auto index = static_cast<std::size_t>(j * phases + i);
        if (index < 4) {
          EXPECT_NEAR(p, item["pc_first4"][index].get<double>(), 1e-6);
        }
        mean += p / (phases * phases);
      }
    }

    EXPECT_NEAR(mean, item["pc_mean"].get<double>(), 1e-6);
  }
}

}  // namespace
}  // namespace todbench
