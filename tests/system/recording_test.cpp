// SPDX-License-Identifier: GPL-3.0-or-later
// Recording and replay as a user has them: the same answers bit for bit, also of a run that did not end well.
#include <signal.h>

#include "bench/session/session_folder.h"
#include "bench/text/files.h"
#include "bench/text/text.h"
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;

class Replays : public ::testing::Test {
 protected:
  Ended run(const std::vector<std::string>& arguments) {
    ChildOptions options;
    options.folder = folder_.path();
    return todbench(arguments, options);
  }
  std::filesystem::path at(const std::string& name) const { return folder_.path() / name; }
  void write(const std::string& name, const std::string& text) { folder_.write(name, text); }

 private:
  TemporaryFolder folder_;
};

TEST_F(Replays, OfASessionHaveTheSameTrialsAndFitsBitForBit) {
  write("plan.toml",
        small_measurement(4, "nuc_interval_s = 0.2\nnuc_wait_s = 0.05\n[measurement]\nrecord_frames = true\n"));
  ASSERT_TRUE(completed(run({"measure", "./plan.toml", "--out", "m"})));

  const Ended ended = run({"replay", "m", "--out", "r", "--json"});

  EXPECT_TRUE(completed(ended)) << ended.err;
  const Json json = one_object(ended);
  EXPECT_EQ(json["same_trials"], true);
  EXPECT_EQ(json["same_fits"], true);
  for (const char* file : {"trials.csv", "trials_simulated.csv", "fits.json", "curve.csv", "comparison.json"}) {
    EXPECT_TRUE(same_content(at("m") / file, at("r") / file)) << file;
  }
  expect_whole_session(at("m"), "complete");
  expect_whole_session(at("r"), "complete");
  EXPECT_TRUE(std::filesystem::exists(at("m") / "frames" / "camera.todrec"));
  EXPECT_FALSE(std::filesystem::exists(at("r") / "frames" / "camera.todrec"));
}

TEST_F(Replays, GoAsFarAsTheFramesOfASessionThatWasCutOff) {
  write("plan.toml", small_measurement(8));
  ASSERT_TRUE(completed(run({"measure", "./plan.toml", "--record-frames", "--out", "m"})));
  // What a crash leaves: frames up to somewhere within one, no manifest, the state "running", trials up to then.
  const auto frames = at("m") / "frames" / "camera.todrec";
  std::filesystem::resize_file(frames, std::filesystem::file_size(frames) * 9 / 10);
  std::filesystem::remove(at("m") / "manifest.json");
  std::filesystem::remove(at("m") / "fits.json");
  std::string provenance = *read_text_file(at("m") / "provenance.json");
  provenance.replace(provenance.find("\"complete\""), 10, "\"running\"");
  ASSERT_TRUE(write_file_atomically(at("m") / "provenance.json", provenance).has_value());

  const Ended ended = run({"replay", "m", "--out", "r"});

  EXPECT_EQ(ended.code, 5) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("ends after"));
  expect_whole_session(at("r"), "interrupted");
  EXPECT_GT(rows_in(at("r") / "trials.csv"), 0u);
}

TEST_F(Replays, RefuseSessionsWithoutFramesAndFramesThatWereChanged) {
  write("plan.toml", small_measurement(2));
  ASSERT_TRUE(completed(run({"measure", "./plan.toml", "--out", "without"})));
  ASSERT_TRUE(completed(run({"measure", "./plan.toml", "--record-frames", "--out", "changed"})));
  const auto frames = at("changed") / "frames" / "camera.todrec";
  std::filesystem::resize_file(frames, std::filesystem::file_size(frames) - 1);

  expect_refused(run({"replay", "without"}), 2, "this session has no recorded frames");
  expect_refused(run({"replay", "changed"}), 2, "the session was changed");
}

TEST_F(Replays, OfASessionWhoseAnswersWereEditedAreReportedAsDifferent) {
  write("plan.toml", small_measurement(2));
  ASSERT_TRUE(completed(run({"measure", "./plan.toml", "--record-frames", "--out", "m"})));
  auto trials = *read_trials(at("m") / "trials.csv");
  trials.front().scores[0] += 1e-9;
  {
    auto writer = TrialsWriter::create(at("m") / "trials.csv");
    for (const auto& trial : trials) ASSERT_TRUE(writer->append(trial).has_value());
  }
  ASSERT_TRUE(write_manifest(at("m")).has_value());

  const Ended ended = run({"replay", "m", "--out", "r"});

  EXPECT_EQ(ended.code, 1);
  EXPECT_THAT(ended.err, HasSubstr("answers of the replay differ from those of the session"));
}

TEST_F(Replays, RecordedFramesAreACamera) {
  const Ended recorded = run({"record", "sim:sc2000", "--frames", "12", "--out", "a.todrec", "--json"});
  ASSERT_EQ(recorded.code, 0) << recorded.err;
  EXPECT_EQ(one_object(recorded)["frames"], 12);

  const Ended copied = run({"record", "file:a.todrec", "--out", "b.todrec", "--json"});

  ASSERT_EQ(copied.code, 0) << copied.err;
  EXPECT_EQ(one_object(copied)["frames"], 12);
  EXPECT_EQ(one_object(copied)["lost"], 0);
}

TEST_F(Replays, RecordedFramesGoThroughTiffAndBack) {
  ASSERT_EQ(run({"record", "sim:sc2000", "--frames", "5", "--out", "a.todrec"}).code, 0);
  ASSERT_EQ(run({"record", "file:a.todrec", "--format", "tiff", "--out", "a.tif"}).code, 0);

  const Ended back = run({"record", "file:a.tif?bits=14", "--format", "tiff", "--out", "b.tif", "--json"});

  ASSERT_EQ(back.code, 0) << back.err;
  EXPECT_EQ(one_object(back)["frames"], 5);
  EXPECT_TRUE(same_content(at("a.tif"), at("b.tif")));
}

TEST_F(Replays, RecordRefusesAnExistingFileAndACameraThatIsNotThere) {
  write("there.todrec", "precious");

  expect_refused(run({"record", "sim:sc2000", "--frames", "1", "--out", "there.todrec"}), 2, "exists already");
  expect_refused(run({"record", "file:absent.todrec"}), 4, "no such file");
}

TEST_F(Replays, RecordNeverOverwritesTheFramesThatItReads) {
  ASSERT_EQ(run({"record", "sim:sc2000", "--frames", "3", "--out", "a.todrec"}).code, 0);
  const auto size = std::filesystem::file_size(at("a.todrec"));

  expect_refused(run({"record", "file:a.todrec", "--out", "./a.todrec", "--force"}), 2,
                 "the frames are read from there");

  EXPECT_EQ(std::filesystem::file_size(at("a.todrec")), size);
}

class Recording : public Replays, public ::testing::WithParamInterface<const char*> {
 protected:
  /// As a camera.
  std::string camera(const std::string& name) const {
    return "file:" + name + (std::string(GetParam()) == "tiff" ? "?bits=14" : "");
  }
  std::string name() const { return std::string(GetParam()) == "tiff" ? "a.tif" : "a.todrec"; }
  /// What another recording of the file says.
  std::int64_t frames_in(const std::string& file) {
    const Ended ended = run({"record", camera(file), "--out", "again.todrec", "--force", "--json"});
    EXPECT_EQ(ended.code, 0) << ended.err;
    return ended.code == 0 ? one_object(ended)["frames"].get<std::int64_t>() : -1;
  }
};

TEST_P(Recording, IntoAFolderThatIsDeletedEndsWithTheDisk) {
  std::filesystem::create_directories(at("there"));
  const std::string file = "there/" + name();
  ChildOptions options;
  options.folder = at("");
  ChildProcess child(todbench_command({"record", "sim:sc2000", "--format", GetParam(), "--out", file, "--json"}),
                     options);
  ASSERT_TRUE(child.wait_until([&] {
    std::error_code problem;
    return std::filesystem::file_size(at(file), problem) > 1'000'000 && !problem;
  }));

  std::filesystem::remove_all(at("there"));
  const Ended ended = child.wait();

  EXPECT_EQ(ended.code, 7) << ended.err;
  EXPECT_EQ(one_object(ended)["frames"], 0);
  EXPECT_THAT(ended.err, HasSubstr(file));
}

TEST_P(Recording, OnAFullDiskKeepsEveryWholeFrameAndSaysHowMany) {
  ChildOptions options;
  options.folder = at("");
  options.largest_file_bytes = 2'000'000;

  const Ended ended = todbench({"record", "sim:sc2000", "--format", GetParam(), "--out", name(), "--json"}, options);

  EXPECT_EQ(ended.code, 7) << ended.err;
  const auto frames = one_object(ended)["frames"].get<std::int64_t>();
  EXPECT_GT(frames, 0);
  EXPECT_EQ(frames_in(name()), frames);
}

TEST_P(Recording, ThatIsKilledIsReadableUpToItsLastWholeFrame) {
  ChildOptions options;
  options.folder = at("");
  ChildProcess child(todbench_command({"record", "sim:sc2000", "--format", GetParam(), "--out", name()}), options);
  ASSERT_TRUE(child.wait_until([&] {
    std::error_code problem;
    return std::filesystem::file_size(at(name()), problem) > 3'000'000 && !problem;
  }));

  child.signal(SIGKILL);
  (void)child.wait();

  EXPECT_GT(frames_in(name()), 3);
}

INSTANTIATE_TEST_SUITE_P(InEveryFormat, Recording, ::testing::Values("recording", "tiff"),
                         [](const auto& parameters) { return std::string(parameters.param); });

TEST_F(Replays, RecordWritesNoTiffWithoutAFrame) {
  ASSERT_EQ(run({"record", "sim:sc2000", "--frames", "3", "--out", "a.todrec"}).code, 0);
  // One byte of every picture is another one: none is complete any more.
  std::string bytes = *read_text_file(at("a.todrec"));
  for (std::size_t at = bytes.find("FRAM"); at != std::string::npos; at = bytes.find("FRAM", at + 1000))
    bytes[at + 500] = static_cast<char>(bytes[at + 500] ^ 1);
  ASSERT_TRUE(write_file_atomically(at("bad.todrec"), bytes).has_value());

  const Ended ended = run({"record", "file:bad.todrec", "--format", "tiff", "--out", "none.tif", "--json"});

  EXPECT_EQ(ended.code, 5) << ended.err;
  EXPECT_EQ(one_object(ended)["frames"], 0);
  EXPECT_EQ(one_object(ended)["arrived"], 3);
  EXPECT_THAT(ended.err, HasSubstr("none of 3 frames is complete"));
  EXPECT_FALSE(std::filesystem::exists(at("none.tif")));
}

TEST_F(Replays, OfASessionWhoseFramesAreDeletedMeanwhileDoNotCount) {
  write("plan.toml", small_measurement(10000));
  ChildOptions options;
  options.folder = at("");
  ChildProcess child(todbench_command({"measure", "./plan.toml", "--record-frames", "--out", "m"}), options);
  ASSERT_TRUE(child.wait_until([&] { return rows_in(at("m") / "trials.csv") > 20; }));

  std::filesystem::remove_all(at("m") / "frames");
  const Ended ended = child.wait();

  EXPECT_EQ(ended.code, 7) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("was deleted"));
}

TEST_F(Replays, RecordRefusesATiffStackThatIsCutOff) {
  ASSERT_EQ(run({"record", "sim:sc2000", "--frames", "5", "--format", "tiff", "--out", "a.tif"}).code, 0);
  std::filesystem::resize_file(at("a.tif"), std::filesystem::file_size(at("a.tif")) / 2);

  expect_refused(run({"record", "file:a.tif?bits=14", "--out", "b.todrec"}), 2, "is missing");
}

}  // namespace
}  // namespace todbench::testing
