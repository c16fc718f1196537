// Cages for the tests of subdivision: known shapes, and random ones that are the same on every machine.
#pragma once
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "core/mesh/cage.hpp"

namespace flowcage::zoo {

struct NamedCage {
  std::string name;
  Cage cage;
};

/// splitmix64: the same numbers with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits();
  double uniform(double low, double high);
  int below(int n);

 private:
  std::uint64_t state_;
};

Cage make_cage(std::vector<Vec3> points, const std::vector<std::vector<Index>>& faces);
Cage cube();
Cage tetrahedron();
Cage prism(int n);           ///< n-gon ends
Cage pyramid(int n);         ///< apex of valence n over an n-gon
Cage double_pyramid(int n);  ///< two vertices of valence n
Cage torus(int around, int across);
Cage grid(int nx, int ny);                               ///< open
Cage fan(int n, bool closed);                            ///< n quads round vertex 0, closed or half a turn
Cage voxels(const std::set<std::array<int, 3>>& cells);  ///< their surface, any genus
Cage pillow();                                           ///< two vertices of valence 2

/// Splits faces by diagonals and centre points and merges neighbours, `steps` times.
void scramble(Cage& cage, Random& random, int steps);
void perturb(Cage& cage, Random& random, double amount);

enum class Tags { none, infinite, semi_sharp, whole, mixed };
/// Creases on `share` of the edges, corners on half that share of the vertices. Semi-sharp values are
/// k * 105/1024 < 4 (k no multiple that makes them whole), so that means of up to seven are exact in float,
/// in which OpenSubdiv keeps sharpness; whole ones are 1, 2, 3.
void add_tags(Cage& cage, Random& random, Tags tags, double share);

/// 60 cages: every kind above.
std::vector<NamedCage> all();

}  // namespace flowcage::zoo
