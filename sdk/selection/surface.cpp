#include <string>

#include <armature/sdk/mesh/measures.h>
#include <armature/sdk/selection/surface.h>

namespace armature::sdk {

Surface::Surface(const Mesh& of_mesh)
    : mesh(of_mesh),
      adjacency(of_mesh),
      tree(of_mesh),
      vertex_normals(armature::sdk::vertex_normals(of_mesh)),
      vertex_areas(barycentric_areas(of_mesh)),
      diagonal(bounding_box_diagonal(of_mesh)) {}

Expected<std::vector<SurfacePoint>> project_stroke(const Surface& surface, const std::vector<Eigen::Vector3d>& stroke,
                                                   std::string_view what) {
  std::vector<SurfacePoint> points;
  points.reserve(stroke.size());
  for (std::size_t i = 0; i < stroke.size(); ++i) {
    const auto refuse = [&](const std::string& why) {
      return fail(std::string(what) + ", point " + std::to_string(i) + ": " + why);
    };
    if (!stroke[i].allFinite()) return refuse("expected finite coordinates");
    const FaceId hint = points.empty() ? FaceId() : points.back().face;
    points.push_back(surface.tree.closest(stroke[i], {.hint = hint}));
    if (!points.back().face.valid()) return refuse("the mesh has no face to draw on");
    if (points.back().distance > kFarthestStroke * surface.diagonal)
      return refuse("lies " + std::to_string(points.back().distance / surface.diagonal * 100) +
                    " % of the bounding box's diagonal away from the surface; draw within 5 % of it");
  }
  return points;
}

}  // namespace armature::sdk
