#include "cli/batch.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <thread>

#include "cli/batch_job.hpp"
#include "cli/json_report.hpp"
#include "cli/terminal.hpp"
#include "core/base/error.hpp"
#include "core/base/stopwatch.hpp"

namespace flowcage {
namespace fs = std::filesystem;
namespace {

constexpr auto poll_interval = std::chrono::milliseconds(20);
constexpr double grace = 3;  // seconds: a child ends itself two seconds after a signal

/// A folder for what the children say, gone at the end.
class Scratch {
 public:
  explicit Scratch(const fs::path& folder) : path_(folder / fmt::format(".flowcage-batch-{}", ::getpid())) {
    std::error_code failed;
    fs::create_directories(path_, failed);
    if (!failed) return;
    throw Error(ErrorKind::output,
                fmt::format("--out-dir {}: cannot make the folder: {}", folder.string(), failed.message()),
                "choose a folder that you may write to");
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  fs::path file(std::size_t job, const char* extension) const {
    return path_ / fmt::format("{}{}", job, extension);
  }

 private:
  fs::path path_;
};

/// Starts this program again. Between fork and exec only what a process of many threads may do there.
pid_t start(const std::vector<std::string>& arguments, const fs::path& errors) {
  std::vector<char*> argv{const_cast<char*>("flowcage")};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const pid_t parent = ::getpid(), child = ::fork();
  if (child != 0) return child;
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);  // a batch that is killed takes its children along
  if (::getppid() != parent) ::_exit(static_cast<int>(ErrorKind::interrupted));
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int nothing = ::open("/dev/null", O_RDWR);
  const int log = ::open(errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(nothing, STDOUT_FILENO);
  ::dup2(log, STDERR_FILENO);
  ::execv("/proc/self/exe", argv.data());
  ::_exit(static_cast<int>(ErrorKind::internal));
}

/// What an error says in its first line, without the program's name.
std::string first_line(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  constexpr std::string_view name = "flowcage: ";
  return line.starts_with(name) ? line.substr(name.size()) : line;
}

class Batch {
 public:
  Batch(const Options& options, std::vector<BatchJob> jobs, Progress& progress)
      : options_(options),
        jobs_(std::move(jobs)),
        progress_(progress),
        scratch_(options.out_dir),
        exit_codes_(jobs_.size(), 0) {}

  ~Batch() { end_children(); }

  int run() {
    std::size_t next = 0;
    while (next < jobs_.size() || !running_.empty()) {
      if (progress_.cancelled()) {
        end_children();
        throw Error(ErrorKind::interrupted, "interrupted", "start it again to do the rest");
      }
      if (next < jobs_.size() && static_cast<int>(running_.size()) < options_.jobs) {
        begin(next++);
        continue;
      }
      if (!collect()) std::this_thread::sleep_for(poll_interval);
    }
    const auto failed = std::ranges::find_if(exit_codes_, [](int code) { return code != 0; });
    return failed == exit_codes_.end() ? 0 : *failed;
  }

 private:
  struct Running {
    std::size_t job = 0;
    Stopwatch time;
  };

  void begin(std::size_t job) {
    if (is_finished(jobs_[job])) {
      tell(job, {{"status", "skipped"}, {"exit_code", 0}});
      return;
    }
    std::error_code ignored;
    fs::remove(jobs_[job].record, ignored);  // its output is about to be replaced
    const auto arguments = child_arguments(options_, jobs_[job], scratch_.file(job, ".json"));
    const pid_t child = start(arguments, scratch_.file(job, ".err"));
    if (child < 0) {
      throw Error(ErrorKind::internal, "cannot start a process", "use fewer --jobs, or free memory");
    }
    running_[child] = {job, {}};
  }

  /// Takes one child that ended; false if none did.
  bool collect() {
    int status = 0;
    for (const auto& [child, running] : running_) {
      const pid_t ended = ::waitpid(child, &status, WNOHANG);
      if (ended == 0) continue;
      const Running of = running;
      const pid_t pid = child;
      running_.erase(pid);
      if (!WIFEXITED(status)) remove_leftovers(pid);
      report(of, status);
      return true;
    }
    return false;
  }

  /// The unfinished outputs of a child that could not remove them itself (base/atomic_file).
  void remove_leftovers(pid_t child) const {
    std::error_code ignored;
    const std::string prefix = fmt::format(".flowcage-{}-", child);
    for (const auto& entry : fs::directory_iterator(options_.out_dir, ignored)) {
      if (entry.path().filename().string().starts_with(prefix)) fs::remove_all(entry.path(), ignored);
    }
  }

  void report(const Running& of, int status) {
    const bool crashed = !WIFEXITED(status);
    const int code = crashed ? static_cast<int>(ErrorKind::internal) : WEXITSTATUS(status);
    if (code == static_cast<int>(ErrorKind::interrupted) && progress_.cancelled()) return;  // by Ctrl-C
    exit_codes_[of.job] = code;
    Json facts{
        {"status", code == 0 ? "done" : "failed"}, {"exit_code", code}, {"seconds", of.time.seconds()}};
    if (crashed) {
      facts["signal"] = WTERMSIG(status);
      facts["message"] = fmt::format("the process was ended by signal {}", WTERMSIG(status));
    } else if (code != 0) {
      facts["message"] = first_line(scratch_.file(of.job, ".err"));
    }
    std::ifstream in(scratch_.file(of.job, ".json"));
    const Json figures = Json::parse(in, nullptr, false);
    if (figures.is_object() && figures.contains("volume")) {
      facts["cells"] = figures["volume"]["cells"];
      facts["min_scaled_jacobian"] = figures["volume"]["min_scaled_jacobian"];
      facts["max_deviation"] = figures["surface"]["max_deviation"];
    }
    if (code == 0) write_record(jobs_[of.job]);
    tell(of.job, facts);
  }

  void tell(std::size_t job, const Json& facts) {
    Json line{{"input", jobs_[job].input}, {"output", jobs_[job].output.string()}};
    line.update(facts);
    print(line.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
    ++told_;
    progress_.step("batch", static_cast<double>(told_) / static_cast<double>(jobs_.size()));
  }

  void end_children() {
    for (const auto& [child, running] : running_) ::kill(child, SIGTERM);
    const Stopwatch waiting;
    while (!running_.empty()) {
      const bool patient = waiting.seconds() < grace;
      for (auto it = running_.begin(); it != running_.end();) {
        if (!patient) ::kill(it->first, SIGKILL);
        it = ::waitpid(it->first, nullptr, patient ? WNOHANG : 0) != 0 ? running_.erase(it) : std::next(it);
      }
      std::this_thread::sleep_for(poll_interval);
    }
  }

  const Options& options_;
  const std::vector<BatchJob> jobs_;
  Progress& progress_;
  const Scratch scratch_;
  std::vector<int> exit_codes_;
  std::map<pid_t, Running> running_;
  std::size_t told_ = 0;
};

}  // namespace

int run_batch(const Options& options, Progress& progress) {
  std::vector<BatchJob> jobs = batch_jobs(options);
  return Batch(options, std::move(jobs), progress).run();
}

}  // namespace flowcage
