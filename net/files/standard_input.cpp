#include "net/files/standard_input.h"

#include "net/files/file.h"

#include <array>
#include <cerrno>
#include <span>
#include <system_error>

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gs::net {
namespace {

std::string input_problem() { return "standard input: " + std::generic_category().message(errno); }

}  // namespace

std::optional<std::string> hold_standard_input(std::uint64_t limit) {
  struct stat status {};
  if (::fstat(STDIN_FILENO, &status) != 0) return input_problem();
  if (S_ISREG(status.st_mode)) return std::nullopt;
  if (::isatty(STDIN_FILENO) == 1) return "standard input is a terminal; expected a file or a pipe";
  const Descriptor memory(::memfd_create("stdin", MFD_CLOEXEC));
  if (!memory) return input_problem();
  std::array<std::byte, 1 << 16> buffer;
  for (std::uint64_t held = 0;;) {
    const ssize_t got = ::read(STDIN_FILENO, buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return input_problem();
    if (got == 0) break;
    held += static_cast<std::uint64_t>(got);
    if (held > limit)
      return "standard input has more than " + std::to_string(limit) + " bytes; raise --memory to read more";
    if (!write_all(memory.get(), std::span(buffer).first(static_cast<std::size_t>(got)))) return input_problem();
  }
  return ::dup2(memory.get(), STDIN_FILENO) < 0 ? std::optional(input_problem()) : std::nullopt;
}

}  // namespace gs::net
