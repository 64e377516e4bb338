#include "net/ssh/ssh_failures.h"

#include <algorithm>
#include <array>

namespace gs::net {
namespace {

constexpr std::size_t kLongestLine = 200;

/// Message of ssh, and its explanation. `{}` is the target. The first row that fits counts.
struct Row {
  std::string_view part;
  SshFailure::Kind kind;
  std::string_view explanation;
};
using Kind = SshFailure::Kind;
constexpr std::array kRows{
    Row{"REMOTE HOST IDENTIFICATION HAS CHANGED", Kind::refused,
        "the host key of {} has changed; if that is expected, run 'ssh {}' in a terminal for the remedy"},
    Row{"Host key verification failed", Kind::refused,
        "the host key of {} is unknown; run 'ssh {}' once in a terminal to accept it"},
    Row{"Too many authentication failures", Kind::refused,
        "{} refuses the login after too many keys; name one key in ~/.ssh/config (IdentityFile, IdentitiesOnly)"},
    Row{"Permission denied", Kind::refused,
        "{} refuses the login; run 'ssh {}' in a terminal, or add a key to the agent (ssh-add)"},
    Row{"Could not resolve hostname", Kind::unreachable, "there is no host of this name"},
    Row{"No route to host", Kind::unreachable, "there is no route to the host"},
    Row{"Network is unreachable", Kind::unreachable, "the network of the host cannot be reached"},
    Row{"Connection refused", Kind::unreachable, "no ssh server answers there (connection refused)"},
    Row{"timed out", Kind::unreachable, "the host does not answer"},
    Row{"Bad configuration option", Kind::unusable, "ssh rejects its configuration: {line}"},
    Row{"Connection closed", Kind::broken, "the host has closed the connection"},
    Row{"Connection reset", Kind::broken, "the connection was reset"},
    Row{"Broken pipe", Kind::broken, "the connection was interrupted"},
};

std::string filled(std::string_view pattern, const std::string& target, const std::string& line) {
  std::string text(pattern);
  const auto fill = [&text](std::string_view mark, const std::string& by) {
    for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos; at += by.size())
      text.replace(at, mark.size(), by);
  };
  fill("{}", target);
  fill("{line}", line);
  return text;
}

}  // namespace

std::string clean_line(std::string_view line) {
  std::string text(line.substr(0, kLongestLine));
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  text.erase(text.find_last_not_of(' ') + 1);
  text.erase(0, std::min(text.find_first_not_of(' '), text.size()));
  return line.size() > kLongestLine ? text + "..." : text;
}

std::string last_line_of(std::string_view text) {
  while (!text.empty()) {
    const std::size_t begin = text.rfind('\n') + 1;  // 0 if there is no line end
    if (std::string line = clean_line(text.substr(begin)); !line.empty()) return line;
    text = text.substr(0, begin > 0 ? begin - 1 : 0);
  }
  return {};
}

SshFailure explain_ssh(std::string_view errors, std::optional<int> status, const std::string& target) {
  const std::string line = last_line_of(errors);
  for (const Row& row : kRows)
    if (errors.find(row.part) != std::string_view::npos) return {row.kind, filled(row.explanation, target, line)};
  if (!status) return {Kind::broken, "ssh was ended by a signal"};
  return {Kind::broken, line.empty() ? "the connection was interrupted" : "ssh reports: " + line};
}

}  // namespace gs::net
