// SPDX-License-Identifier: GPL-3.0-or-later
// The same plan on every emulated camera, one line changed: every run comes to its end, every replay gives the same
// bits, and the TOD is the same on every path within its interval.
#include <cmath>
#include <csignal>
#include <map>
#include <thread>

#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

/// A run through one interface.
struct Path {
  std::string camera;
  std::string corrections;  ///< of the plan's [camera]
};

const std::vector<Path>& paths() {
  static const std::vector<Path> all{
      {"gige", ""},
      {"gige-ax5", ""},
      {"gige-ax5", "nuc_interval_s = 5\nnuc_wait_s = 0.6\n"},
      {"gige-a-series", ""},
      {"gige-legacy-science", ""},
      {"gige-unlisted", ""},
      {"u3v", ""},
      {"seek", ""},
      {"seek",
       "nuc_interval_s = 60\nnuc_wait_s = 3\n"},  // its shutter closes at the start; the first frame may come late
      {"v4l2", ""},
      {"v4l2-yuyv", ""},
  };
  return all;
}

std::string name_of(const Path& path) {
  return path.camera + (path.corrections.empty() ? "" : " with corrections");
}

std::string plan_of(const Json& lab, const Path& path) {
  std::string settings;
  for (const auto& [name, value] : lab["camera"]["settings"].items())
    settings += name + " = \"" + value.get<std::string>() + "\"\n";
  if (!settings.empty()) settings = "[camera.settings]\n" + settings;
  return "name = \"path\"\n[camera]\nid = \"" + lab["camera"]["id"].get<std::string>() +
         "\"\nifov_mrad = 1.3085399449\n" + path.corrections + settings +
         "[simulation]\naccuracy = \"draft\"\nphases = 4\n[measurement]\nregistration_frames = 8\n"
         "contrast_frames = 8\nrecord_frames = true\n[target]\nkind = \"scpi\"\nblack_body = \"" +
         lab["black_body"].get<std::string>() + "\"\nstage = \"" + lab["stage"].get<std::string>() +
         "\"\ndistance_m = 2\nplates = [\"tcat-a\", \"tcat-b\"]\nmountings = [\"identity\", \"rotated_180\"]\n"
         "delta_t_k = [16.9, 1.93]\nphases = 6\n[fit]\nestimator = \"weibull\"\n[limits]\nequivalence_margin_percent = "
         "25\n";
}

/// Size at 75 % and its standard error, in logarithms, by contrast.
struct Threshold {
  double log_size = 0, standard_error = 0;
};
using Curve = std::map<double, Threshold>;

Curve curve_of(const Json& measured) {
  Curve curve;
  for (const auto& point : measured["points"]) {
    const double low = point["s75_ci95_mrad"][0], high = point["s75_ci95_mrad"][1];
    curve[point["delta_t_k"]] = {std::log(point["s75_mrad"].get<double>()), std::log(high / low) / (2 * 1.96)};
  }
  return curve;
}

Curve measured_through(const Path& path) {
  const TemporaryFolder folder;
  std::vector<std::string> emulate{"emulate",           "--json", "--camera",     path.camera,
                                   "--black-body-port", "0",      "--stage-port", "0"};
  ChildProcess laboratory(todbench_command(emulate));
  if (!laboratory.wait_until([&] { return laboratory.out().find('\n') != std::string::npos; })) {
    ADD_FAILURE() << name_of(path) << ": " << laboratory.wait().err;
    return {};
  }
  const Json lab = Json::parse(laboratory.out(), nullptr, false);
  ChildOptions client{.folder = folder.path()};
  for (const auto& [name, value] : lab["camera"]["environment"].items()) client.setenv[name] = value;
  folder.write("plan.toml", plan_of(lab, path));

  const Ended measured = todbench({"measure", "./plan.toml", "--out", "m", "--json"}, client);
  const Ended replayed = todbench({"replay", "m", "--out", "r", "--json", "--quiet"}, client);
  laboratory.signal(SIGTERM);

  EXPECT_EQ(measured.code, 0) << name_of(path) << ": " << measured.err;
  EXPECT_EQ(replayed.code, 0) << name_of(path) << ": " << replayed.err;
  if (measured.code != 0) return {};
  expect_whole_session(folder.path() / "m", "complete");
  EXPECT_TRUE(same_content(folder.path() / "m" / "trials.csv", folder.path() / "r" / "trials.csv")) << name_of(path);
  const Json rejected = one_object(measured)["frames"]["rejected"];
  for (const auto& [reason, count] : rejected.items()) {
    // A loaded host may lose a frame; what a correction does to the pictures is never called anything else.
    EXPECT_TRUE(reason == "nonuniformity_correction" || reason == "gapped" || reason == "incomplete")
        << name_of(path) << ": " << count << " " << reason;
  }
  EXPECT_EQ(rejected.contains("nonuniformity_correction"), path.corrections.empty() ? path.camera == "seek" : true)
      << name_of(path);
  return curve_of(one_object(measured));
}

TEST(CameraPaths, GiveTheSameTodWithinItsInterval) {
  // The control port of GigE Vision is fixed, so those cameras go one after the other, and the others beside them.
  std::map<std::string, Curve> curves;
  for (const auto& path : paths()) curves[name_of(path)];
  const auto measure_through_all = [&](bool gige) {
    for (const auto& path : paths()) {
      if (path.camera.starts_with("gige") == gige) curves.at(name_of(path)) = measured_through(path);
    }
  };
  {
    const std::jthread beside([&] { measure_through_all(false); });
    measure_through_all(true);
  }

  const Curve& reference = curves.at("gige");
  ASSERT_EQ(reference.size(), 2U);
  for (const auto& [name, curve] : curves) {
    ASSERT_EQ(curve.size(), reference.size()) << name;
    for (const auto& [contrast, threshold] : curve) {
      const Threshold& other = reference.at(contrast);
      // 18 comparisons of independent noise: beyond 3.9 standard errors once in 600 runs of this test.
      const double tolerance = 3.9 * std::hypot(threshold.standard_error, other.standard_error);
      EXPECT_NEAR(threshold.log_size, other.log_size, tolerance) << name << " at " << contrast << " K";
      // The tolerance means something: about 0.2 here.
      EXPECT_LT(tolerance, 0.3) << name << " at " << contrast << " K";
    }
  }
}

}  // namespace
}  // namespace todbench::testing
