#include "cli/interruption.hpp"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <ctime>
#include <string_view>

#include "core/base/atomic_file.hpp"
#include "core/base/error.hpp"

namespace flowcage {
namespace {

constexpr std::time_t grace_seconds = 2;

sigset_t watched_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1}) {
    // nohup's choice stands; that of a shell's background job (SIGINT) does not: `kill -INT` shall end it.
    struct sigaction action {};
    if (signal == SIGHUP && ::sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN)
      continue;
    sigaddset(&set, signal);
  }
  return set;
}

[[noreturn]] void end_process() {
  remove_unfinished_outputs();
  constexpr std::string_view message = "flowcage: interrupted\n  nothing was written\n";
  [[maybe_unused]] const auto ignored = ::write(STDERR_FILENO, message.data(), message.size());
  ::_exit(static_cast<int>(ErrorKind::interrupted));
}

}  // namespace

Interruption::Interruption() {
  const sigset_t signals = watched_signals();
  ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  // A full disk, a closed pipe or a limit of the file size shall be errors of write(), not the end.
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);
  watcher_ = std::thread([this] { watch(); });
}

Interruption::~Interruption() {
  over_ = true;
  ::pthread_kill(watcher_.native_handle(), SIGUSR1);
  watcher_.join();
}

void Interruption::watch() {
  const sigset_t signals = watched_signals();
  int signal = 0;
  do {
    if (::sigwait(&signals, &signal) != 0) return;
    if (over_) return;
  } while (signal == SIGUSR1);
  requested_ = true;
  const timespec grace{grace_seconds, 0};
  ::sigtimedwait(&signals, nullptr, &grace);
  if (!over_) end_process();
}

}  // namespace flowcage
