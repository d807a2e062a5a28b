// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/rebuild_report.h"

#include <utility>

#include "acquisition/base/try.h"
#include "bench/plan/order.h"
#include "bench/report/report_csv.h"
#include "bench/run/report_data.h"
#include "bench/session/bars_people.h"
#include "bench/session/foreign_files.h"
#include "bench/session/human_record.h"
#include "bench/session/manifest.h"
#include "bench/session/signature.h"
#include "bench/text/files.h"
#include "bench/text/folders.h"
#include "bench/text/text.h"

namespace todbench {

Result<ReportData> report_data_of(const Session& session, const std::filesystem::path& folder) {
  auto data = report_data(session, session_name(folder));
  if (!data) return data;
  TODBENCH_TRY(auto people, read_people(folder));
  for (PersonRecord& person : people) {
    person.record.trials.clear();
    person.record.shown.clear();
  }
  if (!people.empty()) data->human = people.front().record.curve;
  data->people = std::move(people);
  TODBENCH_TRY(data->bars_people, read_bars_sittings(folder));
  TODBENCH_TRY(auto letterhead, kept_letterhead(folder));
  if (letterhead) data->letterhead = std::move(letterhead);
  std::error_code none;
  if (std::filesystem::exists(folder / order_file, none)) {
    TODBENCH_TRY(data->order, load_order(folder / order_file));
  }
  return data;
}

Result<ReportData> rebuild_report(const Session& session, const std::filesystem::path& folder,
                                  const PageWriter& write_pages) {
  TODBENCH_TRY_VOID(require_unsigned(folder));
  const bool vouched_for = session.accepted_changes.empty() && !session.cut_off;
  // Accepting changed files includes added ones; links are never accepted.
  TODBENCH_TRY_VOID(vouched_for ? require_no_foreign_file(folder) : require_no_links(folder));
  auto data = report_data_of(session, folder);
  if (!data) return data;
  if (vouched_for && !session.verdict) {
    TODBENCH_TRY_VOID(keep_verdict(folder, *data->verdict));
    TODBENCH_TRY(data->manifest_sha256, manifest_digest(folder));
  }
  TODBENCH_TRY(const auto pages, write_pages(*data));
  if (!vouched_for) return data;
  TODBENCH_TRY_VOID(refresh_manifest(folder, pages));
  return data;
}

Result<ReportData> revise_report(const Session& session, const std::filesystem::path& folder, const std::string& reason,
                                 const std::string& utc, const std::filesystem::path& secret_key,
                                 const std::stop_token& stop) {
  TODBENCH_TRY(auto revision, next_revision(folder, reason, utc));
  TODBENCH_TRY_VOID(require_no_foreign_file(folder));
  TODBENCH_TRY_VOID(require_key_of_session(folder, secret_key, stop));
  auto data = report_data_of(session, folder);
  if (!data) return data;
  data->revision = revision;
  TODBENCH_TRY_VOID(make_folder(folder / "revisions"));
  std::vector<std::string> pages;
  for (const auto& [extension, text] :
       {std::pair(std::string("html"), render_report(*data)), std::pair(std::string("csv"), report_csv(*data))}) {
    pages.push_back(revision_page(revision, extension));
    TODBENCH_TRY_VOID(write_file_atomically(folder / pages.back(), text));
  }
  TODBENCH_TRY_VOID(keep_revision(folder, revision, pages, secret_key, stop));
  return data;
}

PageWriter html_page_with(std::filesystem::path folder, Letterhead letterhead) {
  return [folder = std::move(folder),
          letterhead = std::move(letterhead)](const ReportData& data) -> Result<std::vector<std::string>> {
    ReportData with = data;
    with.letterhead = letterhead;
    auto kept = keep_letterhead(folder, letterhead);
    if (!kept) return kept;
    auto pages = html_page(folder)(with);
    if (pages) pages->insert(pages->end(), kept->begin(), kept->end());
    return pages;
  };
}

Result<PageWriter> with_order(std::filesystem::path folder, const std::filesystem::path& order, PageWriter write) {
  TODBENCH_TRY(auto entries, load_order(order));
  TODBENCH_TRY(auto text, read_text_file(order));
  return [folder = std::move(folder), entries = std::move(entries), text = std::move(text),
          write = std::move(write)](const ReportData& data) -> Result<std::vector<std::string>> {
    ReportData with = data;
    with.order = entries;
    TODBENCH_TRY_VOID(make_folder(folder / "inputs"));
    TODBENCH_TRY_VOID(write_file_atomically(folder / order_file, text));
    auto pages = write(with);
    if (pages) pages->emplace_back(order_file);
    return pages;
  };
}

PageWriter html_page(std::filesystem::path folder) {
  return [folder = std::move(folder)](const ReportData& data) -> Result<std::vector<std::string>> {
    TODBENCH_TRY_VOID(write_file_atomically(folder / "report.html", render_report(data)));
    TODBENCH_TRY_VOID(write_file_atomically(folder / "report.csv", report_csv(data)));
    return std::vector<std::string>{"report.html", "report.csv"};
  };
}

}  // namespace todbench
