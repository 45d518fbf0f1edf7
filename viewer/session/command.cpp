#include "viewer/session/command.h"

#include <array>

#include <fmt/format.h>

namespace armature::viewer {
namespace {

std::array<std::span<const Command>, 8> all_commands() {
  return {file_commands(), view_commands(), sphere_commands(), select_commands(),
          pose_commands(), edit_commands(), walk_commands(),   script_commands()};
}

}  // namespace

const Command* find_command(std::string_view name) {
  for (const auto group : all_commands())
    for (const Command& command : group)
      if (command.name == name) return &command;
  return nullptr;
}

std::string list_of_commands() {
  std::string list;
  for (const auto group : all_commands())
    for (const Command& command : group)
      list += fmt::format("  {:<40} {}\n", fmt::format("{} {}", command.name, command.usage), command.help);
  return list;
}

}  // namespace armature::viewer
