#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include <armature/navproto/keys.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zmq.h>

namespace armature::navproto {
namespace {

constexpr std::size_t kKeyLength = 40;
constexpr std::string_view kZ85 =
    "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ.-:+=^!/*?&<>()[]{}@%$#";
constexpr std::uintmax_t kMaxFileBytes = 1 << 20;
constexpr std::string_view kBlank = " \t\r";

Expected<std::string> read_text(const std::filesystem::path& file) {
  if (::access(file.c_str(), R_OK) != 0 && errno == EACCES) {
    return fail(file.string() +
                ": this user may not read it; for the installed daemon run `systemd-tmpfiles --create armature.conf` "
                "as root, else give it the reader's group (chgrp, chmod 640)");
  }
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    return fail(file.string() + ": no such file; `armature keys new` and `armature keys allow` make one");
  }
  if (std::filesystem::file_size(file, error) > kMaxFileBytes) return fail(file.string() + ": larger than 1 MiB");
  std::ifstream in(file, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (!in && !in.eof()) return fail(file.string() + ": cannot be read");
  return text;
}

Expected<void> write_all(const std::filesystem::path& file, int flags, mode_t mode, const std::string& text) {
  const int descriptor = ::open(file.c_str(), flags | O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, mode);
  if (descriptor < 0 && errno == EEXIST)
    return fail(file.string() + ": is there already and stays as it is; choose another name, or move it away first");
  if (descriptor < 0) return fail(file.string() + ": cannot be written: " + std::strerror(errno));
  const off_t before = ::lseek(descriptor, 0, SEEK_END);
  const bool written =
      ::write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size()) && ::fsync(descriptor) == 0;
  // Nothing is left half-written: neither half a line nor half a pair of keys.
  if (!written) (void)((flags & O_EXCL) != 0 ? ::unlink(file.c_str()) : ::ftruncate(descriptor, before));
  if (::close(descriptor) != 0 || !written) return fail(file.string() + ": cannot be written: is the disk full?");
  return {};
}

/// Cuts the first word off.
std::string_view take_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
  const auto word = line.substr(0, line.find_first_of(kBlank));
  line.remove_prefix(word.size());
  line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
  while (!line.empty() && kBlank.find(line.back()) != std::string_view::npos) line.remove_suffix(1);
  return word;
}

template <class Take>
Expected<void> each_line(std::string_view text, std::string_view name, Take take) {
  for (int number = 1; !text.empty(); ++number) {
    const auto line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (const char* complaint = take(line)) {
      return fail(std::string(name) + ":" + std::to_string(number) + ": " + complaint);
    }
  }
  return {};
}

}  // namespace

bool is_key(std::string_view key) noexcept {
  return key.size() == kKeyLength &&
         std::ranges::all_of(key, [](char c) { return kZ85.find(c) != std::string_view::npos; });
}

Expected<KeyPair> make_key_pair() {
  std::array<char, kKeyLength + 1> open{}, secret{};
  // A key that began with '-' would be taken for an option, one with '#' for a comment.
  do {
    if (zmq_curve_keypair(open.data(), secret.data()) != 0) {
      return fail("keys: this libzmq has no CURVE; install Debian's libzmq5");
    }
  } while (open.front() == '-' || open.front() == '#');
  return KeyPair{open.data(), secret.data()};
}

Expected<KeyPair> parse_key_pair(std::string_view text, std::string_view name) {
  KeyPair keys;
  const auto read = each_line(text, name, [&](std::string_view line) -> const char* {
    const auto what = take_word(line);
    if (what.empty() && line.empty()) return nullptr;
    if ((what != "public" && what != "secret") || !is_key(line)) return "expected 'public KEY' or 'secret KEY'";
    (what == "public" ? keys.public_key : keys.secret_key) = line;
    return nullptr;
  });
  if (!read) return tl::unexpected(read.error());
  std::array<char, kKeyLength + 1> derived{};
  if (!is_key(keys.secret_key) || zmq_curve_public(derived.data(), keys.secret_key.c_str()) != 0 ||
      keys.public_key != derived.data()) {
    return fail(std::string(name) + ": expected a public and a secret key that belong together");
  }
  return keys;
}

Expected<KeyPair> read_key_pair(const std::filesystem::path& file) {
  const auto text = read_text(file);
  if (!text) return tl::unexpected(text.error());
  return parse_key_pair(*text, file.string());
}

Expected<void> write_key_pair(const std::filesystem::path& file, const KeyPair& keys) {
  return write_all(file, O_EXCL, 0600, "public " + keys.public_key + "\nsecret " + keys.secret_key + "\n");
}

Expected<std::vector<AllowedKey>> parse_allow_list(std::string_view text, std::string_view name) {
  std::vector<AllowedKey> list;
  const auto read = each_line(text, name, [&](std::string_view line) -> const char* {
    auto rest = line;
    const auto key = take_word(rest);
    // '#' is a character of keys too: it begins a comment where a key or a name would begin.
    if (key.empty() || (key.starts_with('#') && !is_key(key))) return nullptr;
    if (!is_key(key)) return "expected a public key of 40 characters and a name";
    if (std::ranges::any_of(list, [&](const AllowedKey& known) { return known.public_key == key; })) {
      return "this key stands above already";
    }
    list.push_back({std::string(key), std::string(rest.substr(0, rest.find('#')))});
    return nullptr;
  });
  if (!read) return tl::unexpected(read.error());
  return list;
}

Expected<std::vector<AllowedKey>> read_allow_list(const std::filesystem::path& file) {
  const auto text = read_text(file);
  if (!text) return tl::unexpected(text.error());
  return parse_allow_list(*text, file.string());
}

Expected<void> allow_key(const std::filesystem::path& file, const AllowedKey& key) {
  if (!is_key(key.public_key)) return fail("key '" + key.public_key + "': expected 40 characters of Z85");
  if (key.name.find_first_of("#\n\r") != std::string::npos) return fail("name: expected one line without '#'");
  std::error_code error;
  bool last_line_ended = true;
  if (std::filesystem::exists(file, error)) {
    const auto text = read_text(file);
    if (!text) return tl::unexpected(text.error());
    const auto list = parse_allow_list(*text, file.string());
    if (!list) return tl::unexpected(list.error());
    last_line_ended = text->empty() || text->back() == '\n';
    for (const AllowedKey& known : *list) {
      if (known.public_key == key.public_key) {
        return fail(file.string() + ": this key is listed already, as '" + known.name + "'");
      }
    }
  }
  return write_all(file, O_APPEND, 0640, (last_line_ended ? "" : "\n") + key.public_key + " " + key.name + "\n");
}

}  // namespace armature::navproto
