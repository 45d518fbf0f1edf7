#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <utility>

#include <armature/sdk/deformation/session.h>

namespace armature::sdk {
namespace {

constexpr std::string_view kHeader = "armature deformation 1";

void put(std::string& text, double number) {
  std::array<char, 32> digits;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), number);
  text += ' ';
  text.append(digits.data(), end);
}

void put(std::string& text, std::string_view what, const Eigen::Vector3d& vector) {
  text += what;
  for (const double number : vector) put(text, number);
}

/// One line, word by word.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line.substr(0, line.find('#'))) { skip(); }

  [[nodiscard]] bool ended() const noexcept { return rest_.empty(); }
  std::string_view next() noexcept {
    last_ = rest_.substr(0, rest_.find_first_of(kBlanks));
    rest_.remove_prefix(last_.size());
    skip();
    return last_;
  }
  /// The next word as a number, whole; nothing, and the word stays, if it is none.
  template <class Number>
  std::optional<Number> number() noexcept {
    const std::string_view before = rest_;
    const std::string_view word = next();
    Number value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error == std::errc() && end == word.data() + word.size() && !word.empty()) return value;
    rest_ = before;
    return std::nullopt;
  }
  std::optional<Eigen::Vector3d> vector() noexcept {
    Eigen::Vector3d result;
    for (double& coordinate : result) {
      const auto read = number<double>();
      if (!read) return std::nullopt;
      coordinate = *read;
    }
    return result;
  }
  /// What stands here, as messages show it.
  [[nodiscard]] std::string found() const {
    if (rest_.empty()) return "the line ends here";
    std::string word(rest_.substr(0, std::min<std::size_t>(40, rest_.find_first_of(kBlanks))));
    std::ranges::replace_if(
        word, [](char c) { return c < ' ' || c > '~'; }, '?');
    return "found '" + word + "'";
  }

 private:
  static constexpr std::string_view kBlanks = " \t\r";
  void skip() noexcept { rest_.remove_prefix(std::min(rest_.find_first_not_of(kBlanks), rest_.size())); }

  std::string_view rest_;
  std::string_view last_;
};

Expected<std::vector<SphereId>> spheres_of(Words& words) {
  std::vector<SphereId> spheres;
  if (words.next() != "spheres") return fail("expected `spheres` and their numbers");
  while (const auto sphere = words.number<std::uint32_t>()) spheres.emplace_back(*sphere);
  return spheres;
}

struct ReadMove {
  SphereMove move;
  MoveOptions options = {};
};

Expected<ReadMove> move_of(Words& words) {
  ReadMove line;
  auto spheres = spheres_of(words);
  if (!spheres) return tl::unexpected(spheres.error());
  line.move.spheres = std::move(*spheres);
  while (!words.ended()) {
    const std::string expected_here =
        "expected a sphere, `translate`, `rotate`, `about`, `scale`, `radius`, `frame` or `surface`; " + words.found();
    const std::string_view what = words.next();
    if (what == "translate" || what == "rotate" || what == "about") {
      const auto vector = words.vector();
      if (!vector) return fail("expected three numbers behind `" + std::string(what) + "`; " + words.found());
      if (what == "translate") line.move.translate = *vector;
      if (what == "rotate") line.move.rotate = *vector;
      if (what == "about") line.move.about = *vector;
    } else if (what == "scale" || what == "radius") {
      const auto number = words.number<double>();
      if (!number) return fail("expected a number behind `" + std::string(what) + "`; " + words.found());
      if (what == "scale") line.move.scale = *number;
      if (what == "radius") line.move.radius = *number;
    } else if (what == "surface") {
      const auto rings = words.number<std::uint32_t>();
      if (!rings) return fail("expected a number of edges behind `surface`; " + words.found());
      line.options.surface_rings = *rings;
    } else if (what == "frame") {
      const std::string found = words.found();
      const std::string_view frame = words.next();
      if (frame != "parent" && frame != "model") return fail("expected `parent` or `model` behind `frame`; " + found);
      line.options.frame = frame == "parent" ? MoveFrame::Parent : MoveFrame::Model;
    } else {
      return fail(expected_here);
    }
  }
  return line;
}

}  // namespace

std::string DeformationSession::text() const {
  std::string text = std::string(kHeader) + "\nvertices " + std::to_string(positions_.size()) + '\n';
  std::size_t level = 0;
  const auto at_level = [&](std::size_t spheres) {
    if (spheres != level) text += "level " + std::to_string(spheres) + '\n';
    level = spheres;
  };
  for (const Step& step : done_) {
    at_level(step.level);
    text += step.pins ? (*step.pins ? "pin spheres" : "unpin spheres") : "move spheres";
    for (const SphereId sphere : step.move.spheres) text += ' ' + std::to_string(sphere.index());
    if (!step.move.translate.isZero(0)) put(text, " translate", step.move.translate);
    if (!step.move.rotate.isZero(0)) put(text, " rotate", step.move.rotate);
    if (step.move.about) put(text, " about", *step.move.about);
    if (step.move.scale != 1) put(text += " scale", step.move.scale);
    if (step.move.radius) put(text += " radius", *step.move.radius);
    if (step.options.frame == MoveFrame::Parent) text += " frame parent";
    if (step.options.surface_rings > 0) text += " surface " + std::to_string(step.options.surface_rings);
    text += '\n';
  }
  at_level(nodes_.size());
  return text;
}

struct DeformationSession::Line {
  enum class Verb : std::uint8_t { Level, Move, Pin, Unpin };
  std::size_t number = 0;  // in the text
  Verb verb = Verb::Level;
  std::size_t level = 0;  // to go to
  ReadMove move = {};     // of a pin, its spheres
};

Expected<std::vector<DeformationSession::Line>> DeformationSession::lines_of(std::string_view text,
                                                                             std::string_view name) const {
  std::vector<Line> lines;
  std::size_t level = nodes_.size(), number = 0;
  bool begun = false;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    ++number;
    const auto wrong = [&](const std::string& what) {
      return fail(std::string(name) + ", line " + std::to_string(number) + ": " + what);
    };
    Words words(line);
    if (words.ended()) continue;
    if (!begun) {
      if (line.substr(0, line.find_last_not_of(" \t\r") + 1) != kHeader)
        return wrong("expected `" + std::string(kHeader) + "`; is this a deformation session?");
      begun = true;
      continue;
    }
    const std::string found = words.found();
    const std::string_view verb = words.next();
    Line read{.number = number};
    Expected<void> checked;
    if (verb == "vertices") {
      const auto vertices = words.number<std::size_t>();
      if (vertices != positions_.size())
        return wrong("expected a session of a mesh with " + std::to_string(positions_.size()) + " vertices; " +
                     (vertices ? "found " + std::to_string(*vertices) : words.found()));
    } else if (verb == "level") {
      const auto spheres = words.number<std::size_t>();
      if (!spheres) return wrong("expected a number of spheres behind `level`; " + words.found());
      checked = check_level(*spheres);
      read.level = level = *spheres;
    } else if (verb == "move" || verb == "pin" || verb == "unpin") {
      read.verb = verb == "move" ? Line::Verb::Move : verb == "pin" ? Line::Verb::Pin : Line::Verb::Unpin;
      auto move = verb == "move" ? move_of(words) : spheres_of(words).map([](std::vector<SphereId>&& spheres) {
        return ReadMove{.move = {.spheres = std::move(spheres)}};
      });
      if (!move) return wrong(move.error().message);
      checked = check(move->move, level);
      read.move = std::move(*move);
    } else {
      return wrong("expected `vertices`, `level`, `move`, `pin` or `unpin`; " + found);
    }
    if (!checked) return wrong(checked.error().message);
    if (!words.ended()) return wrong("expected the line to end here; " + words.found());
    if (verb != "vertices") lines.push_back(std::move(read));
  }
  if (!begun) return fail(std::string(name) + ": is empty; expected `" + std::string(kHeader) + "`");
  return lines;
}

Expected<void> DeformationSession::carry_out(const Line& line) {
  switch (line.verb) {
    case Line::Verb::Level: return go_to(line.level);
    case Line::Verb::Move: return move(line.move.move, line.move.options);
    case Line::Verb::Pin: return pin(line.move.move.spheres, true);
    case Line::Verb::Unpin: break;
  }
  return pin(line.move.move.spheres, false);
}

Expected<void> DeformationSession::replay(std::string_view text, std::string_view name, const Task& task) {
  cancel();
  const auto lines = lines_of(text, name);
  if (!lines) return tl::unexpected(lines.error());
  const std::size_t before = steps(), level = nodes_.size();
  std::vector<Step> undone = std::exchange(undone_, {});
  for (std::size_t i = 0; i < lines->size(); ++i) {
    const Line& line = (*lines)[i];
    task.report("moving spheres", static_cast<double>(i) / static_cast<double>(lines->size()));
    const auto done = task.stopped() ? Expected<void>(cancelled()) : carry_out(line);
    if (done) continue;
    take_back(before, level);
    undone_ = std::move(undone);
    if (done.error().kind == ErrorKind::Cancelled) return done;
    return fail(std::string(name) + ", line " + std::to_string(line.number) + ": " + done.error().message);
  }
  if (steps() == before) undone_ = std::move(undone);
  return {};
}

}  // namespace armature::sdk
