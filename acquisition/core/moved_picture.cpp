// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/moved_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

namespace todbench {
namespace {

/// A rearrangement is detected if undoing it reduces the difference below this fraction, or below 1 minus this many
/// standard errors of the difference, whichever is lower.
constexpr double put_right = 0.8;
constexpr double put_right_errors = 4.5;
/// A difference up to this multiple of the least one needs no search.
constexpr double alike = 1.2;
/// The first pictures are always searched, because the least difference must be learnt.
constexpr int first_pictures = 8;
/// Smaller shifts may be movements of a target or a mount.
constexpr int least_shift = 8;
constexpr double wanted_samples = 4000;
/// With 1000 pixels the minimum over the rearrangements stays above 1 - 4.5 * 2.4 % = 0.89; smaller pictures are not
/// judged.
constexpr std::size_t least_pixels = 1000;

/// Mean over pixels of |a - b - level|, and its standard error relative to the mean.
struct ShiftedDifference {
  double mean = 0, relative_error = 0;
};

/// Compares with the rows of `a` shifted by `shift`. `step`: distance of the compared columns.
ShiftedDifference difference(const cv::Mat1w& a, const cv::Mat1w& b, int shift, int step, double level) {
  double sum = 0, squares = 0;
  long count = 0;
  for (int y = 0; y < a.rows; ++y) {
    const std::uint16_t* now = a.ptr<std::uint16_t>((y + shift) % a.rows);
    const std::uint16_t* before = b.ptr<std::uint16_t>(y);
    for (int x = step / 2; x < a.cols; x += step, ++count) {
      const double change = std::abs(now[x] - before[x] - level);
      sum += change;
      squares += change * change;
    }
  }
  if (count == 0 || sum == 0) return {};
  const auto n = static_cast<double>(count);
  return {sum / n, std::sqrt(std::max(0.0, squares - sum * sum / n)) / sum};
}

int step_for(const cv::Mat1w& picture) {
  return std::max(1, static_cast<int>(static_cast<double>(picture.total()) / wanted_samples));
}

double level_between(const cv::Mat1w& a, const cv::Mat1w& b) {
  return cv::mean(a)[0] - cv::mean(b)[0];
}

/// Returns the shift of rows with the least difference.
std::pair<int, double> best_shift(const cv::Mat1w& a, const cv::Mat1w& b, double level) {
  std::pair<int, double> best{0, HUGE_VAL};
  const int step = std::clamp(step_for(a), 1, std::max(1, a.cols / 4));
  for (int shift = least_shift; shift <= a.rows - least_shift; ++shift) {
    const double seen = difference(a, b, shift, step, level).mean;
    if (seen < best.second) best = {shift, seen};
  }
  return best;
}

struct Turned {
  const char* words;
  cv::Mat1w picture;
};

std::vector<Turned> turned(const cv::Mat1w& picture) {
  std::vector<Turned> all;
  const auto add = [&](const char* words, const cv::Mat1w& from, std::optional<int> flip) {
    cv::Mat1w out;
    if (flip)
      cv::flip(from, out, *flip);
    else
      out = from;
    all.push_back({words, out});
  };
  add("it is rotated by 180 degrees", picture, -1);
  add("it is upside down", picture, 0);
  add("it is mirrored", picture, 1);
  if (picture.rows != picture.cols) return all;
  const cv::Mat1w across = picture.t();
  add("it is rotated by 90 degrees", across, 0);
  add("it is rotated by 90 degrees", across, 1);
  add("its rows and columns are exchanged", across, std::nullopt);
  return all;
}

}  // namespace

std::optional<std::string> MovedPicture::see(const cv::Mat1w& counts) {
  if (counts.total() < least_pixels) return std::nullopt;
  if (reference_.size() != counts.size()) {
    reference_ = counts;
    least_difference_.reset();
    compared_ = 0;
    return std::nullopt;
  }
  const double level = level_between(counts, reference_);
  const int step = std::clamp(step_for(counts), 1, std::max(1, counts.cols / 4));
  const auto [as_it_is, relative_error] = difference(counts, reference_, 0, step, level);
  const bool usual = least_difference_ && as_it_is <= alike * *least_difference_;
  std::optional<std::string> found;
  if (as_it_is > 0 && (!usual || compared_ < first_pictures)) {
    double least = std::min(put_right, 1 - put_right_errors * relative_error) * as_it_is;
    const auto propose = [&](double seen, const std::string& words) {
      if (seen >= least) return;
      least = seen;
      found = words;
    };
    const auto [rows, by_rows] = best_shift(counts, reference_, level);
    propose(by_rows, "it wraps around vertically, shifted by " + std::to_string(rows) + " px");
    const auto [columns, by_columns] = best_shift(counts.t(), reference_.t(), level);
    propose(by_columns, "it wraps around horizontally, shifted by " + std::to_string(columns) + " px");
    for (const Turned& other : turned(counts))
      propose(difference(other.picture, reference_, 0, step, level).mean, other.words);
  }
  ++compared_;
  if (found) return found;
  if (as_it_is > 0) least_difference_ = std::min(as_it_is, least_difference_.value_or(as_it_is));
  reference_ = counts;
  return std::nullopt;
}

}  // namespace todbench
