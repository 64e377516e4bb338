#include "base/json_value.h"

#include <catch2/catch.hpp>

using namespace gs;

TEST_CASE("prints facts as JSON in the order of insertion") {
  JsonValue facts =
      JsonValue::named({{"file", "a.wrl"}, {"bytes", std::size_t{18'446'744'073'709'551'615u}}, {"least", -3}});
  facts.put("right", true);
  facts.put("size", JsonValue::list({1.5, 2.0f, 7u}));
  facts.put("none", JsonValue());
  facts.put("file", std::string("\xff\"\n"));
  REQUIRE(
      facts.json() ==
      "{\n  \"file\": \"\\ufffd\\\"\\n\",\n  \"bytes\": 18446744073709551615,\n  \"least\": -3,\n  \"right\": true,\n"
      "  \"size\": [\n    1.5,\n    2.0,\n    7\n  ],\n  \"none\": null\n}\n");
  REQUIRE(JsonValue::list().json() == "[]\n");
  REQUIRE(JsonValue::named().json() == "{}\n");
}

TEST_CASE("prints facts as text, with lists and metadata on their own lines") {
  JsonValue facts = JsonValue::named({{"type_of_voxels", "u16be"}, {"origin", JsonValue::list({0.1f, 4'500'000.001})}});
  JsonValue levels = JsonValue::list();
  levels.add(JsonValue::named({{"level", 0}, {"bytes", 12}}));
  facts.put("levels", levels);
  facts.put("metadata", JsonValue::named({{"up", "z"}}));
  REQUIRE(facts.lines() == std::vector<std::string>{"type of voxels         u16be",
                                                    "origin                 0.1 4500000.001", "levels",
                                                    "  level 0, bytes 12", "metadata", "  up: z"});
}

TEST_CASE("copies facts by value, and reports an empty one") {
  JsonValue a = JsonValue::list();
  REQUIRE(a.empty());
  JsonValue b = a;
  b.add(1);
  REQUIRE(a.empty());
  REQUIRE_FALSE(b.empty());
  a = b;
  b = JsonValue::named();
  REQUIRE(a.json() == "[\n  1\n]\n");
  REQUIRE(b.empty());
}

TEST_CASE("finds a name only in a valid JSON object") {
  REQUIRE(is_json_with(R"({"peak_rss_bytes": 1})", "peak_rss_bytes"));
  REQUIRE_FALSE(is_json_with(R"({"peak_rss_bytes": 1)", "peak_rss_bytes"));
  REQUIRE_FALSE(is_json_with(R"({"other": 1})", "peak_rss_bytes"));
  REQUIRE_FALSE(is_json_with(R"(["peak_rss_bytes"])", "peak_rss_bytes"));
  REQUIRE_FALSE(is_json_with("", "peak_rss_bytes"));
}
