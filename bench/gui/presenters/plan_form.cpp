// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/plan_form.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

namespace todbench {
namespace {

std::optional<std::size_t> line_of(const std::vector<PlanField>& fields, const std::string& path) {
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const auto& paths = fields[i].paths;
    if (std::find(paths.begin(), paths.end(), path) != paths.end()) return i;
  }
  return std::nullopt;
}

}  // namespace

PlanForm::PlanForm(const Plan& plan) : fields_(plan_fields()), lines_(fields_.size()) {
  reset(plan);
}

QString PlanForm::text(std::size_t i) const {
  return lines_[i].unreadable.isNull() ? fields_[i].shown(draft_) : lines_[i].unreadable;
}

bool PlanForm::right() const {
  return others_.isEmpty() &&
         std::all_of(lines_.begin(), lines_.end(), [](const Line& line) { return line.problem.isEmpty(); });
}

bool PlanForm::changed() const {
  return draft_ != base_ ||
         std::any_of(lines_.begin(), lines_.end(), [](const Line& line) { return !line.unreadable.isNull(); });
}

void PlanForm::enter(std::size_t i, const QString& text) {
  Line& line = lines_[i];
  line.entered = true;
  const QString wrong = fields_[i].entered(draft_, text.trimmed());
  // A null text means no error; an empty one may be an entered text.
  line.unreadable = wrong.isEmpty() ? QString() : text.isNull() ? QString("") : text;
  line.problem = wrong;
  judge();
}

void PlanForm::judge() {
  others_.clear();
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    if (lines_[i].unreadable.isNull()) lines_[i].problem.clear();
  }
  for (const PlanMistake& mistake : mistakes_in(draft_)) {
    if (const auto i = line_of(fields_, path_of(*mistake.at.section, *mistake.at.key))) {
      if (lines_[*i].problem.isEmpty()) lines_[*i].problem = QString::fromStdString(mistake.mistake.sentence);
    } else {
      others_ << QString::fromStdString(error_of(mistake).message);
    }
  }
}

void PlanForm::refused(const Error& error) {
  const auto i = error.key ? line_of(fields_, error.key->name) : std::nullopt;
  if (i) {
    lines_[*i].problem = QString::fromStdString(error.key->reason);
  } else {
    others_ << QString::fromStdString(error.message);
  }
}

void PlanForm::reset(const Plan& plan) {
  base_ = draft_ = plan;
  lines_.assign(fields_.size(), Line{});
  judge();
}

void PlanForm::rebase(const Plan& plan) {
  std::vector<std::pair<std::size_t, QString>> entered;
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    if (lines_[i].entered && text(i) != fields_[i].shown(base_)) entered.emplace_back(i, text(i));
  }
  reset(plan);
  for (const auto& [i, text] : entered) {
    if (text != fields_[i].shown(plan)) enter(i, text);
  }
}

}  // namespace todbench
