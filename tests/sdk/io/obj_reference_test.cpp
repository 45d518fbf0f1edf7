#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/mesh/triangulate.h>
#include <gtest/gtest.h>
#include <tiny_obj_loader.h>

namespace armature::sdk {
namespace {

/// What tinyobjloader makes of a file, cut into triangles by us.
Mesh by_tinyobjloader(const std::string& file) {
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> materials;
  std::string warning;
  std::string error;
  Mesh mesh;
  EXPECT_TRUE(tinyobj::LoadObj(&attributes, &shapes, &materials, &warning, &error, file.c_str(), nullptr,
                               /*triangulate=*/false))
      << error;
  for (std::size_t i = 0; i + 2 < attributes.vertices.size(); i += 3)
    mesh.positions.emplace_back(attributes.vertices[i], attributes.vertices[i + 1], attributes.vertices[i + 2]);
  for (const tinyobj::shape_t& shape : shapes) {
    std::size_t at = 0;
    for (const auto count : shape.mesh.num_face_vertices) {
      std::vector<VertexId> corners;
      for (std::size_t k = 0; k < count; ++k) corners.emplace_back(shape.mesh.indices[at++].vertex_index);
      triangulate_polygon(corners, mesh.positions, mesh.triangles);
    }
  }
  return mesh;
}

class ObjModels : public testing::TestWithParam<const char*> {};

TEST_P(ObjModels, AreWhatTinyobjloaderReadsButForItsRounding) {
  const auto path = std::filesystem::path("../shared/data/meshes") / GetParam();
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto ours = read_mesh(path);
  ASSERT_TRUE(ours) << ours.error().message;
  const Mesh theirs = by_tinyobjloader(path.string());
  ASSERT_EQ(ours->positions.size(), theirs.positions.size());
  for (std::size_t i = 0; i < theirs.positions.size(); ++i)
    for (int k = 0; k < 3; ++k)
      ASSERT_NEAR(ours->positions[i][k], theirs.positions[i][k], 1e-14 * std::abs(theirs.positions[i][k])) << i;
  EXPECT_EQ(ours->triangles, theirs.triangles);
}

INSTANTIATE_TEST_SUITE_P(Obj, ObjModels,
                         testing::Values("as_WusonOBJ.obj", "c3d_cow.obj", "c3d_suzanne.obj", "cino_soccerball.obj",
                                         "gc_moebius.obj", "geo_cube_with_8_spheres.obj", "ml_office_chair.obj",
                                         "vh4_caterpillar.obj"),
                         [](const auto& model) {
                           std::string name = model.param;
                           name.resize(name.find('.'));
                           for (char& c : name)
                             if (c == '-') c = '_';
                           return name;
                         });

}  // namespace
}  // namespace armature::sdk
