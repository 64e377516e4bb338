#include "vrml/syntax/parser.h"

#include "vrml/syntax/statement_parser.h"

#include <algorithm>
#include <string>
#include <utility>

namespace gs::vrml {
namespace {

// Maximum bytes of a truncated statement that every new piece reads again. A longer statement is read again only after
// 1/kRetryGrowth more was received. Thus a hostile sender of single bytes costs only a bounded multiple of the text.
constexpr std::size_t kEagerRetry = 64 * 1024;
constexpr std::size_t kRetryGrowth = 8;
// Maximum bytes of a new piece that are joined to the rest of the previous piece.
constexpr std::size_t kJoin = 4096;

ParseOutcome read_whole(Grammar grammar, std::string_view text, SceneGraph& scene, Diagnostics& diagnostics) {
  const std::unique_ptr<SceneReader> reader = make_reader(grammar, scene, diagnostics);
  reader->push(text);
  return reader->finish();
}

}  // namespace

struct Parser::State {
  State(SceneGraph& scene, Diagnostics& diagnostics) : text(scene, diagnostics), statements(text) {}
  void run(const char* begin, const char* end, bool last);

  ParsedText text;
  StatementParser statements;
  std::string carry;           // received bytes that are not complete enough to use
  std::size_t retry_size = 0;  // size of `carry` at which it is read again
};

void Parser::State::run(const char* begin, const char* end, bool last) {
  text.lexer.set_window(begin, end, last);
  while (text.outcome != ParseOutcome::refused && !text.out_of_budget() && !text.is_stopped()) {
    const Lexer::Position start = text.lexer.position();
    const Step result = text.header_read ? statements.step() : text.read_header();
    if (result == Step::done) continue;
    if (result == Step::need_more) text.lexer.go_back(start);
    return;
  }
}

Parser::Parser(SceneGraph& scene, Diagnostics& diagnostics) : state_(std::make_unique<State>(scene, diagnostics)) {}
Parser::~Parser() = default;

void Parser::set_headerless_language(Language language) { state_->text.headerless_language = language; }

// Joins the unused bytes with bytes of the next piece until they are complete. Reads the rest of the piece in place.
void Parser::push(std::string_view piece) {
  State& s = *state_;
  while (!piece.empty() && s.text.outcome != ParseOutcome::refused) {
    if (s.text.out_of_budget()) {
      s.carry = {};
      return;
    }
    if (s.carry.empty()) {
      s.run(piece.data(), piece.data() + piece.size(), false);
      s.carry.assign(s.text.lexer.unread(), s.text.lexer.window_end());
      piece = {};
    } else {
      const std::size_t old_size = s.carry.size();
      const std::size_t joined = std::min(piece.size(), std::max(kJoin, old_size / kRetryGrowth));
      s.carry.append(piece.substr(0, joined));
      if (s.carry.size() < s.retry_size) {
        piece.remove_prefix(joined);
        continue;
      }
      const std::string window = std::exchange(s.carry, {});
      s.run(window.data(), window.data() + window.size(), false);
      const auto used = static_cast<std::size_t>(s.text.lexer.unread() - window.data());
      if (used >= old_size) {
        piece.remove_prefix(used - old_size);
      } else {
        s.carry = window.substr(used);
        piece.remove_prefix(joined);
      }
      // The window is invalid now. The lexer continues in the next one at the same position in the text.
      s.text.lexer.set_window(s.carry.data(), s.carry.data() + s.carry.size(), false);
      s.retry_size = s.carry.size() < kEagerRetry ? 0 : s.carry.size() + s.carry.size() / kRetryGrowth;
      continue;
    }
    s.text.lexer.set_window(s.carry.data(), s.carry.data() + s.carry.size(), false);
    s.retry_size = s.carry.size() < kEagerRetry ? 0 : s.carry.size() + s.carry.size() / kRetryGrowth;
  }
}

std::vector<NodeId> Parser::open_nodes() const {
  std::vector<NodeId> nodes;
  for (const Frame& frame : state_->text.frames)
    if (frame.kind == Frame::Kind::node_body) nodes.push_back(frame.node.id);
  return nodes;
}

ParseOutcome Parser::finish() {
  State& s = *state_;
  const std::string window = std::exchange(s.carry, {});
  s.run(window.data(), window.data() + window.size(), true);
  return s.text.close();
}

ParseOutcome Parser::parse_whole(std::string_view text) {
  // Replaces a null window, because the lexer takes it for no window yet.
  if (text.data() == nullptr) text = "";
  state_->run(text.data(), text.data() + text.size(), true);
  return state_->text.close();
}

// A header in the text only selects the language. Otherwise it is a comment.
ParseOutcome Parser::parse_fragment(std::string_view text) {
  state_->text.read_fragment_header(text);
  return parse_whole(text);
}

bool parse_interface(std::string_view text, NodeType& type) {
  SceneGraph scene("node table");
  Diagnostics diagnostics;
  return Parser(scene, diagnostics).read_interface(text, type) && diagnostics.errors() == 0;
}

bool Parser::read_interface(std::string_view text, NodeType& type) {
  const std::string whole = std::string(text) + "\n]";
  state_->text.header_read = state_->text.table_text = true;
  Frame frame;
  frame.kind = Frame::Kind::prototype_interface;
  frame.declaring = &type;
  state_->text.frames.push_back(std::move(frame));
  state_->run(whole.data(), whole.data() + whole.size(), true);
  return state_->text.lexer.unread() == whole.data() + whole.size();
}

RunTimeNodes read_into(SceneGraph& scene, std::string file_name, std::string_view text, Diagnostics& diagnostics,
                       const SourceText* written_by, std::shared_ptr<const TextSource> fetched_from) {
  const RunTimeText written(scene, std::move(file_name), written_by ? *written_by : scene, std::move(fetched_from));
  const Grammar grammar = grammar_of(text);
  const bool has_parser = grammar == Grammar::vrml97 || grammar == Grammar::x3d_classic;
  const ParseOutcome outcome =
      has_parser ? Parser(scene, diagnostics).parse_fragment(text) : read_whole(grammar, text, scene, diagnostics);
  return {written.text().roots(), outcome};
}

ParseOutcome parse(std::string_view text, SceneGraph& scene, Diagnostics& diagnostics) {
  const Grammar grammar = grammar_of(text);
  if (grammar == Grammar::vrml97 || grammar == Grammar::x3d_classic)
    return Parser(scene, diagnostics).parse_whole(text);
  return read_whole(grammar, text, scene, diagnostics);
}

}  // namespace gs::vrml
