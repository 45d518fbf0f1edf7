#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include <armature/sdk/error.h>

#include "viewer/session/arguments.h"

namespace armature::viewer {

class Session;

/// Something a user can do. Panels and scripts do nothing but commands.
struct Command {
  std::string_view name;
  std::string_view usage;  ///< its arguments
  std::string_view help;   ///< one line
  sdk::Expected<void> (*run)(Session&, Arguments&);
  bool while_busy = false;  ///< also while a job runs
};

///@{
/// By what they are about.
[[nodiscard]] std::span<const Command> file_commands();
[[nodiscard]] std::span<const Command> view_commands();
[[nodiscard]] std::span<const Command> sphere_commands();
[[nodiscard]] std::span<const Command> select_commands();
[[nodiscard]] std::span<const Command> pose_commands();
[[nodiscard]] std::span<const Command> edit_commands();
[[nodiscard]] std::span<const Command> walk_commands();
[[nodiscard]] std::span<const Command> script_commands();
///@}

/// The command of that name, or none.
[[nodiscard]] const Command* find_command(std::string_view name);

/// All of them, a line each, for people.
[[nodiscard]] std::string list_of_commands();

}  // namespace armature::viewer
