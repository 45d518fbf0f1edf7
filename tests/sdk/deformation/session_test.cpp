#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <armature/sdk/deformation/session.h>
#include <armature/sdk/hierarchy/build.h>
#include <gtest/gtest.h>

#include "tests/sdk/deformation/tubes.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

struct Tube {
  Tube() : mesh(tubes::tube(10, 0.6, 0.04, 32, 160)), hierarchy(build_hierarchy(mesh).value().hierarchy) {}
  [[nodiscard]] DeformationSession session(std::size_t level) const {
    return DeformationSession::start(mesh, hierarchy, level).value();
  }
  /// How far a sphere is from the planes of the faces within a region, squared and times their areas.
  [[nodiscard]] double error(NodeId node, std::span<const Vector3d> positions, const Sphere& sphere) const {
    const auto [begin, end] = hierarchy.range(node);
    double sum = 0;
    for (const Triangle& corners : mesh.triangles) {
      if (!std::ranges::all_of(corners,
                               [&](VertexId v) { return begin <= hierarchy.place(v) && hierarchy.place(v) < end; }))
        continue;
      const Vector3d& a = positions[corners[0].index()];
      const Vector3d cross = (positions[corners[1].index()] - a).cross(positions[corners[2].index()] - a);
      sum += std::pow(cross.normalized().dot(a - sphere.centre) - sphere.radius, 2) * cross.norm() / 2;
    }
    return sum;
  }
  Mesh mesh;
  Hierarchy hierarchy;
};

std::vector<SphereId> spheres_where(const DeformationSession& session, auto&& is) {
  std::vector<SphereId> found;
  for (std::size_t s = 0; s < session.shape().spheres.size(); ++s)
    if (is(session.shape().spheres[s])) found.emplace_back(s);
  return found;
}

std::vector<Vector3d> positions(const DeformationSession& session) {
  return {session.positions().begin(), session.positions().end()};
}

double farthest_apart(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  double most = 0;
  for (std::size_t v = 0; v < a.size(); ++v) most = std::max(most, (a[v] - b[v]).norm());
  return most;
}

/// Lifts the right end at the level it is at.
void bend(DeformationSession& session) {
  const SphereMove move{.spheres = spheres_where(session, [](const Sphere& s) { return s.centre.x() > 1; }),
                        .rotate = {0, 0, 0.6},
                        .about = Vector3d::Zero()};
  ASSERT_TRUE(session.move(move));
}

TEST(DeformationSession, DoesOneMoveAsDeformDoes) {
  const Tube tube;
  auto session = tube.session(8);
  const SphereMove move{.spheres = {SphereId(2), SphereId(5)}, .translate = {0, 1, 0}, .rotate = {0.4, 0, 0.2}};
  ASSERT_TRUE(session.move(move));
  EXPECT_EQ(positions(session), deform(tube.mesh, tube.hierarchy, 8, std::vector{move})->positions);
}

TEST(DeformationSession, ShowsAPreviewAndDropsIt) {
  const Tube tube;
  auto session = tube.session(8);
  const Sphere before = session.shape().spheres[3];
  ASSERT_TRUE(session.preview({.spheres = {SphereId(3)}, .translate = {0, 0, 2}}));
  ASSERT_TRUE(session.preview({.spheres = {SphereId(3)}, .translate = {0, 0, 1}}));
  EXPECT_LT((session.shape().spheres[3].centre - before.centre - Vector3d(0, 0, 1)).norm(), 1e-12);
  EXPECT_NE(positions(session), tube.mesh.positions);
  session.cancel();
  EXPECT_EQ(positions(session), tube.mesh.positions);
  EXPECT_EQ(session.shape().spheres[3].centre, before.centre);
  EXPECT_FALSE(session.undo());
}

TEST(DeformationSession, FitsTheSpheresToWhatWasDeformedAtEveryLevel) {
  const Tube tube;
  auto session = tube.session(8);
  const auto fat = spheres_where(session, [](const Sphere& s) { return std::abs(s.centre.x()) < 2; });
  ASSERT_FALSE(fat.empty());
  const double radius = session.shape().spheres[fat[0].index()].radius;
  for (const SphereId sphere : fat) ASSERT_TRUE(session.move({.spheres = {sphere}, .radius = 1.6 * radius}));
  bend(session);
  const Refit refit(tube.mesh, tube.hierarchy);
  for (const std::size_t level : {8, 5, 20, 8}) {
    ASSERT_TRUE(session.go_to(level));
    double widest = 0;
    for (const Sphere& sphere : session.shape().spheres) widest = std::max(widest, sphere.radius);
    EXPECT_GT(widest, 1.25 * radius) << level;
    // Nearer to the planes of their faces than where rigid motions of the regions would take them.
    double fitted = 0;
    double carried = 0;
    for (std::size_t s = 0; s < level; ++s) {
      const NodeId node = session.nodes()[s];
      const Sphere was = tube.hierarchy.sphere(node);
      const RegionFrame frame = refit.frame(node, session.positions());
      const Sphere gone{frame(was.centre), frame.scale * was.radius};
      fitted += tube.error(node, session.positions(), session.shape().spheres[s]);
      carried += tube.error(node, session.positions(), gone);
    }
    EXPECT_LT(fitted, carried) << level;
  }
}

TEST(DeformationSession, UndoesAndRedoesBitByBit) {
  const Tube tube;
  auto session = tube.session(8);
  std::vector<std::vector<Vector3d>> states = {positions(session)};
  std::vector<SphereMesh> shapes = {session.shape()};
  for (int k = 0; k < 4; ++k) {
    ASSERT_TRUE(session.move({.spheres = {SphereId(k)}, .translate = {0, 0.2, 0.1 * k}, .rotate = {0.2, 0, 0}}));
    states.push_back(positions(session));
    shapes.push_back(session.shape());
  }
  for (int k = 3; k >= 0; --k) {
    ASSERT_TRUE(session.undo());
    EXPECT_EQ(positions(session), states[static_cast<std::size_t>(k)]);
    EXPECT_EQ(session.shape().spheres[2].centre, shapes[static_cast<std::size_t>(k)].spheres[2].centre);
  }
  EXPECT_FALSE(session.undo());
  for (std::size_t k = 1; k <= 4; ++k) {
    ASSERT_TRUE(session.redo());
    EXPECT_EQ(positions(session), states[k]);
  }
  EXPECT_FALSE(session.redo());
  ASSERT_TRUE(session.undo());
  bend(session);
  EXPECT_FALSE(session.redo()) << "a new move ends what could be done again";
}

TEST(DeformationSession, KeepsAFineEditWhenACoarseMoveFollows) {
  // Fine, then coarse, or coarse, then the same fine edit in the frame of its parent.
  const Tube tube;
  const auto coarse = [](DeformationSession& session) {
    ASSERT_TRUE(session.go_to(8));
    const SphereMove move{.spheres = spheres_where(session, [](const Sphere& s) { return s.centre.x() > -1; }),
                          .translate = {0, 0, 1},
                          .rotate = {0.3, 0.2, 0.9},
                          .about = Vector3d(-1, 0, 0)};
    ASSERT_TRUE(session.move(move));
  };
  auto probe = tube.session(60);
  // The outermost sphere at the right end, far from where the coarse move bends.
  const auto& spheres = probe.shape().spheres;
  std::size_t tip = 0;
  for (std::size_t s = 0; s < spheres.size(); ++s)
    if (spheres[s].centre.x() > spheres[tip].centre.x()) tip = s;
  const SphereMove detail{.spheres = {SphereId(tip)},
                          .translate = {0.3, 0.2, 0},
                          .rotate = {0, 0.4, 0},
                          .about = Vector3d(5, 0.1, 0),
                          .scale = 1.2};
  const auto fine = [&](DeformationSession& session) {
    ASSERT_TRUE(session.go_to(60));
    ASSERT_TRUE(session.move(detail, {.frame = MoveFrame::Parent}));
  };
  auto fine_first = tube.session(60);
  fine(fine_first);
  coarse(fine_first);
  auto coarse_first = tube.session(60);
  coarse(coarse_first);
  fine(coarse_first);
  // A hierarchy's spheres are floats.
  EXPECT_LT(farthest_apart(positions(fine_first), positions(coarse_first)), 1e-7);
  auto coarse_alone = tube.session(60);
  coarse(coarse_alone);
  EXPECT_GT(farthest_apart(positions(fine_first), positions(coarse_alone)), 0.1);
}

TEST(DeformationSession, EditsSeveralSpheresInTheFrameOfTheSphereAboveThem) {
  const Tube tube;
  const auto fine = [](DeformationSession& session) {
    ASSERT_TRUE(session.go_to(30));
    ASSERT_TRUE(session.move({.spheres = {SphereId(4), SphereId(20)}, .translate = {0, 0.5, 0}, .rotate = {0.3, 0, 0}},
                             {.frame = MoveFrame::Parent}));
  };
  const auto turn_all = [](DeformationSession& session) {
    ASSERT_TRUE(session.go_to(6));
    const SphereMove move{.spheres = spheres_where(session, [](const Sphere&) { return true; }),
                          .translate = {1, 2, 3},
                          .rotate = {0.2, 0, 1.5},
                          .about = Vector3d(0, 1, 0),
                          .scale = 1.3};
    ASSERT_TRUE(session.move(move));
  };
  auto fine_first = tube.session(6);
  fine(fine_first);
  turn_all(fine_first);
  auto fine_last = tube.session(6);
  turn_all(fine_last);
  fine(fine_last);
  // Without `about` a move turns about fitted spheres: see Refit.
  EXPECT_LT(farthest_apart(positions(fine_first), positions(fine_last)), 1e-3);
}

TEST(DeformationSession, PinnedSpheresStayAtEveryLevel) {
  const Tube tube;
  auto session = tube.session(4);
  std::size_t pinned = 0;
  for (std::size_t s = 0; s < 4; ++s)
    if (session.shape().spheres[s].centre.x() > session.shape().spheres[pinned].centre.x()) pinned = s;
  const auto weights = session.weights().of_sphere(pinned);
  const auto lift_all = [&] {
    const SphereMove move{.spheres = spheres_where(session, [](const Sphere&) { return true; }),
                          .translate = {0, 1, 0}};
    ASSERT_TRUE(session.move(move));
  };
  const std::vector<SphereId> pins = {SphereId(pinned)};
  ASSERT_TRUE(session.pin(pins));
  EXPECT_TRUE(session.is_pinned(SphereId(pinned)));
  lift_all();
  ASSERT_TRUE(session.go_to(2));
  lift_all();
  ASSERT_TRUE(session.go_to(200));
  EXPECT_FALSE(spheres_where(session, [](const Sphere&) { return true; }).empty());
  std::size_t held = 0;
  for (std::size_t s = 0; s < 200; ++s) held += session.is_pinned(SphereId(s)) ? 1 : 0;
  EXPECT_GT(held, 0U) << "parts of what is pinned are pinned";
  // At the level where it was pinned and at a coarser one the mesh was lifted by 1, but for the pin's share.
  std::size_t whole = 0;
  for (std::size_t v = 0; v < weights.size(); ++v) {
    const double lifted = session.positions()[v].y() - tube.mesh.positions[v].y();
    // What is cut off weights depends on the level.
    EXPECT_NEAR(lifted, 2 * (1 - weights[v]), 2.0 * static_cast<double>(SphereWeights::kCut));
    if (weights[v] == 1) {
      EXPECT_LT(std::abs(lifted), 1e-6);
      ++whole;
    }
  }
  EXPECT_GT(whole, 10U);
  ASSERT_TRUE(session.go_to(4));
  ASSERT_TRUE(session.pin(pins, false));
  EXPECT_FALSE(session.is_pinned(SphereId(pinned)));
  ASSERT_TRUE(session.undo());
  EXPECT_TRUE(session.is_pinned(SphereId(pinned)));
}

TEST(DeformationSession, ASurfaceFollowsItsFineSpheresAsRigidlyAsPossible) {
  const Tube tube;
  auto session = tube.session(400);
  // A sphere of this level weighs so little that blending hardly moves anything.
  std::size_t top = 0;
  const auto& spheres = session.shape().spheres;
  for (std::size_t s = 0; s < spheres.size(); ++s)
    if (spheres[s].centre.z() - std::abs(spheres[s].centre.x()) >
        spheres[top].centre.z() - std::abs(spheres[top].centre.x()))
      top = s;
  const SphereMove pull{.spheres = {SphereId(top)}, .translate = {0, 0, 0.3}};
  ASSERT_TRUE(session.preview(pull, {.surface_rings = 3}));
  const auto own = tube.hierarchy.vertices(session.nodes()[top]);
  for (const VertexId v : own)
    EXPECT_LT((session.positions()[v.index()] - tube.mesh.positions[v.index()] - Vector3d(0, 0, 0.3)).norm(), 1e-12);
  std::size_t moved = 0;
  double turned_over = 0;
  const auto before = face_normals(tube.mesh);
  Mesh pulled = tube.mesh;
  pulled.positions = positions(session);
  const auto after = face_normals(pulled);
  for (std::size_t v = 0; v < pulled.positions.size(); ++v) {
    const double distance = (pulled.positions[v] - tube.mesh.positions[v]).norm();
    moved += distance > 0 ? 1 : 0;
    EXPECT_LT(distance, 0.35);
  }
  for (std::size_t f = 0; f < before.size(); ++f) turned_over += before[f].dot(after[f]) < 0 ? 1 : 0;
  EXPECT_GT(moved, 3 * own.size());
  EXPECT_LT(moved, pulled.positions.size() / 4);
  EXPECT_EQ(turned_over, 0);
  session.commit();
  EXPECT_NE(session.text().find("surface 3"), std::string::npos);
  auto again = tube.session(2);
  ASSERT_TRUE(again.replay(session.text(), "again.txt"));
  EXPECT_EQ(positions(again), pulled.positions);
}

TEST(DeformationSession, MovesASurfaceOfOneSphereOrOfManyMoreEdgesThanThereAre) {
  const Tube tube;
  auto session = tube.session(1);
  const std::vector<SphereId> first = {SphereId(0)};
  for (const std::size_t rings : {std::size_t{1}, std::numeric_limits<std::size_t>::max()}) {
    // There is nothing around the only sphere.
    ASSERT_TRUE(session.go_to(1));
    ASSERT_TRUE(session.preview({.spheres = first, .translate = {1, 2, 3}}, {.surface_rings = rings}));
    for (std::size_t v = 0; v < tube.mesh.positions.size(); ++v)
      EXPECT_LT((session.positions()[v] - tube.mesh.positions[v] - Vector3d(1, 2, 3)).norm(), 1e-12);
    // The others all follow, whatever is left of them.
    ASSERT_TRUE(session.go_to(6));
    ASSERT_TRUE(session.preview({.spheres = first, .translate = {0, 0, 0.1}}, {.surface_rings = rings}));
    for (const VertexId v : tube.hierarchy.vertices(session.nodes()[0]))
      EXPECT_LT((session.positions()[v.index()] - tube.mesh.positions[v.index()] - Vector3d(0, 0, 0.1)).norm(), 1e-12);
  }
}

TEST(AsRigidAsPossible, FindsARigidMotionWhereThatIsPossible) {
  const Mesh mesh = tubes::tube(6, 1, 0.05);
  std::vector<bool> is_free(mesh.positions.size());
  std::vector<Vector3d> positions = mesh.positions;
  const Eigen::AngleAxisd turn(0.7, Vector3d(1, 2, 0).normalized());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    is_free[v] = std::abs(positions[v].x()) < 2;
    if (!is_free[v]) positions[v] = turn * positions[v];
  }
  const auto surface = AsRigidAsPossible::of(laplacian(mesh, Adjacency(mesh)), mesh.positions, is_free).value();
  surface.solve(positions, 400);
  for (std::size_t v = 0; v < positions.size(); ++v) EXPECT_LT((positions[v] - turn * mesh.positions[v]).norm(), 1e-3);
}

TEST(DeformationSession, IsSavedAndReplayedBitByBit) {
  const Tube tube;
  auto session = tube.session(8);
  bend(session);
  ASSERT_TRUE(session.go_to(3));
  ASSERT_TRUE(session.move({.spheres = {SphereId(1)}, .translate = {0.1, 1.0 / 3, -2e-7}, .scale = 1.1}));
  ASSERT_TRUE(session.go_to(25));
  const std::vector<SphereId> pins = {SphereId(7), SphereId(3)};
  ASSERT_TRUE(session.pin(pins));
  ASSERT_TRUE(session.move({.spheres = {SphereId(11)}, .about = Vector3d(1, 2, 3), .radius = 0.9},
                           {.frame = MoveFrame::Parent}));
  ASSERT_TRUE(session.move({.spheres = {SphereId(12)}, .translate = {0, 0, 1}}));
  ASSERT_TRUE(session.undo());
  ASSERT_TRUE(session.go_to(9));
  const std::string text = session.text();
  auto again = tube.session(2);
  const auto replayed = again.replay(text, "again.txt");
  ASSERT_TRUE(replayed) << replayed.error().message;
  EXPECT_EQ(positions(again), positions(session));
  EXPECT_EQ(again.nodes().size(), 9U);
  EXPECT_EQ(again.text(), text);
  EXPECT_TRUE(again.undo());
}

TEST(DeformationSession, ReplaysAllOfATextOrNothing) {
  const Tube tube;
  auto session = tube.session(8);
  bend(session);
  ASSERT_TRUE(session.go_to(5));
  ASSERT_TRUE(session.move({.spheres = {SphereId(2)}, .translate = {0, 0, 0.3}}));
  EXPECT_EQ(session.steps(), 2U);
  ASSERT_TRUE(session.undo());
  const std::size_t steps = session.steps();
  const auto before = positions(session);
  const std::string text = session.text();
  const std::string head = "armature deformation 1\nlevel 3\nmove spheres 1 translate 0 1 0\npin spheres 0\n";
  // One line says nothing; one says what cannot be done, which only doing it tells.
  for (const std::string wrong : {"move nothing\n", "move spheres 1 translate 0 1e200 0\n"}) {
    ASSERT_TRUE(session.preview({.spheres = {SphereId(1)}, .translate = {0, 0.5, 0}}));
    const auto replayed = session.replay(head + wrong, "s.txt");
    ASSERT_FALSE(replayed);
    EXPECT_EQ(replayed.error().message.find("s.txt, line 5: "), 0U) << replayed.error().message;
    EXPECT_EQ(session.steps(), steps);
    EXPECT_EQ(session.nodes().size(), 5U);
    EXPECT_EQ(positions(session), before);
    EXPECT_EQ(session.text(), text);
    EXPECT_FALSE(session.is_pinned(SphereId(0)));
  }
  // The same where somebody stops it in the middle.
  const std::vector<Sphere> spheres = session.shape().spheres;
  std::stop_source stopper;
  std::vector<double> told;
  const auto stopped = session.replay(head + "move spheres 1 translate 0 1 0\n", "s.txt",
                                      {.stop = stopper.get_token(), .progress = [&](std::string_view, double fraction) {
                                         told.push_back(fraction);
                                         if (fraction > 0.7) stopper.request_stop();
                                       }});
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::Cancelled);
  EXPECT_EQ(told, (std::vector{0.0, 0.25, 0.5, 0.75}));
  EXPECT_EQ(positions(session), before);
  EXPECT_EQ(session.text(), text);
  for (std::size_t s = 0; s < spheres.size(); ++s) {
    EXPECT_EQ(session.shape().spheres[s].centre, spheres[s].centre);
    EXPECT_EQ(session.shape().spheres[s].radius, spheres[s].radius);
  }
  EXPECT_TRUE(session.redo()) << "what was undone before is still there";
  EXPECT_TRUE(session.undo());
  ASSERT_TRUE(session.replay(head, "s.txt"));
  EXPECT_EQ(session.steps(), steps + 2);
  EXPECT_FALSE(session.redo());
}

TEST(DeformationSession, WeighsALevelAsItIsUndeformed) {
  const Tube tube;
  for (const WeightSource source : {WeightSource::Clusters, WeightSource::ClosestPrimitive}) {
    const DeformOptions options{.weights = source};
    auto bent = DeformationSession::start(tube.mesh, tube.hierarchy, 6, options).value();
    const auto straight = DeformationSession::start(tube.mesh, tube.hierarchy, 12, options).value();
    bend(bent);
    ASSERT_TRUE(bent.go_to(12));
    for (std::size_t s = 0; s < 12; ++s) {
      EXPECT_EQ(bent.weights().columns[s]->vertices, straight.weights().columns[s]->vertices) << s;
      EXPECT_EQ(bent.weights().columns[s]->weights, straight.weights().columns[s]->weights) << s;
    }
  }
}

TEST(DeformationSession, RefusesTextsLineByLine) {
  const Tube tube;
  const std::string head = "armature deformation 1\n";
  const auto message = [&](const std::string& text) {
    auto session = tube.session(4);
    const auto replayed = session.replay(text, "s.txt");
    return replayed ? std::string("taken") : replayed.error().message;
  };
  EXPECT_EQ(message(""), "s.txt: is empty; expected `armature deformation 1`");
  EXPECT_EQ(message("PNG"), "s.txt, line 1: expected `armature deformation 1`; is this a deformation session?");
  EXPECT_EQ(message(head + "vertices 7\n"), "s.txt, line 2: expected a session of a mesh with " +
                                                std::to_string(tube.mesh.positions.size()) + " vertices; found 7");
  EXPECT_EQ(message(head + "\n# all of it\nlevel 0"),
            "s.txt, line 4: expected 1 to " + std::to_string(tube.mesh.positions.size()) + " spheres, found 0");
  EXPECT_EQ(message(head + "level"), "s.txt, line 2: expected a number of spheres behind `level`; the line ends here");
  EXPECT_EQ(message(head + "turn 3"),
            "s.txt, line 2: expected `vertices`, `level`, `move`, `pin` or `unpin`; found 'turn'");
  EXPECT_EQ(message(head + "move 3"), "s.txt, line 2: expected `spheres` and their numbers");
  EXPECT_EQ(message(head + "move spheres 4"),
            "s.txt, line 2: spheres[0]: expected a sphere of the level, 0 to 3, found 4");
  EXPECT_EQ(message(head + "move spheres 1 translate 1 2"),
            "s.txt, line 2: expected three numbers behind `translate`; the line ends here");
  EXPECT_EQ(message(head + "move spheres 1 translate 1 nan 2"), "s.txt, line 2: translate: expected finite numbers");
  EXPECT_EQ(message(head + "move spheres 1 scale 0"), "s.txt, line 2: scale: expected a positive number");
  EXPECT_EQ(message(head + "move spheres 1 frame child"),
            "s.txt, line 2: expected `parent` or `model` behind `frame`; found 'child'");
  EXPECT_EQ(message(head + "pin spheres 1 x"), "s.txt, line 2: expected the line to end here; found 'x'");
  EXPECT_EQ(message(head + "move spheres 1 # and nothing else\r\n"), "taken");
}

TEST(DeformationSession, RefusesWhatDeformRefuses) {
  const Tube tube;
  EXPECT_FALSE(DeformationSession::start(surfaces::cube(), tube.hierarchy, 4));
  EXPECT_FALSE(DeformationSession::start(tube.mesh, tube.hierarchy, 0));
  auto session = tube.session(4);
  EXPECT_FALSE(session.go_to(0));
  EXPECT_FALSE(session.preview({.spheres = {SphereId(4)}}));
  EXPECT_FALSE(session.move({.spheres = {SphereId(0)}, .translate = {std::nan(""), 0, 0}}));
  for (const double far : {1e60, 1e200, 1e307}) {
    const auto refused = session.preview({.spheres = {SphereId(0)}, .translate = {0, -2 * far, 0}});
    ASSERT_FALSE(refused) << far;
    EXPECT_EQ(refused.error().message, "the move takes vertices out of range; use smaller numbers");
  }
  EXPECT_FALSE(session.preview({.spheres = {SphereId(0)}, .radius = 1e200}));
  const std::vector<SphereId> none = {SphereId(9)};
  EXPECT_FALSE(session.pin(none));
  EXPECT_EQ(session.nodes().size(), 4U);
  EXPECT_EQ(positions(session), tube.mesh.positions);
}

}  // namespace
}  // namespace armature::sdk
