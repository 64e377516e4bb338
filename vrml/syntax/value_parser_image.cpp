#include "vrml/syntax/value_parser.h"

#include "vrml/syntax/numbers/number.h"

#include <array>
#include <string>
#include <utility>

namespace gs::vrml {

// Parses `width height components`; the pixels follow.
Step ValueParser::image_head(FieldValue& into, Token token, std::string_view name) {
  std::array<double, 3> head{};
  number_type_ = FieldType::SFInt32;
  for (int i = 0; i < 3; ++i) {
    const Lexer::Position before = text_.lexer.position();
    if (i > 0) token = text_.lexer.next();
    if (token.kind == TokenKind::need_more) return Step::need_more;
    if (token.kind == TokenKind::word) cut_number(token);
    if (token.kind != TokenKind::word || !number_of(token, head[i])) {
      text_.unexpected(token, "width, height and components of an image for " + std::string(name));
      if (i > 0) text_.lexer.go_back(before);
      return Step::done;
    }
  }
  if (!text_.sink.limits().admits_image(head[0], head[1], head[2], token.location)) {
    text_.skip_value();
    return Step::done;
  }
  const double pixels = head[0] * head[1];
  SFImage image;
  // Without components, some files have pixels and others have not. In a list, numbers belong to the next image.
  if (pixels > 0 && (head[2] > 0 || &into != &image_))
    for (const double n : head) image.words.push_back(static_cast<std::uint32_t>(n));
  into = image;
  if (image.words.empty()) return Step::done;
  Frame frame;
  frame.kind = Frame::Kind::image;
  frame.start = token.location;
  frame.into = &into;
  frame.pixels_left = static_cast<std::uint64_t>(pixels);
  frame.name = name;
  text_.open(std::move(frame));
  return Step::done;
}

Step ValueParser::image_step() {
  Frame& frame = text_.frames.back();
  Array<std::uint32_t>& words = std::get_if<SFImage>(frame.into)->words;
  const std::uint32_t components = words[2];
  const std::uint32_t mask = components == 4 ? 0xffffffffu : (1u << (8 * components)) - 1;
  for (; frame.pixels_left > 0; --frame.pixels_left) {
    const Lexer::Position before = text_.lexer.position();
    Token token = text_.lexer.next();
    if (token.kind == TokenKind::word) cut_number(token);
    if (token.kind == TokenKind::need_more) {
      text_.sink.limits().charge_growth(*frame.into, frame.charged, false);
      // Only whole pixels were read. The next window begins after them.
      text_.lexer.go_back(before);
      return Step::need_more_kept;
    }
    std::int32_t number = 0;
    double large = 0;
    const bool is_number =
        token.kind == TokenKind::word &&
        (parse_number(token.text, number) || (parse_number(token.text, large) && large >= 0 && large < 4294967296.0));
    if (!is_number && components == 0) {
      text_.lexer.go_back(before);
      break;
    }
    if (!is_number) {
      text_.problems.error(token.location, std::to_string(frame.pixels_left) +
                                               " pixels of an image are missing; expected a pixel, found " +
                                               describe(token));
      text_.lexer.go_back(before);
      // Few bytes of text may declare many pixels.
      if (frame.pixels_left * sizeof(std::uint32_t) > text_.scene.budget()->left(Resource::nodes) / 4)
        words.clear();
      else
        words.resize(words.size() + frame.pixels_left);
      break;
    }
    words.push_back((large > 0 ? static_cast<std::uint32_t>(large) : static_cast<std::uint32_t>(number)) & mask);
  }
  if (components == 0) words.clear();
  words.shrink_to_fit();
  text_.sink.limits().charge_growth(*frame.into, frame.charged, true);
  text_.frames.pop_back();
  return Step::done;
}

// Begins the images of an MFImage: a list in brackets, or one image without brackets.
Step ValueParser::image_list_head(FieldValue& into, const Token& token, const Lexer::Position& before,
                                  std::string_view name) {
  into = MFImage{};
  Frame frame;
  frame.kind = Frame::Kind::image_list;
  frame.start = token.location;
  frame.into = &into;
  frame.name = name;
  frame.single = token.kind != TokenKind::open_bracket;
  if (frame.single) text_.lexer.go_back(before);
  has_image_ = false;
  text_.open(std::move(frame));
  return Step::done;
}

Step ValueParser::image_list_step() {
  const Frame& frame = text_.frames.back();
  const std::string_view name = frame.name;
  if (std::exchange(has_image_, false)) {
    std::get_if<MFImage>(frame.into)->push_back(std::move(*std::get_if<SFImage>(&image_)));
    text_.sink.limits().charge_growth(*frame.into, text_.frames.back().charged, false);
    if (frame.single) {
      text_.frames.pop_back();
      return Step::done;
    }
  }
  const Lexer::Position before = text_.lexer.position();
  const Token token = text_.lexer.next();
  if (token.kind == TokenKind::need_more) return Step::need_more;
  if (token.kind == TokenKind::end) return Step::finished;
  if (token.kind == TokenKind::word && looks_like_number(token.text)) {
    image_ = SFBool{};  // until the head of the image was accepted
    const bool single = frame.single;
    const std::size_t index = text_.frames.size() - 1;
    const Step step = image_head(image_, token, name);
    if (step != Step::done) return step;
    has_image_ = std::holds_alternative<SFImage>(image_);
    if (!has_image_ && single) text_.frames.erase(text_.frames.begin() + static_cast<std::ptrdiff_t>(index));
    return Step::done;
  }
  if (frame.single) {
    text_.frames.pop_back();
    return refuse_token(FieldType::SFImage, token, before, name);
  }
  if (token.kind == TokenKind::close_bracket) {
    text_.sink.limits().charge_growth(*frame.into, text_.frames.back().charged, true);
    text_.frames.pop_back();
    return Step::done;
  }
  if (token.kind == TokenKind::close_brace) {
    text_.problems.error(token.location,
                         "expected ']' at the end of " + std::string(name) + ", found " + describe(token));
    text_.lexer.go_back(before);
    text_.frames.pop_back();
    return Step::done;
  }
  text_.rubbish_token(token, "Image or ']' in " + std::string(name));
  return Step::done;
}

}  // namespace gs::vrml
