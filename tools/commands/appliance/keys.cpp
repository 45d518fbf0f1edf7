#include <cstdio>
#include <memory>

#include <armature/navproto/keys.h>

#include "tools/commands/appliance/appliance.h"
#include "tools/json_lines.h"

namespace armature::tools {
namespace {

struct KeyOptions {
  std::string file, key, name;
  bool json = false;
};

Expected<void> make(const KeyOptions& options) {
  const auto keys = navproto::make_key_pair();
  if (!keys) return fail(keys.error().message);
  if (const auto written = navproto::write_key_pair(options.file, *keys); !written)
    return fail(written.error().message);
  if (options.json) return write_json_line(stdout, {{"file", options.file}, {"public", keys->public_key}});
  std::printf("%s\n", keys->public_key.c_str());
  return {};
}

Expected<void> allow(const KeyOptions& options) {
  const auto added = navproto::allow_key(options.file, {options.key, options.name});
  if (!added) return fail(added.error().message);
  if (options.json) return write_json_line(stdout, {{"file", options.file}, {"allowed", options.key}});
  std::puts("listed; a daemon that runs lets it in after `systemctl restart armatured`");
  return {};
}

Expected<void> list(const KeyOptions& options) {
  const auto keys = navproto::read_allow_list(options.file);
  if (!keys) return fail(keys.error().message);
  for (const navproto::AllowedKey& key : *keys) {
    if (options.json) {
      auto written = write_json_line(stdout, {{"public", key.public_key}, {"name", key.name}});
      if (!written) return written;
    } else {
      std::printf("%s  %s\n", key.public_key.c_str(), key.name.c_str());
    }
  }
  return {};
}

}  // namespace

void add_keys(CLI::App& app, Run& run) {
  CLI::App* keys =
      app.add_subcommand("keys", "Who may listen over a network: CURVE keys and the list of those allowed");
  keys->require_subcommand(1);
  keys->footer(
      "A publisher over tcp has keys and a list; a subscriber has keys, and knows the publisher's public key. The\n"
      "daemon reads both when it starts: publish.keys and publish.allow in its configuration, then `systemctl restart\n"
      "armatured`.\n\n"
      "Example:\n"
      "  armature keys new /etc/armature/kiosk.key          # on the kiosk: prints its public key\n"
      "  armature keys new wall.key                         # on the wall\n"
      "  armature keys allow /etc/armature/allow 'KEY' wall # on the kiosk: the wall's public key\n"
      "  armature listen tcp://kiosk:5555 --keys wall.key --server 'KEY'");
  auto options = std::make_shared<KeyOptions>();
  const auto verb = [&](const char* name, const char* what, Expected<void> (*act)(const KeyOptions&)) {
    CLI::App* command = keys->add_subcommand(name, what);
    command->add_option("FILE", options->file, "The file")->required();
    command->add_flag("--json", options->json, "One JSON object a line");
    command->callback([options, act, &run] { run = [options, act] { return act(*options); }; });
    return command;
  };
  verb("new", "Make a key pair in FILE (mode 0600) and print its public key", make);
  CLI::App* add = verb("allow", "Add a public key to the list in FILE", allow);
  add->add_option("KEY", options->key, "Its public key, 40 characters")->required();
  add->add_option("NAME", options->name, "Whose it is")->required();
  verb("list", "Print the list in FILE", list);
}

}  // namespace armature::tools
