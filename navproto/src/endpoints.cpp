#include <cerrno>
#include <charconv>

#include <armature/navproto/endpoints.h>

#include "navproto/src/transport.h"

namespace armature::navproto {
namespace {

constexpr unsigned kLastPort = 65535;

}  // namespace

Expected<Endpoints> endpoints_of(std::string_view base) {
  const std::string text(base);
  if (base.starts_with(kIpc)) {
    const std::string_view path = base.substr(kIpc.size());
    constexpr std::size_t kRoom = sizeof(sockaddr_un::sun_path) - sizeof(".skeleton");
    if (path.empty() || path == "*" || path == "@" || path.ends_with('/')) {
      return fail("endpoint " + text + ": expected ipc:// and the path of a socket");
    }
    if (path.size() > kRoom) {
      return fail("endpoint " + text + ": the path has " + std::to_string(path.size()) + " bytes and may have " +
                  std::to_string(kRoom));
    }
    return Endpoints{text, text + ".skeleton", text + ".events", text + ".feed", text + ".control"};
  }
  if (base.starts_with(kTcp)) {
    const std::size_t colon = base.rfind(':');
    const std::string_view digits = base.substr(colon + 1);
    unsigned port = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
    const bool whole = error == std::errc() && end == digits.data() + digits.size();
    if (colon <= kTcp.size() || !whole || port < 1 || port > kLastPort - 4) {
      return fail("endpoint " + text + ": expected tcp://HOST:PORT with a port from 1 to " +
                  std::to_string(kLastPort - 4));
    }
    const std::string host = text.substr(0, colon + 1);
    const auto at = [&](unsigned offset) { return host + std::to_string(port + offset); };
    return Endpoints{text, at(1), at(2), at(3), at(4)};
  }
  return fail("endpoint " + text + ": expected ipc://PATH or tcp://HOST:PORT");
}

Expected<void> may_connect(std::string_view endpoint) {
  if (!endpoint.starts_with(kIpc)) return {};
  const LocalAddress address(endpoint.substr(kIpc.size()));
  const Descriptor probe = stream_socket(AF_UNIX);
  if (::connect(probe.get(), address.get(), address.size) == 0 || errno != EACCES) return {};
  return fail(std::string(endpoint) + ": permission denied; " + std::string(kHowToBeLetIn));
}

}  // namespace armature::navproto
