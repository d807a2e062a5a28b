// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/judge_bars.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "bench/cli/commands.h"
#include "bench/cli/session_argument.h"
#include "bench/report/number_format.h"
#include "bench/run/rebuild_report.h"
#include "bench/session/bars_people.h"
#include "bench/session/kept_bars_record.h"
#include "bench/session/provenance.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

void show(Console& console, const std::vector<BarsSitting>& sittings) {
  std::vector<std::vector<std::string>> rows;
  const auto words = [](const BarsThreshold& of) {
    return of.size_px > 0 ? fmt::format("{}, spot of {:.3g} px", of.place, of.size_px)
                          : fmt::format("{}, {:.3g} cycles per pitch along {}", of.place, of.frequency_per_pitch,
                                        to_string(of.axis));
  };
  const std::vector<JudgedBars> people = judged_bars(sittings);
  for (const JudgedBars& sitting : people) {
    for (const BarsThreshold& one : sitting.thresholds) {
      rows.push_back({words(one), sitting.person, std::to_string(one.found.answers),
                      one.found.half_k ? with_interval(one.found.half_k, one.found.ci95) : one.found.reason});
    }
  }
  for (const BarsMean& mean : bars_means(people)) {
    if (mean.over.people == 0) {
      rows.push_back({words(mean.of), "mean", std::to_string(mean.answers),
                      fmt::format("none: {} without a threshold", mean.without)});
      continue;
    }
    const Interval interval = mean.over.ci95 ? Interval{mean.over.ci95->first, mean.over.ci95->second} : Interval{};
    rows.push_back({words(mean.of), fmt::format("mean of {}", mean.over.people), std::to_string(mean.answers),
                    with_interval(mean.over.mean, interval)});
  }
  console.table({"target", "person", "answers", "threshold (K) [95 %]"}, rows);
}

int write_questions(Console& console, const BarsArguments& a, const KeptBars& kept) {
  if (a.out.empty())
    return report_error(console, {ErrorCode::invalid_input, "--out is missing: the folder of the pictures"});
  const auto count = write_bars_questions(a.out, a.session, kept, a.request);
  if (!count) return report_error(console, count.error());
  if (console.json()) {
    console.object({{"pictures", *count}, {"folder", a.out}});
  } else {
    console.text(
        fmt::format("{} pictures in {}. Enter left or right in answers.csv: the side with four bars, or with "
                    "the spot. Then: todbench judge {} --answers {} --person CODE",
                    *count, a.out, a.session, a.out));
  }
  return 0;
}

int take_answers(Console& console, const BarsArguments& a, const KeptBars& kept) {
  auto sitting = read_bars_answers(a.answers, a.session, kept);
  if (!sitting) return report_error(console, sitting.error());
  sitting->person = a.person;
  sitting->person.judged_utc = utc_now();
  const auto earlier = read_bars_sittings(a.session);
  if (!earlier) return report_error(console, earlier.error());
  const bool known = std::ranges::any_of(*earlier, [&](const BarsSitting& one) {
    return one.person.code == sitting->person.code && one.seed == sitting->seed;
  });
  if (known) {
    return report_error(console,
                        {ErrorCode::invalid_input,
                         fmt::format("{}: person '{}' has already answered the pictures of seed {}; show others with "
                                     "another --seed",
                                     a.answers, one_line(sitting->person.code), sitting->seed)});
  }
  if (auto added = add_bars_sitting(a.session, *sitting); !added) return report_error(console, added.error());
  const auto session = open_session(a.session, {});
  if (!session) return report_error(console, session.error());
  if (auto built = rebuild_report(*session, a.session, html_page(a.session)); !built)
    return report_error(console, built.error());
  std::vector<BarsSitting> all = *earlier;
  all.push_back(*sitting);
  if (console.json()) {
    console.object(bars_people_json(all));
  } else {
    show(console, all);
  }
  return 0;
}

}  // namespace

void add_bars_options(CLI::App& command, BarsArguments& a) {
  auto* bars = command.add_flag("--bars", a.questions,
                                "writes the bars and spots that the session kept as pictures for a person, in random "
                                "order");
  auto* answers = command.add_option("--answers", a.answers, "folder of --bars with the answers of a person");
  bars->excludes(answers);
  command
      .add_flag("--all-places", a.request.all_places,
                "pictures of all frequencies and spots; default: those that the plan reports")
      ->needs(bars);
  command.add_option("--times", a.request.times, "decisions at each contrast of each set-up")
      ->check(whole_number(1, 100))
      ->capture_default_str()
      ->needs(bars);
  command.add_option("--magnification", a.request.magnification, "screen pixels per pixel of the camera")
      ->check(whole_number(1, 64))
      ->capture_default_str()
      ->needs(bars);
  command.add_option("--person", a.person.code, "code of the person who answered")->needs(answers);
  command.add_option("--screen", a.person.screen, "screen, in free text")->needs(answers);
  command.add_option("--viewing-distance-m", a.person.distance_m, "from the eye to the screen")
      ->check(number_in(0.01, 100, "m"))
      ->needs(answers);
}

int run_judge_bars(Console& console, const BarsArguments& a) {
  const auto session = opened(console, a.session, a.questions ? a.opening : Opening{});
  if (!session) return report_error(console, session.error());
  const auto kept = read_kept_bars(a.session);
  if (!kept) return report_error(console, kept.error());
  if (!*kept) {
    return report_error(
        console, {ErrorCode::invalid_input, a.session + ": kept no bars. Measure with [measures] mrtd = true and "
                                                        "mrtd_kept_frames = 2"});
  }
  if (!a.questions && a.person.code.empty())
    return report_error(console, {ErrorCode::invalid_input, "--person is missing: a code of the person who answered"});
  if (!a.questions) return take_answers(console, a, **kept);
  BarsArguments with = a;
  with.request.frequency_per_pitch = session->plan.measures.mrtd_frequency_per_pitch;
  with.request.spot_px = session->plan.measures.mdtd_size_px;
  return write_questions(console, with, **kept);
}

}  // namespace todbench
