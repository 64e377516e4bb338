#include "app/saving/world_text.h"

#include "app/inspect/node_editor.h"
#include "app/loading/world_loader.h"
#include "base/gzip.h"
#include "tests/app/scratch_folder.h"
#include "tests/app/worlds.h"

#include <catch2/catch.hpp>

#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace gs::app::world_text_test {
namespace {

constexpr const char* kRoom =
    "#VRML V2.0 utf8\n# my room\nPROTO Lamp [ exposedField SFVec3f at 0 0 0 field SFFloat size 1 ] {\n"
    "  DEF Place Transform { translation IS at children DEF Foot Transform { } } }\n"
    "EXTERNPROTO Far [ field SFFloat x ] \"far.wrl#Far\"\n"
    "DEF Table Transform { # oak\n  translation 1 0 0\n  children Shape { geometry DEF Top Box { } }\n}\n"
    "DEF L Lamp { }\nDEF Rest Inline { url \"rest.wrl\" }\nGroup { children [ DEF A Group { } USE A ] }\n"
    "DEF Clock TimeSensor { loop TRUE } DEF Path PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 1 1 ] }\n"
    "ROUTE Clock.fraction_changed TO Path.set_fraction\nROUTE Path.value_changed TO L.at\n";

/// World of a file, with an editor of its nodes.
struct Edited {
  explicit Edited(const std::string& path) : document(hold_world(load_world(path, {}))) {
    begin_world(*document, 1000);
    editor.set_world(&document->runtime->execution());
  }
  [[nodiscard]] NodeAt find(std::string_view name, const vrml::SceneGraph& scene) const {
    for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i)
      if (scene.nodes().at(i).name == name && !scene.nodes().at(i).in_prototype_body) return {&scene, scene.nodes().id_at(i)};
    return {};
  }
  [[nodiscard]] NodeAt find(std::string_view name) const { return find(name, *document->world.scene); }
  void set(const NodeAt& node, std::string_view event, const std::string& value) {
    REQUIRE(node);
    editor.select(node);
    const vrml::InterfaceDeclaration* const interface = node.scene->node(node.id).type->find(event);
    REQUIRE(interface);
    CHECK(editor.send_text(*interface, value).value_or("") == "");
    keep_source_text(*document);
    CHECK(editor.deliver(document->edits));
  }
  [[nodiscard]] WorldText text(const std::string& target) const {
    auto made = world_text(*document, target);
    REQUIRE(std::holds_alternative<WorldText>(made));
    return std::get<WorldText>(made);
  }

  std::shared_ptr<Document> document;
  NodeEditor editor;
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  REQUIRE(text.find(from) != std::string::npos);
  return text.replace(text.find(from), from.size(), to);
}

}  // namespace

TEST_CASE("writes only the edited values into the text of the file, while the world moves on") {
  const ScratchFolder folder;
  Edited world(folder.write("room.wrl", kRoom));
  CHECK(world.text(folder.path("a.wrl")).text == kRoom);
  world.set(world.find("Table"), "translation", "2 0 0.5");
  world.set(world.find("Table"), "scale", "2 2 2");
  (void)world.document->runtime->step(1000.3);  // the lamp moves
  const WorldText made = world.text(folder.path("a.wrl"));
  CHECK(made.is_source);
  CHECK(made.left_out == 0);
  CHECK(made.text == replaced(kRoom, "translation 1 0 0", "scale 2 2 2\n  translation 2 0 0.5"));
}

TEST_CASE("writes edits of a compressed file, and of a file that was replaced meanwhile") {
  const ScratchFolder folder;
  const std::string_view room = kRoom;
  const auto packed = gzip(std::as_bytes(std::span(room)));
  Edited world(folder.write("room.wrz", {reinterpret_cast<const char*>(packed.data()), packed.size()}));
  world.set(world.find("Table"), "translation", "2 0 0.5");
  folder.write("room.wrz", "#VRML V2.0 utf8\n");
  CHECK(world.text(folder.path("a.wrl")).text == replaced(kRoom, "translation 1 0 0", "translation 2 0 0.5"));
}

TEST_CASE("writes an edit of a prototype's part that IS passes on to the field of the instance") {
  const ScratchFolder folder;
  Edited world(folder.write("room.wrl", kRoom));
  world.set(world.find("Place"), "translation", "0 3 0");
  CHECK(world.text(folder.path("a.wrl")).text == replaced(kRoom, "Lamp { }", "Lamp { at 0 3 0 }"));
}

TEST_CASE("counts edits of nodes that are not in the file") {
  const ScratchFolder folder;
  folder.write("rest.wrl", "#VRML V2.0 utf8\nDEF Inner Transform { }\n");
  Edited world(folder.write("room.wrl", kRoom));
  world.set(world.find("Foot"), "translation", "0 3 0");
  const vrml::SceneGraph* const content = world.document->world.scene->inlines().of(world.find("Rest").id);
  REQUIRE(content);
  world.set(world.find("Inner", *content), "translation", "1 1 1");
  const WorldText made = world.text(folder.path("a.wrl"));
  CHECK(made.left_out == 2);
  CHECK(made.text == kRoom);
}

TEST_CASE("leaves out edits that were undone") {
  const ScratchFolder folder;
  Edited world(folder.write("room.wrl", kRoom));
  world.set(world.find("Table"), "translation", "2 0 0.5");
  CHECK(world.editor.step(world.document->edits, -1));
  const NodeAt table = world.find("Table");
  CHECK(table.scene->get<vrml::SFVec3f>(table.id, "translation") == glm::vec3(1, 0, 0));
  CHECK(world.text(folder.path("a.wrl")).text == kRoom);
  CHECK(world.editor.step(world.document->edits, 1));
  CHECK(table.scene->get<vrml::SFVec3f>(table.id, "translation") == glm::vec3(2, 0, 0.5));
  CHECK(world.text(folder.path("a.wrl")).text != kRoom);
}

TEST_CASE("adapts the URLs to the folder of the new file") {
  const ScratchFolder folder;
  folder.write("a/rest.wrl", "#VRML V2.0 utf8\n");
  Edited world(folder.write("a/room.wrl", kRoom));
  CHECK(world.text(folder.path("room.wrl")).text == replaced(kRoom, "\"rest.wrl\"", "\"a/rest.wrl\""));
}

TEST_CASE("prints the nodes if an edit cannot be written into the text") {
  const ScratchFolder folder;
  const std::string text =
      "#VRML V2.0 utf8\nDEF S Shape { appearance Appearance { } geometry DEF G Box { } } Shape { geometry USE G }\n";
  Edited world(folder.write("room.wrl", text));
  world.set(world.find("S"), "geometry", "NULL");
  const WorldText made = world.text(folder.path("a.wrl"));
  CHECK_FALSE(made.is_source);  // the text would lose the DEF of the box
  vrml::SceneGraph again("again.wrl");
  Diagnostics diagnostics;
  (void)vrml::parse(made.text, again, diagnostics);
  INFO(made.text);
  CHECK(diagnostics.errors() == 0);
  CHECK(again.get<vrml::SFNode>(again.roots()[1], "geometry"));
}

TEST_CASE("prints the nodes of a file of another format") {
  const ScratchFolder folder;
  Edited world(folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
  const WorldText made = world.text(folder.path("a.wrl"));
  CHECK_FALSE(made.is_source);
  CHECK(made.text.starts_with("#VRML V2.0 utf8\n"));
  CHECK(made.text.find("IndexedFaceSet") != std::string::npos);
}

}  // namespace gs::app::world_text_test
