#include <cstdlib>

#include <armature/navproto/keys.h>

// A file of keys: whatever the bytes, what is accepted is a pair of keys, what is not is refused in one line.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace armature::navproto;
  const auto keys = parse_key_pair({reinterpret_cast<const char*>(bytes), size}, "keys");
  if (!keys) {
    if (keys.error().message.find('\n') != std::string::npos) std::abort();
    return 0;
  }
  if (!is_key(keys->public_key) || !is_key(keys->secret_key)) std::abort();
  return 0;
}
