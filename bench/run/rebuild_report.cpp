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
  if (auto open = require_unsigned(folder); !open) return tl::unexpected(open.error());
  const bool vouched_for = session.accepted_changes.empty() && !session.cut_off;
  // Accepting changed files includes added ones; links are never accepted.
  if (auto own = vouched_for ? require_no_foreign_file(folder) : require_no_links(folder); !own)
    return tl::unexpected(own.error());
  auto data = report_data_of(session, folder);
  if (!data) return data;
  if (vouched_for && !session.verdict) {
    if (auto kept = keep_verdict(folder, *data->verdict); !kept) return tl::unexpected(kept.error());
    TODBENCH_TRY(data->manifest_sha256, manifest_digest(folder));
  }
  TODBENCH_TRY(const auto pages, write_pages(*data));
  if (!vouched_for) return data;
  if (auto refreshed = refresh_manifest(folder, pages); !refreshed) return tl::unexpected(refreshed.error());
  return data;
}

Result<ReportData> revise_report(const Session& session, const std::filesystem::path& folder, const std::string& reason,
                                 const std::string& utc, const std::filesystem::path& secret_key,
                                 const std::stop_token& stop) {
  TODBENCH_TRY(auto revision, next_revision(folder, reason, utc));
  if (auto own = require_no_foreign_file(folder); !own) return tl::unexpected(own.error());
  if (auto key = require_key_of_session(folder, secret_key, stop); !key) return tl::unexpected(key.error());
  auto data = report_data_of(session, folder);
  if (!data) return data;
  data->revision = revision;
  if (auto made = make_folder(folder / "revisions"); !made) return tl::unexpected(made.error());
  std::vector<std::string> pages;
  for (const auto& [extension, text] :
       {std::pair(std::string("html"), render_report(*data)), std::pair(std::string("csv"), report_csv(*data))}) {
    pages.push_back(revision_page(revision, extension));
    if (auto written = write_file_atomically(folder / pages.back(), text); !written)
      return tl::unexpected(written.error());
  }
  if (auto kept = keep_revision(folder, revision, pages, secret_key, stop); !kept) return tl::unexpected(kept.error());
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
    if (auto made = make_folder(folder / "inputs"); !made) return tl::unexpected(made.error());
    if (auto kept = write_file_atomically(folder / order_file, text); !kept) return tl::unexpected(kept.error());
    auto pages = write(with);
    if (pages) pages->emplace_back(order_file);
    return pages;
  };
}

PageWriter html_page(std::filesystem::path folder) {
  return [folder = std::move(folder)](const ReportData& data) -> Result<std::vector<std::string>> {
    if (auto written = write_file_atomically(folder / "report.html", render_report(data)); !written)
      return tl::unexpected(written.error());
    if (auto written = write_file_atomically(folder / "report.csv", report_csv(data)); !written)
      return tl::unexpected(written.error());
    return std::vector<std::string>{"report.html", "report.csv"};
  };
}

}  // namespace todbench
