// What scripts need beside what panels do: waiting, expecting, telling, pictures.
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>

#include <fmt/format.h>

#include "viewer/session/command.h"
#include "viewer/session/session.h"

namespace armature::viewer {
namespace {

using Done = sdk::Expected<void>;

std::optional<double> number(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Whether a fact is as expected: the same text, or a number within the tolerance or the bound.
bool holds(const std::optional<std::string>& fact, const std::string& expected, double tolerance) {
  const std::string found = fact.value_or("none");
  if (expected.starts_with(">") || expected.starts_with("<")) {
    const auto bound = number(expected.substr(1)), value = number(found);
    return bound && value && (expected[0] == '>' ? *value > *bound : *value < *bound);
  }
  if (expected.starts_with("~")) return found.find(expected.substr(1)) != std::string::npos;
  const auto a = number(found), b = number(expected);
  if (a && b) return std::abs(*a - *b) <= tolerance;
  return found == expected;
}

/// Nothing where there is no such fact, which scripts call none.
std::optional<std::string> fact(const Session& session, const std::string& name) {
  const auto facts = session.report();
  const auto place = facts.find(name);
  return place == facts.end() ? std::nullopt : std::optional(place->second);
}

/// Says that a fact is not as expected.
std::string otherwise(const std::string& name, const char* is, const std::optional<std::string>& found,
                      const std::string& expected) {
  return found ? fmt::format("{} {} {}, expected {}", name, is, as_word(*found), as_word(expected))
               : fmt::format("there is no fact {}, expected {}; `report` lists them", name, as_word(expected));
}

Done expect(Session& session, Arguments& arguments) {
  const std::string name = arguments.word("fact");
  const std::string expected = arguments.word("value");
  const double tolerance = arguments.left() > 0 ? arguments.number("tolerance", 0) : 0;
  if (auto checked = arguments.check(); !checked) return checked;
  const auto found = fact(session, name);
  if (holds(found, expected, tolerance)) return {};
  return sdk::fail(otherwise(name, "is", found, expected));
}

/// wait SECONDS, or wait SECONDS FACT VALUE: at most so long, until it holds.
Done wait(Session& session, Arguments& arguments) {
  const double seconds = arguments.number("seconds", 0, 3600);
  const std::string name = arguments.left() > 0 ? arguments.word("fact") : "";
  const std::string expected = name.empty() ? "" : arguments.word("value");
  if (auto checked = arguments.check(); !checked) return checked;
  const auto until = session.now + std::chrono::duration_cast<Session::Time>(std::chrono::duration<double>(seconds));
  session.waiting = [&session, until, name, expected, origin = session.origin] {
    if (!name.empty() && holds(fact(session, name), expected, 0)) return true;
    if (session.now < until) return false;
    if (!name.empty()) {
      session.tell_failure(origin, "wait: " + otherwise(name, "is still", fact(session, name), expected));
    }
    return true;
  };
  return {};
}

Done report(Session& session, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  for (const auto& [name, value] : session.report()) fmt::print("{} {}\n", name, value);
  std::fflush(stdout);
  session.longest_frame = session.longest_work = {};
  return {};
}

/// A picture's size, where there is another word.
Done read_size(Arguments& arguments, PictureRequest& request) {
  if (arguments.left() == 0) return {};
  const auto size = parse_size(arguments.word("size"));
  if (!size) return sdk::fail("size: " + size.error().message);
  request.size = *size;
  return {};
}

Done screenshot(Session& session, Arguments& arguments) {
  PictureRequest request{.file = arguments.file(), .origin = session.origin};
  if (auto sized = read_size(arguments, request); !sized) return sized;
  if (auto checked = arguments.check(); !checked) return checked;
  if (lower_extension(request.file) != ".png") return sdk::fail(request.file + ": expected a name that ends in .png");
  session.picture = std::move(request);
  return {};
}

Done frame_times(Session& session, Arguments& arguments) {
  PictureRequest request{.origin = session.origin};
  request.turn = static_cast<int>(arguments.count("pictures", 1, 1000));
  if (auto sized = read_size(arguments, request); !sized) return sized;
  if (auto checked = arguments.check(); !checked) return checked;
  session.picture = std::move(request);
  return {};
}

Done cancel(Session& session, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  if (session.job.running() && session.job.whole())
    return sdk::fail(session.job.title() + " cannot be left half done; it ends by itself");
  session.job.cancel();
  return {};
}

Done quit(Session& session, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  session.quit = true;
  return {};
}

Done help(Session&, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  fmt::print("{}", list_of_commands());
  return {};
}

constexpr std::array kCommands = {
    Command{"wait", "SECONDS [FACT VALUE]", "let time pass, or until a fact holds; fails where it does not", wait,
            true},
    Command{"expect", "FACT VALUE [TOLERANCE]", "fail where it is otherwise; VALUE may be >N, <N or ~PART", expect,
            true},
    Command{"report", "", "print all facts", report, true},
    Command{"screenshot", "FILE.png [WxH]", "write what the window shows", screenshot, true},
    Command{"frame-times", "PICTURES [WxH]", "turn the camera once around and print what pictures take", frame_times,
            true},
    Command{"cancel", "", "end what runs in the background", cancel, true},
    Command{"quit", "", "close the window", quit, true},
    Command{"help", "", "print all commands", help, true},
};

}  // namespace

std::span<const Command> script_commands() {
  return kCommands;
}

}  // namespace armature::viewer
