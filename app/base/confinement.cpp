#include "app/base/confinement.h"

#include "app/base/environment.h"
#include "app/base/system_calls.h"
#include "net/base/descriptor.h"

#include <fcntl.h>
#include <linux/landlock.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <system_error>

namespace gs::app {
namespace {

// Landlock access rights that the headers of Debian 12 lack (linux/landlock.h).
constexpr std::uint64_t kTruncate = std::uint64_t{1} << 14, kIoctlDevice = std::uint64_t{1} << 15;
struct Ruleset {
  std::uint64_t files = 0, net = 0, scoped = 0;
};
constexpr std::uint64_t kBindTcp = 1, kConnectTcp = 2;                 // from Landlock version 4 on
constexpr std::uint64_t kAbstractSockets = 1, kSignals = 2;            // from Landlock version 6 on
constexpr std::uint64_t kFirstVersion = (std::uint64_t{1} << 13) - 1;  // all file access rights of version 1

constexpr std::uint64_t kRead = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
constexpr std::uint64_t kWrite =
    kRead | LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_REG | kTruncate;
// Access rights that are valid for files. The others are only for folders.
constexpr std::uint64_t kOfFiles = LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_WRITE_FILE |
                                   LANDLOCK_ACCESS_FS_READ_FILE | kTruncate | kIoctlDevice;

// Paths that libraries read at run time. They contain no user data; of /etc, only some paths are listed.
constexpr const char* kSystem[] = {
    "/usr",
    "/lib",
    "/lib64",
    "/etc/ld.so.cache",
    "/etc/fonts",
    "/var/cache/fontconfig",
    "/etc/drirc",
    "/etc/localtime",
    "/dev/zero",
    "/dev/urandom",
    "/proc/self",
    "/proc/cpuinfo",
    "/proc/meminfo",
    "/proc/sys/vm/overcommit_memory",
    "/sys/devices/system/cpu",
};

std::string reason(const std::string& what) { return what + ": " + std::generic_category().message(errno); }

int landlock_version() {
  const long version = ::syscall(SYS_landlock_create_ruleset, nullptr, std::size_t{0}, LANDLOCK_CREATE_RULESET_VERSION);
  return version > 0 ? static_cast<int>(version) : 0;
}

std::uint64_t accesses_of(int version) {
  std::uint64_t all = kFirstVersion;
  if (version >= 2) all |= LANDLOCK_ACCESS_FS_REFER;
  if (version >= 3) all |= kTruncate;
  if (version >= 5) all |= kIoctlDevice;
  return all;
}

// Allows the access rights `access` for `path` and everything below it. Returns false and sets errno on failure.
bool allow(const net::Descriptor& rules, const std::string& path, std::uint64_t access) {
  const net::Descriptor place(::open(path.c_str(), O_PATH | O_CLOEXEC));
  struct stat status {};
  if (!place || ::fstat(place.get(), &status) != 0) return false;
  landlock_path_beneath_attr rule{};
  rule.allowed_access = S_ISDIR(status.st_mode) ? access : access & kOfFiles;
  rule.parent_fd = place.get();
  return ::syscall(SYS_landlock_add_rule, rules.get(), LANDLOCK_RULE_PATH_BENEATH, &rule, 0) == 0;
}

std::optional<std::string> confine_files(const Confinement& confinement, int version) {
  const std::uint64_t all = accesses_of(version);
  Ruleset set;
  set.files = all;
  if (version >= 4) set.net = kBindTcp | kConnectTcp;
  if (version >= 6) set.scoped = kAbstractSockets | kSignals;
  // Older kernels accept this longer structure, as long as the members unknown to them are zero.
  const net::Descriptor rules(static_cast<int>(::syscall(SYS_landlock_create_ruleset, &set, sizeof set, 0)));
  if (!rules) return reason("Landlock rules cannot be created");
  for (const char* path : confinement.read.empty() ? std::span<const char* const>() : std::span(kSystem))
    if (!allow(rules, path, kRead & all) && errno != ENOENT && errno != ENOTDIR && errno != EACCES) return reason(path);
  if (confinement.read.empty()) {
    if (::syscall(SYS_landlock_restrict_self, rules.get(), 0) != 0) return reason("Landlock");
    return std::nullopt;
  }
  if (!allow(rules, "/dev/null", (kRead | LANDLOCK_ACCESS_FS_WRITE_FILE) & all)) return reason("/dev/null");
  if (!allow(rules, confinement.read, kRead & all)) return reason(confinement.read);
  if (!confinement.write.empty() && !allow(rules, confinement.write, kWrite & all)) return reason(confinement.write);
  if (::syscall(SYS_landlock_restrict_self, rules.get(), 0) != 0) return reason("Landlock");
  return std::nullopt;
}

}  // namespace

std::string ConfinementSupport::text() const {
  std::string text;
  if (landlock > 0 && seccomp) return "Landlock (version " + std::to_string(landlock) + ") and seccomp";
  if (landlock == 0)
    text = "this kernel has no Landlock (or it is disabled), so they have the file access of this user";
  if (!seccomp) text += std::string(text.empty() ? "" : "; ") + "this kernel has no seccomp, so they may open sockets";
  return text;
}

ConfinementSupport confinement_support() { return {landlock_version(), can_refuse_calls()}; }

std::optional<std::string> confine(const Confinement& confinement) {
  const ConfinementSupport support = confinement_support();
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return reason("no new privileges");
  if (support.landlock > 0)
    if (auto problem = confine_files(confinement, support.landlock)) return "cannot be confined: " + *problem;
  if (support.seccomp && !refuse_calls()) return reason("cannot be confined: seccomp");
  clear_environment();  // Landlock cannot exclude /proc/self/environ, because it allows /proc/self.
  return std::nullopt;
}

static std::optional<std::string> confine_child(bool (*allow_calls)()) {
  const ConfinementSupport support = confinement_support();
  clear_environment();
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return reason("no new privileges");
  if (support.landlock > 0)
    if (auto problem = confine_files({}, support.landlock)) return "cannot be confined: " + *problem;
  if (support.seccomp && !allow_calls()) return reason("cannot be confined: seccomp");
  return std::nullopt;
}

std::optional<std::string> confine_decoder() { return confine_child(allow_decoding_calls); }
std::optional<std::string> confine_programs() { return confine_child(allow_program_calls); }

}  // namespace gs::app
