#pragma once
#include <Message_Gravity.hxx>
#include <Message_ProgressIndicator.hxx>
#include <Standard_Failure.hxx>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/progress.hpp"

namespace flowcage::occ {

/// What the kernel said while a KernelScope lived.
struct KernelMessage {
  Message_Gravity gravity = Message_Info;
  std::string text;
};

/// Exclusive use of the kernel's process-wide state for as long as the object lives: the parameters of
/// Interface_Static (units, reading modes) and the default messenger. One scope at a time in the process (a
/// mutex), none nested in a thread. The destructor restores parameters and printers. The kernel prints
/// nothing meanwhile: its messages are collected.
class KernelScope {
 public:
  using Parameters = std::vector<std::pair<std::string, std::string>>;
  /// `parameters`: name and value of those of Interface_Static that shall hold meanwhile.
  explicit KernelScope(Parameters parameters = {});
  ~KernelScope();
  KernelScope(const KernelScope&) = delete;
  KernelScope& operator=(const KernelScope&) = delete;

  const std::vector<KernelMessage>& messages() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Passes the kernel's progress on to ours and our cancellation on to the kernel: give
/// `KernelProgress(progress, "read CAD").Start()` to a call that takes a Message_ProgressRange. A cancelled
/// call returns early; the caller asks progress.step() afterwards.
class KernelProgress : public Message_ProgressIndicator {
 public:
  KernelProgress(Progress& progress, std::string stage) : progress_(progress), stage_(std::move(stage)) {}

 protected:
  Standard_Boolean UserBreak() override { return progress_.cancelled(); }
  void Show(const Message_ProgressScope&, const Standard_Boolean) override {
    progress_.report(stage_, GetPosition());
  }

 private:
  Progress& progress_;
  std::string stage_;
};

/// "Standard_ConstructionError: message" on one line.
std::string failure_text(const Standard_Failure& failure);

/// Runs `work`; returns "" or the text of the exception that it threw. For work on one face or edge, whose
/// failure costs a warning and not the model. Errors of our own pass through.
template <typename Work>
std::string failure_of(const Work& work) {
  try {
    work();
  } catch (const Error&) {
    throw;
  } catch (const Standard_Failure& failure) {
    return failure_text(failure);
  } catch (const std::exception& failure) {
    return failure.what();
  }
  return {};
}

}  // namespace flowcage::occ
