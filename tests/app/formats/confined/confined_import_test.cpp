#include "app/formats/confined/confined_import.h"

#include "app/base/local_file.h"
#include "app/confined/decoder_pool.h"
#include "app/formats/confined/asset_transfer.h"
#include "app/formats/confined/scene_transfer.h"
#include "app/formats/content_types.h"
#include "base/gzip.h"
#include "tests/app/formats_helpers.h"
#include "tests/app/program.h"
#include "tests/render/media/media_files.h"
#include "vrml/syntax/parser.h"
#include "vrml/syntax/printer.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app {
namespace confined_import_test {

namespace fs = std::filesystem;

struct WithImports {
  WithImports() { set_decoder_program(program()); }
  ~WithImports() { set_decoder_program({}); }
};

struct Imported {
  Asset asset;
  Diagnostics diagnostics;
  [[nodiscard]] std::vector<std::byte> bytes() const { return transfer_bytes(asset, diagnostics); }
};

Imported imported(const ContentType& type, std::span<const std::byte> bytes, const ReadFile& read_file,
                  const WorldBudget& budget = own_budget()) {
  Imported result;
  const std::string path = "folder/file";
  result.asset = read_confined(type, {bytes, path, read_file, budget, result.diagnostics});
  return result;
}

std::vector<std::byte> file_bytes(const fs::path& path) { return media::bytes_of(media::file_text(path.string())); }

/// Calls `check` with each mesh and file of splats of the corpora, and its type.
template <class Check>
void each_corpus_file(const Check& check) {
  for (const auto& entry : fs::recursive_directory_iterator(GHOSTSPACE_TESTS "/fuzz/corpus/app")) {
    if (!entry.is_regular_file()) continue;
    const auto bytes = file_bytes(entry.path());
    const ContentType& type = content_type_of(entry.path().string(), first_bytes(bytes));
    const bool imported = type.content == ContentClass::mesh || type.content == ContentClass::splats;
    if (!imported || !type.read || is_gzip(bytes)) continue;
    INFO(entry.path().string());
    check(type, bytes);
  }
}

Asset read_again(std::span<const std::byte> bytes) {
  Diagnostics diagnostics;
  const std::string path = "file";
  return asset_of(bytes, {bytes, path, {}, own_budget(), diagnostics});
}

const ContentType& type_named(const std::string& extension) { return *content_type_by_name("a." + extension); }

const std::string kObj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\nf 1 2 9\n";

TEST_CASE("a child imports meshes, scenes and splats as this process does") {
  std::map<std::string_view, std::size_t> read;
  each_corpus_file([&](const ContentType& type, const std::vector<std::byte>& bytes) {
    const Imported here = imported(type, bytes, {});
    const WithImports children;
    const Imported there = imported(type, bytes, {});
    CHECK(there.bytes() == here.bytes());
    if (!std::holds_alternative<std::monostate>(here.asset)) ++read[type.name];
  });
  CHECK(read.size() > 10);
  CHECK(read["glTF"] > 0);
}

/// Calls `check` with each glTF file of the shared data, and its bytes.
template <class Check>
void each_shared_scene(const Check& check) {
  const fs::path folder = test::shared_folder() / "data";
  if (!fs::exists(folder)) {
    WARN("no ../shared/data");
    return;
  }
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (entry.is_regular_file() && (extension == ".glb" || extension == ".gltf")) check(entry.path());
  }
}

TEST_CASE("a child imports real glTF files as this process does, for VRML97 and X3D") {
  each_shared_scene([](const fs::path& path) {
    INFO(path.string());
    const auto bytes = file_bytes(path);
    const ReadFile read_file = reader_beside(path.string(), {});
    const ContentType& type = content_type_of(path.string(), first_bytes(bytes));
    for (const bool for_x3d : {false, true}) {
      const auto import = [&] {
        Imported result;
        const WorldBudget budget = own_budget();
        const std::string name = path.string();
        ImportSource source{bytes, name, read_file, budget, result.diagnostics};
        source.for_x3d = for_x3d;
        result.asset = read_confined(type, source);
        return result;
      };
      const Imported here = import();
      const WithImports children;
      const Imported there = import();
      CHECK((there.bytes() == here.bytes()));
      const auto* const one = std::get_if<SceneAsset>(&here.asset);
      const auto* const other = std::get_if<SceneAsset>(&there.asset);
      REQUIRE((one != nullptr) == (other != nullptr));
      if (one) CHECK((vrml::print(*one->scene) == vrml::print(*other->scene)));
    }
  });
}

std::string error_in_scene(const std::function<void(TransferWriter&)>& write) {
  TransferWriter to;
  to.value<std::uint64_t>(0);  // no diagnostics
  to.value<std::uint8_t>(4);   // a scene
  to.value<std::uint64_t>(0);  // no texts
  write(to);
  Diagnostics diagnostics;
  const std::string path = "file";
  const auto bytes = to.take();
  const Asset asset = asset_of(bytes, {bytes, path, {}, own_budget(), diagnostics});
  if (std::holds_alternative<SceneAsset>(asset)) return "";
  return diagnostics.entries().empty() ? "nothing" : diagnostics.entries().front().message;
}

// Writes nodes of one type without names. Their fields have default values, except for references to nodes.
void write_nodes(TransferWriter& to, vrml::NodeKind kind, const std::vector<std::vector<std::uint32_t>>& children) {
  const vrml::NodeType& type = vrml::built_in_node_type(kind);
  to.value<std::uint64_t>(children.size());
  for (const std::vector<std::uint32_t>& numbers : children) {
    to.value(static_cast<std::uint8_t>(kind));
    to.value<std::uint8_t>(0);
    to.text("");
    to.value<std::uint64_t>(type.defaults.size());
    for (const vrml::FieldValue& value : type.defaults) {
      if (std::holds_alternative<vrml::MFNode>(value))
        to.list(numbers);
      else if (const auto* const vector = std::get_if<vrml::SFVec3f>(&value))
        to.value(*vector);
      else
        to.value(std::get<vrml::SFRotation>(value));
    }
  }
  to.list(std::vector<std::uint32_t>{static_cast<std::uint32_t>(children.size())});
}

TEST_CASE("scenes of children have no Scripts, no cycles and no wrong references") {
  const std::string impossible = "the process that read it gave an impossible result";
  const auto groups = [](const std::vector<std::vector<std::uint32_t>>& children) {
    return error_in_scene([&](TransferWriter& to) { write_nodes(to, vrml::NodeKind::transform, children); });
  };
  CHECK(groups({{}, {1}, {1, 2}}).empty());
  CHECK(groups({{1}}) == impossible);       // itself
  CHECK(groups({{2}, {1}}) == impossible);  // a later one
  CHECK(groups({{}, {7}}) == impossible);
  CHECK(error_in_scene([](TransferWriter& to) {
          to.value<std::uint64_t>(1);
          to.value(static_cast<std::uint8_t>(vrml::NodeKind::script));
          for (int i = 0; i < 10; ++i) to.value<std::uint64_t>(0);
        }) == impossible);
  std::vector<std::vector<std::uint32_t>> deep{{}};
  for (std::uint32_t i = 1; i < Limits{}.nesting; ++i) deep.push_back({i});
  CHECK(groups(deep).empty());
  deep.push_back({static_cast<std::uint32_t>(deep.size())});
  CHECK(groups(deep) == impossible);
  vrml::SceneGraph scene("a.wrl");
  Diagnostics diagnostics;
  (void)vrml::parse("#VRML V2.0 utf8\nGroup { children Script {} }", scene, diagnostics);
  CHECK_FALSE(can_transfer(scene));
}

TEST_CASE("a child asks for the files to which a mesh refers") {
  std::vector<std::string> asked;
  const ReadFile read_file = [&](const std::string& reference) -> BytesResult {
    asked.push_back(reference);
    if (reference != "a.mtl") return "there is no " + reference;
    return shared_bytes(media::bytes_of("newmtl red\nKd 1 0 0\n"));
  };
  const auto bytes = media::bytes_of(kObj);
  const Imported here = imported(type_named("obj"), bytes, read_file);
  const std::vector<std::string> expected = std::exchange(asked, {});
  const WithImports children;
  const Imported there = imported(type_named("obj"), bytes, read_file);
  CHECK(there.bytes() == here.bytes());
  CHECK(asked == expected);
  REQUIRE(std::holds_alternative<MeshAsset>(there.asset));
  CHECK(std::get<MeshAsset>(there.asset).looks.at(std::get<MeshAsset>(there.asset).parts.at(0).look).look.diffuse.g ==
        0);
  const auto missing = media::bytes_of("mtllib none.mtl\n" + kObj.substr(kObj.find('v')));
  const Imported without = imported(type_named("obj"), missing, read_file);
  CHECK(std::ranges::any_of(without.diagnostics.entries(), [](const Diagnostic& one) {
    return one.message.find("there is no none.mtl") != std::string::npos && one.file == "folder/file";
  }));
}

TEST_CASE("a reader of references that gives up ends the import, and the next one works") {
  struct GivenUp {};
  const ReadFile read_file = [](const std::string&) -> BytesResult { throw GivenUp(); };
  const auto bytes = media::bytes_of(kObj);
  const WithImports children;
  CHECK_THROWS_AS(imported(type_named("obj"), bytes, read_file), GivenUp);
  CHECK(std::holds_alternative<MeshAsset>(imported(type_named("obj"), bytes, {}).asset));
}

TEST_CASE("a child respects the rest of the budget") {
  std::string points = "OFF\n200000 0 0\n";
  for (int i = 0; i < 200'000; ++i) points += "1 2 3\n";
  const auto bytes = media::bytes_of(points);
  Limits limits;
  limits.memory = std::size_t{1} << 20;
  const WithImports children;
  const Imported there = imported(type_named("off"), bytes, {}, std::make_shared<Budget>(limits));
  CHECK(there.diagnostics.errors() > 0);
  CHECK(there.diagnostics.entries().at(0).message.find("limit") != std::string::npos);
}

TEST_CASE("results of imports are not trusted: prefixes and changed bytes") {
  std::uint32_t random = 1;
  const auto next = [&random] { return random = random * 1664525 + 1013904223; };
  std::size_t taken = 0, refused = 0;
  each_corpus_file([&](const ContentType& type, const std::vector<std::byte>& file) {
    const std::vector<std::byte> bytes = imported(type, file, {}).bytes();
    CHECK(transfer_bytes(read_again(bytes), {}) == transfer_bytes(imported(type, file, {}).asset, {}));
    for (std::size_t size = 0; size < bytes.size(); size += 1 + bytes.size() / 40)
      CHECK(std::holds_alternative<std::monostate>(read_again(std::span(bytes).first(size))));
    for (int turn = 0; turn < 60; ++turn) {
      std::vector<std::byte> changed = bytes;
      for (std::uint32_t left = 1 + (next() >> 8) % 3; left > 0; --left)
        changed[(next() >> 4) % changed.size()] = static_cast<std::byte>(next() >> 16);
      const Asset asset = read_again(changed);
      ++(std::holds_alternative<std::monostate>(asset) ? refused : taken);
      const auto* const mesh = std::get_if<MeshAsset>(&asset);
      if (!mesh) continue;
      for (const MeshPart& part : mesh->parts) {
        CHECK(part.look < mesh->looks.size());
        for (const std::int32_t index : part.geometry.coord_index)
          CHECK((index >= -1 && index < static_cast<std::int32_t>(part.geometry.positions.size())));
      }
    }
  });
  CHECK(taken > 0);
  CHECK(refused > 0);
}

TEST_CASE("requests of imports survive prefixes and changed bytes") {
  ImportRequest request;
  request.type = "OBJ";
  request.path = "a/b.obj";
  request.component.labels = true;
  request.left = {1, 2, 3};
  const auto bytes = transfer_bytes(request);
  const auto again = import_request_of(bytes);
  REQUIRE(again);
  CHECK(again->path == request.path);
  CHECK(again->component == request.component);
  CHECK(again->left == request.left);
  for (std::size_t size = 0; size < bytes.size(); ++size) CHECK_FALSE(import_request_of(std::span(bytes).first(size)));
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    auto changed = bytes;
    changed[at] ^= std::byte{0xff};
    (void)import_request_of(changed);
  }
}

}  // namespace confined_import_test
}  // namespace gs::app
