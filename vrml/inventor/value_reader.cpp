#include "vrml/inventor/value_reader.h"

#include "vrml/syntax/numbers/number.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

namespace gs::vrml::inventor {
namespace {

struct NamedForm {
  std::string_view name;  // without SF or MF
  Form form;
  std::uint8_t numbers = 1;
};

constexpr NamedForm kForms[] = {
    {"Bool", Form::boolean},    {"Enum", Form::word},         {"BitMask", Form::mask},
    {"Short", Form::integer},   {"UShort", Form::integer},    {"Long", Form::integer},
    {"ULong", Form::integer},   {"Int32", Form::integer},     {"UInt32", Form::integer},
    {"Float", Form::real},      {"Double", Form::real},       {"Time", Form::real},
    {"String", Form::text},     {"Name", Form::text},         {"Vec2f", Form::real, 2},
    {"Vec2d", Form::real, 2},   {"Vec2s", Form::real, 2},     {"Vec2i32", Form::real, 2},
    {"Vec3f", Form::real, 3},   {"Vec3d", Form::real, 3},     {"Vec3s", Form::real, 3},
    {"Vec3i32", Form::real, 3}, {"Vec4f", Form::real, 4},     {"Vec4d", Form::real, 4},
    {"Color", Form::color, 3},  {"ColorRGBA", Form::real, 4}, {"Rotation", Form::rotation, 4},
    {"Matrix", Form::real, 16}, {"Plane", Form::real, 4},     {"Box2f", Form::real, 4},
    {"Box3f", Form::real, 6},   {"Image", Form::image},       {"Node", Form::node},
    {"Path", Form::node},       {"Engine", Form::node},       {"Trigger", Form::none}};

bool is_number_word(std::string_view word) {
  return looks_like_number(word) || word == "nan" || word == "NaN" || word == "inf";
}

}  // namespace

std::optional<ValueType> value_type_named(std::string_view name) {
  if (!name.starts_with("SF") && !name.starts_with("MF")) return std::nullopt;
  for (const NamedForm& form : kForms)
    if (name.substr(2) == form.name) return ValueType{form.form, form.numbers, name.starts_with("MF")};
  return std::nullopt;
}

FieldValue initial_of(const ValueType& type) {
  const bool many = type.multiple;
  switch (type.form) {
    case Form::none:
    case Form::boolean:
      return many ? FieldValue(MFInt32{}) : FieldValue(SFBool{false});
    case Form::integer:
      return many ? FieldValue(MFInt32{}) : FieldValue(SFInt32{0});
    case Form::real:
      if (type.numbers == 2) return many ? FieldValue(MFVec2f{}) : FieldValue(SFVec2f{0, 0});
      if (type.numbers == 3) return many ? FieldValue(MFVec3f{}) : FieldValue(SFVec3f{0, 0, 0});
      return type.numbers == 1 && !many ? FieldValue(SFFloat{0}) : FieldValue(MFFloat{});
    case Form::color:
      return many ? FieldValue(MFColor{}) : FieldValue(SFColor{});
    case Form::rotation:
      return many ? FieldValue(MFRotation{}) : FieldValue(SFRotation{});
    case Form::text:
    case Form::word:
    case Form::mask:
      return many ? FieldValue(MFString{}) : FieldValue(SFString{});
    case Form::image:
      return SFImage{};
    case Form::node:
      return SFNode{};
  }
  return SFBool{false};
}

void ValueReader::unexpected(const Token& token, const std::string& what) {
  if (token.location.line == bad_at_.line && token.location.column == bad_at_.column) return;
  bad_at_ = token.location;
  if (token.kind == TokenKind::end) return;
  sink_.problems().error(token.location,
                         "expected " + what + " for " + std::string(name_) + ", found " + quoted(token.text));
}

// Moves the lexer after the first `length` bytes of a word.
void ValueReader::cut(const Token& token, std::size_t length) {
  Lexer::Position position = lexer_.position();
  position.next = token.text.data() + length;
  lexer_.go_back(position);
}

void ValueReader::skip_brackets() {
  for (std::size_t depth = 1; depth > 0;) {
    const Token token = lexer_.next();
    if (token.kind == TokenKind::end || token.kind == TokenKind::unterminated_string) return;
    if (token.kind == TokenKind::open_bracket || token.kind == TokenKind::open_brace) ++depth;
    if (token.kind == TokenKind::close_bracket || token.kind == TokenKind::close_brace) --depth;
  }
}

bool ValueReader::open_bracket() {
  if (lexer_.peek() != '[') return false;
  (void)lexer_.next();
  return true;
}

bool ValueReader::number_follows() {
  const Lexer::Position before = lexer_.position();
  const Token token = lexer_.next();
  lexer_.go_back(before);
  return token.kind == TokenKind::word && is_number_word(token.text);
}

// Reads one number. Returns false, and reads nothing, if no number follows.
template <class Number>
bool ValueReader::number(Number& value) {
  const Lexer::Position before = lexer_.position();
  const Token token = lexer_.next();
  if (token.kind != TokenKind::word || !is_number_word(token.text)) {
    lexer_.go_back(before);
    return false;
  }
  std::int32_t integer = 0;
  float real = 0;
  std::string_view word = token.text;
  for (int attempt = 0; attempt < 2; ++attempt) {
    if constexpr (std::is_same_v<Number, float>) {
      if (parse_number(word, value)) return true;
      if (parse_number(word, integer)) {
        value = static_cast<float>(integer);
        return true;
      }
    } else {
      if (parse_number(word, value)) return true;
      double large = 0;  // decimal numbers from 2^31 on are unsigned
      if (parse_number(word, large)) {
        large = std::isfinite(large) ? std::clamp(large, -2147483648.0, 4294967295.0) : 0;
        value = static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::int64_t>(large)));
        return true;
      }
    }
    const std::size_t length = number_length(word);
    if (length == 0 || length == word.size()) break;
    word = word.substr(0, length);
    cut(token, length);
  }
  if (word.starts_with("0x")) cut(token, token.text.size());
  (void)real;
  unexpected(token, "a number");
  value = 0;
  return true;
}

/// Reads numbers into a list: up to the closing bracket if `bracketed`, else `wanted` elements. `bulk` reads numbers in
/// plain notation.
template <class T, class Bulk>
void ValueReader::read_list(Array<T>& list, FieldValue& into, std::size_t wanted, bool bracketed, Bulk bulk) {
  using Number = std::conditional_t<std::is_same_v<T, std::int32_t>, std::int32_t, float>;
  constexpr std::size_t kNumbers = sizeof(T) / sizeof(Number);
  constexpr std::size_t kShort = 768, kLong = 49152;  // multiples of all sizes of elements
  alignas(16) Number buffer[kShort];
  std::size_t have = 0, charged = 0, capacity = kShort;
  Number* at = buffer;
  for (;;) {
    if (bracketed) {
      const NumberRun run = bulk(lexer_.unread(), lexer_.window_end(), at + have, capacity - have);
      lexer_.advance(run.next, run.lines, run.line_start);
      const bool full = have + run.count == capacity;
      have += run.count;
      const std::size_t elements = have / kNumbers, rest = have % kNumbers;
      Number partial[kNumbers];
      std::copy_n(at + have - rest, rest, partial);
      if (at == buffer)
        list.append(std::span<const T>(reinterpret_cast<const T*>(buffer), elements));
      else
        list.commit(elements);
      have = rest;
      sink_.limits().charge_growth(into, charged, false);
      if (sink_.scene().memory().exhausted()) return;
      if (full) {
        capacity = kLong;
        at = reinterpret_cast<Number*>(list.prepare(kLong / kNumbers));
        std::copy_n(partial, rest, at);
        continue;
      }
      at = buffer;
      capacity = kShort;
      std::copy_n(partial, rest, buffer);
    }
    Number value{};
    if (number(value)) {
      buffer[have++] = value;
      if (have == kNumbers) {
        list.append(std::span<const T>(reinterpret_cast<const T*>(buffer), 1));
        have = 0;
      }
      if (!bracketed && have == 0 && list.size() >= wanted) {
        if (wanted == 0 || !number_follows()) break;
        sink_.problems().warn_once(said_unbracketed_, lexer_.location(),
                                   "several values of " + std::string(name_) + " have no brackets; accepted");
      }
      continue;
    }
    if (!bracketed) {
      if (have > 0 || list.empty()) unexpected(lexer_.next(), "a number");
      break;
    }
    const Lexer::Position before = lexer_.position();
    const Token token = lexer_.next();
    if (token.kind == TokenKind::close_bracket || token.kind == TokenKind::end) break;
    unexpected(token, "a number or ']'");
    if (token.kind == TokenKind::open_bracket || token.kind == TokenKind::open_brace) skip_brackets();
    if (token.kind == TokenKind::close_brace) {
      lexer_.go_back(before);
      break;
    }
  }
  if (have > 0 && !list.empty()) {
    sink_.problems().warn(lexer_.location(), "the last value of " + std::string(name_) + " is incomplete; skipped it");
  }
  list.shrink_to_fit();
  sink_.limits().charge_growth(into, charged, true);
}

void ValueReader::read_numbers(const ValueType& type, FieldValue& into) {
  const bool bracketed = open_bracket();
  if (!type.multiple && bracketed && type.numbers == 1) {
    // One-element list for a single value.
    FieldValue list = initial_of({type.form, type.numbers, true});
    std::visit(
        [&](auto& values) {
          using T = std::decay_t<decltype(values)>;
          if constexpr (std::is_same_v<T, MFFloat>) {
            read_list(values, list, 0, true, parse_floats);
            if (!values.empty()) into = SFFloat{values[0]};
          } else if constexpr (std::is_same_v<T, MFInt32>) {
            read_list(values, list, 0, true, parse_integers);
            if (!values.empty()) into = SFInt32{values[0]};
          }
        },
        list);
    return;
  }
  if (auto* real = std::get_if<SFFloat>(&into)) {
    if (!number(*real)) unexpected(lexer_.next(), "a number");
    return;
  }
  if (auto* integer = std::get_if<SFInt32>(&into)) {
    if (!number(*integer)) unexpected(lexer_.next(), "a number");
    return;
  }
  if (!type.multiple && type.numbers <= 4 && !std::holds_alternative<MFFloat>(into)) {
    std::array<float, 4> n{};
    for (std::uint8_t i = 0; i < type.numbers; ++i)
      if (!number(n[i])) {
        unexpected(lexer_.next(), "a number");
        return;
      }
    if (bracketed) skip_brackets();
    if (auto* vector2 = std::get_if<SFVec2f>(&into)) *vector2 = {n[0], n[1]};
    if (auto* vector3 = std::get_if<SFVec3f>(&into)) *vector3 = {n[0], n[1], n[2]};
    if (auto* color = std::get_if<SFColor>(&into)) *color = {n[0], n[1], n[2]};
    if (auto* rotation = std::get_if<SFRotation>(&into)) *rotation = {n[0], n[1], n[2], n[3]};
    return;
  }
  into = initial_of(type);
  std::visit(
      [&](auto& values) {
        using T = std::decay_t<decltype(values)>;
        if constexpr (std::is_same_v<T, MFInt32>)
          read_list(values, into, 1, bracketed, parse_integers);
        else if constexpr (std::is_same_v<T, MFFloat>)
          read_list(values, into, type.numbers, bracketed, parse_floats);
        else if constexpr (std::is_same_v<T, MFVec2f> || std::is_same_v<T, MFVec3f> || std::is_same_v<T, MFColor> ||
                           std::is_same_v<T, MFRotation>)
          read_list(values, into, 1, bracketed, parse_floats);
      },
      into);
}

String ValueReader::text(const Token& token) {
  if (token.kind == TokenKind::word)
    sink_.problems().warn_once(said_bare_, token.location, "string has no quotes; accepted");
  if (!sink_.limits().admits_string(token.text.size(), token.location)) return {};
  bool latin1 = false;
  std::string decoded = decode_string(token.text, token.has_escapes, latin1);
  if (latin1) sink_.problems().warn_once(said_latin1_, token.location, "a string is not UTF-8; read as Latin-1");
  return String(decoded);
}

// Reads `(A | B)` or `A`. Returns "A|B" without parentheses and blanks.
String ValueReader::mask(const Token& first) {
  std::string words(first.text.substr(0, 256));
  if (words.starts_with('('))
    while (words.find(')') == std::string::npos && words.size() < 256) {
      const Lexer::Position before = lexer_.position();
      const Token token = lexer_.next();
      if (token.kind != TokenKind::word) {
        lexer_.go_back(before);
        break;
      }
      words += token.text.substr(0, 256);
    }
  std::erase_if(words, [](char c) { return c == '(' || c == ')'; });
  return String(words);
}

// Reads strings, enumerations and bit masks.
void ValueReader::read_words(const ValueType& type, FieldValue& into) {
  const bool bracketed = open_bracket();
  auto* const list = std::get_if<MFString>(&into);
  if (list) list->clear();
  for (bool first = true;; first = false) {
    const Lexer::Position before = lexer_.position();
    Token token = lexer_.next();
    const bool string = token.kind == TokenKind::string || token.kind == TokenKind::unterminated_string;
    if (bracketed && token.kind == TokenKind::close_bracket) return;
    if (!string && token.kind != TokenKind::word) {
      if (first || bracketed) unexpected(token, type.form == Form::text ? "a string" : "a name");
      if (token.kind != TokenKind::bad) lexer_.go_back(before);
      if (token.kind == TokenKind::bad && bracketed) continue;
      return;
    }
    if (!bracketed && !first && !string) {
      lexer_.go_back(before);
      return;
    }
    if (token.kind == TokenKind::word && token.text.size() > 1 && token.text.ends_with('~')) {
      cut(token, token.text.size() - 1);
      token.text.remove_suffix(1);
    }
    const String value = type.form == Form::text || string ? text(token) : mask(token);
    if (list)
      list->push_back(value);
    else
      into = value;
    if (bracketed) continue;
    // Several strings without brackets.
    if (!list || lexer_.peek() != '"') return;
  }
}

void ValueReader::read_image(FieldValue& into) {
  const SourceLocation location = lexer_.location();
  std::array<std::int32_t, 3> head{};
  for (std::int32_t& value : head)
    if (!number(value)) return unexpected(lexer_.next(), "an image");
  SFImage image;
  if (!sink_.limits().admits_image(head[0], head[1], head[2], location)) {
    std::int32_t skipped = 0;
    while (number(skipped)) {
    }
    return;
  }
  const std::size_t pixels = static_cast<std::size_t>(head[0]) * static_cast<std::size_t>(head[1]);
  if (pixels == 0) {
    into = SFImage{};
    return;
  }
  for (const std::int32_t value : head) image.words.push_back(static_cast<std::uint32_t>(value));
  std::size_t charged = 0;
  std::int32_t value = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    if (!number(value)) {
      unexpected(lexer_.next(), "a pixel");
      break;
    }
    image.words.push_back(static_cast<std::uint32_t>(value));
    if (i % 65536 == 65535) {
      into = image;
      sink_.limits().charge_growth(into, charged, false);
      into = SFImage{};
      if (sink_.scene().memory().exhausted()) return;
    }
  }
  image.words.resize(3 + pixels);
  into = std::move(image);
  sink_.limits().charge_growth(into, charged, true);
}

void ValueReader::read(const ValueType& type, FieldValue& into, std::string_view name) {
  name_ = name;
  switch (type.form) {
    case Form::none:
    case Form::node:
      return;
    case Form::boolean: {
      if (type.multiple) {
        FieldValue words = MFString{};
        read_words({Form::word, 1, true}, words);
        MFInt32 values;
        for (const String& word : *std::get_if<MFString>(&words)) values.push_back(word == String("TRUE") ? 1 : 0);
        into = values;
        return;
      }
      FieldValue word = SFString{};
      read_words({Form::word, 1, false}, word);
      const std::string_view text = std::get_if<SFString>(&word)->view();
      into = SFBool{text == "TRUE" || text == "true" || text == "1" || text == "True"};
      return;
    }
    case Form::integer:
    case Form::real:
    case Form::color:
    case Form::rotation:
      return read_numbers(type, into);
    case Form::text:
    case Form::word:
    case Form::mask:
      return read_words(type, into);
    case Form::image:
      return read_image(into);
  }
}

}  // namespace gs::vrml::inventor
