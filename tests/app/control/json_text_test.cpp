#include "app/control/json_text.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace gs::app::json_text_test {
namespace {

std::size_t wrong_at(std::string_view text) {
  const auto problem = check_json(text);
  INFO(text);
  REQUIRE(problem);
  CHECK_FALSE(problem->why.empty());
  return problem->place;
}

/// Reads a value with a cursor, and returns its text as written again.
std::string again(JsonCursor& json) {
  std::string out, made;
  switch (json.kind()) {
    case JsonKind::null:
      (void)json.skip();
      return "null";
    case JsonKind::boolean:
      return json.boolean() ? "true" : "false";
    case JsonKind::number:
      append_json_number(out, json.number());
      return out;
    case JsonKind::string:
      append_json_string(out, json.string(made));
      return out;
    case JsonKind::list:
      json.open();
      while (json.more()) out += (out.empty() ? "" : ",") + again(json);
      return "[" + out + "]";
    case JsonKind::object:
      json.open();
      while (json.more()) {
        std::string name;
        append_json_string(name, json.name(made));
        out += (out.empty() ? "" : ",") + name + ":" + again(json);
      }
      return "{" + out + "}";
  }
  return out;
}

std::string again(std::string_view text) {
  REQUIRE_FALSE(check_json(text));
  JsonCursor json(text);
  return again(json);
}

const std::string kText =
    " { \"a\" : [ 1 , -2.5e3, 0, 0.5E-1, true , false,null ] , \"\\u0041\\n\" : { } , "
    "\"c\":\"x\\\"\\\\\\/\\ud83d\\ude00\","
    "\"d\":[[],[{}],\"\"]}  ";

}  // namespace

TEST_CASE("parses JSON as RFC 8259 defines") {
  CHECK(again(kText) ==
        "{\"a\":[1,-2500,0,0.05,true,false,null],\"A\\u000a\":{},\"c\":\"x\\\"\\\\/"
        "\xf0\x9f\x98\x80\",\"d\":[[],[{}],\"\"]}");
  CHECK(again("7") == "7");
  CHECK(again(" \"\" ") == "\"\"");
  CHECK(again("-0") == "-0");
  CHECK(again("\"\\ud800x\\udc00\"") == "\"\xef\xbf\xbdx\xef\xbf\xbd\"");  // unpaired surrogates
  CHECK(again("1e400") == "\"Infinity\"");
  CHECK(again("-1e400") == "\"-Infinity\"");
  CHECK(again("1e-400") == "0");
  CHECK(again("0." + std::string(400, '0') + "1") == "0");
}

TEST_CASE("rejects invalid JSON at its first wrong byte, and every incomplete text") {
  const std::pair<const char*, std::size_t> wrong[] = {
      {"", 0},      {"[1,]", 3},       {"[,1]", 1},  {"[1 2]", 3}, {"{\"a\" 1}", 5},
      {"{a:1}", 1}, {"{\"a\":1,}", 7}, {"{} {}", 3}, {"[}", 1},
  };
  for (const auto& [text, at] : wrong) CHECK(wrong_at(text) == at);
  for (const char* bad : {"01",  "-",        "-01", "1.",  ".5",      "1e",          "1e+",    "+1", "nul", "True",
                          "NaN", "Infinity", "'a'", "\"a", "\"\\x\"", "\"\\u12g4\"", "\"\t\"", "[",  "]",   "\"\\"}) {
    INFO(bad);
    CHECK(check_json(bad));
  }
  const std::string text = "{\"a\":[1,2.5,true,null,\"x\\u0041\"],\"b\":{\"c\":-1e5}}";
  for (std::size_t i = 0; i < text.size(); ++i) {
    INFO(i);
    CHECK(check_json(std::string_view(text).substr(0, i)));
  }
  CHECK_FALSE(check_json(text));
}

TEST_CASE("parses lists nested 64 deep but no deeper, without recursion for a million brackets") {
  CHECK_FALSE(check_json(std::string(64, '[') + std::string(64, ']')));
  CHECK(wrong_at(std::string(65, '[') + std::string(65, ']')) == 64);
  CHECK(check_json(std::string(1'000'000, '[')));
}

TEST_CASE("skips an unneeded value, and returns its text") {
  JsonCursor json(kText);
  std::string made;
  json.open();
  std::vector<std::string> texts;
  while (json.more()) {
    (void)json.name(made);
    texts.emplace_back(json.skip());
  }
  CHECK(texts == std::vector<std::string>{"[ 1 , -2.5e3, 0, 0.5E-1, true , false,null ]", "{ }",
                                          "\"x\\\"\\\\\\/\\ud83d\\ude00\"", "[[],[{}],\"\"]"});
}

TEST_CASE("writes valid JSON for any bytes and numbers") {
  const auto string = [](std::string_view text) {
    std::string out;
    append_json_string(out, text);
    CHECK_FALSE(check_json(out));
    return out;
  };
  CHECK(string("a\"\\\n\x01\x7f") == "\"a\\\"\\\\\\u000a\\u0001\\u007f\"");
  CHECK(string("\xc3\xa9\xff\xe2\x82") == "\"\xc3\xa9\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\"");
  const auto number = [](auto value) {
    std::string out;
    append_json_number(out, value);
    CHECK_FALSE(check_json(out));
    return out;
  };
  CHECK(number(0.1f) == "0.1");
  CHECK(number(0.1) == "0.1");
  CHECK(number(946684800.5) == "946684800.5");
  CHECK(number(std::numeric_limits<float>::quiet_NaN()) == "\"NaN\"");
  CHECK(number(-std::numeric_limits<double>::infinity()) == "\"-Infinity\"");
}

}  // namespace gs::app::json_text_test
