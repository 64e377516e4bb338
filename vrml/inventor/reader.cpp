#include "vrml/inventor/reader.h"

#include "base/budget.h"
#include "base/text.h"
#include "vrml/inventor/converter.h"
#include "vrml/inventor/item_parser.h"
#include "vrml/inventor/output/sharing.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

namespace gs::vrml::inventor {
namespace {

constexpr std::size_t kHeaderWindow = 256;

/// Scanner that finds the ends of nodes at the top level. Recognizes only braces, strings and comments, as Lexer does.
class RootScanner {
 public:
  /// Scans the text from the end of the last scan on. Returns the size of the text up to the next end of a node at the
  /// top level, or nullopt if more text is needed.
  std::optional<std::size_t> scan(std::string_view text) {
    for (; next_ < text.size(); ++next_) {
      const char c = text[next_];
      if (in_comment_) {
        in_comment_ = c != '\n' && c != '\r';
      } else if (in_string_) {
        if (c == '\\')
          escaped_ = !escaped_;
        else if (!std::exchange(escaped_, false) && c == '"')
          in_string_ = false;
      } else if (c == '#') {
        // In numbers such as 1.#QNAN, the mark does not begin a comment.
        const bool after_point = next_ > 0 && text[next_ - 1] == '.';
        if (after_point && next_ + 1 == text.size()) return std::nullopt;
        in_comment_ = !after_point || std::string_view("QIS").find(text[next_ + 1]) == std::string_view::npos;
      } else if (c == '"') {
        in_string_ = true;
      } else if (c == '{') {
        ++depth_;
      } else if (c == '}' && depth_ > 0 && --depth_ == 0) {
        return ++next_;
      }
    }
    return std::nullopt;
  }
  /// Forgets the first bytes of the text.
  void drop(std::size_t bytes) { next_ -= bytes; }

 private:
  std::size_t next_ = 0, depth_ = 0;
  bool in_comment_ = false, in_string_ = false, escaped_ = false;
};

std::string_view header_of(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return text.substr(0, std::min(text.find_first_of("\r\n"), kHeaderWindow));
}

}  // namespace

struct Reader::State {
  State(SceneGraph& scene, Diagnostics& diagnostics)
      : sink(scene, diagnostics), parser(sink), converter(sink), share(scene.budget(), Resource::files) {}

  bool read_header(bool last);
  void read(std::string_view window, bool last);

  SceneSink sink;
  ItemParser parser;
  Converter converter;
  RootScanner scanner;
  std::string text;  // received bytes that were not parsed
  Share share;       // of `text`
  bool header_read = false, refused = false, full = false;
};

// Reads the first line. Returns false if more bytes are needed, or if the text is refused.
bool Reader::State::read_header(bool last) {
  if (header_read) return true;
  const std::string_view header = header_of(text);
  const bool is_line = text.find_first_of("\r\n") != std::string::npos;
  if (!is_line && text.size() < kHeaderWindow + 3 && !last) return false;
  header_read = true;
  const std::string name = lower_case(header);
  if (name.starts_with("#inventor") && name.find("binary") != std::string::npos) {
    sink.problems().error({1, 1},
                          "binary Inventor cannot be read; convert it to ASCII with 'ivcat -o OUT.iv IN.iv' or with "
                          "another program that uses Coin or Inventor");
    refused = true;
    return false;
  }
  // Since Inventor 2.1, shapes without hints have no smooth edges.
  if (name.starts_with("#inventor v2.1")) converter.set_crease_angle(0);
  return true;
}

// Parses and converts bytes of the text that end at the end of a node or of the text.
void Reader::State::read(std::string_view window, bool last) {
  parser.set_window(window, last);
  while (const ItemPtr item = parser.next_root()) {
    converter.convert(*item, parser.count());
    if (!converter.may_go_on(item->location)) {
      full = true;
      return;
    }
  }
}

Reader::Reader(SceneGraph& scene, Diagnostics& diagnostics) : state_(std::make_unique<State>(scene, diagnostics)) {}
Reader::~Reader() = default;

void Reader::push(std::string_view piece) {
  State& s = *state_;
  if (s.refused || s.full) return;
  if (!s.share.grow(piece.size())) {
    s.sink.problems().error({}, s.sink.scene().budget()->refusal(Resource::files) + "; skipped the rest");
    s.full = true;
    return;
  }
  s.text.append(piece);
  if (!s.read_header(false)) return;
  // Each node at the top level is a window, so that the result does not depend on the sizes of the pieces.
  std::size_t done = 0;
  while (const auto end = s.scanner.scan(s.text)) {
    s.read(std::string_view(s.text).substr(done, *end - done), false);
    done = *end;
    if (s.full) return;
  }
  if (done == 0) return;
  // The lexer continues with the rest, and needs both windows to keep its line number.
  std::string rest = s.text.substr(done);
  s.parser.set_window(rest, false);
  s.text.swap(rest);
  s.parser.set_window(s.text, false);
  s.scanner.drop(done);
  s.share.shrink_to(s.text.size());
}

ParseOutcome Reader::finish() {
  State& s = *state_;
  if (!s.refused && !s.full && s.read_header(true)) s.read(s.text, true);
  if (s.refused) return ParseOutcome::refused;
  s.sink.finish();
  share_equal_nodes(s.sink.scene());
  return s.full || s.parser.is_truncated() || s.sink.scene().memory().exhausted() ? ParseOutcome::truncated
                                                                                  : ParseOutcome::complete;
}

}  // namespace gs::vrml::inventor
