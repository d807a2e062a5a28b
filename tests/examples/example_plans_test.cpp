// SPDX-License-Identifier: GPL-3.0-or-later
// The plans of docs/examples, read as the program reads them.
#include <gmock/gmock.h>

#include <filesystem>

#include "bench/plan/loaded_plan.h"
#include "tests/support/source_file.h"

namespace todbench {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> example_plans() {
  std::vector<fs::path> plans;
  for (const auto& entry : fs::directory_iterator(source_file("docs/examples/plans"))) {
    const std::string stem = entry.path().stem().string();
    if (entry.path().extension() == ".toml" && !stem.ends_with("-sensor")) plans.push_back(entry.path());
  }
  return plans;
}

TEST(ExamplePlans, AreThereForEveryKindOfCameraOfTheDocuments) {
  std::vector<std::string> names;
  for (const auto& plan : example_plans()) names.push_back(plan.stem().string());

  EXPECT_THAT(names, ::testing::UnorderedElementsAre("a35", "a655sc", "lepton", "seek", "tiny1", "unknown"));
}

TEST(ExamplePlans, AreValidWithTheirSensors) {
  for (const auto& file : example_plans()) {
    const auto plan = read_plan(file.string());

    ASSERT_TRUE(plan.has_value()) << plan.error().message;
    EXPECT_EQ(plan->plan().name, file.stem().string());
    EXPECT_EQ(plan->sensor().name, file.stem().string());
  }
}

TEST(ExamplePlans, ContradictNeitherTheirSensorNorThePlates) {
  for (const auto& file : example_plans()) {
    const auto plan = read_plan(file.string());
    ASSERT_TRUE(plan.has_value()) << plan.error().message;
    const double ifov_mrad = plan->plan().camera.ifov_mrad;
    const double pixel_mm = ifov_mrad * plan->plan().target.distance_m;

    // The plan has four digits.
    EXPECT_NEAR(ifov_mrad / plan->sensor().ifov_mrad(), 1, 1e-3) << file;
    EXPECT_NEAR(pixel_mm / 2.6, 1, 0.1) << file;
    for (const TargetPlate& plate : plan->plates()) {
      EXPECT_LT(plate.width_mm / pixel_mm, plan->sensor().width) << file;
      EXPECT_LT(plate.height_mm / pixel_mm, plan->sensor().height) << file;
    }
  }
}

}  // namespace
}  // namespace todbench
