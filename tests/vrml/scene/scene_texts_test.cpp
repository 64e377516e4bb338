#include "vrml/scene/scene_texts.h"

#include <catch2/catch.hpp>

#include <memory>

namespace gs::vrml::scene_texts_test {

TEST_CASE("gives back the memory of a run-time text with its last node") {
  SceneMemory memory(std::make_shared<Budget>(Limits{}));
  SourceText file("file.wrl");
  SceneTexts texts(file, memory);
  texts.keep_name("in the file");
  const std::size_t before = memory.charged();
  const std::uint32_t index = texts.open("text", file, nullptr);
  CHECK(index != 0);
  CHECK(texts.run_time_count() == 1);
  CHECK(texts.at(index).is_computed());
  CHECK(texts.write_for(index) == 0);
  CHECK(&texts.writing() == &texts.at(index));
  texts.keep_name("in the text");
  CHECK(memory.reserve_expansion(2, 100));
  texts.add_node(index);
  CHECK(texts.write_for(0) == index);
  CHECK(&texts.writing() == &file);
  CHECK(memory.charged() > before);
  texts.close(index);
  CHECK_FALSE(texts.is_unused(index));
  CHECK(texts.remove_node(index));
  REQUIRE(texts.is_unused(index));
  texts.erase(index);
  CHECK(texts.run_time_count() == 0);
  CHECK(memory.charged() == before);
  CHECK(texts.open("next", file, nullptr) == index);
}

TEST_CASE("finds the text that declares a type, even if the type is deleted") {
  SceneMemory memory(std::make_shared<Budget>(Limits{}));
  SourceText file("file.wrl");
  SceneTexts texts(file, memory);
  const NodeType& own = file.add_type(std::make_unique<NodeType>());
  const std::uint32_t index = texts.open("text", file, nullptr);
  const NodeType& other = texts.at(index).add_type(std::make_unique<NodeType>());
  const NodeType none;
  CHECK(texts.declaring(&own) == 0u);
  CHECK(texts.declaring(&other) == index);
  CHECK_FALSE(texts.declaring(&none));
}

}  // namespace gs::vrml::scene_texts_test
