// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/session_presenter.h"

#include <QRegularExpression>
#include <algorithm>
#include <system_error>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/gui/presenters/pdf_report.h"
#include "bench/gui/presenters/text_of.h"
#include "bench/judgement/verdict_record.h"
#include "bench/plan/strict_toml.h"
#include "bench/report/tod_figures.h"
#include "bench/run/rebuild_report.h"
#include "bench/run/recorded_bench.h"
#include "bench/run/report_data.h"
#include "bench/session/open_session.h"
#include "bench/session/session_comparison.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

/// The name without "session-" and the time, which has a separate column.
QString short_name(const QString& session) {
  static const QRegularExpression stamp("^session-[0-9]{8}T[0-9]{6}Z-");
  return QString(session).remove(stamp);
}

/// The unit under test as named in the plan.
QString unit_of(const std::filesystem::path& folder) {
  const auto text = read_text_file(folder / "session.toml");
  if (!text) return {};
  auto reader = TomlReader::parse(*text, "session.toml");
  return reader ? QString::fromStdString(reader->text("unit", "")) : QString();
}

/// Whether the manifest lists the files of the displayed columns; the others are checked when the session is opened.
bool shown_files_listed(const std::filesystem::path& folder) {
  std::error_code none;
  for (const char* file : {"provenance.json", "session.toml", "verdict.json"}) {
    if (std::filesystem::exists(folder / file, none) && !is_listed(folder, file).value_or(false)) return false;
  }
  return true;
}

QString verdict_of(const std::filesystem::path& folder) {
  const auto text = read_text_file(folder / "verdict.json");
  if (!text || !is_listed(folder, "verdict.json").value_or(false)) return {};
  const Json json = Json::parse(*text, nullptr, false);
  if (json.is_discarded()) return {};
  const auto verdict = verdict_from(json);
  if (!verdict) return {};
  return text_of(decision_word(*verdict));
}

Result<SessionEntry> entry_of(const std::filesystem::path& folder) {
  TODBENCH_TRY(const auto text, read_text_file(folder / "provenance.json"));
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded())
    return fail(ErrorCode::invalid_input, folder.string() + ": provenance.json is not valid JSON");
  TODBENCH_TRY(auto provenance, provenance_from(json));
  SessionEntry entry;
  entry.folder = folder;
  entry.name = short_name(QString::fromStdString(session_name(folder)));
  entry.when = QString::fromStdString(provenance.started_utc).replace('T', ' ').remove('Z');
  const bool cut_off = provenance.state == SessionState::running;
  entry.state = cut_off || shown_files_listed(folder) ? text_of(to_string(provenance.state)) : "changed";
  entry.unit = unit_of(folder);
  if (provenance.camera) {
    if (entry.unit.isEmpty()) entry.unit = QString::fromStdString(provenance.camera->model);
    entry.serial = QString::fromStdString(provenance.camera->serial);
  } else {
    entry.unit = "simulation";
  }
  if (entry.state == "complete") entry.verdict = verdict_of(folder);
  return entry;
}

}  // namespace

std::vector<SessionEntry> matching(const std::vector<SessionEntry>& sessions, const QString& filter) {
  const QStringList words = filter.split(' ', Qt::SkipEmptyParts);
  std::vector<SessionEntry> out;
  for (const SessionEntry& s : sessions) {
    const QString all = QStringList{s.serial, s.unit, s.name, s.when, s.verdict, s.state}.join(' ');
    if (std::all_of(words.begin(), words.end(),
                    [&](const QString& word) { return all.contains(word, Qt::CaseInsensitive); }))
      out.push_back(s);
  }
  return out;
}

Result<Exported> export_reports(const OpenedSession& opened, const std::optional<std::filesystem::path>& order) {
  // The files may have changed since the session was opened.
  if (!opened.session.cut_off) {
    TODBENCH_TRY_VOID(require_intact(opened.folder));
  }
  const auto pdf = opened.folder / "report.pdf";
  PageWriter write_both = [&](const ReportData& data) -> Result<std::vector<std::string>> {
    auto pages = html_page(opened.folder)(data);
    if (!pages) return pages;
    TODBENCH_TRY_VOID(write_pdf_report(data, pdf));
    pages->emplace_back("report.pdf");
    return pages;
  };
  if (order) {
    TODBENCH_TRY(write_both, with_order(opened.folder, *order, std::move(write_both)));
  }
  TODBENCH_TRY_VOID(rebuild_report(opened.session, opened.folder, write_both));
  return Exported{QString::fromStdString((opened.folder / "report.html").string()),
                  QString::fromStdString(pdf.string())};
}

Result<OpenedSession> read_opened_session(const std::filesystem::path& folder) {
  TODBENCH_TRY(auto session, open_session(folder, {.accept_changed = false, .accept_cut_off = true}));
  TODBENCH_TRY(auto data, report_data_of(session, folder));
  TODBENCH_TRY(auto human, read_human(folder));
  std::error_code none;
  const bool recorded = std::filesystem::exists(recorded_frames(folder), none);
  auto bill = bill_of(data);
  return OpenedSession{folder,
                       QString::fromStdString(session_name(folder)),
                       std::move(session),
                       std::move(data),
                       std::move(human),
                       recorded,
                       std::move(bill)};
}

std::vector<SessionEntry> sessions_below(const std::filesystem::path& folder) {
  std::vector<SessionEntry> out;
  std::error_code problem;
  for (const auto& child : std::filesystem::directory_iterator(folder, problem)) {
    if (!std::filesystem::exists(child.path() / "session.toml", problem)) continue;
    if (auto entry = entry_of(child.path())) out.push_back(*std::move(entry));
  }
  std::sort(out.begin(), out.end(), [](const SessionEntry& a, const SessionEntry& b) {
    return std::pair(b.when, b.name) < std::pair(a.when, a.name);
  });
  return out;
}

SessionPresenter::SessionPresenter(Workbench& bench, QObject* parent) : QObject(parent), bench_(bench) {}

template <typename T>
void SessionPresenter::in_background(std::function<Result<T>()> work, std::function<void(Result<T>)> done) {
  jobs_.queue([this, work = std::move(work), done = std::move(done)](const std::stop_token&) {
    bench_.post([this, result = work(), done] {
      if (!result) emit problem(QString::fromStdString(result.error().message));
      done(result);
    });
  });
}

void SessionPresenter::refresh() {
  list_jobs_.start([this, folder = bench_.sessions_folder()](const std::stop_token&) {
    bench_.post([this, found = sessions_below(folder)] {
      sessions_ = found;
      emit listed();
    });
  });
}

void SessionPresenter::open(const std::filesystem::path& folder) {
  ++opening_;
  compare_when_opened_.reset();
  in_background<OpenedSession>([folder] { return read_opened_session(folder); },
                               [this](Result<OpenedSession> session) {
                                 const bool last = --opening_ == 0;
                                 const bool read = session.has_value();
                                 if (read) {
                                   current_ = *std::move(session);
                                   compared_.reset();
                                   emit opened();
                                 }
                                 if (!last || !compare_when_opened_) return;
                                 const auto other = *std::exchange(compare_when_opened_, std::nullopt);
                                 if (read) compare(other);
                               });
}

void SessionPresenter::open_and_export(const std::filesystem::path& folder) {
  open(folder);
  // The jobs run in the order of the requests: this one reads what the first one has checked.
  in_background<Exported>(
      [folder]() -> Result<Exported> {
        TODBENCH_TRY(const auto opened, read_opened_session(folder));
        return todbench::export_reports(opened);
      },
      [this](const Result<Exported>& files) {
        if (files) emit exported(files->html, files->pdf);
      });
}

void SessionPresenter::compare_with(const std::filesystem::path& other) {
  if (opening_ > 0) {
    compare_when_opened_ = other;
  } else if (current_) {
    compare(other);
  }
}

void SessionPresenter::compare(const std::filesystem::path& other) {
  if (!current_->session.curve) {
    emit problem(current_->name + ": the session contains no TOD curve and cannot be compared");
    return;
  }
  in_background<ComparedSessions>(
      [name = current_->name, a = current_->session, other]() -> Result<ComparedSessions> {
        TODBENCH_TRY(const auto b, open_session(other, {}));
        auto compared = compare_sessions(a, b, std::nullopt);
        if (!compared) return fail(other.string(), compared.error());
        return ComparedSessions{name, QString::fromStdString(session_name(other)), std::move(compared->a),
                                std::move(compared->b), std::move(compared->comparison)};
      },
      [this](Result<ComparedSessions> sessions) {
        if (!sessions) return;
        compared_ = *std::move(sessions);
        emit compared();
      });
}

void SessionPresenter::export_reports() {
  if (!current_) return;
  in_background<Exported>([opened = *current_] { return todbench::export_reports(opened); },
                          [this](const Result<Exported>& files) {
                            if (files) emit exported(files->html, files->pdf);
                          });
}

void SessionPresenter::export_with_order(const std::filesystem::path& order) {
  if (!current_) return;
  in_background<Exported>([opened = *current_, order] { return todbench::export_reports(opened, order); },
                          [this](const Result<Exported>& files) {
                            if (files) emit exported(files->html, files->pdf);
                          });
}

void SessionPresenter::use_plan_again() {
  if (current_) bench_.set_plan(current_->session.plan);
}

Plot SessionPresenter::tod_figure(AxisScale acuity_axis) const {
  if (compared_) {
    return with_acuity_axis(todbench::tod_figure({compared_->a.toStdString(), &compared_->curve_a},
                                                 {compared_->b.toStdString(), &compared_->curve_b}, {}),
                            acuity_axis);
  }
  if (!current_) return {};
  return with_acuity_axis(tod_plot(current_->report), acuity_axis);
}

}  // namespace todbench
