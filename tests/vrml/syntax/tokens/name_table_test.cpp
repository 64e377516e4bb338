#include "vrml/syntax/tokens/name_table.h"

#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

using namespace gs::vrml;

TEST_CASE("finds the node of each name in a table of any size") {
  NameTable table;
  CHECK_FALSE(table.find(""));
  CHECK_FALSE(table.find("any"));
  std::vector<std::string> names{""};
  for (std::uint32_t i = 1; i < 5000; ++i) names.push_back("Name" + std::to_string(i * i));
  for (std::uint32_t i = 0; i < names.size(); ++i) {
    NodeId& node = table.insert(names[i]);
    REQUIRE_EACH(node == NodeId{});
    node = {i + 1, 7};
  }
  for (std::uint32_t i = 0; i < names.size(); ++i) {
    const NodeId* const found = table.find(std::string(names[i]));
    REQUIRE_EACH(found);
    REQUIRE_EACH((*found == NodeId{i + 1, 7}));
  }
  CHECK_FALSE(table.find("Name2"));
  // Another node of the same name replaces it.
  table.insert(names[9]) = {1, 1};
  CHECK(*table.find(names[9]) == NodeId{1, 1});
  CHECK(table.insert(names[10]) == NodeId{11, 7});
}
