// SPDX-License-Identifier: GPL-3.0-or-later
// What goes wrong in the middle of a run on one machine: Ctrl-C, a full disk, a reader that went away.
#include <signal.h>
#include <sys/mount.h>

#include <cerrno>
#include <cstring>

#include "bench/session/manifest.h"
#include "bench/session/trials_csv.h"
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::AnyOf;
using ::testing::Eq;
using ::testing::HasSubstr;

/// Far more presentations than any test waits for: such a run ends only by what is done to it.
constexpr int endless = 10000;
/// One frame of the plate.
constexpr std::size_t trials_per_frame = 20;

/// Waits until the run has `rows` trials on disk.
bool has_trials(ChildProcess& child, const std::filesystem::path& csv, std::size_t rows) {
  return child.wait_until([&] { return rows_in(csv) >= rows; });
}

/// The trials on disk are whole rows, and as many as the run says it used.
void expect_readable_trials(const std::filesystem::path& csv, std::size_t at_least) {
  const auto trials = read_trials(csv);
  ASSERT_TRUE(trials) << trials.error().message;
  EXPECT_GE(trials->size(), at_least);
}

/// A disk that refused: the session says so, vouches for every file that is there, and holds no trial more or less.
void expect_ended_by_the_disk(const std::filesystem::path& session, const std::string& reason, const Json& said) {
  const Json provenance = Json::parse(content_of(session / "provenance.json"), nullptr, false);
  ASSERT_TRUE(provenance.is_object());
  EXPECT_EQ(provenance["state"], "interrupted");
  EXPECT_THAT(provenance["run"]["ended_by"].get<std::string>(), HasSubstr(reason));
  EXPECT_FALSE(provenance["ended_utc"].get<std::string>().empty());
  EXPECT_THAT(content_of(session / "log.txt"), HasSubstr("ended early: "));
  EXPECT_THAT(Json::parse(content_of(session / "verdict.json"))["ended_early"].get<std::string>(), HasSubstr(reason));
  const auto check = check_manifest(session);
  ASSERT_TRUE(check) << check.error().message;
  EXPECT_TRUE(check->intact()) << check->changed.size() << check->missing.size() << check->foreign.size();
  EXPECT_EQ(said["points"][0]["trials"], rows_in(session / "trials.csv"));
  EXPECT_EQ(said["verdict"], "inconclusive");
}

class Interruption : public ::testing::TestWithParam<std::tuple<const char*, int>> {};

TEST_P(Interruption, LeavesAValidPartialSession) {
  const auto [command, signal] = GetParam();
  const TemporaryFolder folder;
  folder.write("plan.toml", small_measurement(endless, "[measurement]\nregistration_frames = 4\n"));
  const auto session = folder.path() / "s";
  // A simulation shows the phases of its own section, sixteen; the camera those of the target.
  const std::string plan = std::string(command) == "measure" ? "./plan.toml" : "./simulated.toml";
  folder.write("simulated.toml", small_plan(endless));
  ChildProcess child(todbench_command({command, plan, "--out", "s", "--json"}), {.folder = folder.path()});
  ASSERT_TRUE(has_trials(child, session / "trials.csv", 2 * trials_per_frame));

  child.signal(signal);
  const Ended ended = child.wait();

  EXPECT_EQ(ended.code, 130) << ended.err;
  EXPECT_THAT(lines_of(ended.err).back(), Eq("todbench: ended early: stopped on request; the trials so far are in s"));
  const Json json = one_object(ended);
  EXPECT_EQ(json["points"].size(), 1u);
  EXPECT_TRUE(json["points"][0]["s75_direct_mrad"].is_null());
  expect_whole_session(session, "interrupted");
  expect_readable_trials(session / "trials.csv", 2 * trials_per_frame);
  EXPECT_EQ(json["points"][0]["trials"], rows_in(session / "trials.csv"));
  EXPECT_LT(rows_in(session / "trials.csv"), endless * trials_per_frame);
  EXPECT_THAT(content_of(session / "report.html"), HasSubstr("INTERRUPTED"));
  EXPECT_EQ(json["verdict"], "inconclusive");
  EXPECT_EQ(json["judgement"]["ended_early"], "stopped on request");
  EXPECT_EQ(json["judgement"], Json::parse(content_of(session / "verdict.json")));
}

INSTANTIATE_TEST_SUITE_P(All, Interruption,
                         ::testing::Combine(::testing::Values("simulate", "measure"),
                                            ::testing::Values(SIGINT, SIGTERM, SIGHUP)));

TEST(InterruptionBeforeTheFirstTrial, LeavesAValidFolderOrNone) {
  const TemporaryFolder folder;
  folder.write("plan.toml", small_plan(endless));
  // Registration at 10000 frames does not end while anybody waits.
  folder.write("plan.toml", small_plan(endless, "[measurement]\nregistration_frames = 10000\n"));
  ChildProcess child(todbench_command({"simulate", "./plan.toml", "--out", "s"}), {.folder = folder.path()});
  ASSERT_TRUE(child.wait_until([&] { return std::filesystem::exists(folder.path() / "s" / "trials.csv"); }));

  child.signal(SIGINT);
  const Ended ended = child.wait();

  expect_refused(ended, 130, "stopped on request");
  const Json provenance = Json::parse(content_of(folder.path() / "s" / "provenance.json"));
  EXPECT_EQ(provenance["state"], "interrupted");
  const Json verdict = Json::parse(content_of(folder.path() / "s" / "verdict.json"));
  EXPECT_EQ(verdict["decision"], "inconclusive");
  EXPECT_TRUE(verdict["ended_early"].is_string());
}

// A picture of 64 million pixels takes seconds, and its command looks at no request to stop.
TEST(InterruptionOfAShortCommand, EndsItAtOnceWithoutAFile) {
  const TemporaryFolder folder;
  ChildProcess child(todbench_command({"pattern", "siemens", "--pixels", "8192", "8192", "--out", "p.npy"}),
                     {.folder = folder.path()});
  ASSERT_TRUE(child.wait_until([&] { return child.threads() >= 2; }));

  child.signal(SIGTERM);

  EXPECT_EQ(child.wait().code, 130);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "p.npy"));
}

TEST(IgnoredSignals, StayIgnoredAsNohupWantsThem) {
  const TemporaryFolder folder;
  folder.write("plan.toml", small_plan(16));
  std::vector<std::string> command{"/usr/bin/nohup"};
  for (const auto& word : todbench_command({"simulate", "./plan.toml", "--out", "s"})) command.push_back(word);
  ChildProcess child(command, {.folder = folder.path()});
  ASSERT_TRUE(has_trials(child, folder.path() / "s" / "trials.csv", trials_per_frame));

  child.signal(SIGHUP);
  const Ended ended = child.wait();

  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(rows_in(folder.path() / "s" / "trials.csv"), 16 * trials_per_frame);
}

TEST(FullDisk, ALimitOfTheFileSizeKeepsEveryWholeTrial) {
  const TemporaryFolder folder;
  folder.write("plan.toml", small_plan(endless));

  // A row has some 330 bytes: about a hundred trials fit. The input copies are smaller.
  const Ended ended = todbench({"simulate", "./plan.toml", "--out", "s", "--json"},
                               {.folder = folder.path(), .largest_file_bytes = 32768});

  EXPECT_EQ(ended.code, 7) << ended.err;
  EXPECT_THAT(lines_of(ended.err).back(), HasSubstr("s/trials.csv: cannot be written: File too large"));
  expect_readable_trials(folder.path() / "s" / "trials.csv", trials_per_frame);
  EXPECT_EQ(one_object(ended)["points"].size(), 1u);
  expect_ended_by_the_disk(folder.path() / "s", "File too large", one_object(ended));
}

/// A disk of the test's own, in memory.
class SmallDisk {
 public:
  SmallDisk(const std::filesystem::path& folder, const char* size) : folder_(folder) {
    std::filesystem::create_directories(folder_);
    const std::string options = std::string("size=") + size;
    mounted_ = ::mount("tmpfs", folder_.c_str(), "tmpfs", 0, options.c_str()) == 0;
    if (!mounted_) reason_ = std::strerror(errno);
  }
  ~SmallDisk() {
    if (mounted_) ::umount2(folder_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  [[nodiscard]] bool mounted() const { return mounted_; }
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  std::filesystem::path folder_;
  std::string reason_;
  bool mounted_ = false;
};

class FullDiskOf : public ::testing::TestWithParam<std::tuple<const char*, const char*>> {};

TEST_P(FullDiskOf, KeepsEveryWholeTrialAndTellsTheResult) {
  const auto [command, size] = GetParam();
  const TemporaryFolder folder;
  const SmallDisk disk(folder.path() / "disk", size);
  if (!disk.mounted()) GTEST_SKIP() << "no mount of its own is permitted here: " << disk.reason();
  folder.write("plan.toml", small_measurement(endless, "[measurement]\nregistration_frames = 4\n"));
  folder.write("simulated.toml", small_plan(endless));
  const char* plan = std::string(command) == "measure" ? "./plan.toml" : "./simulated.toml";

  const Ended ended = todbench({command, plan, "--out", "disk/s", "--json"}, {.folder = folder.path()});

  EXPECT_EQ(ended.code, 7) << ended.err;
  EXPECT_THAT(lines_of(ended.err).back(), HasSubstr("cannot be written: No space left on device"));
  expect_readable_trials(folder.path() / "disk" / "s" / "trials.csv", trials_per_frame);
  EXPECT_EQ(one_object(ended)["points"].size(), 1u);
  expect_ended_by_the_disk(folder.path() / "disk" / "s", "No space left on device", one_object(ended));
  EXPECT_EQ(todbench({"verify", "disk/s"}, {.folder = folder.path()}).code, 0);
}

INSTANTIATE_TEST_SUITE_P(All, FullDiskOf,
                         ::testing::Combine(::testing::Values("simulate", "measure"),
                                            ::testing::Values("128k", "140k", "200k")));

TEST(FullDisk, AFolderThatCannotBeWrittenIsNoMistakeOfTheUser) {
  const TemporaryFolder folder;
  const SmallDisk disk(folder.path() / "disk", "1m");
  if (!disk.mounted()) GTEST_SKIP() << "no mount of its own is permitted here: " << disk.reason();
  folder.write("plan.toml", small_plan(2));
  ASSERT_TRUE(completed(todbench({"simulate", "./plan.toml", "--out", "disk/s"}, {.folder = folder.path()})));
  ASSERT_EQ(::mount(nullptr, (folder.path() / "disk").c_str(), nullptr, MS_REMOUNT | MS_RDONLY, nullptr), 0);
  const std::vector<std::vector<std::string>> writers{
      {"simulate", "./plan.toml", "--out", "disk/new"},
      {"simulate", "./plan.toml", "--out", "disk/s", "--force"},
      {"report", "disk/s"},
      {"reproduce", "eo-vista", "--out", "disk/page"},
      {"render", "--sensor", "sc2000", "--size-pitch", "3", "--tiff", "disk/a.tiff"},
      {"record", "sim:sc2000", "--frames", "1", "--out", "disk/a.todrec"},
      {"record", "sim:sc2000", "--frames", "1", "--format", "tiff", "--out", "disk/a.tif"}};

  for (const auto& writer : writers) {
    const Ended ended = todbench(writer, {.folder = folder.path()});

    EXPECT_EQ(ended.code, 7) << writer.front() << " " << writer.back() << ": " << ended.err;
    EXPECT_THAT(ended.err, HasSubstr("Read-only file system")) << writer.front() << " " << writer.back();
  }
}

TEST(FullDisk, FromTheBeginningIsOneSentence) {
  const TemporaryFolder folder;
  const SmallDisk disk(folder.path() / "disk", "4k");
  if (!disk.mounted()) GTEST_SKIP() << "no mount of its own is permitted here: " << disk.reason();
  folder.write("plan.toml", small_plan(2));

  const Ended ended = todbench({"simulate", "./plan.toml", "--out", "disk/s"}, {.folder = folder.path()});

  expect_refused(ended, 7, "No space left on device");
}

TEST(ClosedPipe, OnStandardErrorDoesNotEndARun) {
  const TemporaryFolder folder;
  folder.write("plan.toml", small_plan(2));

  const Ended ended = ChildProcess({"/bin/sh", "-c", "exec \"$0\" simulate ./plan.toml --out s 2>&1 1>result | true",
                                    todbench_command({}).front()},
                                   {.folder = folder.path()})
                          .wait();
  (void)ended;

  expect_whole_session(folder.path() / "s", "complete");
}

}  // namespace
}  // namespace todbench::testing
