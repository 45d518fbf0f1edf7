#pragma once

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "firmware_host/error.h"
#include "tools/json_lines.h"
#include "tools/sdk_call.h"

namespace armature::tools {

/// The experiments of a benchmark by name, one method each.
template <class Bench, std::size_t N>
using Sections = std::array<std::pair<const char*, Expected<void> (Bench::*)()>, N>;

/// What a benchmark says: text, or one JSON object a line.
struct Report {
  bool as_json = false;

  void title(const std::string& text) const {
    if (!as_json) fmt::print("\n{}\n", text);
  }
  [[nodiscard]] Expected<void> say(const Json& json, const std::string& line) const {
    if (as_json) return write_json_line(stdout, json);
    fmt::print("{}\n", line);
    std::fflush(stdout);
    return {};
  }
};

/// Runs those that are wanted, all if none is named, until one fails; `section` is told which.
template <class Bench, std::size_t N>
[[nodiscard]] Expected<void> run_sections(Bench& bench, const Sections<Bench, N>& sections,
                                          const std::vector<std::string>& only, const SdkCall& call,
                                          std::string& section) {
  for (const auto& [name, run] : sections) {
    if (!only.empty() && std::ranges::find(only, name) == only.end()) continue;
    if (call.interrupted()) return fail("stopped on request");
    section = name;
    if (auto done = (bench.*run)(); !done) return done;
  }
  return {};
}

}  // namespace armature::tools
