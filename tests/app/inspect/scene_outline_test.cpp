#include "app/inspect/scene_outline.h"

#include "tests/app/worlds.h"
#include "tests/watched.h"
#include "vrml/events/execution.h"
#include "vrml/scene/prototype.h"

#include <catch2/catch.hpp>

#include <memory>
#include <string>
#include <vector>

namespace gs::app::scene_outline_test {

struct Tree {
  explicit Tree(LoadedWorld opened) : world(std::move(opened)), execution(*world.scene) {
    execution.scenes().attach();
    index.set_world(&execution);
    outline.set_world(&execution, &index);
    learn();
  }
  explicit Tree(const std::string& body) : Tree(world_of(body)) {}
  void learn() {
    while (index.go_on(100'000, now += 10)) {
    }
    outline.refresh();
  }
  // Returns a line like "  children[1] Shape 'S'", with "+" for closed and "-" for open ones.
  [[nodiscard]] std::string line(std::size_t i) const {
    const OutlineRow row = outline.row(i);
    std::string text(2 * row.depth, ' ');
    text += row.open ? "-" : row.can_open ? "+" : " ";
    text += row.field;
    if (row.element) text += '[' + std::to_string(*row.element) + ']';
    if (!row.node) return text + " NULL";
    const vrml::Node& node = row.node.scene->node(row.node.id);
    text += row.use ? " USE" : "";
    return text + ' ' + node.type->name + (node.name.empty() ? "" : " '" + std::string(node.name) + "'");
  }
  [[nodiscard]] std::vector<std::string> lines() const {
    std::vector<std::string> all;
    for (std::size_t i = 0; i < outline.size(); ++i) all.push_back(line(i));
    return all;
  }
  [[nodiscard]] NodeAt node(std::string_view name) const {
    for (std::uint32_t i = 1; i <= world.scene->nodes().count(); ++i)
      if (world.scene->nodes().at(i).name == name) return {world.scene.get(), world.scene->nodes().id_at(i)};
    return {};
  }

  LoadedWorld world;
  vrml::Execution execution;
  SceneIndex index;
  SceneOutline outline;
  double now = 0;
};
using Lines = std::vector<std::string>;

TEST_CASE("lists fields with nodes and DEF names, and opens single lines") {
  Tree tree(
      "DEF A Group { children [ DEF S Shape { appearance Appearance { material Material {} } geometry Box {} } "
      "Group {} ] } DEF B Transform {}");
  CHECK(tree.lines() == Lines{"+[0] Group 'A'", " [1] Transform 'B'"});
  tree.outline.set_open(0, true);
  CHECK(tree.lines() ==
        Lines{"-[0] Group 'A'", "  +children[0] Shape 'S'", "   children[1] Group", " [1] Transform 'B'"});
  tree.outline.set_open(1, true);
  CHECK(tree.lines() == Lines{"-[0] Group 'A'", "  -children[0] Shape 'S'", "    +appearance Appearance",
                              "     geometry Box", "   children[1] Group", " [1] Transform 'B'"});
  CHECK(tree.outline.holder(3) == 1);
  CHECK(tree.outline.holder(1) == 0);
  CHECK_FALSE(tree.outline.holder(0));
  tree.outline.set_open(0, false);
  CHECK(tree.lines() == Lines{"+[0] Group 'A'", " [1] Transform 'B'"});
}

// VRML97 4.6.2: USE is another instance of the same node.
TEST_CASE("marks a node that is used again, and never opens it below itself") {
  Tree tree("DEF A Group { children [ Group { children DEF X Shape { geometry Box {} } } USE X ] } USE A");
  tree.outline.set_open(0, true);
  tree.outline.set_open(1, true);
  CHECK(tree.lines() == Lines{"-[0] Group 'A'", "  -children[0] Group", "    +children[0] Shape 'X'",
                              "   children[1] USE Shape 'X'", " [1] USE Group 'A'"});
  // An event can put a node below itself.
  const NodeAt group = tree.node("A");
  tree.world.scene->set<vrml::MFNode>(group.id, "children", vrml::MFNode{group.id});
  tree.outline.refresh();
  CHECK(tree.lines() == Lines{"-[0] Group 'A'", "   children[0] USE Group 'A'", " [1] USE Group 'A'"});
}

TEST_CASE("lists fields and body of PROTO instances") {
  Tree tree(
      "PROTO Lamp [ field MFNode parts [] ] { Group { children IS parts } PointLight {} } "
      "DEF L Lamp { parts Group {} }");
  tree.outline.set_open(0, true);
  // The body's Group contains the nodes of the field.
  CHECK(tree.lines() == Lines{"-[0] Lamp 'L'", "   parts[0] Group", "  +body[0] Group", "   body[1] PointLight"});
  tree.outline.set_open(2, true);
  CHECK(tree.line(3) == "     children[0] USE Group");
}

TEST_CASE("updates the tree with the world") {
  Tree tree("DEF A Group { children [ Group { children Shape {} } DEF B Group { children Shape {} } ] }");
  tree.outline.set_open(0, true);
  tree.outline.set_open(2, true);
  CHECK(tree.lines().size() == 4);
  const NodeAt a = tree.node("A"), b = tree.node("B");
  tree.world.scene->set<vrml::MFNode>(a.id, "children", vrml::MFNode{b.id, vrml::NodeId{}});
  tree.outline.refresh();
  // A moved node stays open.
  CHECK(tree.lines() ==
        Lines{"-[0] Group 'A'", "  -children[0] Group 'B'", "     children[0] Shape", "   children[1] NULL"});
  tree.world.scene->set<vrml::MFNode>(a.id, "children", vrml::MFNode{});
  tree.outline.refresh();
  CHECK(tree.lines() == Lines{" [0] Group 'A'"});
}

TEST_CASE("lists the content of Inlines below them as it is loaded") {
  Tree tree("DEF I Inline { url \"part.wrl\" }");
  CHECK(tree.lines() == Lines{" [0] Inline 'I'"});
  auto content = std::make_shared<vrml::SceneGraph>("part.wrl", tree.world.scene->budget());
  Diagnostics diagnostics;
  (void)vrml::parse("#VRML V2.0 utf8\nDEF In Group {}", *content, diagnostics);
  tree.world.scene->inlines().attach(tree.node("I").id, content);
  tree.execution.scenes().attach();
  tree.learn();
  CHECK(tree.lines() == Lines{"+[0] Inline 'I'"});
  tree.outline.set_open(0, true);
  CHECK(tree.lines() == Lines{"-[0] Inline 'I'", "   content[0] Group 'In'"});
  tree.index.find("In");
  tree.learn();
  REQUIRE(tree.index.matches() == 2);  // one by its type, one by its name
  CHECK(tree.index.match(1).scene == content.get());
  const NodeAt inside = tree.index.match(1);
  tree.execution.lifetime().remove_content(*tree.world.scene, tree.node("I").id);
  tree.world.scene->inlines().attach(tree.node("I").id, nullptr);
  content.reset();
  // A removed node has no path.
  CHECK(tree.index.way_to(inside).empty());
  tree.learn();
  CHECK(tree.lines() == Lines{" [0] Inline 'I'"});
}

TEST_CASE("finds nodes by parts of names and types, and shows them in the tree") {
  Tree tree(
      "Group { children [ DEF Front_Door Transform { children Shape { geometry DEF Knob Sphere {} } } "
      "DEF Window Transform {} ] }");
  tree.index.find("door");
  tree.learn();
  REQUIRE(tree.index.matches() == 1);
  CHECK(tree.index.match(0) == tree.node("Front_Door"));
  tree.index.find("TRANSF");
  tree.learn();
  CHECK(tree.index.matches() == 2);
  tree.index.find("knob");
  tree.learn();
  REQUIRE(tree.index.matches() == 1);
  const auto line = tree.outline.reveal(tree.index.way_to(tree.index.match(0)));
  REQUIRE(line == 3U);
  CHECK(tree.line(3) == "       geometry Sphere 'Knob'");
  CHECK(tree.lines() == Lines{"-[0] Group", "  -children[0] Transform 'Front_Door'", "    -children[0] Shape",
                              "       geometry Sphere 'Knob'", "   children[1] Transform 'Window'"});
  tree.index.find("");
  tree.learn();
  CHECK(tree.index.matches() == 0);
}

TEST_CASE("costs only the visible lines in a world of a million nodes") {
  const std::size_t count = 1'000'000 / watched_step(49);
  LoadedWorld opened;
  opened.scene = std::make_unique<vrml::SceneGraph>("large.wrl");
  const vrml::NodeType& group = vrml::built_in_node_type(vrml::NodeKind::group);
  const vrml::NodeId root = opened.scene->create(group);
  opened.scene->add_root(root);
  vrml::MFNode children;
  for (std::size_t i = 1; i < count; ++i) children.push_back(opened.scene->create(group));
  opened.scene->node(children[count - 3]).name = *opened.scene->texts().keep_name("Needle");
  opened.scene->set<vrml::MFNode>(root, "children", children);
  vrml::Execution execution(*opened.scene);
  SceneIndex index;
  SceneOutline outline;
  index.set_world(&execution);
  outline.set_world(&execution, &index);
  outline.set_open(0, true);
  CHECK(outline.size() == count);
  // Before the index is built, drawing fifty lines at any position must be cheap.
  const std::uint64_t before = outline.work_done();
  outline.refresh();
  for (std::size_t i = count / 2; i < count / 2 + 50; ++i) CHECK(outline.row(i).node.id == children[i - 1]);
  CHECK(outline.work_done() - before < 1000);
  // Each frame indexes nodes within its limit, until the index is complete.
  index.find("needle");
  std::size_t frames = 0;
  constexpr std::size_t kWork = 10'000;
  for (bool more = true; more; ++frames) {
    const std::uint64_t done = index.work_done();
    more = index.go_on(kWork, 0);
    REQUIRE(index.work_done() - done <= kWork);
  }
  CHECK(frames >= count / kWork);
  CHECK(index.size() == count);
  REQUIRE(index.matches() == 1);
  CHECK(outline.reveal(index.way_to(index.match(0))) == count - 2);
}

}  // namespace gs::app::scene_outline_test
