#include "vrml/syntax/parser.h"

#include "vrml/syntax/parser_state.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>

namespace gs::vrml {
namespace {

constexpr std::size_t kHeaderWindow = 1024;
// A statement that exceeds the received bytes is retried only after this fraction more was received. A hostile sender
// of single bytes thus costs a bounded multiple of the text.
constexpr std::size_t kEagerRetry = 64 * 1024;
constexpr std::size_t kRetryGrowth = 8;
// Bytes of a new piece that are joined to the rest of the previous one.
constexpr std::size_t kJoin = 4096;

bool starts_with_ignoring_case(std::string_view text, std::string_view prefix) {
  return text.size() >= prefix.size() && std::equal(prefix.begin(), prefix.end(), text.begin(), [](char a, char b) {
           return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
         });
}

// Detects binary data. With `nul_tells`, a single NUL byte suffices; used if no header identifies the text.
bool looks_binary(std::string_view text, bool nul_tells) {
  std::size_t odd = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte == 0 && nul_tells) return true;
    if (byte < 0x20 && c != '\t' && c != '\n' && c != '\r' && c != '\f' && c != '\v') ++odd;
  }
  return odd * 20 > text.size();
}

// Normalizes the header: collapses blanks and converts to lower case.
std::string normalised(std::string_view line) {
  std::string out;
  for (const char c : line) {
    const bool is_blank = c == ' ' || c == '\t';
    if (is_blank && (out.empty() || out.back() == ' ')) continue;
    out += is_blank ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out;
}

}  // namespace

std::string describe(const Token& token) {
  switch (token.kind) {
    case TokenKind::end:
      return "the end of the file";
    case TokenKind::string:
      return "a string";
    case TokenKind::unterminated_string:
      return "an unterminated string";
    case TokenKind::bad:
      if (token.text.size() == 1) {
        const auto byte = static_cast<unsigned char>(token.text.front());
        if (byte < 0x20 || byte == 0x7f) return "byte " + std::to_string(byte);
      }
      break;
    default:
      break;
  }
  return quoted(token.text);
}

Parser::State::State(SceneGraph& scene_graph, Diagnostics& diagnostic_list)
    : scene(scene_graph), sink(scene_graph, diagnostic_list), problems(sink.problems()) {
  frames.emplace_back();
}

void Parser::State::unexpected(const Token& found, const std::string& what) {
  if (found.kind == TokenKind::end && (frames.size() > 1 || std::exchange(end_reported, true))) return;
  if (found.kind == TokenKind::unterminated_string) {
    problems.error(found.location, "unterminated string; expected '\"'");
    end_reported = true;
    return;
  }
  problems.error(found.location, "expected " + what + ", found " + describe(found));
}

void Parser::State::rubbish_token(const Token& token, const std::string& what) {
  if (token.kind == TokenKind::unterminated_string || !std::exchange(rubbish, true)) unexpected(token, what);
  if (frames.back().kind == Frame::Kind::statements || frames.back().kind == Frame::Kind::prototype_body) return;
  if (token.kind == TokenKind::open_bracket || token.kind == TokenKind::open_brace) {
    skip_value();
    frames.back().depth = 1;
  }
}

void Parser::State::refuse(std::string message, SourceLocation location) {
  problems.error(location, std::move(message));
  outcome = ParseOutcome::refused;
}

bool Parser::State::open(Frame frame) {
  if (!sink.limits().admits_depth(frames.size(), frame.start)) {
    Frame skip;
    skip.kind = Frame::Kind::skip;
    skip.start = frame.start;
    // Every construct except the pixels of an image has just read its opening bracket.
    skip.depth = frame.kind == Frame::Kind::image || frame.kind == Frame::Kind::external_url ? 0 : 1;
    frames.push_back(std::move(skip));
    return false;
  }
  frames.push_back(std::move(frame));
  return true;
}

Step Parser::State::read_header() {
  const char* begin = lexer.unread();
  const char* end = lexer.window_end();
  if (end - begin >= 3 && std::string_view(begin, 3) == "\xef\xbb\xbf") begin += 3;
  const std::string_view text(begin, std::min<std::size_t>(static_cast<std::size_t>(end - begin), kHeaderWindow));
  // Always examines the same bytes, whatever the sizes of the pieces.
  if (text.size() < kHeaderWindow && !lexer.is_last_window()) return Step::need_more;
  header_read = true;
  if (text.empty()) {
    refuse("the file is empty; expected VRML97 text, '#VRML V2.0 utf8' on its first line");
    return Step::finished;
  }
  lexer.advance(begin, 0, nullptr);
  const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
  const std::string header = normalised(line);
  const SourceLocation top{1, 1};
  if (starts_with_ignoring_case(header, "#vrml v2.0 utf8")) {
    if (looks_binary(text, false)) {
      refuse("a binary file behind a VRML97 header; expected UTF-8 text");
      return Step::finished;
    }
    if (line.substr(0, 15) != "#VRML V2.0 utf8") problems.warn(top, "the header differs from '#VRML V2.0 utf8'");
    return Step::done;
  }
  if (starts_with_ignoring_case(header, "#vrml v1.0")) {
    refuse("a VRML 1.0 file; expected VRML97 ('#VRML V2.0 utf8')", top);
  } else if (starts_with_ignoring_case(header, "#x3d")) {
    refuse("an X3D file in classic encoding; expected VRML97 ('#VRML V2.0 utf8')", top);
  } else if (starts_with_ignoring_case(header, "#inventor")) {
    refuse("an Open Inventor file; expected VRML97 ('#VRML V2.0 utf8')", top);
  } else if (starts_with_ignoring_case(header, "<")) {
    refuse(text.find("X3D") != std::string_view::npos
               ? "an X3D file in XML encoding; expected VRML97 ('#VRML V2.0 utf8')"
               : "an XML or HTML file; expected VRML97 ('#VRML V2.0 utf8')",
           top);
  } else if (looks_binary(text, true)) {
    refuse("a binary file; expected VRML97 text, '#VRML V2.0 utf8' on its first line");
  } else if (starts_with_ignoring_case(header, "#vrml")) {
    problems.warn(top,
                  "expected '#VRML V2.0 utf8', found " + describe({TokenKind::word, line, top}) + "; read as VRML97");
  } else {
    headerless = true;
  }
  return outcome == ParseOutcome::refused ? Step::finished : Step::done;
}

bool Parser::State::out_of_budget() {
  if (!scene.exhausted()) return false;
  end_reported = true;
  return sink.limits().is_exhausted(lexer.location());
}

Step Parser::State::step() {
  if (outcome == ParseOutcome::refused || out_of_budget()) return Step::finished;
  if (!header_read) return read_header();
  switch (frames.back().kind) {
    case Frame::Kind::statements:
    case Frame::Kind::prototype_body:
      return statement_step();
    case Frame::Kind::prototype_interface:
      return interface_step();
    case Frame::Kind::external_url:
      return external_url_step();
    case Frame::Kind::node_body:
      return node_body_step();
    case Frame::Kind::node_list:
      return node_list_step();
    case Frame::Kind::values:
      return values_step();
    case Frame::Kind::image:
      return image_step();
    case Frame::Kind::skip:
      return skip_step();
  }
  return Step::finished;
}

void Parser::State::run(const char* begin, const char* end, bool last) {
  lexer.set_window(begin, end, last);
  for (;;) {
    const Lexer::Position start = lexer.position();
    const Step result = step();
    if (result == Step::done) continue;
    if (result == Step::need_more) lexer.go_back(start);
    return;
  }
}

// Reports once the construct that the end of the text truncates.
void Parser::State::report_end_inside(const Frame& frame) {
  if (std::exchange(end_reported, true)) return;
  std::string what = "a statement";
  if (frame.kind == Frame::Kind::node_body) what = frame.node.type->name;
  if (frame.kind == Frame::Kind::node_list || frame.kind == Frame::Kind::values) what = "a list";
  if (frame.kind == Frame::Kind::image) what = "an image";
  if (frame.kind == Frame::Kind::prototype_body || frame.kind == Frame::Kind::prototype_interface) what = "a PROTO";
  if (frame.kind == Frame::Kind::skip) what = "a skipped part";
  const bool list = frame.kind == Frame::Kind::node_list || frame.kind == Frame::Kind::values ||
                    frame.kind == Frame::Kind::prototype_interface;
  problems.error(lexer.location(), "the file ends inside " + what + " that begins at line " +
                                       std::to_string(frame.start.line) +
                                       (frame.kind == Frame::Kind::image ? ""
                                        : list                           ? "; expected ']'"
                                                                         : "; expected '}'"));
}

ParseOutcome Parser::State::close() {
  if (outcome == ParseOutcome::refused) return outcome;
  (void)out_of_budget();
  if (frames.size() > 1) {
    report_end_inside(frames.back());
    while (frames.size() > 1) {
      Frame& frame = frames.back();
      if (frame.kind == Frame::Kind::node_body) {
        finish_pending();
        end_node();
        continue;
      }
      if (frame.kind == Frame::Kind::prototype_interface) sink.end_interface();
      if (frame.kind == Frame::Kind::prototype_body) {
        end_body();
        continue;
      }
      frames.pop_back();
    }
  }
  sink.finish();
  if (!anything_read && headerless)
    refuse("the file has no content; expected VRML97 text, '#VRML V2.0 utf8' on its first line");
  if (outcome != ParseOutcome::refused && end_reported) outcome = ParseOutcome::truncated;
  return outcome;
}

Parser::Parser(SceneGraph& scene, Diagnostics& diagnostics) : state_(std::make_unique<State>(scene, diagnostics)) {}
Parser::~Parser() = default;

// Joins the unused bytes with just enough of the next piece to use them; reads the rest of the piece in place.
void Parser::push(std::string_view piece) {
  State& s = *state_;
  while (!piece.empty() && s.outcome != ParseOutcome::refused) {
    if (s.out_of_budget()) {
      s.carry = {};
      return;
    }
    if (s.carry.empty()) {
      s.run(piece.data(), piece.data() + piece.size(), false);
      s.carry.assign(s.lexer.unread(), s.lexer.window_end());
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
      const auto used = static_cast<std::size_t>(s.lexer.unread() - window.data());
      if (used >= old_size) {
        piece.remove_prefix(used - old_size);
      } else {
        s.carry = window.substr(used);
        piece.remove_prefix(joined);
      }
      // The window becomes invalid; the lexer continues at the same text position in the next one.
      s.lexer.set_window(s.carry.data(), s.carry.data() + s.carry.size(), false);
      s.retry_size = s.carry.size() < kEagerRetry ? 0 : s.carry.size() + s.carry.size() / kRetryGrowth;
      continue;
    }
    s.lexer.set_window(s.carry.data(), s.carry.data() + s.carry.size(), false);
    s.retry_size = s.carry.size() < kEagerRetry ? 0 : s.carry.size() + s.carry.size() / kRetryGrowth;
  }
}

std::vector<NodeId> Parser::open_nodes() const {
  std::vector<NodeId> nodes;
  for (const Frame& frame : state_->frames)
    if (frame.kind == Frame::Kind::node_body) nodes.push_back(frame.node.id);
  return nodes;
}

ParseOutcome Parser::finish() {
  State& s = *state_;
  const std::string window = std::exchange(s.carry, {});
  s.run(window.data(), window.data() + window.size(), true);
  return s.close();
}

ParseOutcome Parser::parse_whole(std::string_view text) {
  // A null window means "none yet" to the lexer.
  if (text.data() == nullptr) text = "";
  state_->run(text.data(), text.data() + text.size(), true);
  return state_->close();
}

// Here the header is just a comment.
ParseOutcome Parser::parse_fragment(std::string_view text) {
  state_->header_read = true;
  return parse_whole(text);
}

bool parse_interface(std::string_view text, NodeType& type) {
  SceneGraph scene("node table");
  Diagnostics diagnostics;
  return Parser(scene, diagnostics).read_interface(text, type) && diagnostics.errors() == 0;
}

bool Parser::read_interface(std::string_view text, NodeType& type) {
  const std::string whole = std::string(text) + "\n]";
  state_->header_read = state_->table_text = true;
  Frame frame;
  frame.kind = Frame::Kind::prototype_interface;
  frame.declaring = &type;
  state_->frames.push_back(std::move(frame));
  state_->run(whole.data(), whole.data() + whole.size(), true);
  return state_->lexer.unread() == whole.data() + whole.size();
}

RunTimeNodes read_into(SceneGraph& scene, std::string file_name, std::string_view text, Diagnostics& diagnostics,
                       const SourceText* written_by, std::shared_ptr<const TextSource> fetched_from) {
  const RunTimeText written(scene, std::move(file_name), written_by ? *written_by : scene, std::move(fetched_from));
  Parser parser(scene, diagnostics);
  const ParseOutcome outcome = parser.parse_fragment(text);
  return {written.text().roots(), outcome};
}

ParseOutcome parse(std::string_view text, SceneGraph& scene, Diagnostics& diagnostics) {
  return Parser(scene, diagnostics).parse_whole(text);
}

}  // namespace gs::vrml
