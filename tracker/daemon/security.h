#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <armature/navproto/keys.h>

#include "tracker/config.h"

namespace armature {

/// Whom the endpoint lets in. ipc: nothing to say (the file's mode does). tcp: our keys and the allow list, or nothing
/// where the configuration says that it is insecure; anything else is refused, as are an endpoint that is none or
/// in no folder, and files that cannot be read. Like all errors here it names file, line and key.
[[nodiscard]] Expected<std::optional<navproto::CurveServer>> door_of(const Config& config);

/// Beside which endpoint the control socket stands: always one of this machine.
[[nodiscard]] Expected<std::string> control_endpoint(const Config& config);

/// control.uids as numbers.
[[nodiscard]] Expected<std::vector<std::uint32_t>> control_uids(const Config& config);

}  // namespace armature
