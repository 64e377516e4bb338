#include "qnv/codecs/shared/ranks.h"

#include <string>

namespace gs::qnv {

std::optional<EncodeError> agree(Ranks& ranks, const std::optional<EncodeError>& own) {
  if (ranks.count() == 1) return own;
  // A zero byte ends the error text of each rank. The texts contain none.
  std::string text = own ? own->message : std::string();
  text.push_back('\0');
  const std::vector<std::byte> all = ranks.gather(std::as_bytes(std::span(text)));
  std::string first;
  for (const std::byte one : all)
    if (one != std::byte{0})
      first.push_back(std::to_integer<char>(one));
    else if (!first.empty())
      break;
  return first.empty() ? std::nullopt : std::optional(EncodeError{first});
}

}  // namespace gs::qnv
