// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/base/process.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <csignal>
#include <thread>

namespace todbench {
namespace {

TEST(RunProgram, KeepsOutputAndErrorsAndTheExitCode) {
  const auto run = run_program({"/bin/sh", "-c", "echo one; echo two >&2; exit 3"}, ProgramOutput::kept);

  ASSERT_TRUE(run) << run.error().message;
  EXPECT_EQ(run->output, "one\ntwo\n");
  EXPECT_EQ(run->exit_code, 3);
}

TEST(RunProgram, LeavesOutErrorsWhenAsked) {
  const auto run = run_program({"/bin/sh", "-c", "echo one; echo two >&2"}, ProgramOutput::kept_but_errors);

  ASSERT_TRUE(run) << run.error().message;
  EXPECT_EQ(run->output, "one\n");
}

TEST(RunProgram, ReadsMoreThanItKeepsSoThatTheProgramEnds) {
  const auto run = run_program({"/bin/sh", "-c", "head -c 3000000 /dev/zero"}, ProgramOutput::kept);

  ASSERT_TRUE(run) << run.error().message;
  EXPECT_EQ(run->exit_code, 0);
  EXPECT_EQ(run->output.size(), std::size_t{1} << 20);
}

TEST(RunProgram, NamesAProgramThatDoesNotExist) {
  const auto run = run_program({"no-such-program-anywhere"}, ProgramOutput::kept);

  ASSERT_FALSE(run);
  EXPECT_EQ(run.error().code, ErrorCode::not_found);
  EXPECT_EQ(run.error().message, "no-such-program-anywhere is not installed");
}

/// Blocks the signals that a program with a thread for signals blocks.
class BlockedSignals {
 public:
  BlockedSignals() {
    sigset_t blocked;
    sigemptyset(&blocked);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&blocked, signal);
    ::pthread_sigmask(SIG_BLOCK, &blocked, &before_);
  }
  ~BlockedSignals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;

 private:
  sigset_t before_{};
};

TEST(RunProgram, EndsWithAStopRequestAlsoWhereSignalsAreBlocked) {
  const BlockedSignals blocked;
  for (const ProgramOutput output : {ProgramOutput::kept, ProgramOutput::shown}) {
    std::stop_source stop;
    std::jthread later([&] { stop.request_stop(); });

    const auto run = run_program({"sleep", "1000"}, output, stop.get_token());

    ASSERT_TRUE(run) << run.error().message;
    EXPECT_EQ(run->exit_code, 128 + SIGTERM);
  }
}

TEST(RunProgram, HasNoBlockedSignalAndNoneIgnored) {
  const BlockedSignals blocked;
  const auto handler = std::signal(SIGPIPE, SIG_IGN);
  const auto run = run_program({"grep", "-E", "SigBlk|SigIgn", "/proc/self/status"}, ProgramOutput::kept);
  std::signal(SIGPIPE, handler);

  ASSERT_TRUE(run) << run.error().message;
  EXPECT_EQ(run->output.find("SigBlk:\t0000000000000000"), 0u) << run->output;
  constexpr unsigned pipe_signal = 1U << (SIGPIPE - 1);
  const auto ignored = std::stoull(run->output.substr(run->output.find("SigIgn:") + 8), nullptr, 16);
  EXPECT_EQ(ignored & pipe_signal, 0u) << run->output;
}

TEST(StartProgram, GivesTheStreamsThatItIsGiven) {
  auto in = make_pipe();
  auto out = make_pipe();
  ASSERT_TRUE(in && out);

  const auto process = start_program({"cat"}, {.input = in->read.get(), .output = out->write.get()});
  in->read.close();
  out->write.close();
  ASSERT_TRUE(process) << process.error().message;
  ASSERT_EQ(::write(in->write.get(), "abc", 3), 3);
  in->write.close();

  char text[8]{};
  EXPECT_EQ(::read(out->read.get(), text, sizeof text), 3);
  EXPECT_STREQ(text, "abc");
  EXPECT_EQ(wait_for_program(*process).value(), 0);
}

}  // namespace
}  // namespace todbench
