// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/trials_csv.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>

#include "acquisition/base/rng.h"
#include "tests/bench/session/trial_values.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(TrialsCsv, EveryValueComesBackExactly) {
  const testing::TemporaryFolder folder;
  const std::vector<Trial> trials = testing::random_trials(200);
  Result<TrialsWriter> writer = TrialsWriter::create(folder.path() / "trials.csv");
  ASSERT_TRUE(writer) << writer.error().message;

  for (const Trial& trial : trials) ASSERT_TRUE(writer->append(trial));

  const Result<std::vector<Trial>> back = read_trials(folder.path() / "trials.csv");
  ASSERT_TRUE(back) << back.error().message;
  ASSERT_EQ(back->size(), trials.size());
  for (std::size_t i = 0; i < trials.size(); ++i) {
    EXPECT_EQ(testing::values_of((*back)[i]), testing::values_of(trials[i])) << "trial " << i;
  }
}

TEST(TrialsCsv, ATrialIsInTheFileAsSoonAsAppendReturns) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "trials.csv";
  Result<TrialsWriter> writer = TrialsWriter::create(file);
  ASSERT_TRUE(writer) << writer.error().message;
  std::size_t expected = 0;

  for (const Trial& trial : testing::random_trials(5)) {
    ASSERT_TRUE(writer->append(trial));
    EXPECT_EQ(read_trials(file).value().size(), ++expected);
  }
}

TEST(TrialsCsv, TheHeaderStatesTheUnits) {
  const testing::TemporaryFolder folder;
  ASSERT_TRUE(TrialsWriter::create(folder.path() / "t.csv"));

  EXPECT_EQ(
      testing::content_of(folder.path() / "t.csv"),
      "presentation,plate,mounting,triangle,set_delta_t_k,delta_t_k,size_mm,size_mrad,size_px,truth,answer,score_up,"
      "score_right,score_down,score_left,phase_x_px,phase_y_px,frame,device_time_ns,host_time_ns,since_nuc_s,saturated_"
      "pixels,probability_correct,frames,centroid_x_px,centroid_y_px\n");
}

TEST(TrialsCsv, AFileOfAnEarlierVersionEndsBeforeItsLastColumns) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "t.csv";
  Result<TrialsWriter> writer = TrialsWriter::create(file);
  ASSERT_TRUE(writer) << writer.error().message;
  for (const Trial& trial : testing::random_trials(5)) ASSERT_TRUE(writer->append(trial));
  for (const int left_out : {1, 2, 3, 4, 5, 6}) {
    std::istringstream lines(testing::content_of(file));
    std::string earlier;
    for (std::string line; std::getline(lines, line);) {
      for (int k = 0; k < left_out; ++k) line.resize(line.rfind(','));
      earlier += line + "\n";
    }

    const auto trials = read_trials(folder.write("earlier.csv", earlier));

    if (left_out == 1 || left_out == 3 || left_out == 6) {
      EXPECT_FALSE(trials) << "no version ended there";
      continue;
    }
    ASSERT_TRUE(trials) << trials.error().message;
    ASSERT_EQ(trials->size(), 5u);
    for (std::size_t i = 0; i < trials->size(); ++i) {
      Trial expected = testing::random_trials(5)[i];
      expected.centroid.reset();
      if (left_out > 2) {
        expected.probability_correct.reset();
        expected.frames = 1;
      }
      if (left_out > 4) expected.saturated_pixels = 0;
      EXPECT_EQ(testing::values_of((*trials)[i]), testing::values_of(expected)) << "trial " << i;
    }
  }
}

TEST(TrialsCsv, AProbabilityBeyondOneIsRefused) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "t.csv";
  Trial trial = testing::random_trials(2)[1];
  for (const double value : {-0.01, 1.01}) {
    trial.probability_correct = value;
    Result<TrialsWriter> writer = TrialsWriter::create(file);
    ASSERT_TRUE(writer && writer->append(trial));

    const auto trials = read_trials(file);

    ASSERT_FALSE(trials);
    EXPECT_THAT(trials.error().message,
                HasSubstr("t.csv:2: column probability_correct: expected a number from 0 to 1"));
  }
}

TEST(TrialsCsv, AFullDiskIsReportedWithThePath) {
  const Result<TrialsWriter> writer = TrialsWriter::create("/dev/full");

  ASSERT_FALSE(writer);
  EXPECT_EQ(writer.error().code, ErrorCode::io);
  EXPECT_THAT(writer.error().message, HasSubstr("/dev/full: cannot be written: No space left on device"));
}

/// Lets files of this process grow to `bytes` only, as a full disk would, until the end of the block.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    previous_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &previous_);
    const rlimit limit{bytes, previous_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &previous_);
    std::signal(SIGXFSZ, previous_handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit previous_{};
  void (*previous_handler_)(int) = nullptr;
};

TEST(TrialsCsv, WhenTheDiskFillsUpTheFileEndsWithACompleteTrial) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "trials.csv";
  const std::vector<Trial> trials = testing::random_trials(50);
  Result<TrialsWriter> writer = TrialsWriter::create(file);
  ASSERT_TRUE(writer) << writer.error().message;
  std::size_t appended = 0;
  Result<void> last;

  {
    const FileSizeLimit limit(4000);  // header 243 bytes, a line about 250: in the middle of a line
    while (appended < trials.size() && (last = writer->append(trials[appended]))) ++appended;
  }

  ASSERT_FALSE(last);
  EXPECT_EQ(last.error().code, ErrorCode::io);
  EXPECT_THAT(last.error().message, HasSubstr(file.string()));
  EXPECT_GT(appended, 0u);
  EXPECT_EQ(read_trials(file).value().size(), appended);
}

TEST(TrialsCsv, AnAtomicWriteThatFailsLeavesTheOldFile) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path file = folder.write("fits.json", "old");
  Result<void> written;

  {
    const FileSizeLimit limit(100);
    written = write_file_atomically(file, std::string(1000, 'x'));
  }

  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::io);
  EXPECT_EQ(testing::content_of(file), "old");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / ".fits.json.part"));
}

TEST(TrialsCsv, ANumberThatIsNotFiniteIsNotWritten) {
  const testing::TemporaryFolder folder;
  Result<TrialsWriter> writer = TrialsWriter::create(folder.path() / "t.csv");
  ASSERT_TRUE(writer) << writer.error().message;
  Trial trial = testing::random_trials(1)[0];
  trial.scores[2] = std::numeric_limits<double>::quiet_NaN();

  const Result<void> appended = writer->append(trial);

  ASSERT_FALSE(appended);
  EXPECT_EQ(appended.error().code, ErrorCode::internal);
  EXPECT_TRUE(read_trials(folder.path() / "t.csv").value().empty());
}

TEST(TrialsCsv, TheReaderNamesLineAndColumn) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "t.csv";
  Result<TrialsWriter> writer = TrialsWriter::create(file);
  ASSERT_TRUE(writer) << writer.error().message;
  for (const Trial& trial : testing::random_trials(3)) ASSERT_TRUE(writer->append(trial));
  const std::string good = testing::content_of(file);
  const auto complaint = [&](const std::string& text) {
    const auto trials = read_trials(folder.write("bad.csv", text));
    return trials ? std::string() : trials.error().message;
  };
  const auto with = [&](std::string_view old, std::string_view replacement) {
    std::string text = good;
    text.replace(text.find(old), old.size(), replacement);
    return text;
  };

  EXPECT_EQ(complaint(good), "");
  EXPECT_THAT(complaint(good.substr(0, good.size() - 40)), HasSubstr("bad.csv:4: expected 26 fields as in the header"));
  EXPECT_THAT(complaint(with("plate 0", "plate 0,x")),
              HasSubstr("bad.csv:2: expected 26 fields as in the header, found 27"));
  EXPECT_THAT(complaint(with("identity", "upside_down")), HasSubstr("bad.csv:2: column mounting: expected a mounting"));
  EXPECT_THAT(complaint(with("size_px", "size_pix")),
              HasSubstr("bad.csv:1: column 9: expected size_px, found 'size_pix'"));
  EXPECT_THAT(complaint(good.substr(0, good.rfind(',')) + ",x\n"),
              HasSubstr("bad.csv:4: column centroid_y_px: expected a finite number, found 'x'"));
  EXPECT_THAT(complaint(""), HasSubstr("bad.csv:1: the file is empty"));
}

struct Counts {
  const char* name;
  const char* csv;
  const char* message;
};

void PrintTo(const Counts& counts, std::ostream* out) {
  *out << counts.name;
}

class WrongCounts : public ::testing::TestWithParam<Counts> {};

TEST_P(WrongCounts, AreRefusedWithLineAndColumn) {
  const Result<std::vector<Level>> levels = parse_levels(GetParam().csv, "t.csv");

  ASSERT_FALSE(levels);
  EXPECT_EQ(levels.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(levels.error().message, HasSubstr(GetParam().message));
  EXPECT_THAT(levels.error().message, Not(HasSubstr("\n")));
}

INSTANTIATE_TEST_SUITE_P(
    All, WrongCounts,
    ::testing::Values(
        Counts{"empty_file", "", "t.csv:1: the file is empty"},
        Counts{"missing_column", "size,correct\n1,2\n", "t.csv:1: missing column 'total'"},
        Counts{"unknown_column", "size,corect,total\n", "t.csv:1: unknown column 'corect', did you mean 'correct'?"},
        Counts{"column_twice", "size,size,correct,total\n", "t.csv:1: column 'size' occurs twice"},
        Counts{"no_header", "1,2,3\n", "t.csv:1: unknown column '1'"},
        Counts{"short_row", "size,correct,total\n1,2\n", "t.csv:2: expected 3 fields as in the header, found 2"},
        Counts{"long_row", "size,correct,total\n1,2,3\n\n1,2,3,4\n",
               "t.csv:4: expected 3 fields as in the header, found 4"},
        Counts{"negative_size", "size,correct,total\n-1,2,3\n",
               "t.csv:2: column size: expected a finite number of 0 or more, found '-1'"},
        Counts{"not_a_number", "size,correct,total\nnan,2,3\n", "t.csv:2: column size"},
        Counts{"infinite", "size,correct,total\n1,2,3\ninf,2,3\n", "t.csv:3: column size"},
        Counts{"text", "size,correct,total\nbig,2,3\n", "t.csv:2: column size"},
        Counts{"empty_field", "size,correct,total\n1,,3\n", "t.csv:2: column correct"},
        Counts{"more_correct_than_shown", "size,correct,total\n1,4,3\n",
               "t.csv:2: column correct: expected at most the total of 3, found '4'"},
        Counts{"fraction", "size,correct,total\n1,2.5,3\n",
               "t.csv:2: column correct: expected a whole number of 0 or more, found '2.5'"},
        Counts{"fraction_of_total", "size,correct,total\n1,2,3.5\n", "t.csv:2: column total"},
        Counts{"negative_count", "size,correct,total\n1,-2,3\n", "t.csv:2: column correct"},
        Counts{"infinite_count", "size,correct,total\n1,2,inf\n", "t.csv:2: column total"}),
    [](const auto& row) { return std::string(row.param.name); });

TEST(Counts, AreReadInAnyColumnOrderWithBlanksAndWindowsLineEnds) {
  const auto levels = parse_levels("\xEF\xBB\xBFtotal, size ,correct\r\n10,0.5,7\r\n\r\n2e9, 0, 5\r\n0,3,0", "t.csv");

  ASSERT_TRUE(levels) << levels.error().message;
  ASSERT_EQ(levels->size(), 3u);
  EXPECT_EQ((*levels)[0].size, 0.5);
  EXPECT_EQ((*levels)[0].correct, 7);
  EXPECT_EQ((*levels)[0].total, 10);
  EXPECT_EQ((*levels)[0].cluster, -1);
  EXPECT_EQ((*levels)[1].size, 0);
  EXPECT_EQ((*levels)[1].total, 2e9);
  EXPECT_EQ((*levels)[2].total, 0);
}

TEST(Counts, MayNameClusters) {
  const auto levels = parse_levels("size,correct,total,cluster\n1,2,3,4\n", "t.csv");

  ASSERT_TRUE(levels) << levels.error().message;
  EXPECT_EQ(levels->at(0).cluster, 4);
}

TEST(Counts, AHeaderAloneIsNoDataButNoMistake) {
  EXPECT_TRUE(parse_levels("size,correct,total\n", "t.csv").value().empty());
}

}  // namespace
}  // namespace todbench
