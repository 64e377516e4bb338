#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <string>

using namespace gs;

using namespace gs::vrml;

namespace {

struct Reading {
  explicit Reading(const std::string& body) : scene("text.wrl") {
    (void)parse("#VRML V2.0 utf8\n" + body, scene, diagnostics);
    for (const Diagnostic& diagnostic : diagnostics.entries()) said += diagnostic.text() + '\n';
  }
  SceneGraph scene;
  Diagnostics diagnostics;
  std::string said;
};

}  // namespace

TEST_CASE("separates names of a PROTO's body from names outside (4.6.2, 4.8.3)") {
  CHECK(Reading("PROTO P [ ] { DEF X Group { } } USE X").said.find("USE of 'X'") != std::string::npos);
  CHECK(Reading("DEF X Group { } PROTO P [ ] { Group { children USE X } }").said.find("USE of 'X'") !=
        std::string::npos);
  CHECK(Reading("DEF X Group { } PROTO P [ ] { DEF X Transform { } ROUTE X.translation TO X.center } P { } USE X")
            .said.empty());
  const Reading inner("PROTO P [ ] { DEF X Group { } PROTO Q [ ] { Group { children USE X } } Q { } }");
  CHECK(inner.said.find("USE of 'X'") != std::string::npos);
}

TEST_CASE("rejects a PROTO inside its own body, or outside the PROTO that declares it (4.8.3)") {
  const Reading own("PROTO P [ ] { Group { children P { } } } P { }");
  CHECK(own.said == "text.wrl:2:32: error: unknown node type 'P'; the node is skipped\n");
  CHECK(own.scene.resolve_as(own.scene.roots()[0], NodeKind::group));
  CHECK(Reading("PROTO P [ ] { PROTO Q [ ] { Group { } } Q { } } Q { }").said.find("unknown node type 'Q'") !=
        std::string::npos);
  CHECK(Reading("P { } PROTO P [ ] { Group { } }").said.find("unknown node type 'P'") != std::string::npos);
}

TEST_CASE("reports an IS between accesses that Table 4.4 does not pair (4.8.2)") {
  const auto said = [](const std::string& outer, const std::string& inner) {
    return Reading("PROTO P [ " + outer + " ] { " + inner + " }").said;
  };
  const std::string wrong = "(VRML97 Table 4.4)";
  CHECK(said("exposedField SFVec3f x 1 1 1", "Transform { bboxSize IS x }").find(wrong) != std::string::npos);
  CHECK(said("eventIn SFVec3f x", "Transform { bboxSize IS x }").find(wrong) != std::string::npos);
  CHECK(said("eventOut SFVec3f x", "Transform { bboxSize IS x }").find(wrong) != std::string::npos);
  CHECK(said("exposedField SFFloat x 1", "ScalarInterpolator { set_fraction IS x }").find(wrong) != std::string::npos);
  CHECK(said("field SFFloat x 1", "ScalarInterpolator { set_fraction IS x }").find(wrong) != std::string::npos);
  CHECK(said("eventOut SFFloat x", "ScalarInterpolator { set_fraction IS x }").find(wrong) != std::string::npos);
  CHECK(said("exposedField SFBool x TRUE", "TimeSensor { isActive IS x }").find(wrong) != std::string::npos);
  CHECK(said("field SFBool x TRUE", "TimeSensor { isActive IS x }").find(wrong) != std::string::npos);
  CHECK(said("eventIn SFBool x", "TimeSensor { isActive IS x }").find(wrong) != std::string::npos);
  for (const char* access :
       {"exposedField SFVec3f x 1 1 1", "field SFVec3f x 1 1 1", "eventIn SFVec3f x", "eventOut SFVec3f x"})
    CHECK(said(access, "Transform { translation IS x }").empty());
  CHECK(said("field SFVec3f x 1 1 1", "Transform { bboxSize IS x }").empty());
  CHECK(said("eventIn SFVec3f x", "Transform { set_translation IS x }").empty());
  CHECK(said("eventOut SFVec3f x", "Transform { translation_changed IS x }").empty());
}
