#include "vrml/syntax/scene_reader.h"

#include "base/text.h"

#include <string>

namespace gs::vrml {
namespace {

constexpr std::size_t kWindow = 8192;

// Returns the first bytes in lower case, without byte order mark and blanks, and without the zero bytes of UTF-16.
std::string start_of(std::string_view bytes) {
  std::string text;
  for (const char c : bytes.substr(0, kWindow)) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_mark = text.empty() && (byte == 0xef || byte == 0xbb || byte == 0xbf || byte >= 0xfe);
    const bool is_blank = text.empty() && (c == ' ' || c == '\t' || c == '\r' || c == '\n');
    if (byte != 0 && !is_mark && !is_blank) text += c;
  }
  return lower_case(text);
}

}  // namespace

Grammar grammar_of(std::string_view first_bytes) {
  const std::string text = start_of(first_bytes);
  if (text.starts_with("#x3d")) return Grammar::x3d_classic;
  if (text.starts_with("#vrml v1.0") || text.starts_with("#inventor")) return Grammar::inventor;
  // A page of HTML may contain an X3D element.
  if (text.starts_with('<') && text.find("<html") == std::string::npos)
    for (std::size_t at = text.find("<x3d"); at != std::string::npos; at = text.find("<x3d", at + 1))
      if (at + 4 == text.size() || std::string_view(" \t\r\n/>").find(text[at + 4]) != std::string_view::npos)
        return Grammar::x3d_xml;
  if (text.starts_with('{') && text.find("\"x3d\"") != std::string::npos) return Grammar::x3d_json;
  return Grammar::vrml97;
}

}  // namespace gs::vrml
