// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/studies/wire_laboratory.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "bench/devices/emulation.h"

namespace todbench {
namespace {

/// Temperature that a black body shows while its sensor reports `indicated_k`: the errors (set to shown contrast) are
/// interpolated linearly, with the outer ones beyond, so that it drifts between contrasts without a jump.
double shown_where_it_says(const std::map<double, double>& shown_k, double indicated_k) {
  if (shown_k.empty()) return indicated_k;
  const auto above = shown_k.lower_bound(indicated_k);
  const auto error = [](const auto& at) { return at->second - at->first; };
  if (above == shown_k.begin()) return indicated_k + error(above);
  const auto below = std::prev(above);
  if (above == shown_k.end()) return indicated_k + error(below);
  const double part = (indicated_k - below->first) / (above->first - below->first);
  return indicated_k + (1 - part) * error(below) + part * error(above);
}

}  // namespace

Result<WireLaboratory> wire_laboratory(const Plan& plan, const ExperimentInputs& inputs, const LaboratoryErrors& errors,
                                       std::uint64_t seed, std::stop_token stop) {
  auto options = laboratory_options(emulation_for(plan));
  if (!options) return tl::unexpected(options.error());
  RealSetUp real = real_set_up(plan, inputs, errors);
  options->sensor = inputs.sensor;
  options->plan = inputs.effects;
  options->accuracy = inputs.accuracy;
  options->plates = std::move(real.plates);
  options->distance_m = real.distance_m;
  options->stated_scale = real.camera_scale;
  options->seed = seed;
  options->rotation_deg = 0;  // the shifts of even phases (tod/schedule/even_phases.h) need an upright plate
  options->black_body.ambient_k = inputs.sensor.scene_temperature_k;  // as on simulated frames
  options->black_body.real_delta_t_k = [shown_k = std::move(real.shown_k)](double indicated_k) {
    return shown_where_it_says(shown_k, indicated_k);
  };
  auto laboratory = Laboratory::start(*std::move(options));
  if (!laboratory) return fail("starting the emulated laboratory", laboratory.error());
  const auto loaded = LoadedPlan::load(with_laboratory(plan, **laboratory));
  if (!loaded) return tl::unexpected(loaded.error());
  auto bench = open_bench(*loaded, std::move(stop));
  if (!bench) return tl::unexpected(bench.error());
  return WireLaboratory{.laboratory = *std::move(laboratory), .bench = *std::move(bench)};
}

Result<std::vector<LaboratoryPoint>> measured_over_the_wire(const Plan& of_all, const ExperimentInputs& inputs,
                                                            std::uint64_t laboratory, std::stop_token stop) {
  const Plan plan = plan_of_laboratory(of_all, laboratory);
  // Far from the seeds of all laboratories on simulated frames: laboratories of the same number share no noise.
  constexpr std::uint64_t of_wire = std::uint64_t{1} << 32;
  auto opened =
      wire_laboratory(plan, inputs, drawn_errors(plan, of_all.seed, laboratory), plan.seed + 1 + of_wire, stop);
  if (!opened) return tl::unexpected(opened.error());
  return measured_on_bench(opened->bench, plan, inputs, laboratory, std::move(stop));
}

}  // namespace todbench
