// Every fault of the way from a camera, at several rates, in a measurement over the wire: what is measured is the same
// as without the fault. The short form has each fault once; the environment variable TODBENCH_STUDY the whole matrix.
#include <gmock/gmock.h>

#include <cstdlib>

#include "tests/sim_devices/gvsp_measurement.h"

namespace todbench {
namespace {

using namespace test;

struct FaultCase {
  std::string name;
  GvspFaults (*faults)(double rate);
  bool survives_whole;  ///< packets come again or in another order: no frame is lost
};

const std::vector<FaultCase>& fault_cases() {
  static const std::vector<FaultCase> cases{
      {"Loss", [](double rate) { return GvspFaults{.packet_loss = rate}; }, true},
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
  return cases;
}

struct Cell {
  FaultCase fault;
  double rate;
};

std::vector<Cell> cells() {
  const std::vector<double> rates =
      std::getenv("TODBENCH_STUDY") != nullptr ? std::vector<double>{0.001, 0.01, 0.05} : std::vector<double>{0.05};
  std::vector<Cell> all;
  for (const auto& fault : fault_cases()) {
    for (const double rate : rates) all.push_back({fault, rate});
  }
  return all;
}

std::string cell_name(const testing::TestParamInfo<Cell>& cell) {
  return cell.param.fault.name + "At" + std::to_string(std::lround(1000 * cell.param.rate)) + "PerMille";
}

void PrintTo(const Cell& cell, std::ostream* out) {
  *out << cell.fault.name << " at " << cell.rate;
}

class FaultMatrix : public testing::TestWithParam<Cell> {};

/// No frame that differs from its exposure, and none twice, was used.
void expect_only_true_frames_were_used(const WireBench& bench, const WireRun& run) {
  std::set<std::uint64_t> seen;
  for (const auto& frame : run.frames) {
    if (run.rejected.count(frame.sequence) != 0) continue;
    EXPECT_EQ(frame.status, FrameStatus::complete) << frame.sequence;
    EXPECT_TRUE(bench.log->knows(frame.counts)) << "frame " << frame.sequence << " is not what was exposed";
    EXPECT_TRUE(seen.insert(picture_hash(frame.counts)).second) << "frame " << frame.sequence << " is a repetition";
  }
}

void expect_same_decisions(const std::vector<Trial>& measured, const std::vector<Trial>& undisturbed) {
  ASSERT_EQ(measured.size(), undisturbed.size());
  for (std::size_t i = 0; i < measured.size(); ++i) {
    EXPECT_EQ(measured[i].frame, undisturbed[i].frame);
    EXPECT_EQ(measured[i].answer, undisturbed[i].answer);
    EXPECT_EQ(measured[i].scores, undisturbed[i].scores);
    EXPECT_EQ(measured[i].delta_t_k, undisturbed[i].delta_t_k);
    EXPECT_EQ(measured[i].phase_x_px, undisturbed[i].phase_x_px);
  }
}

TEST_P(FaultMatrix, LeavesTheResultAsItIsWithoutTheFault) {
  const WireBench bench;
  const auto camera = bench.camera();
  ASSERT_TRUE(camera);
  const auto source = testing_support::open_camera();
  ASSERT_TRUE(source);
  camera->set_faults(GetParam().fault.faults(GetParam().rate));

  const WireRun run = run_over_the_wire(bench, *source);

  ASSERT_TRUE(run.result) << run.result.error().message;
  EXPECT_FALSE(run.result->ended_by) << run.result->ended_by->message;
  EXPECT_EQ(run.result->trials.size(), bench.trials_of_a_run());
  expect_only_true_frames_were_used(bench, run);
  const auto same = undisturbed(bench, run);
  ASSERT_TRUE(same) << same.error().message;
  expect_same_decisions(run.result->trials, same->trials);
  if (GetParam().fault.survives_whole) {
    EXPECT_EQ(run.result->frames_lost, 0U);
    // On a machine that is busy elsewhere a packet may be sent again too late for its frame.
    EXPECT_LE(run.rejected.size(), run.frames.size() / 20);
  }
}

INSTANTIATE_TEST_SUITE_P(Wire, FaultMatrix, testing::ValuesIn(cells()), cell_name);

TEST(EveryModel, DecidesAsTheSimulatedSensorForTheSameExposures) {
  for (const auto model : {CameraModel::ax5, CameraModel::a_series, CameraModel::legacy_science}) {
    const WireBench bench(model);
    const auto camera = bench.camera();
    const auto source = testing_support::open_camera();
    ASSERT_TRUE(camera && source) << to_string(model);

    const WireRun run = run_over_the_wire(bench, *source);

    ASSERT_TRUE(run.result) << to_string(model) << ": " << run.result.error().message;
    EXPECT_EQ(run.result->trials.size(), bench.trials_of_a_run());
    expect_only_true_frames_were_used(bench, run);
    const auto same = undisturbed(bench, run);
    ASSERT_TRUE(same) << same.error().message;
    expect_same_decisions(run.result->trials, same->trials);
  }
}

TEST(FaultCounts, OfFramesThatWereNotUsedAreThoseOfTheCamera) {
  const WireBench bench;
  const auto camera = bench.camera();
  const auto source = testing_support::open_camera();
  ASSERT_TRUE(camera && source);
  camera->set_faults({.swapped_bytes = 0.1, .wrong_size = 0.1});

  const WireRun run = run_over_the_wire(bench, *source);

  ASSERT_TRUE(run.result) << run.result.error().message;
  std::uint64_t wrong_size = 0, swapped = 0;
  for (const auto& frame : run.frames) {
    if (frame.status == FrameStatus::wrong_size) ++wrong_size;
    if (frame.status == FrameStatus::complete && !bench.log->knows(frame.counts)) ++swapped;
  }
  const auto& reasons = run.result->frames_rejected;
  const auto count = [&](const std::string& reason) { return reasons.count(reason) != 0 ? reasons.at(reason) : 0; };
  EXPECT_GT(wrong_size, 0U);
  EXPECT_GT(swapped, 0U);
  EXPECT_EQ(count("wrong_size"), wrong_size);
  EXPECT_EQ(count("byte_swapped") + count("swapped_bytes"), swapped);
  EXPECT_EQ(run.result->frames_lost, 0U);
}

}  // namespace
}  // namespace todbench
