#include "viewer/walk/city.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace armature::viewer {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kBlock = 34;   // from the middle of a street to the next
constexpr double kStreet = 14;  // wide, pavements included
constexpr double kPavement = 3;
constexpr int kBlocks = 9;  // a side
constexpr double kHalf = kBlocks * kBlock / 2;

/// A rectangle on the ground.
struct Lot {
  Vector2d low, high;
  [[nodiscard]] Lot inset(double by) const { return {low + Vector2d(by, by), high - Vector2d(by, by)}; }
};

class Builder {
 public:
  explicit Builder(std::uint32_t seed) : random_(seed) {}

  /// In [low, high): the same on every machine.
  double uniform(double low, double high) { return low + (high - low) * (random_() / 4294967296.0); }

  /// Corners counter-clockwise seen from outside.
  void quad(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d, const sdk::Colour& colour) {
    const std::size_t first = mesh.positions.size();
    mesh.positions.insert(mesh.positions.end(), {a, b, c, d});
    const auto vertex = [&](std::size_t i) { return sdk::VertexId(first + i); };
    mesh.triangles.insert(mesh.triangles.end(), {{vertex(0), vertex(1), vertex(2)}, {vertex(0), vertex(2), vertex(3)}});
    mesh.face_colours.insert(mesh.face_colours.end(), {colour, colour});
  }

  void box(const Lot& lot, double bottom, double top, const sdk::Colour& wall, const sdk::Colour& roof) {
    const std::array<Vector2d, 4> at = {lot.low, Vector2d(lot.high.x(), lot.low.y()), lot.high,
                                        Vector2d(lot.low.x(), lot.high.y())};
    const auto low = [&](std::size_t i) { return Vector3d(at[i % 4].x(), at[i % 4].y(), bottom); };
    const auto high = [&](std::size_t i) { return Vector3d(at[i % 4].x(), at[i % 4].y(), top); };
    for (std::size_t i = 0; i < 4; ++i) quad(low(i), low(i + 1), high(i + 1), high(i), wall);
    quad(high(0), high(1), high(2), high(3), roof);
  }

  void flat(const Lot& lot, double height, const sdk::Colour& colour) {
    quad({lot.low.x(), lot.low.y(), height}, {lot.high.x(), lot.low.y(), height}, {lot.high.x(), lot.high.y(), height},
         {lot.low.x(), lot.high.y(), height}, colour);
  }

  /// Windows in rows on the four walls, a hand's breadth before them.
  void windows(const Lot& lot, double bottom, double top, const sdk::Colour& glass) {
    constexpr double kFloor = 3.2, kBay = 2.6, kBefore = 0.06;
    const std::array<Vector2d, 5> at = {lot.low, Vector2d(lot.high.x(), lot.low.y()), lot.high,
                                        Vector2d(lot.low.x(), lot.high.y()), lot.low};
    for (std::size_t side = 0; side < 4; ++side) {
      const Vector2d along = at[side + 1] - at[side];
      const double length = along.norm();
      const Vector2d unit = along / length;
      const Vector2d out(unit.y(), -unit.x());
      const int bays = static_cast<int>((length - 1) / kBay);
      const double start = (length - bays * kBay) / 2;
      for (double floor = bottom + 1.1; floor + 1.8 < top; floor += kFloor) {
        for (int bay = 0; bay < bays; ++bay) {
          const Vector2d from = at[side] + unit * (start + bay * kBay + 0.55) + kBefore * out;
          const Vector2d to = from + unit * (kBay - 1.1);
          quad({from.x(), from.y(), floor}, {to.x(), to.y(), floor}, {to.x(), to.y(), floor + 1.7},
               {from.x(), from.y(), floor + 1.7}, glass);
        }
      }
    }
  }

  void tree(const Vector2d& at, double size) {
    const Lot trunk{at - Vector2d(0.14, 0.14) * size, at + Vector2d(0.14, 0.14) * size};
    box(trunk, 0, 2.2 * size, {110, 92, 78}, {110, 92, 78});
    const auto crown = [&](double x, double y, double z, double radius) {
      trees.spheres.push_back({Vector3d(at.x() + x * size, at.y() + y * size, z * size), radius * size});
    };
    const double turn = uniform(0, 2 * std::numbers::pi);
    const std::size_t first = trees.spheres.size();
    crown(0, 0, 4.2, 1.05);
    for (int i = 0; i < 3; ++i) {
      const double angle = turn + i * 2 * std::numbers::pi / 3;
      crown(0.95 * std::cos(angle), 0.95 * std::sin(angle), 2.9 + 0.2 * i, 0.95);
    }
    for (std::size_t i = 1; i < 4; ++i) trees.edges.push_back({sdk::SphereId(first), sdk::SphereId(first + i)});
  }

  sdk::Mesh mesh;
  sdk::SphereMesh trees;

 private:
  std::mt19937 random_;
};

/// Warm, pale walls.
sdk::Colour wall_colour(Builder& builder) {
  static constexpr std::array<sdk::Colour, 6> kWalls = {
      {{226, 214, 196}, {214, 201, 188}, {203, 208, 212}, {222, 196, 178}, {234, 228, 216}, {190, 182, 176}}};
  return kWalls[static_cast<std::size_t>(builder.uniform(0, kWalls.size()))];
}

void add_block(Builder& builder, const Lot& block) {
  constexpr sdk::Colour kStone = {196, 194, 190}, kGlass = {92, 112, 132};
  const Lot pavement = block;
  builder.box(pavement, 0, 0.12, kStone, kStone);
  const Lot lot = pavement.inset(kPavement);
  const Vector2d middle = (lot.low + lot.high) / 2;
  // Four houses a block, of their own heights and colours.
  for (int i = 0; i < 4; ++i) {
    Lot house{{i % 2 == 0 ? lot.low.x() : middle.x(), i < 2 ? lot.low.y() : middle.y()},
              {i % 2 == 0 ? middle.x() : lot.high.x(), i < 2 ? middle.y() : lot.high.y()}};
    house = house.inset(builder.uniform(0.0, 0.35));
    const double height = 3.2 * std::floor(builder.uniform(2, 8)) + 1.4;
    const sdk::Colour wall = wall_colour(builder);
    const sdk::Colour roof = {static_cast<std::uint8_t>(wall[0] - 40), static_cast<std::uint8_t>(wall[1] - 50),
                              static_cast<std::uint8_t>(wall[2] - 50)};
    builder.box(house, 0.12, height, wall, roof);
    builder.windows(house, 0.12, height, kGlass);
    const Lot attic = house.inset(builder.uniform(1.2, 2.6));
    builder.box(attic, height, height + builder.uniform(0.8, 2.4), roof, roof);
  }
  for (double s = 3; s < kBlock - kStreet; s += 6.5) {
    if (builder.uniform(0, 1) < 0.25) continue;
    builder.tree({pavement.low.x() + s, pavement.low.y() + 1.1}, builder.uniform(0.8, 1.15));
    builder.tree({pavement.low.x() + 1.1, pavement.low.y() + s}, builder.uniform(0.8, 1.15));
  }
}

}  // namespace

City make_city(std::uint32_t seed) {
  Builder builder(seed);
  constexpr sdk::Colour kGround = {150, 152, 154}, kGrass = {150, 172, 128}, kLine = {228, 226, 220};
  const double edge = kHalf + 30;
  // In pieces, so that none is much larger than what is near.
  for (double x = -edge; x < edge; x += kBlock)
    for (double y = -edge; y < edge; y += kBlock)
      builder.flat({{x, y}, {std::min(x + kBlock, edge), std::min(y + kBlock, edge)}}, 0, kGround);
  // Streets run along x = 0, y = 0 and every kBlock from there: the camera starts on a crossing.
  for (int i = -kBlocks / 2 - 1; i <= kBlocks / 2; ++i) {
    for (int j = -kBlocks / 2 - 1; j <= kBlocks / 2; ++j) {
      const Vector2d corner(i * kBlock + kStreet / 2, j * kBlock + kStreet / 2);
      const Lot block{corner, corner + Vector2d(kBlock - kStreet, kBlock - kStreet)};
      const bool park = (i == 1 && j == 0) || (i == -2 && j == -2);
      if (park) {
        builder.box(block, 0, 0.12, kLine, kGrass);
        for (int t = 0; t < 14; ++t)
          builder.tree({builder.uniform(block.low.x() + 2, block.high.x() - 2),
                        builder.uniform(block.low.y() + 2, block.high.y() - 2)},
                       builder.uniform(0.9, 1.5));
      } else {
        add_block(builder, block);
      }
    }
  }
  // Broken lines in the middle of the streets.
  for (int i = -kBlocks / 2; i <= kBlocks / 2; ++i) {
    for (double s = -kHalf; s < kHalf; s += 5) {
      if (std::abs(std::remainder(s + 1, kBlock)) < kStreet / 2) continue;
      builder.flat({{s, i * kBlock - 0.09}, {s + 2.2, i * kBlock + 0.09}}, 0.015, kLine);
      builder.flat({{i * kBlock - 0.09, s}, {i * kBlock + 0.09, s + 2.2}}, 0.015, kLine);
    }
  }
  City city{.buildings = std::move(builder.mesh), .trees = std::move(builder.trees), .path = {}};
  // Around the park: straight, a bend to the left, a curve to the right.
  const auto arc = [&](const Vector2d& centre, double radius, double from, double to) {
    constexpr int kSteps = 12;
    for (int i = 0; i <= kSteps; ++i) {
      const double angle = from + (to - from) * i / kSteps;
      city.path.emplace_back(centre + radius * Vector2d(std::cos(angle), std::sin(angle)));
    }
  };
  constexpr double kPi = std::numbers::pi;
  city.path.emplace_back(0, 0);
  arc({kBlock - 5, 5}, 5, -kPi / 2, 0);            // left, into the street at x = kBlock
  arc({kBlock + 5, kBlock - 5}, 5, kPi, kPi / 2);  // right, into the street at y = kBlock
  city.path.emplace_back(1.6 * kBlock, kBlock);
  return city;
}

sdk::Mesh make_ribbon(const std::vector<Vector2d>& path, double width, const sdk::Colour& colour) {
  constexpr double kHeight = 0.03;
  sdk::Mesh mesh;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Vector2d along = path[std::min(i + 1, path.size() - 1)] - path[i == 0 ? 0 : i - 1];
    const Vector2d left = Vector2d(-along.y(), along.x()).normalized() * width / 2;
    for (const Vector2d& at : {Vector2d(path[i] + left), Vector2d(path[i] - left)})
      mesh.positions.emplace_back(at.x(), at.y(), kHeight);
    if (i == 0) continue;
    const auto vertex = [&](std::size_t k) { return sdk::VertexId(2 * i - 2 + k); };
    mesh.triangles.insert(mesh.triangles.end(), {{vertex(0), vertex(1), vertex(3)}, {vertex(0), vertex(3), vertex(2)}});
  }
  mesh.face_colours.assign(mesh.triangles.size(), colour);
  return mesh;
}

}  // namespace armature::viewer
