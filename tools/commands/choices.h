#pragma once

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

/// Options that take one of some names. A table of pairs, name and what it stands for, is the only place that lists
/// them.
namespace armature::tools {

/// The names of a table, for CLI::IsMember and help.
template <class Table>
[[nodiscard]] std::vector<std::string> names_of(const Table& table) {
  std::vector<std::string> names;
  for (const auto& [name, value] : table) names.emplace_back(name);
  return names;
}

/// What a name stands for, which must be in the table.
template <class Table>
[[nodiscard]] const auto& choice_of(const Table& table, std::string_view name) {
  return std::find_if(std::begin(table), std::end(table), [&](const auto& entry) { return entry.first == name; })
      ->second;
}

}  // namespace armature::tools
