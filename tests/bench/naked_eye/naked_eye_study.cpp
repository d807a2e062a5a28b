// SPDX-License-Identifier: GPL-3.0-or-later
// Fits of simulated people: two naked-eye sessions each, plain and in white noise, and how often the intervals of the
// three open parameters hold those of the person. TODBENCH_STUDY_RUNS: people (100 without it). TODBENCH_STUDY_FOLDER:
// where they are kept; who is there is not made again.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <set>

#include "tests/bench/naked_eye/simulated_person.h"

namespace todbench::testing {
namespace {

struct KnownPerson {
  double gain, contrast_noise, sensor_noise_factor;
};

/// Within the open ranges: sensitivity +-4 dB, contrast noise 0.01 to 0.07, sensor-noise factor 1.1 to 3.2.
KnownPerson person_of(std::uint64_t seed) {
  const RandomStream numbers(seed, "test.naked-eye.people");
  return {std::pow(10, (8 * numbers.uniform(0) - 4) / 20), 0.01 + 0.06 * numbers.uniform(1),
          1.1 * std::pow(3.2 / 1.1, numbers.uniform(2))};
}

/// "seed,parameter,truth,value,low,high"; an open side is empty.
std::vector<std::string> rows_of(std::uint64_t seed) {
  const KnownPerson known = person_of(seed);
  const TemporaryFolder folder;
  std::vector<AnsweredSession> sessions;
  for (const double noise : {0.0, 0.05}) {
    NakedEyeTask task{.model = hvs_2_at(calibrated_screen()), .noise = noise, .per_size = 16, .seed = seed};
    task.contrasts = noise > 0 ? std::vector{0.5, 0.3, 0.2} : std::vector{0.4, 0.15, 0.06};
    const auto where = folder.path() / (noise > 0 ? "noise" : "plain");
    auto session = NakedEyeSession::begin(task, where, 16, {});
    if (!session) {
      ADD_FAILURE() << session.error().message;
      return {};
    }
    TemplateObserverSpec person = task.model;
    person.display = linear_display(*task.model.display);
    person.eye->sensitivity *= known.gain;
    person.eye->contrast_noise = known.contrast_noise;
    person.sensor_noise_factor = known.sensor_noise_factor;
    answer_all(*session, person, seed);
    sessions.push_back(answered_naked_eye(where).value());
  }
  PeopleFitOptions options;
  options.from = hvs_2_at(calibrated_screen());
  options.from.display.reset();
  options.name = "person";
  options.free = {true, true, true, false};
  options.persons = PersonsAre::one;
  options.replicates = 19;
  options.draws = 96;
  options.seed = seed;
  const auto fit = fit_people(std::move(sessions), options, {});
  if (!fit) {
    ADD_FAILURE() << fit.error().message;
    return {};
  }
  const double truths[] = {known.gain, known.contrast_noise, known.sensor_noise_factor};
  std::vector<std::string> out;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto side = [](const std::optional<double>& value) { return value ? std::to_string(*value) : std::string(); };
    out.push_back(std::to_string(seed) + "," + std::to_string(k) + "," + std::to_string(truths[k]) + "," +
                  std::to_string(fit->values[k]) + "," + side(fit->ci95[k].low) + "," + side(fit->ci95[k].high));
  }
  return out;
}

TEST(NakedEyePeople, FitsHoldTheParametersOfThePerson) {
  const TemporaryFolder temporary;
  const char* kept = std::getenv("TODBENCH_STUDY_FOLDER");
  const char* asked = std::getenv("TODBENCH_STUDY_RUNS");
  const std::uint64_t people = asked != nullptr ? std::strtoull(asked, nullptr, 10) : 100;
  const std::filesystem::path file =
      (kept != nullptr ? std::filesystem::path(kept) : temporary.path()) / "naked_eye_people.csv";
  std::set<std::uint64_t> there;
  std::ifstream before(file);
  for (std::string line; std::getline(before, line);) there.insert(std::strtoull(line.c_str(), nullptr, 10));
  for (std::uint64_t seed = 1; seed <= people; ++seed) {
    if (there.contains(seed)) continue;
    std::ofstream more(file, std::ios::app);
    for (const std::string& row : rows_of(seed)) more << row << "\n";
  }
  const char* names[] = {"gain", "contrast_noise", "sensor_noise_factor"};
  int held[3] = {}, count[3] = {};
  double error[3] = {};
  std::ifstream all(file);
  for (std::string line; std::getline(all, line);) {
    std::vector<std::string> cell(1);
    for (const char c : line) {
      if (c == ',')
        cell.emplace_back();
      else
        cell.back() += c;
    }
    ASSERT_EQ(cell.size(), 6u) << line;
    const auto k = static_cast<std::size_t>(std::stoi(cell[1]));
    const double truth = std::stod(cell[2]);
    ++count[k];
    held[k] += (cell[4].empty() || std::stod(cell[4]) <= truth) && (cell[5].empty() || truth <= std::stod(cell[5]));
    error[k] += std::log(std::stod(cell[3]) / truth);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    std::printf("| %s | %d of %d | mean ln error %+.3f |\n", names[k], held[k], count[k], error[k] / count[k]);
    EXPECT_GT(held[k], (0.95 - 3 * std::sqrt(0.05 * 0.95 / count[k])) * count[k] - 1) << names[k];
  }
}

}  // namespace
}  // namespace todbench::testing
