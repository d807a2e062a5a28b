// SPDX-License-Identifier: GPL-3.0-or-later
// A measurement over the wire that loses its camera in mid-run: camera reset, power cut, cable pulled.
#pragma once

#include <gmock/gmock.h>

#include <chrono>

#include "acquisition/aravis/aravis_backend.h"
#include "bench/devices/reconnecting_source.h"
#include "tests/sim_devices/lab/gige/gvsp_measurement.h"

namespace todbench::test {

/// A bench whose camera is opened again by address.
inline std::unique_ptr<ReconnectingSource> reconnecting(std::chrono::milliseconds patience) {
  auto source = testing_support::open_camera();
  if (!source) return nullptr;
  return std::make_unique<ReconnectingSource>(
      std::move(source), [] { return aravis_backend()->open("gige:127.0.0.1"); },
      ReconnectionOptions{.patience = patience, .settings = {{"NUCIntervalFrames", "1234"}}});
}

/// Ways to lose a camera.
inline void disturb(std::size_t kind, const WireBench& bench, std::unique_ptr<GvspCamera>& camera) {
  switch (kind % 3) {
    case 0:
      camera->reset(std::chrono::milliseconds(300));
      break;
    case 1:
      camera.reset();
      bench.log->camera_starts_anew();
      camera = bench.camera();
      break;
    default:
      camera->pull_cable(std::chrono::seconds(1));
  }
}

/// A run that loses its camera so many times makes every trial, on a true frame, with all settings as before.
inline void expect_a_whole_run_over(std::size_t losses) {
  WireBench bench;
  bench.phases = static_cast<int>(losses);
  bench.config.nuc_freeze_frames = 0;  // the correction below comes before the run and must not reach into it
  auto camera = bench.camera();
  ASSERT_TRUE(camera);
  const auto source = reconnecting(std::chrono::seconds(60));
  ASSERT_TRUE(source && source->set("NUCIntervalFrames", "1234") && source->correct_nonuniformity());
  const auto before = source->info().settings;
  bench.host->bring_back = [&](std::stop_token stop) { return source->recover(std::move(stop)); };
  bench.host->confirm = [&] { source->confirm_registration(); };
  MeasurementListener listener;
  std::size_t done = 0;
  listener.on_progress = [&](std::size_t presentations, std::size_t) {
    if (presentations % 2 == 1 && done < losses) disturb(done++, bench, camera);
  };

  const WireRun run = run_over_the_wire(bench, *source, listener);

  ASSERT_TRUE(run.result) << run.result.error().message;
  EXPECT_FALSE(run.result->ended_by) << run.result->ended_by->message;
  EXPECT_EQ(run.result->trials.size(), bench.trials_of_a_run());
  EXPECT_EQ(done, losses);
  EXPECT_GE(run.result->interruptions.size(), losses);
  EXPECT_EQ(source->state(), LinkState::streaming);
  for (const auto& interruption : run.result->interruptions) EXPECT_LT(interruption.moved_px, 0.1);
  std::set<std::uint64_t> sequences;
  for (const auto& frame : run.frames) {
    EXPECT_TRUE(sequences.insert(frame.sequence).second) << frame.sequence;
    EXPECT_TRUE(run.rejected.count(frame.sequence) != 0 || bench.log->knows(frame.counts)) << frame.sequence;
  }
  for (const char* feature : {"TemperatureLinearMode", "TemperatureLinearResolution", "CMOSBitDepth", "NUCMode",
                              "NUCIntervalFrames", "SensorVideoStandard"}) {
    EXPECT_EQ(source->info().settings.at(feature), before.at(feature)) << feature;
    EXPECT_EQ(*source->get(feature), before.at(feature)) << feature;
  }
}

}  // namespace todbench::test
