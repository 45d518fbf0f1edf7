// What panels issue, without a window.
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <armature/navproto/publisher.h>
#include <unistd.h>

#include "tests/viewer/app/hands.h"
#include "viewer/app/theme.h"

namespace armature::viewer {
namespace {

TEST_F(Hands, LetGoOfTheLevelsSliderWhileWorkGoesOnAndLookElsewhere) {
  for (const char* line : {"build", "level 8"}) {
    ASSERT_TRUE(session.execute(line));
    while (session.job.running()) session.update(session.now + std::chrono::milliseconds(5));
  }
  const std::shared_ptr<Model> model = session.models.front();
  ui.slide = {.model = model, .wanted = 5, .waits = true};
  ASSERT_TRUE(session.execute("map curvature"));
  ASSERT_TRUE(session.execute("panel look"));
  follow_level(ui);
  EXPECT_EQ(model->spheres->cursor->size(), 8U) << "it waits";
  while (session.job.running()) session.update(session.now + std::chrono::milliseconds(5));
  follow_level(ui);
  EXPECT_EQ(model->spheres->cursor->size(), 5U);
  // It is no other model's, and jumps to nothing later.
  ui.slide.waits = true;
  session.add(ball(6));
  follow_level(ui);
  EXPECT_FALSE(ui.slide.waits);
  EXPECT_EQ(session.notice, "");
}

/// All facts of a session but what it has said, lines that failed, and what it still measures.
std::map<std::string, std::string> facts_of(const Session& session) {
  auto facts = session.report();
  std::erase_if(facts, [](const auto& fact) {
    return fact.first == "notice" || fact.first == "failures" || fact.first.ends_with("measured") ||
           fact.first.ends_with("_percent");
  });
  return facts;
}

void carry_out(Session& session, const std::string& line) {
  static_cast<void>(session.execute(line));
  while (session.job.running()) session.update(session.now + std::chrono::milliseconds(5));
}

TEST_F(Hands, ClickNothingInAPanelThatAScriptDoesNotHold) {
  ImGui::GetIO().DisplaySize = {690, 800};
  std::size_t clicked = 0;
  for (const std::vector<std::string>& lines : {std::vector<std::string>{"panel look"},
                                                {"panel spheres"},
                                                {"pose", "handle 0"},
                                                {"panel select"},
                                                {"tool brush"},
                                                {"similarity gls 0", "panel edit", "edit displace 0.01 map"}}) {
    Session used;
    Ui panels{.commanded = used, .view = {{290, 0}, {400, 764}}};
    used.add(ball(6));
    for (const char* line : {"lasso -0.2 -0.2 0.2 -0.2 0.2 0.2 -0.2 0.2", "expand", "build", "level 8"})
      carry_out(used, line);
    for (const std::string& line : lines) carry_out(used, line);
    const std::size_t before = used.log().size();
    const auto draw = [&](const ImVec2& mouse, bool down) {
      ImGui::GetIO().MousePos = mouse;
      ImGui::GetIO().MouseDown[0] = down;
      ImGui::NewFrame();
      draw_sidebar(panels);
      follow_level(panels);
      ImGui::EndFrame();
      for (int waited = 0; used.job.running(); ++waited) {
        used.update(used.now + std::chrono::milliseconds(5));
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        // What takes long is none of this test's business: cancelled, it leaves everything as it was.
        if (waited == 200) static_cast<void>(used.execute("cancel"));
      }
    };
    // From below the buttons that open dialogs on.
    for (float y = 100; y < 560; y += 9) {
      for (const float x : {40.F, 110.F, 180.F, 250.F}) {
        for (const bool down : {false, true, false}) draw({x, y}, down);
        panels.log = false;
        if (used.models.size() > 1) carry_out(used, "close");  // what is made of it is made once
        panels.dialog = false;                                 // it issues what its own buttons do
      }
    }
    clicked += used.log().size() - before;
    Session again;
    again.aspect = used.aspect;
    again.add(ball(6));
    for (const std::string& line : used.log()) carry_out(again, line);
    EXPECT_EQ(facts_of(again), facts_of(used)) << lines.back();
  }
  EXPECT_GT(clicked, 100U);
}

TEST_F(Hands, CancelWorkHoweverLongItsTitleAndNarrowTheWindow) {
  for (const ImVec2 size : {ImVec2{200, 36}, ImVec2{400, 36}, ImVec2{800, 36}}) {
    std::atomic<bool> done = false;
    session.start("opening " + std::string(250, 'w'), [&](const sdk::Task&) -> sdk::Expected<Job::Apply> {
      done.wait(false);
      return Job::Apply();
    });
    ImGui::GetIO().DisplaySize = {size.x, 400};
    for (const bool down : {false, false, true, false}) {
      ImGui::GetIO().MousePos = {40, 382};
      ImGui::GetIO().MouseDown[0] = down;
      ImGui::NewFrame();
      draw_status_bar(ui, {{0, 364}, size});
      ImGui::EndFrame();
    }
    EXPECT_TRUE(session.job.stopping()) << size.x;
    done = true;
    done.notify_all();
    while (session.job.running()) session.update(session.now + std::chrono::milliseconds(5));
    EXPECT_FALSE(session.job.stopping());
  }
}

TEST_F(Hands, ReadAllThatTheStatusBarSaysHoweverNarrowTheWindow) {
  for (const float width : {240.F, 400.F, 800.F}) {
    for (const char* tool : {"look", "brush", "cut"}) {
      ASSERT_TRUE(session.execute(std::string("tool ") + tool));
      for (const char* notice : {"", "a notice of some words that takes several lines where there is no room for it"}) {
        session.tell(notice);
        const float height = status_height(ui, width, true);
        ImGui::GetIO().DisplaySize = {width, 400};
        float hidden = 1;
        for (int i = 0; i < 3; ++i) {
          ImGui::NewFrame();
          draw_status_bar(ui, {{0, 400 - height}, {width, height}});
          ImGui::Begin("status");
          hidden = ImGui::GetScrollMaxY();
          ImGui::End();
          ImGui::EndFrame();
        }
        EXPECT_EQ(hidden, 0) << width << ", " << tool << ", " << notice;
      }
    }
  }
}

TEST_F(Hands, FindTheSliderOfEditsAtNothingOnceAnEditIsKeptOrDroppedOrIsAnotherModels) {
  ui.view = {{290, 0}, {310, 764}};
  ImGui::GetIO().DisplaySize = {600, 800};
  /// All words of the sidebar.
  const auto words = [&] {
    ImGui::NewFrame();
    ImGui::LogToClipboard();
    draw_sidebar(ui);
    ImGui::LogFinish();
    ImGui::EndFrame();
    return std::string(ImGui::GetClipboardText());
  };
  const auto expect = [&](const char* amount) {
    const std::string shown = words();
    EXPECT_NE(shown.find(std::string(amount) + " % of its size"), std::string::npos) << shown;
  };
  for (const char* end : {"drop-edit", "keep-edit", "model 1"}) {
    if (session.models.size() < 2) session.add(ball(6));
    for (const char* line :
         {"model 1", "panel edit", "similarity gls 0", "model 2", "similarity gls 0", "edit displace 0.02 map"})
      carry_out(session, line);
    expect("2.0");
    carry_out(session, end);
    expect("0.0");
  }
  // What is tried on the other one is seen again, and a kept one is not, whatever was done while it was being kept.
  carry_out(session, "model 2");
  expect("2.0");
  ASSERT_TRUE(session.execute("keep-edit"));
  ASSERT_TRUE(session.execute("camera 20 20"));
  while (session.job.running()) session.update(session.now + std::chrono::milliseconds(5));
  expect("0.0");
}

/// Folders and files that are there for as long as it lives.
struct Folder {
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("armature-panels-files." + std::to_string(::getpid()));
};

TEST_F(Hands, FindFilesThatHaveJustComeInADialogThatIsAlwaysInTheWindow) {
  const Folder folder;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path);
  const auto words = [&] {
    std::string text;
    for (int i = 0; i < 3; ++i) {
      ImGui::NewFrame();
      ImGui::LogToClipboard();
      draw_file_dialog(ui);
      ImGui::LogFinish();
      ImGui::EndFrame();
      text = ImGui::GetClipboardText();
    }
    return text;
  };
  ask_for_file(ui, FileUse::Open);
  EXPECT_EQ(words().find("new.off"), std::string::npos);
  std::ofstream(folder.path / "new.off") << "OFF";
  std::ofstream(folder.path / "steps.moves") << "armature deformation 1";
  ask_for_file(ui, FileUse::Open);
  EXPECT_NE(words().find("new.off"), std::string::npos);
  EXPECT_EQ(words().find("steps.moves"), std::string::npos);
  carry_out(session, "build");
  ask_for_file(ui, FileUse::Save);
  static_cast<void>(words());
  ImGui::GetIO().AddInputCharactersUTF8("new.off");
  EXPECT_NE(words().find("Replace"), std::string::npos) << "it is there";
  ask_for_file(ui, FileUse::SavePose);
  EXPECT_EQ(words().find("Replace"), std::string::npos) << "no steps are saved over a model by a slip";
  ask_for_file(ui, FileUse::ReplayPose);
  EXPECT_NE(words().find("steps.moves"), std::string::npos);
  EXPECT_EQ(words().find("new.off"), std::string::npos);
  // The window becomes smaller.
  ImGui::GetIO().DisplaySize = {260, 180};
  static_cast<void>(words());
  ImGui::NewFrame();
  draw_file_dialog(ui);
  ImGui::Begin("Replay steps");
  const ImVec2 at = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
  ImGui::End();
  ImGui::EndFrame();
  EXPECT_GE(at.x, 0);
  EXPECT_GE(at.y, 0);
  EXPECT_LE(at.x + size.x, 260);
  EXPECT_LE(at.y + size.y, 180);
  std::filesystem::current_path(before);
}

TEST_F(Hands, ChooseAFileForWhatTheyWereAskedFor) {
  ImGuiIO& io = ImGui::GetIO();
  io.KeyMap[ImGuiKey_Enter] = 300;
  const auto draw = [&] {
    ImGui::NewFrame();
    if (ui.dialog) draw_file_dialog(ui);
    ImGui::EndFrame();
  };
  for (const auto& [use, notice] : {std::pair{FileUse::SavePose, "save-pose: begin with `pose` first"},
                                    std::pair{FileUse::ReplayPose, "replay-pose: begin with `pose` first"}}) {
    ask_for_file(ui, use);
    for (int i = 0; i < 3; ++i) draw();
    io.AddInputCharactersUTF8("none.moves");
    draw();
    for (const bool down : {true, false}) {
      io.KeysDown[300] = down;
      draw();
    }
    EXPECT_EQ(session.notice, notice);
    EXPECT_FALSE(ui.dialog);
  }
}

TEST(Letters, OfManyAlphabetsAreThereWhereTheFontIs) {
  ImGuiContext* context = ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  theme::apply(2);
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  atlas.Build();
  // Not the font that is ImGui's own.
  if (theme::heading() != theme::large()) {
    for (const ImWchar letter : {0xE9, 0x142, 0x17C, 0x3BB, 0x448, 0x44F})
      EXPECT_NE(atlas.Fonts.front()->FindGlyphNoFallback(letter), nullptr) << letter;
  }
  EXPECT_LE(atlas.TexWidth * atlas.TexHeight, 2048 * 2048) << "on a display of scale 2";
  ImGui::DestroyContext(context);
}

TEST(TheEndOfAText, IsFoundByAFewQuestionsHoweverLongItIs) {
  const std::string text(1'000'000, 'x');
  int asked = 0;
  const auto fits = [&](const std::string& part) { return ++asked, part.size() <= 100; };
  EXPECT_EQ(end_of(text, fits), "..." + text.substr(0, 97));
  EXPECT_LT(asked, 30);
  EXPECT_EQ(end_of("short", fits), "short");
  // Letters stay whole.
  std::string letters;
  for (int i = 0; i < 200; ++i) letters += "\u0142";
  EXPECT_EQ(end_of(letters, fits), "..." + letters.substr(letters.size() - 96));
}

/// A window of so many pixels, as the program lays it out, and a daemon that says what it is told to.
class Walkers : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder);
    auto bound = navproto::Publisher::bind("ipc://" + (folder / "nav").string());
    ASSERT_TRUE(bound) << bound.error().message;
    publisher.emplace(std::move(*bound));
    ASSERT_TRUE(session.execute("mode walk"));
    ASSERT_TRUE(session.walk.connect("ipc://" + (folder / "nav").string()));
  }
  void TearDown() override {
    session.walk.disconnect();
    std::filesystem::remove_all(folder);
  }
  void hear(navproto::NavigationMessage message) {
    for (int i = 0; i < 60'000; ++i) {
      ASSERT_TRUE(publisher->publish_navigation(message));
      session.update(session.now + std::chrono::milliseconds(1));
      const auto& heard = session.walk.navigation();
      if (session.walk.fresh() && heard && heard->engagement == message.engagement) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    FAIL() << "nothing was heard";
  }
  /// What is drawn over the city in a view, as corners of triangles.
  template <class See>
  void draw(const Area& view, float scale, See see) {
    ImGuiContext* context = ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui::GetIO().DisplaySize = view.end();
    theme::apply(scale);
    ImGui::GetIO().Fonts->Build();
    ImGui::NewFrame();
    Ui ui{.commanded = session, .scale = scale, .view = view, .depth_aspect = 4.0F / 3};
    draw_walk_overlay(ui);
    see(place_walk_cards(ui), ImGui::GetBackgroundDrawList()->VtxBuffer);
    ImGui::EndFrame();
    ImGui::DestroyContext(context);
  }

  std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("armature-panels." + std::to_string(::getpid()));
  std::optional<navproto::Publisher> publisher;
  Session session;
};

struct View {
  Area area;
  float scale;
};
/// With the sidebar and the status bar, or without.
const std::vector<View> kViews = {{{{0, 0}, {200, 150}}, 1},     {{{0, 0}, {320, 204}}, 1},   {{{0, 0}, {480, 324}}, 1},
                                  {{{290, 0}, {510, 564}}, 1},   {{{290, 0}, {990, 764}}, 1}, {{{0, 0}, {200, 150}}, 2},
                                  {{{580, 0}, {700, 728}}, 2},   {{{0, 0}, {800, 528}}, 2},   {{{0, 0}, {640, 480}}, 2},
                                  {{{580, 0}, {1980, 1528}}, 2}, {{{0, 0}, {3840, 2088}}, 2}};

TEST_F(Walkers, ReadWhatToDoInAnyWindow) {
  navproto::NavigationMessage message;
  message.user_id = 1;
  message.engagement = navproto::Engagement::CapturingRest;
  hear(message);
  for (const auto& [view, scale] : kViews) {
    draw(view, scale, [&, &view = view, scale = scale](const WalkCards&, const ImVector<ImDrawVert>& corners) {
      const float middle = view.at.x + view.size.x / 2;
      std::size_t left = 0, right = 0;
      for (const ImDrawVert& corner : corners) {
        const ImVec2& at = corner.pos;
        EXPECT_TRUE(at.x > view.at.x - 1 && at.x < view.end().x + 1 && at.y > -1 && at.y < view.end().y + 1)
            << at.x << " " << at.y << " in a view of " << view.size.x << "x" << view.size.y;
        // Between the two motions nothing is said: neither runs into the other.
        if (corner.col != theme::kInk || at.y < 0.4F * view.size.y || view.size.x < 200 * scale) continue;
        (at.x < middle ? left : right) += 1;
        EXPECT_GT(std::abs(at.x - middle), std::min(0.009F * view.size.x, 4.0F)) << view.size.x << "x" << view.size.y;
      }
      EXPECT_TRUE((left > 40 && right > 40) || view.size.x < 200 * scale) << view.size.x << "x" << view.size.y;
    });
  }
}

TEST_F(Walkers, SeeThemselvesAndTheirSpeedInAnyWindowThatHasRoom) {
  for (const auto& [view, scale] : kViews) {
    draw(view, scale, [&, &view = view, scale = scale](const WalkCards& cards, const auto&) {
      const std::string where = fmt::format("{}x{}, scale {}", view.size.x, view.size.y, scale);
      const std::vector<Area> all = {cards.mirror, cards.speeds, cards.gauges, cards.state};
      for (std::size_t i = 0; i < all.size(); ++i) {
        if (all[i].size.x == 0) continue;
        EXPECT_TRUE(view.holds(all[i].at) && view.holds({all[i].end().x - 1, all[i].end().y - 1})) << where << i;
        for (std::size_t j = 0; j < i; ++j) {
          const bool apart = all[i].end().x <= all[j].at.x || all[j].end().x <= all[i].at.x ||
                             all[i].end().y <= all[j].at.y || all[j].end().y <= all[i].at.y;
          EXPECT_TRUE(apart || all[j].size.x == 0) << where << ": " << i << " over " << j;
        }
      }
      EXPECT_LT(cards.state.size.y, 0.6F * view.size.y) << where << ": the city is seen, too";
      EXPECT_EQ(cards.state.size.x > 0, view.at.x == 0) << where << ": the sidebar says it, or the view";
      EXPECT_EQ(cards.mirror.size.x > 0, view.size.x >= 320 * scale && view.size.y >= 200 * scale) << where;
      EXPECT_EQ(cards.speeds.size.x > 0, cards.mirror.size.x > 0) << where;
      EXPECT_TRUE(cards.gauges.size.x > 0 || view.size.x < 350 * scale || view.size.y < 360 * scale) << where;
    });
  }
}

}  // namespace
}  // namespace armature::viewer
