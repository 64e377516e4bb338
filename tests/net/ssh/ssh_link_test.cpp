#include "net/ssh/ssh_link.h"
#include "tests/net/load_helpers.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <string>
#include <thread>

#include <poll.h>
#include <unistd.h>

namespace gs::net::ssh_link_test {
namespace {

using namespace std::chrono_literals;

/// Replacement of ssh: a shell program. Each start appends its arguments to the file "starts".
struct FakeSsh {
  test::TemporaryFolder folder;
  explicit FakeSsh(const std::string& commands) {
    std::ofstream(folder / "ssh") << "#!/bin/sh\necho \"$@\" >> " << (folder / "starts") << "\n" << commands << "\n";
    std::filesystem::permissions(folder / "ssh", std::filesystem::perms::owner_all);
  }
  [[nodiscard]] SshSettings settings() const {
    SshSettings settings;
    settings.program = folder / "ssh";
    return settings;
  }
  [[nodiscard]] int starts() const {
    std::ifstream file(folder / "starts");
    int count = 0;
    for (std::string line; std::getline(file, line);) ++count;
    return count;
  }
};

SshFailure failure_of(const SshLink& link) {
  for (int i = 0; i < 1000 && !link.failure(); ++i) std::this_thread::sleep_for(10ms);
  return link.failure().value_or(SshFailure{SshFailure::Kind::idle, "none"});
}

bool is_closed(const Descriptor& socket) {
  pollfd wait{socket.get(), POLLIN, 0};
  char one = 0;
  return ::poll(&wait, 1, 10'000) == 1 && ::read(socket.get(), &one, 1) <= 0;
}

const std::string kSftpServer = "/usr/lib/openssh/sftp-server";

}  // namespace

TEST_CASE("a link explains why ssh fails, and closes its connections") {
  using Kind = SshFailure::Kind;
  SECTION("no ssh") {
    SshSettings settings;
    settings.program = "/nonexistent/ssh";
    const SshLink link({{}, "host", {}}, settings, {});
    const SshFailure failure = failure_of(link);
    CHECK(failure.kind == Kind::unusable);
    CHECK(failure.message.find("is not installed; install it") != std::string::npos);
  }
  SECTION("login refused") {
    const FakeSsh ssh("sleep 0.2; echo 'host: Permission denied (publickey).' >&2; exit 255");
    SshLink link({{}, "host", {}}, ssh.settings(), {});
    const Descriptor socket = link.connect();
    REQUIRE(socket);
    CHECK(link.connecting());
    CHECK(is_closed(socket));
    CHECK(failure_of(link).kind == Kind::refused);
    CHECK_FALSE(link.connect());
    CHECK(ssh.starts() == 1);
  }
  SECTION("no program and no SFTP") {
    const FakeSsh ssh("echo 'sh: 1: exec: ghostspace: not found' >&2; exit 127");
    const SshLink link({"ann", "host", 22}, ssh.settings(), {});
    const SshFailure failure = failure_of(link);
    CHECK(failure.kind == Kind::unusable);
    INFO(failure.message);
    CHECK(failure.message.find("not installed there; install it with: ssh -p 22 ann@host mkdir -p .local/bin && scp "
                               "-P 22") != std::string::npos);
    CHECK(failure.message.find("SFTP does not work there") != std::string::npos);
    CHECK(ssh.starts() == 2);
  }
  SECTION("a program that fails") {
    const FakeSsh ssh("echo 'srun: error: no such partition' >&2; exit 3");
    SshSettings settings = ssh.settings();
    settings.remote_program = "srun -N1 ghostspace";
    const SshLink link({{}, "host", {}}, settings, {});
    CHECK(failure_of(link).message.find("srun -N1 ghostspace fails there with status 3: srun: error: no such "
                                        "partition") != std::string::npos);
  }
}

TEST_CASE("a link reads files by SFTP if GhostSpace is missing") {
  if (!std::filesystem::exists(kSftpServer)) {
    WARN(kSftpServer + " is not installed");
    return;
  }
  const FakeSsh ssh("case \"$*\" in *sftp) exec " + kSftpServer +
                    ";; *) echo 'ghostspace: not found' >&2; exit 127;; esac");
  std::ofstream(ssh.folder / "file.txt") << "contents";
  std::mutex mutex;
  std::string told;
  SshLink link({{}, "host", {}}, ssh.settings(), [&](const std::string& message) {
    const std::lock_guard lock(mutex);
    told += message + "\n";
  });
  const Descriptor socket = link.connect();
  const std::string request = "GET " + (ssh.folder / "file.txt") + " HTTP/1.1\r\n\r\n";
  REQUIRE(::write(socket.get(), request.data(), request.size()) == static_cast<ssize_t>(request.size()));
  std::string answer;
  for (int i = 0; i < 1000 && !answer.ends_with("contents"); ++i) {
    char block[4096];
    pollfd wait{socket.get(), POLLIN, 0};
    (void)::poll(&wait, 1, 100);
    if (const ssize_t got = ::read(socket.get(), block, sizeof block); got > 0)
      answer.append(block, static_cast<std::size_t>(got));
  }
  CHECK(answer.starts_with("HTTP/1.1 200 OK\r\n"));
  CHECK(answer.ends_with("\r\n\r\ncontents"));
  const std::lock_guard lock(mutex);
  CHECK(told.find("ssh://host: GhostSpace is not installed there") == 0);
  CHECK(told.find("read by SFTP") != std::string::npos);
}

TEST_CASE("links are shared, and a refused account is not asked again at once") {
  SshLinks links;
  const FakeSsh refuses("echo 'Permission denied' >&2; exit 255");
  const auto first = links.find({{}, "host", {}}, refuses.settings(), {});
  CHECK(links.find({{}, "host", {}}, refuses.settings(), {}) == first);
  CHECK(failure_of(*first).kind == SshFailure::Kind::refused);
  CHECK(links.find({{}, "host", {}}, refuses.settings(), {}) == first);
  CHECK(refuses.starts() == 1);
  const FakeSsh breaks("exit 255");
  const auto second = links.find({{}, "other", {}}, breaks.settings(), {});
  (void)failure_of(*second);
  CHECK(links.find({{}, "other", {}}, breaks.settings(), {}) != second);
  links.end_all();
}

TEST_CASE("the end of a link ends a program that ignores its input") {
  const FakeSsh ssh("trap '' TERM; echo $$ > \"$(dirname \"$0\")/pid\"; while :; do sleep 0.1; done");
  const auto begin = std::chrono::steady_clock::now();
  {
    const SshLink link({{}, "host", {}}, ssh.settings(), {});
    while (!std::filesystem::exists(ssh.folder / "pid")) std::this_thread::sleep_for(10ms);
    std::this_thread::sleep_for(100ms);
  }
  CHECK(std::chrono::steady_clock::now() - begin < 20s);
  pid_t pid = 0;
  std::ifstream(ssh.folder / "pid") >> pid;
  REQUIRE(pid > 0);
  CHECK(::kill(pid, 0) != 0);
}

}  // namespace gs::net::ssh_link_test
