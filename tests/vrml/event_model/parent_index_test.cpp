#include "vrml/event_model/parent_index.h"

#include "vrml/scene/node_names.h"
#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

using namespace gs;
using namespace gs::vrml;

namespace {

/// Scene with an index of its hierarchy.
class Indexed {
 public:
  explicit Indexed(const std::string& body) : scene_("text.wrl") {
    Diagnostics diagnostics;
    (void)parse("#VRML V2.0 utf8\n" + body, scene_, diagnostics);
    CHECK(diagnostics.errors() == 0);
    index_.build();
  }
  [[nodiscard]] NodeId node(const std::string& name) { return NodeNames(scene_).find(name); }
  /// Returns the names of the transforming ancestors of each instance, for example "A/B C/B".
  std::string paths(const std::string& name, std::size_t most = 64) {
    std::vector<ParentIndex::Path> found;
    CHECK(index_.find_paths(scene_, node(name), most, found));
    return text_of(found);
  }
  /// Sets the children of a Group or Transform, without the index.
  void set(const std::string& group, const std::vector<std::string>& children) {
    MFNode list;
    for (const std::string& child : children) list.push_back(node(child));
    scene_.set(node(group), "children", list);
  }
  /// Takes in the children of a node, and returns the names of the moved ones.
  std::string update(const std::string& group) {
    std::vector<NodePlace> moved;
    (void)index_.update(scene_, node(group), moved);
    std::string text;
    for (const NodePlace& place : moved) text += std::string(scene_.node(place.node).name) + ' ';
    return text;
  }
  /// Returns the paths in a new index.
  std::string fresh_paths(const std::string& name) {
    ParentIndex fresh(scene_);
    fresh.build();
    std::vector<ParentIndex::Path> found;
    CHECK(fresh.find_paths(scene_, node(name), 64, found));
    return text_of(found);
  }
  SceneGraph& scene() { return scene_; }
  ParentIndex& index() { return index_; }

 private:
  [[nodiscard]] std::string text_of(const std::vector<ParentIndex::Path>& found) const {
    std::string text;
    for (const ParentIndex::Path& path : found) {
      text += text.empty() ? "" : " ";
      if (path.empty()) text += '.';
      for (const NodePlace& place : path)
        text += (&place == path.data() ? "" : "/") + std::string(scene_.node(place.node).name);
    }
    return text;
  }

  SceneGraph scene_;
  ParentIndex index_{scene_};
};

}  // namespace

TEST_CASE("finds the transforming ancestors of each instance in file order") {
  Indexed world(
      "DEF A Transform { children Group { children [ DEF B Transform { children DEF P ProximitySensor { } } USE B ] } "
      "} "
      "DEF C Transform { children USE B } DEF S Switch { choice [ Group { } DEF D Transform { children USE P } ] } "
      "DEF Alone ProximitySensor { } Group { children USE Alone }");
  CHECK(world.paths("P") == "A/B A/B C/B D");
  CHECK(world.paths("P", 2) == "A/B A/B");
  CHECK(world.paths("B") == "A A C");
  CHECK(world.paths("A") == ".");
  CHECK(world.paths("Alone") == ". .");
}

TEST_CASE("takes in added, removed and reordered children") {
  Indexed world(
      "DEF A Transform { children [ DEF P ProximitySensor { } DEF X Transform { } DEF Y Transform { } ] } "
      "DEF B Transform { } DEF Out Transform { }");
  CHECK(world.paths("P") == "A");
  world.set("B", {"P"});
  CHECK(world.update("B") == "P ");
  CHECK(world.paths("P") == "A B");
  world.set("A", {"X", "Y"});
  CHECK(world.update("A") == "P ");
  CHECK(world.paths("P") == "B");
  CHECK(world.update("A").empty());
  world.set("X", {"P"});
  CHECK(world.update("X") == "P ");
  world.set("Y", {"P"});
  (void)world.update("Y");
  CHECK(world.paths("P") == "A/X A/Y B");
  world.set("A", {"Y", "X"});
  (void)world.update("A");
  CHECK(world.paths("P") == "A/Y A/X B");
}

TEST_CASE("survives cycles and nodes outside of the hierarchy") {
  Indexed world("DEF A Transform { } DEF B Transform { children DEF P ProximitySensor { } }");
  world.set("B", {"A", "P"});
  world.set("A", {"B"});
  CHECK(world.update("A") == "B ");
  CHECK(world.update("B") == "A ");
  CHECK(world.paths("P") == "A/B B");
  CHECK(world.paths("A") == ". B");
  world.scene().set_roots({});
  world.index().build();
  CHECK(world.paths("P").empty());
  CHECK(world.update("A").empty());
}

TEST_CASE("gives the paths of a new index after any series of changes") {
  std::string text;
  constexpr int kGroups = 12;
  for (int i = 0; i < kGroups; ++i) text += "DEF G" + std::to_string(i) + " Transform { } ";
  Indexed world(text + "DEF P ProximitySensor { }");
  std::mt19937 random(7);
  for (int round = 0; round < 400; ++round) {
    std::vector<std::string> children;
    for (auto i = random() % 5; i > 0; --i) children.push_back("G" + std::to_string(random() % kGroups));
    if (random() % 3 == 0) children.insert(children.begin() + static_cast<int>(random() % (children.size() + 1)), "P");
    const std::string group = "G" + std::to_string(random() % kGroups);
    world.set(group, children);
    (void)world.update(group);
    for (const std::string name : {"P", "G3", "G8"}) CHECK(world.paths(name) == world.fresh_paths(name));
  }
}

TEST_CASE("visits each node below a node once, up to a limit") {
  Indexed world(
      "DEF A Group { children [ DEF B Group { children DEF P ProximitySensor { } } USE B DEF C Group { } ] }");
  std::vector<std::string> names;
  const auto visit = [&](const NodePlace& place) { names.emplace_back(world.scene().node(place.node).name); };
  CHECK(world.index().each_below({&world.scene(), world.node("A")}, 10, visit));
  std::sort(names.begin(), names.end());
  CHECK(names == std::vector<std::string>{"A", "B", "C", "P"});
  CHECK_FALSE(world.index().each_below({&world.scene(), world.node("A")}, 2, visit));
}

TEST_CASE("forgets removed nodes") {
  Indexed world("DEF A Transform { children DEF B Transform { children DEF P ProximitySensor { } } }");
  CHECK(world.index().remove(world.scene(), world.node("B")));
  CHECK(world.paths("P").empty());
  CHECK_FALSE(world.index().remove(world.scene(), world.node("B")));
}
