#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "firmware_host/error.h"
#include "tools/sdk_call.h"

namespace armature::tools {

/// The experiments of a benchmark by name, one method each.
template <class Bench, std::size_t N>
using Sections = std::array<std::pair<const char*, Expected<void> (Bench::*)()>, N>;

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
