// SPDX-License-Identifier: GPL-3.0-or-later
// Every fault of the way from a camera, in a measurement over the wire: what is measured is the same as without the
// fault.
#pragma once

#include <gmock/gmock.h>

#include "tests/sim_devices/lab/gige/gvsp_measurement.h"

namespace todbench::test {

struct WireFault {
  std::string name;
  GvspFaults (*faults)(double rate);
  bool survives_whole;  ///< packets come again or in another order: no frame is lost
};

inline std::vector<WireFault> wire_faults() {
  return {{"Loss", [](double rate) { return GvspFaults{.packet_loss = rate}; }, true},
          {"Duplicates", [](double rate) { return GvspFaults{.duplicate = rate}; }, true},
          {"Reordering", [](double rate) { return GvspFaults{.reorder = rate}; }, true},
          {"LateLeaders", [](double rate) { return GvspFaults{.late_leader = rate}; }, false},
          {"LostFrames", [](double rate) { return GvspFaults{.lost_frame = rate}; }, false},
          {"FrozenPictures", [](double rate) { return GvspFaults{.frozen = rate}; }, false},
          {"SwappedBytes", [](double rate) { return GvspFaults{.swapped_bytes = rate}; }, false},
          {"WrongSizes", [](double rate) { return GvspFaults{.wrong_size = rate}; }, false},
          {"AllAtOnce",
           [](double rate) {
             return GvspFaults{.packet_loss = rate,
                               .duplicate = rate,
                               .reorder = rate,
                               .late_leader = rate,
                               .lost_frame = rate,
                               .frozen = rate,
                               .swapped_bytes = rate,
                               .wrong_size = rate};
           },
           false}};
}

/// A fault and how often it comes.
using WireCell = std::tuple<WireFault, double>;

inline std::string name_of(const testing::TestParamInfo<WireCell>& cell) {
  return std::get<0>(cell.param).name + "At" + std::to_string(std::lround(1000 * std::get<1>(cell.param))) + "PerMille";
}

inline void PrintTo(const WireFault& fault, std::ostream* out) {
  *out << fault.name;
}

/// No frame that differs from its exposure, and none twice, was used.
inline void expect_only_true_frames_were_used(const WireBench& bench, const WireRun& run) {
  std::set<std::uint64_t> seen;
  for (const auto& frame : run.frames) {
    if (run.rejected.count(frame.sequence) != 0) continue;
    EXPECT_EQ(frame.status, FrameStatus::complete) << frame.sequence;
    EXPECT_TRUE(bench.log->knows(frame.counts)) << "frame " << frame.sequence << " is not what was exposed";
    EXPECT_TRUE(seen.insert(picture_hash(frame.counts)).second) << "frame " << frame.sequence << " is a repetition";
  }
}

inline void expect_same_decisions(const std::vector<Trial>& measured, const std::vector<Trial>& undisturbed) {
  ASSERT_EQ(measured.size(), undisturbed.size());
  for (std::size_t i = 0; i < measured.size(); ++i) {
    EXPECT_EQ(measured[i].frame, undisturbed[i].frame);
    EXPECT_EQ(measured[i].answer, undisturbed[i].answer);
    EXPECT_EQ(measured[i].scores, undisturbed[i].scores);
    EXPECT_EQ(measured[i].delta_t_k, undisturbed[i].delta_t_k);
    EXPECT_EQ(measured[i].phase_x_px, undisturbed[i].phase_x_px);
  }
}

/// A measurement with the fault at a rate is the undisturbed one over the same exposures.
inline void expect_the_result_without(const WireFault& fault, double rate) {
  const WireBench bench;
  const auto camera = bench.camera();
  ASSERT_TRUE(camera);
  const auto source = testing_support::open_camera();
  ASSERT_TRUE(source);
  camera->set_faults(fault.faults(rate));

  const WireRun run = run_over_the_wire(bench, *source);

  ASSERT_TRUE(run.result) << run.result.error().message;
  EXPECT_FALSE(run.result->ended_by) << run.result->ended_by->message;
  EXPECT_EQ(run.result->trials.size(), bench.trials_of_a_run());
  expect_only_true_frames_were_used(bench, run);
  const auto same = undisturbed(bench, run);
  ASSERT_TRUE(same) << same.error().message;
  expect_same_decisions(run.result->trials, same->trials);
  if (fault.survives_whole) {
    EXPECT_EQ(run.result->frames_lost, 0U);
    // On a machine that is busy elsewhere a packet may be sent again too late for its frame.
    EXPECT_LE(run.rejected.size(), run.frames.size() / 20);
  }
}

}  // namespace todbench::test
