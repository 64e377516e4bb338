#include "vrml/syntax/edits/text_edits.h"

#include "vrml/syntax/tokens/lexer.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace gs::vrml {
namespace {

/// Token with its position in the text.
struct Piece {
  TokenKind kind = TokenKind::end;
  std::string_view text;
  std::size_t begin = 0, end = 0;

  [[nodiscard]] bool is(std::string_view word) const { return kind == TokenKind::word && text == word; }
};

/// Part of the text that is replaced.
struct Change {
  std::size_t begin = 0, end = 0;
  std::string text;
};

// Reader of the tokens of a text, from one of its bytes on.
class Reader {
 public:
  Reader(std::string_view text, std::size_t from) : text_(text) {
    lexer_.set_window(text.data() + from, text.data() + text.size(), true);
  }

  Piece next() {
    (void)lexer_.peek();
    const std::size_t begin = offset();
    const Token token = lexer_.next();
    return {token.kind, token.text, begin, offset()};
  }
  // Returns the next token, and stays before it.
  Piece peek() {
    const Lexer::Position here = lexer_.position();
    const Piece piece = next();
    lexer_.go_back(here);
    return piece;
  }
  // Skips the rest of a list or body after its opening brace. Returns its end, or nullopt if it is incomplete.
  std::optional<std::size_t> skip_block() {
    for (std::size_t depth = 1;;) {
      const Piece piece = next();
      if (piece.kind == TokenKind::open_brace || piece.kind == TokenKind::open_bracket) ++depth;
      if (piece.kind == TokenKind::close_brace || piece.kind == TokenKind::close_bracket) --depth;
      if (piece.kind == TokenKind::end || piece.kind == TokenKind::unterminated_string) return std::nullopt;
      if (depth == 0) return piece.end;
    }
  }
  // Skips a value of any type, given its first token. Returns its end, or nullopt if it is malformed.
  std::optional<std::size_t> skip_value(const Piece& first) {
    if (first.kind == TokenKind::string) return first.end;
    if (first.kind == TokenKind::open_bracket) return skip_block();
    if (first.kind != TokenKind::word) return std::nullopt;
    if (first.is("USE")) return next().end;
    if (first.is("DEF")) {
      (void)next();
      return skip_value(next());
    }
    std::size_t end = first.end;
    if (looks_like_number(first.text)) {
      for (Piece piece = peek(); piece.kind == TokenKind::word && looks_like_number(piece.text); piece = peek())
        end = next().end;
      return end;
    }
    if (peek().kind != TokenKind::open_brace) return end;
    (void)next();
    return skip_block();
  }
  // Skips a PROTO or EXTERNPROTO after its keyword. Returns false if it is malformed.
  bool skip_prototype(bool external) {
    (void)next();
    if (next().kind != TokenKind::open_bracket || !skip_block()) return false;
    return skip_value_or_body(external);
  }

 private:
  [[nodiscard]] std::size_t offset() const { return static_cast<std::size_t>(lexer_.unread() - text_.data()); }
  bool skip_value_or_body(bool external) {
    const Piece first = next();
    if (external) return skip_value(first).has_value();
    return first.kind == TokenKind::open_brace && skip_block();
  }

  std::string_view text_;
  Lexer lexer_;
};

bool is_declaration(const Piece& piece) {
  return piece.is("eventIn") || piece.is("eventOut") || piece.is("field") || piece.is("exposedField");
}

class Editor {
 public:
  explicit Editor(std::string_view text) : text_(text), lines_{0} {
    for (std::size_t i = 0; i < text.size(); ++i)
      if (text[i] == '\n' || (text[i] == '\r' && (i + 1 == text.size() || text[i + 1] != '\n')))
        lines_.push_back(i + 1);
  }

  bool add(const TextEdit& edit) {
    if (edit.location.line == 0 || edit.location.line > lines_.size()) return false;
    const std::size_t at = lines_[edit.location.line - 1] + edit.location.column - 1;
    if (at > text_.size()) return false;
    Reader reader(text_, at);
    const Piece name = reader.next();
    if (name.begin != at || !name.is(edit.name)) return false;
    const Piece open = reader.next();
    if (open.kind == TokenKind::open_brace) return edit_node(reader, open, edit);
    return open.kind == TokenKind::open_bracket && edit_prototype(reader, edit);
  }

  std::optional<std::string> result() {
    std::stable_sort(changes_.begin(), changes_.end(),
                     [](const Change& one, const Change& other) { return one.begin < other.begin; });
    std::string out;
    std::size_t at = 0;
    for (const Change& change : changes_) {
      if (change.begin < at) return std::nullopt;
      out.append(text_.substr(at, change.begin - at)).append(change.text);
      at = change.end;
    }
    return out.append(text_.substr(at));
  }

 private:
  bool edit_node(Reader& reader, const Piece& open, const TextEdit& edit) {
    const Piece first = reader.peek();
    for (;;) {
      Piece piece = reader.next();
      if (piece.kind == TokenKind::close_brace) {
        insert(open, first, edit);
        return true;
      }
      if (piece.kind != TokenKind::word) return false;
      if (piece.is("ROUTE")) {
        for (int i = 0; i < 3; ++i) (void)reader.next();
        continue;
      }
      if (piece.is("PROTO") || piece.is("EXTERNPROTO")) {
        if (!reader.skip_prototype(piece.is("EXTERNPROTO"))) return false;
        continue;
      }
      bool has_value = true;
      if (is_declaration(piece)) {
        has_value = piece.is("field") || piece.is("exposedField");
        (void)reader.next();
        piece = reader.next();
      }
      if (reader.peek().is("IS")) {
        (void)reader.next();
        (void)reader.next();
        if (piece.is(edit.field)) return true;
        continue;
      }
      if (!has_value) continue;
      if (edit_value(reader, piece.is(edit.field) ? &edit : nullptr)) return true;
      if (broken_) return false;
    }
  }

  bool edit_prototype(Reader& reader, const TextEdit& edit) {
    if (edit.field.empty()) return reader.skip_block() && edit_value(reader, &edit);
    for (;;) {
      const Piece access = reader.next();
      if (!is_declaration(access)) return false;
      (void)reader.next();
      const Piece name = reader.next();
      if (access.is("eventIn") || access.is("eventOut")) continue;
      if (edit_value(reader, name.is(edit.field) ? &edit : nullptr)) return true;
      if (broken_) return false;
    }
  }

  // Reads a value, and replaces it unless `edit` is null. Returns true if it was replaced.
  bool edit_value(Reader& reader, const TextEdit* edit) {
    const Piece first = reader.next();
    const auto end = reader.skip_value(first);
    broken_ = !end;
    if (!edit || !end) return false;
    changes_.push_back({first.begin, *end, edit->value});
    return true;
  }

  // Adds a field before the first token of a body.
  void insert(const Piece& open, const Piece& first, const TextEdit& edit) {
    const std::string_view blanks = text_.substr(open.end, first.begin - open.end);
    const std::string field = edit.field + " " + edit.value;
    const bool is_empty = first.kind == TokenKind::close_brace;
    const auto line = *std::prev(std::upper_bound(lines_.begin(), lines_.end(), first.begin));
    if (line <= open.end) {
      changes_.push_back({first.begin, first.begin, (blanks.empty() ? " " : "") + field + " "});
      return;
    }
    const std::string indent(text_.substr(line, first.begin - line));
    const std::string end_of_line = text_.substr(0, line).ends_with("\r\n") ? "\r\n" : std::string(1, text_[line - 1]);
    changes_.push_back({first.begin, first.begin, (is_empty ? "  " : "") + field + end_of_line + indent});
  }

  std::string_view text_;
  std::vector<std::size_t> lines_;  // offsets of the starts of lines
  std::vector<Change> changes_;
  bool broken_ = false;  // the last value was malformed
};

}  // namespace

std::optional<std::string> edited_text(std::string_view text, std::span<const TextEdit> edits) {
  Editor editor(text);
  for (const TextEdit& edit : edits)
    if (!editor.add(edit)) return std::nullopt;
  return editor.result();
}

}  // namespace gs::vrml
