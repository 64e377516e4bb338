#include "net/serve/request_fields.h"

#include <algorithm>

namespace gs::net {
namespace {

char lower_letter(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Compares two words and ignores case. `lower_case` is in lower case.
bool same_word(std::string_view text, std::string_view lower_case) {
  return std::equal(text.begin(), text.end(), lower_case.begin(), lower_case.end(),
                    [](char a, char b) { return lower_letter(a) == b; });
}

/// Reports whether `text` is a token (RFC 9110 5.6.2).
bool is_token(std::string_view text) {
  constexpr std::string_view kMarks = "!#$%&'*+-.^_`|~";
  return !text.empty() && std::all_of(text.begin(), text.end(), [kMarks](char c) {
    const char letter = lower_letter(c);
    return (letter >= 'a' && letter <= 'z') || (c >= '0' && c <= '9') || kMarks.find(c) != std::string_view::npos;
  });
}

bool has_field_controls(std::string_view text) {
  return std::any_of(text.begin(), text.end(),
                     [](char c) { return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7f; });
}

}  // namespace

std::optional<std::string> refuse_fields(std::span<const ReceivedField> fields, std::string_view version) {
  std::size_t lengths = 0, encodings = 0;
  for (const ReceivedField& field : fields) {
    if (field.folded) return "a header field spans several lines; expected one line per field";
    if (!is_token(field.name)) return "the name of a header field has an invalid character";
    if (has_field_controls(field.value)) return "the value of a header field has a control character";
    if (same_word(field.name, "content-length")) ++lengths;
    if (!same_word(field.name, "transfer-encoding")) continue;
    ++encodings;
    if (!same_word(field.value, "chunked")) return "the Transfer-Encoding is unknown; expected chunked";
  }
  if (lengths > 1) return "expected one Content-Length field";
  if (encodings > 1) return "expected one Transfer-Encoding field";
  if (encodings > 0 && lengths > 0) return "expected Content-Length or Transfer-Encoding, not both";
  if (encodings > 0 && version != "HTTP/1.1") return "expected no Transfer-Encoding in " + std::string(version);
  return std::nullopt;
}

}  // namespace gs::net
