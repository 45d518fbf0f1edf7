#include "tools/evaluation/scenes.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <set>
#include <sstream>

namespace armature::tools {
namespace {

template <class T>
using Names = std::initializer_list<std::pair<std::string_view, T>>;

using Body = PersonWish::Body;
using Clothes = PersonWish::Clothes;
using Bag = Outfit::Bag;

/// The columns of one line, taken one after another; remembers what went wrong first.
class Columns {
 public:
  explicit Columns(const std::string& line) : in_(line) {}

  std::string word(std::string_view column) {
    std::string text;
    if (!(in_ >> text)) complain(column, text, "a value");
    return text;
  }

  template <class T>
  T choice(std::string_view column, const Names<T>& names) {
    const std::string text = word(column);
    std::string expected;
    for (const auto& [name, value] : names) {
      if (text == name) return value;
      expected += (expected.empty() ? "" : ", ") + std::string(name);
    }
    complain(column, text, "one of " + expected);
    return {};
  }

  double number(std::string_view column, double least, double most) {
    const std::string text = word(column);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !(value >= least && value <= most)) {
      complain(column, text, std::to_string(least) + " to " + std::to_string(most));
    }
    return value;
  }

  std::uint64_t whole(std::string_view column, std::uint64_t least, std::uint64_t most) {
    const std::string text = word(column);
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || value < least || value > most) {
      complain(column, text, "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
    }
    return value;
  }

  void complain(std::string_view column, const std::string& text, const std::string& expected) {
    if (wrong_.empty()) wrong_ = std::string(column) + " '" + text + "': expected " + expected;
  }

  [[nodiscard]] const std::string& wrong() {
    std::string rest;
    if (in_ >> rest) complain("end of the line", rest, "nothing more");
    return wrong_;
  }

 private:
  std::istringstream in_;
  std::string wrong_;
};

void read_hidden(Columns& columns, SynthOptions& synth) {
  std::string text = columns.word("hidden");
  if (text == "0") return;
  const char from = text.empty() ? ' ' : text.back();
  if (!text.empty()) text.pop_back();
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), synth.occluded);
  if (error != std::errc{} || end != text.data() + text.size() || (from != 'b' && from != 's') ||
      !(synth.occluded > 0 && synth.occluded <= 0.6)) {
    columns.complain("hidden", text + from, "0, or a share up to 0.6 with b (from below) or s (from the side)");
  }
  synth.occluded_below = from == 'b';
}

Scene read_scene(Columns& columns) {
  Scene scene;
  SynthOptions& synth = scene.synth;
  scene.category = columns.word("category");
  scene.activity = columns.word("activity");
  const auto& known = activity_names();
  if (std::find(known.begin(), known.end(), scene.activity) == known.end()) {
    std::string names;
    for (const std::string& name : known) names += (names.empty() ? "" : ", ") + name;
    columns.complain("activity", scene.activity, "one of " + names);
  }
  scene.number = columns.whole("number", 1, 1'000'000);
  scene.posture = columns.choice<Posture>("posture", {{"stands", Posture::Standing},
                                                      {"together", Posture::LegsTogether},
                                                      {"chair", Posture::Chair},
                                                      {"wheelchair", Posture::Wheelchair}});
  synth.wish.body = columns.choice<Body>("body", {{"adult", Body::Adult}, {"child", Body::Child}});
  synth.wish.girth = columns.number("girth", 0.8, 1.4);
  synth.wish.clothes = columns.choice<Clothes>(
      "clothes", {{"plain", Clothes::Plain}, {"coat", Clothes::Coat}, {"skirt", Clothes::Skirt}});
  synth.distance_m = columns.number("distance", 1.5, 3.5);
  synth.turned_deg = columns.number("turned", -60, 60);
  synth.furnished = columns.choice<bool>("room", {{"furnished", true}, {"bare", false}});
  read_hidden(columns, synth);
  synth.carry = columns.choice<Bag>("carries", {{"nothing", Bag::None},
                                                {"bag", Bag::Hand},
                                                {"shoulder_bag", Bag::Shoulder},
                                                {"backpack", Bag::Backpack},
                                                {"mug", Bag::Mug},
                                                {"phone", Bag::Phone}});
  synth.carry_side = scene.number % 2 == 0 ? Side::Left : Side::Right;
  scene.company = columns.choice<Company>("company", {{"alone", Company::None},
                                                      {"beside", Company::Beside},
                                                      {"joins", Company::Joins},
                                                      {"before", Company::Before},
                                                      {"behind", Company::Behind}});
  synth.seed = scene.number | kHeldOut;
  synth.fps = Scene::kFps;
  return scene;
}

}  // namespace

Expected<std::vector<Scene>> read_scenes(const std::filesystem::path& path) {
  std::ifstream in(path);
  if (!in) return fail(path.string() + ": cannot be read; expected a file of scenes");
  std::vector<Scene> scenes;
  std::set<std::uint64_t> numbers;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    line = line.substr(0, line.find('#'));
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    Columns columns(line);
    const Scene scene = read_scene(columns);
    if (!numbers.insert(scene.number).second) {
      columns.complain("number", std::to_string(scene.number), "one that no other scene has");
    }
    if (!columns.wrong().empty()) return fail(path.string() + ":" + std::to_string(number) + ": " + columns.wrong());
    scenes.push_back(scene);
  }
  if (scenes.empty()) return fail(path.string() + ": holds no scene");
  return scenes;
}

std::vector<Scene> first_of_each_category(const std::vector<Scene>& scenes) {
  std::vector<Scene> first;
  std::set<std::string> seen;
  for (const Scene& scene : scenes) {
    if (seen.insert(scene.category).second) first.push_back(scene);
  }
  return first;
}

Expected<std::unique_ptr<SynthSource>> open_scene(const Scene& scene, int width, int height) {
  SynthOptions synth = scene.synth;
  synth.width = width;
  synth.height = height;
  return SynthSource::open(scene_script(scene), synth);
}

}  // namespace armature::tools
