// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/range_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/cli/commands.h"
#include "bench/plan/descriptions.h"
#include "bench/report/grid_figure.h"
#include "bench/report/html.h"
#include "bench/report/range_figure.h"
#include "bench/text/csv_table.h"
#include "bench/text/files.h"
#include "bench/text/spread_text.h"
#include "bench/text/text.h"
#include "bench/text/unit_hint.h"
#include "sim_devices/atmosphere/radiative_path.h"

namespace todbench {
namespace {

/// Parses "tod,ttp" or "all".
Result<std::vector<RangeModel>> models_from(const std::string& text) {
  if (text == "all") return std::vector<RangeModel>(all_range_models.begin(), all_range_models.end());
  std::vector<std::string> known{"all"};
  for (const RangeModel model : all_range_models) known.emplace_back(to_string(model));
  std::vector<RangeModel> models;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const auto end = std::min(text.find(',', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    begin = end + 1;
    const auto found = std::find_if(all_range_models.begin(), all_range_models.end(),
                                    [&](RangeModel model) { return to_string(model) == word; });
    if (found == all_range_models.end()) {
      return fail(ErrorCode::invalid_input, "unknown model '" + one_line(word) + "'" + nearest_name_hint(word, known) +
                                                " (known: " + quoted_list(known) + ")");
    }
    if (std::find(models.begin(), models.end(), *found) == models.end()) models.push_back(*found);
  }
  return models;
}

/// Whether a curve falls from its first point to its last without rising between.
bool falls(std::span<const CurvePoint> points) {
  const auto rises = [](const CurvePoint& a, const CurvePoint& b) { return b.value > a.value; };
  return points.back().value < points.front().value &&
         std::adjacent_find(points.begin(), points.end(), rises) == points.end();
}

/// Reads a curve over frequency_per_mrad from a CSV file.
Result<LogLinearCurve> curve_from(const std::string& file, const std::string& column) {
  // Covers cameras from microscopes to telescopes; a threshold is in kelvin or a contrast.
  constexpr NumberRange frequency_range = NumberRange::between(0, 1e5), value_range = NumberRange::between(1e-9, 1e6);
  TODBENCH_TRY(const auto text, read_text_file(file));
  TODBENCH_TRY(const auto table, parse_csv(text, file));
  const auto place = [&](const std::string& name) { return table.column(name).value_or(table.header.size()); };
  const std::size_t frequency = place("frequency_per_mrad"), value = place(column);
  if (std::max(frequency, value) >= table.header.size()) {
    return table.wrong(
        1, "expected the columns frequency_per_mrad and " + column + ", found " + quoted_list(table.header));
  }
  std::vector<CurvePoint> points;
  for (const auto& row : table.rows) {
    const auto f = parse_number(row.fields[frequency]), y = parse_number(row.fields[value]);
    if (!f || !y) return table.wrong(row.line, "expected two numbers");
    for (const auto& [number, allowed, name] :
         {std::tuple(*f, frequency_range, std::string("frequency_per_mrad")), std::tuple(*y, value_range, column)}) {
      if (!allowed.contains(number))
        return table.wrong(row.line, "column " + name + ": expected " + allowed.describe() + ", found " +
                                         number_text(number) + unit_hint(name, number, allowed));
    }
    points.push_back({*f, *y});
  }
  auto curve = LogLinearCurve::of(points, column);
  if (!curve) return fail(file, curve.error());
  if (falls(curve->points()))
    return table.wrong(2, "column " + column + " falls over its whole length, from " +
                              number_text(points.front().value) + " at " + number_text(points.front().frequency) +
                              " per mrad to " + number_text(points.back().value) + " at " +
                              number_text(points.back().frequency) +
                              " per mrad: a threshold that rises with frequency is expected; are the rows or the "
                              "columns exchanged?");
  return curve;
}

Result<void> read_curve(const std::string& file, const std::string& column, std::optional<LogLinearCurve>& into) {
  if (file.empty()) return {};
  TODBENCH_TRY(into, curve_from(file, column));
  return {};
}

Json criterion_json(const ModelRange& model) {
  return {{"name", model.criterion},
          {"value", model.criterion_value},
          {"probability_form", model.probability_form},
          {"origin", model.criterion_origin}};
}

/// Returns the ranges of the TTP model by both forms of P.
Json forms_json(const RangeSources& sources, const RangeQuestion& question, const ModelRange& ttp) {
  Json forms = Json::object();
  if (!ttp.r50_m) return forms;
  // V is that of the result: the forms differ only in x for a probability.
  for (const ProbabilityForm form : {ProbabilityForm::ttp_2004, ProbabilityForm::fixed_1_5}) {
    const auto ranges = ttp_ranges(sources, question, form);
    forms[std::string(to_string(form))] = {{"r50_m", json_number(ranges.r50_m)}, {"r75_m", json_number(ranges.r75_m)}};
  }
  return forms;
}

Json nominal_json(const NominalRanges& nominal) {
  return {{"preset", "nominal static range after STANAG 4347: 1, 3 and 6 cycles, 50 %"},
          {"size_m", nominal.size_m},
          {"delta_t_k", nominal.delta_t_k},
          {"extinction_per_km", nominal.extinction_per_km},
          {"detection_m", json_number(nominal.detection_m)},
          {"recognition_m", json_number(nominal.recognition_m)},
          {"identification_m", json_number(nominal.identification_m)}};
}

}  // namespace

void RangeOptions::add_to(CLI::App& command) {
  command.add_option("--atmosphere", atmosphere,
                     "atmosphere: clear, beer-lambert (with --extinction-per-km), us-standard, midlatitude-summer, "
                     "midlatitude-winter, subarctic-winter, tropical, FILE.csv or a MODTRAN tape7 file");
  command
      .add_option("--haze", haze,
                  "aerosol of the built-in atmospheres: none, rural-23km, rural-5km, maritime-23km or fog-0.5km")
      ->capture_default_str();
  command.add_option("--band", band, "spectral band LOW-HIGH of the atmosphere in um; default: the band of the sensor");
  command
      .add_option_function<std::string>(
          "--models",
          [this](const std::string& text) {
            auto found = models_from(text);
            if (!found) throw CLI::ValidationError("--models", found.error().message);
            models = *std::move(found);
          },
          "range models: tod, acquire, ttp, mtdp, several separated by commas, or all")
      ->default_str("tod");
  command.add_option("--sensor", sensor,
                     "sensor of the formula models: name or file; default: the sensor of the session");
  // From polar air (184 K) to furnaces; the sky that a surface reflects may be colder.
  const auto background = number_in(150, 2000, "k"), surroundings = number_in(50, 2000, "k"),
             air_temperature = number_in(150, 400, "k");
  command
      .add_option("--background-k", background_k,
                  "temperature of the background in K; the contrast is then computed as radiance")
      ->check(background);
  command.add_option("--emissivity", emissivity, "emissivity of target and background")
      ->check(number_in(1e-6, 1))
      ->capture_default_str();
  command
      .add_option("--surround-k", surround_k,
                  "radiation temperature of the reflected surroundings in K; default: that of the background")
      ->check(surroundings);
  command.add_option("--air-k", air_k, "temperature of the air in K; default: that of the model atmosphere")
      ->check(air_temperature);
  const auto positive = number_in(1e-6, 1e6);
  command
      .add_option("--n50", n50,
                  "N50 of ACQUIRE (2-D), in cycles: 0.75 for detection, 3 for recognition, 6 for identification")
      ->check(positive)
      ->capture_default_str();
  command
      .add_option("--mtdp-n50", mtdp_n50,
                  "N50 of the MTDP-like model, in cycles: 1 for detection, 3 for recognition, 6 for identification")
      ->check(positive)
      ->capture_default_str();
  command.add_option("--mrtd", mrtd_file, "CSV file with frequency_per_mrad and mrtd_k that replaces the MRTD formula");
  auto* mtdp = command.add_option("--mtdp", mtdp_file,
                                  "CSV file with frequency_per_mrad and mtdp_k that replaces the MTDP formula");
  command.add_option("--ctf", ctf_file,
                     "CSV file with frequency_per_mrad and ctf that replaces the CTF of eye and sensor");
  command
      .add_option(
          "--target-contrast", target_contrast,
          "luminance contrast of the target for TTP before the air; default: |dT| / (2 scene contrast). Behind the "
          "air the display shows at most 1")
      ->check(number_in(1e-9, 1000));
  command
      .add_option("--scene-contrast-k", formula.scene_contrast_k,
                  "scene contrast in K that corresponds to the mean luminance of the display")
      ->check(number_in(1e-3, 1000, "k"))
      ->capture_default_str();
  command
      .add_option("--snr-threshold", formula.snr_threshold, "signal-to-noise ratio at threshold in the MRTD formula")
      ->check(positive)
      ->capture_default_str();
  command
      .add_option("--eye-integration-s", formula.eye_integration_s,
                  "integration time of the eye in the MRTD formula, in s")
      ->check(number_in(1e-4, 10, "s"))
      ->capture_default_str();
  command
      .add_option("--extinction-u-percent", extinction_u_percent,
                  "relative standard uncertainty of the extinction in percent; it widens the intervals")
      ->check(number_in(0, 50))
      ->capture_default_str();
  command
      .add_option(
          "--curve-u-percent", curve_u_percent,
          "relative standard uncertainty of the MRTD, MTDP-like and CTF thresholds in percent; it widens the intervals")
      ->check(number_in(0, 50))
      ->capture_default_str();
  auto* turbulence =
      command.add_option("--cn2", cn2, "structure parameter Cn2 of the turbulence along the path in m^(-2/3)")
          ->check(number_in(0, 1e-11));
  command
      .add_option("--tolerance-percent", tolerance_percent,
                  "change of the acuity in percent below which the TOD model skips turbulence")
      ->check(number_in(0.01, 50))
      ->capture_default_str();
  command
      .add_option_function<std::string>(
          "--tod-transfer",
          [this](const std::string& name) {
            auto found = tod_transfer_named(name);
            if (!found) throw CLI::ValidationError("--tod-transfer", found.error().message);
            transfer = *found;
          },
          "transfer by which the TOD curve replaces the MTDP formula: " + std::string(tod_transfers().back().name))
      ->excludes(mtdp)
      ->excludes(turbulence);
  auto* sizes = command.add_option("--grid-sizes-m", grid.sizes_m, "target sizes of a grid in m, separated by commas")
                    ->delimiter(',')
                    ->check(number_in(1e-3, 1000, "m"));
  auto* contrasts =
      command
          .add_option("--grid-contrasts-k", grid.contrasts_k, "target contrasts of the grid in K, separated by commas")
          ->delimiter(',')
          ->check(number_in(-5000, 5000, "k"))
          ->needs(sizes);
  sizes->needs(contrasts);
  sizes->excludes(turbulence);
  command
      .add_option("--m75-u-percent", m75_u_percent,
                  "relative standard uncertainty of M75 in percent; it widens the interval of the TOD model")
      ->check(number_in(0, 50))
      ->excludes(turbulence)
      ->capture_default_str();
  command.add_option("--grid-ranges-m", grid.ranges_m, "ranges in m for which the grid gives P, separated by commas")
      ->delimiter(',')
      ->check(number_in(1e-3, 1e6, "m"))
      ->needs(sizes);
  command.add_option("--svg", svg, "writes the figure of P over range to this SVG file");
  command.add_option("--page", page, "writes figure, tables and assumptions to this HTML file");
}

bool RangeOptions::asks(RangeModel model) const {
  return std::find(models.begin(), models.end(), model) != models.end();
}

bool RangeOptions::has_table() const {
  return !atmosphere.empty() && atmosphere != "clear" && atmosphere != "beer-lambert";
}

Result<std::optional<SensorSpec>> RangeOptions::sensor_of(const std::optional<Session>& session) const {
  if (!sensor.empty()) {
    TODBENCH_TRY(auto loaded, load_sensor(sensor));
    return std::optional(std::move(loaded));
  }
  if (!session) return std::nullopt;
  SensorSpec spec = session->parts.sensor;
  spec.microscan = session->plan.simulation.microscan;
  return std::optional(std::move(spec));
}

Result<SpectralBand> RangeOptions::band_of(const std::optional<SensorSpec>& spec) const {
  if (band.empty()) return spec ? SpectralBand{spec->wavelength_min_um, spec->wavelength_max_um} : SpectralBand{};
  const auto dash = band.find('-');
  const auto low = parse_number(band.substr(0, dash));
  const auto high = dash == std::string::npos ? std::nullopt : parse_number(band.substr(dash + 1));
  if (!low || !high)
    return fail(ErrorCode::invalid_input,
                "--band: expected LOW-HIGH in um, for example 7.5-13, found '" + one_line(band) + "'");
  const SpectralBand found{*low, *high};
  if (auto valid = validate(found); !valid) return fail("--band", valid.error());
  return found;
}

Result<Atmosphere> RangeOptions::air(const std::optional<SensorSpec>& spec, double extinction_per_km) const {
  TODBENCH_TRY(const auto wavelengths, band_of(spec));
  const AtmosphereRequest request{.band = wavelengths,
                                  .haze = haze,
                                  .weight_temperature_k = spec ? spec->scene_temperature_k : 300,
                                  .extinction_per_km = extinction_per_km};
  auto found = load_atmosphere(atmosphere.empty() ? "beer-lambert" : atmosphere, request);
  if (!found) return fail("--atmosphere", found.error());
  return found;
}

RadiativeScene RangeOptions::scene(double delta_t_k, const Atmosphere& found) const {
  const double background = background_k.value_or(300);
  return {.target_k = background + delta_t_k,
          .background_k = background,
          .emissivity = emissivity,
          .surround_k = surround_k.value_or(background),
          .air_k = air_k.value_or(found.air_k.value_or(background))};
}

Result<double> RangeOptions::equivalent_contrast_k(double delta_t_k, const std::optional<SensorSpec>& spec,
                                                   const Atmosphere& found) const {
  // All temperatures are checked, even unused ones, to detect typing errors.
  TODBENCH_TRY_VOID(validate(scene(background_k ? delta_t_k : 0, found)));
  if (!background_k) return delta_t_k;
  TODBENCH_TRY(const auto wavelengths, band_of(spec));
  return todbench::equivalent_contrast_k(wavelengths, radiance_contrast(wavelengths, scene(delta_t_k, found)),
                                         spec ? spec->scene_temperature_k : 300);
}

RangeQuestion RangeOptions::question(const RangeTask& task, std::optional<double> v50, const Atmosphere& found) const {
  return {.size_m = task.size_m,
          .delta_t_k = task.delta_t_k,
          .m75 = task.m75,
          .criterion_source = criterion_source,
          .m75_u_percent = m75_u_percent,
          .m75_observer = m75_observer,
          .curve_observer = curve_observer,
          .n50 = n50,
          .mtdp_n50 = mtdp_n50,
          .v50 = v50.value_or(task.m75 / m75_from_v50(1)),
          .air = found,
          .extinction_u_percent = extinction_u_percent,
          .curve_u_percent = curve_u_percent,
          .formula = formula,
          .target_contrast = target_contrast};
}

Result<RangeSources> RangeOptions::sources(std::vector<TodThreshold> thresholds,
                                           const std::optional<SensorSpec>& spec) const {
  RangeSources found{.thresholds = std::move(thresholds), .sensor = spec, .transfer = transfer};
  TODBENCH_TRY_VOID(read_curve(mrtd_file, "mrtd_k", found.mrtd));
  TODBENCH_TRY_VOID(read_curve(mtdp_file, "mtdp_k", found.mtdp));
  TODBENCH_TRY_VOID(read_curve(ctf_file, "ctf", found.ctf));
  return found;
}

namespace {

/// Returns the figures of a grid of grid_json().
std::vector<GridFigure> figures_of(const Json& grids) {
  std::vector<GridFigure> figures;
  for (const auto& [name, found] : grids["models"].items()) {
    GridFigure figure{.model = name, .sizes_m = grids["sizes_m"], .contrasts_k = grids["contrasts_k"], .r75_m = {}};
    for (double& contrast_k : figure.contrasts_k) contrast_k = std::abs(contrast_k);
    for (const auto& row : found["r75_m"]) {
      for (const auto& r75_m : row)
        figure.r75_m.push_back(r75_m.is_null() ? std::nullopt : std::optional(r75_m.get<double>()));
    }
    figures.push_back(std::move(figure));
  }
  return figures;
}

}  // namespace

Result<void> RangeOptions::write(const std::vector<ModelRange>& answers, const RangeQuestion& question,
                                 const std::vector<std::string>& said, const Json& grids) const {
  if (!svg.empty()) {
    TODBENCH_TRY(const auto figure, range_svg(answers));
    TODBENCH_TRY_VOID(write_file_atomically(svg, figure));
  }
  if (page.empty()) return {};
  RangePage words{.target = fmt::format("{:g} m, {:.4g} K", question.size_m, question.delta_t_k),
                  .air = question.air.source,
                  .notes = question.air.notes};
  words.notes.insert(words.notes.end(), said.begin(), said.end());
  Document document = range_page(answers, words);
  if (!grids.is_null()) document.sections.push_back(grid_section(figures_of(grids)));
  return write_file_atomically(page, render_html(document));
}

namespace {

/// Returns values as nested lists, the last dimension innermost.
Json nested(const std::vector<std::optional<double>>& values, std::size_t outer, std::size_t inner) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < outer; ++i) {
    Json row = Json::array();
    for (std::size_t k = 0; k < inner; ++k) row.push_back(json_number(values[i * inner + k]));
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

Result<Json> RangeOptions::grid_json(const RangeSources& sources, const RangeQuestion& question,
                                     const std::optional<SensorSpec>& spec) const {
  if (grid.sizes_m.empty()) return Json();
  RangeGridAxes axes = grid;
  for (double& contrast_k : axes.contrasts_k) {
    TODBENCH_TRY(contrast_k, equivalent_contrast_k(contrast_k, spec, question.air));
  }
  TODBENCH_TRY(const auto grids, range_grid(models, sources, question, axes));
  const std::size_t sizes = axes.sizes_m.size(), contrasts = axes.contrasts_k.size();
  Json by_model = Json::object();
  for (const auto& found : grids) {
    const Json flat = nested(found.probability, sizes * contrasts, axes.ranges_m.size());
    Json probability = Json::array();
    for (std::size_t s = 0; s < sizes; ++s) {
      Json row = Json::array();
      for (std::size_t c = 0; c < contrasts; ++c) row.push_back(flat[s * contrasts + c]);
      probability.push_back(std::move(row));
    }
    by_model[std::string(to_string(found.model))] = {{"r75_m", nested(found.r75_m, sizes, contrasts)},
                                                     {"probability", probability}};
  }
  return Json{
      {"sizes_m", grid.sizes_m}, {"contrasts_k", grid.contrasts_k}, {"ranges_m", grid.ranges_m}, {"models", by_model}};
}

Json atmosphere_json(const Atmosphere& air, const RangeTask& task, std::optional<double> r75_m,
                     const RangeOptions& options, const std::optional<SensorSpec>& sensor) {
  Json json{{"name", air.name},
            {"source", air.source},
            {"air_k", json_number(options.air_k ? options.air_k : air.air_k)},
            {"end_m", json_number(air.air.end_m())},
            {"equivalent_contrast_k", task.delta_t_k},
            {"transmittance_at_r75", json_number(r75_m ? air.air.at(*r75_m) : std::nullopt)},
            {"apparent_background_at_r75_k", nullptr},
            {"apparent_contrast_at_r75_k", nullptr},
            {"notes", air.notes}};
  const auto band = options.band_of(sensor);
  if (!r75_m || !options.background_k || !band) return json;
  const auto tau = air.air.at(*r75_m);
  // Uses the target's own contrast: that of the task is at the scale of the NETD.
  const double target_contrast_k = options.asked_delta_t_k;
  const auto shown = tau ? apparent_temperatures(*band, options.scene(target_contrast_k, air), *tau) : std::nullopt;
  if (!shown) return json;
  json["apparent_background_at_r75_k"] = json_number(shown->background_k);
  json["apparent_contrast_at_r75_k"] = json_number(shown->contrast_k());
  return json;
}

Json models_json(const std::vector<ModelRange>& models, const RangeSources& sources, const RangeQuestion& question,
                 std::optional<double> twin_r75_m) {
  Json json = Json::object();
  for (const auto& model : models) {
    Json curve = Json::array();
    for (const auto& point : model.curve)
      curve.push_back({{"range_m", point.range_m}, {"probability", json_number(point.probability)}});
    const auto limit = model.dominant();
    Json entry{{"r75_m", json_number(model.r75_m)},
               {"r75_ci95_m", json_interval(model.r75_ci95_m)},
               {"r50_m", json_number(model.r50_m)},
               {"criterion", criterion_json(model)},
               {"dominant_limit", limit ? Json(to_string(*limit)) : Json()},
               {"sensitivity_to_size",
                json_number(model.sensitivity ? std::optional(model.sensitivity->to_size) : std::nullopt)},
               {"sensitivity_to_contrast",
                json_number(model.sensitivity ? std::optional(model.sensitivity->to_contrast) : std::nullopt)},
               {"reads", model.reads},
               {"display", model.display},
               {"reason", model.reason.empty() ? Json() : Json(model.reason)},
               {"notes", model.notes},
               {"curve", curve}};
    if (model.name == "tod") {
      add_spread(entry, "r75_spread_m", model.r75_spread_m);
      entry["twin_r75_m"] = json_number(twin_r75_m);
      entry["ratio_to_twin"] =
          json_number(twin_r75_m && model.r75_m ? std::optional(*model.r75_m / *twin_r75_m) : std::nullopt);
    }
    if (model.name == "ttp") entry["forms"] = forms_json(sources, question, model);
    if (model.name == "mtdp") {
      const auto nominal = nominal_ranges(sources, question);
      entry["nominal_target"] = nominal ? nominal_json(*nominal) : Json();
    }
    json[model.name] = std::move(entry);
  }
  return json;
}

void print_grid(Console& console, const Json& grid) {
  for (const auto& [name, found] : grid["models"].items()) {
    TableRow header{"size [m]"};
    for (const auto& contrast_k : grid["contrasts_k"]) header.push_back(number_text(contrast_k) + " K");
    std::vector<TableRow> rows;
    for (std::size_t s = 0; s < grid["sizes_m"].size(); ++s) {
      TableRow row{number_text(grid["sizes_m"][s])};
      for (const auto& r75_m : found["r75_m"][s])
        row.push_back(fixed(r75_m.is_null() ? std::nullopt : std::optional<double>(r75_m), 1));
      rows.push_back(std::move(row));
    }
    console.text("");
    console.text("R75 in m by size and contrast, " + name);
    console.table(header, rows);
  }
}

void print_models(Console& console, const std::vector<ModelRange>& models) {
  std::vector<TableRow> rows;
  for (const auto& model : models) {
    const auto limit = model.dominant();
    rows.push_back({model.title, model.criterion + " = " + number_text(model.criterion_value), model.probability_form,
                    fixed(model.r50_m, 1), fixed(model.r75_m, 1), range(model.r75_ci95_m, 1),
                    limit ? std::string(to_string(*limit)) : "–"});
  }
  console.text("");
  console.table({"model", "criterion", "form of P", "R50 [m]", "R75 [m]", "95 %", "limited by"}, rows);
  for (const auto& model : models) {
    console.text(model.title + " uses " + model.reads);
    console.text(model.title + ", " + model.criterion + ": " + model.criterion_origin);
    console.text(model.title + ", display: " + model.display);
    if (model.r75_spread_m) console.text(model.title + ", R75: " + spread_in_words(*model.r75_spread_m, "m"));
    if (!model.reason.empty()) console.text(model.title + ": " + model.reason);
    for (const auto& sentence : model.notes) console.note(model.title + ": " + sentence);
  }
}

}  // namespace todbench
