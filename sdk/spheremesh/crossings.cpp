#include "sdk/spheremesh/crossings.h"

#include <algorithm>

#include <Eigen/Geometry>
#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>

namespace armature::sdk {
namespace {

using Eigen::Vector3d;
namespace bg = boost::geometry;

using Point = bg::model::point<double, 3, bg::cs::cartesian>;
using Box = bg::model::box<Point>;
using Entry = std::pair<Box, Crossings::Index>;
using Places = std::array<Vector3d, 3>;

Box box_of(const Places& p) {
  const Vector3d lower = p[0].cwiseMin(p[1]).cwiseMin(p[2]);
  const Vector3d upper = p[0].cwiseMax(p[1]).cwiseMax(p[2]);
  return {{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}};
}

Places places(const Crossings::Face& corners, const Crossings::Positions& positions) {
  return {positions[corners[0]], positions[corners[1]], positions[corners[2]]};
}

/// On which side of the plane through a, b, c the point lies: six times a volume.
double side(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& point) {
  return (b - a).cross(c - a).dot(point - a);
}

/// Whether a segment meets a triangle, other than in their common plane.
bool meets(const Vector3d& p, const Vector3d& q, const Places& t) {
  const double sp = side(t[0], t[1], t[2], p);
  const double sq = side(t[0], t[1], t[2], q);
  if ((sp > 0 && sq > 0) || (sp < 0 && sq < 0) || (sp == 0 && sq == 0)) return false;
  const double a = side(p, q, t[0], t[1]);
  const double b = side(p, q, t[1], t[2]);
  const double c = side(p, q, t[2], t[0]);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

/// Whether two faces meet anywhere but in the corners that they share.
bool cross(const Crossings::Face& a, const Places& at_a, const Crossings::Face& b, const Places& at_b) {
  std::size_t shared = 0;
  std::size_t own_a = 0;  // the corner of a that is shared, or of two the one that is not
  std::size_t own_b = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      if (a[i] == b[j]) ++shared, own_a += i, own_b += j;
  if (shared == 3) return true;
  if (shared == 2) {
    // Beside one edge they meet if one is folded onto the other.
    own_a = 3 - own_a, own_b = 3 - own_b;
    const Vector3d& from = at_a[(own_a + 1) % 3];
    const Vector3d edge = (at_a[(own_a + 2) % 3] - from).normalized();
    const auto away = [&](const Vector3d& p) { return (p - from - edge * edge.dot(p - from)).normalized(); };
    constexpr double kFolded = 1 - 1e-6;
    return away(at_a[own_a]).dot(away(at_b[own_b])) > kFolded;
  }
  if (shared == 1)
    return meets(at_a[(own_a + 1) % 3], at_a[(own_a + 2) % 3], at_b) ||
           meets(at_b[(own_b + 1) % 3], at_b[(own_b + 2) % 3], at_a);
  for (std::size_t k = 0; k < 3; ++k)
    if (meets(at_a[k], at_a[(k + 1) % 3], at_b) || meets(at_b[k], at_b[(k + 1) % 3], at_a)) return true;
  return false;
}

}  // namespace

struct Crossings::State {
  struct SameFace {
    bool operator()(const Entry& a, const Entry& b) const noexcept { return a.second == b.second; }
  };
  bg::index::rtree<Entry, bg::index::linear<16>, bg::index::indexable<Entry>, SameFace> tree;
};

Crossings::Crossings(const std::vector<Face>& faces, const Positions& positions) : state_(std::make_unique<State>()) {
  std::vector<Entry> entries;
  entries.reserve(faces.size());
  for (Index f = 0; f < faces.size(); ++f) entries.emplace_back(box_of(places(faces[f], positions)), f);
  state_->tree = decltype(state_->tree)(entries);
}

Crossings::~Crossings() = default;

void Crossings::insert(Index face, const Face& corners, const Positions& positions) {
  state_->tree.insert(Entry{box_of(places(corners, positions)), face});
}

void Crossings::erase(Index face, const Face& corners, const Positions& positions) {
  state_->tree.remove(Entry{box_of(places(corners, positions)), face});
}

bool Crossings::any(const Face& corners, const Vector3d& first, const std::vector<Face>& faces,
                    const Positions& positions, std::span<const Index> but) const {
  const Places there{first, positions[corners[1]], positions[corners[2]]};
  const auto found =
      state_->tree.qbegin(bg::index::intersects(box_of(there)) && bg::index::satisfies([&](const Entry& entry) {
                            const Index face = entry.second;
                            return !std::binary_search(but.begin(), but.end(), face) &&
                                   cross(corners, there, faces[face], places(faces[face], positions));
                          }));
  return found != state_->tree.qend();
}

}  // namespace armature::sdk
