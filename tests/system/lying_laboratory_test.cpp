// SPDX-License-Identifier: GPL-3.0-or-later
// Stages, black bodies and cameras that are not as they say, or change in mid-run: `todbench measure` in an emulated
// laboratory says which, and gives no verdict.
#include <deque>

#include "acquisition/base/rng.h"
#include "bench/devices/emulation.h"
#include "bench/plan/descriptions.h"
#include "sim_devices/lab/gvsp_laboratory.h"
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;

/// A laboratory with one fault, and how a run in it ends.
struct Lie {
  std::string name;
  std::function<void(LaboratoryOptions&)> make;
  int code = 0;
  std::vector<std::string> said{};  ///< kinds of findings for code 3; parts of the last sentence for others
  std::string settings{};           ///< [camera.settings]
  /// One presentation of one contrast in each set-up: too few answers for a threshold, so code 3 in any case.
  bool one_look = false;
};

std::ostream& operator<<(std::ostream& out, const Lie& lie) {
  return out << lie.name;
}

std::string name_of_lie(const ::testing::TestParamInfo<Lie>& info) {
  return info.param.name;
}

/// Two set-ups of two contrasts, as few frames as show the correlation of successive ones.
std::string plan_in(const Laboratory& laboratory, const Lie& lie) {
  return "name = \"lies\"\n[camera]\nid = \"gige:127.0.0.1\"\nifov_mrad = 1.3085399449\nreconnect_s = 1\n" +
         (lie.settings.empty() ? "" : "[camera.settings]\n" + lie.settings) +
         "[simulation]\naccuracy = \"draft\"\nphases = 2\n[fit]\nestimator = \"weibull\"\n"
         "[measurement]\nregistration_frames = 8\ncontrast_frames = 8\nframe_timeout_ms = 20000\n"
         "max_rejected_share = 0.9\n[target]\nkind = \"scpi\"\nblack_body = \"" +
         laboratory.black_body_endpoint() + "\"\nstage = \"" + laboratory.stage_endpoint() +
         "\"\ndistance_m = 2\nplates = [\"tcat-a\"]\nmountings = [\"identity\", \"rotated_180\"]\n" +
         (lie.one_look ? "delta_t_k = [16.9]\nphases = 1\n" : "delta_t_k = [16.9, 1.93]\nphases = 6\n");
}

/// Kinds of the findings of all points that are not those of a fit.
std::set<std::string> findings_of(const Ended& ended) {
  const std::set<std::string> of_bench{"contrast_deviation", "transfer_change", "noise_change",
                                       "correlation_change", "picture_residue", "setting_change"};
  std::set<std::string> kinds;
  const Json run = one_object(ended);
  for (const Json& point : run["points"]) {
    for (const Json& finding : point["adequacy"]["findings"])
      if (of_bench.contains(finding["kind"].get<std::string>())) kinds.insert(finding["kind"]);
  }
  return kinds;
}

std::unique_ptr<Laboratory> laboratory_with(const std::function<void(LaboratoryOptions&)>& make) {
  auto options = laboratory_options({.plates = {"tcat-a"}, .black_body_port = 0, .stage_port = 0});
  if (!options) {
    ADD_FAILURE() << options.error().message;
    return nullptr;
  }
  if (make) make(*options);
  auto started = Laboratory::start(*std::move(options));
  if (!started) ADD_FAILURE() << started.error().message;
  return started ? *std::move(started) : nullptr;
}

class LyingLaboratory : public ::testing::TestWithParam<Lie> {};

TEST_P(LyingLaboratory, GivesNoVerdict) {
  const Lie& lie = GetParam();
  const auto laboratory = laboratory_with(lie.make);
  ASSERT_TRUE(laboratory);
  const TemporaryFolder folder;
  folder.write("plan.toml", plan_in(*laboratory, lie));

  const Ended ended = todbench({"measure", "./plan.toml", "--out", "m", "--json"}, {.folder = folder.path()});

  ASSERT_EQ(ended.code, lie.code) << ended.err << ended.out;
  if (lie.code == 0 || lie.code == 3) {
    const std::set<std::string> found = findings_of(ended);
    for (const std::string& kind : lie.said) EXPECT_TRUE(found.contains(kind)) << kind << "\n" << ended.err;
    if (lie.said.empty()) {
      EXPECT_THAT(found, ::testing::IsEmpty()) << ended.err;
    }
    return;
  }
  for (const std::string& part : lie.said) EXPECT_THAT(lines_of(ended.err).back(), HasSubstr(part));
}

std::function<void(LaboratoryOptions&)> stage(std::function<cv::Point2d(cv::Point2d)> real_place_mm) {
  return [=](LaboratoryOptions& options) { options.stage.real_place_mm = real_place_mm; };
}

INSTANTIATE_TEST_SUITE_P(Stage, LyingLaboratory,
                         ::testing::Values(Lie{"right", {}, 0},
                                           Lie{"with_a_wrong_sign",
                                               stage([](cv::Point2d p) { return cv::Point2d(-p.x, p.y); }),
                                               6,
                                               {"moves along x with the wrong sign"}},
                                           Lie{"with_exchanged_axes",
                                               stage([](cv::Point2d p) { return cv::Point2d(p.y, p.x); }),
                                               6,
                                               {"the axes of the stage are exchanged"}},
                                           Lie{"that_never_moves",
                                               stage([](cv::Point2d) { return cv::Point2d(0, 0); }),
                                               6,
                                               {"the stage does not move"}},
                                           Lie{"with_a_wrong_scale",
                                               stage([](cv::Point2d p) { return 0.4 * p; }),
                                               6,
                                               {"times the requested shift along x"}}),
                         name_of_lie);

TEST(StageCheck, TellsSignAxesAndScaleFromThePictures) {
  for (const auto& [real_place_mm, cause] :
       std::vector<std::pair<std::function<cv::Point2d(cv::Point2d)>, std::string>>{
           {{}, ""},
           {[](cv::Point2d p) { return cv::Point2d(p.x, -p.y); }, "moves along y with the wrong sign"},
           {[](cv::Point2d p) { return cv::Point2d(p.y, p.x); }, "axes of the stage are exchanged"},
           {[](cv::Point2d p) { return 0.8 * p; }, "times the requested shift along x"}}) {
    const auto laboratory = laboratory_with(stage(real_place_mm));
    ASSERT_TRUE(laboratory);
    const TemporaryFolder folder;
    folder.write("plan.toml", plan_in(*laboratory, {}));
    const std::vector<std::string> check{"instrument", "check",       "scpi-stage", laboratory->stage_endpoint(),
                                         "--camera",   "./plan.toml", "--json"};

    const Ended ended = todbench(check, {.folder = folder.path()});

    EXPECT_EQ(ended.code, cause.empty() ? 0 : 5) << ended.err;
    const Json movement = one_object(ended)["movement"];
    if (cause.empty()) {
      EXPECT_EQ(movement["cause"], Json());
      EXPECT_NEAR(movement["seen_per_asked"][0][0], 1, 0.02) << movement;
      EXPECT_NEAR(movement["seen_per_asked"][1][0], 0, 0.02) << "the plate is turned by 0.4 degrees";
    } else {
      EXPECT_THAT(movement["cause"].get<std::string>(), HasSubstr(cause));
    }
  }
}

std::function<void(LaboratoryOptions&)> black_body(double factor) {
  return [=](LaboratoryOptions& options) {
    options.black_body.real_delta_t_k = [=](double indicated_k) { return factor * indicated_k; };
  };
}

INSTANTIATE_TEST_SUITE_P(
    BlackBody, LyingLaboratory,
    ::testing::Values(Lie{"of_1_15_times_what_it_says", black_body(1.15), 3, {"contrast_deviation"}},
                      Lie{"of_1_4_times_what_it_says", black_body(1.4), 6, {"K, but", "were set"}}),
    name_of_lie);

/// Whether the plate hangs as in one of the two set-ups: a camera that changes with it changes in mid-run.
bool is_turned(const PlateScene& scene) {
  const auto& first = scene.plate.triangles.front().position_mm;
  static const cv::Point2d upright = load_plate("tcat-a")->triangles.front().position_mm;
  return cv::norm(first - upright) > 1e-6;
}

using SentCounts = std::function<cv::Mat1w(cv::Mat1w counts, const PlateScene& scene)>;

std::function<void(LaboratoryOptions&)> camera(SentCounts sent) {
  return [=](LaboratoryOptions& options) { options.sent_counts = sent; };
}

cv::Mat1w in_counts(const cv::Mat1d& counts) {
  cv::Mat1w out;
  counts.convertTo(out, CV_16U);
  return out;
}

cv::Mat1d as_numbers(const cv::Mat1w& counts) {
  cv::Mat1d out;
  counts.convertTo(out, CV_64F);
  return out;
}

cv::Mat1w times(const cv::Mat1w& counts, double gain) {
  constexpr double scene_counts = 4500;
  return in_counts((as_numbers(counts) - scene_counts) * gain + scene_counts);
}

cv::Mat1w with_gain(cv::Mat1w counts, const PlateScene& scene) {
  return is_turned(scene) ? times(counts, 1.1) : counts;
}

/// 1.15 times the contrast from the first movement of the stage on that follows a change of contrast or mounting: the
/// contrast is measured before it, the answers are given after it.
SentCounts with_more_contrast_in_presentations() {
  return [delta_t_k = 0.0, turned = false, place = cv::Point2d(), moved = false](cv::Mat1w counts,
                                                                                 const PlateScene& scene) mutable {
    if (std::abs(scene.delta_t_k - delta_t_k) > 0.1 || is_turned(scene) != turned) {
      moved = false;
    } else {
      moved = moved || scene.shift_mm != place;
    }
    delta_t_k = scene.delta_t_k, turned = is_turned(scene), place = scene.shift_mm;
    return moved ? times(counts, 1.15) : counts;
  };
}

/// 0.8 K, where the sensor has 0.07.
SentCounts with_noise() {
  return [draw = std::uint64_t{0}](cv::Mat1w counts, const PlateScene& scene) mutable {
    if (!is_turned(scene)) return counts;
    cv::Mat1f noise(counts.size());
    RandomStream(1, "more noise").sub(draw++).fill_normal({noise.ptr<float>(), noise.total()});
    return in_counts(as_numbers(counts) + cv::Mat1d(80 * noise));
  };
}

SentCounts with_filter() {
  return [state = cv::Mat1d()](cv::Mat1w counts, const PlateScene& scene) mutable {
    const cv::Mat1d now = as_numbers(counts);
    state = is_turned(scene) && !state.empty() ? cv::Mat1d(0.5 * state + 0.5 * now) : now;
    return in_counts(state);
  };
}

/// 100 ms at 50 Hz.
SentCounts with_latency() {
  return [on_the_way = std::deque<cv::Mat1w>()](cv::Mat1w counts, const PlateScene&) mutable {
    constexpr std::size_t late = 5;
    on_the_way.push_back(counts);
    if (on_the_way.size() > late + 1) on_the_way.pop_front();
    return on_the_way.front().clone();
  };
}

/// By two pixels, from the fourth place on at which the plate came to rest.
SentCounts knocked() {
  return [last = cv::Point2d(), exposures = 0, rested = 0](cv::Mat1w counts, const PlateScene& scene) mutable {
    exposures = scene.shift_mm == last ? exposures + 1 : 0;
    last = scene.shift_mm;
    if (exposures == 1) ++rested;
    if (rested < 4) return counts;
    cv::Mat1w moved = counts.clone();
    counts.colRange(0, counts.cols - 2).copyTo(moved.colRange(2, counts.cols));
    return moved;
  };
}

/// An Ax5 that stays in the range of power-up.
void deaf(LaboratoryOptions& options) {
  options.sensor = with_counts_of(CameraModel::ax5, options.sensor);
  GvspCameraConfig config;
  config.deaf_feature = "SensorGainMode";
  options.connect = connect_gvsp(config);
}

TEST(Recording, OfACameraThatKeepsItsRangeIsRefused) {
  const auto laboratory = laboratory_with(deaf);
  ASSERT_TRUE(laboratory);
  const TemporaryFolder folder;

  const Ended ended = todbench({"record", "gige:127.0.0.1", "--set", "SensorGainMode=LowGainMode", "--frames", "3"},
                               {.folder = folder.path()});

  expect_refused(ended, 6, "SensorGainMode was set to LowGainMode and reads back as HighGainMode");
}

INSTANTIATE_TEST_SUITE_P(
    Camera, LyingLaboratory,
    ::testing::Values(
        Lie{"that_was_knocked", camera(knocked()), 6, {"the picture moved by (+2.0"}},
        Lie{"of_another_gain", camera(with_gain), 3, {"transfer_change"}},
        Lie{"with_more_contrast_in_presentations",
            camera(with_more_contrast_in_presentations()),
            3,
            {"transfer_change"}},
        Lie{"with_more_noise", camera(with_noise()), 3, {"noise_change"}},
        Lie{"with_a_filter_over_frames", camera(with_filter()), 3, {"noise_change", "correlation_change"}},
        Lie{"whose_pictures_come_late",
            camera(with_latency()),
            6,
            // A busy host changes by how many frames they are late, and with it the cause that is named: the place of
            // the plate, or the contrast of the step before.
            {"ended early: "}},
        Lie{"whose_pictures_come_late_in_one_look", camera(with_latency()), 3, {"picture_residue"}, "", true},
        Lie{"right_in_one_look", {}, 3, {}, "", true},
        Lie{"whose_kelvin_are_ten", [](LaboratoryOptions& o) { o.stated_scale = 10; }, 6, {"were set"}},
        Lie{"that_keeps_its_range",
            deaf,
            6,
            {"SensorGainMode was set to LowGainMode"},
            "SensorGainMode = \"LowGainMode\"\n"}),
    name_of_lie);

}  // namespace
}  // namespace todbench::testing
