#include "tracker/daemon/security.h"

#include <charconv>

#include <armature/navproto/endpoints.h>

namespace armature {

Expected<std::optional<navproto::CurveServer>> door_of(const Config& config) {
  if (!config.endpoint.starts_with("tcp:")) return std::nullopt;
  if (config.keys.empty() && config.allow.empty()) {
    if (config.insecure) return std::nullopt;
    return fail(
        "publish.endpoint = " + config.endpoint +
        ": everybody on the network could listen; set publish.keys and publish.allow (`armature keys --help`), or "
        "publish.insecure = true");
  }
  if (config.keys.empty() || config.allow.empty()) {
    return fail("publish.keys and publish.allow: expected both, or neither with publish.insecure = true");
  }
  auto keys = navproto::read_key_pair(config.keys);
  if (!keys) return fail(keys.error().message);
  auto allow = navproto::read_allow_list(config.allow);
  if (!allow) return fail(allow.error().message);
  return navproto::CurveServer{std::move(*keys), std::move(*allow)};
}

Expected<std::string> control_endpoint(const Config& config) {
  if (config.control.empty()) {
    return config.endpoint.starts_with("ipc:") ? config.endpoint : std::string(navproto::kDefaultEndpoint);
  }
  if (config.control.starts_with("ipc:")) return config.control;
  return fail("control.endpoint = " + config.control + ": expected ipc:///PATH, a socket of this machine");
}

Expected<std::vector<std::uint32_t>> control_uids(const Config& config) {
  std::vector<std::uint32_t> uids;
  for (std::string_view rest = config.control_uids; !rest.empty();) {
    const std::size_t blank = rest.find_first_not_of(" ,");
    if (blank == std::string_view::npos) break;
    rest.remove_prefix(blank);
    std::uint32_t uid = 0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), uid);
    if (error != std::errc()) return fail("control.uids = \"" + config.control_uids + "\": expected numbers of users");
    uids.push_back(uid);
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  }
  return uids;
}

}  // namespace armature
