// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/transfer_functions.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "sim_devices/sensor/effect_detector.h"
#include "sim_devices/sensor/effect_diffraction.h"
#include "tests/sim_devices/reference.h"

namespace todbench {
namespace {

using test::reference;
using test::sc2000;

TEST(TransferFunctions, EqualTheReferenceAtEveryFrequency) {
  const auto document = reference();
  const auto& mtf = document.at("mtf");
  const SensorSpec spec = sc2000();
  const SensorPlan plan = full_plan(spec, {}, {});
  const auto system = sensor_transfer(spec, plan, 16);
  const OpticsMtf optics(spec, plan, 16);

  // The band average depends on the radiation constant in its eleventh digit, the rest agrees to 1e-12.
  for (std::size_t i = 0; i < mtf.at("freq_cyc_per_pitch").size(); ++i) {
    const double f = mtf["freq_cyc_per_pitch"][i];
    EXPECT_NEAR(diffraction_mtf(f, 7.5, 1, 47.5), mtf["diff_7p5"][i].get<double>(), 1e-12);
    EXPECT_NEAR(diffraction_mtf(f, 10, 1, 47.5), mtf["diff_10"][i].get<double>(), 1e-12);
    EXPECT_NEAR(diffraction_mtf(f, 13, 1, 47.5), mtf["diff_13"][i].get<double>(), 1e-12);
    EXPECT_NEAR(optics(f), mtf["diff_poly16"][i].get<double>(), 1e-10);
    EXPECT_NEAR(detector_mtf(f, 0, 42.5 / 47.5, 42.5 / 47.5), mtf["det"][i].get<double>(), 1e-12);
    EXPECT_NEAR(system(f, 0).real(), mtf["system_x"][i].get<double>(), 1e-10);
    EXPECT_NEAR(system(f / std::sqrt(2.0), f / std::sqrt(2.0)).real(), mtf["system_diag"][i].get<double>(), 1e-10);
    EXPECT_NEAR(f / spec.ifov_mrad(), mtf["freq_cyc_per_mrad"][i].get<double>(), 1e-12);
  }
}

TEST(TransferFunctions, AWavelengthNodeMoreOrLessChangesLittleAndConverges) {
  const SensorSpec spec = sc2000();
  const SensorPlan plan = full_plan(spec, {}, {});
  const auto dense = reference().at("mtf").at("diff_poly400");
  const auto frequencies = reference().at("mtf").at("freq_cyc_per_pitch");

  const auto largest_error = [&](int nodes) {
    const OpticsMtf optics(spec, plan, nodes);
    double largest = 0;
    for (std::size_t i = 0; i < frequencies.size(); ++i)
      largest = std::max(largest, std::abs(optics(frequencies[i]) - dense[i].get<double>()));
    return largest;
  };

  EXPECT_LT(largest_error(64), largest_error(16));
  EXPECT_LT(largest_error(16), largest_error(4));
  EXPECT_LT(largest_error(16), 1e-4);
}

TEST(TransferFunctions, SkippingAnEffectEqualsItsNeutralValueBitForBit) {
  SensorSpec spec = sc2000();
  spec.aberration_sigma_pitch = 0.25;
  SensorSpec neutral = spec;
  neutral.aberration_sigma_pitch = 0;
  const auto skipped = sensor_transfer(spec, full_plan(spec, {Effect::aberration}, {}), 4);
  const auto at_neutral = sensor_transfer(neutral, full_plan(neutral, {}, {Effect::aberration}), 4);
  const auto no_footprint = sensor_transfer(spec, full_plan(spec, {Effect::detector}, {}), 4);

  for (double f = 0; f < 7; f += 0.13) {
    EXPECT_EQ(skipped(f, 0.3 * f), at_neutral(f, 0.3 * f));
    EXPECT_EQ(no_footprint(f, f).real(), OpticsMtf(spec, full_plan(spec, {}, {}), 4)(std::hypot(f, f)));
  }
}

SensorSpec flat_detectors() {
  SensorSpec spec = sc2000();
  spec.detector_um = 40, spec.detector_y_um = 20;
  return spec;
}

TEST(TransferFunctions, OfAFlatDetectorHaveASincOfEachAxis) {
  const SensorSpec spec = flat_detectors();
  const SensorPlan plan = full_plan(spec, {}, {});
  const auto system = sensor_transfer(spec, plan, 16);
  const auto tabulated = tabulated_transfer({.period = 16, .band = 64}, {.spec = spec, .plan = plan});
  const OpticsMtf optics(spec, plan, 16);
  const auto sinc = [](double x) { return x == 0 ? 1 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x); };
  const double a = 40 / spec.pitch_um, b = 20 / spec.pitch_um;
  for (double u = 0; u <= 3; u += 0.25) {
    for (double w = 0; w <= 3; w += 0.25) {
      const double truth = optics(std::hypot(u, w)) * sinc(a * u) * sinc(b * w);
      EXPECT_NEAR(system(u, w).real(), truth, 1e-14);
      EXPECT_NEAR(tabulated(u, w).real(), truth, 1e-14);
      EXPECT_EQ(detector_mtf(u, w, a, b), sinc(a * u) * sinc(b * w));
    }
  }
}

TEST(TransferFunctions, OfAStatedSquareAreThoseOfTheDefaultBitForBit) {
  SensorSpec stated = sc2000();
  stated.detector_y_um = stated.detector_um;
  const auto plain = sensor_transfer(sc2000(), full_plan(sc2000(), {}, {}), 4);
  const auto square = sensor_transfer(stated, full_plan(stated, {}, {}), 4);
  EXPECT_TRUE(stated.square_detector());
  for (double f = 0; f < 7; f += 0.13) EXPECT_EQ(plain(f, 0.3 * f), square(f, 0.3 * f));
}

TEST(SensorSpec, RefusesSensorsThatCannotExist) {
  const auto message = [](auto change) {
    SensorSpec spec = sc2000();
    change(spec);
    const auto result = validate(spec);
    return result ? std::string() : result.error().message;
  };

  EXPECT_EQ(message([](SensorSpec&) {}), "");
  EXPECT_THAT(message([](SensorSpec& s) { s.f_number = -1; }), testing::HasSubstr("f_number"));
  EXPECT_THAT(message([](SensorSpec& s) { s.f_number = 1e9; }), testing::HasSubstr("f_number"));
  EXPECT_THAT(message([](SensorSpec& s) { s.wavelength_max_um = 1e6; }), testing::HasSubstr("wavelength_max_um"));
  EXPECT_THAT(message([](SensorSpec& s) { s.detector_um = 48; }), testing::HasSubstr("larger than pitch"));
  EXPECT_THAT(message([](SensorSpec& s) { s.detector_y_um = 48; }), testing::HasSubstr("detector_y_um is larger"));
  EXPECT_THAT(message([](SensorSpec& s) { s.detector_y_um = 0.05; }), testing::HasSubstr("detector_y_um must be 0"));
  EXPECT_EQ(message([](SensorSpec& s) { s.detector_y_um = 20; }), "");
  EXPECT_THAT(message([](SensorSpec& s) { s.focal_length_mm = 0; }), testing::HasSubstr("focal_length_mm"));
  EXPECT_THAT(message([](SensorSpec& s) { s.netd_k = std::nan(""); }), testing::HasSubstr("netd_k"));
}

}  // namespace
}  // namespace todbench
