#pragma once

#include <string>
#include <vector>

namespace armature::tools {

/// Those of `files` that another user may not read, as the kernel says; a file that is not there is one. None where
/// that cannot be asked: by anybody but root, or where there is no such user. Asks by processes that become that user.
[[nodiscard]] std::vector<std::string> unreadable_by(const std::string& user, const std::vector<std::string>& files);

}  // namespace armature::tools
