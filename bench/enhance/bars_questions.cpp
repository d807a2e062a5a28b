// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/enhance/bars_questions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "acquisition/base/rng.h"
#include "acquisition/base/try.h"
#include "bench/picture_files/encoded_picture.h"
#include "bench/session/kept_bars_record.h"
#include "bench/text/csv_table.h"
#include "bench/text/files.h"
#include "bench/text/folders.h"
#include "bench/text/json_file.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr int gap_samples = 4;
constexpr std::string_view request_schema = "todbench-bars-questions-1";
constexpr const char *request_name = "bars.json", *answers_name = "answers.csv";

/// Content of bars.json.
struct BarsFolder {
  BarsRequest request{};
  std::string kept_sha256{};
};

void folder_fields(JsonFields& json, BarsFolder& folder) {
  BarsRequest& request = folder.request;
  json.constant("schema", request_schema);
  json.value("kept_sha256", folder.kept_sha256);
  json.value("all_places", request.all_places);
  json.value("frequency_per_pitch", request.frequency_per_pitch);
  json.value("spot_px", request.spot_px);
  json.value("times", request.times);
  json.value("magnification", request.magnification);
  json.value("seed", request.seed);
}

/// The place of an axis, or the spot, nearest to a value.
void add_nearest(const KeptBars& kept, std::optional<EdgeAxis> axis, double wanted, std::set<std::size_t>& into) {
  const auto value = [&](const KeptPlace& place) { return axis ? place.frequency_per_pitch : place.size_px; };
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < kept.places.size(); ++i) {
    const KeptPlace& place = kept.places[i];
    if (axis ? place.size_px > 0 || place.axis != *axis : !(place.size_px > 0)) continue;
    if (!found || std::abs(value(place) - wanted) < std::abs(value(kept.places[*found]) - wanted)) found = i;
  }
  if (found) into.insert(*found);
}

std::set<std::size_t> places_of(const KeptBars& kept, const BarsRequest& request) {
  std::set<std::size_t> places;
  if (request.all_places) {
    for (std::size_t i = 0; i < kept.places.size(); ++i) places.insert(i);
    return places;
  }
  add_nearest(kept, EdgeAxis::x, request.frequency_per_pitch, places);
  add_nearest(kept, EdgeAxis::y, request.frequency_per_pitch, places);
  add_nearest(kept, std::nullopt, request.spot_px, places);
  return places;
}

}  // namespace

Result<std::vector<BarsQuestion>> bars_questions(const KeptBars& kept, const BarsRequest& request) {
  const std::set<std::size_t> places = places_of(kept, request);
  if (places.empty()) return fail(ErrorCode::invalid_input, "the session kept no bars or spots");
  std::map<std::tuple<std::size_t, int, double>, std::vector<std::size_t>> groups;
  std::set<int> set_ups;
  for (std::size_t i = 0; i < kept.pictures.size(); ++i) {
    const KeptPicture& picture = kept.pictures[i];
    if (places.count(picture.place) == 0) continue;
    groups[{picture.place, picture.set_up, picture.contrast_k}].push_back(i);
    set_ups.insert(picture.set_up);
  }
  if (static_cast<int>(set_ups.size()) < least_choice_set_ups) {
    return fail(ErrorCode::invalid_input, fmt::format("the session kept bars of {} set-ups; a threshold needs {}",
                                                      set_ups.size(), least_choice_set_ups));
  }
  const RandomStream choice(request.seed, "bars.choice"), order(request.seed, "bars.order");
  std::uint64_t number = 0;
  std::vector<BarsQuestion> questions;
  for (const auto& [key, frames] : groups) {
    for (int k = 0; k < request.times; ++k, number += 3) {
      const std::size_t first = choice.below(frames.size(), number);
      // Noise that rows or the whole frame share must not help: the windows are of two frames.
      const std::size_t apart = frames.size() > 1 ? 1 + choice.below(frames.size() - 1, number + 1) : 0;
      questions.push_back({frames[first], frames[(first + apart) % frames.size()], choice.below(2, number + 2) == 0});
    }
  }
  for (std::size_t i = questions.size(); i > 1; --i) std::swap(questions[i - 1], questions[order.below(i, i)]);
  return questions;
}

cv::Mat1b bars_picture(const KeptBars& kept, const BarsQuestion& question, int magnification) {
  const KeptPicture& shown = kept.pictures[question.target_picture];
  const cv::Mat1f &target = shown.target, &other = kept.pictures[question.other_picture].other;
  const double squares = cv::norm(target, cv::NORM_L2SQR) + cv::norm(other, cv::NORM_L2SQR);
  const double sd = std::sqrt(squares / static_cast<double>(target.total() + other.total()));
  const double half = std::max({1.5 * std::abs(shown.contrast_k), 3 * sd, 1e-9});
  const cv::Mat1f gap = cv::Mat1f::zeros(target.rows, gap_samples);
  cv::Mat1f both, fine;
  cv::hconcat(std::vector<cv::Mat>{question.target_left ? target : other, gap, question.target_left ? other : target},
              both);
  cv::resize(both, fine, {}, magnification, magnification, cv::INTER_CUBIC);
  cv::Mat1b grey;
  fine.convertTo(grey, CV_8U, 127.5 / half, 127.5);
  return grey;
}

BarsAnswer bars_answer(const KeptBars& kept, const BarsQuestion& question, bool answered_left) {
  const KeptPicture& shown = kept.pictures[question.target_picture];
  const KeptPlace& place = kept.places[shown.place];
  return {.place = place.name,
          .axis = place.axis,
          .frequency_per_pitch = place.frequency_per_pitch,
          .size_px = place.size_px,
          .contrast_k = shown.contrast_k,
          .set_up = shown.set_up,
          .target_left = question.target_left,
          .answered_left = answered_left};
}

Result<std::size_t> write_bars_questions(const std::filesystem::path& folder, const std::filesystem::path& session,
                                         const KeptBars& kept, const BarsRequest& request) {
  if (is_there(folder)) return fail(ErrorCode::invalid_input, folder.string() + ": exists");
  TODBENCH_TRY(const auto questions, bars_questions(kept, request));
  TODBENCH_TRY(std::string sha256, sha256_of_file(kept_bars_file(session)));
  TODBENCH_TRY_VOID(make_folder(folder));
  std::string answers = "number,answer\n";
  for (std::size_t i = 0; i < questions.size(); ++i) {
    TODBENCH_TRY(const std::string png, png_of(bars_picture(kept, questions[i], request.magnification)));
    TODBENCH_TRY_VOID(write_file_atomically(folder / picture_name(i + 1), png));
    answers += std::to_string(i + 1) + ",\n";
  }
  TODBENCH_TRY_VOID(write_file_atomically(folder / answers_name, answers));
  const BarsFolder content{request, std::move(sha256)};
  TODBENCH_TRY_VOID(write_json_file(folder / request_name, json_of(content, folder_fields)));
  return questions.size();
}

Result<BarsSitting> read_bars_answers(const std::filesystem::path& folder, const std::filesystem::path& session,
                                      const KeptBars& kept) {
  TODBENCH_TRY(const auto content, read_record_file<BarsFolder>(folder / request_name, folder_fields));
  TODBENCH_TRY(const std::string sha256, sha256_of_file(kept_bars_file(session)));
  if (sha256 != content.kept_sha256)
    return fail(ErrorCode::invalid_input, (folder / request_name).string() + ": the pictures are of another session");
  TODBENCH_TRY(const auto questions, bars_questions(kept, content.request));
  TODBENCH_TRY(const std::string csv, read_text_file(folder / answers_name));
  TODBENCH_TRY(const CsvTable table, parse_csv(csv, (folder / answers_name).string()));
  if (table.header != std::vector<std::string>{"number", "answer"})
    return table.wrong(1, "expected the columns number,answer");
  if (table.rows.size() != questions.size())
    return table.wrong(1, fmt::format("expected one row for each of the {} pictures", questions.size()));
  BarsSitting sitting{.seed = content.request.seed, .magnification = content.request.magnification};
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const CsvRow& row = table.rows[i];
    if (row.fields[0] != std::to_string(i + 1)) return table.wrong(row.line, "the rows are not in their order");
    const std::string& answer = row.fields[1];
    if (answer.empty()) continue;
    if (answer != "left" && answer != "right") return table.wrong(row.line, "expected left or right");
    sitting.answers.push_back(bars_answer(kept, questions[i], answer == "left"));
  }
  if (sitting.answers.empty()) return table.wrong(1, "there is no answer");
  return sitting;
}

}  // namespace todbench
