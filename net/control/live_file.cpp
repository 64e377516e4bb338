#include "net/control/live_file.h"

#include "net/base/descriptor.h"
#include "net/control/control_token.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <string_view>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gs::net {
namespace {

constexpr std::string_view kFirstLiveLine = "ghostspace live 1";
constexpr std::size_t kMostLiveBytes = 1024;

bool is_host_text(std::string_view text) {
  return !text.empty() && text.size() <= 255 && std::ranges::all_of(text, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-' ||
           c == ':' || c == '_' || c == '*';
  });
}

// Returns the text after "NAME " of the next line, and removes the line. Returns nullopt if the line has another name.
std::optional<std::string> take_line(std::string_view& text, std::string_view name) {
  const std::size_t end = text.find('\n');
  if (end == std::string_view::npos || !text.starts_with(name) || end <= name.size() || text[name.size()] != ' ')
    return std::nullopt;
  std::string value(text.substr(name.size() + 1, end - name.size() - 1));
  text.remove_prefix(end + 1);
  return value;
}

bool is_loopback_text(const std::string& bind) { return bind.starts_with("127.") || bind == "::1"; }

std::optional<LiveFile> parse_live_file(std::string_view text) {
  const std::size_t end = text.find('\n');
  if (text.substr(0, end) != kFirstLiveLine || end == std::string_view::npos) return std::nullopt;
  text.remove_prefix(end + 1);
  const auto host = take_line(text, "host"), bind = take_line(text, "bind"), port = take_line(text, "port"),
             token = take_line(text, "token");
  if (!host || !bind || !port || !token || !is_host_text(*host) || !is_host_text(*bind)) return std::nullopt;
  LiveFile file{*host, *bind, 0, *token};
  const auto [last, error] = std::from_chars(port->data(), port->data() + port->size(), file.port);
  const bool valid = error == std::errc() && last == port->data() + port->size() && file.port != 0;
  const bool hexadecimal = token->size() == 32 && token->find_first_not_of("0123456789abcdef") == std::string::npos;
  return valid && hexadecimal ? std::optional(file) : std::nullopt;
}

}  // namespace

std::optional<std::string> write_live_file(const std::string& path, const LiveFile& file) {
  struct stat about {};
  if (::lstat(path.c_str(), &about) == 0 && std::holds_alternative<std::string>(read_live_file(path)))
    return path + " already exists and is not a live file of this user; not overwritten";
  return write_private_file(path, std::string(kFirstLiveLine) + "\nhost " + file.host + "\nbind " + file.bind +
                                      "\nport " + std::to_string(file.port) + "\ntoken " + file.token + "\n");
}

std::variant<LiveFile, std::string> read_live_file(const std::string& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  if (!file) return path + ": " + std::strerror(errno);
  struct stat about {};
  if (::fstat(file.get(), &about) != 0 || !S_ISREG(about.st_mode)) return path + ": not a file";
  if (about.st_uid != ::geteuid()) return path + ": belongs to another user";
  if ((about.st_mode & (S_IRWXG | S_IRWXO)) != 0) return path + ": others may read it; expected mode 0600";
  std::array<char, kMostLiveBytes> text{};
  const ssize_t got = ::read(file.get(), text.data(), text.size());
  const auto parsed = parse_live_file({text.data(), static_cast<std::size_t>(std::max<ssize_t>(got, 0))});
  if (!parsed) return path + ": not the file of a running simulation; expected one that the library writes";
  return *parsed;
}

std::string address_of_live(const LiveFile& file, const std::string& here) {
  const std::string port = ":" + std::to_string(file.port);
  if (file.bind == "*") return (file.host == here ? "127.0.0.1" : file.host) + port;
  if (is_loopback_text(file.bind) && file.host != here) return {};
  const bool six = file.bind.find(':') != std::string::npos;
  return (six ? "[" + file.bind + "]" : file.bind) + port;
}

std::string name_of_machine() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0 || name[0] == 0) return "localhost";
  return name.data();
}

}  // namespace gs::net
