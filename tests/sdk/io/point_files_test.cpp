#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <variant>
#include <vector>

#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/io/write_mesh.h>
#include <gtest/gtest.h>

namespace armature::sdk {
namespace {

PointSet points_in(const std::string& text, MeshFormat format) {
  auto read = parse_mesh_or_points(text, format, "scan");
  EXPECT_TRUE(read) << (read ? "" : read.error().message);
  if (!read || !std::holds_alternative<PointSet>(*read)) {
    ADD_FAILURE() << "expected points";
    return {};
  }
  return std::get<PointSet>(*read);
}

std::string message_of(const std::string& text, MeshFormat format) {
  const auto read = parse_mesh_or_points(text, format, "scan");
  return read ? "accepted" : read.error().message;
}

void expect_two_points(const PointSet& points) {
  ASSERT_EQ(points.positions.size(), 2U);
  EXPECT_EQ(points.positions[1], Eigen::Vector3d(1, 2, 3.5));
  EXPECT_EQ(points.normals[0], Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(points.normals[1], Eigen::Vector3d(0, -1, 0));  // of unit length, though the file has 2
  EXPECT_TRUE(validate(points));
}

TEST(PointFiles, AreReadFromLinesOfSixNumbers) {
  for (const char* text : {"0 0 0 0 0 1\n1 2 3.5 0 -2 0\n", "# a scan\n2\n0 0 0 0 0 1\r\n\n1 2 3.5 0 -2 0"})
    expect_two_points(points_in(text, MeshFormat::Xyz));
  for (const char* name : {"a.xyz", "a.XYZN", "a.pwn"}) EXPECT_EQ(mesh_format_of(name), MeshFormat::Xyz) << name;
}

TEST(PointFiles, AreReadFromObjectsWithoutFaces) {
  // Which normal is whose goes by their order, wherever they stand.
  expect_two_points(points_in("vn 0 0 1\nvn 0 -2 0\nv 0 0 0\nv 1 2 3.5\n", MeshFormat::Obj));
  expect_two_points(points_in("v 0 0 0\nvn 0 0 1\nv 1 2 3.5 .5 0 0\nvn 0 -2 0\n", MeshFormat::Obj));
  expect_two_points(points_in("NOFF\n2 0 0\n0 0 0 0 0 1\n1 2 3.5 0 -2 0\n", MeshFormat::Off));
}

TEST(PointFiles, AreReadFromPlyWithAreasAndColours) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\n";
  const PointSet plain = points_in(head + "end_header\n0 0 0 0 0 1\n1 2 3.5 0 -2 0\n", MeshFormat::Ply);
  expect_two_points(plain);
  EXPECT_TRUE(plain.areas.empty());
  const PointSet more =
      points_in(head +
                    "property double area\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                    "element face 0\nproperty list uchar int vertex_indices\nend_header\n"
                    "0 0 0 0 0 1 0.25 255 0 9\n1 2 3.5 0 -2 0 0 1 2 3\n",
                MeshFormat::Ply);
  expect_two_points(more);
  EXPECT_EQ(more.areas, (std::vector<double>{0.25, 0}));
  EXPECT_EQ(more.colours, (std::vector<Colour>{{255, 0, 9}, {1, 2, 3}}));
}

TEST(PointFiles, OfEveryKindComeBackAsTheyWere) {
  PointSet points;
  for (int i = 0; i < 200; ++i) {
    points.positions.emplace_back(std::sin(i), std::ldexp(std::cos(i), i - 100), i / 3.0);
    points.normals.push_back(Eigen::Vector3d(std::cos(i), 0.1, std::sin(i)).normalized());
    points.areas.push_back(i / 7.0);
    points.colours.push_back({static_cast<std::uint8_t>(i), 1, 2});
  }
  for (const auto& [format, ascii] : {std::pair{MeshFormat::Ply, false}, std::pair{MeshFormat::Ply, true},
                                      std::pair{MeshFormat::Obj, true}, std::pair{MeshFormat::Xyz, true}}) {
    const auto bytes = encode_points(points, format, ascii);
    ASSERT_TRUE(bytes);
    const PointSet back = points_in(*bytes, format);
    EXPECT_EQ(back.positions, points.positions);
    ASSERT_EQ(back.normals.size(), points.normals.size());
    for (std::size_t i = 0; i < back.normals.size(); ++i)
      EXPECT_LT((back.normals[i] - points.normals[i]).norm(), 1e-15);  // made of unit length again
    if (format == MeshFormat::Ply) {
      EXPECT_EQ(back.areas, points.areas);
    }
    if (format != MeshFormat::Xyz) {
      EXPECT_EQ(back.colours, points.colours);
    }
  }
  EXPECT_FALSE(encode_points(points, MeshFormat::Off));
  points.colours.pop_back();
  EXPECT_FALSE(encode_points(points, MeshFormat::Ply));
}

TEST(PointFiles, NormalsOfAnyLengthComeOutOfUnitLength) {
  const auto normal_of = [](const std::string& three, MeshFormat format) {
    const std::string text =
        format == MeshFormat::Xyz ? "0 0 0 " + three + "\n"
        : format == MeshFormat::Obj
            ? "v 0 0 0\nvn " + three + "\n"
            : "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
              "property double nx\nproperty double ny\nproperty double nz\nend_header\n0 0 0 " +
                  three + "\n";
    return points_in(text, format).normals.at(0);
  };
  for (const MeshFormat format : {MeshFormat::Xyz, MeshFormat::Obj, MeshFormat::Ply}) {
    for (const char* length : {"1.7e308", "1", "1e-200", "5e-324"}) {
      const std::string three = std::string(length) + " -" + length + " " + length;
      EXPECT_LT((normal_of(three, format) - Eigen::Vector3d(1, -1, 1) / std::sqrt(3)).norm(), 1e-15) << length;
    }
    EXPECT_EQ(normal_of("0 0 5e-324", format), Eigen::Vector3d(0, 0, 1));
  }
}

TEST(PointFiles, ThatAreWrongAreRefusedWithThePlaceAndWhatToDo) {
  const auto xyz = [](const char* text) { return message_of(text, MeshFormat::Xyz); };
  EXPECT_EQ(xyz("0 0 0 0 0 1\n1 2 3\n"),
            "scan, line 2: expected six numbers X Y Z NX NY NZ; estimate normals first where there are none; the line "
            "ends here");
  EXPECT_EQ(
      xyz("0 0 0 0 0 0\n"),
      "scan, line 1: expected a normal that points outward; estimate it anew or leave the point out; found '0 0 0'");
  EXPECT_EQ(xyz("0 0 0 0 0 nan\n"), "scan, line 1: expected six finite numbers X Y Z NX NY NZ; found 'nan'");
  EXPECT_EQ(xyz("0 1e999 0 0 0 1\n"), "scan, line 1: expected six finite numbers X Y Z NX NY NZ; found '1e999'");
  EXPECT_EQ(xyz("0 0 0 0 0 1 7\n"), "scan, line 1: expected six numbers X Y Z NX NY NZ and no more; found '7'");
  EXPECT_EQ(xyz("3\n0 0 0 0 0 1\n"),
            "scan, line 3: expected 3 points, as the first line says, but 1 are there; the file ends here");
  EXPECT_EQ(xyz("-3\n"), "scan, line 1: expected six numbers X Y Z NX NY NZ, or how many points follow; found '-3'");
  EXPECT_EQ(xyz("\n# nothing\n"), "scan: expected at least one point; it has none");
  EXPECT_EQ(xyz("0\n"), "scan: expected at least one point; it has none");
  EXPECT_EQ(message_of("v 0 0 0\nv 1 1 1\nvn 0 0 1\n", MeshFormat::Obj),
            "scan: expected as many normals vn as vertices v, 2, for points without faces; found 1");
  EXPECT_EQ(message_of("v 0 0 0\nvn 0 0 1\nvn 0 0 1\n", MeshFormat::Obj),
            "scan, line 3: expected 1 normals vn, one a vertex v; found 'vn'");
  EXPECT_EQ(message_of("v 0 0 0\nvn 0 nan 1\n", MeshFormat::Obj),
            "scan, line 2: expected a normal of finite numbers; found 'vn'");
  EXPECT_EQ(message_of("v 0 0 0\nvn 0 1\n", MeshFormat::Obj),
            "scan, line 2: expected three numbers of a normal; the line ends here");
  EXPECT_EQ(message_of("v 0 0 0\n", MeshFormat::Obj),
            "scan: expected at least one face, or a normal for every point; it has neither: estimate normals first");
  EXPECT_EQ(message_of("NOFF\n1 0 0\n0 0 0 0 1\n", MeshFormat::Off),
            "scan, line 3: expected three coordinates and a normal; the line ends here");
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\nproperty float area\nend_header\n";
  EXPECT_EQ(
      message_of(head + "0 0 0 0 0 0 1\n", MeshFormat::Ply),
      "scan, line 12: expected a normal that points outward; estimate it anew or leave the point out; found '0 0 0'");
  EXPECT_EQ(message_of(head + "0 0 0 0 0 1 -1\n", MeshFormat::Ply),
            "scan, line 12: expected an area that is finite and not negative; found '-1'");
}

TEST(PointFiles, AreNoMeshesAndWhoNeedsOneIsTold) {
  const auto mesh = parse_mesh("0 0 0 0 0 1\n", MeshFormat::Xyz, "scan.xyz");
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.error().message,
            "scan.xyz: has 1 points and no faces; expected a triangle mesh: reconstruct its surface first");
}

TEST(PointFiles, NormalsOfMeshesAreNobodysBusiness) {
  const std::string faces = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn nan 0 0\nvn 0 0 0\nf 1 2 3\n";
  const auto read = parse_mesh_or_points(faces, MeshFormat::Obj, "shape");
  ASSERT_TRUE(read);
  EXPECT_EQ(std::get<Mesh>(*read).triangles.size(), 1U);
  EXPECT_TRUE(
      parse_mesh("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                 "property float nx\nproperty float ny\nproperty float nz\nelement face 1\nproperty list uchar int "
                 "vertex_indices\nend_header\n0 0 0 0 0 0\n1 0 0 0 0 0\n0 1 0 0 0 0\n3 0 1 2\n",
                 MeshFormat::Ply, "shape"));
}

}  // namespace
}  // namespace armature::sdk
