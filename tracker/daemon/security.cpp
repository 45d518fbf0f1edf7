#include "tracker/daemon/security.h"

#include <charconv>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

#include <armature/navproto/endpoints.h>

namespace armature {
namespace {

/// Where the sockets of an endpoint are to be: a name that one can have, and for files a folder that is there. That of
/// the default is made by systemd.
Expected<void> check_endpoint(const Config& config, std::string_view key, const std::string& endpoint) {
  if (const auto sockets = navproto::endpoints_of(endpoint); !sockets)
    return refuse(config, key, endpoint, sockets.error().message);
  constexpr std::string_view kIpc = "ipc://";
  if (!endpoint.starts_with(kIpc) || endpoint == navproto::kDefaultEndpoint) return {};
  const auto folder = std::filesystem::path(endpoint.substr(kIpc.size())).parent_path();
  std::error_code ignored;
  if (folder.empty() || std::filesystem::is_directory(folder, ignored)) return {};
  return refuse(config, key, endpoint, "its directory does not exist; create it or choose another endpoint");
}

}  // namespace

Expected<std::optional<navproto::CurveServer>> door_of(const Config& config) {
  if (const auto checked = check_endpoint(config, "publish.endpoint", config.endpoint); !checked)
    return tl::unexpected(checked.error());
  if (!config.endpoint.starts_with("tcp:")) return std::nullopt;
  if (config.keys.empty() && config.allow.empty()) {
    if (config.insecure) return std::nullopt;
    return refuse(config, "publish.endpoint", config.endpoint,
                  "everybody on the network could listen; set publish.keys and publish.allow (`armature keys --help`), "
                  "or publish.insecure = true");
  }
  constexpr std::string_view kBoth = "expected publish.keys and publish.allow, or neither with publish.insecure = true";
  if (config.allow.empty()) return refuse(config, "publish.keys", config.keys, kBoth);
  if (config.keys.empty()) return refuse(config, "publish.allow", config.allow, kBoth);
  auto keys = navproto::read_key_pair(config.keys);
  if (!keys) return refuse(config, "publish.keys", config.keys, keys.error().message);
  auto allow = navproto::read_allow_list(config.allow);
  if (!allow) return refuse(config, "publish.allow", config.allow, allow.error().message);
  return navproto::CurveServer{std::move(*keys), std::move(*allow)};
}

Expected<std::string> control_endpoint(const Config& config) {
  if (config.control.empty()) {
    return config.endpoint.starts_with("ipc:") ? config.endpoint : std::string(navproto::kDefaultEndpoint);
  }
  if (const auto checked = check_endpoint(config, "control.endpoint", config.control); !checked)
    return tl::unexpected(checked.error());
  if (config.control.starts_with("ipc:")) return config.control;
  return refuse(config, "control.endpoint", config.control, "expected ipc:///PATH, a socket of this machine");
}

Expected<std::vector<std::uint32_t>> control_uids(const Config& config) {
  std::vector<std::uint32_t> uids;
  for (std::string_view rest = config.control_uids; !rest.empty();) {
    const std::size_t blank = rest.find_first_not_of(" ,");
    if (blank == std::string_view::npos) break;
    rest.remove_prefix(blank);
    std::uint32_t uid = 0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), uid);
    if (error != std::errc()) return refuse(config, "control.uids", config.control_uids, "expected numbers of users");
    uids.push_back(uid);
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  }
  return uids;
}

}  // namespace armature
