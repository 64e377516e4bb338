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

// Returns the number of numbers in one value of a type.
constexpr int arity(FieldType type) {
  switch (type) {
    case FieldType::SFVec2f:
    case FieldType::MFVec2f:
      return 2;
    case FieldType::SFColor:
    case FieldType::SFVec3f:
    case FieldType::MFColor:
    case FieldType::MFVec3f:
      return 3;
    case FieldType::SFRotation:
    case FieldType::MFRotation:
      return 4;
    default:
      return 1;
  }
}

std::string_view element_name(FieldType type) {
  std::string_view name = name_of(type);
  return name.starts_with("MF") ? name.substr(2) : name;
}

bool is_keyword_number(std::string_view word) {
  std::string lower;
  for (const char c : word.substr(0, 12)) lower += static_cast<char>(c >= 'A' && c <= 'Z' ? c + 32 : c);
  return lower == "nan" || lower == "inf" || lower == "infinity";
}

float to_float(double number) { return static_cast<float>(number); }

void append_element(FieldValue& list, const std::array<double, 4>& n) {
  if (auto* a = std::get_if<MFFloat>(&list)) a->push_back(to_float(n[0]));
  if (auto* a = std::get_if<MFInt32>(&list)) a->push_back(static_cast<std::int32_t>(n[0]));
  if (auto* a = std::get_if<MFTime>(&list)) a->push_back(n[0]);
  if (auto* a = std::get_if<MFVec2f>(&list)) a->push_back({to_float(n[0]), to_float(n[1])});
  if (auto* a = std::get_if<MFVec3f>(&list)) a->push_back({to_float(n[0]), to_float(n[1]), to_float(n[2])});
  if (auto* a = std::get_if<MFColor>(&list)) a->push_back({to_float(n[0]), to_float(n[1]), to_float(n[2])});
  if (auto* a = std::get_if<MFRotation>(&list))
    a->push_back({to_float(n[0]), to_float(n[1]), to_float(n[2]), to_float(n[3])});
}

void shrink(FieldValue& list) {
  std::visit(
      [](auto& value) {
        if constexpr (requires { value.shrink_to_fit(); }) value.shrink_to_fit();
      },
      list);
}

}  // namespace

// Parses a number token. Rounds floats only once, from text to float. Only SFTime is a double.
bool ValueParser::number_of(const Token& token, double& number) {
  const FieldType type = number_type_;
  if (type == FieldType::SFTime || type == FieldType::MFTime) return parse_number(token.text, number);
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
  const auto wanted = static_cast<std::size_t>(arity(type));
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

// Parses one value of a type other than nodes and images, starting with `token`. An MF type gets one element.
Step ValueParser::single_value(FieldType type, FieldValue& into, Token token, std::string_view name) {
  const auto refuse_token = [&](const Token& found, const Lexer::Position& before) {
    text_.unexpected(found, std::string(element_name(type)) + " for " + std::string(name));
    text_.lexer.go_back(before);
    if (found.kind == TokenKind::open_bracket || found.kind == TokenKind::string ||
        (found.kind == TokenKind::word &&
         (looks_like_number(found.text) || found.text == "TRUE" || found.text == "FALSE")))
      text_.skip_value();
    return Step::done;
  };
  // Start of the first token. Its text is always in the window.
  Lexer::Position before = text_.lexer.position();
  before.next = token.text.data() - (token.kind == TokenKind::string ? 1 : 0);
  if (token.text.data() == nullptr || token.kind == TokenKind::string || token.kind == TokenKind::unterminated_string)
    before = text_.lexer.position();

  switch (type) {
    case FieldType::SFString:
    case FieldType::MFString: {
      if (token.kind != TokenKind::string) return refuse_token(token, before);
      note_url_place(text_.frames.empty() ? nullptr : &text_.frames.back(), name, token);
      if (type == FieldType::SFString) {
        into = string_of(token);
      } else {
        into = MFString{string_of(token)};
      }
      return Step::done;
    }
    case FieldType::SFBool: {
      const std::string_view word = token.kind == TokenKind::word ? token.text : std::string_view{};
      const bool yes = word == "TRUE" || word == "true" || word == "True" || word == "1";
      const bool no = word == "FALSE" || word == "false" || word == "False" || word == "0";
      if (!yes && !no) return refuse_token(token, before);
      if (word != "TRUE" && word != "FALSE")
        text_.problems.warn_once(said_bool_form_, token.location, "expected TRUE or FALSE, found " + describe(token));
      into.emplace<SFBool>(yes);
      return Step::done;
    }
    default:
      break;
  }
  // Reads all tokens first: on need_more, nothing may have changed or have been reported.
  std::array<Token, 4> tokens;
  const auto is_number_like = [](const Token& t) {
    return t.kind == TokenKind::word && (looks_like_number(t.text) || is_keyword_number(t.text));
  };
  const int wanted = arity(type);
  int count = 0;
  for (;;) {
    if (!is_number_like(token)) return refuse_token(token, before);
    cut_number(token);
    tokens[count] = token;
    if (++count == wanted) break;
    before = text_.lexer.position();
    token = text_.lexer.next();
    if (token.kind == TokenKind::need_more) return Step::need_more;
  }
  std::array<double, 4> numbers{};
  number_type_ = type;
  for (int i = 0; i < wanted; ++i)
    if (!number_of(tokens[i], numbers[i]))
      text_.problems.error(tokens[i].location, "expected a number for " + std::string(name) + ", found " +
                                                   describe(tokens[i]) + "; 0 is used");
  const auto f = [&](int i) { return to_float(numbers[i]); };
  switch (type) {
    case FieldType::SFFloat:
      into.emplace<SFFloat>(f(0));
      break;
    case FieldType::SFTime:
      into.emplace<SFTime>(numbers[0]);
      break;
    case FieldType::SFInt32:
      into.emplace<SFInt32>(static_cast<std::int32_t>(numbers[0]));
      break;
    case FieldType::SFVec2f:
      into.emplace<SFVec2f>(f(0), f(1));
      break;
    case FieldType::SFVec3f:
      into.emplace<SFVec3f>(f(0), f(1), f(2));
      break;
    case FieldType::SFColor:
      into.emplace<SFColor>(SFColor{f(0), f(1), f(2)});
      break;
    case FieldType::SFRotation:
      into.emplace<SFRotation>(SFRotation{f(0), f(1), f(2), f(3)});
      break;
    default:
      into = initial_value(type);
      append_element(into, numbers);
      break;
  }
  return Step::done;
}

template <class T>
void ValueParser::bulk_floats(Frame& frame, Array<T>& array) {
  constexpr std::size_t kArity = sizeof(T) / sizeof(float);
  const auto take = [&](float* at, std::size_t capacity) {
    for (std::size_t i = 0; i < frame.partial_count; ++i) at[i] = to_float(frame.partial[i]);
    const NumberRun run = parse_floats(text_.lexer.unread(), text_.lexer.window_end(), at + frame.partial_count,
                                       capacity - frame.partial_count);
    text_.lexer.advance(run.next, run.lines, run.line_start);
    const std::size_t count = run.count + frame.partial_count;
    frame.partial_count = static_cast<std::uint8_t>(count % kArity);
    for (std::size_t i = 0; i < frame.partial_count; ++i) frame.partial[i] = at[count - frame.partial_count + i];
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
    bulk_floats(frame, *a);
  } else if (auto* b = std::get_if<MFInt32>(&list)) {
    bulk_integers(*b);
  } else if (auto* c = std::get_if<MFVec2f>(&list)) {
    bulk_floats(frame, *c);
  } else if (auto* d = std::get_if<MFColor>(&list)) {
    bulk_floats(frame, *d);
  } else if (auto* e = std::get_if<MFFloat>(&list)) {
    bulk_floats(frame, *e);
  } else if (auto* g = std::get_if<MFRotation>(&list)) {
    bulk_floats(frame, *g);
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

Step ValueParser::value_token(Frame& frame, const Token& token, const Lexer::Position& before) {
  FieldValue& list = *frame.into;
  const FieldType type = type_of(list);
  const auto leave = [&] {
    if (frame.partial_count > 0)
      text_.problems.error(token.location, "the last value of " + std::string(frame.name) + " has " +
                                               std::to_string(frame.partial_count) + " numbers; expected " +
                                               std::to_string(arity(type)));
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
  double number = 0;
  if (token.kind == TokenKind::word && type != FieldType::MFString) {
    bool taken = number_of(token, number);
    if (!taken && (looks_like_number(token.text) || is_keyword_number(token.text))) {
      text_.problems.error(token.location, "expected a number in " + std::string(frame.name) + ", found " +
                                               describe(token) + "; 0 is used");
      taken = true;
      number = 0;
    }
    if (taken) {
      frame.partial[frame.partial_count++] = number;
      if (frame.partial_count == arity(type)) {
        append_element(list, frame.partial);
        frame.partial_count = 0;
      }
      text_.rubbish = false;
      return Step::done;
    }
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
