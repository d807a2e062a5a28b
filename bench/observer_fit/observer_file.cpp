// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/observer_fit/observer_file.h"

#include <fmt/format.h>

#include "bench/session/build_info.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

/// A basic string of TOML.
std::string toml_text(std::string_view text) {
  std::string out = "\"";
  for (const char c : one_line(text)) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

/// With a point or an exponent, so that TOML reads a float.
std::string decimal(double value) {
  const std::string text = number_text(value);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

std::string parameter(const PeopleFit& fit, std::size_t k) {
  std::string text = "\n[[fit.parameter]]\nname = " + toml_text(fit.options.parameter(k)) +
                     "\nvalue = " + decimal(fit.values[k]) + "\n";
  if (fit.ci95[k].low) text += "ci95_low = " + decimal(*fit.ci95[k].low) + "\n";
  if (fit.ci95[k].high) text += "ci95_high = " + decimal(*fit.ci95[k].high) + "\n";
  if (fit.spread[k].between_sd) {
    text += "between_sd = " + decimal(*fit.spread[k].between_sd) + "  # standard deviation between people, of " +
            (all_observer_keys[k] == ObserverKey::lapse ? "the value" : "its logarithm") + "\n";
  }
  return text;
}

std::string correlations(const PeopleFitOptions& options, const PersonFit& fit) {
  std::string text;
  for (std::size_t a = 0; a < observer_key_count; ++a) {
    for (std::size_t b = a + 1; b < observer_key_count; ++b) {
      if (const auto r = correlation(fit, a, b)) {
        text += "\n[[fit.correlation]]\nof = [" + toml_text(options.parameter(a)) + ", " +
                toml_text(options.parameter(b)) + "]\nvalue = " + decimal(*r) + "\n";
      }
    }
  }
  return text;
}

std::string eye_text(const TemplateObserverSpec& spec) {
  const EyeParameters& eye = *spec.eye;
  return fmt::format(
      "window_margin_arcmin = {}\n\n[eye]\nsensitivity = {}\nphoton_noise_td = {}\ninhibition_per_degree = "
      "{}\ncritical_cycles = {}\narea_exponent = {}\nuncertainty_channels = {}\ncontrast_noise = {}\nage_years = "
      "{}\nfield_deg2 = {}\n",
      decimal(spec.window_margin_arcmin), decimal(eye.sensitivity), decimal(eye.photon_noise_td),
      decimal(eye.inhibition_per_degree), decimal(eye.critical_cycles), decimal(eye.area_exponent),
      decimal(eye.uncertainty_channels), decimal(eye.contrast_noise), decimal(eye.age_years), decimal(eye.field_deg2));
}

}  // namespace

std::string observer_file(const PeopleFit& fit) {
  const TemplateObserverSpec spec = fitted_observer(fit);
  std::size_t answers = 0;
  for (const FittedPerson& person : fit.people) answers += person.fit.answers;
  std::string free;
  for (std::size_t k = 0; k < observer_key_count; ++k) {
    if (fit.options.free[k]) free += (free.empty() ? "" : ", ") + toml_text(fit.options.parameter(k));
  }
  std::string text = fmt::format(
      "# Template observer fitted to {} answers of {} by todbench observer fit. Its parameters suit these people "
      "best\n# under these conditions. It is not a model of people in general.\nname = {}\n\n",
      answers, fit.people.size() == 1 ? "one person" : fmt::format("{} people", fit.people.size()),
      toml_text(spec.name));
  if (!spec.eye) {
    text += fmt::format("blur_sigma_samples = {}\ninternal_noise = {}\n", decimal(spec.blur_sigma_samples),
                        decimal(spec.internal_noise));
  }
  text += fmt::format(
      "sensor_noise_factor = {}\nsearch_range_samples = {}\nsearch_step_samples = {}\nwindow_size_factor = "
      "{}\nwindow_margin_pitch = {}\n",
      decimal(spec.sensor_noise_factor), decimal(spec.search_range_samples), decimal(spec.search_step_samples),
      decimal(spec.window_size_factor), decimal(spec.window_margin_pitch));
  if (spec.eye) text += eye_text(spec);
  const BuildInfo info = build_info();
  text += fmt::format(
      "\n[fit]\nschema = \"todbench-observer-fit-1\"\nprogram = {}\nfrom = {}\nfrom_sha256 = {}\nfree = [{}]\n"
      "persons = {}\nanswers = {}\nlapse = {}\nleast_model_p = {}\nseed = {}\ndraws = {}\n",
      toml_text(std::string(info.version) + " " + std::string(info.commit)), toml_text(fit.options.from.name),
      toml_text(fit.options.from_sha256), free, fit.people.size(), answers,
      decimal(fit.values[static_cast<std::size_t>(ObserverKey::lapse)]), decimal(fit.least_p), fit.options.seed,
      fit.options.draws);
  for (std::size_t k = 0; k < observer_key_count; ++k) {
    if (fit.options.free[k]) text += parameter(fit, k);
  }
  if (fit.people.size() == 1) text += correlations(fit.options, fit.people.front().fit);
  for (std::size_t p = 0; p < fit.people.size(); ++p) {
    for (const std::size_t s : fit.people[p].sessions) {
      const AnsweredSession& session = fit.sessions[s];
      text += fmt::format(
          "\n[[fit.session]]\nfolder = {}\nperson = {}\nanswers = {}\nmanifest_sha256 = {}\nshown_sha256 = {}\n",
          toml_text(session.folder), p + 1, session.human.trials.size(), toml_text(session.manifest_sha256),
          toml_text(session.shown_sha256));
      if (!session.person.empty()) text += "person_code = " + toml_text(session.person) + "\n";
    }
  }
  return text;
}

}  // namespace todbench
