// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/noise_components.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "acquisition/base/try.h"
#include "acquisition/core/count_step.h"
#include "acquisition/core/input_gate.h"
#include "bench/cli/commands.h"
#include "bench/cli/noise_gates.h"
#include "bench/cli/started_recording.h"
#include "bench/judgement/verdict.h"
#include "tod/measures/three_d_noise.h"

namespace todbench {
namespace {

/// Below this correlation the error of the variance of tvh is less than a quarter of a frame's share.
constexpr double components_white_enough = 0.1;

struct WholeRecording {
  NoiseTable table;
  bool kelvin = false;
  ByteOrderVerdict byte_order = ByteOrderVerdict::as_stated;
  int left_out = 0;            ///< incomplete or damaged frames
  int repeated = 0;            ///< frames identical to the one before, bit for bit
  double memory = 0;           ///< correlation of the pixels' noise in successive frames, if known
  double unit_per_count = 1;   ///< 0: unknown
  double saturated_share = 0;  ///< of all pixels of all frames, because every pixel counts in the components
  CountStep step;
  EndValues ends;
};

std::optional<NoiseFault> fault_of(const WholeRecording& whole) {
  const double variance = estimate_of(whole.table, NoiseComponent::tvh).variance;
  return noise_fault(
      {whole.saturated_share, whole.unit_per_count, whole.step.counts_per_step(), whole.ends.clipped_share()},
      std::sqrt(std::max(0.0, variance)));
}

std::string_view verdict_of(const WholeRecording& whole, const std::optional<NoiseFault>& fault) {
  if (fault) return fault->verdict;
  return std::abs(whole.memory) > components_white_enough ? "correlated" : "ok";
}

/// Detects that the camera reports a correction between this frame and the last one.
class StatedCorrection {
 public:
  [[nodiscard]] bool before(const Frame& frame) {
    const bool restarted = frame.since_correction_s >= 0 && frame.since_correction_s < last_s_;
    last_s_ = frame.since_correction_s;
    return restarted || frame.correction == CorrectionState::running;
  }

 private:
  double last_s_ = -1;
};

Result<void> add(NoiseCube& cube, const Frame& frame, bool kelvin) {
  if (!kelvin) return cube.add(frame.counts);
  const auto picture = to_kelvin(frame);
  if (!picture) return fail("frame " + std::to_string(frame.sequence), picture.error());
  return cube.add(*picture);
}

tl::unexpected<Error> corrected(int frame) {
  return fail(ErrorCode::invalid_input, "the camera performed a correction (NUC) before frame " +
                                            std::to_string(frame + 1) +
                                            ", or the scene moved there; the components would not be those of the "
                                            "camera's noise. Record again, or accept this with --across-corrections");
}

tl::unexpected<Error> unsteady() {
  return fail(
      ErrorCode::invalid_input,
      "the noise changes within the recording, or the scene moves: some successive frames differ much more than "
      "others; the components would not be those of the camera's noise. Record again, or accept this with "
      "--across-corrections");
}

tl::unexpected<Error> outside_picture(int row, int rows) {
  return fail(ErrorCode::invalid_input,
              "row " + std::to_string(row + 1) + " of " + std::to_string(rows) +
                  " is no part of the picture: it differs from the rows beside it as telemetry or a defect does, and "
                  "would determine the components. Record again without this row");
}

Result<WholeRecording> whole_recording(Console& console, const std::string& id, AcrossCorrections across) {
  TODBENCH_TRY(const auto source, started_recording(console, id));
  InputGate gate;
  WholeRecording whole;
  whole.kelvin = source->info().scale.calibrated();
  NoiseCube cube;
  StatedCorrection stated;
  cv::Mat1w last;
  for (;;) {
    auto frame = source->next(std::chrono::seconds(1));
    if (!frame && frame.error().code == ErrorCode::disconnected) break;
    if (!frame) return fail(id, frame.error());
    if (!gate.takes(*frame)) {
      ++whole.left_out;
      continue;
    }
    if (stated.before(*frame) && across == AcrossCorrections::refuse) return corrected(cube.frames());
    if (!last.empty() && last.size() == frame->counts.size() && cv::norm(last, frame->counts, cv::NORM_INF) == 0) {
      ++whole.repeated;
      continue;
    }
    last = frame->counts;
    if (cube.frames() == 0 && whole.kelvin) whole.unit_per_count = kelvin_per_count(*frame, source->info().scale);
    whole.saturated_share += cv::mean(saturated_pixels(*frame))[0];
    whole.step.add(frame->counts);
    whole.ends.add(cv::Mat1f(frame->counts), {});
    if (auto added = add(cube, *frame, whole.kelvin); !added)
      return fail(ErrorCode::invalid_input, added.error().message);
  }
  if (auto sound = gate.verdict(); !sound) return fail(id, sound.error());
  for (const auto& sentence : {gate.cadence(), gate.byte_order().note()}) {
    if (!sentence.empty()) console.note(sentence);
  }
  whole.byte_order = gate.byte_order().verdict();
  if (cube.frames() < 2) return tl::unexpected(too_few_frames(cube.frames(), whole.repeated));
  whole.saturated_share /= cube.frames();
  TODBENCH_TRY(whole.table, cube.table());
  whole.memory = cube.pixel_memory();
  if (const auto row = cube.row_outside_picture()) return outside_picture(*row, whole.table.rows);
  if (const auto change = cube.abrupt_change(); change && across == AcrossCorrections::refuse)
    return cube.few_pairs_stand_out() ? corrected(*change) : unsteady();
  if (cube.noise_changes() && across == AcrossCorrections::refuse) return unsteady();
  return whole;
}

Json components_json(const WholeRecording& whole, const std::string& recording) {
  Json variances, intervals, deviations, squares, freedom, absent;
  const auto fault = fault_of(whole);
  const bool stated = !fault;
  for (const NoiseComponent component : noise_components) {
    const ComponentEstimate found = estimate_of(whole.table, component);
    const std::string name(to_string(component));
    const auto number = [&](double value) { return stated ? json_number(value) : Json(); };
    variances[name] = number(found.variance);
    intervals[name] = {number(found.low), number(found.high)};
    deviations[name] = number(std::sqrt(std::max(0.0, found.variance)));
    squares[name] = number(whole.table.mean_squares[component]);
    freedom[name] = whole.table.degrees_of_freedom[component];
    if (found.p_absent) absent[name] = number(*found.p_absent);
  }
  return {{"recording", recording},
          {"unit", whole.kelvin ? "K" : "counts"},
          {"frames", whole.table.frames},
          {"height", whole.table.rows},
          {"width", whole.table.columns},
          {"byte_order", to_string(whole.byte_order)},
          {"frames_left_out", whole.left_out},
          {"frames_repeated", whole.repeated},
          {"verdict", verdict_of(whole, fault)},
          {"variances", variances},
          {"intervals", intervals},
          {"standard_deviations", deviations},
          {"mean_squares", squares},
          {"degrees_of_freedom", freedom},
          {"p_absent", absent}};
}

void print_components(Console& console, const WholeRecording& whole) {
  const std::string unit = whole.kelvin ? "K" : "counts";
  std::vector<TableRow> rows;
  for (const NoiseComponent component : noise_components) {
    const ComponentEstimate found = estimate_of(whole.table, component);
    rows.push_back({std::string(to_string(component)), fixed(std::sqrt(std::max(0.0, found.variance)), 4),
                    fixed(found.variance, 6), range({found.low, found.high}, 6),
                    found.p_absent ? fixed(found.p_absent, 4) : ""});
  }
  console.text(std::to_string(whole.table.frames) + " frames of " + std::to_string(whole.table.rows) + " rows and " +
               std::to_string(whole.table.columns) + " columns");
  console.table({"component", "sd [" + unit + "]", "variance [" + unit + "^2]", "95 %", "p absent"}, rows);
}

}  // namespace

int run_noise_components(Console& console, const std::string& recording, AcrossCorrections across) {
  const auto whole = whole_recording(console, recording, across);
  if (!whole) {
    const bool named = whole.error().message.find(recording) != std::string::npos;
    return report_error(console, named ? whole.error() : with_context(recording, whole.error()));
  }
  if (whole->left_out > 0)
    console.note("incomplete or damaged frames, which were skipped: " + std::to_string(whole->left_out));
  if (whole->repeated > 0) {
    console.note("frames that repeat the frame before them and were skipped: " + std::to_string(whole->repeated));
  }
  if (std::abs(whole->memory) > components_white_enough) {
    console.note("the noise is correlated in time: successive frames have a correlation of " + fixed(whole->memory, 2) +
                 ". The components assume independent frames, so tvh is too " +
                 (whole->memory > 0 ? "small and vh too large" : "large and vh too small"));
  }
  const auto fault = fault_of(*whole);
  const bool stated = !fault;
  if (fault) console.note(fault->message);
  if (console.json())
    console.object(components_json(*whole, recording));
  else if (stated)
    print_components(console, *whole);
  return stated ? 0 : exit_code(VerdictKind::inconclusive);
}

}  // namespace todbench
