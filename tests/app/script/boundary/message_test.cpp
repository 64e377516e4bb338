#include "app/script/boundary/message.h"

#include <catch2/catch.hpp>

#include <random>
#include <string>
#include <vector>

namespace gs::app::script::message_test {
namespace {

// Returns a value of each field type that is not the initial one.
std::vector<vrml::FieldValue> values_of_all_types() {
  vrml::PixelImage image;
  for (const std::uint32_t word : {2U, 1U, 3U, 0xff0000U, 0x00ff00U}) image.words.push_back(word);
  const vrml::NodeId node{7, 9};
  return {true,
          vrml::Color{0.5F, 0.25F, 1},
          vrml::ColorRGBA{0.5F, 0.25F, 1, 0.75F},
          vrml::Double{2.5},
          1.5F,
          image,
          std::int32_t{-3},
          vrml::SFMatrix3d(glm::dmat3(2)),
          vrml::SFMatrix3f(glm::mat3(3)),
          vrml::SFMatrix4d(glm::dmat4(4)),
          vrml::SFMatrix4f(glm::mat4(5)),
          node,
          vrml::Rotation{1, 0, 0, 2},
          vrml::String("text"),
          12.25,
          glm::dvec2(1, 2),
          glm::vec2(3, 4),
          vrml::SFVec3d(glm::dvec3(1, 2, 3)),
          glm::vec3(1, 2, 3),
          vrml::SFVec4d(glm::dvec4(1, 2, 3, 4)),
          glm::vec4(1, 2, 3, 4),
          vrml::MFBool{true, false, true},
          vrml::MFColor{{1, 0, 0}, {0, 1, 0}},
          vrml::MFColorRGBA{{1, 0, 0, 1}},
          vrml::MFDouble{{1.5}, {2.5}},
          vrml::MFFloat{1, 2, 3},
          vrml::MFImage{image, image},
          vrml::MFInt32{1, -2},
          vrml::MFMatrix3d{glm::dmat3(1)},
          vrml::MFMatrix3f{glm::mat3(2)},
          vrml::MFMatrix4d{glm::dmat4(3)},
          vrml::MFMatrix4f{glm::mat4(4)},
          vrml::MFNode{node, {}},
          vrml::MFRotation{{0, 1, 0, 1}},
          vrml::MFString{"a", "", "long text"},
          vrml::MFTime{1, 2},
          vrml::MFVec2d{glm::dvec2(1, 2)},
          vrml::MFVec2f{glm::vec2(1, 2)},
          vrml::MFVec3d{glm::dvec3(1, 2, 3)},
          vrml::MFVec3f{glm::vec3(1, 2, 3)},
          vrml::MFVec4d{glm::dvec4(1, 2, 3, 4)},
          vrml::MFVec4f{glm::vec4(1, 2, 3, 4)}};
}

Order full_order() {
  Order order{Order::Kind::start};
  auto type = std::make_shared<vrml::NodeType>();
  type->name = "Script";
  type->kind = vrml::NodeType::Kind::script;
  type->role = vrml::Role::script;
  type->declare({vrml::AccessType::exposedField, vrml::FieldType::MFString, "url", vrml::MFString{}, ""});
  type->declare({vrml::AccessType::eventIn, vrml::FieldType::SFTime, "now", {}, ""});
  auto facts = std::make_shared<ProgramFacts>();
  facts->node = {3, {1, 2}};
  facts->type = type;
  facts->library = "http://a.example";
  facts->late_message = "late";
  facts->faults = 2;
  order.facts = facts;
  order.program = 12;
  order.text = "function now() {}";
  order.file = "world.wrl";
  order.at = {4, 5};
  for (std::uint32_t place = 0; const vrml::FieldValue& value : values_of_all_types())
    order.values.emplace_back(place++, value);
  order.gone = {4, 5};
  order.seconds = 2;
  order.heap = 1 << 20;
  return order;
}

Answer full_answer() {
  Answer answer;
  answer.good = answer.flag = true;
  answer.node = {1, {2, 3}};
  answer.place = 4;
  answer.text = "why";
  answer.value = vrml::MFNode{{1, 1}};
  answer.items = {1.5, std::string("name"), NodeRef{1, {2, 3}}};
  answer.type = {std::shared_ptr<const vrml::NodeType>(), &vrml::built_in_node_type(vrml::NodeKind::transform)};
  auto facts = std::make_shared<BrowserFacts>();
  facts->mode = "WALK";
  facts->position = {1, 2, 3};
  answer.browser = facts;
  return answer;
}

// Returns one message with all items, as no process sends it.
std::vector<std::byte> all_items() {
  MessageWriter writer;
  write(writer, full_order());
  write(writer, full_answer());
  for (int kind = 0; kind < kNoticeCount; ++kind) {
    Notice notice{static_cast<Notice::Kind>(kind), {1, {2, 3}}, 4};
    notice.text = "printed";
    notice.value = vrml::MFString{"a", "b"};
    notice.at = Diagnostic{Severity::warning, "a.wrl", {1, 2}, "m"};
    write(writer, notice);
  }
  for (int ask = 0; ask < kAskCount; ++ask) {
    Question question{static_cast<Ask>(ask), {1, {2, 3}}, {4, {5, 6}}, 7, true, "text", "more"};
    question.value = glm::vec3(1, 2, 3);
    write(writer, question);
  }
  Report report;
  report.good = report.runs = true;
  report.text = "1";
  report.problem = Diagnostic{Severity::error, "a.wrl", {1, 2}, "m"};
  write(writer, report);
  return {writer.bytes().begin(), writer.bytes().end()};
}

// Reads all items of a message. Returns their number, or -1 if one of them is wrong.
int read_all(std::span<const std::byte> bytes) {
  MessageReader reader(bytes);
  int count = 0;
  while (!reader.at_end()) {
    switch (static_cast<ItemKind>(reader.number<std::uint8_t>())) {
      case ItemKind::order:
        (void)read_order(reader);
        break;
      case ItemKind::answer:
        (void)read_answer(reader);
        break;
      case ItemKind::notice:
        (void)read_notice(reader);
        break;
      case ItemKind::question:
        (void)read_question(reader);
        break;
      case ItemKind::report:
        (void)read_report(reader);
        break;
      default:
        return -1;
    }
    ++count;
  }
  return reader.good() ? count : -1;
}

}  // namespace

TEST_CASE("carries values of all field types between a world and its programs") {
  const auto values = values_of_all_types();
  REQUIRE(values.size() == vrml::kFieldTypeCount);
  for (std::size_t i = 0; i < values.size(); ++i) {
    REQUIRE(values[i].index() == i);
    MessageWriter writer;
    write(writer, values[i]);
    MessageReader reader(writer.bytes());
    CHECK((read_value(reader) == values[i]));
    CHECK(reader.good());
    CHECK(reader.at_end());
    const vrml::FieldValue empty = vrml::initial_value(static_cast<vrml::FieldType>(i));
    writer.clear();
    write(writer, empty);
    MessageReader again(writer.bytes());
    CHECK((read_value(again) == empty));
    CHECK(again.good());
  }
}

TEST_CASE("carries orders and answers of a world") {
  MessageWriter writer;
  write(writer, full_order());
  MessageReader reader(writer.bytes());
  CHECK(reader.number<std::uint8_t>() == static_cast<std::uint8_t>(ItemKind::order));
  const Order order = read_order(reader), sent = full_order();
  REQUIRE(reader.good());
  CHECK(order.text == sent.text);
  CHECK((order.values == sent.values));
  CHECK(order.gone == sent.gone);
  REQUIRE(order.facts);
  CHECK(order.facts->faults == 2);
  REQUIRE(order.facts->type->interfaces.size() == 2);
  CHECK(order.facts->type->find_field("url")->slot == 0);
  CHECK(order.facts->type->find_event_in("now"));
  writer.clear();
  write(writer, full_answer());
  MessageReader second(writer.bytes());
  CHECK(second.number<std::uint8_t>() == static_cast<std::uint8_t>(ItemKind::answer));
  const Answer answer = read_answer(second);
  REQUIRE(second.good());
  CHECK(answer.items == full_answer().items);
  CHECK(answer.type.get() == &vrml::built_in_node_type(vrml::NodeKind::transform));
  CHECK(answer.browser->position[2] == 3);
}

TEST_CASE("rejects each cut message, and reads changed bytes without harm") {
  const std::vector<std::byte> whole = all_items();
  const int count = read_all(whole);
  CHECK(count == 2 + kNoticeCount + kAskCount + 1);
  int accepted = 0;
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const int found = read_all(std::span(whole).first(length));
    accepted += found >= 0 ? 1 : 0;
    CHECK(found < count);
  }
  CHECK(accepted == count);  // the ends of the items, and the empty message
  std::mt19937 random(1);
  std::vector<std::byte> changed = whole;
  for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
    const std::byte flip{static_cast<unsigned char>(1U << bit % 8)};
    changed[bit / 8] ^= flip;
    (void)read_all(changed);
    changed[bit / 8] ^= flip;
  }
  for (int round = 0; round < 2000; ++round) {
    changed = whole;
    for (int i = 0; i < 8; ++i) changed[random() % changed.size()] = static_cast<std::byte>(random());
    (void)read_all(changed);
  }
}

TEST_CASE("rejects impossible images and numbers in messages") {
  const auto is_refused = [](const MessageWriter& writer) {
    MessageReader reader(writer.bytes());
    (void)read_value(reader);
    return !reader.good();
  };
  MessageWriter writer;
  writer.number(static_cast<std::uint8_t>(vrml::FieldType::SFImage));
  writer.number(std::uint64_t{4});
  for (const std::uint32_t word : {5U, 5U, 3U, 0U}) writer.number(word);
  CHECK(is_refused(writer));
  writer.clear();
  writer.number(static_cast<std::uint8_t>(vrml::FieldType::MFFloat));
  writer.number(~std::uint64_t{0});
  CHECK(is_refused(writer));
  writer.clear();
  writer.number(static_cast<std::uint8_t>(vrml::kFieldTypeCount));
  CHECK(is_refused(writer));
}

}  // namespace gs::app::script::message_test
