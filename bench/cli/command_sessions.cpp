// SPDX-License-Identifier: GPL-3.0-or-later
// todbench compare, todbench report, todbench verify
#include <algorithm>
#include <array>
#include <memory>

#include "bench/cli/commands.h"
#include "bench/cli/compare_boresight.h"
#include "bench/cli/findings.h"
#include "bench/cli/session_argument.h"
#include "bench/forecast/comparison_forecast.h"
#include "bench/judgement/verdict.h"
#include "bench/report/svg.h"
#include "bench/report/tod_figures.h"
#include "bench/run/rebuild_report.h"
#include "bench/run/report_data.h"
#include "bench/session/fit_record.h"
#include "bench/session/provenance.h"
#include "bench/session/session_comparison.h"
#include "bench/session/signature.h"
#include "bench/text/files.h"
#include "tod/psychometric/contrast_slope.h"

namespace todbench {
namespace {

struct CompareArguments {
  std::string a, b, svg;
  double margin_percent = 0;
  bool boresight = false;
  Opening opening{};
};

/// Accepted files of both sessions, prefixed by their folders.
std::vector<std::string> accepted_files(const CompareArguments& arguments, const Session& a, const Session& b) {
  std::vector<std::string> files;
  for (const auto& [folder, session] : {std::pair(&arguments.a, &a), std::pair(&arguments.b, &b)}) {
    for (const std::string& file : session->accepted_changes)
      files.push_back((std::filesystem::path(*folder) / file).generic_string());
  }
  return files;
}

void print_comparison(const Console& console, const Comparison& comparison, bool measured_once) {
  std::vector<TableRow> rows;
  for (const auto& p : comparison.points) {
    rows.push_back({fixed(p.delta_t_a_k, 3), fixed(p.delta_t_b_k, 3), fixed(p.ratio, 4), range(p.ratio_ci95, 4),
                    fixed(p.p_difference, 4), fixed(p.p_equivalence, 4), std::string(to_string(p.verdict))});
  }
  console.table({"dT A [K]", "dT B [K]", "acuity A / B", "95 %", "p difference", "p equivalence", "verdict"}, rows);
  print_paired(console, comparison, measured_once);
  print_findings(console, comparison.adequacy, "");
  console.text("margin " + fixed(comparison.points.front().margin_percent, 1) +
               " %; verdict: " + std::string(to_string(comparison.verdict)));
}

/// Writes both curves in one figure to a separate file.
Result<void> write_svg(const CompareArguments& arguments, const TodCurve& a, const TodCurve& b) {
  const auto drawing = drawn(tod_figure({session_name(arguments.a), &a}, {session_name(arguments.b), &b}, {}));
  if (!drawing) return fail("--svg", drawing.error());
  return write_file_atomically(arguments.svg, svg_document(std::array{*drawing}));
}

int run_compare(Console& console, const CompareArguments& arguments) {
  const auto a = opened(console, arguments.a, arguments.opening);
  if (!a) return report_error(console, a.error());
  const auto b = opened(console, arguments.b, arguments.opening);
  if (!b) return report_error(console, b.error());
  if (arguments.boresight) {
    return show_boresight(console, {{{arguments.a, *a}, {arguments.b, *b}}}, arguments.opening,
                          accepted_files(arguments, *a, *b));
  }
  const auto margin = arguments.margin_percent > 0 ? std::optional(arguments.margin_percent) : std::nullopt;
  const auto compared = compare_sessions(*a, *b, margin);
  if (!compared) return report_error(console, with_context(arguments.a + ", " + arguments.b, compared.error()));
  if (!arguments.svg.empty()) {
    if (auto written = write_svg(arguments, compared->a, compared->b); !written)
      return report_error(console, written.error());
  }
  const Comparison* comparison = &compared->comparison;
  const std::string outlook = comparison_forecast(compared->a, compared->b, *comparison).sentence;
  if (!outlook.empty()) console.note(outlook);
  if (console.json()) {
    Json json = comparison_json(*comparison);
    add_accepted_changes(json, arguments.opening, accepted_files(arguments, *a, *b));
    console.object(json);
  } else {
    print_comparison(console, *comparison,
                     has_contrast_measured_once(compared->a) || has_contrast_measured_once(compared->b));
    for (const auto& sentence : {accepted_sentence(arguments.a, *a), accepted_sentence(arguments.b, *b)}) {
      if (!sentence.empty()) console.text(sentence);
    }
  }
  return exit_code(decision_of(comparison->verdict));
}

/// Writes the report of a signed session as its next revision.
int run_revision(Console& console, const std::string& folder, const std::string& reason, const std::string& key,
                 const std::stop_token& stop) {
  if (key.empty())
    return report_error(console,
                        {ErrorCode::invalid_input,
                         folder + ": a revision is signed with the key of its session: --key FILE is required"});
  const auto session = opened(console, folder, {});
  if (!session) return report_error(console, session.error());
  const auto path = std::filesystem::path(folder);
  const auto data = revise_report(*session, path, reason, utc_now(), key, stop);
  if (!data) return report_error(console, data.error());
  const std::string file = (path / revision_page(*data->revision, "html")).string();
  const auto check = check_signature(path, std::nullopt);
  if (!check) return report_error(console, check.error());
  const std::string digest = *check && (*check)->valid ? (*check)->revision_sha256.back() : "";
  if (console.json()) {
    console.object({{"report", file}, {"revision", data->revision->number}, {"revision_sha256", digest}});
  } else {
    console.text(file);
    console.text("SHA-256 of revision " + std::to_string(data->revision->number) + ": " + digest);
  }
  return 0;
}

int run_report(Console& console, const std::string& folder, Opening opening, const std::string& reason,
               const std::string& key, const std::string& letterhead_path, const std::string& order,
               const std::stop_token& stop) {
  if (!reason.empty()) return run_revision(console, folder, reason, key, stop);
  std::optional<Letterhead> letterhead;
  if (!letterhead_path.empty()) {
    auto loaded = load_letterhead(letterhead_path);
    if (!loaded) return report_error(console, loaded.error());
    letterhead = *std::move(loaded);
  }
  opening.accept_cut_off = true;
  const auto session = opened(console, folder, opening);
  if (!session) return report_error(console, session.error());
  if ((letterhead || !order.empty()) && (session->cut_off || !session->accepted_changes.empty()))
    return report_error(
        console, {ErrorCode::invalid_input, folder + ": the files of the session cannot be verified, so " +
                                                (letterhead ? "a letterhead" : "an order") + " cannot be added"});
  const auto path = std::filesystem::path(folder);
  PageWriter write = letterhead ? html_page_with(path, *letterhead) : html_page(path);
  if (!order.empty()) {
    auto ordered = with_order(path, order, std::move(write));
    if (!ordered) return report_error(console, ordered.error());
    write = *std::move(ordered);
  }
  const auto data = rebuild_report(*session, path, write);
  if (!data) return report_error(console, data.error());
  const bool afterwards = data->verdict->judged == JudgedWhen::afterwards;
  if (afterwards) console.note(std::string(remark_on(data->verdict->judged)));
  const std::string file = (path / "report.html").string();
  if (console.json()) {
    Json json{{"report", file}};
    if (afterwards) json["judged"] = to_string(data->verdict->judged);
    add_accepted_changes(json, opening, session->accepted_changes);
    console.object(json);
  } else {
    console.text(file);
    if (const auto sentence = accepted_sentence(folder, *session); !sentence.empty()) console.text(sentence);
  }
  return 0;
}

struct SignArguments {
  std::string folder, with, key;
};

int run_sign(Console& console, const SignArguments& arguments, const std::stop_token& stop) {
  const SigningProgram with =
      arguments.with == to_string(SigningProgram::minisign) ? SigningProgram::minisign : SigningProgram::openssl;
  const auto made = sign_session(arguments.folder, with, arguments.key, utc_now(), stop);
  if (!made) return report_error(console, made.error());
  if (console.json()) {
    console.object({{"session", arguments.folder},
                    {"with", to_string(made->with)},
                    {"signed_utc", made->signed_utc},
                    {"manifest_sha256", made->manifest_sha256},
                    {"key_sha256", made->key_sha256()}});
  } else {
    console.text("signed: manifest " + made->manifest_sha256 + ", key " + made->key_sha256());
  }
  return 0;
}

/// Checks the signature of a session; an error if it cannot be checked, or is required and absent.
Result<std::optional<SignatureCheck>> signature_of(const std::string& folder, const std::string& public_key) {
  auto check =
      check_signature(folder, public_key.empty() ? std::nullopt : std::optional(std::filesystem::path(public_key)));
  if (check && !*check && !public_key.empty()) return fail(ErrorCode::invalid_input, folder + ": not signed");
  return check;
}

Json signature_json(const SignatureCheck& check) {
  return {{"with", to_string(check.signature.with)},
          {"signed_utc", check.signature.signed_utc},
          {"valid", check.valid},
          {"covers", check.covers},
          {"revisions", check.revision_sha256.size()},
          {"newest_revision_sha256", check.revision_sha256.empty() ? Json() : Json(check.revision_sha256.back())},
          {"checked_with", check.own_key ? "the key in the folder" : "the key that was given"},
          {"key_sha256", check.signature.key_sha256()},
          {"reason", check.valid ? Json() : Json(check.sentence)}};
}

/// The revisions of a valid signature, for people.
std::string revisions_sentence(const std::vector<std::string>& digests) {
  if (digests.empty()) return "revisions of the report: none";
  return "revisions of the report: " + std::to_string(digests.size()) + "; the newest is revision " +
         std::to_string(digests.size() + 1) + ", SHA-256 " + digests.back();
}

/// Fails if the session lacks the revision with this digest, which somebody kept outside of the folder.
Result<void> require_revision(const std::string& folder, const std::optional<SignatureCheck>& check,
                              const std::string& digest) {
  if (digest.empty()) return {};
  if (!check) return fail(ErrorCode::invalid_input, folder + ": not signed");
  const auto& known = check->revision_sha256;
  if (!check->valid || std::find(known.begin(), known.end(), digest) != known.end()) return {};
  return fail(ErrorCode::invalid_input,
              folder + ": the revision with the SHA-256 " + digest + " is missing; " + revisions_sentence(known));
}

int run_verify(Console& console, const std::string& folder, const std::string& public_key,
               const std::string& revision) {
  const auto check = check_session(folder);
  if (!check) return report_error(console, check.error());
  const auto signature = signature_of(folder, public_key);
  if (!signature) return report_error(console, signature.error());
  if (auto there = require_revision(folder, *signature, revision); !there) return report_error(console, there.error());
  const bool signature_holds = !*signature || (*signature)->valid;
  const ManifestCheck& files = check->files;
  const bool intact = check->condition == SessionCondition::intact;
  const std::string reason = !check->sentence.empty() ? check->sentence
                             : intact                 ? ""
                                                      : "files are missing or foreign; no result is read from them";
  if (console.json()) {
    Json json{{"intact", intact},
              {"changed", files.changed},
              {"missing", files.missing},
              {"foreign", files.foreign},
              {"links", files.links},
              {"signed_by", *signature && signature_holds ? Json((*signature)->signature.key_sha256()) : Json()},
              {"manifest_sha256", files.manifest_sha256.empty() ? Json() : Json(files.manifest_sha256)},
              {"condition", to_string(check->condition)},
              {"reason", reason.empty() ? Json() : Json(reason)}};
    if (*signature) json["signature"] = signature_json(**signature);
    console.object(json);
    return intact && signature_holds ? 0 : exit_code(ErrorCode::invalid_input);
  }
  for (const std::string& file : files.changed) console.text("changed   " + file);
  for (const std::string& file : files.missing) console.text("missing   " + file);
  for (const std::string& file : files.foreign) console.text("foreign   " + file);
  for (const std::string& file : files.links) console.text("link      " + file);
  if (!files.manifest_sha256.empty()) console.text("SHA-256 of the manifest: " + files.manifest_sha256);
  if (!signature_holds)
    return report_error(console, {ErrorCode::invalid_input, folder + ": " + (*signature)->sentence});
  if (*signature) {
    console.text(
        "signed " + (*signature)->signature.signed_utc + " with " +
        std::string(to_string((*signature)->signature.with)) + ", SHA-256 of the public key " +
        (*signature)->signature.key_sha256() +
        ((*signature)->own_key ? "; checked with the public key in the folder, which does not prove who signed" : ""));
    console.text(revisions_sentence((*signature)->revision_sha256));
  }
  if (intact) {
    console.text("intact: every file is as the run wrote it");
    return 0;
  }
  return report_error(console, {ErrorCode::invalid_input, folder + ": not intact: " + reason});
}

}  // namespace

void add_compare_command(CLI::App& app, Program& program) {
  auto* command =
      app.add_subcommand("compare", "compares two session folders: ratio, difference, equivalence per contrast");
  auto a = std::make_shared<CompareArguments>();
  command->add_option("A", a->a, "session folder of the first sensor")->required();
  command->add_option("B", a->b, "session folder of the second sensor")->required();
  command
      ->add_option("--margin-percent", a->margin_percent,
                   "equivalence margin in percent; default: the smaller margin of the two plans, or 10")
      ->check(number_in(0.1, 100));
  command->add_option("--svg", a->svg, "writes a figure of both curves to this SVG file");
  command->add_flag(
      "--boresight", a->boresight,
      "compares the line of sight instead, from the geometry of both sessions: zoom states, or before and "
      "after remounting");
  add_accept_changed(*command, a->opening.accept_changed);
  finish_command(*command, program, [a](Console& console) { return run_compare(console, *a); });
}

void add_report_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("report", "rebuilds the report from the session folder alone");
  auto folder = std::make_shared<std::string>();
  command->add_option("DIR", *folder, "session folder")->required();
  auto opening = std::make_shared<Opening>();
  add_accept_changed(*command, opening->accept_changed);
  auto reason = std::make_shared<std::string>();
  command->add_option("--reason", *reason,
                      "reason for the revision of a signed report; the revision is a separate page");
  auto key = std::make_shared<std::string>();
  command->add_option("--key", *key, "with --reason: file with the secret key that signed the session");
  auto letterhead = std::make_shared<std::string>();
  command
      ->add_option("--letterhead", *letterhead,
                   "TOML file with the logo and texts of the laboratory; the session keeps a copy")
      ->excludes("--reason");
  auto order = std::make_shared<std::string>();
  command
      ->add_option("--order", *order,
                   "TOML file with a section [order], as for 'certificate': customer, report number, item, dates. It "
                   "stands on the first page; the session keeps a copy")
      ->excludes("--reason");
  finish_command(*command, program, [&program, folder, opening, reason, key, letterhead, order](Console& console) {
    return run_report(console, *folder, *opening, *reason, *key, *letterhead, *order, program.stop->token());
  });
}

void add_verify_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand(
      "verify", "checks by the manifest that the files of a session folder are as the run wrote them");
  auto folder = std::make_shared<std::string>();
  command->add_option("DIR", *folder, "session folder")->required();
  auto public_key = std::make_shared<std::string>();
  command->add_option("--public-key", *public_key,
                      "file with the public key of the signer; default: the key in the session folder");
  auto revision = std::make_shared<std::string>();
  command->add_option("--expect-revision", *revision,
                      "SHA-256 of a revision that the session must have, as 'report --reason' printed it");
  finish_command(*command, program, [folder, public_key, revision](Console& console) {
    return run_verify(console, *folder, *public_key, *revision);
  });
}

void add_sign_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("sign", "signs a session folder with a detached signature over its manifest");
  auto a = std::make_shared<SignArguments>();
  command->add_option("DIR", a->folder, "session folder")->required();
  std::vector<std::string> names;
  for (const SigningProgram with : signing_programs) names.emplace_back(to_string(with));
  command->add_option("--with", a->with, "program that signs")->required()->check(CLI::IsMember(names));
  command->add_option("--key", a->key, "file with the secret key")->required();
  finish_command(*command, program,
                 [&program, a](Console& console) { return run_sign(console, *a, program.stop->token()); });
}

}  // namespace todbench
