#include "vrml/syntax/edits/text_edits.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace gs::vrml::text_edits_test {
namespace {

// Edits a text, and returns "nothing" if the edits do not fit it.
std::string edited(const std::string& text, const std::vector<TextEdit>& edits) {
  return edited_text(text, edits).value_or("nothing");
}

// Returns an edit of the first node with a type name.
TextEdit edit_of(const std::string& text, const std::string& name, const std::string& field, const std::string& value) {
  const std::size_t at = text.find(name);
  REQUIRE(at != std::string::npos);
  SourceLocation location{1, 1};
  for (std::size_t i = 0; i < at; ++i) {
    ++location.column;
    if (text[i] == '\n') location = {location.line + 1, 1};
  }
  return {location, name, field, value};
}

}  // namespace

TEST_CASE("replaces the value of a field and keeps the comments around it") {
  const std::string text =
      "# a room\nDEF A Transform { # moved\n  translation 1 2 3 # metres\n  rotation 0 1 0 2\n  children Shape { "
      "geometry "
      "Box { } } }\n";
  CHECK(edited(text, {edit_of(text, "Transform", "translation", "4 5 6")}) ==
        "# a room\nDEF A Transform { # moved\n  translation 4 5 6 # metres\n  rotation 0 1 0 2\n  children Shape { "
        "geometry Box { } } }\n");
  CHECK(edited(text, {edit_of(text, "Transform", "rotation", "1 0 0 1"), edit_of(text, "Box", "size", "1 1 1")}) ==
        "# a room\nDEF A Transform { # moved\n  translation 1 2 3 # metres\n  rotation 1 0 0 1\n  children Shape { "
        "geometry Box { size 1 1 1 } } }\n");
}

TEST_CASE("adds a field that the node does not set, indented like the others") {
  const std::string long_text = "Transform { # moved\n\tscale 2 2 2\n}\n";
  CHECK(edited(long_text, {edit_of(long_text, "Transform", "center", "1 0 0")}) ==
        "Transform { # moved\n\tcenter 1 0 0\n\tscale 2 2 2\n}\n");
  const std::string empty = "  Sphere {\r\n  }\r\n";
  CHECK(edited(empty, {edit_of(empty, "Sphere", "radius", "3")}) == "  Sphere {\r\n    radius 3\r\n  }\r\n");
  CHECK(edited("Box{}", {edit_of("Box{}", "Box", "size", "1 1 1")}) == "Box{ size 1 1 1 }");
}

TEST_CASE("skips values of all kinds, ROUTEs, PROTOs and declarations of a Script") {
  const std::string text =
      "Script { PROTO P [ field SFFloat a 1 ] { Box { } } EXTERNPROTO Q [ eventIn SFBool b ] [ \"q.wrl\" ]\n"
      " ROUTE A.x TO B.y eventIn SFBool on field SFNode n USE A field MFNode m [ DEF C Box { } NULL ]\n"
      " field SFImage i 1 1 1 0xff field SFString s \"url \\\" 1\" field SFBool f IS g mustEvaluate TRUE url \"a.js\" "
      "}";
  CHECK(edited(text, {edit_of(text, "Script", "url", "\"b.js\"")}).ends_with("mustEvaluate TRUE url \"b.js\" }"));
  CHECK(
      edited(text, {edit_of(text, "Script", "directOutput", "TRUE")}).starts_with("Script { directOutput TRUE PROTO"));
}

TEST_CASE("changes defaults of a PROTO and the url of an EXTERNPROTO") {
  const std::string text =
      "PROTO P [ eventIn SFTime t exposedField MFString url [ \"a\", \"b\" ] ] { Group { } }\n"
      "EXTERNPROTO Q [ field SFFloat x ] \"lib.wrl#Q\"\n";
  CHECK(edited(text, {edit_of(text, "P [", "", "")}) == "nothing");  // not a name at this position
  TextEdit prototype = edit_of(text, "P [", "url", "[ \"c\" ]"), external = edit_of(text, "Q [", "", "[ \"d\" ]");
  prototype.name = "P";
  external.name = "Q";
  CHECK(edited(text, {external, prototype}) ==
        "PROTO P [ eventIn SFTime t exposedField MFString url [ \"c\" ] ] { Group { } }\n"
        "EXTERNPROTO Q [ field SFFloat x ] [ \"d\" ]\n");
}

TEST_CASE("returns nothing if the text has another node at a location, or ends inside of it") {
  CHECK(edited("Box { }", {{{1, 1}, "Cone", "height", "1"}}) == "nothing");
  CHECK(edited("Box { }", {{{7, 1}, "Box", "size", "1 1 1"}}) == "nothing");
  CHECK(edited("Box { }", {{{1, 99}, "Box", "size", "1 1 1"}}) == "nothing");
  CHECK(edited("Group { children [ Box { }", {{{1, 1}, "Group", "bboxSize", "1 1 1"}}) == "nothing");
  const std::string text = "Group { children Box { size 1 1 1 } }";
  CHECK(edited(text, {edit_of(text, "Group", "children", "[]"), edit_of(text, "Box", "size", "2 2 2")}) == "nothing");
}

TEST_CASE("leaves a field with IS alone") {
  const std::string text = "Box { size IS s }";
  CHECK(edited(text, {edit_of(text, "Box", "size", "1 1 1")}) == text);
}

}  // namespace gs::vrml::text_edits_test
