#include "vrml/syntax/parsed_text.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>

namespace gs::vrml {
namespace {

constexpr std::size_t kHeaderWindow = 1024;

bool starts_with_ignoring_case(std::string_view text, std::string_view prefix) {
  return text.size() >= prefix.size() && std::equal(prefix.begin(), prefix.end(), text.begin(), [](char a, char b) {
           return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
         });
}

// Reports whether text looks like binary data. If `nul_tells`, a single NUL byte suffices, because no header identifies
// the text.
bool looks_binary(std::string_view text, bool nul_tells) {
  std::size_t odd = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte == 0 && nul_tells) return true;
    if (byte < 0x20 && c != '\t' && c != '\n' && c != '\r' && c != '\f' && c != '\v') ++odd;
  }
  return odd * 20 > text.size();
}

// Returns a header line in lower case, with single blanks.
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

bool ParsedText::is_stopped() {
  constexpr std::uint32_t kBetweenLooks = 4096;
  if (!stopped && ++steps % kBetweenLooks == 0) stopped = scene.budget()->stopped();
  if (stopped) end_reported = true;
  return stopped;
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
  sink.prototypes().declare(*frame.declaring, frame.node.id, std::move(*frame.pending));
  frame.pending.reset();
}

void ParsedText::end_body() {
  frames.pop_back();
  sink.prototypes().end_body();
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
      if (frame.kind == Frame::Kind::prototype_interface) sink.prototypes().end_interface();
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

// ---- First line of a file, which identifies its format

// Reads `#X3D Vn.n utf8`, which other words may follow (ISO/IEC 19776-2 4.2.1).
Step ParsedText::read_x3d_header(std::string_view line, std::string_view text) {
  const SourceLocation top{1, 1};
  if (looks_binary(text, false)) {
    refuse("content after the X3D header is binary; expected UTF-8 text");
    return Step::finished;
  }
  const auto is_digit = [&](std::size_t at) { return at < line.size() && line[at] >= '0' && line[at] <= '9'; };
  const bool exact = line.starts_with("#X3D V") && is_digit(6) && line.substr(7, 1) == "." && is_digit(8) &&
                     line.substr(9, 5) == " utf8" && (line.size() == 14 || line[14] == ' ' || line[14] == '\t');
  constexpr int kLikely = 33;
  int version = kLikely;
  for (std::size_t i = 4; i + 2 < line.size(); ++i)
    if (is_digit(i) && line[i + 1] == '.' && is_digit(i + 2)) {
      version = (line[i] - '0') * 10 + (line[i + 2] - '0');
      break;
    }
  if (!exact)
    problems.warn(top, "expected '#X3D V3.3 utf8' or another version, found " + describe({TokenKind::word, line, top}) +
                           "; read as X3D");
  begin_x3d(version, top);
  return Step::done;
}

Step ParsedText::read_header() {
  const char* begin = lexer.unread();
  const char* end = lexer.window_end();
  if (end - begin >= 3 && std::string_view(begin, 3) == "\xef\xbb\xbf") begin += 3;
  const std::string_view text(begin, std::min<std::size_t>(static_cast<std::size_t>(end - begin), kHeaderWindow));
  // Waits until kHeaderWindow bytes are available, so that the result does not depend on the sizes of the pieces.
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
      refuse("content after the VRML97 header is binary; expected UTF-8 text");
      return Step::finished;
    }
    if (line.substr(0, 15) != "#VRML V2.0 utf8") problems.warn(top, "the header differs from '#VRML V2.0 utf8'");
    return Step::done;
  }
  if (starts_with_ignoring_case(header, "#x3d")) return read_x3d_header(line, text);
  if (starts_with_ignoring_case(header, "<")) {
    refuse("the file is XML or HTML; expected VRML97 ('#VRML V2.0 utf8') or X3D", top);
  } else if (looks_binary(text, true)) {
    refuse("the file is binary; expected text that begins with '#VRML V2.0 utf8'");
  } else if (starts_with_ignoring_case(header, "#vrml")) {
    problems.warn(top,
                  "expected '#VRML V2.0 utf8', found " + describe({TokenKind::word, line, top}) + "; read as VRML97");
  } else {
    headerless = true;
    constexpr int kLikely = 33;
    if (headerless_language == Language::x3d) begin_x3d(kLikely, top);
  }
  return outcome == ParseOutcome::refused ? Step::finished : Step::done;
}

void ParsedText::read_fragment_header(std::string_view text) {
  header_read = true;
  while (!text.empty() && (text.front() == ' ' || text.front() == '\n' || text.front() == '\r' || text.front() == '\t'))
    text.remove_prefix(1);
  if (starts_with_ignoring_case(text, "#vrml")) {
    constexpr int kVrml97 = 20;
    written.set_language(Language::vrml97, kVrml97);
  } else if (starts_with_ignoring_case(text, "#x3d")) {
    (void)read_x3d_header(text.substr(0, text.find_first_of("\r\n")), {});
  } else if (language() == Language::x3d) {
    lexer.allow_block_comments();
  }
}

}  // namespace gs::vrml
