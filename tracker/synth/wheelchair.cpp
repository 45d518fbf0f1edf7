#include "tracker/synth/wheelchair.h"

#include <cmath>
#include <numbers>

#include "tracker/body/rotation.h"

namespace armature {
namespace {

using Eigen::Vector3d;

class ChairBuilder {
 public:
  explicit ChairBuilder(std::vector<SurfaceEdge>& out) : out_(out) { out_.clear(); }

  void rod(const Vector3d& from, const Vector3d& to, double radius) {
    out_.push_back({{{from, radius}, {to, radius}}, {}, Material::Furniture});
  }

  /// Rods side by side along x from `-half_width` to `half_width`: cloth between `from` and `to`.
  void sheet(const Vector3d& from, const Vector3d& to, double half_width) {
    constexpr double kRadius = 0.02;
    const int count = static_cast<int>(std::ceil((to - from).norm() / (1.2 * kRadius)));
    for (int i = 0; i <= count; ++i) {
      const Vector3d middle = from + (to - from) * i / count;
      rod(middle - Vector3d(half_width, 0, 0), middle + Vector3d(half_width, 0, 0), kRadius);
    }
  }

  void wheel(const Vector3d& hub, double radius, double tyre, int spokes) {
    constexpr int kCorners = 16;
    const auto on_rim = [&](double turns) -> Vector3d {
      const double angle = 2 * std::numbers::pi * turns;
      return hub + (radius - tyre) * Vector3d(0, on_grid(std::sin(angle)), on_grid(std::cos(angle)));
    };
    for (int i = 0; i < kCorners; ++i) rod(on_rim(i / 16.0), on_rim((i + 1) / 16.0), tyre);
    for (int i = 0; i < spokes; ++i) rod(hub, on_rim(static_cast<double>(i) / spokes), 0.006);
  }

 private:
  std::vector<SurfaceEdge>& out_;
};

}  // namespace

void wheelchair(double seat_height, double thigh, std::vector<SurfaceEdge>& out) {
  constexpr double kHalfWidth = 0.22, kBack = -0.22;
  ChairBuilder build(out);
  const double seat = seat_height - 0.02, rest = seat + 0.22, top = seat + 0.45;
  build.sheet({0, seat, kBack}, {0, seat, 0.20}, kHalfWidth);
  build.sheet({0, seat, kBack}, {0, top, kBack - 0.05}, kHalfWidth);
  for (const double side : {-1.0, 1.0}) {
    const double x = side * (kHalfWidth + 0.03);
    build.wheel({side * (kHalfWidth + 0.07), 0.30, kBack + 0.08}, 0.30, 0.016, 8);
    build.wheel({x, 0.09, 0.28}, 0.09, 0.02, 4);
    build.rod({x, rest, kBack}, {x, rest, 0.12}, 0.025);        // armrest
    build.rod({x, rest, 0.12}, {x, seat - 0.02, 0.16}, 0.014);  // and what holds it
    build.rod({x, seat - 0.03, kBack}, {x, seat - 0.03, 0.20}, 0.014);
    build.rod({x, seat - 0.03, 0.20}, {x, 0.10, thigh + 0.02}, 0.014);
    build.rod({x, 0.10, 0.28}, {x, seat - 0.03, 0.20}, 0.014);
    build.rod({x, top, kBack - 0.05}, {x, top + 0.03, kBack - 0.17}, 0.016);  // handle
    build.sheet({0.5 * x, 0.07, thigh + 0.02}, {0.5 * x, 0.07, thigh + 0.20}, 0.08);
  }
}

}  // namespace armature
