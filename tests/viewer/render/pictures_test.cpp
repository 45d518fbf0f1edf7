// What pictures show, held against what rays computed on the CPU meet. Skipped where OpenGL is not available.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "viewer/render/renderer.h"

namespace armature::viewer {
namespace {

using Eigen::Vector3d;
using sdk::SphereId;
using sdk::VertexId;

constexpr int kSide = 200;  // of the pictures, in pixels

/// One for all tests: making it takes a while.
sdk::Expected<Renderer>& renderer() {
  static sdk::Expected<Renderer> made = Renderer::create();
  return made;
}

sdk::Colour at(const Image& image, int x, int y) {
  const std::size_t first =
      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
  return {image.rgb[first], image.rgb[first + 1], image.rgb[first + 2]};
}

int difference(const sdk::Colour& a, const sdk::Colour& b) {
  int most = 0;
  for (std::size_t k = 0; k < 3; ++k) most = std::max(most, std::abs(int{a[k]} - int{b[k]}));
  return most;
}

/// How many pixels differ by more than `tolerance` in a channel.
int pixels_apart(const Image& a, const Image& b, int tolerance) {
  int apart = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) apart += difference(at(a, x, y), at(b, x, y)) > tolerance ? 1 : 0;
  return apart;
}

// Told apart in a picture whatever the light: each is bright in one channel, the background in none.
constexpr Palette kPrimary = {.mesh = {220, 220, 220},
                              .sphere = {220, 0, 0},
                              .edge = {0, 220, 0},
                              .triangle = {0, 0, 220},
                              .background_top = {0, 0, 0},
                              .background_bottom = {0, 0, 0}};

enum class Seen { Nothing, Sphere, Edge, Triangle };

Seen seen(const sdk::Colour& colour) {
  const auto brightest = std::max_element(colour.begin(), colour.end());
  if (*brightest < 50) return Seen::Nothing;
  return static_cast<Seen>(1 + (brightest - colour.begin()));
}

/// What the nine samples of a pixel see of an edge, by rays: bit 1 << Seen for each.
unsigned seen_by_rays(const sdk::SphereEdge& edge, const Camera& camera, int x, int y) {
  const Eigen::Isometry3d world_from_view = camera.view_from_world.inverse();
  unsigned found = 0;
  for (const double dy : {1 / 6.0, 3 / 6.0, 5 / 6.0}) {
    for (const double dx : {1 / 6.0, 3 / 6.0, 5 / 6.0}) {
      const Vector3d direction((2 * (x + dx) / kSide - 1) * camera.half_width,
                               (1 - 2 * (y + dy) / kSide) * camera.half_height, -1);
      const auto hit = sdk::intersect(edge, {world_from_view.translation(), world_from_view.linear() * direction});
      const Seen seen = !hit ? Seen::Nothing : hit->blend > 0 && hit->blend < 1 ? Seen::Edge : Seen::Sphere;
      found |= 1U << static_cast<unsigned>(seen);
    }
  }
  return found;
}

class Pictures : public testing::Test {
 protected:
  void SetUp() override {
    if (!renderer()) GTEST_SKIP() << renderer().error().message;
  }

  template <class Shape>
  static Camera fitted(const Shape& shape, const View& view = {}) {
    CameraFit fit(view, 1);
    fit.include(shape);
    return fit.camera();
  }
  static Image drawn(const Scene& scene, const Camera& camera) {
    auto image = renderer()->draw(scene, camera, kSide, kSide);
    EXPECT_TRUE(image) << image.error().message;
    return *image;
  }
  template <class Shape>
  static Image drawn(const Shape& shape, const View& view = {}, const Palette& palette = kPrimary) {
    Scene scene({{0, 0, 0}, 2}, palette);
    scene.add(shape);
    return drawn(scene, fitted(shape, view));
  }
};

sdk::SphereMesh ball() {
  return {.spheres = {{{0, 0, 0}, 1}}};
}

sdk::SphereMesh edge(const sdk::Sphere& a, const sdk::Sphere& b) {
  return {.spheres = {a, b}, .edges = {{SphereId(0), SphereId(1)}}};
}

/// A unit sphere of triangles: an octahedron with its sides cut into so many.
sdk::Mesh octasphere(int cuts) {
  sdk::Mesh mesh;
  std::map<std::array<int, 3>, VertexId> vertices;
  const auto vertex = [&](const std::array<int, 3>& place) {
    const auto [found, is_new] = vertices.try_emplace(place, mesh.positions.size());
    if (is_new) mesh.positions.push_back(Vector3d(place[0], place[1], place[2]).normalized());
    return found->second;
  };
  for (const int x : {-1, 1}) {
    for (const int y : {-1, 1}) {
      for (const int z : {-1, 1}) {
        const auto at = [&](int i, int j) { return vertex({x * i, y * j, z * (cuts - i - j)}); };
        const auto add = [&](VertexId a, VertexId b, VertexId c) {
          mesh.triangles.push_back(x * y * z > 0 ? sdk::Triangle{a, b, c} : sdk::Triangle{a, c, b});
        };
        for (int i = 0; i < cuts; ++i) {
          for (int j = 0; i + j < cuts; ++j) {
            add(at(i, j), at(i + 1, j), at(i, j + 1));
            if (i + j + 1 < cuts) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
          }
        }
      }
    }
  }
  return mesh;
}

TEST_F(Pictures, ShowASphereAsADiscOfThePredictedRadius) {
  const Image image = drawn(ball());
  const double radius = 0.93 * kSide / 2;  // the camera leaves a margin of 7 %
  int covered = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const double away = std::hypot(x + 0.5 - kSide / 2.0, y + 0.5 - kSide / 2.0);
      const bool inside = seen(at(image, x, y)) == Seen::Sphere;
      covered += inside ? 1 : 0;
      if (std::abs(away - radius) > 1) {
        EXPECT_EQ(inside, away < radius) << x << ", " << y;
      }
    }
  }
  EXPECT_NEAR(covered, std::numbers::pi * radius * radius, 0.01 * covered);
}

TEST_F(Pictures, ShadeASphereAlikeFromEverySide) {
  const Image front = drawn(ball());
  for (const View& view : {View{.azimuth_rad = 1}, View{.azimuth_rad = -2, .elevation_rad = 1.2}, View{.up = Up::Z}})
    EXPECT_EQ(pixels_apart(front, drawn(ball(), view), 2), 0);
}

TEST_F(Pictures, ShadeASphereAsTheMeshOfOne) {
  Palette palette = kPrimary;
  palette.mesh = palette.sphere;
  const Image exact = drawn(ball());
  const Image mesh = drawn(octasphere(32), {}, palette);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      // The mesh is flatter than the sphere at its rim.
      if (std::hypot(x - 99.5, y - 99.5) < 88) {
        EXPECT_LE(difference(at(exact, x, y), at(mesh, x, y)), 5) << x << ", " << y;
      }
    }
  }
}

TEST_F(Pictures, ShowConesWhereRaysMeetThem) {
  const std::vector<sdk::SphereMesh> shapes = {
      edge({{-1, 0, 0}, 0.4}, {{1, 0.2, 0}, 0.1}),         // a cone
      edge({{-1, -0.3, 0.2}, 0.25}, {{1, 0.2, 0}, 0.25}),  // a cylinder
      edge({{0, 0, 1}, 0.1}, {{0.1, 0, -0.5}, 1}),         // blunt, seen from its tip
      edge({{0, 0, 1}, 0.6}, {{0.3, 0, -1.5}, 0.1}),       // seen from its thick end
      edge({{0, 0, 0}, 1}, {{0.3, 0, 0}, 0.9}),            // hardly longer than the difference of its radii
      edge({{0, 0, 0}, 1}, {{0.3, 0, 0}, 0.2}),            // one sphere holds the other
      edge({{-1, 0, 0}, 0.3}, {{1, 0, 0}, 0}),             // sharp
      edge({{-1, 0, 0}, 0.02}, {{1, 0.5, 0}, 0.01}),       // thin
  };
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    for (const View& view : {View{}, View{.azimuth_rad = 0.7, .elevation_rad = 0.4}}) {
      const Camera camera = fitted(shapes[i], view);
      const Image image = drawn(shapes[i], view);
      const sdk::SphereEdge hull{shapes[i].spheres[0], shapes[i].spheres[1]};
      int wrong = 0, covered = 0;
      for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
          const unsigned truth = seen_by_rays(hull, camera, x, y);
          covered += truth != 1 ? 1 : 0;
          wrong += (truth >> static_cast<unsigned>(seen(at(image, x, y))) & 1U) != 0 ? 0 : 1;
        }
      }
      EXPECT_EQ(wrong, 0) << "of " << covered << " pixels of shape " << i;
      EXPECT_GT(covered, 100);
    }
  }
}

TEST_F(Pictures, ShowTheFlatSidesOfTriangles) {
  sdk::SphereMesh shape{.spheres = {{{-1, -1, 0}, 0.2}, {{1, -1, 0}, 0.2}, {{0, 1, 0}, 0.2}},
                        .triangles = {{SphereId(0), SphereId(1), SphereId(2)}}};
  for (const double azimuth : {0.0, std::numbers::pi}) {
    const Image image = drawn(shape, {.azimuth_rad = azimuth});
    EXPECT_EQ(seen(at(image, kSide / 2, kSide / 2)), Seen::Triangle);
  }
  for (sdk::Sphere& sphere : shape.spheres) sphere.radius = 0;  // a mesh: both sides in one plane
  for (const double azimuth : {0.0, std::numbers::pi}) {
    const Image image = drawn(shape, {.azimuth_rad = azimuth});
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) EXPECT_NE(seen(at(image, x, y)), Seen::Sphere) << "the colour of insides";
    EXPECT_EQ(seen(at(image, kSide / 2, kSide / 2)), Seen::Triangle);
  }
}

/// A square in the plane z = 0 of two triangles, lower right and upper left.
sdk::Mesh square() {
  sdk::Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.triangles = {{VertexId(0), VertexId(1), VertexId(2)}, {VertexId(0), VertexId(2), VertexId(3)}};
  return mesh;
}

TEST_F(Pictures, ShowTheColoursOfFaces) {
  sdk::Mesh mesh = square();
  mesh.vertex_colours.assign(4, {255, 255, 255});
  mesh.face_colours = {{220, 0, 0}, {0, 0, 220}};
  const Image image = drawn(mesh);
  EXPECT_EQ(seen(at(image, 140, 140)), Seen::Sphere);  // red
  EXPECT_EQ(seen(at(image, 60, 60)), Seen::Triangle);  // blue
}

TEST_F(Pictures, BlendTheColoursOfVertices) {
  sdk::Mesh mesh = square();
  mesh.vertex_colours = {{220, 0, 0}, {0, 220, 0}, {0, 220, 0}, {220, 0, 0}};
  const Image image = drawn(mesh);
  int last = 0;
  for (int x = 15; x < 185; x += 10) {
    const sdk::Colour colour = at(image, x, 100);
    const int greener = int{colour[1]} - int{colour[0]};
    if (x > 15) {
      EXPECT_GT(greener, last);
    }
    last = greener;
  }
}

TEST_F(Pictures, TellTheInsideOfAMeshFromItsOutside) {
  const Image front = drawn(square());
  const Image back = drawn(square(), {.azimuth_rad = std::numbers::pi});
  const sdk::Colour inside = at(back, 100, 100);
  EXPECT_GT(difference(at(front, 100, 100), inside), 40);
  EXPECT_LT(inside[1], inside[0]) << "the palette's colour of insides has little green";
}

TEST_F(Pictures, LayGlassOverWhatIsSolid) {
  Palette palette = kPrimary;
  palette.mesh = {0, 0, 220};
  sdk::Mesh pane = square();
  for (Vector3d& position : pane.positions) position.z() = 1.5;
  sdk::Mesh hidden = square();
  for (Vector3d& position : hidden.positions) position.z() = -1.5;
  const auto picture = [&](const sdk::Mesh* mesh, Layer layer) {
    Scene scene({{0, 0, 0}, 2}, palette);
    scene.add(ball());
    if (mesh != nullptr) scene.add(*mesh, {.layer = layer});
    return drawn(scene, fitted(sdk::SphereMesh{.spheres = {{{0, 0, 0}, 2}}}));
  };
  const sdk::Colour bare = at(picture(nullptr, Layer::Glass), 100, 100);
  const sdk::Colour covered = at(picture(&pane, Layer::Glass), 100, 100);
  EXPECT_GT(int{covered[0]}, 50) << "the ball shines through";
  EXPECT_LT(int{covered[0]}, int{bare[0]});
  EXPECT_GT(int{covered[2]}, int{bare[2]} + 30) << "the pane is seen, too";
  EXPECT_EQ(difference(at(picture(&hidden, Layer::Glass), 100, 100), bare), 0);
  EXPECT_EQ(seen(at(picture(&pane, Layer::Solid), 100, 100)), Seen::Triangle);
}

TEST_F(Pictures, AreTheSameBytesForTheSameScene) {
  const sdk::SphereMesh shape = edge({{-1, 0, 0}, 0.4}, {{1, 0.2, 0}, 0.1});
  const Image first = drawn(shape);
  static_cast<void>(drawn(ball()));
  EXPECT_EQ(first.rgb, drawn(shape).rgb);
  auto another = Renderer::create();
  ASSERT_TRUE(another);
  Scene scene({{0, 0, 0}, 2}, kPrimary);
  scene.add(shape);
  EXPECT_EQ(first.rgb, another->draw(scene, fitted(shape), kSide, kSide)->rgb);
}

TEST_F(Pictures, DoNotDependOnTheSizeOfAModelNorOnWhereItIs) {
  const auto picture = [](double scale, const Vector3d& offset) {
    const sdk::Sphere a{scale * Vector3d(-1, 0, 0) + offset, 0.4 * scale};
    const sdk::Sphere b{scale * Vector3d(1, 0.2, 0) + offset, 0.1 * scale};
    Scene scene({offset, 2 * scale}, kPrimary);
    scene.add(edge(a, b));
    return drawn(scene, fitted(edge(a, b)));
  };
  const Image plain = picture(1, Vector3d::Zero());
  EXPECT_LT(pixels_apart(plain, picture(1e-9, Vector3d::Zero()), 8), 20);
  EXPECT_LT(pixels_apart(plain, picture(1e9, Vector3d::Zero()), 8), 20);
  EXPECT_LT(pixels_apart(plain, picture(1, Vector3d(1e7, -2e7, 3e6)), 8), 20);
}

TEST_F(Pictures, OfNothingShowTheBackground) {
  Palette palette = kPrimary;
  palette.background_top = palette.background_bottom = {90, 120, 150};
  const Scene scene({{0, 0, 0}, 0}, palette);
  const Image image = drawn(scene, CameraFit({}, 1).camera());
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) EXPECT_LE(difference(at(image, x, y), {90, 120, 150}), 1);
}

TEST_F(Pictures, ThatDoNotFitTheCardAreRefused) {
  const Scene scene({{0, 0, 0}, 1});
  const auto image = renderer()->draw(scene, CameraFit({}, 1e5).camera(), 1'000'000, 10);
  ASSERT_FALSE(image);
  EXPECT_NE(image.error().message.find("pixels"), std::string::npos) << image.error().message;
  EXPECT_TRUE(renderer()->draw(scene, CameraFit({}, 1).camera(), kSide, kSide));
}

}  // namespace
}  // namespace armature::viewer
