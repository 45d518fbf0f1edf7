#include "navproto/src/gatekeeper.h"

#include <array>
#include <cstring>

namespace armature::navproto {
namespace {

constexpr const char* kDoor = "inproc://zeromq.zap.01";
constexpr const char* kStop = "inproc://armature.gatekeeper.stop";
constexpr std::size_t kRawKeyBytes = 32;
enum Request : std::size_t { Version, Id, Domain, Address, Identity, Mechanism, Credentials };
constexpr std::size_t kRequestParts = Credentials + 1;

void set_text(Socket& socket, int option, const std::string& text) {
  zmq_setsockopt(socket.get(), option, text.data(), text.size());
}

}  // namespace

Gatekeeper::Gatekeeper(void* context, const CurveServer& curve)
    : curve_(curve), door_(context, ZMQ_REP), stop_(context, ZMQ_PAIR), stopped_(context, ZMQ_PAIR) {
  for (const AllowedKey& key : curve_.allow) allowed_.insert(key.public_key);
  for (Socket* socket : {&door_, &stop_, &stopped_}) socket->set(ZMQ_LINGER, 0);
  if (zmq_bind(door_.get(), kDoor) != 0 || zmq_bind(stopped_.get(), kStop) != 0 || zmq_connect(stop_.get(), kStop) != 0)
    return;
  thread_ = std::thread([this] { answer_until_stopped(); });
}

Gatekeeper::~Gatekeeper() {
  if (!thread_.joinable()) return;
  stop_.send({});
  thread_.join();
}

void Gatekeeper::guard(Socket& socket) const {
  socket.set(ZMQ_CURVE_SERVER, 1);
  set_text(socket, ZMQ_CURVE_SECRETKEY, curve_.keys.secret_key);
  set_text(socket, ZMQ_ZAP_DOMAIN, "armature");
}

bool Gatekeeper::known(std::span<const std::byte> key) const {
  if (key.size() != kRawKeyBytes) return false;
  std::array<char, 41> text{};
  zmq_z85_encode(text.data(), reinterpret_cast<const std::uint8_t*>(key.data()), key.size());
  return allowed_.contains(std::string_view(text.data()));
}

void Gatekeeper::answer_until_stopped() {
  std::array<zmq_pollitem_t, 2> items{{{stopped_.get(), 0, ZMQ_POLLIN, 0}, {door_.get(), 0, ZMQ_POLLIN, 0}}};
  std::array<Part, kRequestParts> parts;
  Part more;
  for (;;) {
    if (!poll(items, std::chrono::milliseconds(-1))) continue;
    if (items[0].revents != 0) return;
    std::size_t count = 0;
    bool rest = true;
    while (rest) {
      Part& part = count < parts.size() ? parts[count] : more;
      if (!door_.receive(part)) break;
      rest = part.more();
      ++count;
    }
    if (count == 0) continue;
    const bool allowed = count == kRequestParts && known(parts[Credentials].bytes());
    if (!allowed) refused_.fetch_add(1, std::memory_order_relaxed);
    const auto say = [&](std::string_view text, int flags) { door_.send(std::as_bytes(std::span(text)), flags); };
    say("1.0", ZMQ_SNDMORE);
    door_.send(parts[Id].bytes(), ZMQ_SNDMORE);
    say(allowed ? "200" : "400", ZMQ_SNDMORE);
    say(allowed ? "" : "unknown key", ZMQ_SNDMORE);
    say("", ZMQ_SNDMORE);
    say("", 0);
  }
}

void identify(Socket& socket, const CurveClient& curve) {
  set_text(socket, ZMQ_CURVE_SERVERKEY, curve.server_key);
  set_text(socket, ZMQ_CURVE_PUBLICKEY, curve.keys.public_key);
  set_text(socket, ZMQ_CURVE_SECRETKEY, curve.keys.secret_key);
}

}  // namespace armature::navproto
