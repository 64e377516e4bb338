#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace gs::vrml::xml {

/// Character encoding of an XML text.
enum class Encoding : std::uint8_t {
  utf8,    // also US-ASCII, and unknown encodings
  latin1,  // ISO-8859-1, read as windows-1252, as browsers do
  utf16le,
  utf16be,
};

/// Converter of a text in any supported encoding to UTF-8, piece by piece. Detects the encoding by a byte order mark,
/// or by the XML declaration (XML 1.0 appendix F). Safe for untrusted bytes. One thread.
class TextDecoder {
 public:
  /// Returns the UTF-8 text of the next bytes. `last` means that the text ends after them. The result is valid until
  /// the next call, and as long as `bytes`.
  [[nodiscard]] std::string_view decode(std::string_view bytes, bool last);

  [[nodiscard]] Encoding encoding() const { return encoding_; }
  /// Returns the name of an encoding that is not supported and read as UTF-8. Returns an empty name if there is none.
  [[nodiscard]] const std::string& unknown_encoding() const { return unknown_; }

 private:
  [[nodiscard]] bool detect(std::string_view& bytes, bool last);
  void read_declaration(std::string_view declaration);
  void append_utf16(std::string_view bytes, bool last);

  Encoding encoding_ = Encoding::utf8;
  bool detected_ = false;
  std::string start_;  // bytes before the encoding is known
  std::string out_;    // converted text
  std::string odd_;    // UTF-16: bytes of an incomplete character
  std::string unknown_;
};

/// Appends a character in UTF-8. Replaces values that are no characters by U+FFFD.
void append_utf8(std::string& out, std::uint32_t character);

/// Appends text in windows-1252 as UTF-8.
void append_latin1(std::string& out, std::string_view text);

/// Reports whether the text is valid UTF-8.
[[nodiscard]] bool is_utf8(std::string_view text);

}  // namespace gs::vrml::xml
