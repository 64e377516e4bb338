#include "vrml/syntax/value_parser.h"

#include "vrml/syntax/numbers/number.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

namespace gs::vrml {
namespace {

// Size of a buffer on the stack for bulk-read numbers, so that memory for short lists is allocated once, with the exact
// size. Longer runs are written directly into the array.
constexpr std::size_t kShortRun = 768;
constexpr std::size_t kLongRun = 16 * 1024;

std::string_view element_name(FieldType type) {
  std::string_view name = name_of(type);
  return name.starts_with("MF") ? name.substr(2) : name;
}

bool is_keyword_number(std::string_view word) {
  std::string lower;
  for (const char c : word.substr(0, 12)) lower += static_cast<char>(c >= 'A' && c <= 'Z' ? c + 32 : c);
  return lower == "nan" || lower == "inf" || lower == "infinity";
}

constexpr bool has_doubles(FieldType type) {
  switch (element_type(type)) {
    case FieldType::SFTime:
    case FieldType::SFDouble:
    case FieldType::SFMatrix3d:
    case FieldType::SFMatrix4d:
    case FieldType::SFVec2d:
    case FieldType::SFVec3d:
    case FieldType::SFVec4d:
      return true;
    default:
      return false;
  }
}

float to_float(double number) { return static_cast<float>(number); }

void shrink(FieldValue& list) {
  std::visit(
      [](auto& value) {
        if constexpr (requires { value.shrink_to_fit(); }) value.shrink_to_fit();
      },
      list);
}

}  // namespace

// Parses a number token. Rounds floats only once, from text to float.
bool ValueParser::number_of(const Token& token, double& number) {
  const FieldType type = number_type_;
  if (has_doubles(type)) return parse_number(token.text, number);
  if (type == FieldType::SFInt32 || type == FieldType::MFInt32) {
    std::int32_t integer = 0;
    if (parse_number(token.text, integer)) {
      number = integer;
      return true;
    }
    double real = 0;
    if (!parse_number(token.text, real)) return false;
    text_.problems.warn_once(said_number_form_, token.location,
                             "expected an integer of 32 bits, found " + describe(token) + "; converted");
    number = std::isnan(real) ? 0 : std::trunc(std::clamp(real, -2147483648.0, 2147483647.0));
    return true;
  }
  float real = 0;
  std::int32_t integer = 0;
  if (parse_number(token.text, real)) {
    number = real;
    return true;
  }
  if (!parse_number(token.text, integer)) return false;
  number = integer;  // hexadecimal integer
  return true;
}

// Splits a token in which no blank follows a number, as Annex A permits: "80level", "10-1", "-.5.75". If the whole
// token is not a number, cuts the token after its leading number. Does so only if a name or another number follows.
void ValueParser::cut_number(Token& token) {
  const std::size_t length = number_length(token.text);
  if (length == 0 || length >= token.text.size()) return;
  const char next = token.text[length];
  const bool name = (next >= 'a' && next <= 'z') || (next >= 'A' && next <= 'Z') || next == '_';
  if (!name && next != '+' && next != '-' && next != '.') return;
  token.text = token.text.substr(0, length);
  Lexer::Position place = text_.lexer.position();
  place.next = token.text.data() + length;
  text_.lexer.go_back(place);
}

String ValueParser::string_of(const Token& token) {
  if (!text_.sink.limits().admits_string(token.text.size(), token.location)) return {};
  bool latin1 = false;
  const std::string text = decode_string(token.text, token.has_escapes, latin1);
  if (latin1) text_.problems.warn_once(said_latin1_, token.location, "a string is not UTF-8; read as Latin-1");
  return String(text);
}

// Reads a single value of floats in the plain form of nearly all files. Returns false and reads nothing for other text.
bool ValueParser::plain_floats(FieldType type, FieldValue& into) {
  if (type != FieldType::SFFloat && type != FieldType::SFVec2f && type != FieldType::SFVec3f &&
      type != FieldType::SFColor && type != FieldType::SFRotation)
    return false;
  float f[4];
  const auto wanted = static_cast<std::size_t>(number_count(type));
  const NumberRun run = parse_floats(text_.lexer.unread(), text_.lexer.window_end(), f, wanted);
  if (run.count != wanted) return false;
  text_.lexer.advance(run.next, run.lines, run.line_start);
  switch (type) {
    case FieldType::SFFloat:
      into.emplace<SFFloat>(f[0]);
      break;
    case FieldType::SFVec2f:
      into.emplace<SFVec2f>(f[0], f[1]);
      break;
    case FieldType::SFVec3f:
      into.emplace<SFVec3f>(f[0], f[1], f[2]);
      break;
    case FieldType::SFColor:
      into.emplace<SFColor>(SFColor{f[0], f[1], f[2]});
      break;
    default:
      into.emplace<SFRotation>(SFRotation{f[0], f[1], f[2], f[3]});
      break;
  }
  return true;
}

Step ValueParser::refuse_token(FieldType type, const Token& found, const Lexer::Position& before,
                               std::string_view name) {
  text_.unexpected(found, std::string(element_name(type)) + " for " + std::string(name));
  text_.lexer.go_back(before);
  if (found.kind == TokenKind::open_bracket || found.kind == TokenKind::string ||
      (found.kind == TokenKind::word &&
       (looks_like_number(found.text) || found.text == "TRUE" || found.text == "FALSE")))
    text_.skip_value();
  return Step::done;
}

bool ValueParser::bool_of(const Token& token, bool& value) {
  const std::string_view word = token.kind == TokenKind::word ? token.text : std::string_view{};
  value = word == "TRUE" || word == "true" || word == "True" || word == "1";
  if (!value && word != "FALSE" && word != "false" && word != "False" && word != "0") return false;
  if (word != "TRUE" && word != "FALSE")
    text_.problems.warn_once(said_bool_form_, token.location, "expected TRUE or FALSE, found " + describe(token));
  return true;
}

// Parses one value of a type other than nodes and images, starting with `token`. An MF type gets one element.
Step ValueParser::single_value(FieldType type, FieldValue& into, Token token, std::string_view name) {
  // Start of the first token. Its text is always in the window.
  Lexer::Position before = text_.lexer.position();
  before.next = token.text.data() - (token.kind == TokenKind::string ? 1 : 0);
  if (token.text.data() == nullptr || token.kind == TokenKind::string || token.kind == TokenKind::unterminated_string)
    before = text_.lexer.position();

  switch (type) {
    case FieldType::SFString:
    case FieldType::MFString: {
      if (token.kind != TokenKind::string) return refuse_token(type, token, before, name);
      note_url_place(text_.frames.empty() ? nullptr : &text_.frames.back(), name, token);
      if (type == FieldType::SFString) {
        into = string_of(token);
      } else {
        into = MFString{string_of(token)};
      }
      return Step::done;
    }
    case FieldType::SFBool:
    case FieldType::MFBool: {
      bool flag = false;
      if (!bool_of(token, flag)) return refuse_token(type, token, before, name);
      if (type == FieldType::SFBool) {
        into.emplace<SFBool>(flag);
      } else {
        into = MFBool{flag};
      }
      return Step::done;
    }
    default:
      break;
  }
  return number_count(type) <= 4 ? numbers<4>(type, into, token, before, name)
                                 : numbers<kMaxNumbers>(type, into, token, before, name);
}

template <int kMost>
Step ValueParser::numbers(FieldType type, FieldValue& into, Token token, Lexer::Position before,
                          std::string_view name) {
  // Reads all tokens first: on need_more, nothing may have changed or have been reported.
  std::array<Token, kMost> tokens;
  const auto is_number_like = [](const Token& t) {
    return t.kind == TokenKind::word && (looks_like_number(t.text) || is_keyword_number(t.text));
  };
  const int wanted = number_count(type);
  int count = 0;
  for (;;) {
    if (!is_number_like(token)) return refuse_token(type, token, before, name);
    cut_number(token);
    tokens[static_cast<std::size_t>(count)] = token;
    if (++count == wanted) break;
    before = text_.lexer.position();
    token = text_.lexer.next();
    if (token.kind == TokenKind::need_more) return Step::need_more;
  }
  std::array<double, kMost> values{};
  number_type_ = type;
  for (std::size_t i = 0; i < static_cast<std::size_t>(wanted); ++i)
    if (!number_of(tokens[i], values[i]))
      text_.problems.error(tokens[i].location, "expected a number for " + std::string(name) + ", found " +
                                                   describe(tokens[i]) + "; 0 is used");
  if (type == FieldType::SFInt32) {
    into.emplace<SFInt32>(static_cast<std::int32_t>(values[0]));
  } else if (type == FieldType::SFTime) {
    into.emplace<SFTime>(values[0]);
  } else {
    into = initial_value(type);
    write_numbers(into, values.data());
    std::size_t charged = 0;
    text_.sink.limits().charge_growth(into, charged, true);
  }
  return Step::done;
}

template <class T>
void ValueParser::bulk_floats(Array<T>& array) {
  constexpr std::size_t kArity = sizeof(T) / sizeof(float);
  const auto take = [&](float* at, std::size_t capacity) {
    const auto before = static_cast<std::size_t>(partial_count_);
    for (std::size_t i = 0; i < before; ++i) at[i] = to_float(partial_[i]);
    const NumberRun run = parse_floats(text_.lexer.unread(), text_.lexer.window_end(), at + before, capacity - before);
    text_.lexer.advance(run.next, run.lines, run.line_start);
    const std::size_t count = run.count + before, rest = count % kArity;
    partial_count_ = static_cast<int>(rest);
    for (std::size_t i = 0; i < rest; ++i) partial_[i] = at[count - rest + i];
    return std::pair(count / kArity, run.count == capacity - (count - run.count));
  };
  alignas(16) float buffer[kShortRun];
  auto [elements, full] = take(buffer, kShortRun);
  array.append(std::span<const T>(reinterpret_cast<const T*>(buffer), elements));
  while (full) {
    T* at = array.prepare(kLongRun);
    std::tie(elements, full) = take(reinterpret_cast<float*>(at), kLongRun * kArity);
    array.commit(elements);
  }
}

void ValueParser::bulk_integers(MFInt32& array) {
  std::int32_t buffer[kShortRun];
  NumberRun run = parse_integers(text_.lexer.unread(), text_.lexer.window_end(), buffer, kShortRun);
  text_.lexer.advance(run.next, run.lines, run.line_start);
  array.append(std::span<const std::int32_t>(buffer, run.count));
  bool full = run.count == kShortRun;
  while (full) {
    run = parse_integers(text_.lexer.unread(), text_.lexer.window_end(), array.prepare(kLongRun), kLongRun);
    text_.lexer.advance(run.next, run.lines, run.line_start);
    array.commit(run.count);
    full = run.count == kLongRun;
  }
}

// Parses the content of `[ ... ]` of an MF type other than MFNode: in bulk if the text is plain, else token by token.
// Values already read stay when more bytes are needed.
Step ValueParser::values_step() {
  Frame& frame = text_.frames.back();
  FieldValue& list = *frame.into;
  number_type_ = type_of(list);
  if (auto* a = std::get_if<MFVec3f>(&list)) {
    bulk_floats(*a);
  } else if (auto* b = std::get_if<MFInt32>(&list)) {
    bulk_integers(*b);
  } else if (auto* c = std::get_if<MFVec2f>(&list)) {
    bulk_floats(*c);
  } else if (auto* d = std::get_if<MFColor>(&list)) {
    bulk_floats(*d);
  } else if (auto* e = std::get_if<MFFloat>(&list)) {
    bulk_floats(*e);
  } else if (auto* g = std::get_if<MFRotation>(&list)) {
    bulk_floats(*g);
  } else if (auto* h = std::get_if<MFColorRGBA>(&list)) {
    bulk_floats(*h);
  } else if (auto* k = std::get_if<MFVec4f>(&list)) {
    bulk_floats(*k);
  } else if (auto* l = std::get_if<MFMatrix3f>(&list)) {
    bulk_floats(*l);
  } else if (auto* m = std::get_if<MFMatrix4f>(&list)) {
    bulk_floats(*m);
  }
  text_.sink.limits().charge_growth(list, frame.charged, false);
  const Lexer::Position before = text_.lexer.position();
  Token token = text_.lexer.next();
  if (token.kind == TokenKind::need_more) {
    text_.lexer.go_back(before);
    return Step::need_more_kept;
  }
  if (token.kind == TokenKind::end) return Step::finished;
  if (token.kind == TokenKind::word) cut_number(token);
  return value_token(frame, token, before);
}

// Stores the position of a url string, because errors in a program refer to its position in the file.
void ValueParser::note_url_place(const Frame* node, std::string_view name, const Token& token) {
  if (node && node->kind == Frame::Kind::node_body && node->declaring && !node->pending && name == "url")
    node->declaring->url_places.push_back(token.location);
}

bool ValueParser::take_element(Frame& frame, const Token& token) {
  FieldValue& list = *frame.into;
  if (auto* const flags = std::get_if<MFBool>(&list)) {
    bool flag = false;
    if (!bool_of(token, flag)) return false;
    flags->push_back(flag);
    return true;
  }
  double number = 0;
  if (!number_of(token, number)) {
    if (!looks_like_number(token.text) && !is_keyword_number(token.text)) return false;
    text_.problems.error(token.location, "expected a number in " + std::string(frame.name) + ", found " +
                                             describe(token) + "; 0 is used");
    number = 0;
  }
  partial_[static_cast<std::size_t>(partial_count_)] = number;
  if (++partial_count_ == number_count(type_of(list))) {
    write_numbers(list, partial_.data());
    partial_count_ = 0;
  }
  return true;
}

Step ValueParser::value_token(Frame& frame, const Token& token, const Lexer::Position& before) {
  FieldValue& list = *frame.into;
  const FieldType type = type_of(list);
  const auto leave = [&] {
    if (partial_count_ > 0)
      text_.problems.error(token.location, "the last value of " + std::string(frame.name) + " has " +
                                               std::to_string(partial_count_) + " numbers; expected " +
                                               std::to_string(number_count(type)));
    partial_count_ = 0;
    shrink(list);
    text_.sink.limits().charge_growth(list, frame.charged, true);
    text_.frames.pop_back();
    return Step::done;
  };
  if (token.kind == TokenKind::close_bracket) return leave();
  if (token.kind == TokenKind::string && type == FieldType::MFString) {
    note_url_place(text_.frames.size() < 2 ? nullptr : &text_.frames[text_.frames.size() - 2], frame.name, token);
    std::get_if<MFString>(&list)->push_back(string_of(token));
    text_.rubbish = false;
    return Step::done;
  }
  if (token.kind == TokenKind::word && type != FieldType::MFString && take_element(frame, token)) {
    text_.rubbish = false;
    return Step::done;
  }
  // If the bracket is missing, the next field of the node or the end of the node follows.
  const Frame* owner = text_.frames.size() >= 2 ? &text_.frames[text_.frames.size() - 2] : nullptr;
  const bool next_field =
      token.kind == TokenKind::word && owner && owner->kind == Frame::Kind::node_body &&
      (owner->node.type->find(token.text) || (owner->declaring && access_named(token.text, text_.language())));
  if (token.kind == TokenKind::close_brace || next_field) {
    text_.problems.error(token.location,
                         "expected ']' at the end of " + std::string(frame.name) + ", found " + describe(token));
    text_.lexer.go_back(before);
    return leave();
  }
  text_.rubbish_token(token, std::string(element_name(type)) + " or ']' in " + std::string(frame.name));
  return Step::done;
}

}  // namespace gs::vrml
