#include "net/ssh/ssh_target.h"

#include "net/base/descriptor.h"

#include <algorithm>
#include <cstdlib>

#include <fcntl.h>

namespace gs::net {
namespace {

constexpr std::size_t kLongestName = 255, kLongestProgram = 1000;

bool is_name(std::string_view text, std::string_view more) {
  if (text.empty() || text.size() > kLongestName || text.front() == '-') return false;
  return std::all_of(text.begin(), text.end(), [more](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           more.find(c) != std::string_view::npos;
  });
}

std::string within_quotes(std::string_view text) {
  std::string quoted;
  for (const char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return "'" + quoted + "'";
}

bool is_set(const char* name) {
  const char* const value = std::getenv(name);
  return value && *value != '\0';
}

}  // namespace

std::string SshTarget::text() const {
  std::string result = user.empty() ? std::string() : user + "@";
  result += host.find(':') == std::string::npos ? host : "[" + host + "]";
  return port ? result + ":" + std::to_string(*port) : result;
}

std::variant<SshTarget, std::string> ssh_target_of(const Url& url) {
  const auto place = host_and_port(url.authority);
  if (!place) return "it has no host or an invalid port; expected ssh://USER@HOST:PORT/PATH";
  SshTarget target{{}, place->host, place->port};
  if (const std::size_t at = url.authority.rfind('@'); at != std::string::npos) {
    target.user = url.authority.substr(0, at);
    if (target.user.find(':') != std::string::npos)
      return "it has a password; expected ssh://USER@HOST/PATH, because only ssh asks for passwords";
    if (!is_name(target.user, "._-+"))
      return "its user name is invalid; expected letters, digits, '.', '_', '-' or '+'";
  }
  if (!is_name(target.host, "._-:%")) return "its host name is invalid; expected letters, digits, '.', '_' or '-'";
  return target;
}

std::optional<std::string> refuse_remote_program(std::string_view program) {
  if (program.empty() || program.size() > kLongestProgram)
    return "expected 1 to " + std::to_string(kLongestProgram) + " characters, as in \"srun -N1 ghostspace\"";
  const bool control = std::any_of(program.begin(), program.end(),
                                   [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
  return control ? std::optional<std::string>("control characters are not allowed") : std::nullopt;
}

std::string remote_serve_command(std::string_view program) {
  // Programs in the home folder are often in the path of login shells only.
  return "exec sh -c " +
         within_quotes("PATH=\"$PATH:$HOME/.local/bin\"; export PATH; exec " + std::string(program) + " serve --stdio");
}

std::vector<std::string> ssh_arguments(const SshTarget& target, const std::string& command, bool batch) {
  // No terminal, no windows, no forwarded ports, and no command of the configuration.
  std::vector<std::string> arguments{"-T", "-x", "-a", "-o", "ClearAllForwardings=yes", "-o", "RemoteCommand=none"};
  if (batch) arguments.insert(arguments.end(), {"-o", "BatchMode=yes"});
  if (target.port) arguments.insert(arguments.end(), {"-p", std::to_string(*target.port)});
  if (!target.user.empty()) arguments.insert(arguments.end(), {"-l", target.user});
  if (command.empty()) arguments.emplace_back("-s");
  arguments.insert(arguments.end(), {"--", target.host, command.empty() ? "sftp" : command});
  return arguments;
}

bool ssh_cannot_ask() {
  const Descriptor terminal(::open("/dev/tty", O_RDWR | O_NOCTTY | O_CLOEXEC));
  return !terminal && !is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY") && !is_set("SSH_ASKPASS");
}

}  // namespace gs::net
