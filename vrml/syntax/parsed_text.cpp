#include "vrml/syntax/parsed_text.h"

#include <string>
#include <utility>

namespace gs::vrml {

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

std::optional<AccessType> access_named(std::string_view word, Language language) {
  for (const AccessType access :
       {AccessType::eventIn, AccessType::eventOut, AccessType::field, AccessType::exposedField})
    if (word == name_of(access) || (language == Language::x3d && word == name_of(access, language))) return access;
  return std::nullopt;
}

ParsedText::ParsedText(SceneGraph& scene_graph, Diagnostics& diagnostic_list)
    : scene(scene_graph),
      written(scene_graph.texts().writing()),
      sink(scene_graph, diagnostic_list),
      problems(sink.problems()) {
  frames.emplace_back();
}

void ParsedText::unexpected(const Token& found, const std::string& what) {
  if (found.kind == TokenKind::end && (frames.size() > 1 || std::exchange(end_reported, true))) return;
  if (found.kind == TokenKind::unterminated_string) {
    problems.error(found.location, "unterminated string; expected '\"'");
    end_reported = true;
    return;
  }
  problems.error(found.location, "expected " + what + ", found " + describe(found));
}

void ParsedText::rubbish_token(const Token& token, const std::string& what) {
  if (token.kind == TokenKind::unterminated_string || !std::exchange(rubbish, true)) unexpected(token, what);
  if (frames.back().kind == Frame::Kind::statements || frames.back().kind == Frame::Kind::prototype_body) return;
  if (token.kind == TokenKind::open_bracket || token.kind == TokenKind::open_brace) {
    skip_value();
    frames.back().depth = 1;
  }
}

void ParsedText::refuse(std::string message, SourceLocation location) {
  problems.error(location, std::move(message));
  outcome = ParseOutcome::refused;
}

bool ParsedText::open(Frame frame) {
  if (!sink.limits().admits_depth(frames.size(), frame.start)) {
    Frame skip;
    skip.kind = Frame::Kind::skip;
    skip.start = frame.start;
    // Except for images and url lists, the opening bracket was read just before.
    skip.depth = frame.kind == Frame::Kind::image || frame.kind == Frame::Kind::external_url || frame.single ? 0 : 1;
    frames.push_back(std::move(skip));
    return false;
  }
  frames.push_back(std::move(frame));
  return true;
}

bool ParsedText::out_of_budget() {
  if (!scene.memory().exhausted()) return false;
  end_reported = true;
  return sink.limits().is_exhausted(lexer.location());
}

void ParsedText::skip_value() {
  Frame frame;
  frame.kind = Frame::Kind::skip;
  frame.start = lexer.location();
  frames.push_back(std::move(frame));
}

// Completes the node on top of the stack.
void ParsedText::end_node() {
  const NodeId node = frames.back().node.id;
  frames.pop_back();
  sink.end_node(node);
}

void ParsedText::finish_pending() {
  Frame& frame = frames.back();
  if (!frame.pending) return;
  sink.declare(*frame.declaring, frame.node.id, std::move(*frame.pending));
  frame.pending.reset();
}

void ParsedText::end_body() {
  frames.pop_back();
  sink.end_body();
}

void ParsedText::begin_x3d(int version, SourceLocation location) {
  sink.statements().set_version(version, location);
  lexer.allow_block_comments();
}

void ParsedText::check_name(const Token& name) {
  if (!is_id(name.text))
    problems.warn_once(said_bad_id, name.location,
                       describe(name) + " is not a legal name (VRML97 Annex A.2); accepted");
  check_reserved(name);
}

void ParsedText::check_reserved(const Token& name) {
  const int word = reserved_word(name.text, language());
  if (word < 0 || (said_reserved >> word & 1)) return;
  said_reserved |= std::uint32_t{1} << word;
  problems.warn(name.location, describe(name) + " is a reserved word (" +
                                   (language() == Language::x3d ? "ISO/IEC 19776-2 4.1.2" : "VRML97 4.3.1") +
                                   "); accepted as a name");
}

// Reports the construct that the end of the text truncates, once.
void ParsedText::report_end_inside(const Frame& frame) {
  if (std::exchange(end_reported, true)) return;
  std::string what = "a statement";
  if (frame.kind == Frame::Kind::node_body) what = frame.node.type->name;
  if (frame.kind == Frame::Kind::node_list || frame.kind == Frame::Kind::values ||
      frame.kind == Frame::Kind::image_list)
    what = "a list";
  if (frame.kind == Frame::Kind::image) what = "an image";
  if (frame.kind == Frame::Kind::prototype_body || frame.kind == Frame::Kind::prototype_interface) what = "a PROTO";
  if (frame.kind == Frame::Kind::skip) what = "a skipped part";
  const bool list = frame.kind == Frame::Kind::node_list || frame.kind == Frame::Kind::values ||
                    frame.kind == Frame::Kind::image_list || frame.kind == Frame::Kind::prototype_interface;
  problems.error(lexer.location(), "the file ends inside " + what + " that begins at line " +
                                       std::to_string(frame.start.line) +
                                       (frame.kind == Frame::Kind::image ? ""
                                        : list                           ? "; expected ']'"
                                                                         : "; expected '}'"));
}

ParseOutcome ParsedText::close() {
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

}  // namespace gs::vrml
