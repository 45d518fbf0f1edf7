#include "tracker/daemon/metrics.h"

#include <cerrno>
#include <cstring>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace armature {
namespace {

using namespace std::chrono_literals;

constexpr auto kTick = 100ms;
constexpr timeval kPatience{.tv_sec = 0, .tv_usec = 500'000};

void answer(int client, const std::function<std::string()>& text) {
  ::setsockopt(client, SOL_SOCKET, SO_RCVTIMEO, &kPatience, sizeof kPatience);
  ::setsockopt(client, SOL_SOCKET, SO_SNDTIMEO, &kPatience, sizeof kPatience);
  std::array<char, 2048> request{};
  const auto got = ::recv(client, request.data(), request.size() - 1, 0);
  if (got <= 0) return;
  const std::string_view line(request.data(), static_cast<std::size_t>(got));
  const bool known = line.starts_with("GET /metrics ") || line.starts_with("GET / ");
  const std::string body = known ? text() : "only GET /metrics\n";
  const std::string reply = fmt::format(
      "HTTP/1.1 {}\r\nContent-Type: text/plain; version=0.0.4\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{}",
      known ? "200 OK" : "404 Not Found", body.size(), body);
  for (std::size_t sent = 0; sent < reply.size();) {
    const auto now = ::send(client, reply.data() + sent, reply.size() - sent, MSG_NOSIGNAL);
    if (now <= 0) return;
    sent += static_cast<std::size_t>(now);
  }
}

}  // namespace

void Histogram::add(std::chrono::nanoseconds took) noexcept {
  const double ms = std::chrono::duration<double, std::milli>(took).count();
  std::size_t bucket = 0;
  while (bucket < kBounds_ms.size() && ms > kBounds_ms[bucket]) ++bucket;
  counts_[bucket].fetch_add(1, std::memory_order_relaxed);
  sum_ns_.fetch_add(took.count(), std::memory_order_relaxed);
}

void Histogram::print(std::string& out, std::string_view name, std::string_view labels) const {
  const std::string before = labels.empty() ? "" : std::string(labels) + ",";
  const std::string alone = labels.empty() ? "" : fmt::format("{{{}}}", labels);
  std::uint64_t total = 0;
  for (std::size_t b = 0; b <= kBounds_ms.size(); ++b) {
    total += counts_[b].load(std::memory_order_relaxed);
    const std::string bound = b < kBounds_ms.size() ? fmt::format("{:g}", kBounds_ms[b] / 1000) : "+Inf";
    out += fmt::format("{}_bucket{{{}le=\"{}\"}} {}\n", name, before, bound, total);
  }
  out += fmt::format("{}_sum{} {:.9f}\n", name, alone,
                     static_cast<double>(sum_ns_.load(std::memory_order_relaxed)) * 1e-9);
  out += fmt::format("{}_count{} {}\n", name, alone, total);
}

std::string prometheus_text(const Metrics& metrics, std::string_view version) {
  std::string out;
  const auto say = [&](std::string_view name, std::string_view type, std::string_view help, auto value) {
    out += fmt::format("# HELP armature_{0} {2}\n# TYPE armature_{0} {1}\narmature_{0} {3}\n", name, type, help, value);
  };
  out += fmt::format(
      "# HELP armature_info The daemon's version.\n# TYPE armature_info gauge\narmature_info{{version=\"{}\"}} 1\n",
      version);
  say("frames_total", "counter", "Frames tracked.", metrics.frames.load());
  say("frames_dropped_total", "counter", "Frames overtaken by a newer one.", metrics.dropped.load());
  say("frames_refused_total", "counter", "Torn, garbage or frozen frames, and clocks that jump or stand still.",
      metrics.bad_frames.load());
  say("source_alive", "gauge", "Whether good frames come.", metrics.source_alive.load() ? 1 : 0);
  say("source_blind", "gauge", "Whether good frames come that show nothing.", metrics.source_blind.load() ? 1 : 0);
  say("source_restarts_total", "counter", "Starts of the capture process after the first.", metrics.restarts.load());
  say("stops_total", "counter", "Zeros published because of the source.", metrics.stops.load());
  say("engagement_state", "gauge", "0 absent, 1 waiting, 2 calibrating, 3 engaged, 4 lost.", metrics.engagement.load());
  say("engaged_total", "counter", "Users who began to steer.", metrics.engaged.load());
  say("released_total", "counter", "Users who were released.", metrics.released.load());
  say("peers_refused_total", "counter", "Peers sent away because their key is not on the list.",
      metrics.strangers.load());
  say("control_refused_total", "counter", "Control requests that were not carried out.",
      metrics.control_refused.load());
  say("reloads_total", "counter", "Configurations taken.", metrics.reloads.load());
  say("reloads_refused_total", "counter", "Configurations refused.", metrics.reloads_refused.load());
  say("resident_bytes", "gauge", "Memory that the daemon holds.", metrics.resident_bytes.load());
  out +=
      "# HELP armature_latency_seconds Frame received to message handed to the socket.\n"
      "# TYPE armature_latency_seconds histogram\n";
  metrics.latency.print(out, "armature_latency_seconds", "");
  out += "# HELP armature_stage_seconds Each stage of the tracker.\n# TYPE armature_stage_seconds histogram\n";
  for (std::size_t s = 0; s < kStageCount; ++s) {
    metrics.stage[s].print(out, "armature_stage_seconds", fmt::format("stage=\"{}\"", kStageNames[s]));
  }
  return out;
}

Expected<std::unique_ptr<MetricsServer>> MetricsServer::start(int port, std::function<std::string()> text) {
  const int listener = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int yes = 1;
  ::setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  if (listener < 0 || ::bind(listener, reinterpret_cast<sockaddr*>(&address), size) != 0 ||
      ::listen(listener, 8) != 0 || ::getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    const std::string why = std::strerror(errno);
    if (listener >= 0) ::close(listener);
    return fail(fmt::format("health.metrics_port = {}: {}; choose a port that is free", port, why));
  }
  return std::unique_ptr<MetricsServer>(new MetricsServer(listener, ntohs(address.sin_port), std::move(text)));
}

MetricsServer::MetricsServer(int listener, int port, std::function<std::string()> text)
    : listener_(listener), port_(port), text_(std::move(text)) {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

MetricsServer::~MetricsServer() {
  thread_.request_stop();
  thread_.join();
  ::close(listener_);
}

void MetricsServer::run(const std::stop_token& stop) const {
  while (!stop.stop_requested()) {
    pollfd event{listener_, POLLIN, 0};
    if (::poll(&event, 1, static_cast<int>(kTick.count())) <= 0) continue;
    const int client = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    if (client < 0) continue;
    answer(client, text_);
    ::close(client);
  }
}

}  // namespace armature
