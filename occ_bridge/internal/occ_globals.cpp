#include "occ_bridge/internal/occ_globals.hpp"

#include <IGESControl_Controller.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <STEPControl_Controller.hxx>

namespace flowcage {

std::mutex& occ_globals_mutex() {
  static std::mutex mutex;
  return mutex;
}

void silence_occ() {
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
}

InterfaceSettings::InterfaceSettings(std::vector<std::pair<std::string, std::string>> values) {
  STEPControl_Controller::Init();  // the parameters exist only after this
  IGESControl_Controller::Init();
  for (auto& [name, value] : values) {
    old_.emplace_back(name, Interface_Static::CVal(name.c_str()));
    Interface_Static::SetCVal(name.c_str(), value.c_str());
  }
}

InterfaceSettings::~InterfaceSettings() {
  for (const auto& [name, value] : old_) Interface_Static::SetCVal(name.c_str(), value.c_str());
}

}  // namespace flowcage
