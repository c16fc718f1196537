#include "occ_bridge/internal/kernel_scope.hpp"

#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <Standard_Type.hxx>
#include <algorithm>
#include <iostream>
#include <mutex>
#include <streambuf>

#include "occ_bridge/internal/occ_globals.hpp"

namespace flowcage::occ {

namespace {

/// Keeps messages instead of printing them; a broken file can raise millions, the first ones tell the cause.
class CollectingPrinter : public Message_Printer {
 public:
  mutable std::vector<KernelMessage> messages;

 protected:
  void send(const TCollection_AsciiString& text, const Message_Gravity gravity) const override {
    constexpr std::size_t enough = 1000;
    if (messages.size() < enough) messages.push_back({gravity, text.ToCString()});
  }
};

/// Some parts of the kernel write to std::cout past its messenger.
class NullBuffer : public std::streambuf {
 protected:
  int overflow(int c) override { return c == EOF ? 0 : c; }
};

}  // namespace

struct KernelScope::State {
  std::unique_lock<std::mutex> lock{occ_globals_mutex()};
  Message_SequenceOfPrinters printers;
  Handle(CollectingPrinter) collector = new CollectingPrinter;
  NullBuffer nothing;
  std::streambuf* out = nullptr;
  std::streambuf* err = nullptr;
  std::unique_ptr<InterfaceSettings> settings;
};

KernelScope::KernelScope(Parameters parameters) : state_(std::make_unique<State>()) {
  auto& printers = Message::DefaultMessenger()->ChangePrinters();
  state_->printers = printers;
  printers.Clear();
  printers.Append(state_->collector);
  state_->out = std::cout.rdbuf(&state_->nothing);
  state_->err = std::cerr.rdbuf(&state_->nothing);
  state_->settings = std::make_unique<InterfaceSettings>(std::move(parameters));
}

KernelScope::~KernelScope() {
  std::cout.rdbuf(state_->out);
  std::cerr.rdbuf(state_->err);
  Message::DefaultMessenger()->ChangePrinters() = state_->printers;
}

const std::vector<KernelMessage>& KernelScope::messages() const {
  return state_->collector->messages;
}

std::string failure_text(const Standard_Failure& failure) {
  std::string text = failure.DynamicType()->Name();
  const char* message = failure.GetMessageString();
  if (message != nullptr && *message != '\0') text += std::string(": ") + message;
  std::ranges::replace(text, '\n', ' ');
  return text;
}

}  // namespace flowcage::occ
