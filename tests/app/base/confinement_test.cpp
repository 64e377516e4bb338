// Tests of the rights of a confined process. Each attempt is made in its own process.
#include "app/base/confinement.h"
#include "app/base/environment.h"

#include "app/base/exit_status.h"
#include "app/serve/child_program.h"
#include "net/files/file.h"
#include "tests/app/program.h"
#include "tests/app/run_program.h"
#include "tests/app/scratch_folder.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <thread>

using namespace gs;
using namespace gs::app;

namespace {

// Reports whether a function succeeds in a confined process.
bool succeeds_confined(const Confinement& confinement, const std::function<bool()>& attempt) {
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    constexpr int kNotConfined = 3;
    if (confine(confinement)) ::_exit(kNotConfined);
    ::_exit(attempt() ? 0 : 1);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  INFO("status " << status);
  REQUIRE(WIFEXITED(status));
  REQUIRE((WEXITSTATUS(status) == 0 || WEXITSTATUS(status) == 1));
  return WEXITSTATUS(status) == 0;
}

bool file_opens(const std::string& path, int flags) {
  const int file = ::open(path.c_str(), flags | O_CLOEXEC, 0600);
  if (file >= 0) ::close(file);
  return file >= 0;
}

bool calls(long number, long a = 0, long b = 0, long c = 0, long d = 0) {
  return ::syscall(number, a, b, c, d, 0L, 0L) >= 0;
}

std::string file_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Returns true if `environment` has a variable that confinement must remove.
bool has_other_variables(const std::string& environment) {
  for (std::size_t at = 0; at < environment.size();) {
    const std::size_t end = std::min(environment.find('\0', at), environment.size());
    const std::string entry = environment.substr(at, end - at);
    if (!entry.empty() && !is_kept_variable(entry.substr(0, entry.find('=')))) return true;
    at = end + 1;
  }
  return false;
}

const std::string kConfinedWorld = "#VRML V2.0 utf8\nShape { geometry Box { } }\n";

}  // namespace

TEST_CASE("reads files of the folder, writes files of OUT's folder, and no others, when confined") {
  if (confinement_support().landlock == 0) {
    WARN("skipped: this kernel has no Landlock");
    return;
  }
  const ScratchFolder scratch;
  scratch.write("in/deep/a.wrl", "inside");
  scratch.write("out/old", "old");
  scratch.write("secret", "secret");
  std::filesystem::create_symlink("../secret", scratch.path("in/link"));
  const Confinement both{scratch.path("in"), scratch.path("out")};
  const auto can_open = [&](const std::string& name, int flags) {
    const std::string path = name.starts_with('/') ? name : scratch.path(name);
    return succeeds_confined(both, [&] { return file_opens(path, flags); });
  };
  CHECK(can_open("in/deep/a.wrl", O_RDONLY));
  CHECK(can_open("in", O_RDONLY | O_DIRECTORY));
  const std::pair<std::string, int> refused[] = {
      {"in/deep/a.wrl", O_WRONLY},
      {"in/deep/a.wrl", O_RDWR},
      {"in/deep/a.wrl", O_RDONLY | O_TRUNC},
      {"in/new", O_WRONLY | O_CREAT},
      {"in/link", O_RDONLY},
      {"secret", O_RDONLY},
      {"in/../secret", O_RDONLY},
      {"new", O_WRONLY | O_CREAT},
      {"", O_RDONLY | O_DIRECTORY},
      {"/etc/passwd", O_RDONLY},
      {"/etc/hosts", O_RDONLY},
      {"/root", O_RDONLY | O_DIRECTORY},
      {"/tmp", O_RDONLY | O_DIRECTORY},
      {"/proc/1/environ", O_RDONLY},
      {"/proc/" + std::to_string(::getpid()) + "/environ", O_RDONLY},
      {"/dev/tty", O_RDWR},
      {"/usr/bin/new", O_WRONLY | O_CREAT},
  };
  for (const auto& [name, flags] : refused) {
    INFO(name << " with flags " << flags);
    CHECK_FALSE(can_open(name, flags));
  }
  CHECK(can_open("/usr/bin/env", O_RDONLY));
  CHECK(can_open("/dev/null", O_RDWR));
  CHECK(can_open("out/new", O_RDWR | O_CREAT | O_TRUNC));
  CHECK(can_open("out/old", O_RDWR));
  CHECK(succeeds_confined(both, [&] {
    const std::string text = "as a whole";
    return !net::write_file_atomically(scratch.path("out/whole"), std::as_bytes(std::span(text))) &&
           ::unlink(scratch.path("out/old").c_str()) == 0;
  }));
  CHECK(scratch.read("out/whole") == "as a whole");
  const auto fails = [&](const std::function<int()>& call) {
    return !succeeds_confined(both, [&] { return call() == 0; });
  };
  const std::string in = scratch.path("in/deep/a.wrl"), out = scratch.path("out/new");
  CHECK(fails([&] { return ::rename(out.c_str(), scratch.path("elsewhere").c_str()); }));
  CHECK(fails([&] { return ::rename(in.c_str(), scratch.path("out/moved").c_str()); }));
  CHECK(fails([&] { return ::link(in.c_str(), scratch.path("out/linked").c_str()); }));
  CHECK(fails([&] { return ::symlink("/etc", scratch.path("out/etc").c_str()); }));
  CHECK(fails([&] { return ::mkdir(scratch.path("out/folder").c_str(), 0700); }));
  CHECK(fails([&] { return ::mkfifo(scratch.path("out/pipe").c_str(), 0600); }));
  CHECK(fails([&] { return ::unlink(in.c_str()); }));
  CHECK(fails([&] { return ::rmdir(scratch.path("in/deep").c_str()); }));
  CHECK(fails([&] { return ::truncate(in.c_str(), 0); }));
  CHECK(fails([&] { return ::chmod(in.c_str(), 0); }));
  CHECK(fails([&] { return ::chmod(scratch.path("secret").c_str(), 0777); }));
  CHECK(fails([&] { return ::utimensat(AT_FDCWD, in.c_str(), nullptr, 0); }));
  CHECK(scratch.read("in/deep/a.wrl") == "inside");
  // Without a folder for the result, no file can be written.
  CHECK_FALSE(succeeds_confined({scratch.path("in"), ""}, [&] { return file_opens(out, O_WRONLY); }));
  CHECK(confine({scratch.path("nothing"), ""}).has_value());
}

TEST_CASE("denies sockets, other processes and changes of the machine to a confined process") {
  if (!confinement_support().seccomp) {
    WARN("skipped: this kernel has no seccomp");
    return;
  }
  const ScratchFolder scratch;
  const Confinement here{scratch.path(""), scratch.path("")};
  const auto can = [&](const std::function<bool()>& attempt) { return succeeds_confined(here, attempt); };
  for (const int family : {AF_INET, AF_INET6, AF_UNIX, AF_NETLINK, AF_PACKET, AF_VSOCK, AF_BLUETOOTH, AF_ALG})
    for (const int type : {SOCK_STREAM, SOCK_DGRAM, SOCK_RAW})
      CHECK_FALSE(can([&] { return ::socket(family, type, 0) >= 0 || errno != EPERM; }));
  // A socket that was opened before cannot connect either.
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  REQUIRE(socket >= 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(9);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const auto* to = reinterpret_cast<const sockaddr*>(&address);
  CHECK_FALSE(can([&] { return ::connect(socket, to, sizeof address) == 0; }));
  CHECK_FALSE(can([&] { return ::bind(socket, to, sizeof address) == 0; }));
  CHECK_FALSE(can([&] { return ::sendto(socket, "x", 1, 0, to, sizeof address) == 1; }));
  ::close(socket);
  int pair[2];
  CHECK_FALSE(can([&] { return ::socketpair(AF_UNIX, SOCK_STREAM, 0, pair) == 0; }));
  char program[] = "/bin/true";
  char* const arguments[] = {program, nullptr};
  CHECK_FALSE(can([&] { return ::execv(program, arguments) == 0; }));
  CHECK_FALSE(can([] {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(0);
    return child > 0;
  }));
  CHECK_FALSE(can([] { return std::system("true") == 0; }));
  const pid_t parent = ::getpid();
  CHECK_FALSE(can([&] { return ::kill(parent, 0) == 0; }));
  CHECK(can([] { return ::kill(::getpid(), 0) == 0; }));
  CHECK_FALSE(can([&] { return calls(SYS_pidfd_open, parent); }));
  CHECK_FALSE(can([&] { return calls(SYS_ptrace, 16, parent); }));
  char page[256];
  CHECK_FALSE(can([&] { return calls(SYS_io_uring_setup, 1, reinterpret_cast<long>(page)) || errno != EPERM; }));
  CHECK_FALSE(can([] { return calls(SYS_unshare, 0) || errno != EPERM; }));
  CHECK_FALSE(can([] { return calls(SYS_memfd_create, reinterpret_cast<long>("x")); }));
  CHECK_FALSE(can(
      [] { return ::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0) != MAP_FAILED; }));
  CHECK_FALSE(can([] {
    rlimit limit{};
    return ::getrlimit(RLIMIT_CORE, &limit) == 0 && ::setrlimit(RLIMIT_CORE, &limit) == 0;
  }));
  // A confined process can allocate memory, start threads and read its limits.
  CHECK(can([] {
    rlimit limit{};
    int sum = 0;
    std::thread([&sum] { sum = 1; }).join();
    void* const memory = ::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return memory != MAP_FAILED && sum == 1 && ::getrlimit(RLIMIT_CORE, &limit) == 0;
  }));
#ifdef __x86_64__
  // Calls by the numbers of other architectures are refused or end the process.
  CHECK_FALSE(can([] { return calls(0x40000000 + SYS_getpid) || errno != EPERM; }));
#endif
}

TEST_CASE("hides the environment from a confined process") {
  // Restores the environment of this process at the end.
  char secret[] = "GHOSTSPACE_TEST_SECRET=hunter2", language[] = "LANG=C.UTF-8";
  char* entries[] = {secret, language, nullptr};
  char** const own = environ;
  const ScratchFolder scratch;
  const Confinement here{scratch.path(""), scratch.path("")};
  environ = entries;
  const bool hidden = succeeds_confined(here, [&] {
    const std::string left(secret, sizeof secret);
    return !std::getenv("GHOSTSPACE_TEST_SECRET") && left.find_first_not_of('\0') == std::string::npos &&
           std::string(std::getenv("LANG")) == "C.UTF-8";
  });
  environ = own;
  CHECK(hidden);
  CHECK(std::string(secret).ends_with("hunter2"));
  // Linux shows the initial environment of a process. A test runner passes HOME or PWD.
  const std::string before = file_text("/proc/self/environ");
  REQUIRE(has_other_variables(before));
  CHECK(succeeds_confined(here, [] { return !has_other_variables(file_text("/proc/self/environ")); }));
}

TEST_CASE("passes only kept variables to a child") {
  ::setenv("GHOSTSPACE_TEST_SECRET", "hunter2", 1);
  ::setenv("LC_GHOSTSPACE_TEST", "kept", 1);
  std::stop_source stop;
  const auto shown =
      run_child("/bin/sh", {"-c", "tr '\\000' ' ' </proc/self/environ >&2; exit 1"}, {}, stop.get_token());
  ::unsetenv("GHOSTSPACE_TEST_SECRET");
  ::unsetenv("LC_GHOSTSPACE_TEST");
  REQUIRE(shown);
  INFO(shown->message);
  CHECK(shown->message.find("LC_GHOSTSPACE_TEST=kept") != std::string::npos);
  for (const char* name : {"GHOSTSPACE_TEST_SECRET", "hunter2", "HOME="})
    CHECK(shown->message.find(name) == std::string::npos);
  CHECK(is_kept_variable("TZ"));
  for (const char* name : {"http_proxy", "AWS_SECRET_ACCESS_KEY", "SSH_AUTH_SOCK", "LD_PRELOAD", "PATHS", "", "LC"})
    CHECK_FALSE(is_kept_variable(name));
}

TEST_CASE("runs commands under --confine without reading or writing anything else") {
  const ScratchFolder scratch;
  scratch.write("in/box.wrl", kConfinedWorld + "Inline { url \"part/inner.wrl\" }\n");
  scratch.write("in/part/inner.wrl", "#VRML V2.0 utf8\nTransform { children Shape { geometry Sphere { } } }\n");
  const std::string beyond = scratch.write("beyond.wrl", kConfinedWorld), in = scratch.path("in"),
                    box = quoted(scratch.path("in/box.wrl"));
  std::filesystem::create_directory(scratch.path("out"));
  const std::string confined = "--confine " + quoted(in) + " ";
  const Run picture =
      run(confined + "--size 64x48 --samples 1 --snapshot " + quoted(scratch.path("out/o.png")) + " " + box);
  INFO(picture.output);
  CHECK(picture.status == kDone);
  CHECK(picture.output.empty());
  CHECK(scratch.read("out/o.png").starts_with("\x89PNG"));
  const Run encoded = run("encode " + confined + "--vectors 2000 " + box + " " + quoted(scratch.path("out/o.qnv")));
  INFO(encoded.output);
  CHECK(encoded.status == kDone);
  CHECK(scratch.read("out/o.qnv").size() > 1000);
  CHECK(run("check " + confined + box).status == kDone);
  CHECK(run("info " + confined + box).output.find("triangles") != std::string::npos);
  const Run window = run(confined + box);
  CHECK(window.status == kUsage);
  CHECK(run("check --confine '' " + box).status == kUsage);
  if (confinement_support().landlock == 0) {
    WARN("skipped: this kernel has no Landlock");
    return;
  }
  const Run outside = run("check " + confined + quoted(beyond));
  CHECK(outside.status == kFailed);
  CHECK(outside.output.find("Permission denied") != std::string::npos);
  CHECK(run("check --confine " + quoted(scratch.path("none")) + " " + box).status == kFailed);
}

TEST_CASE("limits the memory and file size of a child, and passes it no descriptors") {
  if (watched()) return;  // AddressSanitizer reserves terabytes of addresses
  const ScratchFolder scratch;
  std::stop_source stop;
  ChildLimits limits;
  limits.memory = std::uint64_t{64} << 20;
  const auto memory = run_child("/bin/sh", {"-c", "ulimit -d >&2; exit 1"}, limits, stop.get_token());
  REQUIRE(memory);
  CHECK(memory->message == "65536");
  CHECK(memory->lasting);
  const int open = ::open("/etc/passwd", O_RDONLY);  // without O_CLOEXEC
  REQUIRE(open >= 0);
  const auto descriptors = run_child("/bin/sh", {"-c", "echo /proc/self/fd/* >&2; exit 1"}, {}, stop.get_token());
  ::close(open);
  REQUIRE(descriptors);
  // The three descriptors of the shell, and the descriptor that reads the folder.
  CHECK(descriptors->message.find("/proc/self/fd/4") == std::string::npos);
  const std::string world = scratch.write("box.wrl", kConfinedWorld);
  limits = {};
  limits.file_bytes = 100;
  const auto full = run_child(program(), {"encode", world, scratch.path("o.qnv")}, limits, stop.get_token());
  REQUIRE(full);
  CHECK_FALSE(full->lasting);
  CHECK_FALSE(run_child("/nowhere", {}, {}, stop.get_token())->lasting);
  CHECK(run_child("/bin/sh", {"-c", "kill -SEGV $$"}, {}, stop.get_token())->lasting);
  CHECK_FALSE(run_child("/bin/sh", {"-c", "kill -KILL $$"}, {}, stop.get_token())->lasting);
}
