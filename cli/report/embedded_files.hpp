#pragma once
#include <string_view>

namespace flowcage {

/// The files of which a report is made, as they were when the program was built.
struct EmbeddedFiles {
  std::string_view page, style, scene, viewer, tables;  ///< report.html, report.css, scene.js, ...
  std::string_view three, orbit_controls;               ///< three.js (libjs-three of Debian, MIT licence)
};
EmbeddedFiles embedded_files();

}  // namespace flowcage
