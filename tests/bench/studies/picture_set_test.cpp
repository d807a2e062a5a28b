// SPDX-License-Identifier: GPL-3.0-or-later
// Sets of targets that are cut from radiometric pictures: contrast by hand, refusals, and the shipped polygons again.
#include "bench/studies/pictured_scenes.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <utility>

#include "acquisition/base/normal.h"
#include "acquisition/recording/tiff_writer.h"
#include "bench/plan/descriptions.h"
#include "bench/studies/identification_study.h"
#include "bench/studies/person_experiment.h"
#include "sim_devices/sensor/scene_image.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

constexpr double kelvin_per_count = 0.005;

void write_counts(const std::filesystem::path& file, const std::vector<cv::Mat1w>& pages) {
  auto writer = TiffWriter::create(file).value();
  for (const cv::Mat1w& page : pages) ASSERT_TRUE(writer.append(page));
}

void write_kelvin(const std::filesystem::path& file, const std::vector<cv::Mat1d>& pages) {
  std::vector<cv::Mat1w> counts(pages.size());
  for (std::size_t i = 0; i < pages.size(); ++i) pages[i].convertTo(counts[i], CV_16U, 1 / kelvin_per_count);
  write_counts(file, counts);
}

/// A block of 8 x 6 pixels, its left half 4 K above a background of 290 K and its right half 2 K below it.
cv::Mat1d two_levels() {
  cv::Mat1d kelvin(40, 60, 290.0);
  kelvin(cv::Rect(20, 15, 4, 6)) = 294.0;
  kelvin(cv::Rect(24, 15, 4, 6)) = 288.0;
  return kelvin;
}

TEST(PictureSets, HaveTheContrastThatFollowsByHand) {
  cv::Mat1d kelvin = two_levels();
  kelvin.row(0) = 320.0;                   // of other things: outside the region
  kelvin(cv::Rect(19, 14, 10, 1)) += 1.0;  // blur beside the target: not of the background
  const auto cut = cut_target(kelvin, {.region = {5, 5, 50, 30}, .above_k = 292.0, .below_k = 289.0});
  ASSERT_TRUE(cut) << cut.error().message;
  EXPECT_EQ(cut->target_px, cv::Size(8, 6));
  EXPECT_EQ(cut->background_k, 290);
  EXPECT_EQ(cut->background_sd_k, 0.0);

  FieldScene scene;
  scene.background_k = scene.surround_k = cut->background_k;
  scene.picture = cut->picture;
  scene.picture->element_m = 0.25;
  const RadianceScale scale{{8, 12}, 290};
  const auto signature = target_signature(scene, scale);
  const auto level = [&](double k) {
    return (band_radiance(scale.band, k) - band_radiance(scale.band, 290)) / band_radiance_derivative(scale.band, 290);
  };
  const double mean = (level(294) + level(288)) / 2, sd = (level(294) - level(288)) / 2;
  EXPECT_NEAR(signature->dt_rss_k(), std::hypot(mean, sd), 1e-9);
  EXPECT_NEAR(signature->size_m(), std::sqrt(48) * 0.25, 1e-12);
}

TEST(PictureSets, RefuseWhatIsNoTarget) {
  const cv::Mat1d kelvin = two_levels();
  const auto refusal = [&](const cv::Mat1d& picture, const PictureCut& cut) {
    const auto found = cut_target(picture, cut);
    return found ? std::string("accepted") : found.error().message;
  };
  EXPECT_THAT(refusal(kelvin, {.above_k = 300.0}), HasSubstr("no pixel"));
  EXPECT_THAT(refusal(kelvin, {.region = {20, 5, 30, 30}, .above_k = 292.0}), HasSubstr("touches the edge"));
  EXPECT_THAT(refusal(kelvin, {.above_k = 280.0}), HasSubstr("touches the edge"));
  EXPECT_THAT(refusal(kelvin, {.region = {40, 5, 30, 30}, .above_k = 292.0}), HasSubstr("outside the picture"));
  EXPECT_THAT(refusal(kelvin, {.mask = cv::Mat1b(40, 59, uchar{0})}), HasSubstr("59 x 40 pixels and the picture 60"));
  EXPECT_THAT(refusal(kelvin, {.region = {18, 13, 8, 10}, .above_k = 292.0}), HasSubstr("background_k"));
  EXPECT_EQ(refusal(kelvin, {.region = {18, 13, 8, 10}, .above_k = 292.0, .background_k = 290}), "accepted");
  cv::Mat1d holes = kelvin.clone();
  holes(20, 30) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal(holes, {.above_k = 292.0}), HasSubstr("no temperature"));
  EXPECT_EQ(refusal(holes, {.region = {10, 5, 20, 30}, .above_k = 292.0}), "accepted") << "outside the region";
  EXPECT_THAT(refusal(cv::Mat1d(400, 400, 300.0), {.region = {10, 10, 300, 300}, .above_k = 290.0}),
              HasSubstr("at most 40000"));
}

TEST(PictureSets, AreReadFromFilesWithOneSentenceForEveryMistake) {
  const TemporaryFolder folder;
  write_kelvin(folder.path() / "a.tiff", {two_levels(), two_levels() + 0.2});
  write_counts(folder.path() / "mask.tiff", {cv::Mat1w(two_levels() != 290)});
  const std::string scaled = "file = \"a.tiff?kelvin_per_count=0.005\"\n";
  const auto set_of = [&](const std::string& second) {
    folder.write("set.toml", "name = \"s\"\n[[target]]\nname = \"first\"\n[[target.view]]\n" + scaled +
                                 "mask = \"mask.tiff\"\nwidth_m = 4\n[[target]]\nname = \"second\"\n" + second);
    return target_set_with_pictures((folder.path() / "set.toml").string());
  };
  const std::string fine = scaled + "above_k = 293\nbelow_k = 289\nifov_mrad = 0.5\ndistance_m = 200\nframes = 2\n";

  const auto set = set_of("[[target.view]]\n" + fine);
  ASSERT_TRUE(set) << set.error().message;
  EXPECT_EQ(element_range_m(*set), std::pair(0.1, 0.5));
  const FieldScene& second = set->targets[1].aspects[0];
  EXPECT_NEAR(second.background_k, 290.1, 1e-9) << "mean of two pictures";
  EXPECT_EQ(cv::countNonZero(second.picture->target), 48);
  EXPECT_THAT(set->notes, ElementsAre());

  const auto mistake = [&](const std::string& text) {
    const auto found = set_of(text);
    return found ? std::string("accepted") : found.error().message;
  };
  EXPECT_THAT(mistake("[[target.view]]\nfile = \"a.tiff\"\nabove_k = 293\npixel_m = 1\n"),
              HasSubstr("counts without temperatures"));
  EXPECT_THAT(mistake("[[target.view]]\n" + fine + "pixel_m = 1\n"), HasSubstr("expected one of pixel_m"));
  EXPECT_THAT(mistake("[[target.view]]\n" + fine + "mask = \"mask.tiff\"\n"), HasSubstr("either a mask"));
  EXPECT_THAT(mistake("[[target.view]]\n" + fine + "[[target.view]]\n" + fine), HasSubstr("as many views"));
  EXPECT_THAT(mistake("[[target.view]]\n" + scaled + "frames = 3\nabove_k = 293\npixel_m = 1\n"), HasSubstr("a.tiff"));
  EXPECT_THAT(mistake(""), HasSubstr("1 to 16 views"));
  EXPECT_THAT(mistake("[[target.view]]\n" + fine + "region = [1, 2, 3]\n"), HasSubstr("x, y, width and height"));
  ASSERT_TRUE(set_of("[[target.view]]\n" + fine));
  EXPECT_THAT(load_target_set((folder.path() / "set.toml").string()).error().message, HasSubstr("not possible here"));
}

TEST(PictureSets, RefuseFramesWhoseBytesAreSwapped) {
  const TemporaryFolder folder;
  cv::Mat1w counts;
  cv::Mat1d(two_levels() - 250.0).convertTo(counts, CV_16U, 1 / kelvin_per_count);
  for (std::uint16_t& pixel : counts) pixel = static_cast<std::uint16_t>(pixel << 8 | pixel >> 8);
  write_counts(folder.path() / "swapped.tiff", {counts});
  std::string text = "name = \"s\"\n";
  for (const char* name : {"first", "second"})
    text += "[[target]]\nname = \"" + std::string(name) +
            "\"\n[[target.view]]\nfile = \"swapped.tiff?kelvin_per_count=0.005&offset_k=250\"\n"
            "above_k = 340\npixel_m = 0.1\n";
  folder.write("set.toml", text);

  const auto set = target_set_with_pictures((folder.path() / "set.toml").string());

  ASSERT_FALSE(set);
  EXPECT_EQ(set.error().code, ErrorCode::invalid_input) << "a mistake of the file of the set";
  EXPECT_THAT(set.error().message, HasSubstr("1 of 1 frames have the two bytes of their pixels swapped"));
}

/// Three craft from the side, and the same as pictures of 0.05 m a pixel in files.
struct BothSets {
  TargetSet polygons, pictures;
};

BothSets three_craft(const TemporaryFolder& folder, const RadianceScale& scale) {
  BothSets sets{load_target_set("small-craft").value(), {}};
  sets.polygons.targets.resize(3);
  sets.polygons.azimuths_deg = {90};
  constexpr double element_m = 0.05;
  std::string toml = "name = \"pictures\"\n";
  for (auto& target : sets.polygons.targets) {
    target.aspects.resize(1);
    const FieldScene& scene = target.aspects.front();
    const cv::Size size(2 * static_cast<int>(extent_m(scene).width / element_m / 2) + 24,
                        2 * static_cast<int>(extent_m(scene).height / element_m / 2) + 24);
    const auto means = [&](const std::vector<PaintedPolygon>& painted) {
      return SceneImager::means(
          placed(visible_edges(painted), 1 / element_m, 0, {(size.width - 1) / 2.0, (size.height - 1) / 2.0}), size);
    };
    auto painted = levels_k(scene, scale);
    cv::Mat1d kelvin = means(painted);
    std::map<long, double> kelvin_of;  // by millikelvin: the inversion takes long
    for (double& k : kelvin) {
      const auto [at, is_new] = kelvin_of.try_emplace(std::lround(1000 * k));
      if (is_new)
        at->second =
            *radiation_temperature_k(scale.band, background_radiance(scene, scale.band) +
                                                     k * band_radiance_derivative(scale.band, scale.calibration_k));
      k = at->second;
    }
    for (auto& region : painted) region.level = 1;
    write_kelvin(folder.path() / (target.name + ".tiff"), {kelvin});
    write_counts(folder.path() / (target.name + "-mask.tiff"), {cv::Mat1w(means(painted) > 0.5)});
    toml += "[[target]]\nname = \"" + target.name + "\"\n[[target.view]]\nfile = \"" + target.name +
            ".tiff?kelvin_per_count=0.005\"\nmask = \"" + target.name + "-mask.tiff\"\npixel_m = 0.05\n";
  }
  sets.pictures = target_set_with_pictures(folder.write("set.toml", toml).string()).value();
  return sets;
}

IdentificationStudyTask study_of(TargetSet set) {
  IdentificationStudyTask task;
  task.set = std::move(set);
  task.sensor = load_sensor("sc2000").value();
  task.accuracy = Accuracy::draft();
  task.ranges_m = {1000, 1700, 2900};
  task.decisions = 96;
  task.seed = 3;
  return task;
}

TEST(PictureSets, OfRenderedPolygonsAreIdentifiedAsThePolygonsAre) {
  const TemporaryFolder folder;
  const SensorSpec sensor = load_sensor("sc2000").value();
  const RadianceScale scale{{sensor.wavelength_min_um, sensor.wavelength_max_um}, sensor.scene_temperature_k};
  const BothSets sets = three_craft(folder, scale);
  for (std::size_t t = 0; t < 3; ++t) {
    const auto a = target_signature(sets.polygons.targets[t].aspects[0], scale);
    const auto b = target_signature(sets.pictures.targets[t].aspects[0], scale);
    EXPECT_NEAR(b->size_m() / a->size_m(), 1, 0.02) << sets.polygons.targets[t].name;
    // Pixels at an outline mix both sides: the contrast is less.
    EXPECT_NEAR(b->dt_rss_k() / a->dt_rss_k(), 0.98, 0.02) << sets.polygons.targets[t].name;
  }

  const auto polygons = study_identification(study_of(sets.polygons));
  const auto pictures = study_identification(study_of(sets.pictures));

  ASSERT_TRUE(polygons && pictures) << (polygons ? pictures.error().message : polygons.error().message);
  for (std::size_t r = 0; r < 3; ++r) {
    const IdentificationPoint &a = polygons->points[r], &b = pictures->points[r];
    // Both have the same draws of noise.
    EXPECT_NEAR(b.proportion(), a.proportion(), 1.96 * a.standard_error() + 1e-9) << a.range_m;
  }
  EXPECT_NEAR(*pictures->r75_m.value / *polygons->r75_m.value, 1, 0.02);
  EXPECT_THAT(pictures->notes, ::testing::Contains(HasSubstr("pixels of 0.05 to 0.05 m")));
  EXPECT_THAT(polygons->notes, ::testing::Not(::testing::Contains(HasSubstr("pixels of"))));

  // A person sees the same shapes.
  const auto shown = PersonExperiment::of_set(study_of(sets.pictures), 1);
  const auto drawn = PersonExperiment::of_set(study_of(sets.polygons), 1);
  ASSERT_TRUE(shown && drawn);
  for (std::size_t t = 0; t < 3; ++t)
    EXPECT_LT(
        cv::norm(shown->icons()[t], drawn->icons()[t], cv::NORM_L1) / static_cast<double>(shown->icons()[t].total()),
        0.05);
}

// Proportions that fall with ln range as a normal distribution or as a Weibull function; 75 % at 1300 m.
TEST(Crossing75, AllowsForItsInterpolationWhereRangesAreFarApart) {
  const auto normal = [](double range_m) { return normal_probability(0.67449 - std::log(range_m / 1300) / 0.5); };
  const auto weibull = [](double range_m) { return std::exp(std::log(0.75) * std::pow(range_m / 1300, 2)); };
  for (const std::function<double(double)>& share : {std::function<double(double)>(normal), {weibull}}) {
    const auto found = [&](const std::vector<double>& ranges_m) {
      std::vector<double> proportions;
      for (const double range_m : ranges_m) proportions.push_back(share(range_m));
      const Crossing75 crossing = crossing_of_75_percent(ranges_m, proportions);
      return std::pair(crossing, with_interval(crossing, std::vector(40, crossing)));
    };
    for (const double first_m : {400.0, 500.0, 600.0}) {
      const auto [far, of_far] = found({first_m, 2 * first_m, 4 * first_m});
      const double off = std::abs(std::log(*far.at / 1300));
      EXPECT_LE(off, far.interpolation_ln) << first_m;
      EXPECT_NEAR(std::log(*of_far.ci95.high / *far.at), far.interpolation_ln, 1e-12) << first_m;
    }
    const auto [near, of_near] = found({1200, 1250, 1350, 1400});
    EXPECT_LT(near.interpolation_ln, 0.003);
    EXPECT_NEAR(*near.at, 1300, 2);
  }
}

}  // namespace
}  // namespace todbench
