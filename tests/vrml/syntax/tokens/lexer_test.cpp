#include "vrml/syntax/tokens/lexer.h"

#include "base/array.h"
#include "vrml/scene/values/field_value.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

using namespace gs;
using namespace gs::vrml;

namespace {

// Returns tokens as text with their positions. The window grows by `piece` bytes on each request of the lexer.
std::vector<std::string> tokens_of(const std::string& text, std::size_t piece) {
  std::vector<std::string> tokens;
  Lexer lexer;
  std::size_t start = 0, end = std::min(piece, text.size());
  for (;;) {
    // Each window is a copy, so that no token can use bytes outside it.
    const std::vector<char> window(text.begin() + static_cast<std::ptrdiff_t>(start),
                                   text.begin() + static_cast<std::ptrdiff_t>(end));
    static const char kNothing[1] = {};
    const char* begin = window.empty() ? kNothing : window.data();
    lexer.set_window(begin, begin + window.size(), end == text.size());
    for (;;) {
      const Lexer::Position before = lexer.position();
      const Token token = lexer.next();
      if (token.kind == TokenKind::need_more) {
        lexer.go_back(before);
        break;
      }
      tokens.push_back(std::to_string(static_cast<int>(token.kind)) + ":" + std::string(token.text) + "@" +
                       std::to_string(token.location.line) + ":" + std::to_string(token.location.column));
      if (token.kind == TokenKind::end) return tokens;
    }
    start += static_cast<std::size_t>(lexer.unread() - begin);
    REQUIRE(end < text.size());
    end = std::min(end + piece, text.size());
  }
}

const std::string kText =
    "#VRML V2.0 utf8\r\nDEF a.b Node{f[1,-2.5e3 .5]\"str\\\"ing\n x\\\\\"TRUE}\r# note\n\t0x1F,,1.#QNAN 1.# no\n'\\ "
    "\x01 end";

}  // namespace

TEST_CASE("reports the kind, text and position of each token") {
  const auto tokens = tokens_of(kText, kText.size());
  const auto token = [](TokenKind kind, const std::string& text, int line, int column) {
    return std::to_string(static_cast<int>(kind)) + ":" + text + "@" + std::to_string(line) + ":" +
           std::to_string(column);
  };
  const std::vector<std::string> expected = {token(TokenKind::word, "DEF", 2, 1),
                                             token(TokenKind::word, "a.b", 2, 5),
                                             token(TokenKind::word, "Node", 2, 9),
                                             token(TokenKind::open_brace, "{", 2, 13),
                                             token(TokenKind::word, "f", 2, 14),
                                             token(TokenKind::open_bracket, "[", 2, 15),
                                             token(TokenKind::word, "1", 2, 16),
                                             token(TokenKind::word, "-2.5e3", 2, 18),
                                             token(TokenKind::word, ".5", 2, 25),
                                             token(TokenKind::close_bracket, "]", 2, 27),
                                             token(TokenKind::string, "str\\\"ing\n x\\\\", 2, 28),
                                             token(TokenKind::word, "TRUE", 3, 6),
                                             token(TokenKind::close_brace, "}", 3, 10),
                                             token(TokenKind::word, "0x1F", 5, 2),
                                             token(TokenKind::word, "1.#QNAN", 5, 8),
                                             token(TokenKind::word, "1.", 5, 16),
                                             token(TokenKind::bad, "'", 6, 1),
                                             token(TokenKind::bad, "\\", 6, 2),
                                             token(TokenKind::bad, "\x01", 6, 4),
                                             token(TokenKind::word, "end", 6, 6),
                                             token(TokenKind::end, "", 6, 9)};
  CHECK(tokens == expected);
}

TEST_CASE("returns equal tokens however the text is cut into pieces") {
  const auto whole = tokens_of(kText, kText.size());
  for (std::size_t piece = 1; piece < kText.size(); ++piece) CHECK(tokens_of(kText, piece) == whole);
}

TEST_CASE("tokenizes each prefix like the whole text, up to its last tokens") {
  const auto whole = tokens_of(kText, kText.size());
  for (std::size_t size = 0; size < kText.size(); ++size) {
    const auto part = tokens_of(kText.substr(0, size), kText.size());
    REQUIRE(!part.empty());
    REQUIRE(part.size() <= whole.size() + 1);
    for (std::size_t i = 0; i + 3 < part.size(); ++i) CHECK(part[i] == whole[i]);
  }
}

TEST_CASE("decodes escapes, UTF-8 and Latin-1 in strings") {
  bool latin1 = false;
  CHECK(decode_string(R"(a\"b\\c\n)", true, latin1) == "a\"b\\c\\n");
  CHECK(decode_string("gr\xc3\xbc\xc3\x9f \xe2\x82\xac \xf0\x9d\x84\x9e", false, latin1) ==
        "gr\xc3\xbc\xc3\x9f \xe2\x82\xac \xf0\x9d\x84\x9e");
  CHECK_FALSE(latin1);
  CHECK(decode_string("caf\xe9", false, latin1) == "caf\xc3\xa9");
  CHECK(latin1);
  for (const char* wrong : {"\xc0\x80", "\xed\xa0\x80", "\xf5\x80\x80\x80", "\xe2\x82", "\x80"}) {
    latin1 = false;
    (void)decode_string(wrong, false, latin1);
    CHECK(latin1);
  }
}

TEST_CASE("accepts the names of Annex A.2") {
  for (const char* good : {"a", "_a-1+b", "Transform", "x:y", "%$&*()/<>=!?@^`|~", "\xc3\xa9"}) CHECK(is_id(good));
  for (const char* wrong : {"", "1a", "-a", "+a", ".a", ":a", "a.b"}) CHECK_FALSE(is_id(wrong));
}

TEST_CASE("shares the storage of arrays until a change") {
  Array<int> a{1, 2, 3};
  Array<int> b = a;
  CHECK(a.shares_with(b));
  b.push_back(4);
  CHECK_FALSE(a.shares_with(b));
  CHECK(a == Array<int>{1, 2, 3});
  CHECK(b == Array<int>{1, 2, 3, 4});
  Array<int> c = b;
  c.mutable_data()[0] = 9;
  CHECK(b[0] == 1);
  c = c;
  CHECK(c[0] == 9);
  c.resize(2);
  CHECK(c == Array<int>{9, 2});
  Array<String> texts{"x", "y"};
  Array<String> more = texts;
  more.push_back("z");
  more.shrink_to_fit();
  CHECK(more.capacity() == 3);
  CHECK(texts.size() == 2);
  texts = std::move(more);
  CHECK(texts[2] == "z");
  texts.clear();
  CHECK(texts.empty());
  CHECK(texts.data() == nullptr);
}

TEST_CASE("has names and default values for the 42 field types") {
  for (int i = 0; i < kFieldTypeCount; ++i) {
    const auto type = static_cast<FieldType>(i);
    CHECK(field_type_named(name_of(type)) == type);
    CHECK(type_of(initial_value(type)) == type);
    CHECK(is_multiple(type) == name_of(type).starts_with("MF"));
    CHECK(name_of(element_type(type)).substr(1) == name_of(type).substr(1));
    CHECK_FALSE(is_multiple(element_type(type)));
  }
  CHECK_FALSE(field_type_named("SFUnknown"));
  CHECK(std::get<SFRotation>(initial_value(FieldType::SFRotation)) == Rotation{0, 0, 1, 0});
}
