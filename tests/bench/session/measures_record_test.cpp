// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of measures.json: as written by every version, and required or optional when read.
#include "bench/session/measures_record.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

namespace todbench {
namespace {

using ::testing::StartsWith;

Estimate around(double value) {
  return {value, value - 0.25, value + 0.5};
}

/// Every measure that is read back, with numbers that differ.
CameraMeasures every_measure() {
  CameraMeasures all;
  all.transfer = TransferMeasure{.frames_each = 8, .steps = {{1, 1.5, 1.25, 0.125}, {2, 2.5, 2.25, 0.25}}, .line = {}};
  all.transfer->line = {.slope = 0.75, .offset = 0.5, .slope_u = 0.125, .chi2 = 3, .degrees_of_freedom = 2, .p = 0.25};
  all.geometry = GeometryMeasure{.plate = "tcat-a", .frames = 4, .set_delta_t_k = 5, .distance_m = 2.5, .geometry = {}};
  all.geometry->stated_ifov_mrad = 1.25;
  all.geometry->picture = {320, 240};
  all.geometry->distance_relative_u = 0.125;
  PlateGeometry& plate = all.geometry->geometry;
  plate.mm_per_px_x = around(2), plate.mm_per_px_y = around(3);
  plate.centre_x_mm = around(4), plate.centre_y_mm = around(5), plate.rotation_deg = around(6);
  plate.keystone_x_percent = around(7), plate.keystone_y_percent = around(8), plate.distortion_percent = around(9);
  plate.residual_px = 0.5, plate.farthest_px = 150, plate.corner_px = 200;
  plate.places.push_back({"a1", {10.5, 20.25}, {0.125, -0.25}});
  const DriftFit line{.shape = DriftShape::linear,
                      .change_k = 0.5,
                      .change_ci95 = {0.25, 0.75},
                      .time_constant_s = std::nullopt,
                      .p_linear = 0.5,
                      .seen_k = {0, 0.5},
                      .fitted_k = {0.125, 0.375}};
  DriftFit approach = line;
  approach.shape = DriftShape::approach, approach.time_constant_s = 12.5, approach.time_constant_ci95 = {10, {}};
  all.drift =
      DriftMeasure{.groups = 2, .frames_each = 3, .first_s = 0.5, .last_s = 9.5, .law = {{0.5, 9.5}, line, approach}};
  all.response = ResponseMeasure{
      .delta_t_k = 4, .frame_s = 0.02, .settling_s = 0.5, .dropped = 1, .bright_pixels = 90, .response = {}};
  StepResponse& steps = all.response->response;
  steps.both = {0.125, 0.0625, 0.25, 16};
  steps.rise = StepTimeConstant{0.5, 0.25, 0.75, 8};
  steps.p_first_order = 0.5, steps.samples = 24;
  steps.points = {{0.02, 0.5, true}, {0.04, 0.25, false}};
  const EdgeMtf edge{.place = "corner",
                     .axis = EdgeAxis::y,
                     .sides = 2,
                     .middle_px = {30.5, 40.5},
                     .angle_deg = 5,
                     .noise_over_step = 0.125,
                     .frequency_per_pitch = {0, 0.5, 1},
                     .mtf = {1, 0.5, 0.25},
                     .low = {0.75, 0.25, 0},
                     .high = {1.25, 0.75, 0.5},
                     .widest_halo_pitch = 2,
                     .halo_allowance = 0.0625,
                     .wide_halo_least = 0.25,
                     .wide_halo_most = 0.5,
                     .mtf50_per_pitch = 0.5,
                     .model = {1, 0.625, 0.375}};
  all.mtf = MtfMeasure{.plate = "edges",
                       .frames = 6,
                       .set_delta_t_k = 8,
                       .said_delta_t_k = 8.5,
                       .pitch_mrad = 0.5,
                       .frequency_per_pitch = 0.5,
                       .edges = {edge, edge}};
  all.mtf->edges.back().mtf50_per_pitch.reset();
  all.mtf->edges.back().model.clear();
  const BarsCtf bars{.group = "g1",
                     .axis = EdgeAxis::x,
                     .frequency_per_pitch = 0.25,
                     .angle_deg = 4,
                     .middle_px = {50.5, 60.5},
                     .pixels = 99,
                     .noise_over_contrast = 0.125,
                     .best = around(0.75),
                     .mean = around(0.5),
                     .worst = around(0.25),
                     .bars_separated_at_best = 4,
                     .share_of_four = 0.875,
                     .model = BarsModel{0.75, 0.625, 0.5}};
  all.ctf = CtfMeasure{.plate = "bars",
                       .frames = 7,
                       .set_delta_t_k = 3,
                       .said_delta_t_k = 3.5,
                       .pitch_mrad = 0.5,
                       .frequency_per_pitch = 0.25,
                       .bars = {}};
  all.ctf->bars.groups = {bars, bars};
  all.ctf->bars.groups.back().model.reset();
  all.ctf->bars.contrast_k = 2.5, all.ctf->bars.far_spread = 0.125;
  all.source = SourceSizeMeasure{
      .plate = "source", .frames = 9, .set_delta_t_k = 20, .said_delta_t_k = 20.5, .stated_px = 6, .effect = {}};
  all.source->effect = {
      .reference_px = 64,
      .reference_k = 19.5,
      .reference_u_k = 0.25,
      .points = {{"hole", false, 6, around(0.75), 0.875, -1}, {"ring", true, 8, around(0.25), 0.125, -1}},
      .size_px = {4, 64},
      .ratio = {around(0.5), around(1)},
      .chi2 = 1.5,
      .degrees_of_freedom = 2,
      .consistent = true};
  all.absolute = AbsoluteMeasure{.plate = "black body", .frames = 12};
  all.absolute->levels = {
      {.set_k = 290, .said_k = 290.5, .expected_k = 290.25, .seen_k = 291, .pattern_k = around(0.5)},
      {.set_k = 300, .said_k = 300.5, .expected_k = 300.25, .seen_k = 301, .saturated = true}};
  all.absolute->levels.front().difference_k = 0.125, all.absolute->levels.front().camera_c = 25.5;
  all.absolute->repeatability_k = 0.125, all.absolute->u_k = 0.25, all.absolute->degrees_of_freedom = 5;
  all.absolute->source_u_k = 0.0625, all.absolute->nonlinearity_percent = 0.5;
  all.absolute->undetermined_slope_k = 0.75;
  all.latency =
      LatencyMeasure{.speed_mm_s = 12.5, .runs_ms = {3, 4}, .frames_ms = {2.5, 3.5, 4.5}, .latency_ms = around(3.5)};
  const MrtdPoint point{.place = "bars-1",
                        .axis = EdgeAxis::y,
                        .frequency_per_pitch = 0.25,
                        .positive_k = 0.5,
                        .negative_k = -0.75,
                        .threshold_k = 0.625,
                        .ci95 = {0.5, 0.75},
                        .spread_k = std::pair(0.25, 1.5),
                        .best_phase_k = 0.375,
                        .best_phase_ci95 = {0.25, {}},
                        .best_phase = 0.125,
                        .positive_share = {0.5, 1},
                        .negative_share = {0.25, 0.75}};
  all.mrtd = MrtdMeasure{.plate = "mrtd", .observer = "hvs-2", .frames = 5, .set_ups = 3, .mountings = 2};
  all.mrtd->pitch_mrad = 0.5, all.mrtd->frequency_per_pitch = 0.25, all.mrtd->spot_px = 3;
  all.mrtd->contrast_k = {0.25, 0.5};
  all.mrtd->bars = {point};
  all.mrtd->spots = {{.place = "spot", .size_px = 3, .reason = "no decision"}};
  all.gain_control = GainControlMeasure{.unit = "count", .frames = 10, .levels = {{1, 1.5, 100, 90, 200, 8, 0.5}}};
  all.gain_control->levels.push_back({10, 10.5, 101, 80, 300, 60, 0.25});
  all.gain_control->settling = all.response;
  all.gain_control->settling->change = 3.5;
  all.picture = PlatePicture{};
  all.picture->seen.kelvin = cv::Mat1d(4, 5, 300.0);
  all.picture->seen.kelvin(1, 1) = 301;
  all.picture->expected_k = cv::Mat1d(4, 5, 300.5);
  all.picture->residual_k = 0.125;
  all.picture->outlines = {{{1.5, 2.5}, {3, 4}}};
  all.triangles = {{.set_delta_t_k = 2, .frames = 3, .size_px = {4, 2}, .kelvin = cv::Mat1d(2, 3, 300.0)}};
  all.timing = TimingMeasure{};
  all.reasons = {"noise: not asked"};
  return all;
}

Json written(const CameraMeasures& measures) {
  return measures_json(measures, std::nullopt);
}

/// Returns the measures that were read.
CameraMeasures read_back(const MeasureLines& lines) {
  CameraMeasures all;
  all.transfer = lines.transfer, all.geometry = lines.geometry, all.drift = lines.drift;
  all.response = lines.response, all.mtf = lines.mtf, all.ctf = lines.ctf, all.source = lines.source;
  all.absolute = lines.absolute, all.latency = lines.latency, all.mrtd = lines.mrtd;
  all.gain_control = lines.gain_control;
  if (all.transfer) all.transfer->line.degrees_of_freedom = 2;  // not read, and above 0
  return all;
}

/// A part of the record.
struct Part {
  const char* key;
  const char* text;                   ///< as written; null: not compared
  std::vector<std::string> optional;  ///< ends of the names of keys that may be missing
  std::vector<std::string> nullable;  ///< of keys that may be null
};

void PrintTo(const Part& part, std::ostream* out) {
  *out << part.key;
}

/// A value of the record, and its name in a message.
struct Place {
  Json::json_pointer at;
  std::string key, name;
};

bool among(const std::vector<std::string>& ends, const Place& place) {
  return std::ranges::any_of(ends, [&](const std::string& end) { return place.name.ends_with("." + end); });
}

/// Adds all keys below a place; of a list only those of its first element.
void add_keys(const Json& record, const Place& place, const Part& part, std::vector<Place>& found) {
  const Json& json = record.at(place.at);
  if (json.is_array() && !json.empty())
    add_keys(record, {place.at / std::size_t{0}, place.key, place.name + "[0]"}, part, found);
  if (!json.is_object()) return;
  for (const auto& [key, value] : json.items()) {
    found.push_back({place.at / key, key, place.name + "." + key});
    if (!among(part.optional, found.back())) add_keys(record, Place(found.back()), part, found);
  }
}

std::vector<Place> keys_of(const Json& record, const Part& part) {
  std::vector<Place> found;
  const std::string key = part.key;
  add_keys(record, {Json::json_pointer("/main/" + key), key, "main." + key}, part, found);
  return found;
}

class MeasurePart : public ::testing::TestWithParam<Part> {
 protected:
  const Json record_ = written(every_measure());
};

TEST_P(MeasurePart, IsWrittenAsByEveryVersion) {
  if (GetParam().text != nullptr) {
    EXPECT_EQ(to_line(record_["main"][GetParam().key]), GetParam().text);
  }
}

TEST_P(MeasurePart, IsReadBack) {
  const auto read = measures_from(record_);

  ASSERT_TRUE(read) << read.error().message;
  if (GetParam().text == nullptr) return;
  const Json again = written(read_back(*read->main));
  for (const Place& place : keys_of(record_, GetParam())) {
    const Json& value = record_.at(place.at);
    const bool of_records = value.is_object() || (value.is_array() && !value.empty() && value[0].is_object());
    if (!of_records && !among(GetParam().optional, place)) {
      EXPECT_EQ(again.at(place.at), value) << place.name;
    }
  }
}

TEST_P(MeasurePart, NamesAMissingKey) {
  const std::vector<Place> keys = keys_of(record_, GetParam());
  EXPECT_FALSE(keys.empty());
  for (const Place& place : keys) {
    Json cut = record_;
    cut.at(place.at.parent_pointer()).erase(place.key);

    const auto read = measures_from(cut);

    EXPECT_EQ(read.has_value(), among(GetParam().optional, place)) << place.name;
    if (!read) {
      EXPECT_EQ(read.error().message, "missing key '" + place.name + "'");
    }
  }
}

TEST_P(MeasurePart, NamesAKeyWithNull) {
  for (const Place& place : keys_of(record_, GetParam())) {
    Json changed = record_;
    changed.at(place.at) = nullptr;

    const auto read = measures_from(changed);

    EXPECT_EQ(read.has_value(), among(GetParam().optional, place) || among(GetParam().nullable, place)) << place.name;
    if (!read) {
      EXPECT_THAT(read.error().message, StartsWith("'" + place.name + "': expected "));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Record, MeasurePart,
    ::testing::Values(
        Part{"transfer",
             R"({"frames_each":8,"steps":[{"set_delta_t_k":1.0,"said_delta_t_k":1.5,"seen_delta_t_k":1.25,)"
             R"("seen_u_k":0.125},{"set_delta_t_k":2.0,"said_delta_t_k":2.5,"seen_delta_t_k":2.25,)"
             R"("seen_u_k":0.25}],"slope":0.75,"slope_u":0.125,"offset_k":0.5,"chi2":3.0,"degrees_of_freedom":2,)"
             R"("p":0.25,"nonlinearity_percent":0.0})",
             {"frames_each", "slope_u", "chi2", "degrees_of_freedom", "p", "nonlinearity_percent"},
             {}},
        Part{"geometry",
             R"({"plate":"tcat-a","frames":4,"set_delta_t_k":5.0,"distance_m":2.5,"distance_relative_u":0.125,)"
             R"("stated_ifov_mrad":1.25,"picture_px":[320,240],"mm_per_px_x":{"value":2.0,"ci95":[1.75,2.5]},)"
             R"("mm_per_px_y":{"value":3.0,"ci95":[2.75,3.5]},"centre_x_mm":{"value":4.0,"ci95":[3.75,4.5]},)"
             R"("centre_y_mm":{"value":5.0,"ci95":[4.75,5.5]},"rotation_deg":{"value":6.0,"ci95":[5.75,6.5]},)"
             R"("keystone_x_percent":{"value":7.0,"ci95":[6.75,7.5]},"keystone_y_percent":{"value":8.0,"ci95":[)"
             R"(7.75,8.5]},"distortion_percent":{"value":9.0,"ci95":[8.75,9.5]},"residual_px":0.5,)"
             R"("farthest_px":150.0,"corner_px":200.0,"places":[{"triangle":"a1","found_px":[10.5,20.25],)"
             R"("residual_px":[0.125,-0.25]}]})",
             {"frames", "set_delta_t_k", "centre_x_mm", "keystone_x_percent", "keystone_y_percent",
              "distortion_percent", "geometry.residual_px", "farthest_px", "corner_px"},
             {"distance_relative_u"}},
        Part{"drift",
             R"({"groups":2,"frames_each":3,"first_s":0.5,"last_s":9.5,"ended_by_correction":false,"time_s":[0.5,)"
             R"(9.5],"level":{"shape":"linear","change_k":{"value":0.5,"ci95":[0.25,0.75]},"time_constant_s":null,)"
             R"("time_constant_ci95_s":[null,null],"p_linear":0.5,"seen_k":[0.0,0.5],"fitted_k":[0.125,0.375]},)"
             R"("pattern":{"shape":"approach","change_k":{"value":0.5,"ci95":[0.25,0.75]},"time_constant_s":12.5,)"
             R"("time_constant_ci95_s":[10.0,null],"p_linear":0.5,"seen_k":[0.0,0.5],"fitted_k":[0.125,0.375]}})",
             {"groups", "frames_each", "first_s", "last_s", "ended_by_correction"},
             {"time_constant_s"}},
        Part{"response",
             R"({"delta_t_k":4.0,"frame_s":0.02,"settling_ms":500.0,"dropped_steps":1,"bright_pixels":90,)"
             R"("time_constant_ms":{"value":125.0,"ci95":[62.5,250.0],"steps":16},"rise_ms":{"value":500.0,"ci95":[)"
             R"(250.0,750.0],"steps":8},"fall_ms":null,"p_first_order":0.5,"points":[{"time_s":0.02,"left":0.5,)"
             R"("rising":true},{"time_s":0.04,"left":0.25,"rising":false}]})",
             {"delta_t_k", "frame_s", "settling_ms", "dropped_steps", "bright_pixels", "ci95", "steps", "rise_ms",
              "fall_ms", "p_first_order"},
             {}},
        Part{"mtf",
             R"({"plate":"edges","frames":6,"set_delta_t_k":8.0,"said_delta_t_k":8.5,"pitch_mrad":0.5,)"
             R"("stated_at_per_pitch":0.5,"edges":[{"place":"corner","axis":"y","sides":2,"middle_px":[30.5,40.5],)"
             R"("angle_deg":5.0,"noise_over_step":0.125,"frequency_per_pitch":[0.0,0.5,1.0],"frequency_per_mrad":[)"
             R"(0.0,1.0,2.0],"mtf":[1.0,0.5,0.25],"mtf_ci95":[[0.75,1.25],[0.25,0.75],[null,0.5]],)"
             R"("widest_halo_pitch":2.0,"halo_allowance":0.0625,"wide_halo_ci95":[0.25,0.5],"mtf50_per_pitch":0.5,)"
             R"("model":[1.0,0.625,0.375]},{"place":"corner","axis":"y","sides":2,"middle_px":[30.5,40.5],)"
             R"("angle_deg":5.0,"noise_over_step":0.125,"frequency_per_pitch":[0.0,0.5,1.0],"frequency_per_mrad":[)"
             R"(0.0,1.0,2.0],"mtf":[1.0,0.5,0.25],"mtf_ci95":[[0.75,1.25],[0.25,0.75],[null,0.5]],)"
             R"("widest_halo_pitch":2.0,"halo_allowance":0.0625,"wide_halo_ci95":[0.25,0.5],"mtf50_per_pitch":null,)"
             R"("model":null}]})",
             {"plate", "frames", "set_delta_t_k", "said_delta_t_k", "stated_at_per_pitch", "middle_px",
              "frequency_per_mrad", "widest_halo_pitch", "halo_allowance", "wide_halo_ci95"},
             {"mtf50_per_pitch", "model"}},
        Part{"ctf",
             R"({"plate":"bars","frames":7,"set_delta_t_k":3.0,"said_delta_t_k":3.5,"pitch_mrad":0.5,)"
             R"("stated_near_per_pitch":0.25,"contrast_k":2.5,"far_spread":0.125,"groups":[{"group":"g1",)"
             R"("axis":"x","frequency_per_pitch":0.25,"frequency_per_mrad":0.5,"angle_deg":4.0,"middle_px":[50.5,)"
             R"(60.5],"pixels":99,"noise_over_contrast":0.125,"best":{"value":0.75,"ci95":[0.5,1.25]},)"
             R"("mean":{"value":0.5,"ci95":[0.25,1.0]},"worst":{"value":0.25,"ci95":[0.0,0.75]},)"
             R"("bars_separated_at_best":4,"share_of_four":0.875,"model":{"best":0.75,"mean":0.625,"worst":0.5}},)"
             R"({"group":"g1","axis":"x","frequency_per_pitch":0.25,"frequency_per_mrad":0.5,"angle_deg":4.0,)"
             R"("middle_px":[50.5,60.5],"pixels":99,"noise_over_contrast":0.125,"best":{"value":0.75,"ci95":[0.5,)"
             R"(1.25]},"mean":{"value":0.5,"ci95":[0.25,1.0]},"worst":{"value":0.25,"ci95":[0.0,0.75]},)"
             R"("bars_separated_at_best":4,"share_of_four":0.875,"model":null}]})",
             {"plate", "frames", "set_delta_t_k", "said_delta_t_k", "stated_near_per_pitch", "contrast_k", "far_spread",
              "frequency_per_mrad", "middle_px"},
             {"model"}},
        Part{"source_size",
             R"({"plate":"source","frames":9,"set_delta_t_k":20.0,"said_delta_t_k":20.5,"stated_px":6.0,)"
             R"("reference_px":64.0,"reference_k":19.5,"reference_u_k":0.25,"chi2":1.5,"degrees_of_freedom":2,)"
             R"("consistent":true,"points":[{"place":"hole","method":"direct","size_px":6.0,"ratio":{"value":0.75,)"
             R"("ci95":[0.5,1.25]},"fitted":0.875},{"place":"ring","method":"inverse","size_px":8.0,)"
             R"("ratio":{"value":0.25,"ci95":[0.0,0.75]},"fitted":0.125}],"curve":[{"size_px":4.0,)"
             R"("ratio":{"value":0.5,"ci95":[0.25,1.0]}},{"size_px":64.0,"ratio":{"value":1.0,"ci95":[0.75,1.5]}}]})",
             {"plate", "frames", "set_delta_t_k", "said_delta_t_k", "reference_k", "reference_u_k", "chi2",
              "degrees_of_freedom", "consistent"},
             {}},
        Part{"absolute",
             R"({"plate":"black body","frames":12,"levels":[{"set_k":290.0,"said_k":290.5,"expected_k":290.25,)"
             R"("seen_k":291.0,"difference_k":0.125,"camera_c":25.5,"pattern_k":{"value":0.5,"ci95":[0.25,1.0]},)"
             R"("saturated":false},{"set_k":300.0,"said_k":300.5,"expected_k":300.25,"seen_k":301.0,)"
             R"("difference_k":0.0,"camera_c":null,"pattern_k":null,"saturated":true}],"repeatability_k":0.125,)"
             R"("u_k":0.25,"degrees_of_freedom":5,"source_u_k":0.0625,"nonlinearity_percent":0.5,)"
             R"("undetermined_slope_k":0.75})",
             {"frames", "repeatability_k", "nonlinearity_percent", "undetermined_slope_k", "difference_k", "camera_c",
              "pattern_k"},
             {}},
        Part{"latency",
             R"({"speed_mm_s":12.5,"runs_ms":[3.0,4.0],"frames_ms":[2.5,3.5,4.5],"latency_ms":{"value":3.5,"ci95":[)"
             R"(3.25,4.0]}})",
             {"speed_mm_s", "runs_ms", "frames_ms"},
             {}},
        Part{"mrtd",
             R"({"plate":"mrtd","observer":"hvs-2","frames":5,"set_ups":3,"mountings":2,"pitch_mrad":0.5,)"
             R"("stated_near_per_pitch":0.25,"stated_spot_px":3.0,"bars":[{"place":"bars-1","axis":"y",)"
             R"("frequency_per_pitch":0.25,"frequency_per_mrad":0.5,"size_px":0.0,"positive_k":0.5,)"
             R"("negative_k":-0.75,"threshold_k":0.625,"ci95_k":[0.5,0.75],"best_phase_k":0.375,)"
             R"("best_phase_ci95_k":[0.25,null],"best_phase_px":0.125,"reason":null,"proportion_correct":[)"
             R"({"delta_t_k":0.25,"positive":0.5,"negative":0.25},{"delta_t_k":0.5,"positive":1.0,)"
             R"("negative":0.75}],"threshold_spread_k":[0.25,1.5]}],"spots":[{"place":"spot","axis":"x",)"
             R"("frequency_per_pitch":0.0,"frequency_per_mrad":0.0,"size_px":3.0,"positive_k":null,)"
             R"("negative_k":null,"threshold_k":null,"ci95_k":[null,null],"best_phase_k":null,"best_phase_ci95_k":[)"
             R"(null,null],"best_phase_px":0.0,"reason":"no decision","proportion_correct":[]}]})",
             {"stated_near_per_pitch", "stated_spot_px", "frequency_per_mrad", "proportion_correct",
              "threshold_spread_k"},
             {"positive_k", "negative_k", "threshold_k", "best_phase_k", "reason"}},
        Part{"gain_control",
             R"({"unit":"count","frames":10,"levels":[{"set_delta_t_k":1.0,"said_delta_t_k":1.5,"surround":100.0,)"
             R"("lowest":90.0,"highest":200.0,"contrast":8.0,"contrast_u":0.5,"triangles":0},)"
             R"({"set_delta_t_k":10.0,)"
             R"("said_delta_t_k":10.5,"surround":101.0,"lowest":80.0,"highest":300.0,"contrast":60.0,)"
             R"("contrast_u":0.25,"triangles":0}],"settling":{"delta_t_k":4.0,"change":3.5,"time_constant_ms":125.0,)"
             R"("p_first_order":0.5,"points":[{"time_s":0.02,"left":0.5,"rising":true},{"time_s":0.04,"left":0.25,)"
             R"("rising":false}]}})",
             {"frames", "change", "p_first_order", "triangles"},
             {"settling"}},
        Part{"quantities", nullptr, {"definition"}, {"value"}}, Part{"picture", nullptr, {}, {}},
        Part{"maps", nullptr, {}, {}}),
    [](const auto& instance) { return std::string(instance.param.key); });

TEST(MeasuresRecord, IsNotWrittenWithANumberThatTheReaderNeedsAndThatIsNotFinite) {
  CameraMeasures measures = every_measure();
  measures.transfer->line.p = std::numeric_limits<double>::infinity();
  measures.transfer->line.nonlinearity_percent = std::numeric_limits<double>::quiet_NaN();
  const auto good = measures_record(measures, std::nullopt);
  ASSERT_TRUE(good) << good.error().message;
  EXPECT_EQ((*good)["main"]["transfer"]["p"], nullptr);
  EXPECT_TRUE(measures_from(*good));
  EXPECT_EQ(*good, written(measures));

  measures.absolute->levels.front().seen_k = std::numeric_limits<double>::quiet_NaN();
  const auto bad = measures_record(measures, std::nullopt);
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().code, ErrorCode::internal);
  EXPECT_THAT(bad.error().message, StartsWith("'main.absolute.levels[0].seen_k': expected a finite number"));
  EXPECT_EQ(written(measures)["main"]["absolute"]["levels"][0]["seen_k"], nullptr);
}

TEST(MeasuresRecord, OfEarlierVersionsIsRead) {
  Json record = written(every_measure());
  Json& main = record["main"];
  main["geometry"] = {{"picture_px", {320, 240}}, {"places", Json::array()}};  // without a line of sight
  main["latency"] = Json::object();                                            // without frames
  for (const char* key : {"mtf", "ctf", "source_size", "absolute", "mrtd", "gain_control", "maps", "picture"})
    main.erase(key);

  const auto read = measures_from(record);

  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->main->geometry->picture, cv::Size(320, 240));
  EXPECT_TRUE(read->main->latency->frames_ms.empty());
  EXPECT_FALSE(read->main->mrtd || read->main->picture);
  EXPECT_TRUE(read->main->maps.empty());
}

}  // namespace
}  // namespace todbench
