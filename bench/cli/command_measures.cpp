// SPDX-License-Identifier: GPL-3.0-or-later
// todbench sfr, todbench sitf
#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "acquisition/base/try.h"
#include "acquisition/recording/picture_file.h"
#include "bench/cli/commands.h"
#include "bench/judgement/verdict.h"
#include "bench/text/csv_table.h"
#include "bench/text/text.h"
#include "sim_devices/sensor/effect_diffraction.h"
#include "tod/measures/signal_transfer.h"
#include "tod/measures/slanted_edge.h"
#include "tod/measures/slanted_star.h"

namespace todbench {
namespace {

struct SfrArguments {
  std::string picture, axis;
  std::vector<int> region;
  std::vector<double> star;
  std::optional<double> pitch_mrad;
  std::optional<double> f_number, pitch_um, halo_at_most;
  std::vector<double> wavelength_um;
};

Result<cv::Mat1d> cut(const cv::Mat1d& picture, const std::vector<int>& region) {
  if (region.empty()) return picture;
  const cv::Rect wanted(region[0], region[1], region[2], region[3]);
  if ((wanted & cv::Rect(0, 0, picture.cols, picture.rows)) != wanted) {
    return fail(ErrorCode::invalid_input, "--region extends beyond the picture of " + std::to_string(picture.cols) +
                                              " x " + std::to_string(picture.rows) + " pixels");
  }
  return picture(wanted).clone();
}

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

/// Interval with one of the lower ends of an edge. Without a statement about halos, it is open if only the bound on
/// their share limits it.
Interval interval_of(const SlantedEdge& edge, const std::vector<double>& low, std::size_t i,
                     const SfrArguments& arguments) {
  const bool known = edge.low_known[i] || arguments.halo_at_most;
  return {known ? std::optional(low[i]) : std::nullopt, edge.mtf_high[i]};
}

/// Bounds with a stated largest share of all halos.
TailBounds with_halos(TailBounds bounds, double most) {
  bounds.most_halo = bounds.most_halo_seen = most;
  bounds.most_wide = std::min(bounds.most_wide, most);
  return bounds;
}

/// Bounds without the stated lens.
TailBounds bounds_without_lens(const SfrArguments& a) {
  return a.halo_at_most ? with_halos({}, *a.halo_at_most) : TailBounds();
}

/// Returns the tails that remain for the stated aperture, band and pitch.
Result<TailBounds> tail_bounds(const SfrArguments& a) {
  TailBounds bounds;
  const bool any = a.f_number || a.pitch_um || !a.wavelength_um.empty();
  if (any && !(a.f_number && a.pitch_um && !a.wavelength_um.empty()))
    return fail(ErrorCode::invalid_input, "--f-number, --wavelength-um and --pitch-um: expected all three or none");
  if (any) {
    const double mean_um = 0.5 * (a.wavelength_um.front() + a.wavelength_um.back());
    bounds = diffraction_bounds(*a.f_number, mean_um, *a.pitch_um);
  }
  if (a.halo_at_most) bounds = with_halos(bounds, *a.halo_at_most);
  return bounds;
}

/// MTF of a perfect lens as stated, at the shortest wavelength of the band. Precondition: a stated lens.
double lens_mtf(const SlantedEdge& edge, const SfrArguments& a, std::size_t i) {
  const double shortest_um = std::min(a.wavelength_um.front(), a.wavelength_um.back());
  return diffraction_mtf(edge.frequency_per_pitch[i], shortest_um, *a.f_number, *a.pitch_um);
}

/// Lowest frequency, in cycles per pitch, at which the lower end of the interval is above the MTF of the stated lens.
/// Empty: none, or no stated lens.
std::optional<double> above_stated_lens(const SlantedEdge& edge, const SfrArguments& a) {
  constexpr double tolerance = 0.02;  // of the MTF, for rounded f-numbers and bands
  if (!a.f_number) return std::nullopt;
  for (std::size_t i = 0; i < edge.mtf.size(); ++i) {
    if (edge.mtf_low[i] > lens_mtf(edge, a, i) + tolerance) return edge.frequency_per_pitch[i];
  }
  return std::nullopt;
}

/// Finding about a lens that cannot have made the picture, at the frequency where it does so most; empty if it can.
std::string lens_finding(const SlantedEdge& edge, const SfrArguments& a) {
  if (!above_stated_lens(edge, a)) return {};
  std::size_t i = 0;
  for (std::size_t k = 0; k < edge.mtf.size(); ++k) {
    if (edge.mtf_low[k] - lens_mtf(edge, a, k) > edge.mtf_low[i] - lens_mtf(edge, a, i)) i = k;
  }
  return "the stated lens contradicts the picture: at " + fixed(edge.frequency_per_pitch[i], 2) +
         " cycles per pitch the MTF is at least " + fixed(edge.mtf_low[i], 3) + ", but that of a perfect lens is " +
         fixed(lens_mtf(edge, a, i), 3) +
         ". Check f-number, wavelength and pitch, and whether the camera sharpens its picture. The tails are not "
         "bounded "
         "by this lens.";
}

Json edge_json(const SlantedEdge& edge, const SfrArguments& arguments) {
  Json intervals = Json::array();
  Json in_picture = Json::array();
  for (std::size_t i = 0; i < edge.mtf.size(); ++i) {
    intervals.push_back(json_interval(interval_of(edge, edge.mtf_low, i, arguments)));
    in_picture.push_back(json_interval(interval_of(edge, edge.mtf_low_in_picture, i, arguments)));
  }
  const std::optional<double> pitch = arguments.pitch_mrad;
  const auto per_mrad = [&](const std::optional<double>& per_pitch) {
    return pitch && per_pitch ? json_number(*per_pitch / *pitch) : Json();
  };
  return {{"axis", to_string(edge.axis)},
          {"angle_deg", json_number(edge.angle_deg)},
          {"edge_at_pitch", json_number(edge.edge_at_pitch)},
          {"curvature_pitch", json_number(edge.curvature_pitch)},
          {"lines", edge.rows},
          {"step", json_number(edge.step)},
          {"noise_over_step", json_number(edge.noise_over_step)},
          {"shading_percent", json_number(edge.shading_percent)},
          {"window_pitch", json_number(edge.window_pitch)},
          {"frequency_per_pitch", json_numbers(edge.frequency_per_pitch)},
          {"frequency_per_mrad", pitch ? json_numbers(scaled(edge.frequency_per_pitch, 1 / *pitch)) : Json()},
          {"mtf", json_numbers(edge.mtf)},
          {"mtf_ci95", intervals},
          {"mtf_ci95_in_picture", in_picture},
          {"widest_halo_pitch", json_number(edge.widest_halo_pitch)},
          {"halo_allowance", json_number(edge.halo_allowance)},
          {"wide_halo_ci95", {json_number(edge.wide_halo_least), json_number(edge.wide_halo_most)}},
          {"sharpened", edge.sharpened},
          {"mtf50_per_pitch", json_number(edge.mtf50_per_pitch)},
          {"mtf50_per_mrad", per_mrad(edge.mtf50_per_pitch)},
          {"above_stated_lens_per_pitch", json_number(above_stated_lens(edge, arguments))},
          {"notes", edge.notes}};
}

Json sfr_json(const SlantedEdge& edge, const SfrArguments& arguments) {
  Json json{{"picture", arguments.picture}};
  json.update(edge_json(edge, arguments));
  return json;
}

Json star_json(const std::vector<StarEdge>& edges, const SfrArguments& arguments) {
  Json rows = Json::array();
  for (const StarEdge& edge : edges) {
    Json row = edge.measured ? edge_json(*edge.measured, arguments) : Json{{"rejected", edge.rejected}};
    row["edge_deg"] = json_number(edge.edge_deg);
    row["normal_deg"] = json_number(edge.normal_deg);
    row["direction"] = to_string(edge.direction);
    row["region"] = {edge.region.x, edge.region.y, edge.region.width, edge.region.height};
    rows.push_back(std::move(row));
  }
  return {{"picture", arguments.picture}, {"star", json_numbers(arguments.star)}, {"edges", rows}};
}

void print_star(Console& console, const std::vector<StarEdge>& edges, const SfrArguments& arguments) {
  std::vector<TableRow> rows;
  for (const StarEdge& edge : edges) {
    TableRow row{fixed(edge.edge_deg, 1), fixed(edge.normal_deg, 1), std::string(to_string(edge.direction))};
    for (const std::size_t i : {10u, 20u, 30u, 50u})
      row.push_back(edge.measured ? fixed(edge.measured->mtf[i], 4) + " " +
                                        range(interval_of(*edge.measured, edge.measured->mtf_low, i, arguments), 4)
                                  : "-");
    row.push_back(edge.measured ? fixed(edge.measured->mtf50_per_pitch, 4) : edge.rejected);
    rows.push_back(std::move(row));
  }
  console.table({"edge (deg)", "normal (deg)", "direction", "MTF at 0.1", "at 0.2", "at 0.3", "at 0.5", "MTF 0.5 at"},
                rows);
  console.text("");
  console.text(
      "MTF along the normal of each edge, at frequencies in cycles per pitch, with 95 % intervals relative to a source "
      "of any size. Angles are from +x towards +y (down). Tangential: along the line from the middle of the picture to "
      "the star, within 22.5 degrees; sagittal: across it.");
}

void print_sfr(Console& console, const SlantedEdge& edge, const SfrArguments& arguments) {
  console.text("MTF along " + std::string(to_string(edge.axis)) + " from an edge slanted by " +
               fixed(edge.angle_deg, 2) + " degrees over " + std::to_string(edge.rows) + " lines; noise " +
               fixed(100 * edge.noise_over_step, 2) + " % of the step");
  std::vector<TableRow> rows;
  for (std::size_t i = 0; i < edge.mtf.size(); i += 5) {
    const double frequency = edge.frequency_per_pitch[i];
    TableRow row{fixed(frequency, 2), fixed(edge.mtf[i], 4), range(interval_of(edge, edge.mtf_low, i, arguments), 4),
                 range(interval_of(edge, edge.mtf_low_in_picture, i, arguments), 4)};
    if (arguments.pitch_mrad) row.insert(row.begin() + 1, fixed(frequency / *arguments.pitch_mrad, 4));
    rows.push_back(row);
  }
  TableRow header{"cycles per pitch", "MTF", "95 %", "95 % in picture"};
  if (arguments.pitch_mrad) header.insert(header.begin() + 1, "cycles per mrad");
  console.table(header, rows);
  console.text("");
  console.text("MTF 0.5 at " + fixed(edge.mtf50_per_pitch, 4) + " cycles per pitch");
  console.text("The MTF is relative to a source of the size of the picture and excludes halos wider than " +
               fixed(edge.widest_halo_pitch, 1) + " pitches, which are at most " + fixed(100 * edge.wide_halo_most, 1) +
               " % of the step. The first interval is relative to a source of any size, the second to a source of the "
               "size of the picture.");
}

/// Whether values reach the end of the range of the file's type, so that they may be clipped.
bool reaches_end(const PictureFile& file) {
  if (!file.counts) return false;
  double low = 0, high = 0;
  cv::minMaxLoc(file.picture, &low, &high);
  return high >= file.counts->second || (low <= file.counts->first && file.counts->first != 0);
}

bool above_lens(const SlantedEdge& edge, const SfrArguments& arguments) {
  return above_stated_lens(edge, arguments).has_value();
}

bool above_lens(const std::vector<StarEdge>& edges, const SfrArguments& arguments) {
  return std::ranges::any_of(edges,
                             [&](const StarEdge& e) { return e.measured && above_lens(*e.measured, arguments); });
}

/// Measures without the stated lens first, and with its bounds only if it can have made the picture: false bounds
/// change the tails and so the MTF.
template <typename Measure>
auto without_false_lens(SlantedEdgeOptions options, const SfrArguments& arguments, Measure measure) {
  const TailBounds of_lens = options.tails;
  options.tails = bounds_without_lens(arguments);
  auto found = measure(options);
  if (!found || !arguments.f_number || above_lens(*found, arguments)) return found;
  options.tails = of_lens;
  return measure(options);
}

/// Adds what the file and the bounds say of a measured edge.
void add_notes(SlantedEdge& edge, bool at_end, const SfrArguments& arguments) {
  if (std::string finding = lens_finding(edge, arguments); !finding.empty()) edge.notes.push_back(std::move(finding));
  if (at_end) edge.notes.emplace_back("pixels have the lowest or highest value of the pixel type and may be clipped");
  if (!arguments.halo_at_most && !std::all_of(edge.low_known.begin(), edge.low_known.end(), [](bool k) { return k; })) {
    edge.notes.emplace_back(
        "a halo cannot be distinguished from shading, because the picture is too noisy or too small: the MTF has no "
        "lower limit. Average more frames, include more of the two sides, or state the largest share of halos "
        "(--halo-at-most).");
  }
}

int run_star(Console& console, const PictureFile& file, const SlantedEdgeOptions& options,
             const SfrArguments& arguments) {
  auto edges = without_false_lens(options, arguments, [&](const SlantedEdgeOptions& within) {
    return slanted_star(file.picture, {{arguments.star[0], arguments.star[1]}, arguments.star[2]}, within);
  });
  if (!edges) return report_error(console, with_context(arguments.picture, edges.error()));
  const bool at_end = reaches_end(file);
  std::vector<std::string> said;
  for (StarEdge& edge : *edges) {
    if (!edge.measured) continue;
    add_notes(*edge.measured, at_end, arguments);
    for (const auto& note : edge.measured->notes)
      if (std::ranges::find(said, note) == said.end()) said.push_back(note);
  }
  for (const auto& note : said) console.note(note);
  if (console.json())
    console.object(star_json(*edges, arguments));
  else
    print_star(console, *edges, arguments);
  return exit_code(above_lens(*edges, arguments) ? VerdictKind::inconclusive : VerdictKind::pass);
}

int run_sfr(Console& console, const SfrArguments& arguments) {
  const auto file = read_picture(arguments.picture);
  if (!file) return report_error(console, file.error());
  SlantedEdgeOptions options;
  if (!arguments.axis.empty()) options.axis = arguments.axis == "x" ? EdgeAxis::x : EdgeAxis::y;
  const auto bounds = tail_bounds(arguments);
  if (!bounds) return report_error(console, bounds.error());
  options.tails = *bounds;
  if (!arguments.star.empty()) return run_star(console, *file, options, arguments);
  const auto picture = cut(file->picture, arguments.region);
  if (!picture) return report_error(console, with_context(arguments.picture, picture.error()));
  auto edge = without_false_lens(options, arguments,
                                 [&](const SlantedEdgeOptions& within) { return slanted_edge(*picture, within); });
  if (!edge) return report_error(console, with_context(arguments.picture, edge.error()));
  add_notes(*edge, reaches_end(*file), arguments);
  for (const auto& note : edge->notes) console.note(note);
  if (console.json())
    console.object(sfr_json(*edge, arguments));
  else
    print_sfr(console, *edge, arguments);
  return exit_code(above_stated_lens(*edge, arguments) ? VerdictKind::inconclusive : VerdictKind::pass);
}

/// Returns the column of the first name in the header.
std::optional<std::size_t> column_of(const CsvTable& table, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    if (const auto found = table.column(name)) return found;
  }
  return std::nullopt;
}

struct StepColumns {
  std::size_t delta_t_k = 0, signal = 0;
  std::optional<std::size_t> signal_u{};
  std::string unit{};
  std::vector<std::string> unused{};  ///< names of unused columns
};

Result<StepColumns> step_columns(const CsvTable& table) {
  const auto temperature = column_of(table, {"delta_t_k", "temperature_k"});
  if (!temperature) return table.wrong(1, "expected a column delta_t_k (or temperature_k)");
  const auto signal = column_of(table, {"counts", "signal", "signal_k"});
  if (!signal) return table.wrong(1, "expected a column counts (or signal, signal_k)");
  for (const auto& name : table.header) {
    if (std::count(table.header.begin(), table.header.end(), name) > 1)
      return table.wrong(1, "the column '" + one_line(name) + "' occurs twice");
  }
  StepColumns columns{*temperature, *signal,
                      column_of(table, {"counts_se", "counts_u", "u_counts", "signal_u", "signal_se"})};
  columns.unit = table.header[*signal] == "signal_k" ? "K" : table.header[*signal];
  for (std::size_t i = 0; i < table.header.size(); ++i) {
    if (i != columns.delta_t_k && i != columns.signal && i != columns.signal_u)
      columns.unused.push_back(one_line(table.header[i]));
  }
  return columns;
}

struct Steps {
  std::vector<TemperatureStep> steps;
  std::string unit;
  std::vector<std::string> unused;
};

Result<Steps> read_steps(const std::string& file) {
  TODBENCH_TRY(const auto text, read_text_file(file));
  TODBENCH_TRY(const auto table, parse_csv(text, file));
  TODBENCH_TRY(const auto columns, step_columns(table));
  Steps steps;
  steps.unit = columns.unit;
  steps.unused = columns.unused;
  for (const CsvRow& row : table.rows) {
    TemperatureStep step;
    const auto number = [&](std::size_t column) -> Result<double> {
      const auto value = parse_number(row.fields[column]);
      if (value) return *value;
      return table.wrong(row.line, "column " + one_line(table.header[column]) + ": expected a number, found '" +
                                       one_line(row.fields[column]) + "'");
    };
    const auto temperature = number(columns.delta_t_k), signal = number(columns.signal);
    if (!temperature) return tl::unexpected(temperature.error());
    if (!signal) return tl::unexpected(signal.error());
    step.delta_t_k = *temperature, step.signal = *signal;
    if (columns.signal_u && !row.fields[*columns.signal_u].empty()) {
      const auto uncertainty = number(*columns.signal_u);
      if (!uncertainty) return tl::unexpected(uncertainty.error());
      if (!(*uncertainty > 0)) return table.wrong(row.line, "the uncertainty of the signal must be above 0");
      step.signal_u = *uncertainty;
    }
    steps.steps.push_back(step);
  }
  return steps;
}

Json sitf_json(const SignalTransfer& line, const Steps& steps, const std::string& file) {
  return {{"steps_file", file},
          {"unit", steps.unit + " per K"},
          {"steps", steps.steps.size()},
          {"slope", json_number(line.slope)},
          {"slope_u", json_number(line.slope_u)},
          {"slope_u_stated", json_number(line.slope_u_stated)},
          {"slope_u_scatter", json_number(line.slope_u_scatter)},
          {"offset", json_number(line.offset)},
          {"chi2", json_number(line.chi2)},
          {"degrees_of_freedom", line.degrees_of_freedom},
          {"p", json_number(line.p)},
          {"largest_residual", json_number(line.largest_residual)},
          {"nonlinearity_percent", json_number(line.nonlinearity_percent)},
          {"r_squared", json_number(line.r_squared)},
          {"residuals", json_numbers(line.residuals)}};
}

int run_sitf(Console& console, const std::string& file) {
  const auto steps = read_steps(file);
  if (!steps) return report_error(console, steps.error());
  for (const auto& name : steps->unused) console.note("the column '" + name + "' is not used");
  const auto line = signal_transfer(steps->steps);
  if (!line) return report_error(console, with_context(file, line.error()));
  if (line->p && *line->p < 0.01)
    console.note("the steps do not lie on a straight line within their uncertainties (p " + fixed(line->p, 4) + ")");
  if (console.json()) {
    console.object(sitf_json(*line, *steps, file));
    return 0;
  }
  const std::string unit = steps->unit + " per K";
  console.table(
      {"quantity", "value", "unit"},
      {{"slope", fixed(line->slope, 5), unit},
       {"standard uncertainty", fixed(line->slope_u, 5), unit},
       {"  from the stated uncertainties", fixed(line->slope_u_stated, 5), unit},
       {"  from the scatter", fixed(line->slope_u_scatter, 5), unit},
       {"offset", fixed(line->offset, 3), steps->unit},
       {"chi squared", fixed(line->chi2, 3), "degrees of freedom: " + std::to_string(line->degrees_of_freedom)},
       {"p", fixed(line->p, 4), ""},
       {"nonlinearity", fixed(line->nonlinearity_percent, 3), "% of the span"}});
  return 0;
}

}  // namespace

void add_sfr_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("sfr", "measures the MTF from a picture of a slanted edge (TIFF or .npy)");
  auto a = std::make_shared<SfrArguments>();
  command->add_option("PICTURE", a->picture, "file with one straight edge between two flat fields")->required();
  command
      ->add_option("--axis", a->axis,
                   "axis of the spatial frequency: x for a nearly vertical edge; default: detected from the picture")
      ->check(CLI::IsMember({"x", "y"}));
  command
      ->add_option("--region", a->region,
                   "X,Y,WIDTH,HEIGHT of the region with the edge, in pixels; default: the whole picture")
      ->delimiter(',')
      ->expected(4)
      ->check(whole_number(0, 65535));
  command
      ->add_option(
          "--star", a->star,
          "X,Y,RADIUS of a star of bright and dark sectors in the picture, in pixels: measures each of its edges")
      ->delimiter(',')
      ->expected(3)
      ->check(number_in(0, 65535))
      ->excludes("--region")
      ->excludes("--axis");
  command
      ->add_option("--pitch-mrad", a->pitch_mrad,
                   "angle of a pixel (IFOV) in mrad; adds frequencies in cycles per mrad")
      ->check(number_in(1e-6, 1e6, "mrad"));
  command
      ->add_option(
          "--f-number", a->f_number,
          "f-number of the lens; with --wavelength-um and --pitch-um it bounds the tails of the line spread function")
      ->check(number_in(0.1, 100));
  command->add_option("--wavelength-um", a->wavelength_um, "spectral band LOW,HIGH in um, or its central wavelength")
      ->delimiter(',')
      ->expected(1, 2)
      ->check(number_in(0.1, 100, "um"));
  command->add_option("--pitch-um", a->pitch_um, "detector pitch in um")->check(number_in(0.1, 1000, "um"));
  command
      ->add_option(
          "--halo-at-most", a->halo_at_most,
          "largest share of the step that halos of any width can have, if known; it bounds the lower end of the "
          "intervals")
      ->check(number_in(0, 0.9));
  finish_command(*command, program, [a](Console& console) { return run_sfr(console, *a); });
}

void add_sitf_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("sitf", "fits the signal transfer (SiTF) to temperature steps in a CSV file");
  auto file = std::make_shared<std::string>();
  command->add_option("STEPS.csv", *file, "file with the columns delta_t_k, counts and, if known, counts_se")
      ->required();
  finish_command(*command, program, [file](Console& console) { return run_sitf(console, *file); });
}

}  // namespace todbench
