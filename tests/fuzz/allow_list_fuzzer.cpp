#include <cstdlib>

#include <armature/navproto/keys.h>

// A list of keys: whatever the bytes, every key of it is one.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace armature::navproto;
  const auto list = parse_allow_list({reinterpret_cast<const char*>(bytes), size}, "list");
  if (!list) return 0;
  for (const AllowedKey& key : *list) {
    if (!is_key(key.public_key)) std::abort();
  }
  return 0;
}
