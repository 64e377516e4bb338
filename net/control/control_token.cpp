#include "net/control/control_token.h"

#include "net/base/descriptor.h"
#include "net/base/hexadecimal.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gs::net {
namespace {

constexpr std::size_t kBytes = 16;

// Reports whether the content of a file has the form that write_control_token() writes.
bool is_token_file(const std::string& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  struct stat about {};
  std::array<char, 2 * kBytes + 1> text{};
  return file && ::fstat(file.get(), &about) == 0 && S_ISREG(about.st_mode) && about.st_size == ssize_t{text.size()} &&
         ::read(file.get(), text.data(), text.size()) == ssize_t{text.size()} && text.back() == '\n' &&
         std::all_of(text.begin(), text.end() - 1, [](char c) { return hexadecimal_value(c) >= 0; });
}

}  // namespace

std::string make_control_token() {
  std::array<unsigned char, kBytes> bytes{};
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t got = ::getrandom(bytes.data() + at, bytes.size() - at, 0);
    if (got > 0) at += static_cast<std::size_t>(got);
  }
  std::string text;
  for (const unsigned char byte : bytes)
    for (const int digit : {byte >> 4, byte & 15}) text += "0123456789abcdef"[digit];
  return text;
}

bool same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned different = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    different |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return different == 0;
}

std::optional<std::string> write_control_token(const std::string& path, const std::string& token) {
  struct stat about {};
  if (::lstat(path.c_str(), &about) == 0 && !is_token_file(path))
    return path + " already exists and has no token; not overwritten";
  return write_private_file(path, token + "\n");
}

std::optional<std::string> write_private_file(const std::string& path, std::string_view text) {
  const auto problem = [&] { return path + ": " + std::strerror(errno); };
  std::string made = path + ".XXXXXX";
  Descriptor file(::mkostemp(made.data(), O_CLOEXEC));  // mkostemp creates the file with mode 0600
  if (!file) return problem();
  const bool written = ::write(file.get(), text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (written && file.close() && ::rename(made.c_str(), path.c_str()) == 0) return std::nullopt;
  const std::string why = problem();
  ::unlink(made.c_str());
  return why;
}

std::string usual_token_file(std::uint16_t port) {
  const std::string name = "insitu-" + std::to_string(port) + ".token";
  if (const char* runtime = std::getenv("XDG_RUNTIME_DIR"); runtime && runtime[0] == '/')
    return std::string(runtime) + "/ghostspace/" + name;
  if (const char* home = std::getenv("HOME"); home && home[0] == '/')
    return std::string(home) + "/.cache/ghostspace/" + name;
  return {};
}

}  // namespace gs::net
