#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <armature/navproto/error.h>

// Who may listen over a network: ZeroMQ's CURVE (Curve25519). Keys are 40 characters of Z85.

namespace armature::navproto {

/// One end's identity. The public key is told to the other end, the secret one to nobody.
struct KeyPair {
  std::string public_key;  ///< Z85, 40 characters
  std::string secret_key;  ///< Z85, 40 characters
};

/// Somebody who may connect.
struct AllowedKey {
  std::string public_key;  ///< Z85, 40 characters
  std::string name;        ///< for human beings; one line without '#'

  friend bool operator==(const AllowedKey&, const AllowedKey&) = default;
};

/// What a publisher over tcp needs: its own identity and whom it lets in. Everybody else is refused and counted.
struct CurveServer {
  KeyPair keys;                   ///< the publisher's own
  std::vector<AllowedKey> allow;  ///< nobody else is let in
};

/// What a subscriber to such a publisher needs.
struct CurveClient {
  std::string server_key;  ///< the publisher's public key
  KeyPair keys;            ///< the subscriber's own, whose public key is on the publisher's list
};

/// Whether `key` is 40 characters of Z85.
[[nodiscard]] bool is_key(std::string_view key) noexcept;

/// A new identity. Fails where libzmq was built without CURVE.
[[nodiscard]] Expected<KeyPair> make_key_pair();

/// Two lines, `public KEY` and `secret KEY`. Fails with NAME:LINE where the text holds anything else.
[[nodiscard]] Expected<KeyPair> parse_key_pair(std::string_view text, std::string_view name);
/// Reads what write_key_pair() wrote, a file of at most 1 MiB.
[[nodiscard]] Expected<KeyPair> read_key_pair(const std::filesystem::path& file);
/// Two lines, `public KEY` and `secret KEY`, mode 0600. Refuses to replace a file.
[[nodiscard]] Expected<void> write_key_pair(const std::filesystem::path& file, const KeyPair& keys);

/// A line for each allowed key: `KEY NAME`; '#' begins a comment, empty lines do not count. Fails with FILE:LINE.
[[nodiscard]] Expected<std::vector<AllowedKey>> parse_allow_list(std::string_view text, std::string_view name);
/// The same from a file of at most 1 MiB.
[[nodiscard]] Expected<std::vector<AllowedKey>> read_allow_list(const std::filesystem::path& file);
/// Adds a line to the list, which is made (mode 0640) where there is none. A key that is listed already is an error.
[[nodiscard]] Expected<void> allow_key(const std::filesystem::path& file, const AllowedKey& key);

}  // namespace armature::navproto
