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

/// Returns the difference of rearranged pictures relative to that of the same pixels as they are. Infinite if the
/// errors of the latter explain it.
double ratio_of(const ShiftedDifference& rearranged, const ShiftedDifference& as_it_is) {
  const double ratio = rearranged.mean / as_it_is.mean;
  return ratio < 1 - put_right_errors * as_it_is.relative_error ? ratio : HUGE_VAL;
}

int step_for(const cv::Mat1w& picture) {
  return std::max(1, static_cast<int>(static_cast<double>(picture.total()) / wanted_samples));
}

double level_between(const cv::Mat1w& a, const cv::Mat1w& b) {
  return cv::mean(a)[0] - cv::mean(b)[0];
}

/// Step of the compared columns.
int step_of_columns(const cv::Mat1w& picture) {
  return std::clamp(step_for(picture), 1, std::max(1, picture.cols / 4));
}

/// A shift of rows, and the difference with it relative to that without it.
struct RowShift {
  int rows = 0;
  double ratio = HUGE_VAL;
};

/// Returns the shift with the least difference.
RowShift best_shift(const cv::Mat1w& a, const cv::Mat1w& b, double level) {
  const int step = step_of_columns(a);
  // Of the same columns: a row of telemetry is one of the columns of a transposed picture.
  const ShiftedDifference as_it_is = difference(a, b, 0, step, level);
  RowShift best;
  for (int shift = least_shift; shift <= a.rows - least_shift; ++shift) {
    const double ratio = ratio_of(difference(a, b, shift, step, level), as_it_is);
    if (ratio < best.ratio) best = {shift, ratio};
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
  const int step = step_of_columns(counts);
  const ShiftedDifference as_it_is = difference(counts, reference_, 0, step, level);
  const bool usual = least_difference_ && as_it_is.mean <= alike * *least_difference_;
  std::optional<std::string> found;
  if (as_it_is.mean > 0 && (!usual || compared_ < first_pictures)) {
    double least = put_right;
    const auto propose = [&](double ratio, const std::string& words) {
      if (!(ratio < least)) return;
      least = ratio;
      found = words;
    };
    const RowShift rows = best_shift(counts, reference_, level);
    propose(rows.ratio, "it wraps around vertically, shifted by " + std::to_string(rows.rows) + " px");
    const RowShift columns = best_shift(counts.t(), reference_.t(), level);
    propose(columns.ratio, "it wraps around horizontally, shifted by " + std::to_string(columns.rows) + " px");
    for (const Turned& other : turned(counts))
      propose(ratio_of(difference(other.picture, reference_, 0, step, level), as_it_is), other.words);
  }
  ++compared_;
  if (found) return found;
  if (as_it_is.mean > 0) least_difference_ = std::min(as_it_is.mean, least_difference_.value_or(as_it_is.mean));
  reference_ = counts;
  return std::nullopt;
}

}  // namespace todbench
