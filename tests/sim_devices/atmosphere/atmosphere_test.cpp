// SPDX-License-Identifier: GPL-3.0-or-later
// Radiance, spectra, tape7 and turbulence against the reference numbers.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "sim_devices/atmosphere/band_radiance.h"
#include "sim_devices/atmosphere/radiative_path.h"
#include "sim_devices/atmosphere/spectral_air.h"
#include "sim_devices/atmosphere/turbulence.h"
#include "tests/sim_devices/atmosphere/short_exposure.h"
#include "tests/support/source_file.h"

namespace todbench {
namespace {

/// Stated in the file.
constexpr double tolerance = 1e-8;

nlohmann::json cases(const std::string& kind) {
  std::ifstream file(source_file("tests/golden/reference_atmosphere_shared.json"));
  nlohmann::json found = nlohmann::json::parse(file)["cases"][kind];
  EXPECT_FALSE(found.empty()) << kind;
  return found;
}

SpectralBand band_of(const nlohmann::json& reference) {
  return {reference["band_um"][0], reference["band_um"][1]};
}

TEST(BandRadiance, AndItsDerivativeAgreeWithTheReference) {
  for (const auto& reference : cases("band_radiance")) {
    const double t = reference["temperature_k"];
    EXPECT_NEAR(band_radiance(band_of(reference), t) / reference["radiance_w_m2_sr"].get<double>(), 1, tolerance);
    EXPECT_NEAR(band_radiance_derivative(band_of(reference), t) / reference["derivative_w_m2_sr_k"].get<double>(), 1,
                tolerance);
  }
}

TEST(BandRadiance, IsThatOfStefanAndBoltzmannOverAllWavelengthsAndComesBackToItsTemperature) {
  constexpr double stefan_boltzmann = 5.670374419e-8;
  EXPECT_NEAR(band_radiance({1e-3, 1e6}, 300) / (stefan_boltzmann * std::pow(300, 4) / std::numbers::pi), 1, 1e-9);
  for (const double t : {40.0, 180.0, 300.0, 2000.0}) {
    const auto back = radiation_temperature_k({7.5, 13}, band_radiance({7.5, 13}, t));
    ASSERT_TRUE(back);
    EXPECT_NEAR(*back / t, 1, 1e-12);
  }
  EXPECT_FALSE(radiation_temperature_k({7.5, 13}, 0));
  EXPECT_FALSE(radiation_temperature_k({7.5, 13}, -1));
}

TEST(RadiativePath, ApparentContrastAgreesWithTheReference) {
  for (const auto& reference : cases("apparent_contrast")) {
    const RadiativeScene scene{.target_k = reference["target_k"],
                               .background_k = reference["background_k"],
                               .emissivity = reference["emissivity"],
                               .surround_k = reference["surround_k"],
                               .air_k = reference["air_k"]};
    const double tau = reference["transmittance"];
    ASSERT_TRUE(validate(scene));

    const auto shown = apparent_temperatures(band_of(reference), scene, tau);

    ASSERT_TRUE(shown);
    EXPECT_NEAR(shown->target_k, reference["apparent_target_k"].get<double>(), 1e-7);
    EXPECT_NEAR(shown->background_k, reference["apparent_background_k"].get<double>(), 1e-7);
    EXPECT_NEAR(shown->contrast_k(), reference["apparent_contrast_k"].get<double>(), 1e-7);
    EXPECT_NEAR(equivalent_contrast_k(band_of(reference), tau * radiance_contrast(band_of(reference), scene), 300) /
                    reference["radiance_contrast_at_300k"].get<double>(),
                1, tolerance);
  }
}

TEST(RadiativePath, RefusesWhatNoSceneHas) {
  EXPECT_FALSE(validate(RadiativeScene{.target_k = -1}));
  EXPECT_FALSE(validate(RadiativeScene{.background_k = 0}));
  EXPECT_FALSE(validate(RadiativeScene{.emissivity = 0}));
  EXPECT_FALSE(validate(RadiativeScene{.emissivity = 1.01}));
  EXPECT_FALSE(validate(RadiativeScene{.air_k = NAN}));
  EXPECT_FALSE(validate(SpectralBand{13, 7.5}));
}

TEST(SpectralAir, BandTransmittanceAgreesWithTheReference) {
  for (const auto& reference : cases("band_transmittance")) {
    std::vector<SpectralExtinction> spectrum;
    for (std::size_t i = 0; i < reference["wavelength_um"].size(); ++i)
      spectrum.push_back({reference["wavelength_um"][i], reference["extinction_per_km"][i]});

    const auto air = air_of_spectrum(spectrum, reference["temperature_k"]);

    ASSERT_TRUE(air) << air.error().message;
    for (std::size_t i = 0; i < reference["range_km"].size(); ++i) {
      const double range_km = reference["range_km"][i];
      EXPECT_NEAR(air->at(1000 * range_km).value(), reference["transmittance"][i].get<double>(), tolerance);
      EXPECT_NEAR(air->optical_depth(1000 * range_km).value() / range_km,
                  reference["effective_extinction_per_km"][i].get<double>(), tolerance);
    }
    EXPECT_NEAR(air->optical_depth(1e-3).value() / 1e-6, reference["limit_extinction_at_zero_range"].get<double>(),
                1e-6);
    EXPECT_NEAR(air->at(1000 * reference["range_of_half_km"].get<double>()).value(), 0.5, tolerance);
  }
}

TEST(Turbulence, AgreesWithTheReference) {
  for (const auto& reference : cases("turbulence")) {
    const TurbulentPath path{reference["cn2_m_minus_2_3"], 1000 * reference["path_km"].get<double>(),
                             reference["wavelength_um"]};
    const double aperture = reference["aperture_m"];

    EXPECT_NEAR(fried_plane_m(path) / reference["r0_plane_m"].get<double>(), 1, tolerance);
    EXPECT_NEAR(fried_spherical_m(path) / reference["r0_spherical_m"].get<double>(), 1, tolerance);
    EXPECT_NEAR(tilt_sd_mrad(path, aperture) / reference["long_exposure_angle_tilt_sd_mrad_per_axis"].get<double>(), 1,
                tolerance);
    for (std::size_t i = 0; i < reference["cycles_per_mrad"].size(); ++i) {
      const double f = reference["cycles_per_mrad"][i];
      EXPECT_NEAR(long_exposure_mtf(path, f), reference["mtf_long"][i].get<double>(), tolerance);
      const auto far = short_exposure_mtf(path, aperture, PropagationField::far_field, f);
      const auto near = short_exposure_mtf(path, aperture, PropagationField::near_field, f);
      ASSERT_EQ(far.has_value(), !reference["mtf_short_far"][i].is_null());
      if (!far) continue;
      EXPECT_NEAR(*far, reference["mtf_short_far"][i].get<double>(), tolerance);
      EXPECT_NEAR(*near, reference["mtf_short_near"][i].get<double>(), tolerance);
    }
  }
}

// Two numbers are in use for the variance of the dance in (D / r0)^(5/3) (lambda / D)^2: 0.182, the tilt of a wavefront
// over the aperture (Noll 1976: 4 / pi^2 of 1.0299 - 0.582 rad^2), which tilt_sd_mrad() states; and 3.44 / (2 pi^2) =
// 0.1743, what Fried's short exposure in the near field leaves out of the long one.
TEST(Turbulence, OfShortFramesAndTheirDanceIsThatOfTheLongExposure) {
  const TurbulentPath path{.cn2_m_minus_2_3 = 2e-13, .path_m = 1000, .wavelength_um = 10};
  constexpr double aperture_m = 0.1, noll = 0.182, pi = std::numbers::pi;
  const double tilt_mrad = tilt_sd_mrad(path, aperture_m);
  const double left_out = 3.44 / (2 * pi * pi);

  EXPECT_NEAR(4 / (pi * pi) * (1.0299 - 0.582), noll, 5e-4);
  EXPECT_NEAR(std::sqrt(left_out / noll), 0.9786, 1e-4) << "2 % of the standard deviation";
  for (const double f : {0.1, 1.0, 5.0, 9.9}) {
    const auto still = short_exposure_mtf(path, aperture_m, PropagationField::near_field, f);
    ASSERT_TRUE(still);
    const double dance = std::exp(-2 * pi * pi * tilt_mrad * tilt_mrad * left_out / noll * f * f);
    EXPECT_NEAR(*still * dance, long_exposure_mtf(path, f), 1e-12) << f;
  }
}

/// A run as MODTRAN writes it: a grey path of `extinction_per_km` with one opaque line.
std::string tape7(double range_km, double extinction_per_km) {
  std::string text =
      "M F 1    1    0    0    1    1    1    1    1    1    1    0    0   0.0000.30000\n"
      "    1    1    0    0    0    0  23.00000   0.00000   0.00000   0.00000   0.00000\n"
      "   36TROPICAL MODEL      \n";
  text += fmt::format("{:10.5f}{:10.5f}{:10.5f}{:10.5f}{:10.5f}\n", 0.0, 100.0, 89.5, range_km, 0.0);
  text +=
      "     700.0    1400.0      10.0      10.0NW              \n"
      "    FREQ  TOT_TRANS  PTH_THRML  THRML_SCT\n";
  for (int nu = 700; nu <= 1400; nu += 10)
    text += fmt::format("{:8.2f}{:11.8f} 1.5065E-05            0.0000E+00\n", static_cast<double>(nu),
                        std::exp(-extinction_per_km * range_km));
  return text + " -9999.\n";
}

TEST(Tape7, OneRunAndSeveralAreTheirAir) {
  const auto one = parse_tape7(tape7(2, 0.3));
  ASSERT_TRUE(one) << one.error().message;
  ASSERT_EQ(one->size(), 1u);
  EXPECT_EQ(one->front().range_km, 2);
  const auto several = parse_tape7(tape7(4, 0.3) + tape7(1, 0.3) + tape7(2, 0.3));
  ASSERT_TRUE(several) << several.error().message;
  ASSERT_EQ(several->size(), 3u);

  for (const auto& runs : {*one, *several}) {
    const auto air = air_of_tape7(runs, {7.5, 13}, 300);
    ASSERT_TRUE(air) << air.error().message;
    // Eight decimals in the file.
    EXPECT_NEAR(air->at(1500).value(), std::exp(-0.45), 1e-7);
    EXPECT_NEAR(air->at(200).value(), std::exp(-0.06), 1e-7);
    EXPECT_EQ(air->end_m(), runs.size() == 1 ? 2000 : 4000);
  }
  EXPECT_FALSE(air_of_tape7(*one, {3, 5}, 300)) << "the band is not covered";
}

TEST(Tape7, RefusesWhatIsNone) {
  const std::string good = tape7(2, 0.3);
  EXPECT_FALSE(parse_tape7(""));
  EXPECT_FALSE(parse_tape7("FREQ\n"));
  EXPECT_FALSE(parse_tape7("range_m,transmittance\n1,0.9\n"));
  std::string without_range = good;
  without_range.replace(without_range.find("   2.00000"), 10, "   0.00000");
  EXPECT_FALSE(parse_tape7(without_range));
  std::string letters = good;
  letters.replace(letters.find("  710.00"), 8, "  710.0x");
  const auto refused = parse_tape7(letters);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "line 8: expected a wavenumber and a transmittance");
}

}  // namespace
}  // namespace todbench
