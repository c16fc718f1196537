#pragma once

namespace flowcage {

/// A closed cage with every feature of the format: groups, tags, polylines, n-gons, negative and textured
/// indices.
inline constexpr const char* prism_text = R"(# a prism over a pentagon
mtllib ignored.mtl
o prism
v 0 0 0
v 2 0 0 1.0
v 2.5 1.5 0 0.1 0.2 0.3
v 1 2.5 0
v -0.5 1.5 0
v 0 0 1e0
v 2 0 1
v 2.5 1.5 +1
v 1 2.5 1 # an end-of-line comment
v -0.5 1.5 1
vt 0 0
vn 0 0 1
g bottom cap
f 5 4 3 2 1
g top
f -5/1/1 -4//1 -3/1 -2 -1
g
usemtl sides
f 1 2 \
  7 6
f 2 3 8 7
f 3 4 9 8
s off
f 4 5 10 9
f 5 1 6 10
t crease 2/1/0 0 1 2.5
t crease 4/1/0 5 6 6 7 10
t crease 4/2/0 7 8 8 9 3 4
t corner 1/1/0 3 10
t interpolateboundary 1/0/0 1
l 1 2 3
)";

}  // namespace flowcage
