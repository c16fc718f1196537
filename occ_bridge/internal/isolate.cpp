#include "occ_bridge/internal/isolate.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <ctime>
#include <mutex>
#include <new>
#include <string_view>

#include "occ_bridge/internal/kernel_scope.hpp"
#include "occ_bridge/internal/occ_globals.hpp"

namespace flowcage::occ {

namespace {

// What the child sends: a letter, then the result, or the error's kind as a digit string, what and remedy,
// each with a zero byte behind.
constexpr char sent_result = 'r', sent_error = 'e';

class FileDescriptor {
 public:
  explicit FileDescriptor(int number) : number_(number) {}
  ~FileDescriptor() { close(); }
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  int number() const { return number_; }
  void close() {
    if (number_ >= 0) ::close(number_);
    number_ = -1;
  }

 private:
  int number_;
};

/// Ends and collects the child whatever happens in between.
class Child {
 public:
  explicit Child(pid_t id) : id_(id) {}
  ~Child() {
    if (id_ < 0) return;
    kill(id_, SIGKILL);
    wait();
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  double processor_seconds() const {
    clockid_t clock{};
    timespec time{};
    if (clock_getcpuclockid(id_, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0;
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  int wait() {
    int status = 0;
    while (waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
    id_ = -1;
    return status;
  }

 private:
  pid_t id_;
};

void send_all(int pipe, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = write(pipe, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) _exit(1);
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

void send_error(int pipe, const Error& error) {
  send_all(pipe, fmt::format("{}{}{}{}{}{}{}", sent_error, static_cast<int>(error.kind()), '\0', error.what(),
                             '\0', error.remedy(), '\0'));
}

[[noreturn]] void be_the_child(const std::function<std::string()>& work, const std::string& file, int pipe) {
  for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTERM}) signal(number, SIG_DFL);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) {
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
  }
  try {
    send_all(pipe, sent_result + work());
  } catch (const Error& error) {
    send_error(pipe, error);
  } catch (const std::bad_alloc&) {
    send_error(pipe, input_error(file, 0, "not enough memory to read it", "the file may be damaged"));
  } catch (const Standard_Failure& failure) {
    send_error(pipe, input_error(file, 0, "OpenCASCADE cannot read it: " + failure_text(failure),
                                 "export the file again from the CAD system"));
  } catch (const std::exception& failure) {
    send_error(pipe, input_error(file, 0, std::string("cannot be read: ") + failure.what(),
                                 "export the file again from the CAD system"));
  }
  _exit(0);  // no destructors of the parent's objects, no second flush of its buffers
}

Error error_of(std::string_view message) {
  const std::size_t first = message.find('\0'), second = message.find('\0', first + 1);
  const int kind = std::atoi(std::string(message.substr(0, first)).c_str());
  std::string_view remedy = message.substr(second + 1);
  if (!remedy.empty()) remedy.remove_suffix(1);
  return {static_cast<ErrorKind>(kind), std::string(message.substr(first + 1, second - first - 1)),
          std::string(remedy)};
}

}  // namespace

std::string run_isolated(const std::function<std::string()>& work, const IsolationSettings& settings,
                         Progress& progress) {
  progress.step(settings.stage, 0.0);
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw Error(ErrorKind::internal, fmt::format("no pipe for reading CAD: {}", std::strerror(errno)),
                "free some file descriptors");
  }
  FileDescriptor from(ends[0]), to(ends[1]);
  std::unique_lock lock(occ_globals_mutex());  // nobody else holds it in the child
  const pid_t id = fork();
  lock.unlock();
  if (id < 0) {
    throw Error(ErrorKind::internal, fmt::format("no process for reading CAD: {}", std::strerror(errno)),
                "free some memory, or raise the limit of processes");
  }
  if (id == 0) be_the_child(work, settings.file, to.number());
  Child child(id);
  to.close();

  std::string message;
  const auto start = std::chrono::steady_clock::now();
  // The child's own time, so that other work on the machine changes no result; on the clock for one that
  // waits.
  constexpr double longest_on_the_clock = 10;
  for (;;) {
    pollfd waiting{from.number(), POLLIN, 0};
    constexpr int milliseconds = 50;
    const int ready = poll(&waiting, 1, milliseconds);
    progress.step(settings.stage, 0.0);
    // Also when something came: what is over its limit is over it, however soon it was done after that.
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
    if (child.processor_seconds() > settings.limit_seconds ||
        passed.count() > longest_on_the_clock * settings.limit_seconds) {
      throw input_error(settings.file, 0,
                        fmt::format("reading it takes more than {:g} s", settings.limit_seconds),
                        "the file may be damaged: repair it or export it again from the CAD system");
    }
    if (ready <= 0) continue;
    std::array<char, 65536> buffer{};
    const ssize_t count = read(from.number(), buffer.data(), buffer.size());
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count <= 0) break;
    message.append(buffer.data(), static_cast<std::size_t>(count));
  }
  const int status = child.wait();
  if (WIFSIGNALED(status) || message.empty() || WEXITSTATUS(status) != 0) {
    const int number = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    const std::string cause = number == SIGKILL ? "was killed (out of memory?)"
                              : number != 0     ? fmt::format("crashed ({})", strsignal(number))
                                                : "ended without a result";
    throw input_error(settings.file, 0, "OpenCASCADE " + cause + " while reading it: the file is damaged",
                      "repair it or export it again from the CAD system");
  }
  const char kind = message.front();
  message.erase(0, 1);
  if (kind == sent_error) throw error_of(message);
  return message;
}

}  // namespace flowcage::occ
