// SPDX-License-Identifier: GPL-3.0-or-later
// What strangers leave in a folder, and what the system leaves the program.
#include <sys/mount.h>
#include <sys/stat.h>

#include <memory>

#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;

/// A measured session, fit for a history.
class Strangers : public ::testing::Test {
 protected:
  /// Measured once for all cases of a process.
  static void SetUpTestSuite() {
    measured_ = std::make_unique<TemporaryFolder>();
    measured_->write("plan.toml", small_measurement(8));
    ASSERT_TRUE(completed(todbench({"measure", "./plan.toml", "--out", "m"}, {.folder = measured_->path()})));
  }
  static void TearDownTestSuite() { measured_.reset(); }
  Strangers() { std::filesystem::copy(measured_->path(), folder_.path(), std::filesystem::copy_options::recursive); }
  [[nodiscard]] Ended run(const std::vector<std::string>& arguments) const {
    return todbench(arguments, {.folder = folder_.path()});
  }
  [[nodiscard]] std::filesystem::path at(const std::string& name) const { return folder_.path() / name; }

  static inline std::unique_ptr<TemporaryFolder> measured_;
  TemporaryFolder folder_;
};

TEST_F(Strangers, LinksInASessionLeadNoWriterOutOfIt) {
  folder_.write("mine.txt", "precious");
  for (const char* name : {".report.csv.part", ".report.html.part", "report.csv.part", "notes.csv"}) {
    std::filesystem::create_symlink(at("mine.txt"), at("m") / name);
    for (const std::vector<std::string>& writer : {std::vector<std::string>{"report", "m"},
                                                   {"report", "m", "--reason", "a look"},
                                                   {"cost", "--session", "m", "--budget-s", "1"}}) {
      EXPECT_EQ(run(writer).code, 2) << name << writer.front();
      EXPECT_EQ(content_of(at("mine.txt")), "precious") << name << writer.front();
    }
    std::filesystem::remove(at("m") / name);
  }
  EXPECT_EQ(run({"report", "m"}).code, 0);
}

TEST_F(Strangers, APipeInPlaceOfAFileIsRefusedAndNotWaitedFor) {
  for (const char* name : {"trials.csv", "provenance.json", "session.toml", "manifest.json"}) {
    const std::string kept = content_of(at("m") / name);
    std::filesystem::remove(at("m") / name);
    ASSERT_EQ(::mkfifo((at("m") / name).c_str(), 0600), 0);
    for (const char* reader : {"report", "verify"}) EXPECT_EQ(run({reader, "m"}).code, 2) << reader << " " << name;
    std::filesystem::remove(at("m") / name);
    folder_.write(std::string("m/") + name, kept);
  }
  EXPECT_EQ(run({"verify", "m"}).code, 0);
  ASSERT_EQ(::mkfifo(at("pipe.toml").c_str(), 0600), 0);
  EXPECT_EQ(run({"simulate", "./pipe.toml"}).code, 2);
  const Ended noise = run({"noise", "./pipe.toml"});
  EXPECT_EQ(noise.code, 2);
  EXPECT_THAT(noise.err, HasSubstr("it is a pipe, a socket or a device"));
}

TEST_F(Strangers, EveryOfSixProgramsAddsItsSessionToANewHistory) {
  constexpr int programs = 6;
  std::vector<std::unique_ptr<ChildProcess>> running;
  for (int i = 0; i < programs; ++i) {
    const std::string copy = "copy" + std::to_string(i);
    std::filesystem::copy(at("m"), at(copy), std::filesystem::copy_options::recursive);
  }
  for (int i = 0; i < programs; ++i) {
    running.push_back(std::make_unique<ChildProcess>(
        todbench_command({"history", "add", "copy" + std::to_string(i), "--index", "index.sqlite"}),
        ChildOptions{.folder = folder_.path()}));
  }

  for (const auto& one : running) {
    const Ended ended = one->wait();
    EXPECT_EQ(ended.code, 0) << ended.err;
  }
  EXPECT_EQ(run({"history", "check", "--index", "index.sqlite", "--measure", "acuity", "--at-least", "0.000001"}).code,
            0);
}

TEST_F(Strangers, AHistoryOnADiskThatMayNotBeWrittenIsRead) {
  folder_.write("later.toml", small_measurement(2));
  ASSERT_TRUE(completed(run({"measure", "./later.toml", "--out", "later"})));
  std::filesystem::create_directories(at("disk"));
  ASSERT_EQ(run({"history", "add", "m", "--index", "disk/index.sqlite"}).code, 0);
  if (::mount(at("disk").c_str(), at("disk").c_str(), nullptr, MS_BIND, nullptr) != 0)
    GTEST_SKIP() << "no mount of its own is permitted here";
  const bool fixed = ::mount(nullptr, at("disk").c_str(), nullptr, MS_REMOUNT | MS_BIND | MS_RDONLY, nullptr) == 0;

  const Ended read = run({"history", "export", "--index", "disk/index.sqlite"});
  const Ended added = run({"history", "add", "later", "--index", "disk/index.sqlite"});
  ::umount2(at("disk").c_str(), MNT_DETACH);

  ASSERT_TRUE(fixed);
  EXPECT_EQ(read.code, 0) << read.err;
  EXPECT_THAT(read.out, HasSubstr("acuity"));
  EXPECT_EQ(added.code, 7) << added.err;
}

TEST_F(Strangers, AStackOfSixtyFourKilobytesIsEnough) {
  const auto limited = [&](const std::string& words) {
    std::vector<std::string> command{"/bin/sh", "-c", "ulimit -s 64 && exec \"$0\" " + words};
    command.push_back(todbench_command({}).front());
    return ChildProcess(command, {.folder = folder_.path()}).wait();
  };

  EXPECT_EQ(limited("--version").code, 0);
  EXPECT_TRUE(completed(limited("simulate ./plan.toml --out s")));
  EXPECT_EQ(limited("report m").code, 0);
}

TEST_F(Strangers, SecondsOfARecordingBeginWithItsFirstFrame) {
  const Ended ended = run({"record", "sim:sc2000", "--seconds", "0.2", "--out", "a.todrec", "--json"});

  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_GE(one_object(ended)["frames"].get<int>(), 1);
}

}  // namespace
}  // namespace todbench::testing
