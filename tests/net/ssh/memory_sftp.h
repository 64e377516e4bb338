#pragma once

#include "net/base/network_bytes.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::net::test {

/// SFTP server in memory. Files by path; folders end with a slash. Relative paths begin at /home/user.
class MemorySftp {
 public:
  std::map<std::string, std::string> files;
  std::map<std::string, std::string> links;  // paths that realpath replaces
  std::uint32_t most = 1 << 20;              // bytes per read, to test short answers
  std::vector<int> asked;                    // types of the requests
  std::vector<std::byte> out;

  void receive(std::span<const std::byte> bytes) {
    in_.insert(in_.end(), bytes.begin(), bytes.end());
    while (in_.size() >= 4) {
      const auto size = NetworkReader(in_).integer<std::uint32_t>();
      if (in_.size() < 4 + size) return;
      const std::vector<std::byte> packet(in_.begin() + 4, in_.begin() + 4 + size);
      in_.erase(in_.begin(), in_.begin() + 4 + size);
      answer(packet);
    }
  }

 private:
  static std::string text(NetworkReader& reader) {
    const auto bytes = reader.bytes(reader.integer<std::uint32_t>());
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  static void put(NetworkWriter& writer, std::string_view text) {
    writer.integer(static_cast<std::uint32_t>(text.size()));
    writer.bytes(std::as_bytes(std::span(text)));
  }
  template <class Fill>
  void packet(std::uint8_t type, std::uint32_t id, const Fill& fill) {
    std::vector<std::byte> body;
    NetworkWriter writer(body);
    writer.integer(type);
    writer.integer(id);
    fill(writer);
    NetworkWriter whole(out);
    whole.integer(static_cast<std::uint32_t>(body.size()));
    whole.bytes(body);
  }
  void status(std::uint32_t id, std::uint32_t code) {
    packet(101, id, [&](NetworkWriter& writer) {
      writer.integer(code);
      put(writer, "text");
      put(writer, "en");
    });
  }
  void attributes(NetworkWriter& writer, const std::string& path) const {
    const bool folder = path.ends_with('/');
    writer.integer(std::uint32_t{1 | 4 | 8});
    writer.integer(static_cast<std::uint64_t>(folder ? 0 : files.at(path).size()));
    writer.integer(std::uint32_t{folder ? 0040755U : 0100644U});
    writer.integer(std::uint32_t{5});
    writer.integer(std::uint32_t{784111777});
  }
  [[nodiscard]] std::string found(std::string path) const {
    if (path == ".") path = "/home/user";
    if (!path.starts_with('/')) path = "/home/user/" + path;
    if (const auto link = links.find(path); link != links.end()) path = link->second;
    if (files.contains(path)) return path;
    return files.contains(path + "/") ? path + "/" : std::string();
  }
  void answer(const std::vector<std::byte>& bytes) {
    NetworkReader reader(bytes);
    const auto type = reader.integer<std::uint8_t>();
    const auto id = reader.integer<std::uint32_t>();
    asked.push_back(type);
    if (type == 1) return packet(2, 3, [](NetworkWriter&) {});
    const std::string name = text(reader);
    if (type == 5) {
      const auto offset = reader.integer<std::uint64_t>();
      const auto size = std::min(reader.integer<std::uint32_t>(), most);
      const std::string& content = files[name];
      if (offset >= content.size()) return status(id, 1);
      return packet(103, id, [&](NetworkWriter& writer) { put(writer, content.substr(offset, size)); });
    }
    if (type == 4) return status(id, 0);
    const std::string path = type == 8 || type == 12 ? name : found(name);
    if (path.empty()) return status(id, 2);
    if (path.find("secret") != std::string::npos) return status(id, 3);
    if (type == 17 || type == 8) return packet(105, id, [&](NetworkWriter& writer) { attributes(writer, path); });
    if (type == 3 || type == 11) {
      listed_ = false;
      return packet(102, id, [&](NetworkWriter& writer) { put(writer, path); });
    }
    if (type == 16)
      return packet(104, id, [&](NetworkWriter& writer) {
        writer.integer(std::uint32_t{1});
        put(writer, path.size() > 1 && path.ends_with('/') ? path.substr(0, path.size() - 1) : path);
        put(writer, "");
        writer.integer(std::uint32_t{0});
      });
    if (std::exchange(listed_, true)) return status(id, 1);
    std::vector<std::string> inside;
    for (const auto& [one, content] : files)
      if (one.starts_with(path) && one.size() > path.size()) inside.push_back(one);
    packet(104, id, [&](NetworkWriter& writer) {
      writer.integer(static_cast<std::uint32_t>(inside.size()));
      for (const std::string& one : inside) {
        std::string short_name = one.substr(path.size());
        if (short_name.ends_with('/')) short_name.pop_back();
        put(writer, short_name);
        put(writer, "-rw-r--r-- " + one);
        attributes(writer, one);
      }
    });
  }

  std::vector<std::byte> in_;
  bool listed_ = false;
};

}  // namespace gs::net::test
