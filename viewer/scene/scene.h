#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>
#include <armature/sdk/spheremesh/sphere_triangle.h>

#include "viewer/scene/palette.h"

namespace armature::viewer {

/// In which of a picture's two layers something is drawn.
enum class Layer : std::uint8_t {
  Solid,
  Glass,  ///< translucent, over what is solid; shows its foremost surface only
};

/// How a mesh is drawn.
struct MeshStyle {
  Layer layer = Layer::Solid;
  bool wireframe = false;   ///< its edges, over its faces
  double crease_rad = 0.6;  ///< edges sharper than this keep their faces apart in the shading
  ///@{
  /// By FaceId, of each corner, where the caller has them: `corner_normals()`, and colours instead of the mesh's own.
  std::span<const std::array<Eigen::Vector3d, 3>> normals = {};
  std::span<const std::array<sdk::Colour, 3>> colours = {};
  ///@}
};

/// How a sphere-mesh is drawn.
struct SphereMeshStyle {
  enum class Shape : std::uint8_t {
    Surface,    ///< the interpolated surface, exactly
    Structure,  ///< what spans it: small spheres, thin edges, flat triangles
  };
  Layer layer = Layer::Solid;
  Shape shape = Shape::Surface;
};

/// What is in a picture, in the form in which it is drawn: corners of triangles, spheres, and cones between spheres.
/// Single precision, in a frame of the scene's own, whatever the size of the model and its distance from the origin.
class Scene {
 public:
  /// A corner of a triangle: three make one.
  struct Corner {
    std::array<float, 3> position;
    std::array<float, 3> normal;  // outward, unit length
    std::uint32_t flags;          // kLines, kTwoSided, kOneSided
  };
  static constexpr std::uint32_t kLines = 1;     ///< the triangle's edges are drawn
  static constexpr std::uint32_t kTwoSided = 2;  ///< the triangle has no inside
  static constexpr std::uint32_t kOneSided = 4;  ///< the triangle cannot be seen from behind

  struct Ball {
    std::array<float, 4> sphere;  // centre, radius
    sdk::Colour colour;
    std::uint8_t unused = 0;
  };
  struct Cone {
    std::array<float, 4> a, b;  // its spheres: centre, radius; neither holds the other
    sdk::Colour colour;
    std::uint8_t unused = 0;
  };
  struct Content {
    std::vector<Corner> corners;
    std::vector<sdk::Colour> colours;  // of the corners, apart: they change more often
    std::vector<Ball> balls;
    std::vector<Cone> cones;
  };

  /// `frame`: a sphere about as large as what will be added, and around it.
  explicit Scene(const sdk::Sphere& frame, const Palette& palette = {});

  /// Uses the mesh's own colours, a face's before its vertices', where it has any.
  void add(const sdk::Mesh& mesh, const MeshStyle& style = {});
  void add(const sdk::SphereMesh& shape, const SphereMeshStyle& style = {});

  [[nodiscard]] const Content& content(Layer layer) const noexcept { return layers_[static_cast<std::size_t>(layer)]; }
  [[nodiscard]] const sdk::Sphere& frame() const noexcept { return frame_; }
  [[nodiscard]] const Palette& palette() const noexcept { return palette_; }

 private:
  Content& content_of(Layer layer) noexcept { return layers_[static_cast<std::size_t>(layer)]; }
  void add_surface(const sdk::SphereMesh& shape, Content& content) const;
  void add_structure(const sdk::SphereMesh& shape, Content& content) const;
  void add_ball(const sdk::Sphere& sphere, const sdk::Colour& colour, Content& content) const;
  void add_cone(const sdk::SphereEdge& edge, const sdk::Colour& colour, Content& content) const;
  void add_facets(const sdk::SphereTriangle& triangle, Content& content) const;
  void add_triangle(const std::array<Eigen::Vector3d, 3>& corners, const Eigen::Vector3d& normal, std::uint32_t flags,
                    Content& content) const;
  [[nodiscard]] std::array<float, 3> local(const Eigen::Vector3d& point) const;
  [[nodiscard]] std::array<float, 4> local(const sdk::Sphere& sphere) const;

  sdk::Sphere frame_;
  Palette palette_;
  std::array<Content, 2> layers_;  // by Layer
};

}  // namespace armature::viewer
