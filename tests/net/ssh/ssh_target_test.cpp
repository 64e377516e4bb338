#include "net/ssh/ssh_target.h"
#include "net/ssh/ssh_failures.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <string>

namespace gs::net::ssh_target_test {
namespace {

SshTarget target(const std::string& url) {
  auto made = ssh_target_of(parse_url(url));
  if (const auto* why = std::get_if<std::string>(&made)) FAIL(*why);
  return std::get<SshTarget>(made);
}
bool refused(const std::string& url) { return std::holds_alternative<std::string>(ssh_target_of(parse_url(url))); }

using Words = std::vector<std::string>;
const Words kAlways{"-T", "-x", "-a", "-o", "ClearAllForwardings=yes", "-o", "RemoteCommand=none"};

Words with(Words more) {
  more.insert(more.begin(), kAlways.begin(), kAlways.end());
  return more;
}

}  // namespace

TEST_CASE("ssh: URLs name an account, and nothing that ssh could take for an option") {
  CHECK(target("ssh://cluster/data").text() == "cluster");
  CHECK(target("ssh://ann@Login1.example.org:2222/a").text() == "ann@Login1.example.org:2222");
  CHECK(target("ssh://[fe80::1%25eth0]:22/a").host == "fe80::1%25eth0");
  CHECK(target("ssh://[::1]/a").text() == "[::1]");
  for (const char* bad :
       {"ssh:///a", "ssh://-oProxyCommand=x/a", "ssh://-l@host/a", "ssh://a b/", "ssh://host:0/", "ssh://host:99999/",
        "ssh://user:word@host/", "ssh://us;er@host/", "ssh://$(id)@host/", "ssh://ho`st/", "ssh://ho'st/",
        "ssh://@host/", "ssh://a@b@host/", "ssh://host%00/", "ssh://h\n/", "ssh:host"})
    CHECK((refused(bad) || std::string(bad) == "ssh://host%00/"));
  CHECK(refused("ssh://" + std::string(300, 'a') + "/"));
}

TEST_CASE("ssh gets the account as separate arguments") {
  const SshTarget ann = target("ssh://ann@host:2222/x");
  CHECK(ssh_arguments(ann, "run it", false) == with({"-p", "2222", "-l", "ann", "--", "host", "run it"}));
  CHECK(ssh_arguments(target("ssh://host/"), {}, true) == with({"-o", "BatchMode=yes", "-s", "--", "host", "sftp"}));
}

TEST_CASE("the remote command is one word for any shell, which splits the given program") {
  CHECK(remote_serve_command("ghostspace") ==
        "exec sh -c 'PATH=\"$PATH:$HOME/.local/bin\"; export PATH; exec ghostspace serve --stdio'");
  CHECK(remote_serve_command("srun -N1 '/a b/ghostspace'") ==
        "exec sh -c 'PATH=\"$PATH:$HOME/.local/bin\"; export PATH; exec srun -N1 '\\''/a b/ghostspace'\\'' serve "
        "--stdio'");
  CHECK_FALSE(refuse_remote_program("srun -N1 ghostspace"));
  CHECK(refuse_remote_program(""));
  CHECK(refuse_remote_program("a\nb"));
  CHECK(refuse_remote_program(std::string(2000, 'a')));
}

TEST_CASE("messages of ssh become one line each") {
  using Kind = SshFailure::Kind;
  const auto of = [](const std::string& text, std::optional<int> status = 255) {
    return explain_ssh(text, status, "ann@host");
  };
  const auto check = [&of](const std::string& text, Kind kind, const std::string& part) {
    const SshFailure failure = of(text);
    CHECK(failure.kind == kind);
    INFO(failure.message);
    CHECK(failure.message.find(part) != std::string::npos);
    CHECK(failure.message.find('\n') == std::string::npos);
  };
  check("@@@\n@ WARNING: REMOTE HOST IDENTIFICATION HAS CHANGED! @\n@@@\nHost key verification failed.\r\n",
        Kind::refused, "has changed");
  check(
      "No ED25519 host key is known for host and you have requested strict checking.\r\nHost key verification failed.",
      Kind::refused, "run 'ssh ann@host' once");
  check("ann@host: Permission denied (publickey).\r\n", Kind::refused, "refuses the login");
  check("ssh: Could not resolve hostname host: Name or service not known\r\n", Kind::unreachable, "no host");
  check("ssh: connect to host host port 22: No route to host\r\n", Kind::unreachable, "no route");
  check("ssh: connect to host host port 22: Connection refused\r\n", Kind::unreachable, "refused");
  check("ssh: connect to host host port 22: Connection timed out\r\n", Kind::unreachable, "does not answer");
  check("Connection closed by 10.0.0.1 port 22\r\n", Kind::broken, "closed");
  check("strange\x1b[31m words\n\n", Kind::broken, "ssh reports: strange [31m words");
  check("", Kind::broken, "interrupted");
  CHECK(of("", std::nullopt).message == "ssh was ended by a signal");
  CHECK(last_line_of("a\nb\n \n") == "b");
  CHECK(last_line_of("").empty());
  CHECK(clean_line(std::string(500, 'x')).size() == 203);
}

}  // namespace gs::net::ssh_target_test
