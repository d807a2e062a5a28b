// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of every part of the computation. Every compiler and processor must find them within 1e-12.
#include <algorithm>
#include <cmath>

#include "bench/selftest/selftest_cases.h"
#include "hvs/observer/known_position.h"
#include "sim_devices/prediction/cued_estimate.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "sim_devices/sensor/sensor_model.h"
#include "sim_devices/sensor/transfer_functions.h"
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

}  // namespace

std::map<std::string, double> numbers_of_every_part() {
  Numbers found;
  add_fits(found);
  add_images(found);
  return found;
}

const std::map<std::string, double>& golden_numbers() {
  static const Numbers golden{{"cued", 1.7108450253004055},
                              {"direct", 1.6102116547495005},
                              {"direct standard error", 0.0084110249060085646},
                              {"fit acuity high", 1.7634814497629638},
                              {"fit acuity lapse high", 1.7860249119561697},
                              {"fit acuity lapse likelihood", -48.985280144057285},
                              {"fit acuity lapse low", 0.85712496779164316},
                              {"fit acuity lapse posterior high", 1.4624397195713121},
                              {"fit acuity lapse posterior low", 0.92677375398497064},
                              {"fit acuity lapse slope", 2.9489384636119178},
                              {"fit acuity lapse standard error", 0.1116202526435027},
                              {"fit acuity lapse threshold", 1.1128025714278946},
                              {"fit acuity likelihood", -48.809476931445666},
                              {"fit acuity low", 0.86113565500679135},
                              {"fit acuity posterior high", 1.454610045180305},
                              {"fit acuity posterior low", 0.93144690649719508},
                              {"fit acuity slope", 2.8994946786169229},
                              {"fit acuity standard error", 0.10885564488483912},
                              {"fit acuity threshold", 1.1129872567547694},
                              {"fit size high", 1.8081934456162012},
                              {"fit size lapse high", 1.8233527998965042},
                              {"fit size lapse likelihood", -48.459534285255955},
                              {"fit size lapse low", 0.93703375701960478},
                              {"fit size lapse posterior high", 1.5659847790222681},
                              {"fit size lapse posterior low", 1.0188675083459804},
                              {"fit size lapse slope", 2.6339443934330307},
                              {"fit size lapse standard error", 0.10175075936235795},
                              {"fit size lapse threshold", 1.2025994194030256},
                              {"fit size likelihood", -48.259955947402929},
                              {"fit size low", 0.94253664801027159},
                              {"fit size posterior high", 1.5623327722730216},
                              {"fit size posterior low", 1.0291394521550064},
                              {"fit size slope", 2.6065544176330486},
                              {"fit size standard error", 0.099926046282858616},
                              {"fit size threshold", 1.2047684074180878},
                              {"known position", 0.67385391999509736},
                              {"optics", 0.83982895743607844},
                              {"pixel 0", 0.00077062574489721481},
                              {"pixel 1", 0.0031601300778775492},
                              {"pixel 2", 0.30085815418887935},
                              {"pixel 3", 0.96480211682705108},
                              {"pixel 4", 0.31980232928882352},
                              {"pixel 5", 0.0031357786127624134},
                              {"pixel 6", 0.00068539243026309344},
                              {"power", 0.8536441625743465},
                              {"psi mean", -0.20080475358939509},
                              {"psi sd", 0.10745814221295445},
                              {"range", 570.78600007239561},
                              {"spectrum im", 0.16494282371577385},
                              {"spectrum re", -0.20185882978141009},
                              {"sum of counts", 384009510}};
  return golden;
}

void add_every_part(SelftestCases& cases) {
  const Numbers found = numbers_of_every_part();
  for (const auto& [name, expected] : golden_numbers()) {
    const auto value = found.find(name);
    cases.push_back({"every part", name, value == found.end() ? NAN : value->second, expected,
                     1e-12 * std::max(1.0, std::abs(expected))});
  }
}

}  // namespace todbench
