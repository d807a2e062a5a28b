// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/loaded_plan.h"

#include <gmock/gmock.h>

#include <map>

#include "bench/run/experiment.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::Pair;
using ::testing::SizeIs;

/// find_resource(), counting how often each is asked for.
struct CountingFinder {
  std::map<std::string, int> reads;
  ResourceFinder finder() {
    return [this](ResourceKind kind, std::string_view reference) {
      ++reads[std::string(to_string(kind)) + " " + std::string(reference)];
      return find_resource(kind, reference);
    };
  }
};

/// A folder with a plan and every part it names as files.
struct Files {
  testing::TemporaryFolder folder;
  std::string plan;

  Files() {
    folder.write("sensor.toml", testing::content_of(source_file("sim_devices/sensors/sc2000.toml")));
    folder.write("eye.toml", testing::content_of(source_file("hvs/observers/hvs-1.toml")));
    folder.write("a.toml", testing::content_of(source_file("tod/plate/tcat-a.toml")));
    plan = folder
               .write("plan.toml",
                      "[target]\ndistance_m = 2\nplates = [\"./a.toml\"]\nmountings = [\"identity\"]\n"
                      "delta_t_k = [16.9]\nphases = 1\n[observer]\nname = \"./eye.toml\"\n"
                      "[simulation]\nsensor = \"./sensor.toml\"\naccuracy = \"draft\"\n"
                      "[measurement]\nregistration_frames = 2\ncontrast_frames = 2\n"
                      "[fit]\nestimator = \"weibull\"\n")
               .string();
  }
};

TEST(LoadedPlan, ReadsThePlanAndEachOfItsPartsOnce) {
  const Files files;
  CountingFinder count;

  const auto loaded = read_plan(files.plan, count.finder());

  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_THAT(count.reads, SizeIs(4));
  EXPECT_THAT(count.reads, Each(Pair(::testing::_, 1)));
}

TEST(LoadedPlan, OfAnotherPlanReadsOnlyWhatIsNamedAnew) {
  const LoadedPlan loaded = LoadedPlan::load(Plan{}).value();
  Plan changed;
  changed.target.plates = {"tcat-b"};
  changed.simulation.tolerance_percent = 3;
  CountingFinder count;

  const auto other = loaded.with(changed, count.finder());

  ASSERT_TRUE(other) << other.error().message;
  EXPECT_THAT(count.reads, ElementsAre(Pair("plate tcat-b", 1)));
  EXPECT_EQ(other->plan(), changed);
  EXPECT_EQ(other->plates().at(0).name, "tcat-b");
}

TEST(LoadedPlan, IsRefusedAboutTheKeyThatNamesWhatIsNotThere) {
  Plan plan;
  plan.target.plates = {"tcat-a", "tcat-z"};

  const auto loaded = LoadedPlan::load(plan);

  ASSERT_FALSE(loaded);
  ASSERT_TRUE(loaded.error().key);
  EXPECT_EQ(loaded.error().key->name, "target.plates");
}

TEST(LoadedPlan, IsWhatARunUsesWhateverHappensToTheFilesMeanwhile) {
  const Files files;
  const LoadedPlan loaded = read_plan(files.plan).value();
  const auto before = simulate_plan(loaded, {.folder = files.folder.path() / "before"}, {}, {});
  for (const char* name : {"plan.toml", "sensor.toml", "eye.toml", "a.toml"}) files.folder.write(name, "rubbish [");

  const auto after = simulate_plan(loaded, {.folder = files.folder.path() / "after"}, {}, {});

  ASSERT_TRUE(before) << before.error().message;
  ASSERT_TRUE(after) << after.error().message;
  for (const char* name : {"trials.csv", "fits.json", "session.toml", "inputs/sensor-sensor.toml"}) {
    EXPECT_EQ(testing::content_of(files.folder.path() / "before" / name),
              testing::content_of(files.folder.path() / "after" / name))
        << name;
  }
}

TEST(LoadedPlan, AnInvalidPlanMadeByHandBeginsNoRun) {
  const testing::TemporaryFolder folder;
  Plan plan;
  plan.target.distance_m = -1;
  plan.camera.id = "sim:sc2000";
  plan.camera.ifov_mrad = 1.3;

  const auto simulated = simulate_plan(plan, {.folder = folder.path() / "s"}, {}, {});
  const auto measured = measure_plan(plan, {.folder = folder.path() / "m"}, {}, {});

  ASSERT_FALSE(simulated || measured);
  EXPECT_EQ(simulated.error().key->name, "target.distance_m");
  EXPECT_EQ(measured.error().key->name, "target.distance_m");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace todbench
