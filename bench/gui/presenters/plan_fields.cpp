#include "bench/gui/presenters/plan_fields.h"

#include <QStringList>
#include <utility>

namespace todbench {
namespace {

QString number_text(double value) {
  return QString::number(value, 'g', 8);
}

QString numbers_text(const std::vector<double>& values) {
  QStringList texts;
  for (const double value : values) texts << number_text(value);
  return texts.join(", ");
}

QString text_of(std::string_view text) {
  return QString::fromUtf8(text.data(), static_cast<qsizetype>(text.size()));
}

QString not_a_number(const QString& text) {
  return "'" + text + "' is not a number";
}

/// Numbers separated by commas.
QString read_numbers(const QString& text, std::vector<double>& into) {
  std::vector<double> values;
  for (const QString& part : text.split(',', Qt::SkipEmptyParts)) {
    bool good = false;
    values.push_back(part.trimmed().toDouble(&good));
    if (!good) return not_a_number(part.trimmed());
  }
  into = values;
  return {};
}

std::vector<std::string> words_of(const QString& text) {
  std::vector<std::string> words;
  for (const QString& part : text.split(',', Qt::SkipEmptyParts)) words.push_back(part.trimmed().toStdString());
  return words;
}

QString acuity_limits_text(const LimitsPlan& limits) {
  QStringList texts;
  for (const auto& limit : limits.acuity)
    texts << number_text(limit.delta_t_k) + ": " + number_text(limit.least_acuity_per_mrad);
  return texts.join(", ");
}

QString read_acuity_limits(const QString& text, LimitsPlan& limits) {
  std::vector<AcuityLimit> out;
  for (const QString& part : text.split(',', Qt::SkipEmptyParts)) {
    const QStringList sides = part.split(':');
    bool first = false, second = false;
    AcuityLimit limit;
    if (sides.size() == 2) {
      limit.delta_t_k = sides[0].toDouble(&first);
      limit.least_acuity_per_mrad = sides[1].toDouble(&second);
    }
    if (!first || !second) return "'" + part.trimmed() + "' is not 'contrast: least acuity'";
    out.push_back(limit);
  }
  limits.acuity = out;
  return {};
}

using Shown = std::function<QString(const Plan&)>;
using Entered = std::function<QString(Plan&, const QString&)>;

PlanField number_field(QString label, QString name, std::function<double&(Plan&)> place) {
  const Shown shown = [place](const Plan& plan) {
    Plan copy = plan;
    return number_text(place(copy));
  };
  const Entered entered = [place](Plan& plan, const QString& text) {
    bool good = false;
    const double value = text.toDouble(&good);
    if (good) place(plan) = value;
    return good ? QString() : not_a_number(text);
  };
  return {std::move(label), std::move(name), shown, entered};
}

PlanField text_field(QString label, QString name, std::function<std::string&(Plan&)> place) {
  const Shown shown = [place](const Plan& plan) {
    Plan copy = plan;
    return QString::fromStdString(place(copy));
  };
  const Entered entered = [place](Plan& plan, const QString& text) {
    place(plan) = text.toStdString();
    return QString();
  };
  return {std::move(label), std::move(name), shown, entered};
}

QString plates_text(const Plan& plan) {
  QStringList names;
  for (const auto& plate : plan.target.plates) names << QString::fromStdString(plate);
  return names.join(", ");
}

QString read_plates(Plan& plan, const QString& text) {
  plan.target.plates = words_of(text);
  return {};
}

QString mountings_text(const Plan& plan) {
  QStringList names;
  for (const auto mounting : plan.target.mountings) names << text_of(to_string(mounting));
  return names.join(", ");
}

QString read_mountings(Plan& plan, const QString& text) {
  std::vector<Mounting> mountings;
  for (const auto& word : words_of(text)) {
    const auto mounting = mounting_from(word);
    if (!mounting) return "'" + QString::fromStdString(word) + "' is no mounting";
    mountings.push_back(*mounting);
  }
  plan.target.mountings = mountings;
  return {};
}

QString read_phases(Plan& plan, const QString& text) {
  bool good = false;
  const int value = text.toInt(&good);
  if (good) plan.target.phases = value;
  return good ? QString() : not_a_number(text);
}

QString margin_text(const Plan& plan) {
  const auto margin = plan.limits.equivalence_margin_percent;
  return margin ? number_text(*margin) : QString();
}

QString read_margin(Plan& plan, const QString& text) {
  bool good = false;
  const double value = text.toDouble(&good);
  if (text.isEmpty()) plan.limits.equivalence_margin_percent.reset();
  if (good) plan.limits.equivalence_margin_percent = value;
  return good || text.isEmpty() ? QString() : not_a_number(text);
}

QString read_record(Plan& plan, const QString& text) {
  if (text != "yes" && text != "no") return "'" + text + "' is neither yes nor no";
  plan.measurement.record_frames = text == "yes";
  return {};
}

}  // namespace

std::vector<PlanField> plan_fields() {
  return {
      text_field("Name", "planName", [](Plan& p) -> std::string& { return p.name; }),
      text_field("Operator", "planOperator", [](Plan& p) -> std::string& { return p.operator_name; }),
      text_field("Place", "planPlace", [](Plan& p) -> std::string& { return p.place; }),
      text_field("Unit under test", "planUnit", [](Plan& p) -> std::string& { return p.unit; }),
      text_field("Camera", "planCamera", [](Plan& p) -> std::string& { return p.camera.id; }),
      number_field("IFOV of a pixel (mrad)", "planIfov", [](Plan& p) -> double& { return p.camera.ifov_mrad; }),
      number_field("Correct camera every (s), 0: never", "planNuc",
                   [](Plan& p) -> double& { return p.camera.nuc_interval_s; }),
      number_field("Distance to plate (m)", "planDistance", [](Plan& p) -> double& { return p.target.distance_m; }),
      {"Plates", "planPlates", plates_text, read_plates},
      {"Contrasts ΔT (K)", "planContrasts", [](const Plan& p) { return numbers_text(p.target.delta_t_k); },
       [](Plan& p, const QString& text) { return read_numbers(text, p.target.delta_t_k); }},
      {"Mountings", "planMountings", mountings_text, read_mountings},
      {"Phases (sub-pixel shifts)", "planPhases", [](const Plan& p) { return QString::number(p.target.phases); },
       read_phases},
      text_field("Observer", "planObserver", [](Plan& p) -> std::string& { return p.observer; }),
      text_field("Simulated sensor", "planSensor", [](Plan& p) -> std::string& { return p.simulation.sensor; }),
      text_field("Accuracy: draft, normal, reference", "planAccuracy",
                 [](Plan& p) -> std::string& { return p.simulation.accuracy; }),
      {"Limits, ΔT (K): least acuity (1/mrad)", "planLimits",
       [](const Plan& p) { return acuity_limits_text(p.limits); },
       [](Plan& p, const QString& text) { return read_acuity_limits(text, p.limits); }},
      {"Equivalence margin (%), empty: none", "planMargin", margin_text, read_margin},
      {"Keep frames, for a replay: yes, no", "planRecord",
       [](const Plan& p) { return QString(p.measurement.record_frames ? "yes" : "no"); }, read_record},
      text_field("Notes", "planNotes", [](Plan& p) -> std::string& { return p.notes; }),
  };
}

}  // namespace todbench
