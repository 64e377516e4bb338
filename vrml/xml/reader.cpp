#include "vrml/xml/reader.h"

#include "vrml/syntax/tokens/text_pieces.h"
#include "vrml/x3d/element_builder.h"
#include "vrml/xml/expat_parser.h"
#include "vrml/xml/markup.h"
#include "vrml/xml/open_elements.h"
#include "vrml/xml/text_decoder.h"

#include <string>
#include <utility>

namespace gs::vrml::xml {
namespace {

// Maximum bytes of incomplete markup at the end of a file that Expat examines for its error.
constexpr std::size_t kMaxRest = 4096;

std::string_view without_prefix(std::string_view name) { return name.substr(name.rfind(':') + 1); }

bool is_blank(char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; }

bool is_blank(std::string_view text) { return text.find_first_not_of(" \t\r\n") == std::string_view::npos; }

// Appends a value with blanks instead of tabs and line breaks (XML 1.0 2.11, 3.3.3). Returns the result, which is valid
// as long as `out` has capacity.
std::string_view append_without_breaks(std::string_view value, std::string& out) {
  const std::size_t begin = out.size();
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (value[i] == '\n' && i > 0 && value[i - 1] == '\r') continue;
    out += is_blank(value[i]) ? ' ' : value[i];
  }
  return std::string_view(out).substr(begin);
}

// Moves the position in a tag, as location and offset, from the start of a value to its end if it is long.
void pass_long_value(const AttributeSpan& span, SourceLocation& location, std::size_t& offset) {
  if (!span.is_long) return;
  location.line += span.lines;
  location.column = static_cast<std::uint32_t>(span.lines > 0 ? span.end - span.line_start + 1
                                                              : location.column + (span.end - span.begin));
  offset = span.end;
}

}  // namespace

struct Reader::State {
  State(SceneGraph& scene, Diagnostics& diagnostics)
      : sink(scene, diagnostics),
        values(sink),
        builder(sink),
        expat(scene.budget(), {[this](std::string_view name, const char** given) { begin_in_expat(name, given); },
                               [this] { end_in_expat(); }, [this](std::string_view text) { take_text(text); }}),
        pieces(scene.budget()) {}

  void feed(std::string_view text);
  void close();
  std::size_t scan(std::string_view text);
  std::size_t pass_blanks(std::string_view text);
  void take(const Markup& markup);
  void take_tag(std::string_view tag);
  void take_plain(std::string_view tag);
  void take_end(std::string_view tag);
  void give_text(std::string_view text);
  void read_plain_attributes();
  void begin_in_expat(std::string_view name, const char** given);
  void end_in_expat();
  void give(std::string_view text, bool last);
  void fail(const std::string& problem);
  void refuse(const std::string& problem, SourceLocation location);
  void begin(std::string_view name);
  void take_text(std::string_view text);
  void read_attributes(const char** given);
  void pass(std::string_view text);
  [[nodiscard]] std::string_view valid_text(std::string_view text);

  SceneSink sink;
  x3d::ValueReader values;
  x3d::ElementBuilder builder;
  ExpatParser expat;
  TextDecoder decoder;
  MarkupScanner scanner;
  OpenElements elements;
  std::vector<x3d::Attribute> attributes;  // of the element that begins
  TextPieces pieces;
  std::string_view tag;             // tag that Expat reads
  std::size_t located = 0;          // offset in `tag` that `location` belongs to
  std::string skeleton, converted;  // parts of `tag` for Expat
  std::string without_breaks;       // values of `tag` with blanks instead of line breaks
  SourceLocation location{1, 1};    // of the next byte, or in `tag`
  SourceLocation markup_location;   // of the markup that is read
  bool is_one_line = false;         // the plain tag `tag` has no line breaks
  bool all_in_expat = false;        // a document type declaration may change the meaning of tags
  bool is_mismatched = false;       // the tag that Expat reads ends another element than the innermost one
  bool stopped = false, said_latin1 = false, said_encoding = false;
  ParseOutcome outcome = ParseOutcome::complete;
};

void Reader::State::refuse(const std::string& problem, SourceLocation where) {
  sink.problems().error(where, problem);
  outcome = ParseOutcome::refused;
  stopped = true;
}

// Reports an error of the text, which ends reading.
void Reader::State::fail(const std::string& problem) {
  if (std::exchange(stopped, true)) return;
  outcome = ParseOutcome::truncated;
  if (expat.is_out_of_memory())
    sink.problems().error(markup_location,
                          sink.scene().budget()->refusal(Resource::nodes) + "; skipped the rest of the file");
  else
    sink.problems().error(markup_location, problem + "; skipped the rest of the file");
}

// Moves `location` past a text.
void Reader::State::pass(std::string_view text) {
  location = x3d::location_in(text, location, text.data() + text.size());
}

// Returns the text as valid UTF-8: reads other bytes as windows-1252.
std::string_view Reader::State::valid_text(std::string_view text) {
  if (is_utf8(text)) return text;
  sink.problems().warn_once(said_latin1, markup_location, "the text is not UTF-8; read as windows-1252");
  converted.clear();
  append_latin1(converted, text);
  return converted;
}

void Reader::State::give(std::string_view text, bool last) {
  if (!expat.parse(valid_text(text), last)) fail("not well-formed XML: " + expat.error());
}

void Reader::State::read_attributes(const char** given) {
  attributes.clear();
  const std::vector<AttributeSpan>& spans = scanner.attributes();
  SourceLocation at = location;
  std::size_t from = located;
  for (std::size_t i = 0; given[2 * i]; ++i) {
    x3d::Attribute attribute{given[2 * i], given[2 * i + 1], at};
    if (!tag.empty() && i < spans.size()) {
      attribute.location = at = x3d::location_in(tag.substr(from), at, tag.data() + spans[i].begin);
      from = spans[i].begin;
      pass_long_value(spans[i], at, from);
      if (spans[i].is_long) attribute.value = tag.substr(spans[i].begin, spans[i].end - spans[i].begin);
    }
    attributes.push_back(attribute);
  }
  located = from;
  location = at;
}

// Reads the attributes of a plain tag.
void Reader::State::read_plain_attributes() {
  attributes.clear();
  without_breaks.clear();
  is_one_line = !scanner.has_long_values() && tag.find('\n') == std::string_view::npos;
  std::size_t broken = 0;  // bytes of the values with line breaks
  for (const AttributeSpan& span : scanner.attributes()) broken += span.has_breaks ? span.end - span.begin : 0;
  without_breaks.reserve(broken);
  for (const AttributeSpan& span : scanner.attributes()) {
    x3d::Attribute attribute;
    attribute.name = tag.substr(span.name_begin, span.name_end - span.name_begin);
    attribute.value = tag.substr(span.begin, span.end - span.begin);
    if (is_one_line) {
      attribute.location = {location.line, location.column + static_cast<std::uint32_t>(span.begin)};
    } else {
      attribute.location = location = x3d::location_in(tag.substr(located), location, tag.data() + span.begin);
      located = span.begin;
      pass_long_value(span, location, located);
    }
    if (span.has_breaks) attribute.value = append_without_breaks(attribute.value, without_breaks);
    attributes.push_back(attribute);
  }
}

void Reader::State::begin(std::string_view name) {
  if (builder.depth() > 2 * sink.scene().limits().nesting) {
    fail("more than " + std::to_string(builder.depth()) + " nested elements");
    return expat.stop();
  }
  const SourceName element{without_prefix(name), markup_location};
  if (builder.depth() == 0 && x3d::kind_of(element.text) != x3d::ElementKind::x3d &&
      x3d::kind_of(element.text) != x3d::ElementKind::scene) {
    refuse("root element is " + quoted(name) + "; expected X3D", markup_location);
    return expat.stop();
  }
  builder.begin(element, attributes);
  for (const x3d::Attribute& attribute : attributes) {
    FieldValue* const value = builder.value_of({attribute.name, attribute.location});
    if (!value) continue;
    values.read({attribute.value, attribute.location, attribute.name}, *value);
    builder.value_given();
  }
}

void Reader::State::begin_in_expat(std::string_view name, const char** given) {
  if (stopped) return;
  elements.open_in_expat();
  read_attributes(given);
  begin(name);
}

// After stop(), Expat still reports the end of an empty element.
void Reader::State::end_in_expat() {
  if (stopped || is_mismatched) return;
  elements.close();
  builder.end();
}

void Reader::State::take_text(std::string_view text) {
  if (!stopped && builder.takes_text()) builder.text(text, markup_location);
}

// Reads a start tag or an empty element without Expat.
void Reader::State::take_plain(std::string_view text) {
  tag = text;
  read_plain_attributes();
  elements.open(scanner.name(text));
  begin(scanner.name(text));
  if (is_one_line)
    location.column += static_cast<std::uint32_t>(tag.size());
  else
    pass(tag.substr(located));
  located = tag.size();
  if (!stopped && MarkupScanner::is_empty_element(text)) {
    elements.close();
    builder.end();
  }
  tag = {};
}

// Reads the end tag of an element that Expat has not seen.
void Reader::State::take_end(std::string_view text) {
  const bool is_match = scanner.is_plain() && scanner.name(text) == elements.name();
  if (is_match) {
    elements.close();
    return builder.end();
  }
  is_mismatched = true;
  if (!scanner.is_plain()) give(text, false);
  if (!stopped) fail("not well-formed XML: " + ExpatParser::mismatch_error());
}

// Passes the root element and each tag that is not plain to Expat, which checks references and the context of tags.
void Reader::State::take_tag(std::string_view text) {
  const bool is_end = MarkupScanner::is_end_tag(text);
  if (!elements.empty() && !all_in_expat) {
    if (is_end && !elements.is_in_expat()) return take_end(text);
    if (!is_end && scanner.is_plain()) return take_plain(text);
  }
  tag = text;
  if (scanner.has_long_values()) {
    skeleton.clear();
    scanner.append_skeleton(text, skeleton);
    text = skeleton;
  }
  give(text, false);
  tag = {};
}

// Reads the text in an element. The comment after it makes Expat report all of it, or its error, before the next tag.
void Reader::State::give_text(std::string_view text) {
  give(text, false);
  pass(text);
  located = text.size();
  markup_location = location;
  if (!stopped) give("<!---->", false);
}

void Reader::State::take(const Markup& markup) {
  markup_location = location;
  located = 0;
  switch (markup.kind) {
    case MarkupKind::tag:
      take_tag(markup.text);
      break;
    case MarkupKind::doctype:
      // Attributes may have default values, and entities may contain tags.
      all_in_expat |= markup.text.find('[') != std::string_view::npos;
      give(markup.text, false);
      break;
    case MarkupKind::cdata:
      if (builder.takes_text()) {
        const SourceLocation start = x3d::location_in(markup.text, location, markup.content.data());
        builder.text(valid_text(markup.content), start);
      }
      break;
    case MarkupKind::text:
      if (!is_blank(markup.text) && builder.takes_text()) give_text(markup.text);
      break;
    default:
      break;
  }
  pass(markup.text.substr(located));
}

// Skips the insignificant blanks before markup. Returns their number, or 0 if text follows.
std::size_t Reader::State::pass_blanks(std::string_view text) {
  std::size_t size = 0, line_start = 0;
  std::uint32_t lines = 0;
  for (; size < text.size() && is_blank(text[size]); ++size) {
    if (text[size] != '\n') continue;
    ++lines;
    line_start = size + 1;
  }
  if (size == text.size() || text[size] != '<') return 0;
  location.line += lines;
  location.column = static_cast<std::uint32_t>(size - line_start) + (lines > 0 ? 1 : location.column);
  return size;
}

// Reads complete markup. Returns the number of bytes read.
std::size_t Reader::State::scan(std::string_view text) {
  std::size_t used = 0;
  while (used < text.size() && !stopped) {
    used += pass_blanks(text.substr(used));
    const Markup markup = scanner.next(text.substr(used));
    if (markup.kind == MarkupKind::need_more) break;
    take(markup);
    used += markup.text.size();
    if (sink.limits().is_exhausted(location)) {
      stopped = true;
      outcome = ParseOutcome::truncated;
    }
  }
  return used;
}

void Reader::State::feed(std::string_view text) {
  if (!decoder.unknown_encoding().empty())
    sink.problems().warn_once(
        said_encoding, {1, 1},
        "the encoding " + quoted(decoder.unknown_encoding()) + " is not supported; read as UTF-8");
  const auto read = [this](std::string_view window) { return stopped ? window.size() : scan(window); };
  if (!pieces.push(text, read)) fail(sink.scene().budget()->refusal(Resource::nodes));
}

// Reports an incomplete end of the text.
void Reader::State::close() {
  if (stopped) return;
  std::string_view rest = pieces.rest();
  rest.remove_prefix(scan(rest));
  if (stopped) return;
  markup_location = location;
  if (!is_blank(rest)) give(rest.substr(0, kMaxRest), false);
  if (!stopped && builder.depth() > 0) markup_location = builder.open_location();
  if (!stopped && !expat.parse({}, true))
    fail(builder.depth() > 0 ? "the file ends inside the element that begins here" : "not XML: " + expat.error());
}

Reader::Reader(SceneGraph& scene, Diagnostics& diagnostics) : state_(std::make_unique<State>(scene, diagnostics)) {}
Reader::~Reader() = default;

void Reader::push(std::string_view piece) {
  if (!state_->stopped) state_->feed(state_->decoder.decode(piece, false));
}

ParseOutcome Reader::finish() {
  State& state = *state_;
  if (!state.stopped) state.feed(state.decoder.decode({}, true));
  state.close();
  state.builder.finish();
  if (state.outcome != ParseOutcome::refused && !state.builder.is_x3d()) {
    if (state.outcome == ParseOutcome::complete) state.refuse("the file has no X3D element", {});
    state.outcome = ParseOutcome::refused;
  }
  return state.outcome;
}

std::vector<NodeId> Reader::open_nodes() const { return state_->builder.open_nodes(); }

}  // namespace gs::vrml::xml
