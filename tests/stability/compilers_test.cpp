// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of every part of the computation, found again within 1e-12 by another compiler. The file was written by GCC
// 12; TODBENCH_WRITE_GOLDEN=FILE in the environment writes a new one.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "hvs/observer/known_position.h"
#include "sim_devices/prediction/cued_estimate.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "sim_devices/sensor/sensor_model.h"
#include "sim_devices/sensor/transfer_functions.h"
#include "tests/support/source_file.h"
#include "tod/comparison/planning.h"
#include "tod/plate/test_pattern.h"
#include "tod/range/range_prediction.h"
#include "tod/schedule/psi_placement.h"

namespace todbench {
namespace {

using Numbers = std::map<std::string, double>;

void add_fits(Numbers& out) {
  const std::vector<Level> levels{{0.5, 6, 20, 0}, {0.9, 11, 20, 1}, {1.4, 17, 20, 2}, {3, 20, 20, 3}, {0.7, 9, 20, 4}};
  for (const PsychometricForm form : {PsychometricForm::size, PsychometricForm::acuity}) {
    for (const double lapse : {0.0, 0.01}) {
      const auto fit = fit_psychometric(levels, {.form = form, .fixed_lapse = lapse}).value();
      const std::string name = "fit " + std::string(to_string(form)) + (lapse > 0 ? " lapse " : " ");
      out[name + "threshold"] = fit.threshold.value();
      out[name + "slope"] = fit.slope.value();
      out[name + "low"] = fit.ci95.low.value();
      out[name + "high"] = fit.ci95.high.value();
      out[name + "likelihood"] = fit.log_likelihood.value();
      out[name + "standard error"] = fit.se_ln_threshold.value();
      out[name + "posterior low"] = fit.posterior->low;
      out[name + "posterior high"] = fit.posterior->high;
    }
  }
  PsiPlacement placement({.first_size = 0.2, .last_size = 5}, RandomStream(3, "psi"));
  for (int i = 0; i < 30; ++i) placement.observe(placement.next(), i % 4 != 1 ? 1 : 0, 1);
  out["psi mean"] = placement.mean_ln_threshold();
  out["psi sd"] = placement.sd_ln_threshold();
  out["power"] = equivalence_power(0.03, 10, 0.01);
  const std::vector<TodThreshold> curve{{16.9, 1.5, {1.4, 1.6}}, {1.93, 1.8, {1.7, 1.9}}, {0.23, 2.6, {2.4, 2.8}}};
  out["range"] = predict_range(curve, {.size_m = 5, .delta_t_k = 4, .extinction_per_km = 0.3})->r75_m.value();
}

void add_images(Numbers& out) {
  const SensorSpec spec;
  const SensorPlan plan = full_plan(spec, {}, {});
  const auto spectrum = polygon_spectrum(triangle(1.7, Apex::left, {0.3, -0.2}), 0.7, -1.3);
  out["spectrum re"] = spectrum.real();
  out["spectrum im"] = spectrum.imag();
  const OpticsMtf optics(spec, plan, 16);
  out["optics"] = optics(0.6);
  const ImageChain chain(spec, plan, Accuracy::normal());
  const cv::Mat1d pixels = chain.image(triangle(2.6, Apex::right, {0.3, 0.1})).sample({-3, -3}, 1, {7, 7});
  for (int i = 0; i < 7; ++i) out["pixel " + std::to_string(i)] = pixels(i, 6 - i);
  KnownPositionTask task;
  task.mean = {1.231, 1.214, 1.207, 1.224};
  const double g[4] = {1, 0.9932, 0.9864, 0.9932};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) task.gram[i][j] = g[(j + 4 - i) % 4];
  }
  task.noise = 0.1;
  out["known position"] = probability_correct(task, 32);
  TemplateObserver observer({}, triangle_alternatives());
  out["cued"] = CuedEstimate(spec, plan, observer).s75_pitch(0.1).value();
  const auto direct = direct_estimate(spec, plan, observer, {1.93}, {.accuracy = Accuracy::draft()}).value()[0];
  out["direct"] = direct.s75_pitch;
  out["direct standard error"] = direct.standard_error_pitch;
  PlateScene scene;
  scene.plate.triangles = {{.name = "only", .position_mm = {10, -20}, .size_mm = 12, .apex = Apex::right}};
  scene.delta_t_k = 1.93;
  const SensorModel model(spec, plan, Accuracy::normal(), 1);
  const cv::Mat1w frame = model.expose(scene, 3);
  out["sum of counts"] = cv::sum(frame)[0];
}

TEST(Compilers, FindTheSameNumbers) {
  Numbers found;
  add_fits(found);
  add_images(found);
  if (const char* path = std::getenv("TODBENCH_WRITE_GOLDEN"); path != nullptr) {
    std::ofstream(path) << nlohmann::json(found).dump(1) << "\n";
    GTEST_SKIP() << "wrote " << path;
  }
  std::ifstream file(source_file("tests/golden/compilers.json"));
  const auto golden = nlohmann::json::parse(file);

  ASSERT_EQ(golden.size(), found.size());
  for (const auto& [name, value] : found) {
    ASSERT_TRUE(golden.contains(name)) << name;
    const double expected = golden[name].get<double>();
    EXPECT_NEAR(value, expected, 1e-12 * std::max(1.0, std::abs(expected))) << name;
  }
}

}  // namespace
}  // namespace todbench
