#pragma once
#include <span>
#include <string>
#include <vector>

#include "occ_bridge/internal/read_files.hpp"

namespace flowcage::occ {

/// Which faces a person wants: those that match a pattern of `include` (all where there is none) and none of
/// `exclude`. A pattern is a shell wildcard (*, ?, [...]) over the face's own name, its solid, part,
/// instance, layer, colour (#rrggbb), file or patch name; a prefix narrows it to one of them (name: solid:
/// part: layer: color: file: group:). face:3 and face:1-4,9 go by number.
struct FaceSelection {
  std::vector<std::string> include, exclude;
};

/// Takes the other faces out of the files' shapes; files without a face left are dropped. Returns how many
/// faces went. Throws Error(usage) for a pattern that is malformed or matches no face (its remedy lists what
/// there is, the nearest first), and where no face is left.
Index select_faces(std::vector<FileContent>& contents, const FaceLabels& labels,
                   const FaceSelection& selection);

/// Gives the faces that match a pattern its name as their group (of several, the last). Throws Error(usage)
/// as select_faces does.
void name_faces(std::vector<CadFace>& faces, std::span<const CadReadSettings::NamedFaces> named);

}  // namespace flowcage::occ
