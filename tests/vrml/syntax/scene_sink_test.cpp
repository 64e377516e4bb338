#include "vrml/syntax/scene_sink.h"

#include "tests/vrml/syntax/s_expressions.h"
#include "vrml/syntax/parser.h"
#include "vrml/syntax/printer.h"

#include <catch2/catch.hpp>

#include <string>

using namespace gs;
using namespace gs::vrml;

namespace {

/// World that one grammar has read.
struct World {
  SceneGraph scene;
  Diagnostics diagnostics;

  explicit World(const Limits& limits = {}) : scene("world", limits) {}
  /// Returns LINE: SEVERITY MESSAGE of each diagnostic. Columns depend on the grammar.
  [[nodiscard]] std::string messages() const {
    std::string text;
    for (const Diagnostic& one : diagnostics.entries())
      text += std::to_string(one.location.line) + (one.severity == Severity::error ? ": error " : ": warning ") +
              one.message + "\n";
    return text;
  }
};

struct Pair {
  World vrml97, expressions;

  Pair(const std::string& vrml97_text, const std::string& expressions_text, const Limits& limits = {})
      : vrml97(limits), expressions(limits) {
    (void)Parser(vrml97.scene, vrml97.diagnostics).parse_fragment(vrml97_text);
    gs::vrml::test::SceneReader(expressions.scene, expressions.diagnostics).read(expressions_text);
  }
};

}  // namespace

TEST_CASE("builds the same world from a second grammar") {
  const Pair pair(
      R"(DEF T Transform { translation 1 2 3 children [ DEF S Shape { geometry Box { size 1 1 2 } } USE S ] }
PROTO Outer [ field SFColor paint 1 0 0 exposedField MFNode things [ ] eventIn SFVec3f move ] {
  PROTO Inner [ field SFColor tint 0 1 0 ] { Material { diffuseColor IS tint } }
  Transform {
    set_translation IS move
    children [ Shape { appearance Appearance { material Inner { tint IS paint } } } Group { children IS things } ]
  }
}
DEF O Outer { paint 0 0 1 things [ Shape { } Shape { } ] }
EXTERNPROTO Tree [ field SFFloat height eventIn SFTime grow ] [ "tree.wrl#Tree" "urn:nobody:tree" ]
Tree { height 3 }
DEF Path PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0 1 0 0 ] }
DEF Code Script { url "javascript:" field SFFloat speed 2 eventOut SFFloat done }
ROUTE Path.value_changed TO O.move
ROUTE Code.done TO Path.set_fraction
ROUTE Path.value_changed TO Late.set_translation
DEF Late Transform { }
)",
      R"((def T (Transform (translation 1 2 3) (children (def S (Shape (geometry (Box (size 1 1 2))))) (use S))))
(proto Outer ((field SFColor paint 1 0 0) (exposedField MFNode things) (eventIn SFVec3f move))
  (proto Inner ((field SFColor tint 0 1 0)) (Material (is diffuseColor tint)))
  (Transform
    (is set_translation move)
    (children (Shape (appearance (Appearance (material (Inner (is tint paint)))))) (Group (is children things)))))
(def O (Outer (paint 0 0 1) (things (Shape) (Shape))))
(externproto Tree ((field SFFloat height) (eventIn SFTime grow)) "tree.wrl#Tree" "urn:nobody:tree")
(Tree (height 3))
(def Path (PositionInterpolator (key 0 1) (keyValue 0 0 0 1 0 0)))
(def Code (Script (url "javascript:") (field SFFloat speed 2) (eventOut SFFloat done)))
(route Path value_changed O move)
(route Code done Path set_fraction)
(route Path value_changed Late set_translation)
(def Late (Transform))
)");
  CHECK(pair.vrml97.messages().empty());
  CHECK(pair.expressions.messages().empty());
  CHECK(print(pair.expressions.scene) == print(pair.vrml97.scene));
  CHECK(pair.expressions.scene.nodes().count() == pair.vrml97.scene.nodes().count());
  CHECK(pair.expressions.scene.routes().size() == pair.vrml97.scene.routes().size());
}

TEST_CASE("reports the same problems for a second grammar") {
  const Pair pair(R"(USE Nobody
DEF Lost Zorp { }
USE Lost
Shape { geometry Material { } }
Group { children Box { } size 1 1 1 addChildren NULL }
Box { size 1 1 1 size 2 2 2 }
Sphere { radius -1 }
DEF M Material { diffuseColor IS paint }
PROTO P [ field SFFloat x 1 field SFFloat x 2 eventIn SFTime t ] {
  Sphere { radius IS y } Material { diffuseColor IS x } Viewpoint { set_bind IS t }
}
PROTO Box [ ] { Shape { } }
DEF S Script { exposedField SFFloat a 0 }
ROUTE M.nothing TO M.transparency
ROUTE M.transparency TO M.diffuseColor
ROUTE Nobody.a TO M.transparency
)",
                  R"((use Nobody)
(def Lost (Zorp))
(use Lost)
(Shape (geometry (Material)))
(Group (children (Box)) (size 1 1 1) (addChildren))
(Box (size 1 1 1) (size 2 2 2))
(Sphere (radius -1))
(def M (Material (is diffuseColor paint)))
(proto P ((field SFFloat x 1) (field SFFloat x 2) (eventIn SFTime t))
  (Sphere (is radius y)) (Material (is diffuseColor x)) (Viewpoint (is set_bind t))
)
(proto Box () (Shape))
(def S (Script (exposedField SFFloat a 0)))
(route M nothing M transparency)
(route M transparency M diffuseColor)
(route Nobody a M transparency)
)");
  CHECK(pair.vrml97.diagnostics.errors() == 14);
  CHECK(pair.expressions.messages() == pair.vrml97.messages());
  CHECK(print(pair.expressions.scene) == print(pair.vrml97.scene));
}

TEST_CASE("reports problems at the positions that the grammar supplies") {
  World world;
  gs::vrml::test::SceneReader(world.scene, world.diagnostics).read("(Group (children (Shape)\n  (Zorp)) (sise 2))");
  REQUIRE(world.diagnostics.entries().size() == 2);
  CHECK(world.diagnostics.entries()[0].text() == "world:2:4: error: unknown node type 'Zorp'; the node is skipped");
  CHECK(world.diagnostics.entries()[1].text() == "world:2:12: error: Group has no field 'sise'; skipped");
}

TEST_CASE("applies the limits of a world to a second grammar") {
  const std::string vrml97 =
      "Group { children [ Group { children [ Group { children Shape { } } ] } Group { } ] } Group { }";
  const std::string expressions = "(Group (children (Group (children (Group (children (Shape))))) (Group))) (Group)";
  Limits few;
  few.nodes = 3;
  const Pair counted(vrml97, expressions, few);
  CHECK(counted.vrml97.messages() == "1: error more than 3 nodes; skipped the rest\n");
  CHECK(counted.expressions.messages() == counted.vrml97.messages());
  CHECK(print(counted.expressions.scene) == print(counted.vrml97.scene));

  Limits flat;
  flat.nesting = 4;  // this grammar counts a field and its node as one level
  World world(flat);
  gs::vrml::test::SceneReader(world.scene, world.diagnostics).read(expressions);
  CHECK(world.messages() == "1: error nested deeper than 4 levels; skipped the deeper content\n");
}
