// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/sweep/result_store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <map>
#include <sstream>
#include <utility>

#include "bench/session/build_info.h"
#include "bench/session/provenance.h"
#include "bench/text/files.h"
#include "bench/text/folders.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr std::size_t tasks_a_folder = 1000;
/// Age limit for a lock of another host, whose process cannot be queried.
constexpr auto patience_with_hosts = std::chrono::hours(24);

std::filesystem::path folder_of(const Sweep& sweep, std::size_t index) {
  return sweep.file().results / fmt::format("{:03d}", index / tasks_a_folder);
}

/// This process as an element of a Slurm job, which Slurm restarts after node failure or preemption.
struct SlurmElement {
  std::string job;
  double restarts = 0;
};
std::optional<SlurmElement> slurm_element() {
  const auto variable = [](const char* name) {
    const char* text = std::getenv(name);
    return std::string(text == nullptr ? "" : text);
  };
  const std::string job = variable("SLURM_ARRAY_JOB_ID") + "_" + variable("SLURM_ARRAY_TASK_ID");
  if (job.size() < 3 || job.find('\n') != std::string::npos) return std::nullopt;
  return SlurmElement{job, parse_number(variable("SLURM_RESTART_COUNT")).value_or(0)};
}

/// Whether the lock belongs to this element before a restart by Slurm: the process that held it has ended, on any host.
bool is_of_earlier_start(const std::vector<std::string>& lock) {
  const auto element = slurm_element();
  if (!element || lock.size() < 4) return false;
  const auto restarts = parse_number(lock[3]);
  return lock[2] == element->job && restarts && *restarts < element->restarts;
}

/// Held while a task runs; created with O_EXCL, which network file systems support too.
class Lock {
 public:
  static std::optional<Lock> taken(const std::filesystem::path& file) {
    const int descriptor = ::open(file.c_str(), O_CREAT | O_EXCL | O_NOFOLLOW | O_WRONLY | O_CLOEXEC, 0644);
    if (descriptor < 0) return std::nullopt;
    std::string text = fmt::format("{}\n{}\n", host_name(), ::getpid());
    if (const auto element = slurm_element()) text += fmt::format("{}\n{}\n", element->job, element->restarts);
    const auto written = ::write(descriptor, text.data(), text.size());
    ::close(descriptor);
    if (written != static_cast<ssize_t>(text.size())) {
      std::error_code ignored;
      std::filesystem::remove(file, ignored);
      return std::nullopt;
    }
    return Lock(file);
  }
  Lock(Lock&& other) noexcept : file_(std::exchange(other.file_, {})) {}
  Lock& operator=(Lock&&) = delete;
  ~Lock() {
    std::error_code ignored;
    if (!file_.empty()) std::filesystem::remove(file_, ignored);
  }

 private:
  explicit Lock(std::filesystem::path file) : file_(std::move(file)) {}
  std::filesystem::path file_;
};

std::vector<std::string> lines_of_lock(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

bool is_younger_than(const std::filesystem::path& file, std::chrono::seconds age) {
  std::error_code problem;
  const auto written = std::filesystem::last_write_time(file, problem);
  return !problem && std::filesystem::file_time_type::clock::now() - written < age;
}

/// Whether this host runs the process; a zombie is not running.
bool is_running(pid_t process) {
  if (::kill(process, 0) != 0 && errno != EPERM) return false;
  const auto stat = read_text_file(fmt::format("/proc/{}/stat", process));
  const auto name_end = stat ? stat->rfind(')') : std::string::npos;
  return name_end == std::string::npos || name_end + 2 >= stat->size() || (*stat)[name_end + 2] != 'Z';
}

/// Whether the owner of the lock may still be running.
bool is_alive(const std::filesystem::path& lock) {
  const auto text = read_text_file(lock);
  if (!text) return false;
  const auto lines = lines_of_lock(*text);
  const auto process = lines.size() < 2 ? std::nullopt : parse_number(lines[1]);
  // Just being written, or its process was killed while writing.
  if (!process) return is_younger_than(lock, std::chrono::seconds(10));
  if (is_of_earlier_start(lines)) return false;
  if (lines[0] == host_name()) return is_running(static_cast<pid_t>(*process));
  return is_younger_than(lock, patience_with_hosts);
}

std::filesystem::path with_ending(std::filesystem::path result, const char* ending) {
  return result.replace_extension(ending);
}

Json result_json(const RunnableSweep& runnable, const SweepTask& task, const Json& answer) {
  Json parameters = Json::object();
  for (const auto& [key, value] : task.parameters) parameters[key] = value;
  return {{"format", "todbench-sweep-result"},
          {"version", std::string(build_info().version)},
          {"commit", std::string(build_info().commit)},
          {"sweep_sha256", runnable.sweep.hash()},
          {"index", task.index},
          {"task", task.name},
          {"repeat", task.repeat},
          {"seed", task.seed},
          {"parameters", parameters},
          {"points", answer["points"]}};
}

/// Returns a result of this index with another hash.
std::optional<std::string> foreign_result(const std::filesystem::path& folder, const SweepTask& task) {
  const std::string prefix = task.name.substr(0, task.name.find('-') + 1);
  std::error_code problem;
  for (auto entry = std::filesystem::directory_iterator(folder, problem);
       !problem && entry != std::filesystem::directory_iterator(); entry.increment(problem)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with(prefix) && name.ends_with(".json") && name != task.name + ".json") return name;
  }
  return std::nullopt;
}

TaskOutcome failed(Error error) {
  return {.kind = TaskOutcome::Kind::failed, .error = std::move(error)};
}

/// Takes the lock of the task, after removing a stale one.
std::optional<Lock> lock_of(const std::filesystem::path& result) {
  const auto file = with_ending(result, ".lock");
  if (auto lock = Lock::taken(file)) return lock;
  if (is_alive(file)) return std::nullopt;
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  return Lock::taken(file);
}

}  // namespace

std::filesystem::path result_file(const Sweep& sweep, const SweepTask& task) {
  return folder_of(sweep, task.index) / (task.name + ".json");
}

std::size_t SweepStatus::count(TaskState state) const {
  return static_cast<std::size_t>(std::count(states.begin(), states.end(), state));
}

std::string SweepStatus::open_list() const {
  std::string list;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (states[i] == TaskState::done) continue;
    std::size_t last = i;
    while (last + 1 < states.size() && states[last + 1] != TaskState::done) ++last;
    if (!list.empty()) list += ',';
    list += last == i ? std::to_string(i) : fmt::format("{}-{}", i, last);
    i = last;
  }
  return list;
}

SweepStatus sweep_status(const Sweep& sweep) {
  SweepStatus status{std::vector<TaskState>(sweep.count(), TaskState::missing)};
  for (std::size_t begin = 0; begin < sweep.count(); begin += tasks_a_folder) {
    // Content of the folder by index: the name without its extension, and the extensions.
    std::error_code problem;
    const auto folder = folder_of(sweep, begin);
    for (auto entry = std::filesystem::directory_iterator(folder, problem);
         !problem && entry != std::filesystem::directory_iterator(); entry.increment(problem)) {
      const std::string stem = entry->path().stem().string(), ending = entry->path().extension().string();
      const auto number = parse_number(stem.starts_with('i') ? stem.substr(1, stem.find('-') - 1) : "");
      if (!number || *number < 0 || *number >= static_cast<double>(sweep.count())) continue;
      const auto index = static_cast<std::size_t>(*number);
      TaskState& state = status.states[index];
      const bool ours = sweep.task(index).name == stem;
      if (ending == ".json") state = ours ? TaskState::done : (state == TaskState::done ? state : TaskState::foreign);
      if (!ours || state == TaskState::done) continue;
      if (ending == ".failed" && state == TaskState::missing) state = TaskState::failed;
      if (ending == ".lock") state = is_alive(entry->path()) ? TaskState::running : TaskState::stale;
    }
  }
  return status;
}

std::string failure_of(const Sweep& sweep, std::size_t index) {
  const auto text = read_text_file(with_ending(result_file(sweep, sweep.task(index)), ".failed"));
  return text ? one_line(std::string_view(*text).substr(0, text->find('\n'))) : "";
}

TaskOutcome run_and_store(const RunnableSweep& runnable, std::size_t index, std::stop_token stop) {
  const SweepTask task = runnable.sweep.task(index);
  const auto file = result_file(runnable.sweep, task);
  std::error_code problem;
  if (std::filesystem::exists(file, problem)) return {.kind = TaskOutcome::Kind::already_done};
  if (auto made = make_folder(file.parent_path()); !made) return failed(made.error());
  if (const auto foreign = foreign_result(file.parent_path(), task)) {
    return failed({ErrorCode::invalid_input, file.parent_path().string() + "/" + *foreign +
                                                 ": this result belongs to another sweep. Name another folder with "
                                                 "results = \"...\" or remove the file"});
  }
  const auto lock = lock_of(file);
  if (!lock) return {.kind = TaskOutcome::Kind::locked};
  // Another process may have finished between the check and the lock.
  if (std::filesystem::exists(file, problem)) return {.kind = TaskOutcome::Kind::already_done};
  const auto answer = run_task(runnable, task, with_ending(file, ".scratch"), stop);
  const auto failure = with_ending(file, ".failed");
  if (!answer) {
    if (answer.error().code != ErrorCode::interrupted)
      (void)write_file_atomically(failure, answer.error().message + "\n").has_value();
    return failed(answer.error());
  }
  if (auto written = write_file_atomically(file, to_page(result_json(runnable, task, *answer))); !written)
    return failed(written.error());
  std::filesystem::remove(failure, problem);
  return {};
}

}  // namespace todbench
