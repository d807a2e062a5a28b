// SPDX-License-Identifier: GPL-3.0-or-later
// Report and live page in a browser: nothing on its console, nothing from elsewhere, nothing wider than the window.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "bench/report/report.h"
#include "bench/serve/live_run.h"
#include "bench/serve/live_server.h"
#include "tests/bench/report/report_sample.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

struct Looked {
  int exit_code = 0;
  std::string said;
};

/// What Chromium finds wrong with pages; 77 where there is none.
Looked look_at(const std::string& urls) {
  const std::string command = "python3 -B '" + source_file("tests/support/browser_check.py") + "' " + urls + " 2>&1";
  FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return {77, "no shell"};
  Looked looked;
  std::array<char, 512> some{};
  while (std::fgets(some.data(), some.size(), pipe) != nullptr) looked.said += some.data();
  const int ended = ::pclose(pipe);
  looked.exit_code = WIFEXITED(ended) ? WEXITSTATUS(ended) : -1;
  return looked;
}

TEST(Browser, FindsNothingWrongWithReportAndLivePage) {
  const testing::TemporaryFolder folder;
  ReportData data = sample_report();
  Letterhead letterhead;
  letterhead.title = "Acceptance";
  letterhead.lines = {std::string(120, 'L')};
  letterhead.closing_title = "Words";
  data.letterhead = letterhead;
  const auto report = folder.write("report.html", render_report(data));
  const auto server = LiveServer::start({"127.0.0.1", 0}).value();
  Plan plan;
  plan.name = "A plan with a name that is longer than a telephone is wide";
  const LiveCurve curve(plan);
  LiveRun live(*server, curve, plan);
  const ExperimentListener listener = live.listening({});
  listener.on_phase("measuring");
  listener.on_progress(3, 8);
  Frame frame;
  frame.counts = cv::Mat1w(240, 320, static_cast<std::uint16_t>(1000));
  listener.on_frame(frame);
  live.ask("put in plate a, mirrored left to right, and close the door of the enclosure");

  const Looked looked = look_at("'file://" + report.string() + "' '" + server->url() + "'");

  if (looked.exit_code == 77) GTEST_SKIP() << looked.said;
  EXPECT_EQ(looked.exit_code, 0) << looked.said;
}

}  // namespace
}  // namespace todbench
