#include "app/inspect/node_children.h"

#include "tests/app/worlds.h"

#include <catch2/catch.hpp>

#include <string>

namespace gs::app::node_children_test {
namespace {

// Returns the description of the first node of a world.
std::string content_of(const std::string& body) {
  const LoadedWorld world = world_of(body);
  return content_name({world.scene.get(), world.scene->roots()[0]});
}

}  // namespace

TEST_CASE("describes a group without a name by the first name or geometry below it") {
  CHECK(content_of("Transform { children Shape { appearance Appearance { } geometry Box { } } }") == "Box");
  CHECK(content_of("Transform { children [ Transform { children DEF Wheel Group { } } Shape { } Shape { } ] }") ==
        "Wheel, 2 more");
  CHECK(content_of("Shape { geometry DEF Lens Sphere { } }") == "Lens");
  CHECK(content_of("Transform { children Inline { url \"trees/oak.wrl\" } }") == "oak.wrl");
  CHECK(content_of("PROTO Lamp [] { Group { } } Transform { children Lamp { } }") == "Lamp");
  CHECK(content_of("Transform { children PointLight { } }") == "PointLight");
}

TEST_CASE("describes neither named nodes nor nodes without content") {
  CHECK(content_of("DEF A Transform { children Shape { geometry Box { } } }").empty());
  CHECK(content_of("Transform { }").empty());
  CHECK(content_of("PointLight { }").empty());
}

}  // namespace gs::app::node_children_test
