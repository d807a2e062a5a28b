// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/scene_descriptions.h"

#include <gmock/gmock.h>

#include "bench/plan/target_sets.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

Result<StoredPicture> counts_of_a_ramp(const std::string& path) {
  if (path.find("lost") != std::string::npos) return fail(ErrorCode::invalid_input, path + ": cannot be read");
  StoredPicture picture{cv::Mat1d(4, 6), StoredPicture::Kind::counts};
  for (int i = 0; i < 24; ++i) picture.values(i / 6, i % 6) = 1000 + i;
  return picture;
}

TEST(Scenes, TargetsAndSetsThatAreShippedReadAndAreCalledAsTheirFiles) {
  for (const std::string& name : resource_names(ResourceKind::scene)) {
    const auto scene = load_scene(name, counts_of_a_ramp);
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(scene->name, name);
    EXPECT_TRUE(target_signature(*scene, {})) << name;
  }
  for (const std::string& name : resource_names(ResourceKind::target)) {
    const auto target = load_target(name);
    ASSERT_TRUE(target) << target.error().message;
    EXPECT_EQ(target->name, name);
  }
  for (const std::string& name : resource_names(ResourceKind::target_set)) {
    const auto set = load_target_set(name);
    ASSERT_TRUE(set) << set.error().message;
    EXPECT_EQ(set->name, name);
    for (const auto& target : set->targets) {
      ASSERT_EQ(target.aspects.size(), set->azimuths_deg.size());
      for (const FieldScene& scene : target.aspects) {
        EXPECT_TRUE(validate(scene)) << target.name;
        EXPECT_GT(target_signature(scene, {})->size_m(), 0.3);
      }
    }
  }
  EXPECT_EQ(load_target_set("all-targets")->targets.size(), 24u);
}

TEST(TargetSets, NameEverySideOnce) {
  const TemporaryFolder folder;
  const auto set_of = [&](const std::string& sides) {
    folder.write("set.toml", "name = \"s\"\ntargets = [\"craft-01\", \"craft-02\"]\nazimuths_deg = " + sides +
                                 "\nbackground_k = 290\n");
    return load_target_set((folder.path() / "set.toml").string());
  };

  EXPECT_TRUE(set_of("[90, -90, 0]"));
  for (const char* sides : {"[90, 0, 90]", "[90, -270]", "[0, 360]"}) {
    const auto set = set_of(sides);
    ASSERT_FALSE(set) << sides;
    EXPECT_THAT(set.error().message, ::testing::HasSubstr("every side once"));
  }
}

/// A scene file of these lines behind name and background.
Result<FieldScene> scene_from(const TemporaryFolder& folder, const std::string& lines) {
  folder.write("scene.toml", "name = \"s\"\nbackground_k = 290\n" + lines);
  return load_scene((folder.path() / "scene.toml").string(), counts_of_a_ramp);
}

TEST(Scenes, PointUpInTheFileAndDownInThePicture) {
  const TemporaryFolder folder;
  const auto scene =
      scene_from(folder, "[[region]]\nx_m = [0, 2, 2]\ny_m = [0, 0, 1]\ntemperature_k = 300\ntarget = true\n");

  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->regions.front().outline_m.back(), cv::Point2d(2, -1));
  EXPECT_EQ(scene->surround_k, 290);
}

TEST(Scenes, OfPicturesAreKelvinByTheScaleOfTheFile) {
  const TemporaryFolder folder;
  const std::string picture = "[picture]\nfile = \"p.tiff\"\npixel_mrad = 0.1\nrange_m = 50\n";

  const auto scene = scene_from(folder, picture + "kelvin_per_count = 0.1\noffset_k = 190\n");
  const auto without_scale = scene_from(folder, picture);
  const auto below_zero = scene_from(folder, picture + "kelvin_per_count = 0.1\noffset_k = -150\n");
  const auto lost = scene_from(folder, "[picture]\nfile = \"lost.tiff\"\npixel_mrad = 0.1\nrange_m = 50\n");

  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_NEAR(scene->picture->kelvin(3, 5), 190 + 0.1 * 1023, 1e-9);
  EXPECT_FALSE(without_scale);
  EXPECT_FALSE(below_zero);
  EXPECT_FALSE(lost);
}

TEST(Scenes, AreRefusedWithTheirFileWhereTheyCannotBe) {
  const TemporaryFolder folder;
  const std::string good = "[[region]]\nx_m = [0, 2, 2]\ny_m = [0, 0, 1]\n";
  for (const std::string& bad : std::vector<std::string>{
           "", good, good + "temperature_k = -3\n", good + "temperature_k = 300\ncolour = 3\n",
           good + "temperature_k = 300\nemissivity = 2\n",
           "[[region]]\nx_m = [0, 1, 1, 0]\ny_m = [0, 1, 0, 1]\ntemperature_k = 300\n",
           "[[region]]\nx_m = [0, 1, 1, 0]\ny_m = [0, 1, 0]\ntemperature_k = 300\n",
           "[[target]]\ntarget = \"craft-99\"\n", "[[target]]\n", "[plate]\nplate = \"tcat-z\"\ndelta_t_k = 1\n"}) {
    const auto scene = scene_from(folder, bad);

    ASSERT_FALSE(scene) << bad;
    EXPECT_EQ(scene.error().code, ErrorCode::invalid_input) << bad;
    EXPECT_THAT(scene.error().message, HasSubstr("scene.toml")) << bad;
  }
}

}  // namespace
}  // namespace todbench
