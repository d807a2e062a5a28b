// SPDX-License-Identifier: GPL-3.0-or-later
// False alarms of the fit of a camera's optics over right sessions. TODBENCH_STUDY_RUNS: how many of each kind (250
// without it); TODBENCH_STUDY_SHARE: "1/2" makes every second; TODBENCH_STUDY_DESIGN: cameras of the halo study with
// this beginning of their names.
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "tests/sim_devices/prediction/camera_halos.h"

namespace todbench::test {
namespace {

TEST(CameraOpticsStudy, FalseAlarmsOfRightSessions) {
  struct Kind {
    const char* name;
    OpticsSession session;
  };
  const auto of = [](auto change) { return sensor_with(change); };
  const std::vector<Kind> kinds{
      {"plain", {}},
      {"20 mK", {.camera = of([](SensorSpec& s) { s.netd_k = 0.02; })}},
      {"5 mK", {.camera = of([](SensorSpec& s) { s.netd_k = 0.005; })}},
      {"aberration 0.35", {.camera = of([](SensorSpec& s) { s.aberration_sigma_pitch = 0.35; })}},
      {"fixed pattern 0.1 K", {.camera = of([](SensorSpec& s) { s.fixed_pattern_k = 0.1; })}},
      {"column and row noise", {.camera = of([](SensorSpec& s) { s.column_noise_k = 0.07, s.row_noise_k = 0.03; })}},
      {"dead pixels 0.5 %", {.dead_share = 0.005}},
      {"noise that remembers", {.camera = of([](SensorSpec& s) { s.noise_correlation = 0.6; })}},
      {"rounding to 2 sigma",
       {.camera = of([](SensorSpec& s) { s.kelvin_per_count = 0.05, s.netd_k = 0.025; }), .rounds = true}},
      {"microscan", {.camera = of([](SensorSpec& s) { s.microscan = 2; })}}};
  const char* asked = std::getenv("TODBENCH_STUDY_RUNS");
  const std::uint64_t runs = asked != nullptr ? std::strtoull(asked, nullptr, 10) : 250;
  std::uint64_t first = 1, step = 1;
  if (const char* share = std::getenv("TODBENCH_STUDY_SHARE")) {
    char slash = 0;
    std::istringstream(share) >> first >> slash >> step;
  }
  int all = 0, differ = 0, refused = 0, none = 0;
  for (const Kind& kind : kinds) {
    const OpticsSessions sessions(kind.session);
    int own = 0, own_differ = 0, own_refused = 0;
    double chi2 = 0, limit = 0;
    for (std::uint64_t seed = first; seed <= runs; seed += step) {
      const auto found = sessions.fitted(kind.session.camera, 1000 + seed);
      none += found ? 0 : 1;
      if (!found) continue;
      ++own;
      own_differ += found->differs ? 1 : 0;
      own_refused += found->optics.fits() ? 0 : 1;
      chi2 += found->optics.chi2;
      limit += found->optics.chi2_limit;
    }
    std::printf("| %s | %d | differ %d | refused %d | chi2 %.3f | limit %.3f |\n", kind.name, own, own_differ,
                own_refused, chi2 / own, limit / own);
    std::fflush(stdout);
    all += own;
    differ += own_differ;
    refused += own_refused;
  }
  std::printf("%d sessions: differ %d, refused %d, no fit %d\n", all, differ, refused, none);
  // 1 %, with three standard errors of so many sessions.
  const double most = 0.01 + 3 * std::sqrt(0.01 * 0.99 / all);
  EXPECT_LE(differ, most * all);
  EXPECT_LE(refused, most * all);
}

TEST(CameraHaloStudy, FalseAlarmsAndPower) {
  const char* asked = std::getenv("TODBENCH_STUDY_RUNS");
  const std::uint64_t runs = asked != nullptr ? std::strtoull(asked, nullptr, 10) : 250;
  std::vector<HaloCamera> cameras = cameras_without_halo();
  const std::size_t without = cameras.size();
  for (const auto& [share, sigma] :
       {std::pair(0.01, 4.0), {0.01, 8.0}, {0.01, 14.0}, {0.02, 14.0}, {0.03, 4.0}, {0.03, 8.0}, {0.03, 14.0}})
    cameras.push_back({"halo of " + std::to_string(share) + " within " + std::to_string(sigma) + " pitches",
                       camera_with_halo(share, sigma)});
  const char* only = std::getenv("TODBENCH_STUDY_DESIGN");
  std::uint64_t all = 0, alarms = 0;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const HaloCamera& one = cameras[i];
    if (only != nullptr && !one.name.starts_with(only)) continue;
    const OpticsSessions sessions({.camera = one.camera});
    std::uint64_t found = 0;
    double share = 0;
    for (std::uint64_t seed = 1; seed <= runs; ++seed) {
      const auto halo = sessions.halo(one.twin, 1000 + seed, one.f_number_ratio);
      found += halo ? 1 : 0;
      share += halo ? halo->share : 0;
    }
    std::printf("| %s | %d | found %d | mean share %.4f |\n", one.name.c_str(), static_cast<int>(runs),
                static_cast<int>(found), found > 0 ? share / static_cast<double>(found) : 0);
    std::fflush(stdout);
    if (i < without) all += runs, alarms += found;
  }
  EXPECT_LE(alarms, all / 100);
}

}  // namespace
}  // namespace todbench::test
