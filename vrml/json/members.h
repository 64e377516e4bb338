#pragma once

#include "vrml/json/list_reader.h"
#include "vrml/scene/stable_vector.h"
#include "vrml/x3d/element_builder.h"

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml::json {

/// Result of one step of the reader.
enum class Progress : std::uint8_t {
  done,
  need_more,       // more bytes are needed; nothing was read
  need_more_kept,  // more bytes are needed; the part of a list that was read is kept
  finished,        // the text has ended
};

/// Attribute of an element that begins, with its own copies of the texts.
struct StoredAttribute {
  std::string name, value;
  SourceLocation location;
};

/// Member of an object that must wait for other members, because JSON does not order them.
struct WaitingMember {
  std::string key;
  std::string text;  // value, as it is in the file
  SourceLocation location;
};

/// Open object or array.
struct Frame {
  enum class Kind : std::uint8_t {
    document,      // the text
    choice,        // object with the name of a node as its key: { "Shape": {...} }
    choice_list,   // array of such objects
    element,       // object with the attributes and children of an element
    element_list,  // array of such objects of one name
    values,        // array with the value of a field
    lines,         // array with the lines of a program
    skip,          // any value that is not used
  };
  Kind kind = Kind::document;
  SourceLocation start;
  std::string name;                         // element and element_list: name of the element
  std::string container;                    // choice and choice_list: field of the parent
  std::vector<StoredAttribute> attributes;  // element that has not begun: its attributes
  std::vector<WaitingMember> waiting;       // element: members that wait for its end
  x3d::ElementKind element = x3d::ElementKind::node;
  std::uint8_t given = 0;      // element that has not begun: bits of its attributes, see bit_of() in members.cpp
  bool begun = false;          // element: the builder knows it
  bool has_interface = false;  // element of a PROTO: its interface was read
  std::size_t depth = 0;       // skip and values: number of open brackets
  bool is_recorded = false;    // skip: the text belongs to the last waiting member of the frame below
};

/// Stack of frames. It keeps closed frames, and the memory of their names, for the next ones.
class FrameStack {
 public:
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] Frame& back() { return frames_[size_ - 1]; }
  [[nodiscard]] const Frame& back() const { return frames_[size_ - 1]; }
  /// Returns the frame around the innermost one.
  [[nodiscard]] Frame& parent() { return frames_[size_ - 2]; }
  /// Adds a frame. Other frames do not move.
  Frame& push(Frame::Kind kind, SourceLocation start, std::string_view name = {}, std::string_view container = {});
  void pop_back();

 private:
  StableVector<Frame, 4> frames_;
  std::size_t size_ = 0;
};

/// Reader of the members of X3D objects. It keeps the stack of open objects and arrays.
class MemberReader {
 public:
  explicit MemberReader(SceneSink& sink);

  [[nodiscard]] Lexer& lexer() { return lexer_; }
  [[nodiscard]] x3d::ElementBuilder& builder() { return builder_; }
  [[nodiscard]] std::size_t depth() const { return frames_.size(); }
  /// Returns the start of the innermost open object or array.
  [[nodiscard]] SourceLocation open_location() const { return frames_.back().start; }

  /// Reads the next part of the text.
  [[nodiscard]] Progress step();

 private:
  [[nodiscard]] Progress document_step();
  [[nodiscard]] Progress choice_step();
  [[nodiscard]] Progress list_step();
  [[nodiscard]] Progress element_step();
  [[nodiscard]] Progress values_step();
  [[nodiscard]] Progress lines_step();
  [[nodiscard]] Progress skip_step();

  /// Reads the colon after a key. Returns false if more bytes are needed.
  [[nodiscard]] bool pass_colon();
  [[nodiscard]] std::string_view text_of(const Token& token, std::string& storage);
  Frame* open(Frame::Kind kind, SourceLocation start, std::string_view name = {}, std::string_view container = {});
  void open_element(std::string_view name, std::string_view container, SourceLocation start);
  void begin_element();
  void end_element();
  void member(std::string_view key, SourceLocation location, const Token& value);
  void attribute(std::string_view name, SourceLocation location, const Token& value);
  [[nodiscard]] bool must_wait(const Frame& frame, std::string_view key) const;
  void wait(std::string_view key, SourceLocation location, const Token& value);
  void replay(const WaitingMember& member);
  void skip(const Token& value);
  void unexpected(const Token& token, std::string_view wanted);

  SceneSink& sink_;
  x3d::ValueReader values_;
  x3d::ElementBuilder builder_;
  ListReader list_;
  Lexer lexer_;
  FrameStack frames_;
  std::vector<x3d::Attribute> attributes_;  // of the element that begins
  std::string key_text_, value_text_;       // decoded strings
  std::size_t replays_ = 0;                 // number of nested replays
  bool said_unexpected_ = false, said_latin1_ = false;
};

}  // namespace gs::vrml::json
