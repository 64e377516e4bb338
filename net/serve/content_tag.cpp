#include "net/serve/content_tag.h"

#include "net/base/siphash.h"
#include "net/files/file.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include <sys/xattr.h>

namespace gs::net {
namespace {

constexpr const char* kTagAttribute = "user.ghostspace.tag";
constexpr std::size_t kDigits = 16;

}  // namespace

void store_content_tag(const std::string& path, const std::stop_token& stop) {
  const auto opened = open_file(path);
  const auto* const file = std::get_if<RandomAccessFile>(&opened);
  if (!file) return;
  std::vector<std::byte> piece(std::size_t{1} << 20);
  // Chains the pieces: the hash of a piece is part of the key of the next piece.
  std::uint64_t sum = file->size();
  for (std::uint64_t at = 0; at < file->size();) {
    const std::size_t got = file->read(at, piece);
    if (got == 0 || stop.stop_requested()) return;
    sum = siphash(SipKey{sum, at}, std::span(piece).first(got));
    at += got;
  }
  char text[kDigits + 1];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(sum));
  (void)::setxattr(path.c_str(), kTagAttribute, text, kDigits, 0);
}

std::optional<std::string> content_tag_of(const Descriptor& file) {
  std::array<char, kDigits> text{};
  if (::fgetxattr(file.get(), kTagAttribute, text.data(), text.size()) != static_cast<ssize_t>(kDigits))
    return std::nullopt;
  const std::string_view digits(text.data(), text.size());
  if (digits.find_first_not_of("0123456789abcdef") != std::string_view::npos) return std::nullopt;
  return "\"" + std::string(digits) + "-c\"";
}

}  // namespace gs::net
