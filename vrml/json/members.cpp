#include "vrml/json/members.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace gs::vrml::json {
namespace {

using x3d::ElementKind;

// Maximum number of nested objects with members that wait for each other.
constexpr std::size_t kMaxReplays = 16;

// Reports whether the attribute selects the element, and is no value of a field.
bool is_control(ElementKind element, std::string_view name) {
  switch (element) {
    case ElementKind::node:
      return name == "DEF" || name == "USE" || name == "containerField";
    case ElementKind::field:
    case ElementKind::field_value:
      return name != "value";
    case ElementKind::external_prototype:
      return name != "url";
    default:
      return true;
  }
}

// Returns the bit of an attribute that other members of an element may wait for; 0 for others.
std::uint8_t bit_of(std::string_view attribute) {
  constexpr std::string_view kNames[] = {"name", "type", "accessType", "USE"};
  for (unsigned i = 0; i < std::size(kNames); ++i)
    if (attribute == kNames[i]) return static_cast<std::uint8_t>(1u << i);
  return 0;
}

bool is_scalar(const Token& token) { return token.kind == TokenKind::string || token.kind == TokenKind::word; }

}  // namespace

Frame& FrameStack::push(Frame::Kind kind, SourceLocation start, std::string_view name, std::string_view container) {
  if (size_ == frames_.size()) frames_.emplace_back();
  Frame& frame = frames_[size_++];
  frame.kind = kind;
  frame.start = start;
  frame.name = name;
  frame.container = container;
  frame.element = ElementKind::node;
  frame.begun = frame.has_interface = frame.is_recorded = false;
  frame.depth = 0;
  frame.given = 0;
  return frame;
}

void FrameStack::pop_back() {
  constexpr std::size_t kMaxKept = 256;  // bytes of a name, and attributes
  Frame& frame = frames_[--size_];
  for (std::string* const text : {&frame.name, &frame.container})
    if (text->capacity() > kMaxKept) *text = {};
  frame.attributes.clear();
  if (frame.attributes.capacity() > kMaxKept) frame.attributes = {};
  frame.waiting = {};
}

MemberReader::MemberReader(SceneSink& sink) : sink_(sink), values_(sink), builder_(sink), list_(sink, values_) {
  frames_.push(Frame::Kind::document, {});
}

Progress MemberReader::step() {
  switch (frames_.back().kind) {
    case Frame::Kind::document:
      return document_step();
    case Frame::Kind::choice:
      return choice_step();
    case Frame::Kind::choice_list:
    case Frame::Kind::element_list:
      return list_step();
    case Frame::Kind::element:
      return element_step();
    case Frame::Kind::values:
      return values_step();
    case Frame::Kind::lines:
      return lines_step();
    case Frame::Kind::skip:
      return skip_step();
  }
  return Progress::finished;
}

void MemberReader::unexpected(const Token& token, std::string_view wanted) {
  if (std::exchange(said_unexpected_, true)) return;
  const std::string found = token.kind == TokenKind::string ? "a string" : quoted(token.text);
  sink_.problems().error(token.location, "expected " + std::string(wanted) + ", found " + found);
}

// Returns the text of a token, which is valid as long as the token and `storage`.
std::string_view MemberReader::text_of(const Token& token, std::string& storage) {
  if (token.kind != TokenKind::string || (!token.has_escapes && is_ascii(token.text))) return token.text;
  bool latin1 = false;
  storage = decode_string(token.text, token.has_escapes, latin1);
  if (latin1) sink_.problems().warn_once(said_latin1_, token.location, "a string is not UTF-8; read as Latin-1");
  return storage;
}

bool MemberReader::pass_colon() {
  const char next = lexer_.peek();
  if (next == '\0') return lexer_.is_last_window();
  if (next == ':') lexer_.advance(lexer_.unread() + 1, 0, nullptr);
  return true;
}

// Opens an object or array after its bracket. Skips it if it is too deep, and then returns null.
Frame* MemberReader::open(Frame::Kind kind, SourceLocation start, std::string_view name, std::string_view container) {
  // An X3D node takes three levels: its object, its name and its field.
  const bool admitted = frames_.size() < 4 * sink_.scene().limits().nesting ||
                        sink_.limits().admits_depth(sink_.scene().limits().nesting, start);
  if (admitted) return &frames_.push(kind, start, name, container);
  frames_.push(Frame::Kind::skip, start).depth = 1;
  return nullptr;
}

// Skips a value after its first token.
void MemberReader::skip(const Token& value) {
  if (value.kind != TokenKind::open_brace && value.kind != TokenKind::open_bracket) return;
  frames_.push(Frame::Kind::skip, value.location).depth = 1;
}

Progress MemberReader::document_step() {
  const Token token = lexer_.next();
  if (token.kind == TokenKind::need_more) return Progress::need_more;
  if (token.kind == TokenKind::end) return Progress::finished;
  if (token.kind == TokenKind::open_brace) {
    open(Frame::Kind::choice, token.location);
    return Progress::done;
  }
  unexpected(token, "'{'");
  return Progress::done;
}

// Reads {"Name": {...}}. Real files may have several members.
Progress MemberReader::choice_step() {
  const Token key = lexer_.next();
  if (key.kind == TokenKind::need_more) return Progress::need_more;
  if (key.kind == TokenKind::end || key.kind == TokenKind::unterminated_string) return Progress::finished;
  if (key.kind == TokenKind::close_brace) {
    frames_.pop_back();
    return Progress::done;
  }
  if (key.kind != TokenKind::string) {
    unexpected(key, "the name of a node or '}'");
    skip(key);
    return Progress::done;
  }
  if (!pass_colon()) return Progress::need_more;
  const Token value = lexer_.next();
  if (value.kind == TokenKind::need_more) return Progress::need_more;
  const std::string_view name = text_of(key, key_text_);
  if (value.kind == TokenKind::open_brace && !name.empty() && name[0] != '#' && name[0] != '@' && name[0] != '-')
    open_element(name, frames_.back().container, key.location);
  else
    skip(value);
  return Progress::done;
}

Progress MemberReader::list_step() {
  const Token token = lexer_.next();
  if (token.kind == TokenKind::need_more) return Progress::need_more;
  if (token.kind == TokenKind::end || token.kind == TokenKind::unterminated_string) return Progress::finished;
  const Frame& frame = frames_.back();
  if (token.kind == TokenKind::close_bracket) {
    frames_.pop_back();
  } else if (token.kind == TokenKind::open_brace) {
    if (frame.kind == Frame::Kind::element_list)
      open_element(frame.name, frame.container, token.location);
    else
      open(Frame::Kind::choice, token.location, {}, frame.container);
  } else {
    if (token.kind != TokenKind::word && token.kind != TokenKind::string) unexpected(token, "'{' or ']'");
    skip(token);
  }
  return Progress::done;
}

void MemberReader::open_element(std::string_view name, std::string_view container, SourceLocation start) {
  Frame* const frame = open(Frame::Kind::element, start, name);
  if (!frame) return;
  frame->element = x3d::kind_of(name);
  if (!container.empty()) frame->attributes.push_back({"containerField", std::string(container), start});
}

// Tells the builder about the innermost element, if it does not know it yet.
void MemberReader::begin_element() {
  Frame& frame = frames_.back();
  if (std::exchange(frame.begun, true)) return;
  attributes_.clear();
  for (const StoredAttribute& stored : frame.attributes)
    attributes_.push_back({stored.name, stored.value, stored.location});
  builder_.begin({frame.name, frame.start}, attributes_);
  frame.attributes.clear();
}

void MemberReader::end_element() {
  begin_element();
  if (!frames_.back().waiting.empty()) {
    std::vector<WaitingMember> waiting = std::exchange(frames_.back().waiting, {});
    std::stable_partition(waiting.begin(), waiting.end(),
                          [](const WaitingMember& member) { return member.key != "ProtoBody"; });
    for (const WaitingMember& member : waiting) replay(member);
  }
  builder_.end();
  frames_.pop_back();
}

Progress MemberReader::element_step() {
  const Lexer::Position before = lexer_.position();
  const Token key = lexer_.next();
  if (key.kind == TokenKind::need_more) return Progress::need_more;
  if (key.kind == TokenKind::end || key.kind == TokenKind::unterminated_string) return Progress::finished;
  if (key.kind == TokenKind::close_brace) {
    end_element();
    return Progress::done;
  }
  if (key.kind == TokenKind::close_bracket) {
    // The brace is missing.
    unexpected(key, "'}'");
    end_element();
    lexer_.go_back(before);
    return Progress::done;
  }
  if (key.kind != TokenKind::string) {
    unexpected(key, "the name of a member or '}'");
    skip(key);
    return Progress::done;
  }
  if (!pass_colon()) return Progress::need_more;
  const Token value = lexer_.next();
  if (value.kind == TokenKind::need_more) return Progress::need_more;
  if (value.kind == TokenKind::end) return Progress::finished;
  if (value.kind == TokenKind::close_brace) {
    end_element();
    return Progress::done;
  }
  const std::string_view name = text_of(key, key_text_);
  if (!name.empty()) member(name, key.location, value);
  return Progress::done;
}

// Reads a member of an element. The first token of its value was read.
void MemberReader::member(std::string_view key, SourceLocation location, const Token& value) {
  if (must_wait(frames_.back(), key)) return wait(key, location, value);
  const bool is_object = value.kind == TokenKind::open_brace, is_list = value.kind == TokenKind::open_bracket;
  if (key[0] == '@') return attribute(key.substr(1), location, value);
  if (key[0] == '#') {
    if (key != "#sourceCode" && key != "#sourceText") return skip(value);
    begin_element();
    if (value.kind == TokenKind::string && builder_.takes_text())
      builder_.text(text_of(value, value_text_), value.location);
    if (!is_list) return skip(value);
    open(Frame::Kind::lines, value.location);
    return;
  }
  if (!is_object && !is_list) return;
  begin_element();
  const std::string_view name = key[0] == '-' ? key.substr(1) : key;
  if (frames_.back().element == ElementKind::prototype && name == "ProtoInterface") frames_.back().has_interface = true;
  if (key[0] == '-') {
    open(is_list ? Frame::Kind::choice_list : Frame::Kind::choice, value.location, {}, name);
  } else if (is_list) {
    open(Frame::Kind::element_list, value.location, name);
  } else {
    open_element(name, {}, value.location);
  }
}

void MemberReader::attribute(std::string_view name, SourceLocation location, const Token& value) {
  Frame& frame = frames_.back();
  if (is_control(frame.element, name)) {
    if (!is_scalar(value)) return skip(value);
    if (!frame.begun) {
      (void)sink_.scene().memory().charge(sizeof(StoredAttribute) + value.text.size());
      frame.given |= bit_of(name);
      frame.attributes.push_back({std::string(name), std::string(text_of(value, value_text_)), value.location});
    } else if (name == "DEF") {
      builder_.name_node({text_of(value, value_text_), value.location});
    }
    return;
  }
  begin_element();
  const SourceName field{name, location};
  FieldValue* const into = builder_.value_of(field);
  if (!into || (value.kind == TokenKind::word && value.text == "null")) return skip(value);
  if (value.kind == TokenKind::open_bracket) {
    if (list_.read_short(*into, lexer_)) return builder_.value_given();
    if (Frame* const list = open(Frame::Kind::values, value.location)) {
      list->depth = 1;
      list_.begin(*into, name, value.location);
    }
    return;
  }
  if (!is_scalar(value)) {
    unexpected(value, "a value");
    return skip(value);
  }
  if (value.kind == TokenKind::string && !std::holds_alternative<MFString>(*into)) {
    const std::string_view text = text_of(value, value_text_);
    if (std::holds_alternative<SFString>(*into))
      *into = values_.string_of(text, value.location);
    else
      values_.read({text, value.location, name}, *into);
  } else if (value.kind != TokenKind::word || !ListReader::read_plain_word(value.text, *into)) {
    list_.begin(*into, name, value.location);
    value.kind == TokenKind::string ? list_.read_string(text_of(value, value_text_), value.location)
                                    : list_.read_word(value.text, value.location);
    list_.end(value.location);
  }
  builder_.value_given();
}

// Reads the elements of an array. Arrays in it only group them.
Progress MemberReader::values_step() {
  list_.read_plain(lexer_);
  const Lexer::Position before = lexer_.position();
  const Token token = lexer_.next();
  switch (token.kind) {
    case TokenKind::need_more:
      lexer_.go_back(before);
      return Progress::need_more_kept;
    case TokenKind::end:
    case TokenKind::unterminated_string:
      return Progress::finished;
    case TokenKind::string:
      list_.read_string(text_of(token, value_text_), token.location);
      break;
    case TokenKind::word:
      list_.read_word(token.text, token.location);
      break;
    case TokenKind::open_bracket:
      ++frames_.back().depth;
      break;
    case TokenKind::close_bracket:
      if (--frames_.back().depth > 0) break;
      list_.end(token.location);
      frames_.pop_back();
      builder_.value_given();
      break;
    case TokenKind::close_brace:
      unexpected(token, "']'");
      list_.end(token.location);
      frames_.pop_back();
      builder_.value_given();
      lexer_.go_back(before);
      break;
    default:
      unexpected(token, "a value or ']'");
      skip(token);
      break;
  }
  return Progress::done;
}

Progress MemberReader::lines_step() {
  const Token token = lexer_.next();
  if (token.kind == TokenKind::need_more) return Progress::need_more;
  if (token.kind == TokenKind::end || token.kind == TokenKind::unterminated_string) return Progress::finished;
  if (token.kind == TokenKind::close_bracket)
    frames_.pop_back();
  else if (token.kind == TokenKind::string && builder_.takes_text())
    builder_.text(std::string(text_of(token, value_text_)) + "\n", token.location);
  else
    skip(token);
  return Progress::done;
}

Progress MemberReader::skip_step() {
  const char* const start = lexer_.unread();
  const Token token = lexer_.next();
  if (token.kind == TokenKind::need_more) return Progress::need_more;
  Frame& frame = frames_.back();
  if (frame.is_recorded) {
    std::string& text = frames_.parent().waiting.back().text;
    const auto size = static_cast<std::size_t>(lexer_.unread() - start);
    (void)sink_.scene().memory().charge(size);
    if (!sink_.scene().memory().exhausted()) text.append(start, size);
  }
  if (token.kind == TokenKind::end || token.kind == TokenKind::unterminated_string) return Progress::finished;
  if (token.kind == TokenKind::open_brace || token.kind == TokenKind::open_bracket) ++frame.depth;
  if ((token.kind == TokenKind::close_brace || token.kind == TokenKind::close_bracket) && --frame.depth == 0)
    frames_.pop_back();
  return Progress::done;
}

// Reports whether a member needs members that were not read yet.
bool MemberReader::must_wait(const Frame& frame, std::string_view key) const {
  if (replays_ >= kMaxReplays || key[0] == '#') return false;
  const auto has = [&](std::string_view name) { return frame.begun || (frame.given & bit_of(name)) != 0; };
  const bool is_control_member = key[0] == '@' && is_control(frame.element, key.substr(1));
  switch (frame.element) {
    case ElementKind::field:
      return !is_control_member && !(has("name") && has("type") && has("accessType"));
    case ElementKind::field_value:
    case ElementKind::external_prototype:
    case ElementKind::instance:
      return !is_control_member && !has("name") && !has("USE");
    case ElementKind::prototype:
      return !is_control_member && (!has("name") || (key == "ProtoBody" && !frame.has_interface));
    default:
      return false;
  }
}

// Stores a member until the end of its element.
void MemberReader::wait(std::string_view key, SourceLocation location, const Token& value) {
  WaitingMember member{std::string(key), {}, location};
  const bool is_string = value.kind == TokenKind::string;
  member.text = is_string ? '"' + std::string(value.text) + '"' : std::string(value.text);
  (void)sink_.scene().memory().charge(sizeof(WaitingMember) + member.text.size());
  frames_.back().waiting.push_back(std::move(member));
  if (value.kind != TokenKind::open_brace && value.kind != TokenKind::open_bracket) return;
  skip(value);
  frames_.back().is_recorded = true;
}

// Reads a member that has waited.
void MemberReader::replay(const WaitingMember& waiting) {
  Lexer lexer;
  lexer.set_window(waiting.text.data(), waiting.text.data() + waiting.text.size(), true);
  std::swap(lexer_, lexer);
  ++replays_;
  const std::size_t depth = frames_.size();
  const Token value = lexer_.next();
  // Nothing is left to wait for.
  frames_.back().has_interface = true;
  member(waiting.key, waiting.location, value);
  while (frames_.size() > depth && step() == Progress::done && !sink_.scene().memory().exhausted()) {
  }
  while (frames_.size() > depth) frames_.pop_back();
  --replays_;
  std::swap(lexer_, lexer);
}

}  // namespace gs::vrml::json
