// The viewer without a window: lines, jobs, the camera, the path.
#include "viewer/session/session.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <stdexcept>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "viewer/scene/coarse_mesh.h"
#include "viewer/session/arguments.h"
#include "viewer/session/command.h"
#include "viewer/session/job.h"
#include "viewer/session/made_once.h"
#include "viewer/session/orbit_camera.h"
#include "viewer/session/script.h"
#include "viewer/walk/path_task.h"

namespace armature::viewer {
namespace {

using namespace std::chrono_literals;
using Words = std::vector<std::string>;

TEST(Lines, AreWordsWithQuotesAndComments) {
  EXPECT_EQ(*split_words("open  model.off # a comment"), (Words{"open", "model.off"}));
  EXPECT_EQ(*split_words(R"(open "my \"best\" model.off" x#y)"), (Words{"open", R"(my "best" model.off)", "x#y"}));
  EXPECT_TRUE(split_words("  # nothing")->empty());
  EXPECT_FALSE(split_words("open \"model.off"));
}

TEST(Lines, KeepWordsOfAnyKind) {
  for (const std::string word :
       {"plain", "two words", R"(a "quote")", R"(back\slash)", "#hash", "", "two\nlines", R"(a \n b)"})
    EXPECT_EQ(*split_words("open " + as_word(word)), (Words{"open", word}));
}

TEST(Lines, AreRefusedWithWhatWasExpected) {
  Session session;
  const auto refused = [&](const std::string& line) {
    const auto done = session.execute(line);
    return done ? std::string("carried out") : done.error().message;
  };
  EXPECT_EQ(refused("fly"), "fly is no command; `help` lists them");
  EXPECT_EQ(refused("tool hammer"),
            "tool: tool: expected one of look, click, cut, brush, lasso, edge, pose, spot, found hammer");
  EXPECT_EQ(refused("camera 0 far"), "camera: elevation in degrees: expected a number from -89 to 89, found far");
  EXPECT_EQ(refused("camera 0 nan"), "camera: elevation in degrees: expected a number from -89 to 89, found nan");
  EXPECT_EQ(refused("fit now"), "fit: expected nothing more, found now");
  EXPECT_EQ(refused("expand"), "expand: nothing is open; open a model first");
  EXPECT_EQ(refused("rerest"), "rerest: no daemon is connected; connect to one, or start one on a synthetic person");
  EXPECT_TRUE(session.log().empty());
  EXPECT_TRUE(session.notice_is_error);
}

TEST(Lines, OfACameraThatMovesCountOnce) {
  Session session;
  for (const char* line : {"camera 10 10", "camera 20 10", "wireframe on", "camera 30 10", "camera 40 10"})
    ASSERT_TRUE(session.execute(line));
  EXPECT_EQ(session.log(), (Words{"camera 20 10", "wireframe on", "camera 40 10"}));
  for (const char* line : {"camera 10 20 7 1 2 3", "camera 30 40     # a comment is no argument"})
    ASSERT_TRUE(session.execute(line));
  EXPECT_EQ(*std::prev(session.log().end(), 2), "camera 10 20 7 1 2 3");
}

TEST(Lines, OfWorkStandWhereItBegan) {
  Session session;
  auto model = std::make_shared<Model>();
  model->name = "triangle";
  sdk::Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{sdk::VertexId(0), sdk::VertexId(1), sdk::VertexId(2)}};
  model->mesh = std::make_shared<const MeshShape>(std::move(mesh));
  session.add(model);
  ASSERT_TRUE(session.execute("camera 0 0"));
  ASSERT_TRUE(session.execute("lasso -1 -1 1 -1 1 1 -1 1"));
  ASSERT_TRUE(session.job.running());
  ASSERT_TRUE(session.execute("camera 30 10"));  // moves on meanwhile
  ASSERT_TRUE(session.execute("combine subtract"));
  while (session.job.running()) session.update(session.now + 5ms);
  EXPECT_EQ(session.log(),
            (Words{"camera 0 0", "lasso -1 -1 1 -1 1 1 -1 1", "meanwhile camera 30 10", "meanwhile combine subtract"}));
  EXPECT_EQ(model->selecting.selection.faces().size(), 1U) << "as it was combined when it began";
  // What is done meanwhile of work that comes to nothing is done all the same.
  ASSERT_TRUE(session.execute("lasso -1 -1 1 -1 1 1 -1 1"));
  ASSERT_TRUE(session.execute("camera 40 10"));
  session.job.cancel();
  while (session.job.running()) session.update(session.now + 5ms);
  EXPECT_EQ(session.log().back(), "camera 40 10");
  EXPECT_EQ(session.log().size(), 5U);
}

/// Lets a script come to its end, or returns why it did not.
std::string played(Session& session, Script script) {
  for (;;) {
    session.update(session.now + 5ms);
    if (const auto stepped = script.step(session); !stepped) return stepped.error().message;
    if (script.done(session)) return "";
  }
}

TEST(Lines, OfASessionThatIsReplayedDoWhatTheyDidWhateverWorkWentOn) {
  const std::string file = ::testing::TempDir() + "replayed.off";
  std::ofstream(file) << "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  const Words lines = {"open " + as_word(file),
                       "meanwhile camera 90 20 5 1 2 3",  // opening sees all of it afterwards
                       "camera 10 20 7 1 2 3",
                       "camera 30 40",  // from as far
                       "camera 50 40",
                       "panel spheres"};
  Session first, again;
  EXPECT_EQ(played(first, Script({lines[0], lines[1]})), "");
  const double fitted = first.camera.distance;
  EXPECT_LT(fitted, 4);
  EXPECT_EQ(played(again, Script(first.log())), "");
  EXPECT_EQ(again.camera.distance, fitted);
  EXPECT_EQ(played(first, Script({lines[2], lines[3], lines[4], lines[5]})), "");
  EXPECT_EQ(first.log(), (Words{lines[0], lines[1], lines[2], lines[4], lines[5]}));
  EXPECT_EQ(played(again, Script({lines[2], lines[4]})), "");
  EXPECT_EQ(again.camera.view_from_world().matrix(), first.camera.view_from_world().matrix());
  std::remove(file.c_str());
}

TEST(Errors, ThatCannotBeMeasuredAreSaidOnce) {
  Session session;
  auto model = std::make_shared<Model>();
  model->mesh = std::make_shared<const MeshShape>(sdk::Mesh{.positions = {{0, 0, 0}, {1, 0, 0}}, .triangles = {}});
  sdk::SphereMesh shape;
  shape.spheres = {{{0, 0, 0}, 1}};
  model->set_spheres(std::move(shape));
  session.add(model);
  const auto wait = [&] {
    for (int i = 0; i < 5000 && model->spheres->unmeasured.empty(); ++i) {
      session.update(session.now + 200ms);
      std::this_thread::sleep_for(1ms);
    }
    return model->spheres->unmeasured;
  };
  const std::string why = wait();
  EXPECT_FALSE(why.empty());
  for (int i = 0; i < 10; ++i) session.update(session.now + 200ms);
  EXPECT_EQ(model->spheres->unmeasured, why) << "and stays said";
  EXPECT_EQ(session.report()["unmeasured"], why);
}

TEST(Errors, AreThoseOfTheLevelThatStandsInTheEnd) {
  Session session;
  auto model = std::make_shared<Model>();
  sdk::Mesh square{.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, .triangles = {}};
  square.triangles = {{sdk::VertexId(0), sdk::VertexId(1), sdk::VertexId(2)},
                      {sdk::VertexId(0), sdk::VertexId(2), sdk::VertexId(3)}};
  model->mesh = std::make_shared<const MeshShape>(square);
  const auto ball = [](double radius) {
    sdk::SphereMesh shape;
    shape.spheres = {{{0.5, 0.5, 0}, radius}};
    return shape;
  };
  model->set_spheres(ball(0.1));
  session.add(model);
  for (int i = 0; i < 3; ++i) session.update(session.now + 200ms);  // the first is being measured
  model->set_spheres(ball(0.4));
  const auto measured = [&](bool about) {
    for (int i = 0; i < 30'000 && !(model->spheres->errors && model->spheres->errors->about == about); ++i) {
      session.update(session.now + 200ms);
      std::this_thread::sleep_for(1ms);
    }
    return model->spheres->errors;
  };
  const auto quick = measured(true), full = measured(false);
  ASSERT_TRUE(quick && full);
  EXPECT_NEAR(full->hausdorff, 100 * 0.4 / std::sqrt(2), 0.01) << "of the last one, at its top";
  EXPECT_LE(quick->hausdorff, full->hausdorff);
  EXPECT_NEAR(quick->mean_input_to_approximation / full->mean_input_to_approximation, 1, 0.02);
}

TEST(Models, ThatAreClosedGo) {
  Session session;
  auto model = std::make_shared<Model>();
  model->mesh = std::make_shared<const MeshShape>(sdk::Mesh{.positions = {{0, 0, 0}}, .triangles = {}});
  const std::weak_ptr<Model> left = model;
  session.add(std::move(model));
  ASSERT_TRUE(session.execute("close"));
  for (int i = 0; i < 5000 && !left.expired(); ++i) {
    session.update(session.now + 5ms);
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_TRUE(left.expired());
}

TEST(Sizes, AreReadStrictly) {
  EXPECT_EQ(parse_size("640x480")->width, 640);
  EXPECT_EQ(parse_size("640x480")->height, 480);
  for (const char* text :
       {"", "640", "x", "640x", "640x480 ", "640x480junk", "6.4x480", "15x100", "100x16385", "-64x64"})
    EXPECT_FALSE(parse_size(text)) << text;
}

/// A folder with two triangles, one.off and two.off.
std::string two_files() {
  std::string folder = ::testing::TempDir();
  for (const char* name : {"one.off", "two.off"})
    std::ofstream(folder + name) << "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  return folder;
}

void play(Session& session, Playlist& playlist) {
  do {
    session.update(session.now + 5ms);
    playlist.step(session);
  } while (!playlist.done(session));
}

TEST(Scripts, NameThePlaceOfWhatFailsWhereItHasOne) {
  const auto failure = [](Script script) {
    Session session;
    return played(session, std::move(script));
  };
  const std::string file = ::testing::TempDir() + "viewer_script.txt";
  std::ofstream(file) << "# a script\ntool hammer\n";
  EXPECT_EQ(failure(Script({"open nothing.off"})).find("nothing.off"), 0U);
  EXPECT_EQ(failure(Script(*Script::read(file))).find(file + ", line 2: tool"), 0U);
  // What a line begins belongs to it, whatever is done meanwhile.
  std::ofstream(file) << "mode walk\nopen nothing.off\nmeanwhile mode shapes\nmeanwhile try tool hammer\n\nmode walk\n";
  EXPECT_EQ(failure(Script(*Script::read(file))).find(file + ", line 2: nothing.off"), 0U);
  std::ofstream(file)
      << "try open nothing.off\nmeanwhile mode shapes\ntry wait 0.01 models 7\nmeanwhile mode walk\nfit\n";
  EXPECT_EQ(failure(Script(*Script::read(file))), "");
  std::ofstream(file) << "\xEF\xBB\xBFmode walk\r\n";
  EXPECT_EQ(failure(Script(*Script::read(file))), "");
  std::ofstream(file) << "wait 0.01 models 7\nmode walk\n";
  EXPECT_EQ(failure(Script(*Script::read(file))).find(file + ", line 1: wait"), 0U);
  std::ofstream(file) << "# a script\ntool hammer\n";
  Script both({"try open nothing.off", "mode walk"});
  both.append(*Script::read(file));
  EXPECT_EQ(failure(both).find(file + ", line 2: tool"), 0U);
  std::remove(file.c_str());
}

TEST(Scripts, TakeWordsBeforeACommandInAnyOrderAndLinesWithoutWordsForNone) {
  const std::string file = two_files() + "one.off";
  for (const char* line :
       {"meanwhile cancel", "  meanwhile cancel", "meanwhile\ttry cancel", "try meanwhile cancel # it"}) {
    Session session;
    EXPECT_EQ(played(session, Script({"open " + as_word(file), "# a comment", "", " \t\r", line})), "") << line;
    EXPECT_TRUE(session.models.empty()) << line;
  }
  Session session;
  EXPECT_EQ(played(session, Script({"try\ttool hammer", " try tool nail", "try meanwhile tool spoon"})), "");
  EXPECT_EQ(session.failures, 3U);
  EXPECT_EQ(played(session, Script(Words{"meanwhiles"})), "meanwhiles is no command; `help` lists them");
}

TEST(Scripts, EndWhereTheyFailWhateverTheyWaitFor) {
  Session session;
  EXPECT_EQ(played(session, Script({"open " + as_word(two_files() + "one.off"), "meanwhile wait 0.01 panel edit",
                                    "meanwhile panel edit"})),
            "wait: panel is still look, expected edit");
  EXPECT_EQ(session.panel, Panel::Look);
}

TEST(Scripts, FailWhereAPictureDoes) {
  for (const bool may_fail : {false, true}) {
    Session session;
    Script script({may_fail ? "try screenshot a.png" : "screenshot a.png", "panel edit"});
    session.update(5ms);
    ASSERT_TRUE(script.step(session));
    ASSERT_TRUE(session.picture);
    const PictureRequest request = *std::exchange(session.picture, std::nullopt);
    session.tell_failure(request.origin, "no");
    EXPECT_EQ(script.step(session).has_value(), may_fail);
    EXPECT_EQ(session.panel, may_fail ? Panel::Edit : Panel::Look);
  }
}

TEST(Scripts, AreFiles) {
  const auto read = Script::read(::testing::TempDir());
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("is a folder; expected a file of commands"), std::string::npos);
}

TEST(Commands, HaveOneMeaningEach) {
  for (const auto group : {file_commands(), view_commands(), sphere_commands(), select_commands(), pose_commands(),
                           edit_commands(), walk_commands(), script_commands()})
    for (const Command& command : group) EXPECT_EQ(find_command(command.name), &command) << command.name;
}

std::optional<sdk::Expected<void>> waited_for(Job& job) {
  for (;;) {
    if (auto done = job.poll()) return done;
    std::this_thread::sleep_for(1ms);
  }
}

TEST(WhatIsDropped, IsOpenedWhateverFailsMeanwhile) {
  const std::string folder = two_files();
  Session session;
  Playlist playlist({}, Script({"open " + as_word(folder + "one.off")}));
  play(session, playlist);
  ASSERT_EQ(session.models.size(), 1U);
  // By hand, and nothing lies within: it fails while the files wait.
  ASSERT_TRUE(session.execute("lasso 2 2 2.1 2 2 2.1"));
  for (const char* name : {"none.off", "two.off", "one.off"}) playlist.drop(folder + name);
  play(session, playlist);
  EXPECT_EQ(session.models.size(), 3U);
  EXPECT_EQ(session.models.back()->name, "one");
}

TEST(WhatIsOpened, IsAllThatCanBeAndTheOthersAreTold) {
  const std::string folder = two_files();
  Session session;
  Playlist playlist({folder + "no.off", folder + "one.off", folder + "none.off", folder + "two.off"}, Script());
  play(session, playlist);
  EXPECT_EQ(session.models.size(), 2U);
  EXPECT_TRUE(session.notice_is_error);
  EXPECT_NE(session.notice.find("no.off: cannot be read"), std::string::npos) << session.notice;
  EXPECT_NE(session.notice.find("none.off: cannot be read"), std::string::npos) << session.notice;
  EXPECT_FALSE(session.failure);
}

TEST(WhatIsOpened, NamesTheFirstFewOfManyThatCannotBe) {
  Session session;
  Playlist playlist({"a.off", "b.off", "c.off", "d.off", "e.off"}, Script());
  play(session, playlist);
  EXPECT_NE(session.notice.find("c.off"), std::string::npos) << session.notice;
  EXPECT_EQ(session.notice.find("d.off"), std::string::npos) << session.notice;
  EXPECT_TRUE(session.notice.ends_with("; and 2 more")) << session.notice;
  playlist.drop("f.off");
  play(session, playlist);
  EXPECT_TRUE(session.notice.starts_with("open: f.off") || session.notice.starts_with("f.off")) << session.notice;
  EXPECT_EQ(session.notice.find("more"), std::string::npos) << session.notice;
}

TEST(Scripts, GoOnWhateverFailsByHandMeanwhile) {
  Session session;
  Playlist playlist({}, Script({"wait 0.1", "panel edit", "wait 0.1", "tool hammer", "panel look"}));
  session.update(5ms);
  playlist.step(session);
  EXPECT_FALSE(session.execute("undo")) << "of nothing";
  play(session, playlist);
  EXPECT_EQ(session.panel, Panel::Edit) << "what of its own fails ends it";
  EXPECT_EQ(session.notice.find("tool: "), 0U) << session.notice;
  // and nothing else.
  playlist.drop(two_files() + "one.off");
  play(session, playlist);
  EXPECT_EQ(session.models.size(), 1U);
}

TEST(Jobs, ChangeThingsOnTheCallersThreadOnceTheyAreDone) {
  Job job;
  std::thread::id changed_by;
  job.start("counting", [&](const sdk::Task& task) -> sdk::Expected<Job::Apply> {
    task.report("half", 0.5);
    return Job::Apply([&] { changed_by = std::this_thread::get_id(); });
  });
  EXPECT_TRUE(job.running());
  EXPECT_TRUE(waited_for(job)->has_value());
  EXPECT_EQ(changed_by, std::this_thread::get_id());
  EXPECT_FALSE(job.running());
}

/// Counts how often it is copied.
struct Counted {
  explicit Counted(int& of) : copies(&of) {}
  Counted(const Counted& other) noexcept : copies(other.copies) { ++*copies; }
  Counted(Counted&& other) noexcept = default;
  Counted& operator=(const Counted&) = delete;
  Counted& operator=(Counted&&) = delete;
  ~Counted() = default;
  int* copies;
};

TEST(Jobs, CopyNothingThatTheChangesHold) {
  Job job;
  int copies = 0;
  bool changed = false;
  job.start("holding", [&](const sdk::Task&) -> sdk::Expected<Job::Apply> {
    return Job::Apply([&changed, held = Counted(copies)] { changed = held.copies != nullptr; });
  });
  EXPECT_TRUE(waited_for(job)->has_value());
  EXPECT_TRUE(changed);
  EXPECT_EQ(copies, 0);
}

TEST(Jobs, ChangeNothingOnceTheyAreCancelled) {
  Job job;
  bool changed = false;
  job.start("waiting", [&](const sdk::Task& task) -> sdk::Expected<Job::Apply> {
    while (!task.stopped()) std::this_thread::sleep_for(1ms);
    return Job::Apply([&] { changed = true; });
  });
  job.cancel();
  const auto done = waited_for(job);
  ASSERT_FALSE(done->has_value());
  EXPECT_EQ(done->error().kind, sdk::ErrorKind::Cancelled);
  EXPECT_FALSE(changed);
}

class JobsThatChangeThings : public ::testing::TestWithParam<Stops> {};

TEST_P(JobsThatChangeThings, AreDoneWhereTheyAreAlthoughSomebodyCancels) {
  const Stops stops = GetParam();
  Job job;
  bool applied = false;
  job.start(
      "posing",
      [&](const sdk::Task& task) -> sdk::Expected<Job::Apply> {
        while (!task.stopped()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        return Job::Apply([&] { applied = true; });
      },
      stops);
  job.cancel();
  std::optional<sdk::Expected<void>> done;
  while (!done) done = job.poll();
  EXPECT_TRUE(*done);
  EXPECT_TRUE(applied);
}

INSTANTIATE_TEST_SUITE_P(All, JobsThatChangeThings, ::testing::Values(Stops::ByItself, Stops::Never));

TEST(WhatIsMadeOnce, IsMadeByTheFirstThatAsksAndWaitedForByTheOthers) {
  MadeOnce<int> once;
  std::atomic<int> made = 0;
  std::atomic<bool> go = false;
  const auto make = [&](const sdk::Task&) -> sdk::Expected<int> {
    while (!go) std::this_thread::sleep_for(1ms);
    return ++made;
  };
  std::vector<int> got(3);
  {
    std::vector<std::jthread> askers;
    for (int& to : got) askers.emplace_back([&] { to = **once.get({}, make); });
    go = true;
  }
  EXPECT_EQ(got, (std::vector{1, 1, 1}));
}

TEST(WhatIsMadeOnce, IsMadeByTheNextWhereTheFirstOneIsCancelledAndNobodyWaitsLongerThanHeLikes) {
  MadeOnce<int> once;
  std::stop_source first, second;
  std::atomic<bool> making = false;
  std::jthread maker([&] {
    const auto made = once.get({.stop = first.get_token()}, [&](const sdk::Task& task) -> sdk::Expected<int> {
      making = true;
      while (!task.stopped()) std::this_thread::sleep_for(1ms);
      return sdk::cancelled();
    });
    EXPECT_EQ(made.error().kind, sdk::ErrorKind::Cancelled);
  });
  while (!making) std::this_thread::sleep_for(1ms);
  const auto never = [](const sdk::Task&) -> sdk::Expected<int> { return 0; };
  second.request_stop();
  EXPECT_EQ(once.get({.stop = second.get_token()}, never).error().kind, sdk::ErrorKind::Cancelled);
  first.request_stop();
  EXPECT_EQ(**once.get({}, [](const sdk::Task&) -> sdk::Expected<int> { return 7; }), 7);
  EXPECT_EQ(**once.get({}, never), 7);
}

TEST(Jobs, ThatRunOutOfMemoryFailInWords) {
  Job job;
  job.start("growing", [](const sdk::Task&) -> sdk::Expected<Job::Apply> { throw std::bad_alloc(); });
  const auto done = waited_for(job);
  ASSERT_FALSE(done->has_value());
  EXPECT_NE(done->error().message.find("memory"), std::string::npos);
}

TEST(Jobs, ThatThrowFailInWords) {
  Job job;
  job.start("reading",
            [](const sdk::Task&) -> sdk::Expected<Job::Apply> { throw std::runtime_error("no such thing"); });
  std::optional<std::string> why;
  while (job.running()) why = job.poll_failure();
  ASSERT_TRUE(why);
  EXPECT_NE(why->find("no such thing"), std::string::npos);
}

TEST(OrbitCamera, SeesAPointWhereItsRayGoes) {
  OrbitCamera camera;
  camera.orbit(0.4, 0.3);
  camera.target = {1, 2, 3};
  for (const ViewPoint& at : {ViewPoint(0, 0), ViewPoint(0.7, -0.4), ViewPoint(-1.5, 0.9)}) {
    const sdk::Ray ray = camera.ray(at);
    EXPECT_LT((camera.project(ray.origin + 2.5 * ray.direction) - at).norm(), 1e-12);
  }
}

TEST(OrbitCamera, KeepsWhatIsPannedUnderTheHand) {
  OrbitCamera camera;
  const Eigen::Vector3d grabbed = camera.target;
  camera.pan({0.3, -0.2});
  EXPECT_LT((camera.project(grabbed) - ViewPoint(0.3, -0.2)).norm(), 1e-12);
}

TEST(OrbitCamera, FitsASphereIntoViewsOfAnyShape) {
  for (const double aspect : {0.4, 1.0, 2.5}) {
    OrbitCamera camera;
    const sdk::Sphere around{{5, 5, 5}, 2};
    camera.fit(around, aspect);
    const Eigen::Isometry3d world_from_view = camera.view_from_world().inverse();
    for (const Eigen::Vector3d side : {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()}) {
      const ViewPoint at = camera.project(around.centre + 2 * (world_from_view.linear() * side));
      EXPECT_LE(std::abs(at.x()), aspect);
      EXPECT_LE(std::abs(at.y()), 1);
    }
  }
}

TEST(CoarseMesh, KeepsAShapeAndKnowsWhereItsFacesComeFrom) {
  // A sheet of 60 x 60 squares in a corner of which a face is doubled.
  sdk::Mesh mesh;
  constexpr std::size_t kSide = 61;
  for (std::size_t i = 0; i < kSide * kSide; ++i)
    mesh.positions.emplace_back(static_cast<double>(i % kSide) / 60, static_cast<double>(i / kSide) / 60, 0);
  const auto vertex = [&](std::size_t x, std::size_t y) { return sdk::VertexId(y * kSide + x); };
  for (std::size_t y = 0; y + 1 < kSide; ++y) {
    for (std::size_t x = 0; x + 1 < kSide; ++x) {
      mesh.triangles.push_back({vertex(x, y), vertex(x + 1, y), vertex(x + 1, y + 1)});
      mesh.triangles.push_back({vertex(x, y), vertex(x + 1, y + 1), vertex(x, y + 1)});
    }
  }
  const CoarseMesh coarse = coarse_mesh(mesh, 10);
  ASSERT_EQ(coarse.source.size(), coarse.mesh.triangles.size());
  EXPECT_LT(coarse.mesh.triangles.size(), mesh.triangles.size() / 20);
  double area = 0;
  for (std::size_t f = 0; f < coarse.source.size(); ++f) {
    const sdk::FaceId face(f);
    const Eigen::Vector3d normal = (coarse.mesh.corner(face, 1) - coarse.mesh.corner(face, 0))
                                       .cross(coarse.mesh.corner(face, 2) - coarse.mesh.corner(face, 0));
    EXPECT_GE(normal.z(), 0) << "no face is turned over";
    area += normal.z() / 2;
    EXPECT_LT((coarse.mesh.corner(face, 0) - mesh.corner(coarse.source[f], 0)).norm(), 0.25);
  }
  EXPECT_NEAR(area, 1, 0.2) << "all but the rim";
  EXPECT_TRUE(coarse_mesh(sdk::Mesh(), 10).mesh.triangles.empty());
}

TEST(PathTask, MeasuresHowFarOneWalksBesideIt) {
  PathTask task({{0, 0}, {10, 0}, {10, 10}});
  for (double x = 0; x <= 10; x += 0.1) task.update({x, 0.5}, 100ms);
  EXPECT_TRUE(task.close());
  EXPECT_NEAR(task.mean_deviation_m(), 0.5, 0.02);
  EXPECT_FALSE(task.finished());
  task.update({7, 3}, 100ms);
  EXPECT_NEAR(task.distance_m(), 3, 1e-9);
  EXPECT_FALSE(task.close());
  for (double y = 3; y <= 9.8; y += 0.1) task.update({10, y}, 100ms);
  EXPECT_TRUE(task.finished());
  const auto time = task.time();
  task.update({10, 10}, 1s);
  EXPECT_EQ(task.time(), time) << "time stands still after the end";
}

}  // namespace
}  // namespace armature::viewer
