#include "bench/session/signature.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <system_error>

#include "bench/session/manifest.h"
#include "bench/session/open_session.h"
#include "bench/text/files.h"
#include "bench/text/json.h"
#include "bench/text/json_reader.h"
#include "bench/text/program.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr std::string_view signature_record = "signature.json";
constexpr std::string_view signature_schema = "todbench-signature-1";
constexpr std::string_view revisions_record = "revisions/revisions.json";
constexpr std::string_view revisions_schema = "todbench-revisions-1";

std::string_view signature_file(SigningProgram program) {
  return program == SigningProgram::minisign ? "manifest.json.minisig" : "manifest.json.sig";
}

/// A file of this program alone, removed in the end.
class OwnFile {
 public:
  OwnFile() {
    std::error_code problem;
    std::string name = (std::filesystem::temp_directory_path(problem) / "todbench-key-XXXXXX").string();
    const int descriptor = ::mkstemp(name.data());
    if (descriptor < 0) return;
    ::close(descriptor);
    path_ = name;
  }
  OwnFile(const OwnFile&) = delete;
  OwnFile& operator=(const OwnFile&) = delete;
  ~OwnFile() {
    std::error_code problem;
    if (!path_.empty()) std::filesystem::remove(path_, problem);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A relative path may begin with a hyphen, which a program would take for an option.
std::string argument(const std::filesystem::path& path) {
  std::error_code problem;
  const auto absolute = std::filesystem::absolute(path, problem);
  return (problem ? path : absolute).string();
}

Result<void> require_file(const std::filesystem::path& file) {
  std::error_code problem;
  if (std::filesystem::is_regular_file(file, problem)) return {};
  return fail(ErrorCode::invalid_input, file.string() + ": no such key");
}

/// Success, or the last line that the program said.
Result<void> run_well(const std::vector<std::string>& words, ProgramOutput output) {
  const auto run = run_program(words, output);
  if (!run) return tl::unexpected(run.error());
  if (run->exit_code == 0) return {};
  std::string said = run->output;
  while (!said.empty() && said.back() == '\n') said.pop_back();
  const std::size_t line = said.find_last_of('\n');
  if (line != std::string::npos) said = said.substr(line + 1);
  return fail(ErrorCode::invalid_input, words.front() + " refuses" + (said.empty() ? "" : ": " + one_line(said)));
}

/// With a digest, or, for keys that sign a text as a whole (Ed25519), without one.
Result<void> openssl_sign(const std::string& key, const std::string& file, const std::string& signature) {
  const auto digest =
      run_well({"openssl", "dgst", "-sha256", "-sign", key, "-out", signature, file}, ProgramOutput::kept);
  if (digest || digest.error().code == ErrorCode::not_found) return digest;
  return run_well({"openssl", "pkeyutl", "-sign", "-rawin", "-inkey", key, "-in", file, "-out", signature},
                  ProgramOutput::kept);
}

Result<void> openssl_verify(const std::string& key, const std::string& file, const std::string& signature) {
  const auto digest =
      run_well({"openssl", "dgst", "-sha256", "-verify", key, "-signature", signature, file}, ProgramOutput::kept);
  if (digest || digest.error().code == ErrorCode::not_found) return digest;
  return run_well(
      {"openssl", "pkeyutl", "-verify", "-pubin", "-inkey", key, "-rawin", "-in", file, "-sigfile", signature},
      ProgramOutput::kept);
}

Result<void> sign_file(SigningProgram with, const std::string& key, const std::string& file,
                       const std::string& signature) {
  if (with == SigningProgram::openssl) return openssl_sign(key, file, signature);
  return run_well({"minisign", "-S", "-s", key, "-m", file, "-x", signature}, ProgramOutput::shown);
}

Result<void> verify_file(SigningProgram with, const std::string& key, const std::string& file,
                         const std::string& signature) {
  if (with == SigningProgram::openssl) return openssl_verify(key, file, signature);
  return run_well({"minisign", "-V", "-q", "-p", key, "-m", file, "-x", signature}, ProgramOutput::kept);
}

/// The public key of a secret one, as its program writes it.
Result<std::string> public_key_of(SigningProgram with, const std::string& secret_key) {
  const OwnFile file;
  const std::string out = file.path().string();
  if (out.empty()) return fail(ErrorCode::io, "no temporary file can be created");
  if (with == SigningProgram::minisign) {
    // It does not write over a file.
    std::error_code problem;
    std::filesystem::remove(out, problem);
  }
  const auto made = with == SigningProgram::openssl
                        ? run_well({"openssl", "pkey", "-in", secret_key, "-pubout", "-out", out}, ProgramOutput::kept)
                        : run_well({"minisign", "-R", "-s", secret_key, "-p", out}, ProgramOutput::shown);
  if (!made) return tl::unexpected(made.error());
  return read_text_file(out);
}

Result<Json> read_record_file(const std::filesystem::path& file) {
  const auto text = read_text_file(file);
  if (!text) return tl::unexpected(text.error());
  Json json = Json::parse(*text, nullptr, false);
  if (json.is_discarded()) return fail(ErrorCode::invalid_input, file.string() + ": not valid JSON");
  return json;
}

Result<SessionSignature> read_signature(const std::filesystem::path& folder) {
  const auto file = folder / signature_record;
  const auto json = read_record_file(file);
  if (!json) return tl::unexpected(json.error());
  const JsonReader reader(*json);
  reader.at("schema").expect(signature_schema);
  SessionSignature signature;
  signature.with = reader.at("with").named(signing_programs);
  signature.signed_utc = reader.at("signed_utc").text();
  signature.manifest_sha256 = reader.at("manifest_sha256").text();
  signature.public_key = reader.at("public_key").text();
  if (auto finished = reader.finish(); !finished) return fail(file.string(), finished.error());
  return signature;
}

Result<Json> revisions_of(const std::filesystem::path& folder) {
  if (!is_there(folder / revisions_record)) return Json{{"schema", revisions_schema}, {"revisions", Json::array()}};
  auto json = read_record_file(folder / revisions_record);
  if (!json) return json;
  if (!json->is_object() || !json->contains("revisions") || !(*json)["revisions"].is_array())
    return fail(ErrorCode::invalid_input, (folder / revisions_record).string() + ": not a list of revisions");
  return json;
}

/// The first page of a revision that is not what was written; empty where there is none.
Result<std::string> changed_revision(const std::filesystem::path& folder) {
  const auto json = revisions_of(folder);
  if (!json) return tl::unexpected(json.error());
  const JsonReader reader(*json);
  for (const JsonReader& revision : reader.at("revisions").elements()) {
    for (const JsonReader& page : revision.at("pages").elements()) {
      const std::string path = page.at("path").text();
      const auto digest = sha256_of_file(folder / path);
      if (!digest || *digest != page.at("sha256").text()) return path;
    }
  }
  if (auto finished = reader.finish(); !finished) return fail((folder / revisions_record).string(), finished.error());
  return std::string();
}

Result<void> require_whole(const std::filesystem::path& folder) {
  const auto check = check_session(folder);
  if (!check) return tl::unexpected(check.error());
  if (check->condition == SessionCondition::intact) return {};
  return fail(ErrorCode::invalid_input,
              folder.string() + ": not intact, so nothing to sign: " +
                  (check->sentence.empty() ? "files are missing or foreign" : check->sentence));
}

}  // namespace

std::string_view to_string(SigningProgram program) {
  return program == SigningProgram::minisign ? "minisign" : "openssl";
}

std::string SessionSignature::key_sha256() const {
  return sha256_of(public_key);
}

bool is_signed(const std::filesystem::path& folder) {
  return is_there(folder / signature_record);
}

Result<void> require_unsigned(const std::filesystem::path& folder) {
  if (!is_signed(folder)) return {};
  return fail(ErrorCode::invalid_input,
              folder.string() +
                  ": the session is signed, nothing of it is written again; a revision of its report is made by "
                  "todbench report --reason TEXT");
}

Result<SessionSignature> sign_session(const std::filesystem::path& folder, SigningProgram with,
                                      const std::filesystem::path& secret_key, const std::string& signed_utc) {
  if (is_signed(folder)) return fail(ErrorCode::invalid_input, folder.string() + ": the session is signed already");
  if (auto found = require_file(secret_key); !found) return tl::unexpected(found.error());
  if (auto whole = require_whole(folder); !whole) return tl::unexpected(whole.error());
  const std::string file = argument(folder / manifest_name), signature = argument(folder / signature_file(with));
  const std::string key = argument(secret_key);
  SessionSignature made{.with = with, .signed_utc = signed_utc, .manifest_sha256 = {}, .public_key = {}};
  auto digest = manifest_digest(folder);
  if (!digest) return tl::unexpected(digest.error());
  made.manifest_sha256 = *std::move(digest);
  auto public_key = public_key_of(with, key);
  if (!public_key) return tl::unexpected(public_key.error());
  made.public_key = *std::move(public_key);
  auto done = sign_file(with, key, file, signature);
  if (done) {
    const Json record{{"schema", signature_schema},      {"with", to_string(with)},
                      {"signed_utc", made.signed_utc},   {"manifest_sha256", made.manifest_sha256},
                      {"key_sha256", made.key_sha256()}, {"public_key", made.public_key}};
    done = write_file_atomically(folder / signature_record, to_page(record));
  }
  if (!done) {
    std::error_code problem;
    std::filesystem::remove(signature, problem);
    return tl::unexpected(done.error());
  }
  return made;
}

Result<std::optional<SignatureCheck>> check_signature(const std::filesystem::path& folder,
                                                      const std::optional<std::filesystem::path>& public_key) {
  if (!is_signed(folder)) return std::nullopt;
  auto signature = read_signature(folder);
  if (!signature) return tl::unexpected(signature.error());
  SignatureCheck check{.signature = *std::move(signature), .own_key = !public_key, .sentence = {}};
  const OwnFile own;
  std::string key = own.path().string();
  if (public_key) {
    if (auto found = require_file(*public_key); !found) return tl::unexpected(found.error());
    key = argument(*public_key);
  } else if (auto written = write_file_atomically(own.path(), check.signature.public_key); !written) {
    return tl::unexpected(written.error());
  }
  const SigningProgram with = check.signature.with;
  const auto verified =
      verify_file(with, key, argument(folder / manifest_name), argument(folder / signature_file(with)));
  if (!verified && verified.error().code != ErrorCode::invalid_input) return tl::unexpected(verified.error());
  if (!verified) {
    check.sentence = "the signature does not belong to this manifest and key";
    return check;
  }
  const auto changed = changed_revision(folder);
  if (!changed) return tl::unexpected(changed.error());
  if (!changed->empty()) {
    check.sentence = *changed + " is not the revision that was written";
    return check;
  }
  check.valid = true;
  return check;
}

Result<ReportRevision> next_revision(const std::filesystem::path& folder, const std::string& reason,
                                     const std::string& utc) {
  if (!is_signed(folder))
    return fail(ErrorCode::invalid_input, folder.string() + ": not signed: its report is rebuilt without a reason");
  if (reason.find_first_not_of(" \t\n") == std::string::npos)
    return fail(ErrorCode::invalid_input, folder.string() + ": a revision of a signed report needs a reason");
  const auto json = revisions_of(folder);
  if (!json) return tl::unexpected(json.error());
  return ReportRevision{static_cast<int>((*json)["revisions"].size()) + 2, utc, one_line(reason)};
}

std::string revision_page(const ReportRevision& revision, std::string_view extension) {
  return "revisions/report-" + std::to_string(revision.number) + "." + std::string(extension);
}

Result<void> keep_revision(const std::filesystem::path& folder, const ReportRevision& revision,
                           const std::vector<std::string>& pages) {
  auto json = revisions_of(folder);
  if (!json) return tl::unexpected(json.error());
  Json listed = Json::array();
  for (const std::string& page : pages) {
    const auto digest = sha256_of_file(folder / page);
    if (!digest) return tl::unexpected(digest.error());
    listed.push_back({{"path", page}, {"sha256", *digest}});
  }
  (*json)["revisions"].push_back(
      {{"number", revision.number}, {"utc", revision.utc}, {"reason", revision.reason}, {"pages", listed}});
  return write_file_atomically(folder / revisions_record, to_page(*json));
}

}  // namespace todbench
