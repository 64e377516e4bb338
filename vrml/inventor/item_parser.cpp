#include "vrml/inventor/item_parser.h"

#include "vrml/inventor/item_types.h"

#include <algorithm>
#include <utility>

namespace gs::vrml::inventor {
namespace {

constexpr std::size_t kMaxRemembered = 1000;  // types, fields or messages that a text can make the parser remember

bool is_value(const Token& token) {
  return token.kind == TokenKind::string ||
         (token.kind == TokenKind::word && (looks_like_number(token.text) || token.text == "TRUE" ||
                                            token.text == "FALSE" || token.text.front() == '('));
}

}  // namespace

Token ItemParser::next() { return lexer_.next(); }

// Returns the next byte after blanks, and does not move the lexer.
char ItemParser::peek() {
  const Lexer::Position before = lexer_.position();
  const char found = lexer_.peek();
  lexer_.go_back(before);
  return found;
}

// Moves the lexer back to the start of a token that is not a string.
void ItemParser::back(const Token& token) {
  if (token.kind == TokenKind::end || token.text.data() == nullptr) return;
  Lexer::Position position = lexer_.position();
  position.next = token.text.data();
  if (token.location.line == position.line) lexer_.go_back(position);
}

void ItemParser::report_once(SourceLocation location, std::string message, Severity severity) {
  if (reported_.size() >= kMaxRemembered || !reported_.insert(message).second) return;
  sink_.problems().report(severity, location, std::move(message));
}

bool ItemParser::charge(std::size_t bytes, SourceLocation location) {
  if (stopped_) return false;
  if (share_.grow(bytes) && !sink_.scene().memory().exhausted()) return true;
  stopped_ = true;
  if (!sink_.limits().is_exhausted(location))
    sink_.problems().error(location, sink_.scene().budget()->refusal(Resource::nodes) + "; skipped the rest");
  return false;
}

void ItemParser::end_inside(const Item& item) {
  if (!last_window_) {
    sink_.problems().error(lexer_.location(), "expected '}' for " + item.type->name + " that begins at line " +
                                                  std::to_string(item.location.line));
    return;
  }
  if (std::exchange(truncated_, true) || stopped_) return;
  sink_.problems().error(lexer_.location(), "the file ends inside " + item.type->name + " that begins at line " +
                                                std::to_string(item.location.line) + "; expected '}'");
}

const ItemType& ItemParser::type_of(const Token& name) {
  if (const ItemType* const known = find_item_type(name.text)) return *known;
  const std::string key(name.text.substr(0, 200));
  std::unique_ptr<ItemType>& type = unknown_types_[unknown_types_.size() < kMaxRemembered ? key : std::string()];
  if (!type) {
    type = std::make_unique<ItemType>(unknown_item_type());
    type->name = key;
  }
  return *type;
}

const FieldRow& ItemParser::keep_row(std::string_view name, const ValueType& type) {
  const std::string key = std::string(name.substr(0, 200)) + '\n' +
                          static_cast<char>('a' + static_cast<int>(type.form)) + static_cast<char>('a' + type.numbers) +
                          (type.multiple ? 'm' : 's');
  const auto found = row_by_name_.find(key);
  if (found != row_by_name_.end()) return *found->second;
  if (rows_.size() >= kMaxRemembered * 10) return rows_.back();
  rows_.push_back({type, std::string(name.substr(0, 200)), initial_of(type)});
  row_by_name_.emplace(key, &rows_.back());
  return rows_.back();
}

// Reports whether a node begins with `token`, which was read: DEF, USE, or a word with a brace after it.
bool ItemParser::is_node_start(const Token& token) {
  if (token.kind != TokenKind::word) return false;
  return token.text == "DEF" || token.text == "USE" || (!looks_like_number(token.text) && peek() == '{');
}

ItemPtr ItemParser::next_root() {
  while (!stopped_) {
    const Token token = next();
    if (token.kind == TokenKind::end) return nullptr;
    if (is_node_start(token)) {
      rubbish_ = false;
      if (ItemPtr item = parse_node(token, 1)) return item;
      continue;
    }
    if (std::exchange(rubbish_, true)) continue;
    if (token.kind == TokenKind::unterminated_string) {
      truncated_ = true;
      sink_.problems().error(token.location, "unterminated string; expected '\"'");
    } else {
      sink_.problems().error(token.location, "expected a node, found " + quoted(token.text));
    }
  }
  return nullptr;
}

// Parses a node from DEF, USE or its type on.
ItemPtr ItemParser::parse_node(const Token& first, std::size_t depth) {
  Token type = first;
  std::string_view name;
  if (first.text == "USE" || first.text == "DEF") {
    const Token id = next();
    if (id.kind != TokenKind::word) {
      sink_.problems().error(id.location, "expected a name after " + std::string(first.text));
      back(id);
      return nullptr;
    }
    if (first.text == "USE") {
      auto found = names_.find(std::string(id.text));
      // After `= USE Name.output` of an engine, the output belongs to the word.
      if (found == names_.end()) found = names_.find(std::string(id.text.substr(0, id.text.find('.'))));
      if (found != names_.end()) return found->second;
      report_once(id.location, "USE of " + quoted(id.text) + ", but no earlier DEF has this name", Severity::error);
      return nullptr;
    }
    name = id.text;
    type = next();
  }
  if (type.kind != TokenKind::word || peek() != '{') {
    if (type.kind != TokenKind::end)
      sink_.problems().error(type.location,
                             "expected a node after DEF " + quoted(name) + ", found " + quoted(type.text));
    else
      truncated_ = true;
    back(type);
    return nullptr;
  }
  (void)next();
  auto item = std::make_shared<Item>();
  item->type = &type_of(type);
  item->name = name;
  item->location = type.location;
  item->serial = ++serial_;
  if (!sink_.limits().admits_depth(depth, type.location) || !charge(sizeof(Item) + 64 + name.size(), type.location)) {
    values_.skip_brackets();
    return nullptr;
  }
  parse_body(*item, depth);
  // A node that contains itself is not possible: the name is known only after the node.
  if (!item->name.empty() && charge(item->name.size() + 64, type.location)) names_[item->name] = item;
  return item;
}

void ItemParser::parse_body(Item& item, std::size_t depth) {
  std::vector<FieldRow> own;  // fields that the node declares itself
  while (!stopped_) {
    const Token token = next();
    if (token.kind == TokenKind::close_brace) {
      item.fields.shrink_to_fit();
      item.children.shrink_to_fit();
      return;
    }
    if (token.kind == TokenKind::end) return end_inside(item);
    if (token.kind == TokenKind::unterminated_string) {
      if (!std::exchange(truncated_, true))
        sink_.problems().error(token.location, "unterminated string; expected '\"'");
      return;
    }
    if (token.kind == TokenKind::open_brace) {
      values_.skip_brackets();
      continue;
    }
    if (token.kind == TokenKind::word) {
      parse_member(item, token, depth, own);
      continue;
    }
    if (item.type->kind != ItemClass::ignored && item.type->kind != ItemClass::unknown &&
        token.kind != TokenKind::open_bracket && token.kind != TokenKind::close_bracket)
      report_once(token.location, "expected a field of " + item.type->name + " or '}', found " + quoted(token.text),
                  Severity::error);
  }
}

// Parses a field, a child or another part of a body that begins with a word.
void ItemParser::parse_member(Item& item, const Token& name, std::size_t depth, std::vector<FieldRow>& own) {
  if (name.text == "fields" && peek() == '[') return declare_fields(own);
  if (name.text == "isA" && (peek() == '[' || peek() == '"')) return read_base_types(item);
  if (const FieldRow* const row = item.type->find(name.text)) return parse_field(item, *row, depth);
  for (const FieldRow& row : own)
    if (row.name == name.text) return parse_field(item, keep_row(row.name, row.type), depth);
  if (is_node_start(name)) {
    ItemPtr child = parse_node(name, depth + 1);
    if (!child || !charge(sizeof(ItemPtr), name.location)) return;
    if (item.type->kind == ItemClass::plain || item.type->kind == ItemClass::shape)
      report_once(name.location, item.type->name + " cannot have children; skipped them", Severity::error);
    item.children.push_back(std::move(child));
    return;
  }
  // A part of a nodekit, or a field with a node.
  const Lexer::Position before = lexer_.position();
  const Token value = next();
  const bool is_node = is_node_start(value) || value.text == "NULL";
  lexer_.go_back(before);
  if (is_node && (item.type->kind == ItemClass::kit || item.type->kind == ItemClass::unknown))
    return parse_field(item, keep_row(name.text, {Form::node, 1, false}), depth);
  if (name.text == "=") return parse_connection(depth);
  if (item.type->kind == ItemClass::ignored || item.type->kind == ItemClass::unknown) return;
  skip_field(item, name);
}

void ItemParser::parse_field(Item& item, const FieldRow& row, std::size_t depth) {
  ItemField field;
  field.row = &row;
  if (peek() == '~') {
    (void)next();
    field.ignored = true;
    field.value = row.initial;
  } else if (peek() == '=') {
    field.value = row.initial;
  } else if (row.type.form == Form::node) {
    parse_nodes(field, depth);
  } else {
    field.value = row.initial;
    values_.read(row.type, field.value, row.name);
  }
  if (peek() == '~') {
    (void)next();
    field.ignored = true;
  }
  if (peek() == '=') {
    const Token sign = next();
    if (sign.text == "=") parse_connection(depth);
  }
  if (!charge(sizeof(ItemField), item.location)) return;
  const auto given = std::find_if(item.fields.begin(), item.fields.end(),
                                  [&](const ItemField& earlier) { return earlier.row == &row; });
  if (given == item.fields.end())
    item.fields.push_back(std::move(field));
  else
    *given = std::move(field);
}

// Parses the nodes of a field: one node, NULL, or a list in brackets.
void ItemParser::parse_nodes(ItemField& field, std::size_t depth) {
  field.value = SFNode{};
  const bool bracketed = peek() == '[';
  if (bracketed) (void)next();
  while (!stopped_) {
    const Token token = next();
    if (token.kind == TokenKind::end || (bracketed && token.kind == TokenKind::close_bracket)) return;
    if (token.text == "NULL") {
      if (bracketed) continue;
      return;
    }
    if (!is_node_start(token)) {
      report_once(token.location, "expected a node for " + field.row->name + ", found " + quoted(token.text),
                  Severity::error);
      back(token);
      return;
    }
    if (ItemPtr node = parse_node(token, depth + 1)) field.nodes.push_back(std::move(node));
    if (!bracketed) return;
  }
}

// Parses the source of a connected field after `=`: a node and the name of its output. The field keeps its value.
void ItemParser::parse_connection(std::size_t depth) {
  const Token token = next();
  report_once(token.location, "connections of fields are not followed; connected fields keep their values");
  if (!is_node_start(token)) {
    back(token);
    return;
  }
  const ItemPtr source = parse_node(token, depth + 1);
  (void)source;
  // The output's name: ". name", ".name", or the end of the word after USE.
  if (peek() != '.') return;
  const Token point = next();
  if (point.text == ".") (void)next();
}

// Parses `fields [ SFFloat radius, MFNode parts ]`.
void ItemParser::declare_fields(std::vector<FieldRow>& own) {
  (void)next();
  for (;;) {
    const Token type = next();
    if (type.kind != TokenKind::word) {
      if (type.kind == TokenKind::close_brace) back(type);
      return;
    }
    const Token name = next();
    if (name.kind != TokenKind::word) {
      back(name);
      return;
    }
    const auto value_type = value_type_named(type.text);
    if (value_type && own.size() < kMaxRemembered)
      own.push_back({*value_type, std::string(name.text.substr(0, 200)), initial_of(*value_type)});
  }
}

// Parses `isA [ "Transform", "Node" ]`: the node is treated like the first known type.
void ItemParser::read_base_types(Item& item) {
  FieldValue bases = MFString{};
  values_.read({Form::text, 1, true}, bases, "isA");
  if (item.type->kind != ItemClass::unknown) return;
  for (const String& base : *std::get_if<MFString>(&bases))
    if (const ItemType* const type = find_item_type(base.view())) {
      item.type = type;
      return;
    }
}

// Skips an unknown field with its value.
void ItemParser::skip_field(const Item& item, const Token& name) {
  report_once(name.location, item.type->name + " has no field " + quoted(name.text) + "; skipped");
  if (peek() == '[') {
    (void)next();
    return values_.skip_brackets();
  }
  for (bool first = true;; first = false) {
    const Lexer::Position before = lexer_.position();
    const Token token = next();
    const bool word = first && token.kind == TokenKind::word && !item.type->find(token.text) && !is_node_start(token);
    if (!is_value(token) && !word) {
      lexer_.go_back(before);
      return;
    }
    if (token.text.starts_with('(') && token.text.find(')') == std::string_view::npos)
      for (Token part = next(); part.kind == TokenKind::word && part.text.find(')') == std::string_view::npos;)
        part = next();
    if (word && !is_value(token)) return;
  }
}

}  // namespace gs::vrml::inventor
