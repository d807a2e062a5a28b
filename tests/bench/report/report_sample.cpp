// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/report/report_sample.h"

#include <cmath>

namespace todbench {
namespace {

constexpr int trials_per_presentation = 10;

TodCurve sample_curve(double factor) {
  TodCurve curve;
  curve.observer = "template-stack 1";
  curve.sensor = "sc2000";
  curve.points = {sample_point(20, 16.9, 2.083 * factor, 0.026), sample_point(2, 1.93, 2.131 * factor, 0.031),
                  sample_point(0.25, 0.231, 3.482 * factor, 0.047)};
  return curve;
}

ComparisonPoint sample_comparison(double set_delta_t_k, double seen_k, double ratio, ComparisonVerdict verdict) {
  ComparisonPoint point;
  point.set_delta_t_k = set_delta_t_k;
  point.delta_t_a_k = seen_k;
  point.delta_t_b_k = set_delta_t_k;
  point.ratio = ratio;
  point.ratio_ci95 = {ratio * 0.962, ratio * 1.041};
  point.ratio_ci90 = {ratio * 0.968, ratio * 1.034};
  point.p_difference = verdict == ComparisonVerdict::different ? 0.0002 : 0.413;
  point.p_equivalence = verdict == ComparisonVerdict::equivalent ? 0.0123 : 0.271;
  point.margin_percent = 10;
  point.verdict = verdict;
  return point;
}

Verdict sample_verdict() {
  Demand met{.kind = DemandKind::acuity, .delta_t_k = 20, .limit = 0.44, .result = 0.48, .interval = {0.468, 0.493}};
  met.decision = VerdictKind::pass;
  met.reason = "The whole interval is above the limit.";
  Demand open{
      .kind = DemandKind::acuity, .delta_t_k = 2, .limit = 0.465, .result = 0.4693, .interval = {0.4551, 0.4843}};
  open.reason = "The interval contains the limit: more trials are needed.";
  Demand missed{
      .kind = DemandKind::acuity, .delta_t_k = 0.25, .limit = 0.32, .result = 0.2872, .interval = {0.2743, 0.3013}};
  missed.decision = VerdictKind::fail;
  missed.reason = "The whole interval is below the limit.";
  Verdict verdict;
  verdict.decision = VerdictKind::fail;
  verdict.rule_in_words =
      "Guarded acceptance and rejection: a limit is met or violated only when the whole 95 % interval lies on one side "
      "of it; otherwise it "
      "is inconclusive.";
  verdict.demands = {met, open, missed};
  return verdict;
}

SetUpRecord sample_set_up(const std::string& plate, Mounting mounting, double rotation_deg) {
  SetUpRecord record;
  record.plate = plate;
  record.mounting = mounting;
  record.registration.scale_px_per_mm = 0.2547;
  record.registration.scale_deviation = -0.0003;
  record.registration.rotation_deg = rotation_deg;
  record.registration.residual_px = 0.041;
  record.registration.triangles_used = 12;
  return record;
}

TargetPlate sample_plate(const std::string& name, double largest_mm) {
  TargetPlate plate{name, "", 280, 200, {}};
  for (int row = 0; row < 5; ++row)
    for (int i = 0; i < 4; ++i)
      plate.triangles.push_back({"row " + std::to_string(row) + ", triangle " + std::to_string(i),
                                 {-90.0 + 60 * i, -70.0 + 35 * row},
                                 largest_mm * std::pow(1.25, -row),
                                 all_apexes[static_cast<std::size_t>((row + i) % 4)]});
  return plate;
}

SourceInfo sample_camera() {
  SourceInfo camera;
  camera.id = "gige:Example-48000123";
  camera.vendor = "Example Infrared";
  camera.model = "TI-320";
  camera.serial = "48000123";
  camera.firmware = "2.14.0";
  camera.transport = "GigE Vision";
  camera.width = 320;
  camera.height = 240;
  camera.pixel_format = "Mono14";
  camera.significant_bits = 14;
  camera.frame_rate_hz = 50;
  camera.settings = {{"PixelFormat", "Mono14"},
                     {"AcquisitionFrameRate", "50"},
                     {"IRFormat", "TemperatureLinear10mK"},
                     {"NUCMode", "Manual"},
                     {"NoiseReduction", "Off"}};
  camera.warnings = {"The system granted 212992 of the 8388608 bytes asked for the socket buffer."};
  return camera;
}

void add_simulation(ReportData& data) {
  SensorSpec spec;
  spec.name = "sc2000";
  data.simulated_sensor = spec;
  data.plan.decisions = {
      {Effect::diffraction, Decision::simulate, "Part of the point spread.", 1.9},
      {Effect::aberration, Decision::skip, "Neutral: the blur of this sensor is zero.", 0.0},
      {Effect::detector, Decision::simulate, "The footprint is 0.89 of the pitch.", 14.2},
      {Effect::temporal_noise, Decision::simulate, "Always simulated: no criterion bounds its effect.", std::nullopt},
      {Effect::fixed_pattern, Decision::skip, "Neutral: the data sheet states none.", 0.0},
      {Effect::quantisation, Decision::skip, "The step of 0.01 K is a seventh of the noise.", 0.02}};
}

}  // namespace

std::vector<Level> expected_answers(double threshold_mrad, double slope, int clusters) {
  std::vector<Level> levels;
  for (int i = 0; i < 8; ++i) {
    const double size = threshold_mrad * std::pow(1.2, i - 3.6);
    const double right = 1 - 0.75 * std::exp(-std::log(3.0) * std::pow(size / threshold_mrad, slope));
    double given = 0;
    for (int cluster = 0; cluster < clusters; ++cluster) {
      const double wanted = std::round(right * trials_per_presentation * (cluster + 1));
      levels.push_back({size, wanted - given, trials_per_presentation, cluster});
      given = wanted;
    }
  }
  return levels;
}

TodPoint sample_point(double set_delta_t_k, double seen_delta_t_k, double threshold_mrad, double relative) {
  constexpr double slope = 5.2;
  constexpr int clusters = 16;
  TodPoint point;
  point.set_delta_t_k = set_delta_t_k;
  point.delta_t_k = seen_delta_t_k;
  point.delta_t_se_k = 0.0042;
  point.levels = expected_answers(threshold_mrad, slope, clusters);
  point.fit.verdict = FitVerdict::ok;
  point.fit.threshold = threshold_mrad;
  point.fit.ci95 = {threshold_mrad / (1 + relative), threshold_mrad * (1 + relative)};
  point.fit.slope = slope;
  point.fit.trials = 8 * trials_per_presentation * clusters;
  point.fit.clusters = clusters;
  return point;
}

ReportData sample_report() {
  ReportData data;
  data.session = "20240311T091500Z_TI-320_48000123_tod";
  data.description = "Factory acceptance, three contrasts";
  data.started = "2024-03-11T09:15:00Z";
  data.finished = "2024-03-11T09:58:12Z";
  data.operator_name = "A. Operator";
  data.place = "Laboratory 2, optical bench";
  data.conditions = {{"Customer", "Example Customs"}, {"Room temperature (°C)", "21.3"}, {"Warm-up (min)", "45"}};
  data.camera = sample_camera();
  data.distance_m = 3;
  data.ifov_mrad = 1.309;
  data.target = "Black body BB-150 serial 7711, plate stage PS-2 serial 0042";
  data.plates = {sample_plate("fine", 10), sample_plate("coarse", 18)};
  for (const std::string plate : {"fine", "coarse"})
    for (const Mounting mounting : all_mountings)
      data.set_ups.push_back(sample_set_up(plate, mounting, mounting == Mounting::identity ? 0.12 : -0.08));
  data.observer = "template-stack 1";
  data.measured = sample_curve(1);
  data.simulated = sample_curve(0.985);
  for (TodPoint& point : data.simulated->points) {
    point.delta_t_k = point.set_delta_t_k;
    point.direct_s75_mrad = *point.fit.threshold * 1.004;
    point.direct_s75_se_mrad = 0.0071;
  }
  data.comparison = Comparison{{sample_comparison(20, 16.9, 0.985, ComparisonVerdict::equivalent),
                                sample_comparison(2, 1.93, 0.981, ComparisonVerdict::inconclusive),
                                sample_comparison(0.25, 0.231, 0.873, ComparisonVerdict::different)},
                               ComparisonVerdict::different};
  data.verdict = sample_verdict();
  add_simulation(data);
  data.frames_used = 1536;
  data.frames_rejected = {{"incomplete", 3}, {"nonuniformity_correction", 41}};
  data.frames_lost = 2;
  data.temporal_noise_k = 0.0713;
  data.provenance = {{"todbench", "0.1.0"}, {"Git commit", "0123456789abcdef"}, {"Seed", "1"}, {"Host", "bench-2"}};
  data.notes = {"The plate was registered again after every change of mounting."};
  return data;
}

}  // namespace todbench
